"""Trains of four-bars with change points at one input, against closed forms."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np

import linkwork as lw
from tests.oracles.trains import Loop, apart, parallelogram, straight_motion, train

__all__ = ["CASES", "parallel_train_campaign", "random_train_campaign"]

#: From, to, step of the input [deg]: both directions, steps that meet the crossings and miss them.
CASES = [
    (first, first + way * 360.0, way * step)
    for first in (90.0, -45.0, 30.0)
    for way in (1.0, -1.0)
    for step in (1.0, 10.0, 7.2, 60.0)
]
_SAME = 1e-8  # rad


def parallel_train_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """All cases of one length of train: unit parallelograms in a row, straight on."""
    counts: Counter[str] = Counter()
    false = []
    size = part + 1
    loops = [parallelogram(1.0, 1.0) for _ in range(size)]
    for number, rows in enumerate(CASES[:count]):
        upwards = math.sin(math.radians(rows[0])) > 0.0
        mine = loops if upwards else [Loop(1.0, 1.0, 1.0, 1.0, side=1.0)] * size
        motion = train(mine, rows).sweep(change_points="straight", certify=number % 4 == 0)
        want = [motion["t0"]] * size
        false += [f"{size} loops, {rows}: {what}" for what in _judged(motion, want, counts)]
        shared = [limit for limit in motion.limits if len(limit.loops) != size]
        if shared:
            false.append(f"{size} loops, {rows}: only {shared[0].loops} at {shared[0].input!r}")
    return counts, false


def random_train_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """Trains of two to five loops with change points that coincide, or nearly."""
    rng = np.random.default_rng([37, part])
    counts: Counter[str] = Counter()
    false = []
    for number in range(count):
        rows = CASES[int(rng.integers(len(CASES)))]
        loops = _random_loops(rng, rows[0])
        motion = train(loops, rows).sweep(change_points="straight", certify=bool(number % 2))
        asked = motion["t0"]
        keep = np.flatnonzero(np.array(motion.asked))
        want = straight_motion(loops, asked[keep])
        wrong = _judged(motion, want, counts, keep)
        false += [f"part {part}, train {number}, {rows}, {loops}: {what}" for what in wrong]
    return counts, false


def _random_loops(rng: np.random.Generator, first: float) -> list[Loop]:
    """Parallelograms and loops with g + a = b + c, all with change points at 180 degrees, some of
    them moved by an offset.
    """
    loops: list[Loop] = []
    upwards = math.sin(math.radians(first)) > 0.0
    at_crossing = np.array([math.pi])
    for _ in range(int(rng.integers(2, 6))):
        ground, crank = (float(x) for x in rng.uniform(1.0, 4.0, 2))
        if rng.random() < 0.6:
            coupler, rocker = ground, crank
        else:
            coupler = crank + float(rng.uniform(0.2, 0.9)) * (ground - crank)
            rocker = ground + crank - coupler
        offset = math.remainder(math.pi - float(at_crossing[0]), 2.0 * math.pi)
        if rng.random() < 0.3:
            offset += float(rng.choice([1e-3, -1e-6, 1e-9, -1e-10]))
        side = -1.0 if upwards else 1.0
        loops.append(Loop(ground, crank, coupler, rocker, offset, side))
        at_crossing = loops[-1].rocker_angles(at_crossing + offset)[0]
    return loops


def _judged(
    motion: lw.Motion,
    want: list[np.ndarray],
    counts: Counter[str],
    keep: np.ndarray | None = None,
) -> list[str]:
    """What is wrong with the rows of a train."""
    keep = np.arange(len(motion.found)) if keep is None else keep
    found = motion.found[keep]
    counts["trains"] += 1
    counts["rows"] += len(found)
    counts["rows missing"] += int((~found).sum())
    wrong = []
    if not found.all():
        reasons = {motion.status[k].name for k in keep[~found]}
        wrong.append(f"{int((~found).sum())} rows are missing: {', '.join(sorted(reasons))}")
    for k, exact in enumerate(want, start=1):
        exact = exact if len(exact) == len(found) else exact[keep]
        off = apart(motion[f"t{k}"][keep][found], exact[found])
        if off > _SAME:
            counts["rows wrong"] += 1
            wrong.append(f"t{k} is off by {off:.1e}")
            break
    return wrong
