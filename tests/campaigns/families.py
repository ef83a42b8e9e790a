"""The referee of families: random four-bars by the ten thousand against their closed form."""

from __future__ import annotations

from collections import Counter

import numpy as np
import numpy.typing as npt

import linkwork as lw
from linkwork.core.foundation.arrays import CountArray
from linkwork.core.foundation.statuses import Certification, Status

__all__ = ["family_campaign"]

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]
Bools = npt.NDArray[np.bool_]

_CHUNK = 20_000
_APART = 1e-7  # two branches nearer than this are not told apart by their positions
_STEP = 10.0


def family_campaign(count: int) -> tuple[Counter[str], list[str]]:
    """So many four-bars over a whole turn, a tenth close to a change point; what is false."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    for first in range(0, count, _CHUNK):
        _judge(first, min(_CHUNK, count - first), counts, false)
    return counts, false


def _judge(first: int, count: int, counts: Counter[str], false: list[str]) -> None:
    rng = np.random.default_rng([23, first])
    near = rng.random(count) < 0.1
    shared = first // _CHUNK % 2 == 0  # all start at one input, or each at its own
    bars, theta, sign = _designs(rng, near, shared)
    a, b, c, d = bars
    tip = _tip(bars, theta, sign)
    mechanism = lw.loops(
        loops={"1": "b*e^(i*t) + c*e^(i*p) = a + d*e^(i*q)"},
        dimensions={"a": 2.0, "b": 1.0, "c": 2.5, "d": 2.5},
        guess={"t": 0.0, "p": 60.0, "q": 100.0},
        inputs=lw.Input(variable="t", from_=0, to=360, step=_STEP),
    )
    family = mechanism.family({
        "a": a, "b": b, "c": c, "d": d,
        "t": np.degrees(theta),
        "p": np.degrees(np.angle(tip - b * np.exp(1j * theta))),
        "q": np.degrees(np.angle(tip - a)),
    })  # fmt: skip
    motion = family.sweep()
    found, certified = motion.found, motion.certified
    counts["mechanisms"] += count
    counts["near a change point"] += int(near.sum())
    counts["designs that went alone"] += int(motion.rows.alone.sum())
    counts["rows"] += found.size
    counts["rows found"] += int(found.sum())
    for status in Status:
        counts[f"status {status.name}"] += int((motion.status == status.code).sum())
    for kind in Certification:
        counts[f"row {kind.name}"] += int((motion.certification == kind.code).sum())
    inputs = np.radians(motion.inputs[:, 0])
    here = b[:, None] * np.exp(1j * inputs) + c[:, None] * np.exp(1j * np.radians(motion["p"]))
    own, other = (
        np.abs(here - _tip(bars[:, :, None], inputs, (side * sign)[:, None])) for side in (1, -1)
    )
    changed = found & (other < own) & (own > _APART)
    counts["rows on another branch"] += int(changed.sum())
    # at a change point the branch beyond it is chosen, which the status tells
    false += [f"{first + k}: certified on another branch" for k in _rows(changed & certified)]
    lost = _turns(bars)[:, None] & ~found
    counts["rows lost that can be reached"] += int(lost.sum())
    false += [f"{first + k}: reachable rows are lost" for k in _rows(lost & ~near[:, None])]
    silent = found & (motion.certification == Certification.NO_POSITION.code)
    false += [f"{first + k}: a position without a reason" for k in _rows(silent)]


def _rows(wrong: Bools) -> list[int]:
    return np.flatnonzero(wrong.any(axis=1)).tolist()


def _designs(
    rng: np.random.Generator, near: Bools, shared: bool
) -> tuple[Array, Array, npt.NDArray[np.int64]]:
    """Bars (4, D), where they start, and on which side; drawn anew until they can be assembled."""
    count = len(near)
    bars, theta = np.empty((4, count)), np.empty(count)
    sign = rng.choice([-1, 1], count)
    start = rng.uniform(0.0, 2.0 * np.pi)
    left = np.arange(count)
    while len(left):
        bars[:, left] = _bars(rng, near[left])
        theta[left] = start if shared else rng.uniform(0.0, 2.0 * np.pi, len(left))
        sides = [_tip(bars[:, left], theta[left], s) for s in (1, -1)]
        left = left[~(np.abs(sides[0] - sides[1]) > 0.05)]
    return bars, theta, sign


def _bars(rng: np.random.Generator, near: Bools) -> Array:
    """Ground, crank, coupler, rocker: three in four turn fully, or come close to a change point."""
    r = rng.uniform(0.3, 3.0, (4, len(near)))
    plain = ~near & (rng.random(len(near)) < 0.25)
    crank, one, two, _ = sorted_bars = np.sort(r, axis=0)
    gap = np.where(near, 10.0 ** rng.uniform(-9, -3, len(near)), rng.uniform(0.05, 0.5, len(near)))
    others = rng.permuted(np.stack([one, two, one + two - crank - gap]), axis=0)
    grashof = np.stack([others[0], sorted_bars[0], others[1], others[2]])
    return np.where(plain, r, np.abs(grashof))


def _tip(bars: Array, theta: Array, sign: CountArray | int) -> Complex:
    """Where coupler and rocker meet, NaN where they do not."""
    a, b, c, d = bars
    base = b * np.exp(1j * theta)
    line = a - base
    size = np.abs(line)
    with np.errstate(invalid="ignore"):
        along = (size**2 + c**2 - d**2) / (2.0 * size)
        across = np.sqrt(c**2 - along**2)
    return np.asarray(base + line / size * (along + 1j * sign * across))


def _turns(bars: Array) -> Bools:
    """Whether the crank turns fully."""
    a, b, c, d = bars
    return np.asarray((np.abs(a - b) > np.abs(c - d)) & (a + b < c + d))
