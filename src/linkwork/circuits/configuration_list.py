"""All configurations at one input value, as positions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from linkwork.circuits.assembling import Assemblies, positions_at
from linkwork.circuits.circuit_list import branch_start, is_branch_name
from linkwork.circuits.homotopy.isolated_roots import SEED
from linkwork.circuits.results import Configurations
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, NotConvergedError, UnknownNameError, choices
from linkwork.core.foundation.statuses import Certification, Completeness, Status
from linkwork.core.motion.model import Model, without_redundant
from linkwork.core.motion.positions import (
    Evidence,
    found_message,
    input_rate,
    name_series,
    position_of,
    target_values,
)
from linkwork.core.motion.solving import failed_position, first_position, solve
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.results.failure import Failure
from linkwork.core.results.position import Certificate, Position

_NONE = "there is no configuration at this input: the loops cannot be closed"


def configurations(model: Model, at: float | Mapping[str, float] | None = None) -> Configurations:
    """All configurations at one input value, each with its certificate.

    Blocks of one loop are solved in closed form, larger ones by following the solutions of a
    random system of the same structure (:mod:`linkwork.circuits.homotopy.isolated_roots`).

    Parameters
    ----------
    at : number or Mapping[str, number], optional
        Input value(s) in file units; the guess's own if left out.

    Raises
    ------
    UnknownNameError, InputError
        For input values that do not fit the mechanism.
    """
    target = target_values(model, at)
    found = positions_at(model, target * model.input_scale)
    names = (variable.name for variable in model.equations.inputs)
    return Configurations(
        mechanism=model.description.name,
        positions=_positions(model, target, found),
        completeness=found.completeness,
        message=found.message,
        input=dict(zip(names, target.tolist(), strict=True)),
        input_units=model.input_units,
        paths=found.paths,
        seed=SEED,
    )


def _positions(model: Model, target: Array, found: Assemblies) -> tuple[Position, ...]:
    count, solver = len(found.v), model.compiled.solver
    if not count:
        return ()
    rates, proof = solver.rates(found.v, input_rate(model)), found.proof
    residual = solver.residual(found.v)
    inputs = np.repeat(target[None, :], count, axis=0)
    named = name_series(
        model, found.v, rates.first, rates.second, inputs, np.ones(count, dtype=bool)
    )
    status = Status.CONVERGED
    positions = []
    for k in range(count):
        certificate = Certificate(certification=Certification.POSITION_NOT_PROVED)
        if proof.holds[k]:
            certificate = Certificate(
                certification=without_redundant(
                    model.equations, Certification.CONFIGURATION_CERTIFIED
                ),
                radius=float(proof.radius[k]),
                unique_within=float(proof.least_uniqueness_radius[k]),
            )
        evidence = Evidence(
            status=status,
            message=found_message(status, float(rates.condition[k])),
            residual=float(residual[k]),
            iterations=int(found.iterations[k]),
            condition=float(rates.condition[k]),
            certificate=certificate,
            configuration=found.names[k],
        )
        positions.append(position_of(model, named, k, evidence, found.v[k, : solver.unknowns]))
    return tuple(positions)


def solve_configuration(
    model: Model, at: float | Mapping[str, float] | None, name: str, *, throw: bool = False
) -> Position:
    """The position at one input value in a named configuration, or on a named branch.

    Raises
    ------
    UnknownNameError, InputError
        If there is no configuration of this name at this input, or they cannot be listed.
    NotConvergedError
        Only with ``throw``: if there is no configuration at all at this input.
    """
    if is_branch_name(name):
        return solve(branch_start(model, name), at, throw=throw)
    found = configurations(model, at)
    if found.completeness is Completeness.NOT_LISTED:
        raise InputError(f"{model.description.name}: {found.message}")
    if len(found):
        return found[name]
    position = _explain_unassembled(model, target_values(model, at))
    if throw:
        raise NotConvergedError(position.message)
    return position


def _explain_unassembled(model: Model, target: Array) -> Position:
    """The message where there is no configuration: the loop that does not close, if one is known.

    Newton-Raphson is tried from the guess, as for every position; the message is that of its
    failure.
    """
    start = first_position(model, target * model.input_scale, NewtonOptions())
    if start.failure is not None:
        return failed_position(model, target, start.status, start.failure, start)
    failure = Failure(what=_NONE, units=model.units)
    return failed_position(model, target, Status.CANNOT_CLOSE, failure, start)


def start_in_configuration(model: Model, name: str) -> Model:
    """The model with a named configuration, at the guess's own input value, as its guess.

    A name such as ``circuit 1 branch 2`` takes a position on that branch instead.

    Raises
    ------
    UnknownNameError, InputError
        If there is no configuration of this name, or they cannot be listed.
    """
    if is_branch_name(name):
        return branch_start(model, name)
    found = positions_at(model, model.start_inputs)
    if found.completeness is Completeness.NOT_LISTED:
        raise InputError(f"{model.description.name}: {found.message}")
    if name not in found.names:
        raise UnknownNameError(
            f'there is no configuration "{name}" of {model.description.name} at its guess\'s '
            f"input {choices('configurations', found.names, name)}"
        )
    start = found.v[found.names.index(name)]
    return replace(model, equations=replace(model.equations, start=start), branch=name)
