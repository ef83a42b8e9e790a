"""The table of a motion: a column for each quantity, a row for each input value."""

from __future__ import annotations

import numpy as np

from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Rate
from linkwork.core.results.series import Series
from linkwork.core.results.tables import Column, Summary, Table


def table_of(motion: Motion, *names: str) -> Table:
    """Columns of a motion: inputs, unknowns, points, outputs, derivatives, rates, evidence.

    ``<name>.d1`` and ``.d2`` are derivatives with respect to the leading input, angles in radians;
    ``.velocity`` and ``.acceleration`` appear when the input has a speed.

    Parameters
    ----------
    names : str
        Only these quantities and rates, between the inputs and the status.

    Raises
    ------
    UnknownNameError
        With the nearest names.
    """
    units = motion.units
    columns: dict[str, Column] = {}
    unit_of: dict[str, str] = {}

    def add(name: str, values: Column, unit: str) -> None:
        columns[name], unit_of[name] = values, unit

    for name, values in motion.inputs.items():
        add(name, values, motion.input_units[name])
    if names:
        for quantity in map(motion.quantity, names):
            add(quantity.name, motion[quantity.name], quantity.unit)
        add("status", np.array([status.name for status in motion.status]), "")
        return Table(columns=columns, units=unit_of, index=next(iter(motion.inputs)))
    everything: dict[str, Series] = dict(motion.unknowns)
    everything |= {link: motion.links[link] for link in motion.riding}
    for x, y in motion.points.values():
        everything[x.quantity.name], everything[y.quantity.name] = x, y
    everything |= motion.outputs
    for name, series in everything.items():
        add(name, series.value, units.of(series.quantity.kind))
    known = (rate for rate in Rate if not rate.needs_series)
    asked = [rate for rate in known if not (rate.by_time and motion.speed is None)]
    for pair in (asked[:2], asked[2:]):
        for name, series in everything.items():
            kind = series.quantity.kind
            for rate in pair:
                values = rate.of(series.first, series.second, motion.speed)
                unit = rate.unit(kind, units, motion.derivative_unit)
                add(f"{name}.{rate.value}", values, unit)
    add("status", np.array([status.name for status in motion.status]), "")
    add("residual", motion.residual, "")
    add("iterations", motion.iterations, "")
    add("condition", motion.condition, "")
    add("certified", motion.certified, "")
    add("branch", np.array(motion.branch, dtype=str), "")
    add("limit", np.array(motion.limit, dtype=str), "")
    return Table(columns=columns, units=unit_of, index=next(iter(motion.inputs)))


# ----------------------------------------------------------------------
# The short summary of a motion.


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
    """The summary as text; see :class:`linkwork.core.results.motion.Motion`."""
    return str(motion_summary(motion))
