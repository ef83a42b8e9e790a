"""Straight guides of points in a mechanism given by loop equations."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from linkwork import wings
from linkwork.core.equations.compiling import Compiled, compile_equations
from linkwork.core.equations.from_description import read_loops, read_plain_equations, write_loops
from linkwork.core.equations.input_motion import driven_by_time
from linkwork.core.equations.model import LoopEquations, Output, Term, Variable
from linkwork.core.expression.tree import Name, names_in
from linkwork.core.foundation.arrays import RANK_TOLERANCE, Array
from linkwork.core.foundation.errors import (
    ExpressionError,
    InputError,
    MechanismError,
    Problem,
    UnknownNameError,
    choices,
)
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.foundation.values import as_told, finite_number
from linkwork.core.mechanism.description import LIMITS, Description, Question
from linkwork.core.mechanism.inputs import speed_per_second
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops, PlainEquations
from linkwork.core.mechanism.machine import LoadedBodies
from linkwork.core.mechanism.skeleton import DrivenPart, Rail, Skeleton
from linkwork.core.mechanism.varied_numbers import tolerance_problems
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.results.position import Position
from linkwork.core.results.quantities.definition import (
    Asked,
    Group,
    MechanismNames,
    RowQuantity,
    Solved,
)
from linkwork.core.results.quantities.registry import Quantities, row_quantity
from linkwork.core.results.quantity import Kind, Units

_MOST_LOOPS = 4  # up to so many loops are combined; of more, each is tried by itself
_LEAST = 1e-12  # relative to the largest term: smaller ones are the rounding of a difference

#: A sum of vectors: length variable and phase -> value.
_Sum = dict[tuple[object, ...], complex]


def rails_of(equations: LoopEquations, links: Mapping[str, tuple[str, ...]]) -> Iterator[Rail]:
    """The rails of a mechanism, each with the variable that measures a point's distance along it.

    A point runs along a rail if its place is a constant and a length times a constant vector; along
    a link, if it is a length away from one of its points in the link's direction: as formulas have
    it, or after loop equations are added to it or subtracted.
    """
    lengths = {v.symbol: v.name for v in equations.variables if v.kind == "length"}
    loops = [_sum(loop.terms) for loop in equations.loops]
    if not any(key[0] in lengths for loop in loops for key in loop):
        return
    places = {name: _sum(point.terms) for name, point in equations.points.items()}
    rails: dict[tuple[str, complex], list[str]] = {}
    on_links: list[Rail] = []
    for name, place in places.items():
        for way in _ways(place, loops):
            moving = [key for key in way if key[0] is not None or key[1]]
            if len(moving) == 1 and moving[0][0] in lengths and not moving[0][1]:
                vector = way[moving[0]]
                rails.setdefault((lengths[str(moving[0][0])], vector / abs(vector)), []).append(
                    name
                )
                break
        else:
            on_links += _on_links(name, places, links, lengths, loops)
    for (variable, along), points in rails.items():
        yield Rail(name=variable, points=tuple(points), along=along)
    yield from on_links


def _on_links(
    name: str,
    places: Mapping[str, _Sum],
    links: Mapping[str, tuple[str, ...]],
    lengths: Mapping[str, str],
    loops: list[_Sum],
) -> Iterator[Rail]:
    """Rails on links along which a point moves."""
    for link, points in links.items():
        if link == GROUND or name in points or len(points) < 2:
            continue
        foot, tip = points[:2]
        line = _add([(1, places[tip]), (-1, places[foot])])
        if len(line) != 1:
            continue
        ((length, turn),) = line
        if length is not None or not turn:
            continue
        for way in _ways(_add([(1, places[name]), (-1, places[foot])]), loops):
            if len(way) == 1:
                ((far, way_turn),) = way
                if far in lengths and turn == way_turn:
                    yield Rail(name=lengths[str(far)], points=(name,), on=link, line=(foot, tip))
                    break


def _sum(terms: Iterable[Term]) -> _Sum:
    return _add([(1, {(term.length, term.phase): term.value}) for term in terms])


def _add(parts: Iterable[tuple[int, _Sum]]) -> _Sum:
    """Add sums of vectors, each with its sign, and drop the terms that cancel."""
    total: _Sum = {}
    largest = 0.0
    for sign, part in parts:
        for key, value in part.items():
            total[key] = total.get(key, 0j) + sign * value
            largest = max(largest, math.hypot(value.real, value.imag))
    return {
        key: value
        for key, value in total.items()
        if math.hypot(value.real, value.imag) > _LEAST * largest
    }


def _ways(place: _Sum, loops: list[_Sum]) -> Iterator[_Sum]:
    """The place of a point with loop equations added or subtracted, its own formula first."""
    if len(loops) > _MOST_LOOPS:
        yield place
        for loop in loops:
            yield _add([(1, place), (1, loop)])
            yield _add([(1, place), (-1, loop)])
        return
    signs = product((0, 1, -1), repeat=len(loops))
    for chosen in sorted(signs, key=lambda one: sum(map(abs, one))):
        yield _add([(1, place), *zip(chosen, loops, strict=True)])


# ----------------------------------------------------------------------
# The quantities that stops bound.


def bounded_quantity(name: str, known: Quantities) -> Asked:
    """The quantity of positions that a stop bounds.

    Raises
    ------
    InputError
        If there is none of this name, or it does not follow from positions alone.
    """
    asked = known.find(name)
    if asked.needs or asked.group is Group.EVIDENCE:
        raise InputError(
            f'"{name}" cannot be stopped: name a quantity of positions, such as a link or B.x'
        )
    return asked


def stop_problems(description: Description, known: Quantities) -> list[Problem]:
    """Stops of what the mechanism does not have."""
    problems = []
    for k, stop in enumerate(description.stops if isinstance(description, LoadedBodies) else ()):
        try:
            bounded_quantity(stop.of, known)
        except InputError as error:
            problems.append(Problem(key=("stops", k, "of"), message=str(error)))
    return problems


# ----------------------------------------------------------------------
# The first input of a table that moves, and the rates of the other inputs with respect to it.


def leading_input(rows: Array) -> tuple[int, Array]:
    """The leading input, and the rate of every input with respect to it.

    Parameters
    ----------
    rows : (rows, p)
        The table of input values.

    Returns
    -------
    lead : int
        The first input that changes from row to row, 0 if none does.
    rate : (p,)
        1 for the leading input.
    """
    inputs = rows.shape[1]
    # from end to end, so that the rounding of one step is not multiplied by their number
    changes = rows[-1] - rows[0] if len(rows) > 1 else np.zeros(inputs)
    moving = np.flatnonzero(changes)
    if not len(moving):
        return 0, np.eye(1, inputs)[0]
    lead = int(moving[0])
    return lead, changes / changes[lead]


# ----------------------------------------------------------------------
# Read the speed of an input: ``"300 rpm"``, ``"25 rad/s"``, ``"50 mm/s"``.


def input_speed(description: Description, inputs: Sequence[Variable], rows: Array) -> float | None:
    """The rate of the leading input, [rad/s] or [length/s]; ``None`` if no speed is given.

    Raises
    ------
    MechanismError
        For a speed that cannot be read, or speeds that contradict the lock-step of the inputs.
    """
    rates = leading_speeds(description, inputs, rows)
    first = next(iter(rates.values()), None)
    for k, leading in rates.items():
        assert first is not None
        if not math.isclose(leading, first, rel_tol=1e-9):
            message = (
                "contradicts the first speed: speeds of inputs in lock-step have the ratio of "
                "their steps"
            )
            problem = Problem(key=(*description.input_key(k), "speed"), message=message)
            raise MechanismError([problem], f'mechanism "{description.name}"')
    return first


def leading_speeds(
    description: Description, inputs: Sequence[Variable], rows: Array
) -> dict[int, float]:
    """The leading input's rate according to the speed of every input that has one.

    Raises
    ------
    MechanismError
        For a speed that cannot be read.
    """
    _, rate = leading_input(rows)
    return {
        k: _speed(description, k, inputs[k].kind) / float(rate[k]) if rate[k] else math.nan
        for k, which in enumerate(description.inputs)
        if which.speed is not None
    }


def _speed(description: Description, k: int, kind: str) -> float:
    """The speed of the k-th input, internal units per second."""
    which = description.inputs[k]
    assert which.speed is not None
    driven = {"angle": "link", "length": "slider"}.get(kind, "variable")
    try:
        own = speed_per_second(which.speed, driven, description.numbers, description.length)
    except ExpressionError as error:
        problem = Problem(key=(*description.input_key(k), "speed"), message=error.message)
        raise MechanismError([problem], f'mechanism "{description.name}"') from None
    return own * (description.angle.radians if kind == "angle" else 1.0)


# ----------------------------------------------------------------------
# Check redundant conditions at the start and at every position.
#
# The length of a redundant link is an unknown of the equations. Positions at which it does not come
# out as given are no positions of the mechanism.


#: Relative to the longest link: a redundant link this near to its length fits.
FITS = 1e-9


def misfit(equations: LoopEquations, v: Array) -> Array:
    """How far redundant links are from their lengths at positions v (B, N), of the longest link."""
    columns, lengths = _redundant(equations)
    if not columns:
        return np.zeros(len(v))
    gaps: Array = np.abs(v[:, columns] - lengths).max(axis=1) / equations.length_scale
    return gaps


def lengths_found(equations: LoopEquations, v: Array) -> list[float]:
    """The lengths of the redundant links at a position (N,)."""
    columns, _ = _redundant(equations)
    return [float(length) for length in v[columns]]


def largest_misfits(equations: LoopEquations, v: Array) -> dict[str, float]:
    """The same for each redundant link, the largest at any of the positions that are there."""
    columns, lengths = _redundant(equations)
    there = v[~np.isnan(v).any(axis=1)][:, columns]
    gaps = np.abs(there - lengths).max(axis=0, initial=0.0) / equations.length_scale
    links = (part.link for part in equations.redundant)
    return dict(zip(links, gaps.tolist(), strict=True))


def without_redundant(equations: LoopEquations, proved: Certification) -> Certification:
    """The certification of the mechanism from that of its equations."""
    if proved.certified and has_corners(equations):
        proved = Certification.MOTION_NOT_PROVED
    return Certification.SUBSET_CERTIFIED if equations.redundant and proved.certified else proved


def has_corners(equations: LoopEquations) -> bool:
    """Whether the speed of an input changes at once: no proof leads past that."""
    return any(law.law.corners for law in equations.laws)


def _redundant(equations: LoopEquations) -> tuple[list[int], Array]:
    """The columns of redundant lengths, and their given values."""
    number = {variable.symbol: k for k, variable in enumerate(equations.variables)}
    columns = [number[canonical(part.variable)] for part in equations.redundant]
    return columns, np.array([part.length for part in equations.redundant])


def check_redundancy(compiled: Compiled, where: str) -> None:
    """Refuse conditions too many that the others do not imply.

    Raises
    ------
    MechanismError
        If a redundant link does not fit at the start, or if with it the inputs cannot move.
    """
    equations = compiled.equations
    surplus = equations.surplus
    if not equations.redundant or surplus is None:
        return
    done = compiled.solver.solve(equations.start[None, :], NewtonOptions())
    if Status.of_code(int(done.status[0])) is not Status.CONVERGED:
        return  # said when a position is asked for
    columns, _ = _redundant(equations)
    found = done.v[0, columns]
    freedoms, inputs = mobility_by_rank(compiled, done.v[0]), len(equations.inputs)
    fits = misfit(equations, done.v)[0] <= FITS
    # several inputs may also be given values that do not belong together
    if not fits and (freedoms >= inputs or inputs < 2):
        wanted = ", ".join(
            f"{part.link} needs the length {length:.10g}, not {part.length:.10g}"
            for part, length in zip(equations.redundant, found, strict=True)
            if abs(length - part.length) > FITS * equations.length_scale
        )
        raise _refuse(surplus, f"it does not fit the sketch: {wanted}", where)
    if freedoms < inputs:
        how = f"{freedoms} degree{'s' if freedoms != 1 else ''} of freedom"
        driven = f"{inputs} input{'s' if inputs != 1 else ''}"
        raise _refuse(surplus, f"as assembled it has {how} for {driven}", where)


def _refuse(surplus: Problem, why: str, where: str) -> MechanismError:
    return MechanismError(
        [Problem(key=surplus.key, message=f"{surplus.message} ({why})", line=surplus.line)], where
    )


def mobility_by_rank(compiled: Compiled, v: Array) -> int:
    """Variables minus the rank of all equations by all variables at a position (N,)."""
    table, equations = compiled.table, compiled.equations
    scaled = table.jacobian(v[None, :])[0] * table.variable_scale / table.equation_scale[:, None]
    columns, _ = _redundant(equations)
    # a redundant length is no freedom: it has to keep its value
    scaled = np.delete(scaled, columns, axis=1)
    if not scaled.size:
        return int(scaled.shape[1])
    tolerance = RANK_TOLERANCE * np.linalg.norm(scaled, 2)
    return int(scaled.shape[1] - np.linalg.matrix_rank(scaled, tol=tolerance))  # eq. (65)


# ----------------------------------------------------------------------
# Check that a mechanism has the quantities that its questions ask for.


def question_problems(questions: tuple[Question, ...], known: Quantities) -> list[Problem]:
    """The questions whose answers the mechanism does not have."""
    found = ((k, _trouble(question, known)) for k, question in enumerate(questions))
    return [Problem(key=("questions", k, "answer"), message=text) for k, text in found if text]


def _trouble(question: Question, known: Quantities) -> str:
    answer = question.answer
    if not isinstance(answer, str) or answer in LIMITS:
        return ""
    try:
        (known.find_of_motion if question.at is None else known.find)(answer)
    except InputError as error:
        if question.at is None and _is_of_rows(answer, known):
            return (
                f'"{answer}" differs from row to row: add the input, at = 90, or ask for a number '
                f'of the whole motion, "max({answer})"'
            )
        words = " or ".join(f'"{word}"' for word in LIMITS)
        return f"{error}; or ask for {words}"
    return ""


def _is_of_rows(name: str, known: Quantities) -> bool:
    try:
        known.find(name)
    except InputError:
        return False
    return True


# ----------------------------------------------------------------------
# The model of a mechanism: description, equations, arrays.


@dataclass(frozen=True)
class Model:
    """Everything that solving needs, derived once from a description.

    ``branch``: the name of the branch that the guess lies on. ``untimed``: of a mechanism that
    time drives, the same with its own inputs, whose variables have the same order.
    """

    description: Description
    equations: LoopEquations
    compiled: Compiled
    skeleton: Skeleton
    branch: str = "circuit 1 branch 1"
    untimed: Model | None = None

    def from_start_of(self, other: Model) -> Model:
        """The model with the guess of another one of the same equations."""
        equations = replace(self.equations, start=other.equations.start)
        return replace(self, equations=equations, branch=other.branch)

    def from_position(self, position: Position) -> Model:
        """The model with a position of this mechanism as its guess."""
        values = [position.input[variable.name] for variable in self.equations.inputs]
        start = np.concatenate([position.q, np.array(values) * self.input_scale])
        equations = replace(self.equations, start=start)
        return replace(self, equations=equations, branch=position.configuration or self.branch)

    def with_guess(self, values: Mapping[str, float]) -> Model:
        """The model with another guess for some unknowns, in file units.

        Raises
        ------
        UnknownNameError, InputError
            For a name that is no unknown, or a value that is no finite number.
        """
        if not isinstance(values, Mapping):
            raise InputError(f'a guess is given by name, as {{"θ3": 20}}, got {as_told(values)}')
        unknowns = self.equations.unknowns
        number = {canonical(u.name): k for k, u in enumerate(unknowns)}
        start = self.equations.start.copy()
        for name, value in values.items():
            if canonical(name) not in number:
                raise UnknownNameError(
                    f'"{name}" is not an unknown of {self.description.name} '
                    f"{choices('unknowns', [u.name for u in unknowns], name)}"
                )
            k = number[canonical(name)]
            start[k] = finite_number(f"the guess of {name}", value) * self.units.scale(
                Kind(unknowns[k].kind)
            )
        return replace(self, equations=replace(self.equations, start=start))

    @property
    def circuit(self) -> str:
        """The name of the circuit that the guess lies on."""
        return self.branch.partition(" branch ")[0]

    @property
    def units(self) -> Units:
        """The mechanism's units."""
        description = self.description
        force = description.force if isinstance(description, LoadedBodies) else Units.force
        return Units(description.angle, description.length, force)

    @cached_property
    def quantities(self) -> Quantities:
        """The quantities of its positions and motions, with those of forces if it is loaded."""
        names = self.motion_quantities.names
        return Quantities(replace(names, further=self.force_quantities()))

    def force_quantities(self) -> tuple[RowQuantity, ...]:
        """The efforts of the inputs and the reactions of the joints; none without loads."""
        if not getattr(self.description, "loaded", False):
            return ()
        return wings.use("forces.reactions.solving").force_quantities(self)

    def beside_switches(self, at: Callable[[Array], Solved], t: Array) -> Array:
        """Places just before and just behind all switches of loads between rising values t (B,) of
        the leading input, at which ``at`` gives positions; none without loads.
        """
        if not getattr(self.description, "loaded", False):
            return np.zeros(0)
        return wings.use("forces.reactions.switches").beside_switches(self, at, t)

    def derivatives(self, solved: Solved, asked: Asked, order: int) -> Array:
        """The derivatives of a quantity with respect to the leading input, from the first to one of
        any order, in radians and lengths, (order, B).

        Raises
        ------
        InputError
            For plain equations, for formulas, and for a family.
        """
        from linkwork.core.motion.higher_rates import derivatives_of

        return derivatives_of(self, solved, asked, order)

    @cached_property
    def motion_quantities(self) -> Quantities:
        """The quantities that need no forces."""
        equations = self.equations
        released = {part.variable for part in equations.redundant}
        inputs = {v.name: Kind(v.kind) for v in equations.inputs}
        lead = equations.inputs[leading_input(self.rows)[0]].name if inputs else ""
        own = () if self.untimed is None else self.untimed.equations.inputs
        driven = own[0].name if len(own) == 1 else ""
        return Quantities(
            MechanismNames(
                units=self.units,
                skeleton=self.skeleton,
                inputs=inputs,
                unknowns={
                    v.name: Kind(v.kind) for v in equations.unknowns if v.name not in released
                },
                links=tuple(equations.links),
                sliders=tuple(equations.sliders),
                outputs={name: Kind(output.kind) for name, output in equations.outputs.items()},
                output_needs={
                    name: max((row.needs for _, row in _derived(output)), default=0)
                    for name, output in equations.outputs.items()
                },
                points=tuple(getattr(self.description, "points", {})),
                by=self.derivative_unit,
                lead=lead,
                driven=driven,
                series=self.derivatives,
            )
        )

    @cached_property
    def input_scale(self) -> Array:
        """Internal units per file unit of each input, (p,)."""
        return np.array([self.units.scale(Kind(v.kind)) for v in self.equations.inputs])

    @property
    def start_inputs(self) -> Array:
        """The input values the guess belongs to, internal units, (p,)."""
        return self.equations.start[len(self.equations.unknowns) :]

    @cached_property
    def rows(self) -> Array:
        """The table's input values, internal units, (rows, p)."""
        if not self.description.inputs:
            raise InputError(
                f'mechanism "{self.description.name}" has no input, so it does not move: '
                "solve and configurations give its positions"
            )
        return self.rows_in_file_units * self.input_scale

    @cached_property
    def rows_in_file_units(self) -> Array:
        """The table's input values as asked, in file units, (rows, p)."""
        if self.untimed is not None:
            timed = self.description.timed
            # without a law nothing says when the rows are: only that time leads
            return self.description.times[:, None] if timed else np.array([[0.0], [1.0]])
        columns = [self.description.rows(which) for which in self.description.inputs]
        if not columns:
            return np.zeros((1, 0))
        count = max(map(len, columns))
        return np.stack([np.broadcast_to(column, count) for column in columns], axis=1)

    @cached_property
    def start_in_file_units(self) -> Array:
        """The input values the guess belongs to, in file units, (p,)."""
        values = [
            self.units.angle.from_radians(float(value)) if variable.kind == "angle" else value
            for variable, value in zip(self.equations.inputs, self.start_inputs, strict=True)
        ]
        return np.array(values, dtype=float)

    @property
    def riding(self) -> tuple[str, ...]:
        """Links that turn with another one, on which they only slide."""
        named = {variable.name for variable in self.equations.variables}
        return tuple(
            link
            for link, angle in self.equations.links.items()
            if angle.variable is not None and link not in named
        )

    @property
    def input_units(self) -> dict[str, str]:
        """The file unit of every input."""
        return {v.name: self.units.of(Kind(v.kind)) for v in self.equations.inputs}

    @cached_property
    def derivative_unit(self) -> str:
        """The unit of the input in derivatives: ``rad`` or the length unit of the leading input."""
        if not self.equations.inputs:
            return ""
        return self.units.of_rate(Kind(self.equations.inputs[leading_input(self.rows)[0]].kind))

    @cached_property
    def speed(self) -> float | None:
        """Rate of the leading input, [rad/s] or [length/s]; 1 if that is the time."""
        if not self.description.inputs:
            return None
        if self.untimed is not None:
            return 1.0
        return input_speed(self.description, self.equations.inputs, self.rows)

    def input_values(self, at: dict[str, float]) -> Array:
        """Named input values as an array, in file units, (p,).

        Raises
        ------
        UnknownNameError, InputError
            For a name that is no input, or an input without a value.
        """
        known = {canonical(v.name): k for k, v in enumerate(self.equations.inputs)}
        names = [v.name for v in self.equations.inputs]
        values = np.full(len(names), np.nan)
        for name, value in at.items():
            if canonical(name) not in known:
                raise UnknownNameError(
                    f'"{name}" is not an input of {self.description.name} '
                    f"{choices('inputs', names, name)}"
                )
            values[known[canonical(name)]] = finite_number(name, value)
        missing = [name for name, value in zip(names, values, strict=True) if np.isnan(value)]
        if missing:
            raise InputError(
                f"no value for the input {', '.join(missing)}: "
                f"give a value to each input of this mechanism ({', '.join(names)})"
            )
        return values


def model_of(description: Description) -> Model:
    """Write or read the equations of a mechanism and compile them.

    Raises
    ------
    MechanismError
        With every problem found.
    """
    where = f'mechanism "{description.name}"'
    match description:
        case Linkage():
            equations = write_loops(description)
            skeleton = Skeleton.of_linkage(description, equations.outlines)
        case Loops():
            equations = read_loops(description)
            fixed = description.links.get(GROUND, equations.fixed)
            driven = tuple(
                _driven_part(description, equations, variable, description.falls(which))
                for variable, which in zip(equations.inputs, description.inputs, strict=True)
            )
            rails = tuple(rails_of(equations, description.links))
            skeleton = Skeleton.of_points(
                description.links, fixed, description.trace, driven, rails
            )
        case PlainEquations():
            equations = read_plain_equations(description)
            skeleton = Skeleton()
        case _:
            raise TypeError(f"no equations are known for {type(description).__name__}")
    compiled = compile_equations(equations, where)
    check_redundancy(compiled, where)
    skeleton = replace(skeleton, questions=description.questions)
    model = Model(description, equations, compiled, skeleton)
    if description.timed:
        equations = driven_by_time(equations, description)
        compiled = compile_equations(equations, where)
        model = Model(description, equations, compiled, skeleton, untimed=model)
    _check_outputs(model, where)
    # what cannot be read is an error of the file, found with the others
    _ = model.speed
    unknown = question_problems(description.questions, model.quantities)
    unknown += tolerance_problems(description) + stop_problems(description, model.motion_quantities)
    if unknown:
        raise MechanismError(unknown, where)
    return model


def _derived(output: Output) -> Iterator[tuple[Name, RowQuantity]]:
    """The names in a formula that are quantities of the registry."""
    for node in names_in(output.formula):
        row = row_quantity(node.name)
        if row is not None:
            yield node, row


def _check_outputs(model: Model, where: str) -> None:
    """Refuse formulas with quantities that the mechanism does not have."""
    problems = []
    for name, output in model.equations.outputs.items():
        for node, _ in _derived(output):
            try:
                model.quantities.find(node.name)
            except UnknownNameError as error:
                message = f"column {node.column}: {error}"
                problems.append(Problem(key=("outputs", name), message=message))
    if problems:
        raise MechanismError(problems, where)


def _driven_part(
    loops: Loops, equations: LoopEquations, variable: Variable, backwards: bool
) -> DrivenPart:
    """The drawn link that turns with an input angle, if there is one: its direction is e^(iφ)."""
    for link, points in loops.links.items():
        if link == GROUND or variable.kind != "angle" or len(points) < 2:
            continue
        for start, end in ((points[0], points[1]), (points[1], points[0])):
            if _turns_with(equations, start, end, variable.symbol):
                return DrivenPart(kind="link", name=link, pivot=start, backwards=backwards)
    return DrivenPart(kind="variable", name=variable.name, backwards=backwards)


def _turns_with(equations: LoopEquations, start: str, end: str, symbol: str) -> bool:
    """Whether the vector between two points is a positive length times e^(i symbol)."""
    total: dict[tuple[object, ...], complex] = {}
    for point, sign in ((end, 1), (start, -1)):
        for term in equations.points[point].terms:
            key = (term.length, term.phase)
            total[key] = total.get(key, 0j) + sign * term.value
    left = {key: value for key, value in total.items() if abs(value) > 1e-12}
    value = left.pop((None, ((symbol, 1.0),)), 0j)
    return not left and value.real > 0 and abs(value.imag) <= 1e-12 * value.real
