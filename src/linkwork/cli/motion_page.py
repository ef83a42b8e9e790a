"""A motion as a page of text: counts of positions, limits, evidence, ranges."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from linkwork.cli.terminal import bad, fields, sentence, title_lines
from linkwork.cli.text_table import table_lines
from linkwork.foundation.arrays import Array
from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.status import Status
from linkwork.results.listing.motion_listing import (
    evidence_fields,
    how_many,
    limit_fields,
    range_columns,
    range_text,
    status_fields,
)
from linkwork.results.listing.number_text import short
from linkwork.results.motion import Motion

__all__ = ["answers", "failure_line", "motion_lines", "range_lines"]


def motion_lines(
    motion: Motion, measure: str, columns: Sequence[str] = (), numbers: Sequence[str] = ()
) -> list[str]:
    """The summary of a motion; ``measure`` is printed after residuals.

    ``columns`` instead of unknowns, outputs and traced points; ``numbers`` of the whole motion.
    """
    head = f"{range_text(motion)}: {how_many(motion)}"
    lines = [*title_lines(motion.mechanism), *sentence(str, head)]
    pairs = [*status_fields(motion), *limit_fields(motion)]
    if motion.found.any():
        pairs += evidence_fields(motion, measure)
        pairs += _numbers(motion, numbers)
    lines += fields(pairs, {s.label: bad for s in motion.counts if not s.ok})
    ranges = table_lines(range_columns(motion, columns)) if motion.found.any() else []
    return [*lines, "", *ranges] if ranges else lines


def range_lines(
    motion: Motion, columns: Sequence[str], between: Mapping[str, Array] = FrozenDict()
) -> list[str]:
    """The smallest and largest values of columns, as in :func:`motion_lines`; ``between``: further
    values of inputs and columns.
    """
    ranges = range_columns(motion, columns, between=between) if motion.found.any() else []
    return table_lines(ranges)


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


def _numbers(motion: Motion, names: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Numbers of the whole motion with their units."""
    for name in names:
        unit = motion.quantities.find_of_motion(name).unit
        value = f"{short(motion.value(name))} {unit}".rstrip()
        yield name, f"{value}, of the rows" if motion.is_of_rows(name) else value
