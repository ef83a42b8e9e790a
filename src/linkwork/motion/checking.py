"""Check a mechanism: loops, unknowns, blocks, mobility, closure at the start."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.foundation.arrays import Array
from linkwork.mechanism.chain_graph import missing
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.loops import Loops
from linkwork.motion.classifying.as_linkage import NotSeen, as_linkage
from linkwork.motion.classifying.classify import block_groups, classify
from linkwork.motion.mobility import mobility_of, pins
from linkwork.motion.model import Model
from linkwork.motion.redundancy import largest_misfits
from linkwork.motion.start import first_position
from linkwork.numerics.newton import NewtonOptions
from linkwork.results.check import BlockSummary, CheckReport
from linkwork.results.quantity import Kind

__all__ = ["check"]


def check(model: Model) -> CheckReport:
    """Report loops, unknowns, blocks and mobility of a mechanism; try its start position."""
    description, equations = model.description, model.equations
    start = first_position(model, model.start_inputs, NewtonOptions())
    seen = as_linkage(model)
    linkage = None if isinstance(seen, NotSeen) else seen.linkage
    mobility = mobility_of(model, linkage, start.v if start.status.ok else None)
    measured: tuple[tuple[str, str, float], ...] = ()
    links = joints = 0
    if isinstance(description, Linkage):
        form = "points and links"
        measured = tuple(
            (m.link, " ".join(m.points), m.length) for m in description.shapes.measured
        )
    else:
        form = "loops" if isinstance(description, Loops) else "equations"
    if linkage is not None:
        bodies = [part for part in linkage.parts if part.body]
        links = len(linkage.links) + len(bodies)
        joints = pins(linkage) + sum(part.kind is not None for part in linkage.parts) - len(bodies)
    units = model.units
    if lacking := missing():  # in a browser
        seen = NotSeen(lacking)
    return CheckReport(
        mechanism=description.name,
        form=form,
        links=links,
        joints=joints,
        loops=equations.labels,
        unknowns=tuple((v.name, units.of(Kind(v.kind))) for v in equations.unknowns),
        inputs=tuple((v.name, units.of(Kind(v.kind))) for v in equations.inputs),
        rows=len(model.rows) if description.inputs else 0,
        blocks=tuple(
            BlockSummary(
                equations=tuple(equations.labels[e] for e in block.equations),
                unknowns=tuple(equations.unknowns[k].name for k in block.unknowns),
                group=group,
            )
            for block, group in zip(
                model.compiled.solver.blocks, block_groups(model, seen), strict=True
            )
        ),
        mobility_count=mobility.count,
        mobility_rank=mobility.rank,
        mobility_why=mobility.why,
        redundant=() if not start.status.ok else tuple(_redundant(model, start.v)),
        measured=measured,
        measured_in_parts=tuple(_measured_in_parts(model)),
        start=start.status,
        start_message=start.message,
        start_input={
            v.name: float(value)
            for v, value in zip(equations.inputs, model.start_in_file_units, strict=True)
        },
        residual=start.residual,
        failure=start.failure,
        classification=None if isinstance(seen, NotSeen) else classify(seen),
        unclassified=seen.why if isinstance(seen, NotSeen) else "",
    )


def _measured_in_parts(model: Model) -> Iterator[tuple[str, str, float, str]]:
    """Part, quantity, value and unit of what parts take from the sketch."""
    for entry in model.equations.measured:
        kind = Kind(entry.kind)
        value = entry.value / model.units.scale(kind)
        yield entry.part, entry.quantity, value, model.units.of(kind)


def _redundant(model: Model, v: Array) -> Iterator[tuple[str, float, float]]:
    """Every redundant link with its length and how far it is from that."""
    gaps = largest_misfits(model.equations, v[None, :])
    for part in model.equations.redundant:
        yield part.link, part.length, gaps[part.link]
