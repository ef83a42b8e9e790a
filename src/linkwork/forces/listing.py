"""The evidence of forces as sentences."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np

from linkwork.core.foundation.arrays import BoolArray
from linkwork.forces.results import ForceStatus, Reactions
from linkwork.forces.stall import Stall


def force_status_fields(found: Reactions) -> Iterator[tuple[str, str]]:
    """The number of rows with forces, and those without by their reasons."""
    counts = Counter(status for status in found.statuses if status is not ForceStatus.FOUND)
    yield "found", str(len(found) - counts.total())
    yield from ((status.label, f"{n}: {status.value}") for status, n in counts.items())


def finite_forces(found: Reactions, names: Sequence[str] = ()) -> list[str]:
    """The forces with a finite value in some row, of ``names`` or of all."""
    return [
        name
        for name in names or found.values
        if name != "disagreement" and np.isfinite(found.values[name]).any()
    ]


def force_fields(found: Reactions, stalls: Sequence[Stall] = ()) -> Iterator[tuple[str, str]]:
    """Stalls, how far virtual work and free bodies agree, and what is wrong with joints."""
    yield from (("stalls", _stall(stall)) for stall in stalls)
    if "disagreement" in found.values:
        worst = np.nanmax(found.values["disagreement"], initial=0.0)
        yield "check", f"virtual work and free bodies agree to {worst:.1e} of the largest term"
    yield from undefined_fields(found)
    lost = [name for name, rows in found.undetermined.items() if rows.any()]
    if lost:
        yield "undetermined", f"{', '.join(lost)}: {ForceStatus.UNDETERMINED.value}"
    for name, rows in found.lifted.items():
        if rows.any():
            yield "lifts off", f"{name} would have to pull{_where(rows)}"
    for name, rows in found.slipping.items():
        if rows.any():
            yield "slips", f"{name} needs more friction than there is{_where(rows)}"
    unsure = int(np.sum(~found.proved))
    if unsure:
        yield "not proved", f"that friction leaves an equilibrium, or none, in {unsure} rows"


def undefined_fields(found: Reactions) -> Iterator[tuple[str, str]]:
    """Loads without a finite value."""
    for name, rows in found.undefined.items():
        if rows.any():
            yield "no value", f"{name}{_where(rows)}"


def _where(rows: BoolArray) -> str:
    return "" if rows.ndim == 0 else f" in {int(rows.sum())} rows"


def _stall(stall: Stall) -> str:
    """Where friction stops the mechanism, and whether this is proved."""
    moves, locked = stall.bracket
    proof = (
        f"proved: moves at {moves:.10g}, locked at {locked:.10g}" if stall.proved else "not proved"
    )
    others = (name for name in stall.position.unknowns if name != stall.input)
    places = [
        f"{name} = {stall.position[name]:.8g} {stall.position.value_units[name]}"
        for name in (stall.input, *islice(others, 1))
    ]
    return f"at {', '.join(places)} ({proof})"
