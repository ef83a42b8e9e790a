"""Sensitivities of quantities at a position, over a table, and of numbers of a whole motion."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.arrays import AnyArray, Array
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.mechanism.varied_numbers import VariedNumber
from linkwork.core.motion.model import Model, leading_input
from linkwork.core.results.failure import LimitKind
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from linkwork.core.results.quantities.definition import Asked, AskedOfMotion, Group, RowSlopes
from linkwork.design.derivatives.forces import LoadedRows
from linkwork.design.derivatives.rows import (
    DifferentiatedFolds,
    DifferentiatedRows,
    RegularRows,
    chosen_numbers,
    groups_of,
    row_of,
    rows_of,
)
from linkwork.design.tolerance_results import Sensitivity, SensitivityStatus

#: The ends of the range of the leading input, as numbers of a motion.
LIMITS = ("limit.lower", "limit.upper")

_FITS = 1e-9  # longest links per unit of a number: a redundant link that follows still fits


def is_of_motion(of: str) -> bool:
    """Whether a name is that of a number of a whole motion."""
    return "(" in of or of.strip() in LIMITS


def play_of(
    model: Model, solved: Position | Motion, of: str, pins: Sequence[tuple[str, str]]
) -> Array:
    """The derivatives of a quantity by the displacement of points of links from their pins.

    Their size is the force in the pin for a unit load at the quantity with the input held, eq.
    (124). Of a number of a motion a journal may lie differently in each row on which an extreme
    depends; where rates enter, such as in the length of a path, it stays where it is in all rows.

    Parameters
    ----------
    pins : sequence of (link, point)

    Returns
    -------
    array (pins, rows, 2)
        Of a position one row.
    """
    if isinstance(solved, Motion):
        _, _, parts = _number_and_parts(model, solved, of)
        plays = []
        for part in parts:
            rates = part.rates(model, (), pins)
            moved = rates.reshape(len(pins), 2, rates.shape[1]).swapaxes(1, 2)
            plays.append(moved if part.depends_on_values else moved.sum(axis=1, keepdims=True))
        return np.concatenate(plays, axis=1) if plays else np.zeros((len(pins), 0, 2))
    quantity, row = model.quantities.find(of), row_of(model, solved)
    taped = LoadedRows(model, (), row.differentiable, quantity.needs, pins)
    with np.errstate(all="ignore"):
        # R of eq. (124)
        rates = taped.tape.backward(quantity.values(taped, taped.speed))
    return np.broadcast_to(rates, (2 * len(pins), 1)).reshape(len(pins), 1, 2)


def sensitivity_of(
    model: Model, solved: Position | Motion, of: str, by: Iterable[str] | None = None
) -> Sensitivity:
    """The derivatives of a quantity at a position or in all rows of a motion, or of a number of a
    motion.

    Raises
    ------
    UnknownNameError, InputError
        For a name that is not known, a number that cannot vary, or one whose derivatives are not
        known.
    """
    shape: tuple[int, ...] = ()
    inputs: Mapping[str, AnyArray]
    if isinstance(solved, Motion):
        if is_of_motion(of):
            return _of_motion(model, solved, of, by)
        rows, inputs, shape = rows_of(model, solved), solved.inputs, (len(solved),)
    else:
        rows = row_of(model, solved)
        inputs = {name: np.asarray(value) for name, value in solved.input.items()}
    named = model.quantities.find(of)
    _check(named, of)
    named.check_rate(model.speed)
    numbers, refused = _fitting_numbers(model, rows, by)
    v = rows.differentiable
    derivatives: dict[str, Array] = {}
    for group in groups_of(model.description, numbers):
        taped = LoadedRows(model, group, v, named.needs)
        with np.errstate(all="ignore"):
            rates = taped.tape.backward(named.values(taped, taped.speed))
        each = (len(group), len(v))
        rates = np.broadcast_to(rates, each) + _fitting(taped, each)
        derivatives |= dict(zip((q.name for q in group), rates, strict=True))
    value = np.broadcast_to(np.atleast_1d(named.values(solved, model.speed)), len(v))
    status = np.full(len(v), SensitivityStatus.FOUND.code)
    corner = np.isnan(value)
    for name, rates in derivatives.items():
        # where the quantity itself does not exist its derivatives do not either
        derivatives[name] = np.where(np.isfinite(value), rates, np.nan)
        corner = corner | ~np.isfinite(derivatives[name])
    status[corner] = SensitivityStatus.CORNER.code
    status[~rows.regular] = SensitivityStatus.DEAD_POINT.code
    status[~rows.found] = SensitivityStatus.NO_POSITION.code
    return _result(
        model, of=named.name, unit=named.unit, inputs=inputs, value=value.reshape(shape),
        derivatives={name: rates.reshape(shape) for name, rates in derivatives.items()},
        numbers=numbers, statuses=SensitivityStatus.of_codes(status), refused=refused)  # fmt: skip


def _fitting_numbers(
    model: Model, rows: RegularRows, by: Iterable[str] | None
) -> tuple[tuple[VariedNumber, ...], Mapping[str, str]]:
    """The numbers that can vary alone, in a position of redundant links too; why others cannot.

    Raises
    ------
    InputError
        For a requested number that would break the fit of a redundant link.
    """
    numbers, refused = chosen_numbers(model, by)
    # whether a redundant link follows is the same in all positions
    there = np.flatnonzero(rows.found & rows.regular)
    if not model.equations.redundant or not len(there):
        return numbers, refused
    for group in groups_of(model.description, numbers):
        taped = DifferentiatedRows(model, group, rows.v[there[:1]], 0)
        fits = np.isfinite(_fitting(taped, (len(group), 1)))[:, 0]
        why = "a redundant link does not fit any more"
        refused |= {q.name: why for q, fitting in zip(group, fits, strict=True) if not fitting}
    wrong = [q.name for q in numbers if q.name in refused]
    if by is not None and wrong:
        raise InputError(f'"{wrong[0]}" cannot vary: {refused[wrong[0]]}')
    return tuple(q for q in numbers if q.name not in refused), refused


def _check(quantity: Asked, of: str) -> None:
    if quantity.group is Group.EVIDENCE:
        raise InputError(f'"{of}" measures how a position was found: it has no sensitivity')
    if quantity.needs > 2:
        raise InputError(
            f'the derivatives of "{of}" are not known: those of positions, velocities and '
            "accelerations are"
        )


def _fitting(taped: DifferentiatedRows, shape: tuple[int, ...]) -> Array:
    """0, or NaN for numbers whose change a redundant link does not follow, (P, B)."""
    corrections = np.zeros(shape)
    for misfit in taped.misfits:
        rates = np.broadcast_to(taped.tape.forward([misfit])[0], shape)
        corrections[np.abs(rates) > _FITS] = np.nan
    return corrections


def _result(
    model: Model, *, of: str, unit: str, inputs: Mapping[str, AnyArray], value: Array,
    derivatives: Mapping[str, Array], numbers: Sequence[VariedNumber],
    statuses: tuple[SensitivityStatus, ...], refused: Mapping[str, str],
) -> Sensitivity:  # fmt: skip
    description = model.description
    kinds = {x.name: x.kind for x in model.equations.variables}
    return Sensitivity(
        mechanism=description.name,
        of=of,
        unit=unit,
        inputs={name: np.asarray(values) for name, values in inputs.items()},
        input_units=model.input_units if inputs else {},
        value=value,
        derivatives={q.name: derivatives[q.name] for q in numbers},
        units={q.name: q.unit(description, kinds) for q in numbers},
        numbers={q.name: q.of(description) for q in numbers},
        statuses=statuses,
        refused=refused,
    )


# Numbers of a whole motion


def _of_motion(model: Model, motion: Motion, of: str, by: Iterable[str] | None) -> Sensitivity:
    """The derivatives of a number of a whole motion: ``stroke(d)``, ``limit.upper``.

    Extremes need no derivative of the place where they are, except at dead points, which move.
    """
    numbers, refused = _fitting_numbers(model, rows_of(model, motion), by)
    value, unit, parts = _number_and_parts(model, motion, of)
    rates = {q.name: np.zeros(()) for q in numbers}
    for part in parts:
        for group in groups_of(model.description, numbers):
            totals = np.sum(part.rates(model, group), axis=1)
            for q, rate in zip(group, totals, strict=True):
                rates[q.name] = rates[q.name] + rate
    finite = all(np.isfinite(rate) for rate in rates.values()) and np.isfinite(value)
    status = SensitivityStatus.FOUND if finite else SensitivityStatus.CORNER
    if not motion.found.any():
        status = SensitivityStatus.NO_POSITION
    return _result(model, of=of.strip(), unit=unit, inputs={}, value=np.asarray(value),
        derivatives=rates, numbers=numbers, statuses=(status,), refused=refused)  # fmt: skip


def _number_and_parts(model: Model, motion: Motion, of: str) -> tuple[float, str, list[_Part]]:
    """The number, its unit, and the rows on which it depends."""
    if of.strip() in LIMITS:
        return _limit(model, motion, of.strip())
    return _number(model, motion, of)


@dataclass(frozen=True, eq=False)
class _Part:
    """What some rows add to a number of a motion: Σ weight · column of a quantity."""

    v: Array
    weights: RowSlopes
    of: AskedOfMotion | None
    fold: bool

    @property
    def depends_on_values(self) -> bool:
        """Whether no rates enter."""
        weights = self.weights
        return not (np.any(weights.first != 0.0) or np.any(weights.second != 0.0))

    def rates(
        self,
        model: Model,
        numbers: Sequence[VariedNumber],
        plays: Sequence[tuple[str, str]] = (),
    ) -> Array:
        """The derivatives by numbers, or by displacements in pins, row by row, (P, B)."""
        needs = 0 if self.of is None else self.of.needs
        kind = DifferentiatedFolds if self.fold else LoadedRows
        taped = kind(model, numbers, self.v, needs, plays)
        with np.errstate(all="ignore"):
            columns: Sequence[Any] = (
                (taped.leading_input,) if self.of is None else self.of.columns(taped, taped.speed)
            )
            weights = (self.weights.value, self.weights.first, self.weights.second)
            total: Any = np.zeros(len(self.v))
            for weight, column in zip(weights, columns, strict=False):
                if np.any(weight != 0.0):
                    total = total + np.real(np.conj(weight) * column)
            rates = taped.tape.backward(total)
        shape = (len(taped.tape.inputs), len(self.v))
        return np.broadcast_to(rates, shape) + _fitting(taped, shape)


def _number(model: Model, motion: Motion, of: str) -> tuple[float, str, list[_Part]]:
    request = model.quantities.find_of_motion(of)
    _check(request.of, of)
    if request.of.rate is not None and request.of.rate.by_time:
        raise UnknownNameError(
            f'"{of}" has no sensitivity: use "{request.of.own.name}.d1", the rate by the input'
        )
    located = motion.located(request)
    value = float(request.number(located.rows))
    with np.errstate(all="ignore"):
        slopes = request.quantity.slopes(located.rows, request.numbers)
    further = cast("Sequence[Motion]", located.further)  # equations of a motion
    rows = rows_of(model, motion, *further).take(located.order)
    return value, request.unit, list(_parts(rows, slopes, request))


def _parts(rows: RegularRows, slopes: RowSlopes, request: AskedOfMotion) -> Iterator[_Part]:
    """Regular rows and dead points that a number depends on."""
    count = len(rows.v)
    weights = [np.broadcast_to(w, count) for w in (slopes.value, slopes.first, slopes.second)]
    # most numbers depend on one or two rows: only these are differentiated
    used = np.any([weight != 0.0 for weight in weights], axis=0) & rows.found
    for fold in (False, True):
        which = np.flatnonzero(used & (rows.regular != fold))
        if len(which):
            names = ("value", "first", "second")
            parts = (weight[which] for weight in weights)
            slopes_of_part = RowSlopes(**dict(zip(names, parts, strict=True)))
            yield _Part(rows.v[which], slopes_of_part, request, fold)


def _limit(model: Model, motion: Motion, of: str) -> tuple[float, str, list[_Part]]:
    """The dead point that ends the range of the leading input."""
    lead = leading_input(model.rows)[0]
    name = model.equations.inputs[lead].name
    side = -1.0 if of == LIMITS[0] else 1.0
    start = model.start_in_file_units[lead]
    ends = [
        limit for limit in motion.limits
        if limit.kind is LimitKind.DEAD_POINT and side * (limit.input - start) >= 0.0
    ]  # fmt: skip
    if not ends:
        raise InputError(
            f"the motion of {name} has no dead point {'below' if side < 0 else 'above'} its start: "
            f"{of} does not exist"
        )
    # the branch ends at the first dead point on either side
    nearest = min(ends, key=lambda limit: side * limit.input)
    rows = rows_of(model, motion)
    there = np.array([word == LimitKind.DEAD_POINT.word for word in motion.limit])
    away = np.where(there & motion.found, np.abs(motion.inputs[name] - nearest.input), np.inf)
    row = int(away.argmin())
    one = np.ones(1) / model.input_scale[lead]
    part = _Part(rows.v[[row]], RowSlopes(value=one), None, fold=True)
    return nearest.input, model.input_units[name], [part]


def sensitivity(
    mechanism: Mechanism,
    of: str,
    at: float | Mapping[str, float] | None = None,
    *,
    by: Iterable[str] | None = None,
    configuration: str | None = None,
    motion: Motion | None = None,
) -> Sensitivity:
    """The derivatives of a quantity by the numbers of the mechanism, exact to rounding.

    With ``at`` those of a position at this input; without it those in all rows of the input's
    table. A number of a whole motion (``stroke(d)``, ``path_length(P)``, ``limit.upper`` for
    the dead point that ends the motion) has one derivative by each number.

    Parameters
    ----------
    of : str
        A quantity, a rate, or a number of a motion, see ``linkwork quantities``.
    at : number or Mapping[str, number], optional
        Input value(s) in file units.
    by : iterable of str, optional
        Numbers that a family can vary: ``"O2 A"``, ``"O4.x"``, ``"a2"``, ``"d.offset"``; by
        default all that the file writes as plain numbers.
    configuration : str, optional
        As in :meth:`~linkwork.Mechanism.solve`.
    motion : Motion, optional
        Instead of the table: a motion of this mechanism, solved already.

    Returns
    -------
    Sensitivity
        Its ``status`` says whether the derivatives exist.

    Raises
    ------
    UnknownNameError, InputError
        If a name is not known, or a number cannot vary alone.

    Examples
    --------
    >>> import linkwork as lw
    >>> found = lw.design.sensitivity(lw.example("slider-crank"), "d", at=60)
    >>> found.effective[0], round(found["B A"], 6)
    ('B A', 1.123196)
    """
    solved: Position | Motion
    if at is None and (mechanism.description.inputs or motion is not None or is_of_motion(of)):
        solved = mechanism.sweep(configuration=configuration) if motion is None else motion
    elif is_of_motion(of):
        raise InputError(f'"{of}" is a number of a whole motion: leave out at')
    else:
        solved = mechanism.solve(at, configuration=configuration)
    return sensitivity_of(mechanism.model, solved, of, by)


def gradient(
    mechanism: Mechanism,
    of: str,
    *,
    by: Iterable[str] | None = None,
    at: float | Mapping[str, float] | None = None,
    configuration: str | None = None,
    motion: Motion | None = None,
) -> dict[str, Array | float]:
    """The derivatives of :func:`sensitivity` by name, (R,) each, or numbers; NaN where there is
    none.

    Parameters
    ----------
    of, by, at, configuration, motion
        As in :func:`sensitivity`.

    Examples
    --------
    >>> import linkwork as lw
    >>> crank = lw.example("slider-crank")
    >>> rows = lw.design.gradient(crank, "d", by=["B A"])["B A"]
    >>> rows.shape, round(float(rows[60]), 6)
    ((361,), 1.123196)
    """
    result = sensitivity(mechanism, of, at, by=by, configuration=configuration, motion=motion)
    return {name: result[name] for name in result.derivatives}
