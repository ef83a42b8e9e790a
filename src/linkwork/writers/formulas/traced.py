"""Real numbers with formulas: sums of weighted terms, simplified as they are built.

A term is a formula without a numerical factor. Functions use radians; ``radians`` and ``degrees``
are functions too, because cells contain angles in the file's unit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from linkwork.core.equations.model import LoopEquations
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode, names_in
from linkwork.core.expression.values import FUNCTIONS, least, most
from linkwork.core.foundation.arrays import AnyArray
from linkwork.core.foundation.lanes import (
    Arithmetic,
    Consensus,
    Lanes,
    NotElementwise,
    Operand,
    Truths,
    remainders,
    with_parts,
)
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.varied_numbers import VariedNumber, varied_numbers, with_numbers
from linkwork.families.building import write_equations

_DEGREE = math.pi / 180.0
_SHORT = 1e-13  # relative: nearer factors are rounded to a short number


class _FormArithmetic(Arithmetic["LinearForm"]):
    """Takes numbers out of products, and common factors out of quotients."""

    def plain(self, number: float) -> LinearForm:
        """A number."""
        return LinearForm(number)

    def add(self, x: LinearForm, y: LinearForm) -> LinearForm:
        """x + y, like terms joined."""
        weights = dict(x.terms)
        for node, weight in y.terms:
            weights[node] = weights.get(node, 0.0) + weight
        kept = tuple((node, weight) for node, weight in weights.items() if weight)
        return LinearForm(x.constant + y.constant, kept)

    def negate(self, x: LinearForm) -> LinearForm:
        """-x."""
        return _weigh(x, -1.0)

    def multiply(self, x: LinearForm, y: LinearForm) -> LinearForm:
        """x y."""
        if y.fixed:
            return _weigh(x, y.constant)
        if x.fixed:
            return _weigh(y, x.constant)
        (left, one), (right, other) = _factored(x), _factored(y)
        node = Binary("^", left, NumberNode(2.0)) if left == right else _product(left, right)
        return _weigh(LinearForm.of(node), one * other)

    def divide(self, x: LinearForm, y: LinearForm) -> LinearForm:
        """x / y."""
        if y.fixed:
            return _weigh(x, 1.0 / y.constant)
        if x.zero:
            return x
        below, weight = _factored(y)
        reduced = [_without(node, below) for node, _ in x.terms]
        if not x.constant and None not in reduced:
            parts = zip(reduced, x.terms, strict=True)
            return sum(
                (_weigh(form, top / weight) for form, (_, top) in parts if form is not None),
                LinearForm(),
            )
        above, top = _factored(x)
        return _weigh(LinearForm.of(Binary("/", above, below)), top / weight)


@dataclass(frozen=True)
class LinearForm(Operand):
    """``Σ weight · term + constant``; terms differ and no weight is 0."""

    arithmetic = _FormArithmetic()
    constant: float = 0.0
    terms: tuple[tuple[Node, float], ...] = ()

    @classmethod
    def of(cls, node: Node) -> LinearForm:
        """A form with one term."""
        return cls(0.0, ((node, 1.0),))

    @classmethod
    def named(cls, name: str) -> LinearForm:
        """A form with the value of a cell, by key."""
        return cls.of(Name(name))

    @property
    def fixed(self) -> bool:
        """Whether it is a constant."""
        return not self.terms

    @property
    def zero(self) -> bool:
        """Whether it is the number 0."""
        return not self.terms and self.constant == 0.0

    @property
    def single(self) -> tuple[Node, float] | None:
        """Its only term with its weight; ``None`` for a sum and for a number."""
        return self.terms[0] if len(self.terms) == 1 and self.constant == 0.0 else None

    @property
    def node(self) -> Node:
        """The formula, a positive term first if there is one."""
        ordered = sorted(self.terms, key=lambda part: part[1] < 0.0)
        parts = [(weight < 0.0, _weighted(node, abs(weight))) for node, weight in ordered]
        if self.constant or not parts:
            constant = (self.constant < 0.0, NumberNode(abs(self.constant)))
            first = bool(parts) and parts[0][0] and not constant[0]
            parts = [constant, *parts] if first else [*parts, constant]
        minus, total = parts[0]
        total = Negative(total) if minus else total
        for minus, part in parts[1:]:
            total = Binary("-" if minus else "+", total, part)
        return total

    def per(self, unit: float) -> LinearForm | None:
        """The form with all numbers divided by a unit, if the results are short numbers."""
        weights = [_short(weight / unit) for _, weight in self.terms]
        constant = _short(self.constant / unit)
        if constant is None or None in weights:
            return None
        nodes = (node for node, _ in self.terms)
        kept = ((n, w) for n, w in zip(nodes, weights, strict=True) if w is not None)
        return LinearForm(constant, tuple(kept))

    @property
    def angle(self) -> Node:
        """The formula of an angle in radians; ``radians(…)`` if it is shorter in degrees."""
        turned = self.per(1.0 / _DEGREE)
        if turned is not None and not self.fixed:
            return Call("degrees", (turned.node,))
        in_degrees = [(n, d) for n, w in self.terms if (d := _short(w / _DEGREE)) is not None]
        if not in_degrees:
            return self.node
        rest = tuple((n, w) for n, w in self.terms if _short(w / _DEGREE) is None)
        constant = _short(self.constant / _DEGREE)
        in_file_unit = LinearForm(constant or 0.0, tuple(in_degrees))
        converted = LinearForm.of(Call("radians", (in_file_unit.node,)))
        return (converted + LinearForm(self.constant if constant is None else 0.0, rest)).node

    @property
    def in_degrees(self) -> Node:
        """The formula in degrees of an angle in radians."""
        in_file_unit = self.per(_DEGREE)
        return Call("degrees", (self.angle,)) if in_file_unit is None else in_file_unit.node


def form_of(node: Node) -> LinearForm:
    """A formula as a form: signs, sums and numerical factors are read."""
    match node:
        case NumberNode():
            return LinearForm(node.value)
        case Negative():
            return -form_of(node.operand)
        case Binary("+"):
            return form_of(node.left) + form_of(node.right)
        case Binary("-"):
            return form_of(node.left) - form_of(node.right)
        case Binary("*", NumberNode(weight), part):
            return form_of(part) * weight
        case _:
            return LinearForm.of(node)


def in_radians(form: LinearForm) -> LinearForm:
    """A form in degrees, with all numbers divided by 180/π; factors like 1 are exact."""
    terms = tuple((node, _short(w * _DEGREE) or w * _DEGREE) for node, w in form.terms)
    return LinearForm(form.constant * _DEGREE, terms)


def _product(left: Node, right: Node) -> Node:
    """left · right, factor by factor from the left."""
    if isinstance(right, Binary) and right.operator == "*":
        return Binary("*", _product(left, right.left), right.right)
    if isinstance(left, Binary) and left.operator == "*" and left.right == right:
        return Binary("*", left.left, Binary("^", right, NumberNode(2.0)))
    return Binary("*", left, right)


def _weigh(form: LinearForm, factor: float) -> LinearForm:
    if factor == 0.0:
        return LinearForm()
    scaled = tuple((node, weight * factor) for node, weight in form.terms)
    return LinearForm(form.constant * factor, scaled)


def _weighted(node: Node, weight: float) -> Node:
    return node if weight == 1.0 else Binary("*", NumberNode(weight), node)


def _short(number: float) -> float | None:
    near = float(f"{number:.9g}")
    return near if abs(number - near) <= _SHORT * abs(number) else None


def _factored(form: LinearForm) -> tuple[Node, float]:
    return form.single or (form.node, 1.0)


def _without(node: Node, factor: Node) -> LinearForm | None:
    """A term without a factor; ``None`` if it does not contain the factor."""
    if node == factor:
        return LinearForm(1.0)
    match node:
        case Binary("*"):
            for side, other in ((node.left, node.right), (node.right, node.left)):
                if side == factor:
                    return LinearForm.of(other)
        case Binary("^") if node.left == factor and node.right == NumberNode(2.0):
            return LinearForm.of(factor)
    return None


def call(function: str, *arguments: LinearForm) -> LinearForm:
    """A function of forms."""
    return LinearForm.of(Call(function, tuple(argument.node for argument in arguments)))


def cosine(angle: LinearForm) -> LinearForm:
    """cos of an angle in radians."""
    if angle.fixed:
        return LinearForm(math.cos(angle.constant))
    return LinearForm.of(Call("cos", (angle.angle,)))


def sine(angle: LinearForm) -> LinearForm:
    """sin of an angle in radians."""
    if angle.fixed:
        return LinearForm(math.sin(angle.constant))
    return LinearForm.of(Call("sin", (angle.angle,)))


# ----------------------------------------------------------------------
# A number that records its formula while the equations are built from it.
#
# The builder of a mechanism's equations computes with floats and complex numbers. A traced number
# passes through it as :class:`~linkwork.core.foundation.lanes.Lanes` of one design do, and knows
# afterwards by which formula it follows from the dimensions. Decisions are taken by its value:
# which way round a link is, in which half turn an angle lies.


Formula = Callable[..., "TracedNumber"]

_ZERO = LinearForm()
_EQUAL_VALUES = 1e-15  # two formulas of one number may differ by this: a few roundings


class Trace(Consensus):
    """What the traced numbers of one mechanism have in common.

    Attributes
    ----------
    settled : dict of Node
        Formulas that had to become plain numbers, as ratios of teeth.
    angles : dict
        Angles by which something was turned, by how they are written: form and value.
    """

    def __init__(self) -> None:
        super().__init__(1, widest=True)
        self.settled: dict[Node, None] = {}
        self.angles: dict[Node, tuple[LinearForm, float]] = {}

    def number(self, value: float, form: LinearForm) -> float:
        """A real number with its formula."""
        return cast(float, self.make([value], form))

    def make(self, values: Any, re: LinearForm, im: LinearForm = _ZERO) -> TracedNumber:
        """A number, values (1,), with the formulas of its parts."""
        return TracedNumber(np.asarray(values), self, re, im)

    def plain(self, number: complex) -> TracedNumber:
        """A plain number; its formula is the number."""
        z = complex(number)
        return self.make([number], LinearForm(z.real), LinearForm(z.imag))

    def pick(self, truths: Truths, yes: complex, no: complex) -> TracedNumber:
        """One of two plain numbers."""
        return self.plain(yes if truths.values[0] else no)

    def settle(self, number: TracedNumber) -> Any:
        """The plain number, which is recorded as settled."""
        if not number.re.fixed:
            self.settled[number.re.node] = None
        return super().settle(number)

    def value_of(self, number: TracedNumber) -> Any:
        """The number with its formula; code that needs a plain number refuses it later."""
        return number

    def estimate(self, number: Any) -> Any:
        """The number without its formula."""
        return self.value_in(number, 0)

    def apply(self, function: Callable[..., Any], *numbers: object) -> TracedNumber:
        """A function for which there is a formula."""
        if function is np.where:
            return self._choose(*numbers)
        if function not in _FORMULAS:
            raise NotElementwise
        operands = [self.operand(number) for number in numbers]
        values = function(*(number.values for number in operands))
        return _FORMULAS[function](self, values, *operands)

    def _choose(self, condition: object, yes: object, no: object) -> TracedNumber:
        """The number that holds by its value; where both are one, the one with a formula."""
        taken: TracedNumber = self.operand(yes)
        other: TracedNumber = self.operand(no)
        if not cast(Truths, condition):
            taken, other = other, taken
        plain = taken.re.fixed and taken.im.fixed
        same = abs(complex(taken.values[0]) - complex(other.values[0])) <= _EQUAL_VALUES
        return other if plain and same else taken

    def add(self, x: TracedNumber, y: TracedNumber) -> TracedNumber:
        """x + y."""
        return self.make(x.values + y.values, x.re + y.re, x.im + y.im)

    def negate(self, x: TracedNumber) -> TracedNumber:
        """-x."""
        return self.make(-x.values, -x.re, -x.im)

    def multiply(self, x: TracedNumber, y: TracedNumber) -> TracedNumber:
        """x y."""
        re, im = x.re * y.re - x.im * y.im, x.re * y.im + x.im * y.re
        return self.make(x.values * y.values, re, im)

    def divide(self, x: TracedNumber, y: TracedNumber) -> TracedNumber:
        """x / y."""
        if not y.im.zero:
            return x * y.conjugate() / (y * y.conjugate()).real
        return self.make(x.values / y.values, x.re / y.re, x.im / y.re)

    def power(self, x: TracedNumber, y: TracedNumber) -> TracedNumber:
        """x to the power y, both real."""
        if not (x.im.zero and y.im.zero):
            raise NotElementwise
        if y.re == LinearForm(2.0):
            return x * x
        power = Binary("^", x.re.node, y.re.node)
        return self.make(x.values**y.values, LinearForm.of(power))

    def absolute(self, x: TracedNumber) -> TracedNumber:
        """|x|."""
        return self.apply(np.abs, x)


class TracedNumber(Lanes):
    """A number with the formulas ``re`` and ``im`` of its parts."""

    __slots__ = ("im", "re")
    arithmetic: Trace

    def __init__(self, values: AnyArray, trace: Trace, re: LinearForm, im: LinearForm) -> None:
        super().__init__(values, trace)
        self.re, self.im = re, im


def _positive(form: LinearForm, value: AnyArray) -> LinearForm:
    """The size of a number that keeps its sign."""
    return -form if value[0] < 0.0 else form


def _turned(z: TracedNumber) -> Node | None:
    """The angle of cos x + i sin x."""
    match z.re.single, z.im.single:
        case (Call("cos", (x,)), 1.0), (Call("sin", (y,)), 1.0) if x == y:
            return x
    return None


# The formulas of functions: from the trace, the values, and the arguments


def _angle(trace: Trace, values: AnyArray, z: TracedNumber) -> TracedNumber:
    """The direction of a vector; of one that was turned, the angle by which."""
    turned = trace.angles.get(_turned(z) or NumberNode(0.0))
    if turned is not None:
        form, value = turned
        turns = round((float(values[0]) - value) / FULL_TURN)
        return trace.make(values, form + LinearForm(turns * FULL_TURN))
    if z.im.zero or (z.re.fixed and z.im.fixed):
        return trace.make(values, LinearForm(float(values[0])))
    return trace.make(values, call("atan2", z.im, z.re))


def _cosine(trace: Trace, values: AnyArray, angle: TracedNumber) -> TracedNumber:
    trace.angles[angle.re.angle] = (angle.re, float(angle.values[0]))
    return trace.make(values, cosine(angle.re))


def _sine(trace: Trace, values: AnyArray, angle: TracedNumber) -> TracedNumber:
    return trace.make(values, sine(angle.re))


def _tangent(trace: Trace, values: AnyArray, angle: TracedNumber) -> TracedNumber:
    return trace.make(values, LinearForm.of(Call("tan", (angle.re.angle,))))


def _vector(trace: Trace, values: AnyArray, x: TracedNumber, y: TracedNumber) -> TracedNumber:
    return trace.make(values, x.re, y.re)


def _root(trace: Trace, values: AnyArray, x: TracedNumber) -> TracedNumber:
    if x.re.fixed:
        return trace.make(values, LinearForm(float(values[0])))
    return trace.make(values, call("sqrt", x.re))


def _signed(trace: Trace, values: AnyArray, *_: TracedNumber) -> TracedNumber:
    return trace.make(values, LinearForm(float(values[0])))


def _reduced(trace: Trace, values: AnyArray, x: TracedNumber, *_: object) -> TracedNumber:
    return trace.make(values, x.re + LinearForm(float(values[0] - x.values[0])))


def _size(trace: Trace, values: AnyArray, x: TracedNumber) -> TracedNumber:
    if x.im.zero:
        return trace.make(values, _positive(x.re, x.values.real))
    if x.re.zero:
        return trace.make(values, _positive(x.im, x.values.imag))
    return trace.make(values, LinearForm(1.0) if _turned(x) else call("hypot", x.re, x.im))


def _conjugate(trace: Trace, values: AnyArray, x: TracedNumber) -> TracedNumber:
    return trace.make(values, x.re, -x.im)


def _real(trace: Trace, values: AnyArray, x: TracedNumber) -> TracedNumber:
    return trace.make(values, x.re)


def _imaginary(trace: Trace, values: AnyArray, x: TracedNumber) -> TracedNumber:
    return trace.make(values, x.im)


def _called(name: str) -> Formula:
    """A function that has the same name in formulas."""

    def made(trace: Trace, values: AnyArray, *arguments: TracedNumber) -> TracedNumber:
        if not all(argument.im.zero for argument in arguments):
            raise NotElementwise
        if all(argument.re.fixed for argument in arguments):
            return trace.make(values, LinearForm(float(values[0])))
        return trace.make(values, call(name, *(argument.re for argument in arguments)))

    return made


_FORMULAS: dict[Callable[..., Any], Formula] = {
    np.angle: _angle, np.cos: _cosine, np.sin: _sine, np.tan: _tangent, with_parts: _vector,
    np.sqrt: _root, np.copysign: _signed, np.rint: _signed, remainders: _reduced, np.abs: _size,
    np.conjugate: _conjugate, np.real: _real, np.imag: _imaginary,
    np.hypot: _called("hypot"), np.exp: _called("exp"), np.fmax: _called("max"),
    np.fmin: _called("min"), most: _called("max"), least: _called("min"),
    **{FUNCTIONS[x]: _called(x) for x in ("abs", "ln", "log10", "asin", "acos", "atan", "atan2")},
}  # fmt: skip


# ----------------------------------------------------------------------
# The equations of a mechanism with the formulas of their coefficients.


@dataclass(frozen=True, kw_only=True)
class Dimension:
    """A number of the mechanism's description with a cell.

    ``key`` is its name in formulas, ``kind`` its table in the file, ``formula`` its formula of
    other dimensions in the file, ``live`` whether the equations follow its cell.
    """

    key: str
    name: str
    kind: str
    value: float
    formula: Node | None
    live: bool


@dataclass(frozen=True, kw_only=True)
class TracedEquations:
    """Equations whose coefficients are traced numbers.

    ``settled``: keys of dimensions that had to be evaluated as numbers, such as gear ratios.
    """

    equations: LoopEquations
    dimensions: tuple[Dimension, ...]
    settled: tuple[str, ...]


def forms_of(z: object) -> tuple[LinearForm, LinearForm]:
    """The formulas of the real and imaginary part of a coefficient."""
    if isinstance(z, TracedNumber):
        return z.re, z.im
    assert isinstance(z, int | float | complex)
    plain = complex(z)
    return LinearForm(plain.real), LinearForm(plain.imag)


def traced(description: Description) -> TracedEquations:
    """The equations with all dimensions traced for which the builder has formulas."""
    plain = _without_tables(description)
    varied = list(_dimensions(description))
    live = varied
    built = _built(plain, live)
    if built is None:
        live = [q for q in varied if _built(plain, [q]) is not None]
        built = _built(plain, live)
    if built is None:
        live = []
        built = _built(plain, [])
    assert built is not None
    equations, trace = built
    used = {_key(q) for q in live}
    return TracedEquations(
        equations=equations,
        dimensions=tuple(_dimension(description, q, _key(q) in used) for q in varied),
        settled=tuple(dict.fromkeys(n.name for node in trace.settled for n in names_in(node))),
    )


def _without_tables(description: Description) -> Description:
    """The mechanism with plain input ranges, which are not part of the equations."""
    numbers = description.numbers

    def plain(number: Number | None) -> float | None:
        return None if number is None else numbers(number)

    inputs = tuple(
        replace(
            which,
            from_=plain(which.from_),
            to=plain(which.to),
            step=plain(which.step),
            speed=None,
        )
        for which in description.inputs
    )
    return replace(description, inputs=inputs)


def _dimensions(description: Description) -> Iterator[VariedNumber]:
    """All numbers with cells; ground lengths follow from its points."""
    ground = set(description.links[GROUND]) if isinstance(description, Linkage) else set()
    for quantity in varied_numbers(description):
        if quantity.table == "guess":
            continue
        if quantity.table in ("lengths", "angles"):
            if ground.issuperset(quantity.key.split()):
                continue
            if isinstance(_formula(description, quantity), Name):
                continue  # a named dimension
        yield quantity


def _key(quantity: VariedNumber) -> str:
    if quantity.table == "dimensions":
        return canonical(quantity.name)
    return f"{quantity.table} {quantity.name}"


def _formula(description: Description, quantity: VariedNumber) -> Node | None:
    written = quantity.written(description)
    return parse(written) if isinstance(written, str) else None


def _dimension(description: Description, quantity: VariedNumber, live: bool) -> Dimension:
    formula = _formula(description, quantity)
    return Dimension(
        key=_key(quantity),
        name=quantity.name,
        kind=quantity.table,
        value=float(quantity.of(description)),
        formula=formula,
        live=live,
    )


def _built(
    description: Description, varied: Sequence[VariedNumber]
) -> tuple[LoopEquations, Trace] | None:
    """The equations with these numbers traced; ``None`` if the builder has no formulas."""
    trace = Trace()
    numbers = {
        quantity: trace.number(quantity.of(description), LinearForm.named(_key(quantity)))
        for quantity in varied
    }
    try:
        with np.errstate(all="ignore"):
            return write_equations(with_numbers(description, numbers)), trace
    except NotElementwise:
        return None
