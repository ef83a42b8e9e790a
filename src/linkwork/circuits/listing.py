"""Circuits as columns and sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isfinite

from linkwork.circuits.results import Circuit, Circuits, Configurations, PathCount, solution_counts
from linkwork.core.foundation.statuses import Certification, CircuitEnd
from linkwork.core.results.listing.motion_listing import (
    Column,
    Row,
    listed_links,
    redundant_lines,
    short,
    value_cells,
)
from linkwork.core.results.position import Certificate
from linkwork.core.results.quantity import Kind


def branch_columns(found: Circuits, circuit: Circuit, digits: int = 10) -> list[Column]:
    """The range of every branch of a circuit."""
    unit = f" [{found.input_unit}]" if found.input_unit else ""
    branches = circuit.branches
    names = [branch.name.removeprefix(f"{circuit.name} ") for branch in branches]
    low, high = ([short(b.input_range[k], digits) for b in branches] for k in range(2))
    configurations = [branch.configuration or "-" for branch in branches]
    return [
        Column(header=circuit.name, cells=names),
        Column(header=f"from {found.input}{unit}", cells=low, align="point"),
        Column(header="to", cells=high, align="point"),
        Column(header="at the guess's input", cells=configurations),
    ]


def circuit_fields(found: Circuits, circuit: Circuit) -> Iterator[tuple[str, str]]:
    """How a circuit ends, which links turn, its limits."""
    proof = "proved" if circuit.certified else "not proved"
    redundant = circuit.motion.redundant
    if redundant and circuit.certified:
        proof += f" without {listed_links(redundant)}"
    yield ("closed" if circuit.closed else "not closed"), f"{circuit.end.explanation}; {proof}"
    if circuit.closed:
        yield from _turning(circuit)
    resting = [
        branch.name.removeprefix(f"{circuit.name} ")
        for branch in circuit.branches
        if branch.end is CircuitEnd.INPUT_CONSTANT
    ]
    if resting:
        yield "input at rest", f"along {', '.join(resting)} {CircuitEnd.INPUT_CONSTANT.explanation}"
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


# ----------------------------------------------------------------------
# Configurations as columns and sentences.


def configuration_columns(
    found: Configurations, kinds: Mapping[str, Kind], decimals: int = 6
) -> list[Column]:
    """A row for every configuration; ``kinds`` of the unknowns in order."""
    columns = [Column(header="name", cells=found.names)]
    for name, kind in kinds.items():
        if name not in found.positions[0].unknowns:
            continue  # a redundant link's length
        unit = found.positions[0].units.of(kind)
        rows = [Row(name=name, kind=kind, value=position.unknowns[name]) for position in found]
        header = f"{name} [{unit}]" if unit else name
        columns.append(Column(header=header, cells=value_cells(rows, decimals), align="point"))
    certified = [_certified(p.certificate) for p in found]
    columns.append(Column(header="certified", cells=certified))
    return columns


def completeness_fields(found: Configurations) -> Iterator[tuple[str, str]]:
    """Whether the list is complete, and the counts of solutions behind it."""
    yield "complete", found.message
    label = "paths"
    for count in found.paths:
        yield label, path_sentence(count, several=len(found.paths) > 1)
        label = ""


def path_sentence(count: PathCount, *, several: bool) -> str:
    """The counts of solutions of one block in words."""
    block = f"{', '.join(count.unknowns)}: " if several else ""
    if not count.paths:
        return f"{block}follow from the others"
    text = solution_counts(count)
    text += f", {count.multiple} multiple" if count.multiple else ""
    text += f", for {count.solved} positions of earlier blocks" if count.solved > 1 else ""
    others = [
        f"{number} {end}"
        for number, end in ((count.at_infinity, "to infinity"), (count.failed, "lost"))
        if number
    ]
    return f"{block}{text}" + (f"; {count.paths} paths: {', '.join(others)}" if others else "")


def _certified(certificate: Certificate) -> str:
    if certificate.certification is Certification.SUBSET_CERTIFIED:
        return "partly"
    return "yes" if certificate.certified else "no"
