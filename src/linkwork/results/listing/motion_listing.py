"""A motion as columns and sentences: counts of positions, limits, evidence, ranges."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.status import Status
from linkwork.results.branch_end import is_in_table
from linkwork.results.listing.column import Column
from linkwork.results.listing.number_text import short
from linkwork.results.listing.position_listing import (
    Row,
    listed_links,
    redundant_lines,
    value_cells,
)
from linkwork.results.motion import Motion
from linkwork.results.quantities.asked import Asked
from linkwork.results.quantity import Kind

__all__ = [
    "coordinates_off_ground",
    "evidence_fields",
    "how_many",
    "limit_fields",
    "range_columns",
    "range_text",
    "status_fields",
    "whole_energy",
]

_MOST_RUNS = 4  # ranges of failed rows that are listed
_EQUAL = 1e-9  # relative difference of values that are equal but for rounding
_STILL = 1e-10  # relative range below which a value counts as constant, without located extremes


def how_many(motion: Motion) -> str:
    """``361 positions, 2 more at limits and 269 on further branches``."""
    asked = int(motion.asked.sum())
    home = {branch for branch, a in zip(motion.branch, motion.asked, strict=True) if a}
    away = sum(b not in home for b, a in zip(motion.branch, motion.added, strict=True) if a)
    near = int(motion.added.sum()) - away
    more = [f"{near} more at limits"] if near else []
    more += [f"{away}{'' if near else ' more'} on further branches"] if away else []
    return f"{asked} positions" + (f", {' and '.join(more)}" if more else "")


def range_text(motion: Motion) -> str:
    """``θ12 from 0 to 360 deg by 1``; several inputs one after the other."""
    parts = []
    for name, all_values in motion.inputs.items():
        values = all_values[motion.asked]
        unit = motion.input_units[name]
        text = f"{name} from {short(values[0])} to {short(values[-1])} {unit}".rstrip()
        by = f" by {short((values[-1] - values[0]) / (len(values) - 1))}" if len(values) > 1 else ""
        parts.append(text + by)
    return ", ".join(parts)


def status_fields(motion: Motion) -> Iterator[tuple[str, str]]:
    """The number of rows with each status; for failures, also the input values and the reason."""
    counts = motion.counts
    yield "found", str(counts[Status.CONVERGED])
    for status in Status:
        if status.ok or not counts[status]:
            continue
        rows = f"{counts[status]} at {_runs(motion, status)}"
        if status is Status.NO_START and motion.failure is not None:
            yield status.label, rows
            yield from motion.failure.sentences()
            continue
        reason = motion.message if status is Status.NO_START else status.value
        yield status.label, f"{rows}: {reason}"


def _runs(motion: Motion, status: Status) -> str:
    """The input values of all rows with this status: ``118 to 121, 200 deg``."""
    name, values = _lead(motion)
    here = np.array([s is status for s in motion.status])
    edges = np.flatnonzero(np.diff(here, prepend=False, append=False))
    runs = list(zip(edges[0::2], edges[1::2] - 1, strict=True))
    shown = [
        short(values[a]) if a == b else f"{short(values[a])} to {short(values[b])}"
        for a, b in runs[:_MOST_RUNS]
    ]
    more = f" and {len(runs) - _MOST_RUNS} more ranges" if len(runs) > _MOST_RUNS else ""
    return f"{', '.join(shown)} {motion.input_units[name]}".rstrip() + more


def limit_fields(motion: Motion) -> Iterator[tuple[str, str]]:
    """Dead points and other ends of the branch, one to a line."""
    name, _ = _lead(motion)
    unit = motion.input_units[name]
    # two ends of a branch may coincide
    told: dict[tuple[str, str], None] = {}
    for limit in motion.limits:
        place = "" if is_in_table(limit, motion) else ", outside the table"
        told[limit.kind.word, limit.told(name, unit) + place] = None
    yield from told
    for extreme in motion.output_limits:
        value = f"{extreme.value:.10g} {motion.quantity(extreme.name).unit}".rstrip()
        text = f"{extreme.name} = {value} at {name} = {extreme.input:.12g} {unit}".rstrip()
        yield extreme.kind, text
    if motion.circuit is not None:
        yield "circuit", motion.circuit.value


def evidence_fields(motion: Motion, measure: str) -> Iterator[tuple[str, str]]:
    yield from _certified(motion)
    yield "worst residual", _worst(motion, motion.residual, measure)
    regular = np.where(np.isfinite(motion.condition), motion.condition, np.nan)
    if not np.isnan(regular).all():  # at dead points it is infinite
        yield "worst condition", _worst(motion, regular, "")


def _certified(motion: Motion) -> Iterator[tuple[str, str]]:
    """How many rows are proved, and why the others are not."""
    found = int(motion.found.sum())
    proved = int(motion.certified.sum())
    why = Counter(
        c.value
        for c, here in zip(motion.certification, motion.found, strict=True)
        if here and c not in (Certification.CERTIFIED, Certification.SUBSET_CERTIFIED)
    )
    partly = motion.certification.count(Certification.SUBSET_CERTIFIED)
    if partly:
        yield "certified", f"{partly}, without {listed_links(motion.redundant)}"
    elif proved or not why:
        yield "certified", str(proved)
    for reason, count in why.items():
        yield "not certified", f"{count if count < found else 'all'}: {reason}"
    yield from redundant_lines(motion.redundant)


def _worst(motion: Motion, values: Array, measure: str) -> str:
    name, inputs = _lead(motion)
    finite = np.where(np.isfinite(values), values, -np.inf)  # ∞ at limits
    # the first of those that are equal but for rounding
    row = int(np.argmax(finite >= (1.0 - _EQUAL) * finite.max()))
    size = f"{values[row]:.2g}{measure}"
    return f"{size}, at {name} = {short(inputs[row])} {motion.input_units[name]}".rstrip()


@dataclass(frozen=True)
class _Range:
    quantity: Asked
    value: Array


def range_columns(
    motion: Motion,
    columns: Sequence[str] = (),
    decimals: int = 6,
    between: Mapping[str, Array] = FrozenDict(),
) -> list[Column]:
    """Smallest and largest value of every unknown, output and traced point, and where; of all
    moving points where there is none of these.

    ``between``: further values of inputs and columns, in the same order.
    """
    traced = (f"{point}.{axis}" for point in motion.skeleton.traced for axis in "xy")
    usual = [*motion.unknowns, *motion.riding, *motion.outputs, *traced]
    names = columns or usual or coordinates_off_ground(motion)
    none = np.zeros(0)
    found = [
        _Range(motion.quantity(name), np.append(motion[name], between.get(name, none)))
        for name in names
    ]
    if not found:
        return []
    lead, inputs = _lead(motion)
    inputs = np.append(inputs, between.get(lead, none))
    low = [int(np.argmin(_filled(series.value, np.inf))) for series in found]
    high = [int(np.argmax(_filled(series.value, -np.inf))) for series in found]
    numbers = [
        Row(name=s.quantity.name, kind=_kind(s.quantity), value=float(s.value[row]))
        for rows in (low, high)
        for s, row in zip(found, rows, strict=True)
    ]
    cells = value_cells(numbers, decimals)  # both columns together, for the same number of decimals

    def places(rows: list[int]) -> Column:
        moving = [
            s.value[b] - s.value[a] > _STILL * max(1.0, abs(s.value[a]), abs(s.value[b]))
            for s, a, b in zip(found, low, high, strict=True)
        ]
        cells = [short(inputs[r] if m else np.nan) for r, m in zip(rows, moving, strict=True)]
        return Column(header="at", cells=cells, align="point")

    return [
        Column(header="range of rows", cells=[s.quantity.name for s in found]),
        Column(header="minimum", cells=cells[: len(found)], align="point"),
        places(low),
        Column(header="maximum", cells=cells[len(found) :], align="point"),
        places(high),
        Column(header="unit", cells=[s.quantity.unit for s in found]),
    ]


def whole_energy(motion: Motion) -> Array:
    """The kinetic and stored energy of a loaded mechanism, flywheels included, (N,)."""
    found: Array = motion["kinetic_energy"] + motion["stored_energy"]
    return found if motion.flywheel_energy is None else found + motion.flywheel_energy


def coordinates_off_ground(motion: Motion) -> tuple[str, ...]:
    """What there is to show of a motion without unknowns, outputs and traced points."""
    moving = [point for point in motion.points if point not in motion.skeleton.fixed]
    return tuple(f"{point}.{axis}" for point in moving for axis in "xy")


def _kind(asked: Asked) -> Kind:
    return asked.own.kind if asked.rate is None else Kind.NUMBER


def _filled(values: Array, filling: float) -> Array:
    """The values with ``filling`` for those that are missing."""
    return np.where(np.isnan(values), filling, values)


def _lead(motion: Motion) -> tuple[str, Array]:
    """The first input, whose values name the rows."""
    return next(iter(motion.inputs.items()))
