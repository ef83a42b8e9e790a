"""The closure equations of a mechanism in symbolic form, for display and compilation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from linkwork.core.expression.derivatives import Jet, evaluate, evaluate_by
from linkwork.core.expression.grammar import CONSTANTS, parse
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode, names_in
from linkwork.core.expression.values import ENCLOSURES, Enclosure, Interval, check_real
from linkwork.core.foundation.arrays import Array, ComplexArray, FrozenDict
from linkwork.core.foundation.errors import ExpressionError, Problem, choices
from linkwork.core.foundation.lanes import display_value, phase as phase_of
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.mechanism.description import Problems
from linkwork.core.results.quantities.registry import row_quantity
from linkwork.core.results.quantity import Kind
from linkwork.core.table.rows import Piecewise


@dataclass(frozen=True, kw_only=True)
class Variable:
    """An unknown or input.

    ``symbol`` is its canonical name in formulas and terms; ``shown`` its name in printed equations
    (θ with the link's name for a link's angle).
    """

    name: str
    kind: str  # angle | length | number
    symbol: str
    shown: str = ""

    def __post_init__(self) -> None:
        if not self.shown:
            object.__setattr__(self, "shown", self.symbol)


@dataclass(frozen=True, kw_only=True)
class Term:
    """``sign · magnitude · s · exp(i (Σ weight θ + turn))``.

    ``value`` is sign · magnitude · exp(i turn) as a number; ``magnitude`` is the displayed form,
    ``None`` for 1. ``length`` names a variable length, ``phase`` variable angles with weights.
    """

    value: complex
    magnitude: Node | None = None
    sign: int = 1
    turn: float = 0.0
    length: str | None = None
    phase: tuple[tuple[str, float], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The symbols of its variables: the length first, then those of the phase."""
        own = () if self.length is None else (self.length,)
        return (*own, *(name for name, _ in self.phase))

    def negated(self) -> Term:
        """The term with the opposite sign."""
        return replace(self, value=-self.value, sign=-self.sign)

    @classmethod
    def vector(
        cls,
        z: complex,
        shown: Node | None,
        length: str | None = None,
        phase: tuple[tuple[str, float], ...] = (),
    ) -> Term:
        """A fixed vector in a rotating frame: modulus displayed as ``shown``, direction as turn."""
        seen = display_value(z)
        turn = phase_of(seen) if seen else 0.0
        sign = 1
        if turn > np.pi / 2 + 1e-12 or turn < -np.pi / 2 + 1e-12:
            sign, turn = -1, phase_of(-seen)
        if abs(turn) < 1e-15:
            turn = 0.0
        return cls(value=z, magnitude=shown, sign=sign, turn=turn, length=length, phase=phase)


@dataclass(frozen=True, kw_only=True)
class LoopEquation:
    """A closed vector loop: the sum of ``left`` equals the sum of ``right``."""

    label: str
    left: tuple[Term, ...]
    right: tuple[Term, ...]

    @property
    def terms(self) -> tuple[Term, ...]:
        """Left minus right."""
        return self.left + tuple(term.negated() for term in self.right)


@dataclass(frozen=True, kw_only=True)
class LinearEquation:
    """Σ weight · variable + constant = 0; angles in radians.

    ``kind`` of its residual: angle or length.
    """

    label: str
    terms: tuple[tuple[str, float], ...]
    constant: float
    kind: str = "angle"


@dataclass(frozen=True, kw_only=True, eq=False)
class LawEquation:
    """Σ weight · variable + constant - f(Σ weight · variable + offset) = 0; angles in radians.

    ``shown`` is the name of the function in printed equations, ``primes`` the order of its
    derivative, ``meaning`` its description; ``kind`` of the residual: length or angle. ``error``:
    how far f may be from the function of the file.
    """

    label: str
    terms: tuple[tuple[str, float], ...]
    constant: float
    law: Piecewise
    shown: str
    inner: tuple[tuple[str, float], ...]
    offset: float
    meaning: str = ""
    primes: int = 0
    kind: str = "length"
    error: float = 0.0


@dataclass(frozen=True, kw_only=True)
class RealEquation:
    """A plain equation ``left = right`` in named variables."""

    label: str
    left: Node
    right: Node


@dataclass(frozen=True, kw_only=True)
class PointPath:
    """A point: its ``parent`` point's position (the origin if ``None``) plus terms."""

    parent: str | None
    terms: tuple[Term, ...]


@dataclass(frozen=True, kw_only=True)
class LinkAngle:
    """The angle of a link: a variable (or none) plus a constant [rad]."""

    variable: str | None
    constant: float


@dataclass(frozen=True)
class MeasuredInPart:
    """A number of a part that is not given and follows from the sketch [rad] or [length].

    ``kind``: angle or length.
    """

    part: str
    quantity: str
    value: float
    kind: str


@dataclass(frozen=True, kw_only=True)
class Redundant:
    """A redundant condition: a link's length is an unknown and must equal its given value.

    ``variable`` names the unknown, ``length`` is the given distance of the two points.
    """

    variable: str
    link: str
    points: tuple[str, str]
    length: float


@dataclass(frozen=True, kw_only=True)
class Output:
    """A named formula; ``kind`` of its value: angle, length or number."""

    formula: Node
    kind: str


@dataclass(frozen=True, kw_only=True)
class LoopEquations:
    """All equations of a mechanism, and the definitions of its results.

    Parameters
    ----------
    unknowns, inputs : tuple of Variable
    loops, linear, real, laws : equations
        Complex loops; linear relations; plain real equations; laws of cams and curves.
    symbols : Mapping[str, float]
        Values of the fixed lengths and dimensions in use, by canonical name.
    dimensions : Mapping[str, float]
        All named dimensions, for outputs.
    start : (N,)
        Guess of the unknowns, then its input values; angles in radians.
    points : Mapping[str, PointPath]
        Parents come before their children.
    links : Mapping[str, LinkAngle]
    sliders : Mapping[str, str]
        Name of slider, slot or cylinder → variable.
    outputs : Mapping[str, Output]
    redundant : tuple of Redundant
        Conditions that the others must imply, if there are too many (``surplus``).
    outlines : Mapping[str, (body, point, (K,) complex)]
        Cams and curves by name: points about a point of a body, in that body's frame.
    measured : tuple of MeasuredInPart
        What the sketch gives of parts.
    fixed : tuple of str
        Points on ground.
    length_scale : float
        The longest link, the reference for relative lengths.
    """

    angle: AngleUnit
    unknowns: tuple[Variable, ...]
    inputs: tuple[Variable, ...]
    loops: tuple[LoopEquation, ...] = ()
    linear: tuple[LinearEquation, ...] = ()
    real: tuple[RealEquation, ...] = ()
    laws: tuple[LawEquation, ...] = ()
    symbols: Mapping[str, float] = FrozenDict()
    dimensions: Mapping[str, float] = FrozenDict()
    start: Array
    points: Mapping[str, PointPath] = FrozenDict()
    links: Mapping[str, LinkAngle] = FrozenDict()
    sliders: Mapping[str, str] = FrozenDict()
    outputs: Mapping[str, Output] = FrozenDict()
    redundant: tuple[Redundant, ...] = ()
    surplus: Problem | None = None
    outlines: Mapping[str, tuple[str, str, ComplexArray]] = FrozenDict()
    measured: tuple[MeasuredInPart, ...] = ()
    fixed: tuple[str, ...] = ()
    length_scale: float = 1.0

    def mapped(self, change: Callable[[Any], Any]) -> LoopEquations:
        """The same equations, each of whose coefficients is changed."""

        def terms(own: tuple[Term, ...]) -> tuple[Term, ...]:
            return tuple(replace(term, value=change(term.value)) for term in own)

        return replace(
            self,
            loops=tuple(
                replace(loop, left=terms(loop.left), right=terms(loop.right)) for loop in self.loops
            ),
            linear=tuple(replace(line, constant=change(line.constant)) for line in self.linear),
            symbols={name: change(number) for name, number in self.symbols.items()},
            dimensions={name: change(number) for name, number in self.dimensions.items()},
            points={
                name: replace(path, terms=terms(path.terms)) for name, path in self.points.items()
            },
            links={
                name: replace(link, constant=change(link.constant))
                for name, link in self.links.items()
            },
            redundant=tuple(replace(part, length=change(part.length)) for part in self.redundant),
        )

    @property
    def variables(self) -> tuple[Variable, ...]:
        """Unknowns, then inputs."""
        return self.unknowns + self.inputs

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of all equations: loops, linear, real, laws."""
        named: tuple[LoopEquation | LinearEquation | RealEquation | LawEquation, ...] = (
            *self.loops,
            *self.linear,
            *self.real,
            *self.laws,
        )
        return tuple(equation.label for equation in named)


# ----------------------------------------------------------------------
# Plain real equations as rows of a loop table, differentiated by jets.


@dataclass(frozen=True, kw_only=True)
class FormulaRow:
    """left - right = 0 over a few variables given by name and index."""

    left: Node
    right: Node
    names: tuple[str, ...]
    variables: tuple[int, ...]
    constants: tuple[tuple[str, float], ...]
    unit: AngleUnit

    def moved(self, new_index: dict[int, int]) -> FormulaRow:
        """The same row over renumbered variables."""
        return replace(self, variables=tuple(new_index[k] for k in self.variables))

    def _jet(self, v: Array, d: Array) -> Jet:
        zero = np.zeros(len(v))
        names = {
            name: Jet(v[:, k], d[:, k], zero)
            for name, k in zip(self.names, self.variables, strict=True)
        }
        names |= {name: Jet.constant(value) for name, value in self.constants}
        with np.errstate(all="ignore"):
            jet = evaluate(self.left, names, self.unit) - evaluate(self.right, names, self.unit)
        return Jet(*(np.broadcast_to(part, len(v)) for part in (jet.v, jet.d1, jet.d2)))

    def value_and_gradient(self, v: Array) -> tuple[Array, Array]:
        """Value (B,) and derivatives with respect to ``variables`` (B, k)."""
        gradient = np.zeros((len(v), len(self.variables)))
        value = np.zeros(len(v))
        for column, k in enumerate(self.variables):
            direction = np.zeros_like(v)
            # one jet along each variable gives its column of the gradient
            direction[:, k] = 1.0
            jet = self._jet(v, direction)
            value, gradient[:, column] = jet.v, jet.d1
        return value, gradient

    def second_directional_derivative(self, v: Array, d: Array) -> Array:
        """Second derivative along d, (B,)."""
        return self._jet(v, d).d2

    def repeats_after(self, turns: Array) -> bool:
        """Whether the formula is unaffected by whole turns (k,), as far as known."""
        return not turns.any()

    def enclosure(self, v: Array, box: Array) -> tuple[Array, Array]:
        """Lowest and highest value (2, L), and derivatives (2, L, k), over boxes around v (L, N)
        with half widths ``box`` (L, N).
        """
        names: dict[str, Enclosure] = {}
        for place, (name, k) in enumerate(zip(self.names, self.variables, strict=True)):
            way = np.eye(len(self.variables))[:, place, None]
            own = Interval(v[:, k], v[:, k]) + Interval(-box[:, k], box[:, k])
            # without a width a variable has its value exactly
            exact = box[:, k] == 0.0
            own = Interval(np.where(exact, v[:, k], own.low), np.where(exact, v[:, k], own.high))
            names[name] = Enclosure(own, Interval(way, way))
        for name, number in self.constants:
            # dimensions may be results of formulas
            whole = float(number).is_integer()
            names[name] = (ENCLOSURES.literal if whole else ENCLOSURES.rounded)(number)
        with np.errstate(all="ignore"):
            left, right = (
                evaluate_by(ENCLOSURES, side, names, self.unit) for side in (self.left, self.right)
            )
            found = left - right
        shape = len(self.variables), len(v)
        value = [np.broadcast_to(end, len(v)) for end in (found.v.low, found.v.high)]
        slopes = [np.broadcast_to(end, shape).T for end in (found.d.low, found.d.high)]
        return np.stack(value), np.stack(slopes)


# ----------------------------------------------------------------------
# Named outputs: formulas of unknowns, dimensions and point coordinates, and their kinds.


def read_outputs(
    formulas: Mapping[str, str],
    kinds: Mapping[str, str],
    points: Mapping[str, object],
    dimensions: Mapping[str, float],
    problems: Problems,
) -> dict[str, Output]:
    """Parse the outputs.

    Parameters
    ----------
    kinds : Mapping[str, str]
        The kind of every usable name, by canonical name.
    points : Mapping
        Points by name; ``A.x`` and ``A.y`` can be used too.

    Notes
    -----
    Names such as ``B.transmission`` are recognised by their last part; whether B has this quantity
    is checked when the mechanism is complete.
    """
    coordinates = {canonical(f"{p}.{axis}"): "length" for p in points for axis in "xy"}
    known = {**dict.fromkeys(dimensions, "number"), **kinds, **coordinates}
    found: dict[str, Output] = {}
    for name, formula in formulas.items():
        try:
            tree = parse(formula)
            known |= _derived(tree, known)
            _check_names(tree, known, formula)
        except ExpressionError as error:
            problems.add(("outputs", name), str(error))
            continue
        found[name] = Output(formula=tree, kind=_kind(tree, known.__getitem__))
    return found


def _derived(tree: Node, known: Mapping[str, str]) -> dict[str, str]:
    """Kinds of the names in a formula that are quantities of the registry."""
    rows = {node.name: row_quantity(node.name) for node in names_in(tree) if node.name not in known}
    kinds = {name: row.kind for name, row in rows.items() if row is not None}
    plain = (Kind.ANGLE, Kind.LENGTH)
    return {name: (k if k in plain else Kind.NUMBER).value for name, k in kinds.items()}


def _check_names(tree: Node, known: Mapping[str, str], text: str) -> None:
    for node in names_in(tree):
        if node.name not in known and node.name not in CONSTANTS:
            raise ExpressionError(
                f'column {node.column}: "{node.spelling}" is not defined '
                f"{choices('names', known, node.name)}",
                text,
                node.column,
            )
    check_real(tree, text, "an output")


def _kind(tree: Node, kind_of: Callable[[str], str]) -> str:
    """Angle, length or number, as far as the formula determines it."""
    match tree:
        case NumberNode():
            return "number"
        case Name():
            return "number" if tree.name in CONSTANTS else kind_of(tree.name)
        case Negative():
            return _kind(tree.operand, kind_of)
        case Call("atan2" | "atan" | "asin" | "acos"):
            return "angle"
        case Call("abs" | "hypot" | "min" | "max"):
            found = {_kind(argument, kind_of) for argument in tree.arguments} - {"number"}
            return found.pop() if len(found) == 1 else "number"
        case Call():
            return "number"
        case Binary("+" | "-"):
            kinds = {_kind(tree.left, kind_of), _kind(tree.right, kind_of)} - {"number"}
            return kinds.pop() if len(kinds) == 1 else "number"
        case Binary("*" | "/"):
            left, right = _kind(tree.left, kind_of), _kind(tree.right, kind_of)
            if right == "number":
                return left
            return right if left == "number" and tree.operator == "*" else "number"
        case Binary():
            return "number"
