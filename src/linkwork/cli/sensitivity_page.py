"""Sensitivities and tolerances as pages of text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from linkwork.cli.terminal import bad, fields, good, sentence, title_lines
from linkwork.cli.text_table import table_lines
from linkwork.results.listing.column import Column
from linkwork.results.listing.number_text import short, significant
from linkwork.results.listing.tolerance_listing import (
    contribution_columns,
    sampled_fields,
    tolerance_fields,
)
from linkwork.results.sensitivity import Sensitivity, SensitivityStatus
from linkwork.results.summary import driven_text
from linkwork.results.tolerance import Tolerance

__all__ = ["sensitivity_data", "sensitivity_lines", "tolerance_data", "tolerance_lines"]


def sensitivity_lines(found: Sensitivity) -> list[str]:
    """The derivatives by number, the largest first."""
    lines = title_lines(found.mechanism)
    rows = found.value.ndim > 0
    at = {} if rows else {name: float(value) for name, value in found.inputs.items()}
    where = f"at {driven_text(at, found.input_units)}" if at else ""
    if rows:
        where = f"in {len(found)} positions"
    counts = Counter(status for status in found.statuses if status is not SensitivityStatus.FOUND)
    if len(counts) and SensitivityStatus.FOUND not in found.statuses and not rows:
        lines += sentence(bad, f"No sensitivity of {found.of}", where)
        lines += fields([("why", found.status.value)])
        if found.status is not SensitivityStatus.CORNER:
            return lines
    else:
        lines += sentence(good, f"Sensitivity of {found.of}", where)
    if not rows:
        lines += fields([("value", f"{short(float(found.value))} {found.unit}".rstrip())])
    else:
        lines += fields([("found", str(found.statuses.count(SensitivityStatus.FOUND)))])
        lines += (
            fields([(status.label, f"{count}: {status.value}") for status, count in counts.items()])
            if counts
            else []
        )
    names = found.effective
    if names:
        lines += ["", *_table(found, names, rows)]
    rest = len(found.derivatives) - len(names)
    notes = list(_notes(found, rest))
    return [*lines, "", *fields(notes)] if notes else lines


def _notes(found: Sensitivity, rest: int) -> Iterator[tuple[str, str]]:
    if rest:
        plural = "numbers have" if rest > 1 else "number has"
        yield "others", f"{rest} more {plural} no effect"
    reasons: dict[str, list[str]] = {}
    for name, why in found.refused.items():
        reasons.setdefault(why, []).append(name)
    for why, names in reasons.items():
        yield "refused", f"{', '.join(names)}: {why}"


def _table(found: Sensitivity, names: tuple[str, ...], rows: bool) -> list[str]:
    units = [found.unit_by(name) for name in names]
    columns = [
        Column(header="number", cells=list(names)),
        Column(
            header="value",
            cells=[short(found.numbers[name]) for name in names],
            align="point",
            units=[found.units[name] for name in names],
        ),
    ]
    if not rows:
        cells = [significant(float(found.derivatives[name])) for name in names]
        columns.append(Column(header="derivative", cells=cells, align="point", units=units))
        return table_lines(columns)
    for header, extreme in (("smallest", np.fmin.reduce), ("largest", np.fmax.reduce)):
        cells = [significant(float(extreme(found.derivatives[name]))) for name in names]
        columns.append(Column(header=header, cells=cells, align="point", units=units))
    return table_lines(columns)


def sensitivity_data(found: Sensitivity) -> dict[str, Any]:
    """The derivatives as JSON-ready data."""
    return {
        "mechanism": found.mechanism,
        "of": found.of,
        "unit": found.unit,
        "status": [status.name for status in found.statuses],
        "inputs": {name: np.asarray(value).tolist() for name, value in found.inputs.items()},
        "value": found.value.tolist(),
        "derivatives": {name: rates.tolist() for name, rates in found.derivatives.items()},
        "units": {name: found.unit_by(name) for name in found.derivatives},
        "refused": dict(found.refused),
    }


def tolerance_lines(found: Tolerance) -> list[str]:
    """Worst case, root sum square, and the share of each number and pin."""
    lines = title_lines(found.mechanism)
    where = f"at {found.where}" if found.where else ""
    if found.status is not SensitivityStatus.FOUND:
        lines += sentence(bad, f"No tolerance of {found.of}", where)
        lines += fields([("why", found.status.value)])
        return [*lines, *_sampled(found)]
    lines += sentence(good, f"Tolerance of {found.of}", where)
    lines += [*fields(tolerance_fields(found)), *_sampled(found)]
    return [*lines, "", *table_lines(contribution_columns(found))]


def _sampled(found: Tolerance) -> list[str]:
    return [] if found.sampled is None else fields(sampled_fields(found))


def tolerance_data(found: Tolerance) -> dict[str, Any]:
    """The tolerance as JSON-ready data."""
    return {
        "mechanism": found.mechanism,
        "of": found.of,
        "unit": found.unit,
        "inputs": dict(found.inputs),
        "status": found.status.name,
        "value": found.value,
        "worst_case": found.worst_case,
        "root_sum_square": found.root_sum_square,
        "contributions": [asdict(part) for part in found.contributions],
        "sampled": None if found.sampled is None else asdict(found.sampled),
    }
