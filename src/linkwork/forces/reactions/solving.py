"""The quantities of forces in the registry of a mechanism."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol, runtime_checkable
from weakref import WeakKeyDictionary

import numpy as np

from linkwork.circuits.circuit_list import solve_configuration
from linkwork.core import motion
from linkwork.core.equations.input_motion import TIME
from linkwork.core.expression.derivatives import Jet
from linkwork.core.expression.grammar import CONSTANTS, parse
from linkwork.core.expression.tree import names_in
from linkwork.core.foundation.arrays import Array, ComputedDict
from linkwork.core.foundation.errors import (
    InputError,
    KeyWords,
    LinkworkError,
    MechanismError,
    Problem,
    key_text,
)
from linkwork.core.foundation.values import check_class
from linkwork.core.motion.branch_rows import between_rows
from linkwork.core.motion.higher_rates import check_own_motion, model_in_time
from linkwork.core.motion.model import Model
from linkwork.core.motion.positions import RowValues
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from linkwork.core.results.quantities.definition import UNKNOWN, MechanismNames, RowQuantity, Solved
from linkwork.core.results.quantity import Kind
from linkwork.forces.reactions.geometry import load_formulas
from linkwork.forces.reactions.switches import beside_switches
from linkwork.forces.reactions.system import ForceRows, solve_forces
from linkwork.forces.results import ForceStatus, Reactions, Stall


def force_quantities(model: Model) -> tuple[RowQuantity, ...]:
    """One quantity for every effort, reaction and total of a loaded mechanism.

    Raises
    ------
    MechanismError
        For loads that use unknown quantities.
    """
    check_formulas(model, at_rest=True)
    # the names only: at the guess, which need not be a position
    v = model.compiled.solver.solve(model.equations.start[None, :]).v
    still = np.zeros_like(v)
    guess = RowValues(model, v, still, still, np.ones(1, dtype=bool))
    solved = _Solver(model)
    return tuple(
        RowQuantity(
            word=name,
            about=force.about,
            needs=2,
            of=_Whole(force.kind),
            evaluate=_Evaluation(solved, name),
            pin=force.pin,
        )
        for name, force in solve_forces(model, guess).values.items()
    )


class SolvedDesign(Solved, Protocol):
    """Solved positions of one design of a family, (R,)."""

    @property
    def model(self) -> Model:
        """A model with the numbers of the design."""


@runtime_checkable
class SolvedDesigns(Solved, Protocol):
    """Solved positions of D designs, (R, D)."""

    def apart(self) -> Iterator[SolvedDesign | None]:
        """Every design by itself; ``None`` for one without positions."""


@runtime_checkable
class SolvedForces(Solved, Protocol):
    """Solved positions that compute forces in their own way."""

    def force(self, name: str) -> Array:
        """A quantity of forces by its exact name."""


class _Solver:
    """Solves the forces of a motion once for all its quantities."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.known: WeakKeyDictionary[Solved, ForceRows] = WeakKeyDictionary()
        self.families: WeakKeyDictionary[SolvedDesigns, list[ForceRows | None]] = (
            WeakKeyDictionary()
        )

    def __getstate__(self) -> Model:
        return self.model

    def __setstate__(self, model: Model) -> None:
        self.__init__(model)  # type: ignore[misc]  # caches are not kept

    def forces(self, solved: Solved) -> ForceRows:
        """The forces of solved positions."""
        if solved not in self.known:
            self.known[solved] = solve_forces(self.model, solved)
        return self.known[solved]

    def designs(self, solved: SolvedDesigns) -> list[ForceRows | None]:
        """The forces of every design of a family."""
        if solved not in self.families:
            self.families[solved] = [
                None if own is None else solve_forces(own.model, own) for own in solved.apart()
            ]
        return self.families[solved]


@dataclass(frozen=True)
class _Whole:
    """The mechanism itself has the quantity."""

    kind: Kind

    def __call__(self, names: MechanismNames) -> Mapping[str, Kind]:
        return {"": self.kind}


@dataclass(frozen=True, eq=False)
class _Evaluation:
    """The values of one quantity."""

    solver: _Solver
    name: str

    def __call__(self, names: MechanismNames, solved: Solved, part: str) -> Jet:
        if isinstance(solved, SolvedForces):
            return Jet(solved.force(self.name), UNKNOWN, UNKNOWN)
        places = solved.place(names.points[0]).v
        if not isinstance(places, np.ndarray | np.generic):
            raise TypeError("forces are computed from arrays, and cannot be recorded")
        shape = places.shape
        if isinstance(solved, SolvedDesigns):
            value = np.full(shape, np.nan)
            # masses, pins and wheels of every design have places of their own
            for k, rows in enumerate(self.solver.designs(solved)):
                if rows is not None:
                    value[:, k] = rows.values[self.name].value
        else:
            value = self.solver.forces(solved).values[self.name].value.reshape(shape)
        return Jet(value, UNKNOWN, UNKNOWN)


def check_formulas(model: Model, *, at_rest: bool) -> None:
    """Refuse loads that use quantities which the mechanism does not have.

    ``at_rest``: accept the time and rates even if the input has no speed, as simulations have them.

    Raises
    ------
    MechanismError
        With every such load.
    """
    description = model.description
    problems = []
    for key, formula in load_formulas(description):
        message = _mistake(model, formula, at_rest)
        if message is not None:
            problems.append(Problem(key=key, message=message))
    if problems:
        raise MechanismError(problems, f'mechanism "{description.name}"')


def _mistake(model: Model, formula: str, at_rest: bool) -> str | None:
    """What is wrong with the names of a formula."""
    for node in names_in(parse(formula, comparing=True)):
        if node.name in CONSTANTS or node.name in model.description.numbers.known:
            continue
        if node.name == "t":
            if model.speed is None and not at_rest:
                return f"column {node.column}: the time t needs the speed of an input"
            continue
        try:
            speed = 0.0 if at_rest and model.speed is None else model.speed
            asked = model.motion_quantities.find(node.name)
            asked.check_rate(speed)
            if asked.needs > 1:
                return (
                    f'column {node.column}: "{node.spelling}" follows from accelerations, which '
                    "follow from the loads: a load has positions, velocities and t"
                )
        except LinkworkError as error:
            return f"column {node.column}: {error}"
    return None


# ----------------------------------------------------------------------
# Forces of a position and of a motion as results.


def forces_of_position(model: Model, position: Position, place: KeyWords = key_text) -> Reactions:
    """Efforts and reactions at one position; ``place`` words the key of a load without a value.

    Raises
    ------
    InputError
        If nothing loads the mechanism.
    """
    return _reactions(model, position, dict(position.input), position.input_units, (), place)


def forces_of_motion(model: Model, motion: Motion, place: KeyWords = key_text) -> Reactions:
    """Efforts and reactions in all rows of a motion of the mechanism; raises like
    :func:`forces_of_position`, and for other motions.
    """
    check_class("the motion", motion, Motion)
    if model.untimed is None and TIME in motion.inputs:  # a simulated motion
        model = model_in_time(model)
    check_own_motion(model, motion)
    found = _reactions(model, motion, motion.inputs, motion.input_units, (len(motion),), place)
    if TIME in motion.inputs or any(motion.limit) or not motion.found.all() or len(motion) < 2:
        return found
    names = [*found.inputs, *found.values]
    return replace(found, at_switches=ComputedDict(names, _SwitchValues(model, motion).of))


class _SwitchValues:
    """Quantities on both sides of all switches of loads in a table, computed at first need."""

    def __init__(self, model: Model, motion: Motion) -> None:
        self.model, self.motion = model, motion

    @cached_property
    def rows(self) -> Solved | None:
        """The positions; ``None`` if nothing switches."""
        lead = list(self.motion.inputs).index(self.model.motion_quantities.names.lead)
        t = np.asarray(list(self.motion.inputs.values())[lead]) * self.model.input_scale[lead]
        at = between_rows(self.model, self.motion)
        places = beside_switches(self.model, at, np.sort(t))
        return at(places) if len(places) else None

    def of(self, name: str) -> Array:
        """A quantity, (2K,)."""
        if self.rows is None:
            return np.zeros(0)
        found: Array = self.model.quantities.find(name).values(self.rows, self.model.speed)
        return found


def _reactions(
    model: Model,
    solved: Solved,
    inputs: Mapping[str, Array] | Mapping[str, float],
    input_units: Mapping[str, str],
    shape: tuple[int, ...],
    place: KeyWords,
) -> Reactions:
    if not getattr(model.description, "loaded", False):
        raise InputError(
            f"nothing loads {model.description.name}: add [masses], [[loads]] or a spring with a "
            "stiffness"
        )
    check_formulas(model, at_rest=False)
    rows = solve_forces(model, solved)
    values = rows.values.items()
    return Reactions(
        mechanism=model.description.name,
        inputs={name: np.asarray(value) for name, value in inputs.items()},
        input_units=input_units,
        values={name: force.value.reshape(shape) for name, force in values},
        kinds={name: force.kind for name, force in values},
        units={name: model.units.of(force.kind) for name, force in values},
        about={name: force.about for name, force in values},
        statuses=ForceStatus.of_codes(rows.status),
        undetermined={name: force.undetermined.reshape(shape) for name, force in values},
        lifted={name: force.lifted.reshape(shape) for name, force in values},
        slipping={name: force.slipping.reshape(shape) for name, force in values},
        undefined={
            f'{place(key)} "{formula}"': rows.undefined[formula].reshape(shape)
            for key, formula in load_formulas(model.description)
            if formula in rows.undefined
        },
        proved=rows.proved.reshape(shape),
    )


# ----------------------------------------------------------------------
# Search for input values at which friction stops a mechanism.


_MOVES = (ForceStatus.FOUND, ForceStatus.UNDETERMINED)
_MOST_ROWS = 80
_PRECISE = 1e-11  # of the input value


def locate_stalls(
    model: Model, rows: Motion, *, configuration: str | None = None
) -> tuple[Stall, ...]:
    """Where the rows of a motion change between motion and self-locking; none with several inputs.

    The interval between two rows is halved to the precision of the input; the bracket is the
    narrowest with proofs on both sides.

    Raises
    ------
    InputError
        If nothing loads the mechanism.
    """
    found = forces_of_motion(model, rows)
    if len(rows.inputs) != 1:
        return ()
    name = next(iter(rows.inputs))
    stalls = []
    for k, (first, second) in enumerate(zip(found.statuses, found.statuses[1:], strict=False)):
        locks = ForceStatus.SELF_LOCKING
        if (first in _MOVES and second is locks) or (first is locks and second in _MOVES):
            values = [float(v) for v in rows.inputs[name][k : k + 2]]
            moving, locked = values if second is locks else values[::-1]
            search = _Search(model, name, configuration)
            stall = search.between(moving, locked)
            if stall is not None:
                stalls.append(stall)
    return tuple(stalls)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Row:
    """Whether an effort moves the mechanism at an input value, and whether this is proved."""

    value: float
    position: Position
    moves: bool
    proved: bool


@dataclass(frozen=True, eq=False)
class _Search:
    model: Model
    name: str
    configuration: str | None

    def at(self, value: float) -> _Row | None:
        """The row at an input value; ``None`` without forces."""
        if self.configuration is None:
            position = motion.solve(self.model, value)
        else:
            position = solve_configuration(self.model, value, self.configuration)
        found = forces_of_position(self.model, position)
        if found.status not in (*_MOVES, ForceStatus.SELF_LOCKING):
            return None
        return _Row(
            value=value,
            position=position,
            moves=found.status in _MOVES,
            proved=bool(found.proved) and position.certificate.certified,
        )

    def between(self, moving: float, locked: float) -> Stall | None:
        """The stall between two values; ``None`` if a position between them is missing."""
        near, far = self.at(moving), self.at(locked)
        # another branch than that of the rows has no stall there
        if near is None or far is None or not near.moves or far.moves:
            return None
        for _ in range(_MOST_ROWS):
            if abs(far.value - near.value) <= _PRECISE * max(abs(far.value), abs(near.value)):
                break
            row = self.at(0.5 * (near.value + far.value))
            if row is None:
                return None
            near, far = (row, far) if row.moves else (near, row)
        # rows near the stall are too ill-conditioned to be proved: step back from it
        width = near.value - far.value
        ends = self._proved(near, moving, width), self._proved(far, locked, -width)
        known = [
            own.value if end is None else end for own, end in zip((near, far), ends, strict=True)
        ]
        names = self.model.motion_quantities.names
        return Stall(
            input=self.name,
            value=near.value,
            unit=self.model.units.of(names.inputs[self.name]),
            bracket=(known[0], known[1]),
            proved=None not in ends,
            position=near.position,
        )

    def _proved(self, row: _Row, end: float, step: float) -> float | None:
        """The nearest value towards the end of its side at which the answer is proved."""
        side = row.moves
        while not row.proved:
            if row.value == end:
                return None
            # proofs need a distance from the stall that rounding does not give
            step *= 10.0
            value = row.value + step if abs(step) < abs(end - row.value) else end
            found = self.at(value)
            if found is None or found.moves is not side:
                return None
            row = found
        return row.value
