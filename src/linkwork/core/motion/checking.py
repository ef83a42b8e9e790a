"""Mobility by Grübler's count and by rank, and why the two differ."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from linkwork import wings
from linkwork.core.foundation.arrays import RANK_TOLERANCE, Array
from linkwork.core.foundation.statuses import Status
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops
from linkwork.core.motion.model import FITS, Model, largest_misfits, misfit, mobility_by_rank
from linkwork.core.motion.solving import first_position
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.results.check import BlockSummary, CheckReport
from linkwork.core.results.quantity import Kind

_LARGEST = 100  # unknowns up to which a singular mechanism is looked at as one matrix
_BESIDE = 1e-3  # how far from a position its neighbour is sought, in weighted variables
_TRIES = 6


def _mobility(
    model: Model, linkage: Linkage | None, v: Array | None
) -> tuple[int | None, int | None, str]:
    """Grübler's count of the links, the rank at a position (N,), and why they differ."""
    count = None if linkage is None else grubler_count(linkage)
    rank = None if v is None else _by_rank(model, v)
    if count is None or rank is None or v is None or rank == count:
        return count, rank, ""
    return count, rank, _why(model, v, count, rank)


def pins(linkage: Linkage) -> int:
    """Revolute joints, a pin of k bodies counting k - 1."""
    return sum(max(len(bodies) - 1, 0) for bodies in linkage.carriers().values())


def grubler_count(linkage: Linkage) -> int:
    """Grübler's mobility 3(n - 1) - 2·(pins and sliders) - (joints of two freedoms).

    A cylinder counts as its two links and their sliding joint: one body with one freedom more. A
    slot, a curve, a cam and the teeth of gears and racks leave two freedoms; a belt ties two angles
    as teeth do. A wheel that rolls without slipping has one freedom; a weld has none, of its two
    links' pin.
    """
    rigid = 3 * (len(linkage.links) - 1) - 2 * pins(linkage)  # eq. (64)
    return rigid + sum(part.mobility for part in linkage.parts)


def _why(model: Model, v: Array, count: int, rank: int) -> str:
    """Why a rank and a count are not the same, from the rank at a position near by."""
    if rank < count:
        return "some links have freedoms that do not occur in the equations"
    beside = _rank_beside(model, v)
    redundant = len(model.equations.redundant)
    if redundant and beside == rank:
        several = "conditions follow" if redundant > 1 else "condition follows"
        return (
            f"{redundant} {several} from the others, because of special lengths such as parallel "
            "or equal links: it is overconstrained, but it moves"
        )
    if beside is not None and beside < rank:
        return (
            "only at this position are the constraints dependent, as at dead points and change "
            f"points; near it the rank gives {beside}"
        )
    return (
        "at this position the constraints are dependent, and no position was found near it: its "
        "motion may be infinitesimal only"
    )


def _rank_beside(model: Model, v: Array) -> int | None:
    """The mobility by rank at a position near by, if one is found."""
    compiled = model.compiled
    scale, n = compiled.solver.variable_scale, compiled.solver.unknowns
    rng = np.random.default_rng(0)  # any direction serves; the same every time
    for _ in range(_TRIES):
        guess = v + _BESIDE * scale * rng.uniform(-1.0, 1.0, len(v))
        # inputs are moved clearly: the rank at another input is wanted
        guess[n:] = v[n:] + _BESIDE * scale[n:] * rng.choice([-1.0, 1.0], len(v) - n)
        done = compiled.solver.solve(guess[None, :])
        near = np.abs((done.v[0] - v) / scale).max() < 100.0 * _BESIDE
        if done.status[0] == Status.CONVERGED.code and near:
            # this neighbour is no position of the mechanism with all its links
            if misfit(model.equations, done.v)[0] > FITS:
                return None
            return _by_rank(model, done.v[0])
    return None


def _by_rank(model: Model, v: Array) -> int | None:
    """Variables, inputs included, minus the rank of all equations, scaled.

    Regular blocks have full rank together. Otherwise all equations are looked at as one matrix,
    unless that would be very large.
    """
    solver = model.compiled.solver
    full = not model.equations.redundant
    for block in solver.blocks if full else ():
        n = len(block.unknowns)
        system = block.system
        j = system.jacobian(v[None, block.variables])[0, :, :n]
        full &= _rank_of(j * system.variable_scale[:n] / system.equation_scale[:, None]) == n
    if full:
        return len(model.equations.variables) - solver.unknowns
    # singular values of one large matrix would take seconds
    if solver.unknowns > _LARGEST:
        return None
    return mobility_by_rank(model.compiled, v)


def _rank_of(scaled: Array) -> int:
    if not scaled.size:
        return 0
    return int(np.linalg.matrix_rank(scaled, tol=RANK_TOLERANCE * np.linalg.norm(scaled, 2)))


# ----------------------------------------------------------------------
# Check a mechanism: loops, unknowns, blocks, mobility, closure at the start.


def check(model: Model) -> CheckReport:
    """Report loops, unknowns, blocks and mobility of a mechanism; try its start position."""
    description, equations = model.description, model.equations
    start = first_position(model, model.start_inputs, NewtonOptions())
    chains = wings.use("circuits.classification")
    seen = chains.as_linkage(model)
    linkage = None if isinstance(seen, chains.NotSeen) else seen.linkage
    count, rank, why = _mobility(model, linkage, start.v if start.status.ok else None)
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
    if lacking := wings.use("circuits.chain").missing():  # in a browser
        seen = chains.NotSeen(lacking)
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
                model.compiled.solver.blocks, chains.block_groups(model, seen), strict=True
            )
        ),
        mobility_count=count,
        mobility_rank=rank,
        mobility_why=why,
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
        classification=None if isinstance(seen, chains.NotSeen) else chains.classify(seen),
        unclassified=seen.why if isinstance(seen, chains.NotSeen) else "",
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
