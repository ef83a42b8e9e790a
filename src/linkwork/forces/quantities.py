"""The quantities of forces in the registry of a mechanism."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Protocol, runtime_checkable
from weakref import WeakKeyDictionary

import numpy as np

from linkwork.expression.grammar import CONSTANTS, parse
from linkwork.expression.jets import Jet
from linkwork.expression.tree import names_in
from linkwork.forces.applied import load_formulas
from linkwork.forces.system import ForceRows, solve_forces
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import LinkworkError, MechanismError, Problem
from linkwork.motion.model import Model
from linkwork.motion.named_quantities import RowValues
from linkwork.results.quantities.definition import (
    UNKNOWN,
    MechanismNames,
    RowQuantity,
    Solved,
)
from linkwork.results.quantity import Kind

__all__ = ["check_formulas", "force_quantities"]


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
