"""The referee of proofs over lanes: positions and steps of random tables, many at a time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from linkwork.core.numerics.kantorovich import Bounds, Radii
from linkwork.core.record.block_proof import BlockProof, BlockRadii
from linkwork.core.record.closure import BlockPart, Closure
from linkwork.core.record.recorder import LANES, Recorder
from linkwork.core.table.loop_table import LoopTable
from linkwork.families.compiled.interpreter import run
from linkwork.families.march.march_programs import MarchPrograms, march_programs
from tests.campaigns.certificates import Case, Verdict, judge_case
from tests.campaigns.positions import Placed, closed, random_position
from tests.core.record.running import ran
from tests.oracles.balls import BallTable

__all__ = ["LaneClaims", "claims", "coefficients_of", "judge_lane_steps", "judge_lanes"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class LaneClaims:
    """What lanes claim of M positions: as ``Bounds`` and ``Radii``, and the inverse (M, n, n)."""

    bounds: Bounds
    radii: Radii
    inverse: Array


def coefficients_of(tables: list[LoopTable]) -> dict[str, Array]:
    """What programs read of tables that differ in their coefficients, (M,) each."""
    loops = np.stack([table.loops.coefficient for table in tables])
    lines = np.stack([table.linear.constant for table in tables])
    scales = np.stack([table.variable_scale for table in tables])
    given = {f"c{t}.re": loops[:, t].real for t in range(loops.shape[1])}
    given |= {f"c{t}.im": loops[:, t].imag for t in range(loops.shape[1])}
    given |= {f"k{r}": lines[:, r] for r in range(lines.shape[1])}
    return given | {f"scale{k}": scales[:, k] for k in range(scales.shape[1])}


def claims(tables: list[LoopTable], v: Array, known: Array) -> LaneClaims:
    """The proofs of positions v (M, N) for all known variables within ``known`` (M, p)."""
    table = tables[0]
    n, count = table.unknowns, table.variables
    given = coefficients_of(tables)
    rec = Recorder()
    variables = [rec.input(f"v{k}") for k in range(count)]
    equations = tuple(range(table.loops.rows + len(table.linear.constant)))
    part = BlockPart(equations=equations, unknowns=tuple(range(n)))
    zeros = {name for name, values in given.items() if not values.any()}
    closure = Closure(table, part, rec, variables, zeros)
    proof = BlockProof(closure)
    spread = {k: rec.input(f"d{k}") for k in proof.known}
    for i, row in enumerate(proof.constants(spread)):
        for name, value in (("y", row.y), ("z", row.z), ("o", row.omega), ("b", row.bent)):
            rec.write(f"{name}.{i}", value)
        for k in range(n):
            rec.write(f"a{i}.{k}", proof.inverse[i][k])
    _write_found(rec, proof.within(spread))
    given |= {f"v{k}": v[:, k] for k in range(count)}
    given |= {f"d{k}": known[:, k - n] for k in range(n, count)}
    return _claims(ran(rec, given), n, np.stack([t.variable_scale[:n] for t in tables]))


def _write_found(rec: Recorder, found: BlockRadii) -> None:
    rec.write("holds", found.holds)
    rec.write("radius", found.radius)
    for i, (each, alone) in enumerate(zip(found.error_bound, found.isolation_radius, strict=True)):
        rec.write(f"each{i}", each)
        rec.write(f"alone{i}", alone)


def _claims(found: Mapping[str, Array], n: int, weights: Array) -> LaneClaims:
    def rows(name: str) -> Array:
        return np.stack([found[f"{name}{i}"] for i in range(n)], axis=1)

    holds, alone = found["holds"] > 0.5, rows("alone")
    bounds = Bounds(y=rows("y."), z=rows("z."), omega=rows("o."), omega_slope=rows("b."))
    unique = np.where(holds, (alone / weights).min(axis=1), 0.0)
    radii = Radii(
        holds=holds,
        existence_radius=found["radius"],
        uniqueness_radius=unique,
        error_bound=rows("each"),
        isolation_radius=alone,
    )
    inverse = np.stack([rows(f"a{i}.") for i in range(n)], axis=1)
    return LaneClaims(bounds=bounds, radii=radii, inverse=inverse)


# ------------------------------------------------------------------ positions


def judge_lanes(parts: range, seed: int, lanes: int = LANES, thorough: int = 2) -> Verdict:
    """Random tables, each in so many lanes; ``thorough``: in how many of them every constant is
    looked at and other roots are looked for, not only whether a root is where one is claimed.
    """
    rng = np.random.default_rng([21, seed])
    verdict = Verdict()
    for number in parts:
        tables, v = _lanes_of(rng, random_position(number), lanes)
        known = _known(rng, tables[0], lanes)
        found = claims(tables, v, known)
        for lane in range(lanes):
            if not np.isfinite(found.inverse[lane]).all():
                verdict.counts["J singular to rounding"] += 1
                continue
            case = _case(tables[lane], v[lane], known[lane], found, lane)
            where = f"table {number}, seed {seed}, lane {lane}: "
            judge_case(rng, case, 40 if lane < thorough else 0, verdict, where)
    return verdict


def _lanes_of(
    rng: np.random.Generator, placed: Placed, lanes: int
) -> tuple[list[LoopTable], Array]:
    """The same equations with other coefficients: every second place is not quite a position."""
    table, n = placed.table, placed.table.unknowns
    tables, places = [], []
    for lane in range(lanes):
        shift = 10 ** rng.uniform(-3, 0.5) * rng.normal(size=table.variables)
        place = placed.v + (shift * table.variable_scale if lane else 0.0)
        tables.append(closed(table, place))
        if lane % 2:
            off = 10 ** rng.uniform(-14, -2) * rng.normal(size=n)
            place = place.copy()
            place[:n] += off * table.variable_scale[:n]
        places.append(place)
    return tables, np.stack(places)


def _known(rng: np.random.Generator, table: LoopTable, lanes: int) -> Array:
    n = table.unknowns
    size = 10 ** rng.uniform(-14, 0.0, (lanes, table.variables - n))
    size[rng.random(size.shape) < 0.5] = 0.0
    return np.asarray(size * table.variable_scale[n:])


def _case(table: LoopTable, v: Array, known: Array, found: LaneClaims, lane: int) -> Case:
    b, r = found.bounds, found.radii
    here = slice(lane, lane + 1)
    return Case(
        placed=Placed(kind="lane", table=table, v=v),
        balls=BallTable(table),
        v=v,
        matrix=found.inverse[lane],
        known=known,
        bounds=Bounds(
            y=b.y[here], z=b.z[here], omega=b.omega[here], omega_slope=b.omega_slope[here]
        ),
        radii=Radii(
            holds=r.holds[here],
            existence_radius=r.existence_radius[here],
            uniqueness_radius=r.uniqueness_radius[here],
            error_bound=r.error_bound[here],
            isolation_radius=r.isolation_radius[here],
        ),
    )


# ------------------------------------------------------------------ steps


def judge_lane_steps(parts: range, seed: int) -> Verdict:
    """Steps between positions of random tables; none that leads to another branch is proved."""
    rng = np.random.default_rng([22, seed])
    verdict = Verdict()
    for number in parts:
        placed = random_position(number)
        table, n = placed.table, placed.table.unknowns
        if table.variables != n + 1:
            table = _with_one_input(table, placed.v)
        v = placed.v[: n + 1]
        roots = _roots(rng, table, v)
        if len(roots) < 2:
            verdict.counts["tables without another root"] += 1
            continue
        steps = _steps(rng, table, roots)
        if not len(steps.node):
            continue
        good = _proved(table, steps)
        verdict.counts["right steps"] += int((~steps.wrong).sum())
        verdict.counts["right steps proved"] += int((good & ~steps.wrong).sum())
        verdict.counts["wrong steps"] += int(steps.wrong.sum())
        false = int((good & steps.wrong).sum())
        verdict.false += [f"table {number}, seed {seed}: a wrong step is proved"] * false
    return verdict


def _with_one_input(table: LoopTable, v: Array) -> LoopTable:
    """The first input moves, the others stand still: as fixed phases and lengths."""
    n, rows, linear = table.unknowns, table.loops, table.linear
    held = np.zeros(table.variables, dtype=bool)
    held[n + 1 :] = True
    coefficient = rows.coefficient.copy()
    for t, k, w in zip(rows.phase_term, rows.phase_variable, rows.phase_weight, strict=True):
        if held[k]:
            coefficient[t] *= np.exp(1j * w * v[k])
    length = rows.length.copy()
    for t, j in enumerate(rows.length):
        if j >= 0 and held[j]:
            coefficient[t] *= v[j]
            length[t] = -1
    phases, entries = ~held[rows.phase_variable], ~held[linear.variable]
    constant = linear.constant.copy()
    np.add.at(constant, linear.row[~entries], (linear.weight * v[linear.variable])[~entries])
    return replace(
        table,
        loops=replace(
            rows,
            variables=n + 1,
            coefficient=coefficient,
            length=length,
            phase_term=rows.phase_term[phases],
            phase_variable=rows.phase_variable[phases],
            phase_weight=rows.phase_weight[phases],
        ),
        linear=replace(
            linear,
            constant=constant,
            row=linear.row[entries],
            variable=linear.variable[entries],
            weight=linear.weight[entries],
        ),
        variable_scale=table.variable_scale[: n + 1],
        is_angle=table.is_angle[: n + 1],
    )


def _newton(table: LoopTable, x: Array, steps: int) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Newton-Raphson from places (M, N) with short steps; which arrived at regular positions."""
    n, w = table.unknowns, table.variable_scale[: table.unknowns]
    size = np.full(len(x), np.inf)
    with np.errstate(all="ignore"):
        for _ in range(steps):
            f, j = table.residual_and_jacobian(x)
            j = j[:, :, :n] * w / table.equation_scale[:, None]
            fine = np.isfinite(j).all(axis=(1, 2))
            step = np.full((len(x), n), np.nan)
            step[fine] = np.linalg.solve(
                j[fine] + 1e-14 * np.eye(n), (f / table.equation_scale)[fine][:, :, None]
            )[:, :, 0]
            size = np.abs(step).max(axis=1)
            x = x.copy()
            x[:, :n] -= step * np.minimum(1.0, 0.5 / size)[:, None] * w
        arrived = np.isfinite(size) & (size < 1e-12)
        arrived[arrived] &= np.linalg.cond(j[arrived]) < 1e5
    return x, arrived


def _roots(rng: np.random.Generator, table: LoopTable, v: Array) -> Array:
    """Different positions at the same input, whole turns included, (R, N)."""
    n = table.unknowns
    x = np.repeat(v[None, :], 64, axis=0)
    x[1:, :n] += rng.uniform(-3, 3, (63, n)) * table.variable_scale[:n]
    x, arrived = _newton(table, x, 30)
    found: list[Array] = []
    for place in x[arrived]:
        if all(np.abs((place - other) / table.variable_scale).max() > 1e-3 for other in found):
            found.append(place)
    return np.stack(found) if found else np.empty((0, len(v)))


@dataclass(frozen=True)
class _Steps:
    """From ``node`` to ``trial``, (S, N) each; ``wrong`` (S,): to another branch."""

    node: Array
    trial: Array
    wrong: npt.NDArray[np.bool_]


def _steps(rng: np.random.Generator, table: LoopTable, roots: Array) -> _Steps:
    """From every root to every other one, the input moved a little or not at all."""
    n, w = table.unknowns, table.variable_scale
    nodes, trials, wrong = [], [], []
    gap = np.abs((roots[:, None] - roots[None]) / w).max(axis=2) + 1e9 * np.eye(len(roots))
    for _ in range(4):
        length = 10 ** rng.uniform(-6, -1.5) * rng.choice([-1, 0, 1]) * w[n]
        moved = roots.copy()
        moved[:, n] += length
        moved, arrived = _newton(table, moved, 12)
        # so near to its root, and so far from all others, that it can be no other's continuation
        arrived &= np.abs((moved - roots) / w).max(axis=1) < 0.1 * gap.min(axis=1)
        for k in np.flatnonzero(arrived):
            others = rng.permutation(np.delete(np.arange(len(roots)), k))[:6]
            for j in (k, *others):
                nodes.append(roots[j])
                trials.append(moved[k])
                wrong.append(j != k)
            turning = (
                rng.choice(np.flatnonzero(table.is_angle[:n])) if table.is_angle[:n].any() else -1
            )
            if turning >= 0:  # the same pose, one link turned once around
                nodes.append(roots[k])
                trials.append(moved[k] + 2 * np.pi * np.eye(n + 1)[turning])
                wrong.append(True)
    if not nodes:
        return _Steps(np.empty((0, n + 1)), np.empty((0, n + 1)), np.zeros(0, dtype=bool))
    return _Steps(np.stack(nodes), np.stack(trials), np.array(wrong))


def _proved(table: LoopTable, steps: _Steps) -> npt.NDArray[np.bool_]:
    """Which steps the march's own programs prove, (S,)."""
    n = table.unknowns
    equations = tuple(range(table.loops.rows + len(table.linear.constant)))
    part = BlockPart(equations=equations, unknowns=tuple(range(n)))
    given = coefficients_of([table])
    zeros = {name for name, values in given.items() if not values.any()}
    programs = march_programs(table, [part], zeros, certified=True)
    good = np.zeros(len(steps.node), dtype=bool)
    for first in range(0, len(steps.node), LANES):
        here = slice(first, min(first + LANES, len(steps.node)))
        good[here] = _proved_here(programs, given, n, steps.node[here], steps.trial[here])
    return good


def _proved_here(
    programs: MarchPrograms, given: Mapping[str, Array], n: int, node: Array, trial: Array
) -> npt.NDArray[np.bool_]:
    reg = programs.registers
    space = reg.filled(max(programs.height, reg.count), LANES)
    count = len(node)

    def put(name: str, values: Array | float) -> None:
        if name in reg.named:
            space[reg.named[name], :count] = values

    for name, values in given.items():
        put(name, values[0])
    put("u0.spread", 0.0)
    put("live0.0", 0.0)
    for at, before in ((node, node), (node, node), (trial, node)):  # the node's own proof first
        for k in range(n):
            put(f"x{k}.0", at[:, k])
            put(f"x{k}.1", before[:, k])
            put(f"e{k}.1", space[reg.named[f"e{k}.0"], :count])
        put("t.0", at[:, n])
        put("t.1", before[:, n])
        for program in (p for kind in ("given", "prove", "judge") for p in programs.by_kind[kind]):
            run(program.code, space)
        own = space[reg.named["good.0"], :count] > 0.5
        if at is node:
            proved_node = own
    found: npt.NDArray[np.bool_] = own & proved_node
    return found
