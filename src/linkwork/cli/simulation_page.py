"""Simulated motions and equilibria as pages of text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from linkwork.api import Mechanism
from linkwork.cli.motion_page import range_lines
from linkwork.cli.terminal import bad, fields, good, sentence, title_lines
from linkwork.cli.text_table import table_lines
from linkwork.results.equilibrium import Equilibrium
from linkwork.results.listing.column import Column
from linkwork.results.listing.motion_listing import whole_energy
from linkwork.results.listing.number_text import fixed, significant
from linkwork.results.motion import Motion
from linkwork.results.table import Table

__all__ = ["equilibria_lines", "motion_data", "simulation_lines"]

_ROUNDING = 1e-11  # of the energy: what the balance leaves open


def simulation_lines(motion: Motion, inputs: Sequence[str], names: Sequence[str] = ()) -> list[str]:
    """How a simulation ended, its events and the ranges of its quantities, or of all variables and
    the rates of the inputs.
    """
    whole = bool(motion.found.all())
    message = motion.message[:1].upper() + motion.message[1:]
    lines = [*title_lines(motion.mechanism), *sentence(good if whole else bad, message)]
    lines += fields(list(_facts(motion)))
    listed = list(names) or [*motion.unknowns, *(f"{n}.velocity" for n in inputs)]
    ranges = range_lines(motion, listed)
    return [*lines, "", *ranges] if ranges else lines


def _facts(motion: Motion) -> Iterator[tuple[str, str]]:
    yield "rows", f"{int(motion.asked.sum())}"
    events = Counter(word for word in motion.limit if word)
    for word, count in events.items():
        if word != "end":
            yield "event", f"{word}, {count} times" if count > 1 else word
    yield "certified", f"{int(motion.certified.sum())} of {int(motion.found.sum())}"
    if "load_power" in motion.quantities.derived:
        energy = whole_energy(motion)
        fine = energy[np.isfinite(energy)]
        if len(fine):
            unit = motion.quantity("kinetic_energy").unit
            yield "energy", f"{fine[0]:.10g} at first, {fine[-1]:.10g} at last {unit}"
            if motion.friction_work is not None:
                lost = motion.friction_work[np.isfinite(energy)][-1]
                given = fine[-1] - fine[0] + lost
                size = max(np.abs(fine).max(), abs(lost))
                given = 0.0 if abs(given) < _ROUNDING * size else given
                yield "", f"friction took {lost:.10g}, loads and motor gave {given:.10g}"


def equilibria_lines(mechanism: Mechanism, found: Sequence[Equilibrium]) -> list[str]:
    """A table of equilibria."""
    lines = title_lines(mechanism.description.name)
    if not found:
        return [*lines, *sentence(bad, "No equilibrium on the circuit of the start")]
    if found[0].indifferent == "everywhere":
        return [*lines, *sentence(good, "In equilibrium at every position (indifferent)")]
    head = f"{len(found)} equilibri{'um' if len(found) == 1 else 'a'} on the circuit of the start"
    units = mechanism.model.input_units
    if len(units) > 1:
        head += ", found from a grid of starts: there may be more"
    return [
        *lines,
        *sentence(good, head),
        "",
        *table_lines(
            [
                *(
                    Column(
                        header=f"{name} [{unit}]" if unit else name,
                        cells=[fixed(each.values[name], 6) for each in found],
                        align="point",
                    )
                    for name, unit in units.items()
                ),
                Column(header="", cells=[_stability(each) for each in found]),
                *(
                    Column(
                        header=f"mode {k + 1} [Hz]" if len(units) > 1 else "frequency [Hz]",
                        cells=[_frequency(each.frequencies[k]) for each in found],
                        align="point",
                    )
                    for k in range(len(units))
                ),
            ]
        ),
    ]


def _stability(each: Equilibrium) -> str:
    return "indifferent" if each.indifferent else "stable" if each.stable else "unstable"


def _frequency(value: float) -> str:
    return significant(value) if value > 0.0 else "-"


def motion_data(motion: Motion, table: Table) -> dict[str, Any]:
    """A simulated motion as JSON-ready data."""
    return {
        "mechanism": motion.mechanism,
        "message": motion.message,
        "units": dict(table.units),
        "events": [
            {"t": float(t), "event": word}
            for t, word in zip(motion["t"], motion.limit, strict=True)
            if word
        ],
        "columns": {name: column.tolist() for name, column in table.columns.items()},
        "friction_work": None if motion.friction_work is None else motion.friction_work.tolist(),
    }
