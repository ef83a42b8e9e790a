"""The short summary of a motion."""

from __future__ import annotations

import numpy as np

from linkwork.results.motion import Motion
from linkwork.results.summary import Summary

__all__ = ["motion_summary", "motion_text"]


def motion_summary(motion: Motion) -> Summary:
    """Range of the input, counts by status, limits, worst evidence, ranges of the unknowns."""
    name, values = next(iter(motion.inputs.items()))
    values = values[motion.asked]
    unit = motion.input_units[name]
    head = (
        f"Motion of {motion.mechanism}, {name} {values[0]:.10g} to {values[-1]:.10g} {unit}, "
        f"{len(values)} positions"
    )
    rows = [(s.label, str(n)) for s, n in motion.counts.most_common()]
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


def motion_text(motion: Motion) -> str:
    """The summary as text; see :class:`linkwork.results.motion.Motion`."""
    return str(motion_summary(motion))
