"""The referee of steps: proved steps follow the true branch, steps to another root are refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.branch_tracking import InputPath
from linkwork.core.numerics.newton import SolvedRows
from linkwork.core.numerics.path_proof import prove_path
from linkwork.core.numerics.position_proof import prove, reach, rounding_of_inputs, steps_connected
from linkwork.core.table.loop_table import LoopTable
from tests.campaigns.certificates import Verdict
from tests.campaigns.positions import closed
from tests.core.numerics.systems import Term, blocks_of, loop_table
from tests.oracles.balls import BallTable, exactly, newton

__all__ = ["beads_of", "judge_steps"]

Array = npt.NDArray[np.float64]
PATH = InputPath(origin=np.zeros(1), rate=np.ones(1))
_SUBSTEPS = 200


def judge_steps(count: int, seed: int) -> Verdict:
    """Random four-bars, slider-cranks and six-link triads, one input."""
    rng = np.random.default_rng([10, seed])
    verdict = Verdict()
    while verdict.counts["mechanisms"] < count:
        kind = ("four-bar", "slider-crank", "triad")[verdict.counts["mechanisms"] % 3]
        table, v = _mechanism(rng, kind)
        branch = _branch(table, v, float(10 ** rng.uniform(-3, -0.2) * rng.choice([-1, 1])))
        if branch is None:
            continue
        verdict.counts["mechanisms"] += 1
        where = f"{kind}, seed {seed}, mechanism {verdict.counts['mechanisms']}: "
        for claim in (
            *_true_step(rng, table, branch, verdict),
            *_wrong_steps(rng, table, branch, verdict),
        ):
            verdict.false.append(where + claim)
    return verdict


def _mechanism(rng: np.random.Generator, kind: str) -> tuple[LoopTable, Array]:
    """Random lengths and a random position; a constant closes each loop."""
    c = rng.normal(size=8) + 1j * rng.normal(size=8)
    terms: list[Term]
    if kind == "triad":
        terms = [(0, c[0], 0), (0, c[1], 1), (0, c[2], 2), (0, c[3], 4), (0, 0j, None)]
        terms += [(1, c[4], 1), (1, c[5], 2), (1, c[6], 3), (1, 0j, None)]
        table = loop_table(terms, 4, 1, 1.0)
    else:
        table = loop_table([(0, c[0], 0), (0, c[1], 1), (0, c[2], 2), (0, 0j, None)], 2, 1, 1.0)
    v = rng.uniform(-np.pi, np.pi, table.variables)
    if kind == "slider-crank":  # the second unknown is a length along a fixed line
        rows = table.loops
        table = replace(
            table,
            loops=replace(
                rows,
                length=np.array([-1, 1, -1, -1], dtype=np.intp),
                phase_term=np.array([0, 2], dtype=np.intp),
                phase_variable=np.array([0, 2], dtype=np.intp),
                phase_weight=np.ones(2),
            ),
            is_angle=np.array([True, False, True]),
        )
    return closed(table, v), v


def _branch(table: LoopTable, v: Array, length: float) -> Array | None:
    """The true branch in small substeps, (201, N); ``None`` where it turns too fast to be sure."""
    found = [v]
    n = table.unknowns
    for _ in range(_SUBSTEPS):
        here = found[-1].copy()
        here[n] += length / _SUBSTEPS
        first = 0.0
        for k in range(6):
            f, j = table.residual_and_jacobian(here[None, :])
            if np.linalg.cond(j[0, :, :n]) > 1e5:
                return None
            step = np.linalg.solve(j[0, :, :n], f[0])
            here[:n] -= step
            size = float(np.abs(step).max())
            first = size if k == 0 else first
            # quadratic from the first correction on, or the substep was too long
            if (size > 0.1 * 2.0 ** (-(2.0**k)) or first > 0.03) and size > 1e-13:
                return None
        found.append(here)
    return np.stack(found)


def beads_of(solver: BlockSolver, v: Array) -> SolvedRows:
    """Positions as points along their own input."""
    apart = rounding_of_inputs(v, solver.unknowns)
    return solver.rates(v, PATH.rate).with_columns(t=v[:, solver.unknowns], input_radius=apart)


def _true_step(
    rng: np.random.Generator, table: LoopTable, branch: Array, verdict: Verdict
) -> list[str]:
    """Whether a step that is proved stays in its ball and arrives where the branch leads."""
    solver = blocks_of(table)
    n = table.unknowns
    false = []
    balls = BallTable(table)
    for last in (200, 60, 15):
        v, following = branch[:1], branch[last : last + 1]
        spread = np.abs(following - v)[:, n:] + 2 * rounding_of_inputs(following, n)
        around = reach(solver, v, spread)
        arrival = prove(solver, following, rounding_of_inputs(following, n))
        if not (arrival.holds[0] and steps_connected(v, following, around, arrival.error_bound)[0]):
            verdict.counts["steps not proved at once"] += 1
            continue
        verdict.counts["steps proved at once"] += 1
        way = branch[: last + 1]
        if not (np.abs(way - v)[:, :n] <= around.error_bound[0, :n] + 1e-9).all():
            false.append("the branch leaves the radius of an unknown within a proved step")
        for here in way[::100]:
            others = _others(rng, table, here)
            verdict.counts["other roots beside a step"] += len(others)
            if (
                (np.abs(others - v)[:, :n] < around.isolation_radius[0] * (1.0 - 1e-9))
                .all(axis=1)
                .any()
            ):
                false.append("another root lies in the box in which there is only one")
        for end, place in ((following[0], arrival), (way[last // 2], None)):
            root, proved = newton(balls, exactly(end))
            off = max(abs(float((a - b).mid())) for a, b in zip(root, exactly(end), strict=True))
            if not proved or off > 1e-9:
                false.append("the branch is lost in balls")
            if (
                place is not None
                and not off <= place.existence_radius[0, 0] * table.variable_scale[:n].max()
            ):
                false.append("a true position is not within r- of the end of a step")
    return false


def _wrong_steps(
    rng: np.random.Generator, table: LoopTable, branch: Array, verdict: Verdict
) -> list[str]:
    """Steps to and fro between the branch and another root: none may be proved."""
    solver = blocks_of(table)
    n = table.unknowns
    stops = branch[::25]
    wrong = stops.copy()
    for k in range(1, len(stops), 2):
        others = _others(rng, table, stops[k])
        if len(others) and k % 4 == 1:
            wrong[k] = others[rng.integers(len(others))]
        else:  # the same pose, but one link has made a whole turn
            link = int(rng.choice(np.flatnonzero(table.is_angle[:n])))
            wrong[k, link] += 2 * np.pi * rng.choice([-1, 1])
            verdict.counts["steps to a turned link"] += 2
            continue
        verdict.counts["steps to another root"] += 2
    if stops[-1, n] < stops[0, n]:
        stops, wrong = stops[::-1], wrong[::-1]
    right = prove_path(solver, PATH, beads_of(solver, np.ascontiguousarray(stops)))
    verdict.counts["right steps"] += len(stops) - 1
    verdict.counts["right steps proved"] += int(right.connected.sum())
    found = prove_path(solver, PATH, beads_of(solver, np.ascontiguousarray(wrong)))
    return ["a step to another root is proved"] * int(found.connected.sum())


def _others(rng: np.random.Generator, table: LoopTable, v: Array) -> Array:
    """Other positions at the same input, by Newton from anywhere."""
    n = table.unknowns
    x = np.repeat(v[None, :], 40, axis=0)
    x[:, :n] = rng.uniform(-np.pi, np.pi, (40, n))
    for _ in range(30):
        f, j = table.residual_and_jacobian(x)
        step = np.linalg.solve(j[:, :, :n] + 1e-14 * np.eye(n), f[:, :, None])[:, :, 0]
        x[:, :n] -= np.clip(step, -0.5, 0.5)
    f, j = table.residual_and_jacobian(x)
    good = (np.abs(f).max(axis=1) < 1e-13) & (np.linalg.cond(j[:, :, :n]) < 1e6)
    turns = table.is_angle[:n]
    gap = (x - v)[:, :n]
    gap[:, turns] = np.remainder(gap[:, turns] + np.pi, 2 * np.pi) - np.pi
    near = x.copy()
    near[:, :n] = v[:n] + gap
    return np.asarray(near[good & (np.abs(gap).max(axis=1) > 1e-4)])
