"""Short summaries of results: aligned text fit to be pasted into a question, rows of a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from linkwork.results.circuits import Circuits
    from linkwork.results.configurations import Configurations, PathCount
    from linkwork.results.motion import Motion
    from linkwork.results.position import Position

__all__ = [
    "Summary",
    "circuits_summary",
    "configurations_summary",
    "motion_summary",
    "position_summary",
    "solution_counts",
]


@dataclass(frozen=True)
class Summary:
    """A line that says what it is, and rows of a name and a text; as text, aligned."""

    head: str
    rows: tuple[tuple[str, str], ...]

    def __str__(self) -> str:
        width = max((len(name) for name, _ in self.rows), default=0)
        return "\n".join([self.head, *(f"  {name:<{width}}  {text}" for name, text in self.rows)])


def _driven(inputs: Mapping[str, float], units: Mapping[str, str]) -> str:
    return ", ".join(f"{name} = {value:.10g} {units[name]}" for name, value in inputs.items())


def position_summary(position: Position) -> Summary:
    """Status, unknowns, evidence."""
    at = _driven(position.input, position.input_units)
    head = f"Position of {position.mechanism}" + (f" at {at}" if at else "")
    if not position.status.ok:
        return Summary(head, ((position.status.name, position.message),))
    values = {**position.unknowns, **position.outputs}
    units = position.value_units
    rows = [(n, f"{value:.10g} {units.get(n, '')}".rstrip()) for n, value in values.items()]
    rows += [
        ("residual", f"{position.residual:.1e} of the longest link"),
        ("condition", f"{position.condition:.3g}"),
        ("iterations", str(position.iterations)),
        ("certified", "yes" if position.certificate.certified else "no"),
    ]
    return Summary(head, tuple(rows))


def configurations_summary(found: Configurations) -> Summary:
    """One row per configuration, then completeness and what became of the paths."""
    at = _driven(found.input, found.input_units)
    head = f"Configurations of {found.mechanism}" + (f" at {at}" if at else "")
    rows = []
    for position in found:
        values = ", ".join(f"{name} = {value:.8g}" for name, value in position.unknowns.items())
        certified = "certified" if position.certificate.certified else "not certified"
        rows.append((position.configuration, f"{values}  {certified}"))
    rows.append(("completeness", found.message))
    rows.append(("paths", "; ".join(map(solution_counts, found.paths))))
    return Summary(head, tuple(rows))


def solution_counts(count: PathCount) -> str:
    """``6 complex solutions, 4 of them real``."""
    finite = count.finite + count.multiple
    return f"{finite} complex solution{'' if finite == 1 else 's'}, {count.real} of them real"


def circuits_summary(circuits: Circuits) -> Summary:
    """One line per branch."""
    unit = circuits.input_unit
    head = f"{len(circuits)} circuit{'' if len(circuits) == 1 else 's'} of {circuits.mechanism}"
    rows = []
    for circuit in circuits:
        for branch in circuit.branches:
            low, high = branch.input_range
            rows.append((branch.name, f"{circuits.input} {low:.10g} to {high:.10g} {unit}"))
    return Summary(head, tuple(rows))


def motion_summary(motion: Motion) -> Summary:
    """Range of the input, counts by status, limits, worst evidence, ranges of the unknowns."""
    name, values = next(iter(motion.inputs.items()))
    values = values[motion.asked]
    unit = motion.input_units[name]
    head = (
        f"Motion of {motion.mechanism}, {name} {values[0]:.10g} to {values[-1]:.10g} {unit}, "
        f"{len(values)} positions"
    )
    rows = [(s.name.lower().replace("_", " "), str(n)) for s, n in motion.counts.most_common()]
    rows += [(limit.kind.word, f"{limit.input:.10g} {unit}") for limit in motion.limits]
    rows += [
        (extreme.kind, f"{extreme.name} = {extreme.value:.10g} at {extreme.input:.10g} {unit}")
        for extreme in motion.output_limits
    ]
    if motion.circuit is not None:
        rows.append(("circuit", motion.circuit.value))
    found = motion.found
    if found.any():
        rows.append(("certified", f"{int(motion.certified.sum())} of {int(found.sum())}"))
        rows.append(("worst residual", f"{motion.worst:.1e} of the longest link"))
        regular = motion.condition[np.isfinite(motion.condition)]  # not so at dead points
        if len(regular):
            rows.append(("worst condition", f"{regular.max():.3g}"))
        for own, series in {**motion.unknowns, **motion.outputs}.items():
            reached, unit = series.value[found], motion.units.of(series.quantity.kind)
            rows.append((own, f"{reached.min():.8g} … {reached.max():.8g} {unit}".rstrip()))
    return Summary(head, tuple(rows))
