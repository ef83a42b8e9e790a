"""Tolerances as columns and sentences."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.core.results.listing.motion_listing import Column, fixed, short, significant
from linkwork.design.tolerance_results import Tolerance


def tolerance_fields(tolerance: Tolerance) -> Iterator[tuple[str, str]]:
    """The quantity, its worst case and its standard deviation."""
    unit = tolerance.unit
    yield "value", f"{short(tolerance.value)} {unit}".rstrip()
    yield "worst case", f"± {significant(tolerance.worst_case)} {unit}".rstrip()
    yield "root sum square", f"{significant(tolerance.root_sum_square)} {unit}".rstrip()


def sampled_fields(tolerance: Tolerance) -> Iterator[tuple[str, str]]:
    """The quantity in random designs; nothing if there were none."""
    drawn = tolerance.sampled
    if drawn is None:
        return
    unit = tolerance.unit
    yield (
        "sampled",
        f"deviation {significant(drawn.deviation)} ± {significant(drawn.error, 2)} {unit}, mean "
        f"{short(drawn.mean)} {unit}, from {short(drawn.low)} to {short(drawn.high)} {unit}; "
        f"{drawn.found} of {drawn.designs} designs found, seed {drawn.seed}",
    )


def contribution_columns(tolerance: Tolerance) -> list[Column]:
    """The share of each number and pin."""
    parts = tolerance.contributions
    names = [part.name if part.kind == "dimension" else f"pin {part.name}" for part in parts]

    def column(header: str, cells: list[str], units: list[str] | None = None) -> Column:
        return Column(header=header, cells=cells, align="point", units=units or ())

    return [
        Column(header="number", cells=names),
        column(
            "deviation",
            [short(part.deviation) for part in parts],
            [part.deviation_unit for part in parts],
        ),
        column(
            "sensitivity",
            [significant(part.sensitivity) for part in parts],
            [part.unit for part in parts],
        ),
        column(
            "change", [significant(part.worst) for part in parts], [tolerance.unit] * len(parts)
        ),
        column("share %", [fixed(100.0 * part.share, 1) for part in parts]),
    ]
