"""One position at one input value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.errors import NotConvergedError
from linkwork.foundation.status import Status
from linkwork.foundation.value_types import check_flags, given_or
from linkwork.motion import failure as why, following
from linkwork.motion.model import Model
from linkwork.motion.named_quantities import name_series
from linkwork.motion.positions import (
    Evidence,
    SolvedPosition,
    found_message,
    input_rate,
    position_of,
    target_values,
)
from linkwork.motion.redundancy import FITS, lengths_found, misfit, without_redundant
from linkwork.motion.start import Start, first_position
from linkwork.numerics.newton import NewtonOptions
from linkwork.numerics.proof.position_proof import prove, roots_proved, rounding_of_inputs
from linkwork.numerics.rows import SolvedRows
from linkwork.results.failure import Failure, Remedy
from linkwork.results.position import Certificate, Position

__all__ = ["failed_position", "solve"]


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
            failure = why.without_start(model, failure, inputs)
        position = failed_position(model, target, start.status, failure, start)
    elif from_guess or np.array_equal(inputs, model.start_inputs):
        found = _arrived(model, start, certify)
        position = _position(model, target, found, start, _other_root(model, start.v))
    else:
        reached = following.follow_to_value(model, start.v, target, certify)
        if isinstance(reached, following.OutOfReach):
            position = failed_position(model, target, reached.status, reached.failure, start)
        elif reached.status.ok and not roots_proved(model.compiled.solver, reached.v[None, :])[0]:
            failure = why.root_not_proved(model, start.v, reached.v, options)
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
            return why.another_root(model, found)
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
