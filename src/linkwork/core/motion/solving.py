"""The start position: Newton-Raphson from the guess at its input value."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from linkwork import wings
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, MechanismError, NotConvergedError, Problem
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.foundation.values import check_flags, given_or
from linkwork.core.mechanism.description import Description
from linkwork.core.motion import followed as following
from linkwork.core.motion.model import (
    FITS,
    Model,
    lengths_found,
    misfit,
    model_of,
    without_redundant,
)
from linkwork.core.motion.positions import (
    Evidence,
    SolvedPosition,
    found_message,
    input_rate,
    name_series,
    position_of,
    target_values,
)
from linkwork.core.numerics.newton import NewtonOptions, SolvedRows, Watch
from linkwork.core.numerics.position_proof import prove, roots_proved, rounding_of_inputs
from linkwork.core.results.failure import Failure, Remedy
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Certificate, NewtonStep, NewtonTrail, Position
from linkwork.core.results.quantity import Kind


@dataclass(frozen=True, kw_only=True)
class Start:
    """A solved (or failed) first position: variables (N,), evidence and the iterates.

    ``failure`` explains why there is none.
    """

    v: Array
    status: Status
    message: str
    iterations: int
    residual: float
    trails: tuple[NewtonTrail, ...]
    failure: Failure | None = None


def first_position(
    model: Model,
    inputs: Array,
    options: NewtonOptions,
    with_steps: bool = False,
    *,
    explained: bool = True,
) -> Start:
    """Newton-Raphson from the guess with the given input values (p,), internal units.

    Explaining why there is no position takes many times longer than looking for it.
    """
    solver = model.compiled.solver
    v = model.equations.start.copy()
    v[solver.unknowns :] = inputs
    watchers = [_Watcher(model, k) for k in range(len(solver.blocks))]
    watches: list[Watch | None] | None = list(watchers) if with_steps else None
    done = solver.solve(v[None, :], options, watches)
    status = Status.of_code(int(done.status[0]))
    failure = None
    if not status.ok and explained:
        status, failure = wings.use("circuits.failure.failing").no_position(
            model, v, status, int(done.failed_block[0]), options
        )
    if status.ok and not roots_proved(solver, done.v)[0]:
        status = Status.ROOT_NOT_PROVED
        if explained:
            failure = wings.use("circuits.failure.failing").root_not_proved(
                model, v, done.v[0], options
            )
    trails = []
    for k, watcher in enumerate(watchers):
        if watcher.steps:
            failed = k == done.failed_block[0]
            code = int(done.status[0]) if failed else Status.CONVERGED.code
            trails.append(watcher.trail(Status.of_code(code)))
    return Start(
        v=done.v[0],
        status=status,
        message=status.value if failure is None else failure.message,
        iterations=int(done.iterations[0]),
        residual=float(done.residual[0]),
        trails=tuple(trails),
        failure=failure,
    )


class _Watcher:
    """Notes the iterates of one block in file units."""

    def __init__(self, model: Model, number: int) -> None:
        self.block = model.compiled.solver.blocks[number]
        labels, loops = model.equations.labels, len(model.equations.loops)
        self.equations = tuple(labels[e] for e in self.block.equations)
        closed = [labels[e] for e in self.block.equations if e < loops]
        others = (labels[e] for e in self.block.equations if e >= loops)
        # the parts of all loops, then the equations that are real themselves
        self.rows = (*(f"{name}, {part}" for part in "xy" for name in closed), *others)
        self.variables = [model.equations.unknowns[k] for k in self.block.unknowns]
        self.scales = [model.units.scale(Kind(v.kind)) for v in self.variables]
        self.steps: list[NewtonStep] = []

    def __call__(self, k: int, v: Array, residual: Array, change: Array | None) -> None:
        n = len(self.variables)
        weights = self.block.system.variable_scale[:n]
        jacobian = self.block.system.jacobian(v[:1])[0, :, :n]
        self.steps.append(
            NewtonStep(
                k=k,
                unknowns=self._named(v[0, :n]),
                residual=float(np.linalg.norm(residual[0])),
                step=None if change is None else float(np.abs(change[0] / weights).max()),
                values=tuple(residual[0].tolist()),
                jacobian=tuple(map(tuple, jacobian.tolist())),
                changes={} if change is None else self._named(change[0]),
            )
        )

    def _named(self, values: Array) -> dict[str, float]:
        """Values of the unknowns (n,) by name, in file units."""
        triples = zip(self.variables, values, self.scales, strict=True)
        return {variable.name: float(value / scale) for variable, value, scale in triples}

    def trail(self, status: Status) -> NewtonTrail:
        """The iterates with how they ended."""
        return NewtonTrail(
            equations=self.equations, rows=self.rows, steps=tuple(self.steps), status=status
        )


# ----------------------------------------------------------------------
# One position at one input value.


def solve(
    model: Model,
    at: float | Mapping[str, float] | None = None,
    *,
    from_guess: bool = False,
    options: NewtonOptions | None = None,
    certify: bool = True,
    with_steps: bool = False,
    throw: bool = False,
) -> Position:
    """The position at one input value.

    Newton-Raphson finds the position at the guess's own input value; the branch is then followed
    to the value asked, and the other way around if a limit is met on the way.

    Parameters
    ----------
    at : number or Mapping[str, number], optional
        Input value(s) in file units; the guess's own if left out.
    from_guess : bool
        Start Newton-Raphson at the asked value directly, as the textbook's example does.
    certify : bool
        Prove the position, and that the motion to it stays on the guess's branch.
    with_steps : bool
        Keep the iterates of Newton-Raphson at the value asked, started from the guess. Where that
        is another value than the guess's own, they may end at another position.
    throw : bool
        Raise instead of returning a position that was not found.

    Raises
    ------
    UnknownNameError, InputError
        For input values that do not fit the mechanism.
    NotConvergedError
        Only with ``throw``.
    """
    check_flags(certify=certify, from_guess=from_guess, with_steps=with_steps, throw=throw)
    options = given_or(NewtonOptions(), "options", options)
    target = target_values(model, at)
    inputs = target * model.input_scale
    start = first_position(model, inputs if from_guess else model.start_inputs, options, with_steps)
    if with_steps and not from_guess and not np.array_equal(inputs, model.start_inputs):
        tried = first_position(model, inputs, options, True, explained=False)
        start = replace(start, trails=tried.trails)
    if not start.status.ok:
        failure = start.failure
        if (
            failure is not None
            and not from_guess
            and not np.array_equal(inputs, model.start_inputs)
        ):
            failure = wings.use("circuits.failure.failing").without_start(model, failure, inputs)
        position = failed_position(model, target, start.status, failure, start)
    elif from_guess or np.array_equal(inputs, model.start_inputs):
        found = _arrived(model, start, certify)
        position = _position(model, target, found, start, _other_root(model, start.v))
    else:
        reached = following.follow_to_value(model, start.v, target, certify)
        if isinstance(reached, following.OutOfReach):
            position = failed_position(model, target, reached.status, reached.failure, start)
        elif reached.status.ok and not roots_proved(model.compiled.solver, reached.v[None, :])[0]:
            failure = wings.use("circuits.failure.failing").root_not_proved(
                model, start.v, reached.v, options
            )
            last = replace(start, v=reached.v, residual=reached.residual)
            position = failed_position(model, target, Status.ROOT_NOT_PROVED, failure, last)
        else:
            reached = replace(reached, iterations=start.iterations + reached.iterations)
            position = _position(model, target, reached, start)
    if throw and not position.status.ok:
        raise NotConvergedError(position.message)
    return position


def _arrived(model: Model, start: Start, certify: bool) -> SolvedPosition:
    """The start itself is the position asked for."""
    return SolvedPosition(
        v=start.v,
        status=start.status,
        residual=start.residual,
        iterations=start.iterations,
        certificate=_certificate(model, start.v) if certify else Certificate(),
    )


def _certificate(model: Model, v: Array) -> Certificate:
    """Of one position (N,) that nothing was followed to."""
    solver = model.compiled.solver
    proof = prove(solver, v[None, :], rounding_of_inputs(v[None, :], solver.unknowns))
    if not proof.holds[0]:
        return Certificate(certification=Certification.POSITION_NOT_PROVED)
    return Certificate(
        certification=Certification.CERTIFIED,
        radius=float(proof.radius[0]),
        unique_within=float(proof.least_uniqueness_radius[0]),
    )


def _other_root(model: Model, found: Array) -> Failure | None:
    """The failure of a position (N,) on the other side of the guess: det J has another sign."""
    solver = model.compiled.solver
    here = found.copy()
    here[: solver.unknowns] = model.equations.start[: solver.unknowns]
    for block in solver.blocks:
        both = np.stack([here, found])[:, block.variables]
        slopes = block.system.jacobian(both)[:, :, : len(block.unknowns)]
        # the guess and the position lie on different sides of a dead point
        if np.prod(np.sign(np.linalg.det(slopes))) <= 0.0:
            return wings.use("circuits.failure.failing").another_root(model, found)
        # the next block is compared with its known variables as solved
        here[block.unknowns] = found[block.unknowns]
    return None


def failed_position(
    model: Model, target: Array, status: Status, failure: Failure | None, start: Start
) -> Position:
    """No position at the values (p,), in file units, with the reason and the iterates.

    Where formulas are small without a proof of a root, the unknowns are those of the last iterate.
    """
    nothing = np.full((1, model.compiled.solver.variables), np.nan)
    v = start.v[None, :] if status is Status.ROOT_NOT_PROVED else nothing
    named = name_series(model, v, nothing, nothing, target[None, :], np.array([v is not nothing]))
    evidence = Evidence(
        status=status,
        message=status.value if failure is None else failure.message,
        residual=start.residual,
        iterations=start.iterations,
        condition=np.inf,
        certificate=Certificate(certification=Certification.NO_POSITION),
        trails=start.trails,
        failure=failure,
    )
    return position_of(model, named, 0, evidence, v[0, : model.compiled.solver.unknowns])


def _does_not_fit(model: Model, v: Array) -> Failure:
    """The lengths that redundant links would need at a position (N,) of the others."""
    lengths = lengths_found(model.equations, v)
    remedies = [
        Remedy(length=" ".join(part.points), now=part.length, needed=length, exact=True)
        for part, length in zip(model.equations.redundant, lengths, strict=True)
        if abs(length - part.length) > FITS * model.equations.length_scale
    ]
    return Failure(what=Status.DOES_NOT_FIT.value, remedies=tuple(remedies), units=model.units)


def _at_limit(v: Array, first: Array) -> SolvedRows:
    """A position v (1, N) where a branch ends: the first derivatives (N,) exist, no second."""
    nothing = np.full((1, len(first)), np.nan)
    return SolvedRows(v=v, first=first[None, :], second=nothing, condition=np.full(1, np.inf))


def _position(
    model: Model, target: Array, found: SolvedPosition, start: Start, failure: Failure | None = None
) -> Position:
    """The position that was found, named and with its derivatives."""
    solver = model.compiled.solver
    v = found.v[None, :]
    if found.status.ok and misfit(model.equations, v)[0] > FITS:
        return failed_position(
            model, target, Status.DOES_NOT_FIT, _does_not_fit(model, found.v), start
        )
    rates = solver.rates(v, input_rate(model)) if found.first is None else _at_limit(v, found.first)
    ok = np.array([found.status.ok])
    named = name_series(model, v, rates.first, rates.second, target[None, :], ok)
    condition = float(rates.condition[0])
    evidence = Evidence(
        status=found.status,
        message=found_message(found.status, condition, failure),
        residual=found.residual,
        iterations=found.iterations,
        condition=condition,
        certificate=replace(
            found.certificate,
            certification=without_redundant(model.equations, found.certificate.certification),
        ),
        trails=start.trails,
        failure=failure,
    )
    return position_of(model, named, 0, evidence, found.v[: solver.unknowns])


# ----------------------------------------------------------------------
# The model of a mechanism, started in the configuration that its description names.


def as_described(description: Description) -> Model:
    """The model of a mechanism, started from the configuration that it names, if it names one.

    Raises
    ------
    MechanismError
        With every problem found.
    """
    model = model_of(description)
    if not description.configuration:
        return model
    try:
        return wings.use("circuits.circuit_list").start_in_configuration(
            model, description.configuration
        )
    except InputError as error:
        problem = Problem(key=("configuration",), message=str(error))
        raise MechanismError([problem], f'mechanism "{description.name}"') from None


# ----------------------------------------------------------------------
# The start of a motion at round input values, for pictures.


_STEPS = 50  # a round value is at most about this fraction of the range away


def solve_round_start(model: Model, cycle: Motion, start: Position | None = None) -> Position:
    """The position at the round input values nearest to the start; the start if it is not found.

    Parameters
    ----------
    cycle : Motion
        A motion of the mechanism, for the ranges of its inputs.
    start : Position, optional
        The start; by default the position at the input values of the guess.
    """
    start = solve(model) if start is None else start
    if not start.status.ok:
        return start
    values = {
        name: _round(value, float(np.ptp(cycle.inputs[name])))
        for name, value in start.input.items()
        if name in cycle.inputs
    }
    if values == dict(start.input):
        return start
    near = solve(model, values)
    return near if near.status.ok else start


def _round(value: float, span: float) -> float:
    """The value to a power of ten up to a fiftieth of a range; as it is without a range."""
    if not span:
        return value
    return round(value, -math.floor(math.log10(span / _STEPS)))
