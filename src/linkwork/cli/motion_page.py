"""A motion as a page of text: counts of positions, limits, evidence, ranges."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.cli.position_page import Row, listed_links, redundant_lines, value_cells
from linkwork.cli.terminal import bad, fields, sentence, title_lines
from linkwork.cli.text_table import Column, short, table_lines
from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.results.motion import Motion
from linkwork.results.quantities.asked import Asked
from linkwork.results.quantity import Kind

__all__ = ["failure_line", "limit_fields", "motion_lines", "range_lines"]

_MOST_RUNS = 4  # ranges of failed rows that are listed


def motion_lines(
    motion: Motion, measure: str, columns: Sequence[str] = (), numbers: Sequence[str] = ()
) -> list[str]:
    """The summary of a motion; ``measure`` is printed after residuals.

    ``columns`` instead of unknowns, outputs and traced points; ``numbers`` of the whole motion.
    """
    head = f"{_range_text(motion)}: {_how_many(motion)}"
    lines = [*title_lines(motion.mechanism), *sentence(str, head)]
    pairs = [*_counts(motion), *limit_fields(motion)]
    if motion.found.any():
        pairs += _evidence(motion, measure)
        pairs += _numbers(motion, numbers)
    lines += fields(pairs, {_label(s): bad for s in motion.counts if not s.ok})
    ranges = _ranges(motion, columns) if motion.found.any() else []
    return [*lines, "", *ranges] if ranges else lines


def range_lines(motion: Motion, columns: Sequence[str]) -> list[str]:
    """The smallest and largest values of columns, as in :func:`motion_lines`."""
    return _ranges(motion, columns) if motion.found.any() else []


def answers(motion: Motion, *, through: bool) -> bool:
    """Whether nothing that was asked for is missing.

    Around a whole circuit the inputs that it does not reach are an answer.
    """
    misses = {status for status in motion.counts if not status.ok}
    return not misses or (through and misses == {Status.OUT_OF_CIRCUIT})


def failure_line(motion: Motion) -> list[str]:
    """How many rows were not found, in one sentence."""
    missing = int((motion.asked & ~motion.found).sum())
    return sentence(bad, f"{missing} of {int(motion.asked.sum())} positions were not found")


def _how_many(motion: Motion) -> str:
    """``361 positions, 2 more at limits and 269 on further branches``."""
    asked = int(motion.asked.sum())
    home = {branch for branch, a in zip(motion.branch, motion.asked, strict=True) if a}
    away = sum(b not in home for b, a in zip(motion.branch, motion.added, strict=True) if a)
    near = int(motion.added.sum()) - away
    more = [f"{near} more at limits"] if near else []
    more += [f"{away}{'' if near else ' more'} on further branches"] if away else []
    return f"{asked} positions" + (f", {' and '.join(more)}" if more else "")


def _range_text(motion: Motion) -> str:
    """``θ12 from 0 to 360 deg by 1``; several inputs one after the other."""
    parts = []
    for name, all_values in motion.inputs.items():
        values = all_values[motion.asked]
        unit = motion.input_units[name]
        text = f"{name} from {short(values[0])} to {short(values[-1])} {unit}".rstrip()
        by = f" by {short((values[-1] - values[0]) / (len(values) - 1))}" if len(values) > 1 else ""
        parts.append(text + by)
    return ", ".join(parts)


def _counts(motion: Motion) -> Iterator[tuple[str, str]]:
    """The number of rows with each status; for failures, also the input values and the reason."""
    counts = motion.counts
    yield "found", str(counts[Status.CONVERGED])
    for status in Status:
        if status.ok or not counts[status]:
            continue
        rows = f"{counts[status]} at {_runs(motion, status)}"
        if status is Status.NO_START and motion.failure is not None:
            yield _label(status), rows
            yield from motion.failure.sentences()
            continue
        reason = motion.message if status is Status.NO_START else status.value
        yield _label(status), f"{rows}: {reason}"


def _label(status: Status) -> str:
    return status.name.lower().replace("_", " ")


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
    told = ((limit.kind.word, limit.told(name, unit)) for limit in motion.limits)
    yield from dict.fromkeys(told)
    for extreme in motion.output_limits:
        value = f"{extreme.value:.10g} {motion.quantity(extreme.name).unit}".rstrip()
        text = f"{extreme.name} = {value} at {name} = {extreme.input:.12g} {unit}".rstrip()
        yield extreme.kind, text
    if motion.circuit is not None:
        yield "circuit", motion.circuit.value


def _numbers(motion: Motion, names: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Numbers of the whole motion with their units."""
    for name in names:
        unit = motion.quantities.find_of_motion(name).unit
        yield name, f"{short(motion.value(name))} {unit}".rstrip()


def _evidence(motion: Motion, measure: str) -> Iterator[tuple[str, str]]:
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


_EQUAL = 1e-9  # relative difference of values that are equal but for rounding
_STILL = 1e-10  # relative range below which a value counts as constant, without located extremes


def _ranges(motion: Motion, columns: Sequence[str]) -> list[str]:
    """Smallest and largest value of every unknown, output and traced point, and where."""
    traced = (f"{point}.{axis}" for point in motion.skeleton.traced for axis in "xy")
    names = columns or [*motion.unknowns, *motion.riding, *motion.outputs, *traced]
    found = [_Range(motion.quantity(name), motion[name]) for name in names]
    if not found:
        return []
    _, inputs = _lead(motion)
    low = [int(np.argmin(_filled(series.value, np.inf))) for series in found]
    high = [int(np.argmax(_filled(series.value, -np.inf))) for series in found]
    numbers = [
        Row(name=s.quantity.name, kind=_kind(s.quantity), value=float(s.value[row]))
        for rows in (low, high)
        for s, row in zip(found, rows, strict=True)
    ]
    cells = value_cells(numbers)  # both columns together, for the same number of decimals

    def places(rows: list[int]) -> Column:
        moving = [
            s.value[b] - s.value[a] > _STILL * max(1.0, abs(s.value[a]), abs(s.value[b]))
            for s, a, b in zip(found, low, high, strict=True)
        ]
        cells = [short(inputs[r] if m else np.nan) for r, m in zip(rows, moving, strict=True)]
        return Column(header="at", cells=cells, align="point")

    return table_lines(
        [
            Column(header="range", cells=[s.quantity.name for s in found]),
            Column(header="minimum", cells=cells[: len(found)], align="point"),
            places(low),
            Column(header="maximum", cells=cells[len(found) :], align="point"),
            places(high),
            Column(header="unit", cells=[s.quantity.unit for s in found]),
        ]
    )


def _kind(asked: Asked) -> Kind:
    return asked.own.kind if asked.rate is None else Kind.NUMBER


def _filled(values: Array, filling: float) -> Array:
    """The values with ``filling`` for those that are missing."""
    return np.where(np.isnan(values), filling, values)


def _lead(motion: Motion) -> tuple[str, Array]:
    """The first input, whose values name the rows."""
    return next(iter(motion.inputs.items()))
