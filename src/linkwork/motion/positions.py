"""Rows of a solved batch as positions with their evidence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.status import Status
from linkwork.motion.leading_input import leading_input
from linkwork.motion.model import Model
from linkwork.motion.named_quantities import Named
from linkwork.motion.redundancy import largest_misfits
from linkwork.results.failure import Failure
from linkwork.results.position import Certificate, NewtonTrail, Position
from linkwork.results.series import Series

__all__ = [
    "Evidence",
    "SolvedPosition",
    "found_message",
    "input_rate",
    "position_of",
    "target_values",
]

_HOPELESS = 1e12  # condition beyond which derivatives mean nothing
_SINGULAR = (
    "position found at a dead point or change point, where its derivatives do not exist and no "
    "motion can start"
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Evidence:
    """How a position was found, or why not."""

    status: Status
    message: str
    residual: float
    iterations: int
    condition: float
    certificate: Certificate
    trails: tuple[NewtonTrail, ...] = ()
    configuration: str = ""
    failure: Failure | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class SolvedPosition:
    """A position, found or not according to ``status``: variables v (N,) and evidence.

    ``first`` (N,): derivatives at a dead point or change point, NaN where there are none.
    """

    v: Array
    status: Status
    residual: float
    iterations: int
    certificate: Certificate
    first: Array | None = None


def found_message(status: Status, condition: float, failure: Failure | None = None) -> str:
    """The sentence for a status, its explanation, or that of a position too near to singular."""
    # such a position counts as found, but its derivatives are noise
    if status.ok and condition > _HOPELESS:
        return _SINGULAR
    return status.value if failure is None else failure.message


def target_values(model: Model, at: float | Mapping[str, float] | None) -> Array:
    """The input values asked for, in file units, (p,); the guess's own for ``None``.

    Raises
    ------
    UnknownNameError, InputError
        For input values that do not fit the mechanism.
    """
    if at is None:
        return model.start_in_file_units
    if not isinstance(at, Mapping):
        inputs = model.equations.inputs
        at = {inputs[0].name if len(inputs) == 1 else "": at}
    return model.input_values(dict(at))


def input_rate(model: Model) -> Array:
    """How all inputs move by the leading one, (p,)."""
    rows = model.rows if model.description.inputs else np.zeros((1, 0))
    return leading_input(rows)[1]


def position_of(model: Model, named: Named, row: int, evidence: Evidence, q: Array) -> Position:
    """One row of named quantities as a position; ``q`` (n,) in internal units."""
    everything: dict[str, Series] = {
        **named.unknowns,
        **named.links,
        **named.sliders,
        **named.outputs,
        **{s.quantity.name: s for pair in named.points.values() for s in pair},
    }
    first = {name: float(s.first[row]) for name, s in everything.items()}
    second = {name: float(s.second[row]) for name, s in everything.items()}
    speed = model.speed
    return Position(
        mechanism=model.description.name,
        units=model.units,
        skeleton=model.skeleton,
        quantities=model.quantities,
        status=evidence.status,
        message=evidence.message,
        input={name: float(value[row]) for name, value in named.inputs.items()},
        input_units=model.input_units,
        derivative_unit=model.derivative_unit,
        unknowns=_values(named.unknowns, row),
        links=_values(named.links, row),
        sliders=_values(named.sliders, row),
        points={
            name: (float(x.value[row]), float(y.value[row]))
            for name, (x, y) in named.points.items()
        },
        outputs=_values(named.outputs, row),
        value_units={name: model.units.of(s.quantity.kind) for name, s in everything.items()},
        first=first,
        second=second,
        velocity={} if speed is None else {n: d * speed for n, d in first.items()},
        acceleration={} if speed is None else {n: d * (speed * speed) for n, d in second.items()},
        speed=speed,
        residual=evidence.residual,
        iterations=evidence.iterations,
        condition=evidence.condition,
        certificate=evidence.certificate,
        configuration=evidence.configuration,
        q=q,
        steps=evidence.trails,
        failure=evidence.failure,
        redundant=_misfits(model, q),
    )


def _misfits(model: Model, q: Array) -> dict[str, float]:
    """How far redundant links are from their lengths; none where there is no position."""
    if not model.equations.redundant or np.isnan(q).any():
        return {}
    return largest_misfits(model.equations, q[None, :])


def _values(table: Mapping[str, Series], row: int) -> dict[str, float]:
    return {name: float(series.value[row]) for name, series in table.items()}
