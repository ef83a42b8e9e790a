"""Solved rows, and the rows in which variables have finite derivatives."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self
from weakref import WeakKeyDictionary

import numpy as np

from linkwork.core.equations.compiling import Compiled
from linkwork.core.equations.model import LawEquation, LoopEquations, Term
from linkwork.core.expression.derivatives import Jet, evaluate
from linkwork.core.expression.tree import names_in
from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray, inverses
from linkwork.core.foundation.errors import InputError, LinkworkError, key_text
from linkwork.core.foundation.lanes import NotElementwise, chained, is_batched, vector
from linkwork.core.foundation.names import canonical
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.varied_numbers import (
    VariedNumber,
    number_named,
    varied_numbers,
    with_numbers,
)
from linkwork.core.motion.model import Model, leading_input, leading_speeds
from linkwork.core.motion.positions import LastAxis, QuantityValues, term_jet
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from linkwork.core.results.quantities.definition import Solved
from linkwork.design.derivatives.tape import Tape
from linkwork.families.building import write_equations


@dataclass(frozen=True, eq=False)
class RegularRows:
    """Solved rows: variables (B, N), which exist, and which have rates."""

    v: Array
    found: BoolArray
    regular: BoolArray

    @property
    def differentiable(self) -> Array:
        """The variables, NaN in rows without a derivative, which would spoil inverses of others."""
        return np.where((self.found & self.regular)[:, None], self.v, np.nan)

    def take(self, order: IndexArray) -> RegularRows:
        """Rows in another order."""
        return RegularRows(self.v[order], self.found[order], self.regular[order])


def row_of(model: Model, position: Position) -> RegularRows:
    """One position as a row."""
    v = np.append(position.q, np.array([*position.input.values()]) * model.input_scale)[None, :]
    solved = np.array([position.status.ok])
    return RegularRows(v, solved, _rates_exist(model, position, 1))


def rows_of(model: Model, motion: Motion, *further: Motion) -> RegularRows:
    """The rows of a motion, and those of further ones behind them."""
    parts = (motion, *further)
    v = [
        np.column_stack(
            [each.q, *(each.inputs[x.name] * s for x, s in zip(
                model.equations.inputs, model.input_scale, strict=True))]
        )
        for each in parts
    ]  # fmt: skip
    solved = np.concatenate([each.found for each in parts])
    regular = np.concatenate([_rates_exist(model, each, len(each)) for each in parts])
    return RegularRows(np.concatenate(v), solved, regular)


def _rates_exist(model: Model, solved: Solved, count: int) -> BoolArray:
    """Where the unknowns have derivatives by the input."""
    exist = np.ones(count, dtype=bool)
    if model.equations.inputs:
        for unknown in model.motion_quantities.names.unknowns:
            exist &= np.isfinite(np.atleast_1d(solved.own(unknown).d1))
    return exist


# ----------------------------------------------------------------------
# The numbers of a mechanism by which its quantities have derivatives.


#: Reasons by compiled equations, and by number.
_REFUSED: WeakKeyDictionary[Compiled, dict[VariedNumber, str]] = WeakKeyDictionary()


def chosen_numbers(
    model: Model, by: Iterable[str] | None
) -> tuple[tuple[VariedNumber, ...], dict[str, str]]:
    """The requested numbers, or all plain numbers of the file; and why other ones cannot vary.

    Raises
    ------
    UnknownNameError
        For a name of no number.
    InputError
        For a number that cannot vary, or that is named twice.
    """
    description = model.description
    if by is not None:
        names = (by,) if isinstance(by, str) else tuple(by)
        numbers = tuple(number_named(description, name) for name in names)
        reasons = _refusals(model, numbers)
        for k, (name, number) in enumerate(zip(names, numbers, strict=True)):
            if number in numbers[:k]:
                raise InputError(f'"{name}" is named twice: give each number once')
            if reasons[number]:
                raise InputError(f'"{name}" cannot vary: {reasons[number]}')
        return numbers, {}
    # the value of a formula follows from its numbers; a guess changes no position
    plain = [
        number
        for number in varied_numbers(description)
        if number.table != "guess" and not isinstance(number.written(description), str)
    ]
    reasons = _refusals(model, plain)
    refused = {number.name: reasons[number] for number in plain if reasons[number]}
    return tuple(number for number in plain if not reasons[number]), refused


def _refusals(model: Model, numbers: Sequence[VariedNumber]) -> dict[VariedNumber, str]:
    """Why the equations do not follow each number; "" if they do."""
    known = _REFUSED.setdefault(model.compiled, {})
    left = [number for number in numbers if number not in known]
    # all at once takes hardly longer than one
    if left and not _refusal(model.description, left):
        known |= dict.fromkeys(left, "")
    for number in numbers:
        if number not in known:
            known[number] = _refusal(model.description, [number])
    return {number: known[number] for number in numbers}


def _refusal(description: Description, numbers: Sequence[VariedNumber]) -> str:
    tape = Tape()
    tape.writing = True
    try:
        with np.errstate(all="ignore"):
            taped = {number: tape.number(float(number.of(description))) for number in numbers}
            write_equations(with_numbers(description, taped))
    except NotElementwise:
        return "it changes the form of the equations, such as a ratio of wheels or the law of a cam"
    except LinkworkError as error:
        if tape.lacks_derivatives:
            at = " and ".join(f"{number.of(description):g}" for number in numbers)
            return (
                f"at {at} a formula of it has a corner (abs, max, min, hypot) or an end (asin, "
                "acos, sqrt), where it has no derivative: change the number a little"
            )
        problems = getattr(error, "problems", ())
        if not problems:
            return str(error)
        held = problems[0].key
        if held[0] in ("lengths", "angles") and "ground coordinates" in problems[0].message:
            message = f"ground coordinates are exact and give {key_text(held)}"
            return f"{message}: leave that out to vary coordinates, or vary other numbers"
        return str(problems[0].message)
    return ""


def groups_of(
    description: Description, numbers: Sequence[VariedNumber]
) -> Iterator[tuple[VariedNumber, ...]]:
    """The numbers in groups that vary together: a number that a formula gives varies alone.

    Otherwise its formula would not pass on the change of the numbers in it.
    """
    plain = tuple(q for q in numbers if not isinstance(q.written(description), str))
    if plain:
        yield plain
    for number in numbers:
        if number not in plain:
            yield (number,)


# ----------------------------------------------------------------------
# Solved rows as functions of a mechanism's numbers, by the implicit function theorem.
#
# The equations are written once more with taped numbers. At a solved position one step of
# Newton-Raphson from the solution, v - J⁻¹ F(v; p), has the derivatives of the solution,
# dv = -J⁻¹ F_p. The derivatives of v by the input satisfy the same linear equations, differentiated
# once and twice.


_ZERO = np.zeros(())


class DifferentiatedRows(QuantityValues):
    """Quantities of B solved rows on a tape.

    Parameters
    ----------
    model : Model
    numbers : sequence of VariedNumber
        By which they are differentiated, P.
    v : (B, N)
        Solved variables, internal units; NaN where there is no position with a finite derivative.
    order : int
        How many derivatives by the leading input are differentiated too, 0 to 2.
    plays : sequence of (link, point)
        Points that move away from their pins, with two more numbers for each: x and y.

    Raises
    ------
    NotElementwise
        If the form of the equations depends on a number.
    """

    def __init__(
        self,
        model: Model,
        numbers: Sequence[VariedNumber],
        v: Array,
        order: int,
        plays: Sequence[tuple[str, str]] = (),
    ) -> None:
        self.tape = Tape()
        description = model.description
        taped = {q: self.tape.number(float(q.of(description))) for q in numbers}
        # |x| in the builder shows x without its sign, which stands beside it
        self.tape.writing = True
        with np.errstate(all="ignore"):
            self.description = with_numbers(description, taped) if taped else description
            if plays:
                self.description = self._with_plays(plays)
            self.taped: LoopEquations = write_equations(self.description)
        self.tape.writing = False
        lost: BoolArray = np.logical_not(np.isfinite(v).all(axis=1))
        self._take_quantities(model, lost)
        self.solution = np.where(lost[:, None], np.nan, v)
        # without an input nothing moves, and there are no rates
        self.order = order if self.equations.inputs else 0

    def _take_quantities(self, model: Model, lost: BoolArray) -> None:
        """What quantities read besides variables and points."""
        links: Any = LastAxis([angle.constant for angle in self.taped.links.values()])
        dimensions: Any = LastAxis(list(self.taped.dimensions.values()))
        super().__init__(model, lost, np.where(lost, np.nan, 0.0), links, dimensions)
        self.count = len(self.equations.unknowns)
        self._symbols = [x.symbol for x in self.equations.variables]
        self._points: dict[str, Jet] = {}

    def _with_plays(self, plays: Sequence[tuple[str, str]]) -> Description:
        """A copy in which points of links lie x + iy away from the pins, in the links' frames."""
        # making a description anew would derive its shapes from lengths again
        description = copy(self.description)
        assert isinstance(description, Draft)
        local = {link: dict(points) for link, points in description.shapes.local.items()}
        for link, point in plays:
            away = vector(self.tape.number(0.0), self.tape.number(0.0))
            local[link][point] = local[link][point] + away
        shapes = replace(description.shapes, local=local)
        object.__setattr__(description, "shapes", shapes)
        return description

    @cached_property
    def _rates(self) -> tuple[Array, Array]:
        """First and second derivative of the variables by the leading input, (B, N) each."""
        if not self.equations.inputs:
            return np.zeros_like(self.solution), np.zeros_like(self.solution)
        rows = self.model.compiled.solver.rates(self.solution, self._input_rate)
        return rows.first, rows.second

    @cached_property
    def _input_rate(self) -> Array:
        return leading_input(self.model.rows)[1]

    @cached_property
    def _inverse(self) -> Array:
        """J⁻¹ (B, n, n); NaN in rows without a derivative."""
        inverse = np.full((len(self.solution), self.count, self.count), np.nan)
        fine = ~self.lost
        jacobian = self.model.compiled.table.jacobian(self.solution[fine])
        inverse[fine] = inverses(jacobian[:, :, : self.count])
        return inverse

    # Solved variables on the tape

    @cached_property
    def variables(self) -> dict[str, Jet]:
        """All variables by symbol, with the requested order of derivatives, on the tape."""
        return self._differentiated()

    def _differentiated(self, values: Sequence[Any] = ()) -> dict[str, Jet]:
        """Variables on the tape; ``values``: themselves, if they are on it already."""
        known = self.solution, *self._rates
        columns: list[list[Any]] = [[part[:, k] for k in range(part.shape[1])] for part in known]
        columns[0] = list(values) or columns[0]
        for order in range(1 if values else 0, self.order + 1):
            # higher derivatives are not on the tape yet, and do not enter lower ones
            jets = [Jet(*parts) for parts in zip(*columns, strict=True)]
            rows = self._residuals(dict(zip(self._symbols, jets, strict=True)))
            parts = [(jet.v, jet.d1, jet.d2)[order] for jet in rows]
            unknown = known[order][:, : self.count]
            # eq. (120)
            columns[order][: self.count] = self.tape.stepped(unknown, self._inverse, parts)
        jets = [Jet(*parts) for parts in zip(*columns, strict=True)]
        return dict(zip(self._symbols, jets, strict=True))

    @cached_property
    def by_input(self) -> list[Self]:
        """The same rows with rates by each input alone instead of the leading one."""
        return [self._moved_by(unit) for unit in np.eye(len(self.equations.inputs))]

    def _moved_by(self, direction: Array) -> Self:
        rates = self.model.compiled.solver.rates(self.solution, direction).first
        first: list[Any] = [rates[:, k] for k in range(rates.shape[1])]
        zero = np.zeros(len(rates))
        values = [self.variables[symbol].v for symbol in self._symbols]

        def jets() -> dict[str, Jet]:
            parts = zip(self._symbols, values, first, strict=True)
            return {symbol: Jet(value, rate, zero) for symbol, value, rate in parts}

        parts = [row.d1 for row in self._residuals(jets())]
        # eq. (120)
        first[: self.count] = self.tape.stepped(rates[:, : self.count], self._inverse, parts)
        # the copy shares all but variables and points
        moved = copy(self)
        moved._points = {}
        moved.__dict__["variables"] = jets()
        return moved

    def _residuals(self, variables: Mapping[str, Jet]) -> list[Jet]:
        """All equations in the order of the loop table, as jets."""
        taped = self.taped
        loops = [self._sum(loop.terms, variables) for loop in taped.loops]
        rows = [Jet(z.v.real, z.d1.real, z.d2.real) for z in loops]
        rows += [Jet(z.v.imag, z.d1.imag, z.d2.imag) for z in loops]
        return rows + self._further(variables)

    def _further(self, variables: Mapping[str, Jet]) -> list[Jet]:
        """All equations but loops."""
        taped, rows = self.taped, []
        for line in taped.linear:
            total = _constant(line.constant)
            for symbol, weight in line.terms:
                total = total + variables[symbol] * weight
            rows.append(total)
        with np.errstate(all="ignore"):
            rows += [
                self._formula(equation.left, variables) - self._formula(equation.right, variables)
                for equation in taped.real
            ]
        return rows + [_law_jet(law, variables) for law in taped.laws]

    def _formula(self, node: Any, variables: Mapping[str, Jet]) -> Jet:
        known = dict(variables)
        # lengths and dimensions in plain equations are numbers on the tape too
        for used in {name.name for name in names_in(node)} - set(known):
            if used in self.taped.symbols:
                known[used] = _constant(self.taped.symbols[used])
        return evaluate(node, known, self.taped.angle)

    def _sum(self, terms: Sequence[Term], variables: Mapping[str, Jet]) -> Jet:
        total = Jet(_ZERO, _ZERO, _ZERO)
        for term in terms:
            turn = None
            for symbol, weight in term.phase:
                part = variables[symbol] * weight
                turn = part if turn is None else turn + part
            one = Jet.constant(1.0)
            length = one if term.length is None else variables[term.length]
            total = total + term_jet(term.value, length, turn)
        return total

    # What quantities read

    def variable(self, symbol: str) -> Jet:
        """A variable by its symbol, internal units, (B,)."""
        return self.variables[symbol]

    def place(self, point: str) -> Jet:
        """A point by its exact name, (B,)."""
        if point not in self._points:
            path = self.taped.points[point]
            blank = self.still * (1.0 + 0j)
            place = Jet(blank, blank, blank) if path.parent is None else self.place(path.parent)
            self._points[point] = place + self._sum(path.terms, self.variables)
        return self._points[point]

    @cached_property
    def speed(self) -> Any:
        """The speed of the leading input, which numbers may change; ``None`` without."""
        return taped_speed(self.model, self.description, self.equations)

    @cached_property
    def misfits(self) -> list[Any]:
        """The lengths of redundant links minus their given lengths, (B,) each, on the tape."""
        return [
            self.variables[canonical(part.variable)].v - part.length
            for part in self.taped.redundant
        ]

    @property
    def leading_input(self) -> Any:
        """The leading input, internal units."""
        lead, _ = leading_input(self.model.rows)
        return self.variables[self._symbols[self.count + lead]].v


def taped_speed(model: Model, description: Description, equations: LoopEquations) -> Any:
    """The speed of the leading input in a description with taped numbers; ``None`` without."""
    if model.speed is None:
        return None
    speeds = leading_speeds(description, equations.inputs, model.rows)
    # time, where it drives the rows, has a speed too
    return next(iter(speeds.values()), model.speed)


def _constant(number: Any) -> Jet:
    """A number, taped or not, that does not move."""
    return Jet(number, _ZERO, _ZERO)


def _law_jet(law: LawEquation, variables: Mapping[str, Jet]) -> Jet:
    """Σ a v + constant - f(Σ w v + offset), eq. (4)."""
    straight, inner = (
        sum((variables[s] * weight for s, weight in terms), _constant(constant))
        for terms, constant in ((law.terms, law.constant), (law.inner, law.offset))
    )
    argument: Any = inner.v
    x = argument.values if is_batched(argument) else np.asarray(argument)
    f, first, second = law.law.jet(x)
    # the second derivative by the input needs the third of the law
    third = law.law.slope().jet(x)[2]
    parts = (
        chained(value, slope, argument)
        for value, slope in ((f, first), (first, second), (second, third))
    )
    return straight - inner.chain(*parts)


# ----------------------------------------------------------------------
# Dead points as functions of a mechanism's numbers.
#
# At a dead point J is singular, and the position at a fixed input has no derivative. The dead point
# itself moves smoothly: with null vectors w and φ of J, F = 0 and wᵀ J φ = 0 are regular equations
# of the unknowns and the leading input.


_REGULAR = 1e12  # condition up to which a dead point has digits


class DifferentiatedFolds(DifferentiatedRows):
    """Quantities at B dead points on a tape; parameters as of the base class."""

    @cached_property
    def _null_vectors(self) -> tuple[Array, Array]:
        """w (B, n) and φ (B, N): φ is 0 for inputs."""
        jacobian = self.model.compiled.table.jacobian(self.solution)[:, :, : self.count]
        # the last singular value is the one that vanishes
        u, _, vh = np.linalg.svd(jacobian)
        along = np.zeros_like(self.solution)
        along[:, : self.count] = vh[:, -1]
        return u[:, :, -1], along

    @cached_property
    def variables(self) -> dict[str, Jet]:
        """All variables by symbol; without derivatives by the input, which do not exist here."""
        left, along = self._null_vectors
        zero = np.zeros(len(self.solution))
        jets = {
            symbol: Jet(self.solution[:, k], along[:, k], zero)
            for k, symbol in enumerate(self._symbols)
        }
        rows = self._residuals(jets)
        # eq. (123)
        bend: Any = zero
        for k, row in enumerate(rows):
            bend = bend + row.d1 * left[:, k]
        parts = [row.v for row in rows] + [bend]
        unknown = [*range(self.count), self.lead]
        steps = self.tape.stepped(self.solution[:, unknown], self._bordered(), parts)
        values = dict(zip(unknown, steps, strict=True))
        # inputs in lock-step follow the leading one
        for k, rate in enumerate(self._input_rate, start=self.count):
            if k != self.lead:
                values[k] = self.tape.combine(self.solution[:, k], [(rate, values[self.lead])])
        # rates by the input are infinite at a dead point
        none = np.full(len(self.solution), np.nan)
        return {symbol: Jet(values[k], none, none) for k, symbol in enumerate(self._symbols)}

    @property
    def lead(self) -> int:
        """The column of the leading input."""
        return self.count + int(np.flatnonzero(self._input_rate == 1.0)[0])

    def _bordered(self) -> Array:
        """The inverse of the derivatives of F and of wᵀ J φ by unknowns and leading input."""
        left, along = self._null_vectors
        table, v = self.model.compiled.table, self.solution
        jacobian = table.jacobian(v)
        directions = [np.eye(v.shape[1])[k] for k in range(self.count)]
        directions.append(np.append(np.zeros(self.count), self._input_rate))
        matrix = np.zeros((len(v), self.count + 1, self.count + 1))
        along_twice = table.second_directional_derivative(v, along)
        for k, direction in enumerate(directions):
            moved = np.broadcast_to(direction, v.shape)
            matrix[:, : self.count, k] = jacobian @ direction
            # D²F[φ, d] by polarisation
            both = table.second_directional_derivative(v, along + moved)
            mixed = 0.5 * (both - along_twice - table.second_directional_derivative(v, moved))
            matrix[:, self.count, k] = (left * mixed).sum(axis=1)
        inverse = np.full_like(matrix, np.nan)
        for k, one in enumerate(matrix):
            # two branches cross at a change point, which a change of a number removes
            if np.isfinite(one).all() and np.linalg.cond(one) < _REGULAR:
                inverse[k] = np.linalg.inv(one)
        return inverse
