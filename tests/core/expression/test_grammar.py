"""What formulas mean, and what is said about those that cannot be read."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, strategies as st

from linkwork.core.expression.grammar import FUNCTIONS, parse, parse_equation
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode, text
from linkwork.core.expression.values import value
from linkwork.core.foundation.errors import ExpressionError
from linkwork.core.foundation.units import AngleUnit

X, Y, Z = Name("x"), Name("y"), Name("z")


def number(formula: str, **names: float) -> float:
    return value(parse(formula), names, AngleUnit.RADIAN, formula)


@pytest.mark.parametrize(
    ("formula", "tree"),
    [
        ("x - y - z", Binary("-", Binary("-", X, Y), Z)),
        ("x/y*z", Binary("*", Binary("/", X, Y), Z)),
        ("x/y/z", Binary("/", Binary("/", X, Y), Z)),
        ("x + y*z", Binary("+", X, Binary("*", Y, Z))),
        ("(x + y)*z", Binary("*", Binary("+", X, Y), Z)),
        ("x*y^z", Binary("*", X, Binary("^", Y, Z))),
        ("x^y^z", Binary("^", X, Binary("^", Y, Z))),
        ("-x^y", Negative(Binary("^", X, Y))),
        ("-x*y", Binary("*", Negative(X), Y)),
        ("x^-y", Binary("^", X, Negative(Y))),
        ("x*-y", Binary("*", X, Negative(Y))),
        ("x - -y", Binary("-", X, Negative(Y))),
        ("--x", Negative(Negative(X))),
        ("+x", X),
        ("x**y", Binary("^", X, Y)),
        ("x²", Binary("^", X, NumberNode(2.0))),
        ("x¹²*y", Binary("*", Binary("^", X, NumberNode(12.0)), Y)),
        ("-x²", Negative(Binary("^", X, NumberNode(2.0)))),
        ("√(x)", Call("sqrt", (X,))),
        ("x·y", Binary("*", X, Y)),
        ("x⋅y", Binary("*", X, Y)),
        ("x×y", Binary("*", X, Y)),
        ("x−y", Binary("-", X, Y)),
        ("x–y", Binary("-", X, Y)),
        ("iθ12", Binary("*", Name("i"), Name("theta12"))),
        ("e^iφ", Binary("*", Binary("^", Name("e"), Name("i")), Name("phi"))),
        ("e^(iθ₁₂)", Binary("^", Name("e"), Binary("*", Name("i"), Name("theta12")))),
        ("ix", Name("ix")),
        ("θ₁₂", Name("theta12")),
        ("ϑ12", Name("theta12")),
        ("theta12", Name("theta12")),
        ("s₄", Name("s4")),
        ("µ", Name("mu")),
        ("A.x", Name("A.x")),
        ("a'*b_2", Binary("*", Name("a'"), Name("b_2"))),
        ("atan2(y, x)", Call("atan2", (Y, X))),
        ("1e3", NumberNode(1000.0)),
        ("1.5E-2", NumberNode(0.015)),
        (".5", NumberNode(0.5)),
        ("2.", NumberNode(2.0)),
    ],
)
def test_a_formula_reads_as_its_tree(formula: str, tree: Node) -> None:
    assert parse(formula) == tree


@pytest.mark.parametrize(
    ("formula", "wanted"),
    [
        ("2^3^2", 512.0),
        ("-2²", -4.0),
        ("2^-1", 0.5),
        ("7 - 2 - 1", 4.0),
        ("24/4/2", 3.0),
        ("24/4*2", 12.0),
        ("2*3 + 4*5", 26.0),
        ("hypot(3, 4)", 5.0),
        ("min(3, 1, 2) + max(3, 1, 2)", 4.0),
        ("2*pi", 2 * math.pi),
        ("ln(e)", 1.0),
        ("log10(1000)", 3.0),
        ("abs(-3)", 3.0),
    ],
)
def test_a_formula_has_its_value(formula: str, wanted: float) -> None:
    assert number(formula) == pytest.approx(wanted, rel=1e-15, abs=0)


def test_names_and_columns_are_kept_as_written() -> None:
    tree = parse("a + θ₁₂")
    assert isinstance(tree, Binary)
    assert isinstance(tree.right, Name)
    assert (tree.column, tree.right.spelling, tree.right.column) == (3, "θ₁₂", 5)


@pytest.mark.parametrize(
    ("formula", "column", "message"),
    [
        ("2 $ 3", 3, "unexpected character '$'"),
        ("x⁻¹", 2, "unexpected character '⁻'"),
        ("2x", 2, 'write the multiplication sign: "2*x"'),
        ("2e + 1", 2, 'write the multiplication sign: "2*e"'),
        ("(a)(b)", 4, 'an operator such as * is missing before "("'),
        ("a b", 3, 'an operator such as * is missing before "b"'),
        ("(a b)", 4, 'an operator such as * is missing before "b"'),
        ("a +", 4, 'expected a number, a name or "(", found the end'),
        ("a + * b", 5, 'expected a number, a name or "(", found "*"'),
        ("(a + b", 7, 'expected ")" for the "(" in column 1, found the end'),
        ("sin(a, b", 9, 'expected ")" for the "(" in column 4, found the end'),
        ("a)", 2, '")" without "("'),
        ("a = b", 3, 'unexpected "="'),
        ("1.2.3", 1, '"1.2.3" is not a number'),
        ("a + 1e999", 5, "1e999 is too large"),
        ("a + sin", 5, '"sin" is a function: write sin(…)'),
        ("a + atan2(1)", 5, "atan2 takes 2 arguments, got 1"),
        ("sqrt(1, 2)", 1, "sqrt takes 1 argument, got 2"),
        ("min(1)", 1, "min takes 2 to 9 arguments, got 1"),
        (
            "a + sine(b)",
            5,
            '"sine" is not a function (functions: sin, asin, cos, tan, acos, atan, atan2, sqrt, '
            '… 8 more); for a product write "sine*("',
        ),
        ("(" * 61 + "a" + ")" * 61, 31, "nested deeper than 60 levels"),
    ],
)
def test_a_formula_that_cannot_be_read_says_where_and_why(
    formula: str, column: int, message: str
) -> None:
    with pytest.raises(ExpressionError) as raised:
        parse(formula)
    assert raised.value.message == f"column {column}: {message}"
    assert raised.value.column == column
    assert str(raised.value).splitlines()[0] == f"column {column}: {message}"


def test_the_caret_stands_under_the_column() -> None:
    with pytest.raises(ExpressionError) as raised:
        parse("a2*e^(iθ12) $ 3")
    assert str(raised.value) == (
        "column 13: unexpected character '$'\n    a2*e^(iθ12) $ 3\n                ^"
    )


def test_a_long_formula_is_shown_around_the_column() -> None:
    with pytest.raises(ExpressionError) as raised:
        parse("1+" * 50 + "$" + "+1" * 50)
    piece, caret = raised.value.marked().splitlines()
    assert piece == "    …" + "1+" * 15 + "$" + "+1" * 14 + "+" + "…"
    assert caret.index("^") == piece.index("$")


def test_formulas_without_end_are_refused_before_they_are_read() -> None:
    with pytest.raises(ExpressionError) as raised:
        parse("1+" * 5000 + "1")
    assert raised.value.message == "the formula has 10001 characters, at most 10000 are allowed"
    with pytest.raises(ExpressionError) as raised:
        parse("+".join(["a"] * 300))
    assert raised.value.message == (
        "column 401: more than 400 numbers, names and signs: "
        "split the formula with a named dimension"
    )


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        ("a + b", 'column 6: an equation needs "=": write "… = 0"'),
        ("a = b = c", 'column 7: unexpected "="'),
        ("a b = c", 'column 3: an operator such as * is missing before "b"'),
        ("a =", 'column 4: expected a number, a name or "(", found the end'),
    ],
)
def test_an_equation_needs_one_equals_sign(formula: str, message: str) -> None:
    with pytest.raises(ExpressionError) as raised:
        parse_equation(formula)
    assert raised.value.message == message


def test_an_equation_has_two_sides() -> None:
    assert parse_equation("x + y = -z") == (Binary("+", X, Y), Negative(Z))


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        ("1 + a/b", 'column 5: "a" is not defined (dimensions: x, y)'),
        ("1 + 2/(x - x)", "column 6: division by zero"),
        ("(x - x)^(-1)", "column 8: division by zero"),
        ("1 + (-2)^0.5", "column 9: -2^0.5 is not a real number"),
        ("1 + sqrt(-x)", "column 5: sqrt(-3) is not a real number"),
        ("asin(2)", "column 1: asin(2) is not a real number"),
        ("2*i", "column 3: a real number cannot contain the imaginary unit i"),
        ("cis(1)", "column 1: cis is not allowed in a real number"),
        ("exp(1000)", "the value is too large"),
        ("10^400", "the value is too large"),
    ],
)
def test_a_formula_without_a_real_value_says_why(formula: str, message: str) -> None:
    with pytest.raises(ExpressionError) as raised:
        number(formula, x=3.0, y=1.0)
    assert raised.value.message == message


# ------------------------------------------------------------------ writing

NAMES = [Name(n, n) for n in ("a", "a2", "b_1", "x'", "theta12", "sigma", "pi", "A.x", "psi_a")]
LEAVES = st.one_of(
    st.sampled_from(NAMES),
    st.sampled_from(["θ₁₂", "φ", "Ω3", "β"]).map(lambda n: parse(n)),
    st.integers(0, 10**9).map(lambda n: NumberNode(float(n))),
    st.sampled_from([0.5, 0.001, 1e-9, 1e300, 2.25, 123456.789012]).map(NumberNode),
)


def _grown(children: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    return st.one_of(
        st.builds(Binary, st.sampled_from("+-*/^"), children, children),
        children.map(Negative),
        st.sampled_from(sorted(FUNCTIONS)).flatmap(
            lambda f: st.lists(children, min_size=FUNCTIONS[f][0], max_size=FUNCTIONS[f][0]).map(
                lambda arguments: Call(f, tuple(arguments))
            )
        ),
    )


TREES: st.SearchStrategy[Node] = st.recursive(LEAVES, _grown, max_leaves=12)


@given(TREES)
def test_a_written_formula_reads_back_to_its_tree(tree: Node) -> None:
    assert parse(text(tree)) == tree


@pytest.mark.parametrize(
    ("formula", "written"),
    [
        ("(x - y) - z", "x - y - z"),
        ("x - (y - z)", "x - (y - z)"),
        ("x/(y*z)", "x/(y*z)"),
        ("(x^y)^z", "(x^y)^z"),
        ("x^(y^z)", "x^y^z"),
        ("(-x)^2", "(-x)^2"),
        ("x^-1", "x^(-1)"),
        ("-(x + y)", "-(x + y)"),
        ("-(x*y)", "-(x*y)"),
        ("(-x)*y", "-x*y"),
        ("((x))*1.50", "x*1.5"),
        ("theta12 + α2 - b_1", "θ12 + α2 - b_1"),
        ("sqrt(  x+1 )", "sqrt(x + 1)"),
        ("1e-9*x", "1e-09*x"),
    ],
)
def test_a_formula_is_written_with_as_few_parentheses_as_it_needs(
    formula: str, written: str
) -> None:
    assert text(parse(formula)) == written
