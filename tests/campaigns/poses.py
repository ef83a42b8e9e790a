"""Random five-pose tasks: all and only the dyads, compared with loop closure equations."""

from __future__ import annotations

from collections import Counter

import numpy as np

from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.synthesis.poses.burmester import DyadSet, PoseSet
from linkwork.synthesis.poses.dyads import solve_five_poses
from tests.oracles.burmester import crank_turns

__all__ = ["pose_campaign", "random_poses"]

_NEAR = 1e-6  # turns of cranks that agree: the oracle's polynomial loses digits
_DOUBTFUL = 1e-4  # nearer to the circle, or to each other, the oracle decides nothing
_ROUNDING = 1e-9  # of the size of a task: lengths that are equal


def random_poses(count: int, seed: int) -> tuple[ComplexArray, Array, ComplexArray]:
    """Poses (N, 5), angles (N, 5) [rad], and the fixed pivot that each was made with, or NaN.

    A third are normal random points, a third those of a random four-bar's coupler, a third smooth.
    """
    rng = np.random.default_rng([21, seed])
    points = rng.normal(size=(count, 5)) + 1j * rng.normal(size=(count, 5))
    angles = rng.uniform(0.0, 2.0 * np.pi, (count, 5))
    planted = np.full(count, np.nan + 0j)
    for k in range(count):
        if k % 3 == 1:
            # a crank about a random pivot, and any angles of the body
            planted[k] = complex(*rng.normal(size=2))
            moving = complex(*rng.normal(size=2))
            crank = rng.uniform(0.3, 2.0) * np.exp(1j * rng.uniform(0.0, 2.0 * np.pi, 5))
            points[k] = planted[k] + crank - moving * np.exp(1j * angles[k])
        elif k % 3 == 2:
            s = np.linspace(0.0, 1.0, 5)
            steps = rng.normal(size=(3, 2)) @ (1.0, 1.0j)
            points[k] = steps[0] * s + steps[1] * s**2 + 0.3 * steps[2] * s**3
            angles[k] = rng.uniform(0.3, 2.0) * s + rng.uniform(-0.8, 0.8) * s**2
    return points, angles, planted


def pose_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """Counts and false claims of so many tasks."""
    points, angles, planted = random_poses(count, part)
    solved = solve_five_poses(points, angles)
    poses = PoseSet(points=points, turns=np.exp(1j * angles))
    dyads = DyadSet.of_solutions(solved, poses)
    counts, false = Counter({"tasks": count}), []
    counts["tasks proved complete"] = int(solved.complete.sum())
    for k in range(count):
        own = dyads.take(dyads.task == k)
        counts[f"tasks with {len(own)} dyads"] += 1
        counts["dyads"] += len(own)
        counts["dyads proved"] += int(np.isfinite(own.error).sum())
        small = solved.condition[k] < 1e8
        counts["solutions below condition 1e8"] += int(small.sum())
        counts["of these proved"] += int((small & np.isfinite(solved.error[k])).sum())
        problem = _wrong(points[k], angles[k], complex(planted[k]), own, bool(solved.complete[k]))
        if problem == "undecided":
            counts["tasks that the oracle leaves open"] += 1
        elif problem:
            false.append(f"part {part}, task {k}: {problem}")
    return counts, false


def _wrong(
    points: ComplexArray, angles: Array, planted: complex, own: DyadSet, complete: bool
) -> str:
    """What is wrong with the dyads of a task; "" for nothing."""
    arms = points + own.moving[:, None] * np.exp(1j * angles) - own.fixed[:, None]
    lengths = np.abs(arms)
    far = np.abs(own.moving) + np.abs(own.fixed) + 1.0
    stretched = np.ptp(lengths, axis=1) > 2.0 * own.error + _ROUNDING * far
    if stretched[own.kind == 0].any():
        return "a dyad changes its length beyond its bound"
    apart = np.abs(own.fixed - planted) - 2.0 * own.error
    if planted == planted and complete and not (apart < _ROUNDING * far).any():
        return "the dyad that the task was made with is missing"
    turns = crank_turns(points, angles)
    if len(turns) != 4:
        return "undecided"
    near = np.abs(np.abs(turns) - 1.0)
    gaps = np.abs(turns[:, None] - turns[None]) + 9.0 * np.eye(4)
    if ((near > _NEAR) & (near < _DOUBTFUL)).any() or gaps.min() < _DOUBTFUL:
        return "undecided"
    expected = turns[near <= _NEAR]
    if len(expected) != len(own):
        return f"{len(own)} dyads, of which loop closure has {len(expected)}" if complete else ""
    found = arms[:, 1] / arms[:, 0]
    for turn in expected:
        if own.kind.any() or not len(found):
            continue
        if np.abs(found / np.abs(found) - turn).min() > _DOUBTFUL:
            return "a dyad turns by an angle that loop closure does not have"
    return ""
