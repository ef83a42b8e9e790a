"""Circuits as columns and sentences."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.results.circuits import Circuit, Circuits
from linkwork.results.listing.column import Column
from linkwork.results.listing.number_text import short
from linkwork.results.listing.position_listing import listed_links, redundant_lines

__all__ = ["branch_columns", "circuit_fields"]


def branch_columns(found: Circuits, circuit: Circuit, digits: int = 10) -> list[Column]:
    """The range of every branch of a circuit."""
    unit = f" [{found.input_unit}]" if found.input_unit else ""
    branches = circuit.branches
    return [
        Column(
            header=circuit.name, cells=[b.name.removeprefix(f"{circuit.name} ") for b in branches]
        ),
        Column(
            header=f"from {found.input}{unit}",
            cells=[short(branch.input_range[0], digits) for branch in branches],
            align="point",
        ),
        Column(
            header="to",
            cells=[short(branch.input_range[1], digits) for branch in branches],
            align="point",
        ),
        Column(
            header="at the guess's input",
            cells=[branch.configuration or "-" for branch in branches],
        ),
    ]


def circuit_fields(found: Circuits, circuit: Circuit) -> Iterator[tuple[str, str]]:
    """How a circuit ends, which links turn, its limits."""
    proof = "proved" if circuit.certified else "not proved"
    redundant = circuit.motion.redundant
    if redundant and circuit.certified:
        proof += f" without {listed_links(redundant)}"
    yield ("closed" if circuit.closed else "not closed"), f"{circuit.end.story}; {proof}"
    if circuit.closed:
        yield from _turning(circuit)
    resting = [
        branch.name.removeprefix(f"{circuit.name} ")
        for branch in circuit.branches
        if branch.end is CircuitEnd.INPUT_CONSTANT
    ]
    if resting:
        yield "input at rest", f"along {', '.join(resting)} {CircuitEnd.INPUT_CONSTANT.story}"
    for limit in (*circuit.dead_points, *circuit.change_points):
        yield limit.kind.word, limit.told(found.input, found.input_unit)
    yield from redundant_lines(redundant)
    dead = circuit.dead_points or circuit.change_points
    if not dead and isfinite(circuit.smallest_singular_value):  # infinite without unknowns
        where = f"{found.input} = {circuit.weakest:.3g} {found.input_unit}".rstrip()
        yield (
            "closest to a dead point",
            f"σ_min = {circuit.smallest_singular_value:.3g}, near {where}",
        )


def _turning(circuit: Circuit) -> Iterator[tuple[str, str]]:
    """Which links turn fully and which rock during one pass of the circuit."""
    if circuit.turns:
        times = "once" if circuit.turns == 1 else f"{circuit.turns} times"
        yield "input", f"turns {times} before the circuit closes"
    elif circuit.turns == 0:
        yield "input", "turns back at the dead points"
    turns = [f"{link} ({n:+d})" if abs(n) > 1 else link for link, n in circuit.turning.items() if n]
    rocks = [link for link, n in circuit.turning.items() if not n]
    if turns:
        yield "turning", ", ".join(turns)
    if rocks:
        yield "rocking", ", ".join(rocks)
