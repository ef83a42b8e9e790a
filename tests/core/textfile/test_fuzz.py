"""Whatever comes in, only the package's own errors come out."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Callable
from functools import partial

from hypothesis import given, settings, strategies as st

from linkwork.core.expression.grammar import FUNCTIONS, parse, parse_equation
from linkwork.core.expression.tree import (
    Binary,
    Call,
    Name,
    Negative,
    Node,
    NumberNode,
    text as written,
)
from linkwork.core.expression.values import value
from linkwork.core.foundation.errors import ExpressionError, LinkworkError
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.textfile import read_bytes, read_text
from tests.core.textfile.samples import SAMPLES

TOML_PIECES = [
    "[", "]", "[[", "]]", "{", "}", "=", ",", ".", '"', "'", '"""', "'''", "\\", "\n", "\r\n",
    "#", "\0", "\ufeff", " ", "true", "nan", "inf", "-1", "0", "1e999", "0x" + "f" * 300,
    "1979-05-27", "07:32:00", "format = 1", "[points]", "[links]", "[lengths]", "[[input]]",
    "[input]", "[guess]", "[loops]", "[equations]", "[dimensions]", "A", "B", "ground", "θ", "i",
    "e^(i*θ)", "x = ", "[]", "{}", '""', '"A"', '"A B"', "[0, 0]", "a = 1", '"1/0"',
    '"2^2^2^2^2^2"', "-40", "1e308", "5e-324",
]  # fmt: skip
SIGNS = [
    *"0123456789.,+-*/^()=' eEiπθ₁²√·−", "**", "sin", "atan2", "sqrt", "min(", "cis", "theta",
    "A.x", "e", "pi", "1e9", "1e308", "__", "½",
]  # fmt: skip
ODD_VALUES = [
    "0", "-1", "1e308", "-1e308", "5e-324", "1e100", "nan", "true", '""', '"x"', '"A"', '"1/0"',
    "[]", "{}", "[1, 2]", '["A", "B"]', '["A"]', "[[]]", "[{}]", "1979-05-27", '"1e308*10"',
    "[1e100, -1e100]", "[5e-324, 0]", "[0, 0]", "1" + "0" * 350, '"-0"', '"1e-300"', "1e-100",
]  # fmt: skip


def refusal(call: Callable[[], object]) -> LinkworkError | None:
    """The reason for which a call is refused; any other exception fails the test."""
    try:
        call()
    except LinkworkError as error:
        return error
    return None


def is_read_or_refused(call: Callable[[], object]) -> bool:
    """Whether a call succeeds, or is refused with some words."""
    error = refusal(call)
    return error is None or bool(str(error).strip())


@given(st.binary(max_size=300))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    assert is_read_or_refused(lambda: read_bytes(data))


@given(st.text(max_size=200) | st.lists(st.sampled_from(TOML_PIECES), max_size=40).map("".join))
def test_any_text_is_read_or_refused(text: str) -> None:
    assert is_read_or_refused(lambda: read_text(text))
    assert is_read_or_refused(lambda: read_text("format = 1\n" + text))


@settings(max_examples=200)
@given(st.data())
def test_a_file_with_mistakes_is_read_or_refused(data: st.DataObject) -> None:
    text = data.draw(st.sampled_from(sorted(SAMPLES.values())))
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(text)))
        end = min(len(text), start + data.draw(st.sampled_from([0, 0, 1, 2, 5, 20, 100])))
        text = text[:start] + data.draw(st.sampled_from(["", *TOML_PIECES, *SIGNS])) + text[end:]
    assert is_read_or_refused(lambda: read_text(text))


@settings(max_examples=200)
@given(st.data())
def test_a_file_with_other_values_is_read_or_refused(data: st.DataObject) -> None:
    """Every value of a right file is exchanged for one that TOML allows."""
    rows = data.draw(st.sampled_from(sorted(SAMPLES.values()))).split("\n")
    odd = st.sampled_from(ODD_VALUES)
    assignments = [k for k, row in enumerate(rows) if " = " in row and not row.startswith("format")]
    for k in data.draw(st.lists(st.sampled_from(assignments), min_size=1, max_size=5)):
        rows[k] = rows[k].split(" = ")[0] + " = " + data.draw(odd)
    assert is_read_or_refused(lambda: read_text("\n".join(rows)))


def is_formula(formula: str) -> bool:
    return refusal(partial(parse, formula)) is None


formulas = st.text(max_size=60) | st.lists(st.sampled_from(SIGNS), max_size=30).map("".join)


@given(formulas)
def test_any_formula_is_read_or_refused_with_its_column(formula: str) -> None:
    for read in (parse, parse_equation):
        error = refusal(partial(read, formula))
        if error is not None:
            assert isinstance(error, ExpressionError)
            assert 1 <= error.column <= len(formula) + 1
            assert error.marked()


@given(st.lists(st.sampled_from(["(", "-", "sin(", "2^", "1+", "√", "abs(-"]), max_size=2000))
def test_deep_formulas_are_read_or_refused(pieces: list[str]) -> None:
    assert is_read_or_refused(lambda: parse("".join(pieces) + "1" + ")" * 40))


numbers = st.one_of(
    st.integers(0, 10**9).map(float),
    st.floats(0, 1e300).map(lambda x: float(f"{x:.12g}")),  # formulas are shown with 12 digits
).map(abs)
names = st.sampled_from(["a", "theta12", "s16", "A.x", "x'", "mu", "alpha_b", "pi", "e", "i"])


def compound(inner: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    calls = st.sampled_from(sorted(FUNCTIONS)).flatmap(
        lambda f: st.lists(inner, min_size=FUNCTIONS[f][0], max_size=FUNCTIONS[f][1]).map(
            lambda arguments: Call(f, tuple(arguments))
        )
    )
    binaries = st.builds(Binary, st.sampled_from("+-*/^"), inner, inner)
    negatives = st.builds(Negative, inner.filter(lambda node: not is_product(node)))
    return binaries | calls | negatives


def is_product(node: Node) -> bool:
    """``-(a*b)`` is written ``-a*b``, which reads as ``(-a)*b``: equal, but another tree."""
    return isinstance(node, Binary) and node.operator in "*/"


trees: st.SearchStrategy[Node] = st.recursive(
    st.builds(NumberNode, numbers) | st.builds(lambda n: Name(n, n), names), compound, max_leaves=12
)


@given(trees)
def test_a_formula_that_was_written_reads_back_as_the_same_tree(tree: Node) -> None:
    assert parse(written(tree)) == tree
    assert parse_equation(f"{written(tree)} = {written(tree)}") == (tree, tree)


@given(trees | formulas.filter(is_formula).map(parse), st.sampled_from(AngleUnit))
def test_a_formula_has_a_finite_value_or_a_reason(tree: Node, unit: AngleUnit) -> None:
    known = dict.fromkeys(("a", "theta12", "s16", "A.x", "x'", "mu", "alpha_b", "_"), 1.5)
    found: list[float] = []
    error = refusal(lambda: found.append(value(tree, known, unit)))
    assert all(map(math.isfinite, found))
    assert found or isinstance(error, ExpressionError)


def test_reading_imports_neither_the_writer_s_nor_the_schema_s_packages() -> None:
    code = (
        "import sys, linkwork.core.textfile; "
        "print(sorted({'tomlkit', 'jsonschema', 'scipy', 'hypothesis'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
