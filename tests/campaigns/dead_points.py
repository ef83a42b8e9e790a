"""Dead points of random four-bars, many of them close to a change point, against a closed form.

A four-bar with ground g, crank a, coupler b and rocker c is at a dead point where coupler and
rocker are in line: cos φ = (g² + a² - (b ± c)²) / (2 g a), evaluated in ball arithmetic.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from flint import arb, ctx

import linkwork as lw
from linkwork.core.mechanism.loops import Loops
from linkwork.core.results.failure import Limit, LimitKind
from tests.described import described_as

__all__ = ["NearChangePoint", "dead_point_campaign"]

_TEXT = """format = 1
name = "four-bar"
length = "mm"
angle = "rad"
[dimensions]
g = {g!r}
a = {a!r}
b = {b!r}
c = {c!r}
[loops]
loop = "a*e^(i*t2) + b*e^(i*t3) = g + c*e^(i*t4)"
[guess]
t2 = {start!r}
t3 = {t3!r}
t4 = {t4!r}
[input]
variable = "t2"
from = {start!r}
to = {end!r}
step = {step!r}
"""
_DIGITS = 60
_ROWS = 48
_AT_LIMIT = (0.0, 1e-15, 1e-13, 1e-11, 1e-8, 1e-5)  # rad: last rows so far from a dead point


@dataclass(frozen=True)
class NearChangePoint:
    """A four-bar whose crank is limited; ``margin``: how far it is from having a change point.

    ``start``: an input angle within reach. ``side``: +1 or -1, which way the loop is closed.
    """

    g: float
    a: float
    b: float
    c: float
    margin: float
    start: float
    side: float

    @classmethod
    def random(cls, rng: np.random.Generator) -> NearChangePoint:
        """One with a margin between 1e-12 and 1e-1."""
        while True:
            g, a, b, c = (float(x) for x in rng.uniform(0.5, 4.0, 4))
            margin = 10.0 ** rng.uniform(-12.0, -1.0)
            if rng.random() < 0.5:
                b = g + a - c - margin
            else:
                b = c + math.copysign(abs(g - a) + margin, rng.random() - 0.5)
            low = max(-1.0, (g * g + a * a - (b + c) ** 2) / (2.0 * g * a))
            high = min(1.0, (g * g + a * a - (b - c) ** 2) / (2.0 * g * a))
            if min(g, a, b, c) > 0.1 and high - low > 0.1:
                start = math.acos(rng.uniform(low + 0.05, high - 0.05))
                way = math.copysign(1.0, rng.random() - 0.5)
                return cls(g, a, b, c, margin, way * start, math.copysign(1.0, rng.random() - 0.5))

    def text(self, end: float, rows: int) -> str:
        """A mechanism file with a table from the start to ``end``."""
        x, y = self.a * math.cos(self.start) - self.g, self.a * math.sin(self.start)
        away = math.hypot(x, y)
        opening = math.acos((self.c**2 + away**2 - self.b**2) / (2.0 * self.c * away))
        t4 = math.atan2(y, x) + self.side * opening
        t3 = math.atan2(self.c * math.sin(t4) - y, self.c * math.cos(t4) - x)
        return _TEXT.format(
            g=self.g, a=self.a, b=self.b, c=self.c, t3=t3, t4=t4,
            start=self.start, end=end, step=(end - self.start) / rows,
        )  # fmt: skip

    def dead_points(self) -> tuple[arb, arb]:
        """The ends of the crank's range around the start; infinite where nothing ends it."""
        g, a, b, c = (arb(x) for x in (self.g, self.a, self.b, self.c))
        found = []
        for reach in (b + c, b - c):
            cosine = (g * g + a * a - reach * reach) / (2 * g * a)
            if abs(cosine) < 1:
                found.append(cosine.acos())
        turn = 2 * arb.pi()
        ends = [sign * x + k * turn for x in found for sign in (1, -1) for k in (-1, 0, 1)]
        start = arb(self.start)
        below = [x for x in ends if x < start]
        above = [x for x in ends if x > start]
        return max(below, key=float), min(above, key=float)


def dead_point_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """So many four-bars, each swept, as a circuit, and all together as a family; what is false."""
    before, ctx.dps = ctx.dps, _DIGITS
    try:
        return _campaign(part, count)
    finally:
        ctx.dps = before


def _campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    rng = np.random.default_rng([31, part])
    bars = [NearChangePoint.random(rng) for _ in range(count)]
    counts: Counter[str] = Counter({"four-bars": count})
    false: list[str] = []
    for k, bar in enumerate(bars):
        wrong = [*_sweeps(bar, counts, rng), *_circuits(bar, counts)]
        false += [f"part {part}, four-bar {k} (margin {bar.margin:.1e}): {what}" for what in wrong]
    for certify in (True, False):
        false += [f"part {part}, {what}" for what in _family(bars, counts, certify)]
    return counts, false


def _allowed(angle: arb) -> float:
    """How far a dead point may be off: 1e-13 rad, and the rounding of its cosine."""
    return 1e-13 + 4e-16 / abs(math.sin(float(angle)))


def _limit_is_wrong(limit: Limit, truth: arb, counts: Counter[str]) -> str:
    counts["dead points"] += 1
    if not limit.located:
        counts["dead points not located"] += 1
        low, high = limit.bracket
        if low <= truth and truth <= high:
            return ""
        return f"the dead point at {float(truth)!r} is not in the bracket {limit.bracket}"
    off = abs(float(arb(limit.input) - truth))
    counts["dead points located"] += 1
    if off > _allowed(truth):
        return f"dead point at {limit.input!r}: off by {off:.1e}, sin {math.sin(float(truth)):.1e}"
    low, high = limit.bracket
    if not (arb(low) <= truth and truth <= arb(high)):
        return f"the dead point at {float(truth)!r} is not within {limit.bracket}"
    return ""


def _sweeps(bar: NearChangePoint, counts: Counter[str], rng: np.random.Generator) -> Iterable[str]:
    """Around a whole turn, and to rows close to the dead points."""
    ends = bar.dead_points()
    yield from _sweep(bar, bar.start + 2.0 * math.pi, ends, counts)
    for end in ends:
        for gap in rng.choice(_AT_LIMIT, 2, replace=False):
            for sign in (1.0, -1.0):
                yield from _sweep(bar, float(end) + sign * float(gap), ends, counts)


def _sweep(
    bar: NearChangePoint, end: float, ends: tuple[arb, arb], counts: Counter[str]
) -> Iterable[str]:
    certify = bool(counts["sweeps"] % 2)
    counts["sweeps"] += 1
    motion = lw.loads(bar.text(end, _ROWS)).sweep(certify=certify)
    low, high = ends
    for limit in motion.limits:
        if limit.kind is not LimitKind.DEAD_POINT:
            yield f"a {limit.kind.word} at {limit.input!r}"
            continue
        all_ends = [end + n * 2 * arb.pi() for end in ends for n in (-1, 0, 1)]
        truth = min(all_ends, key=lambda x: abs(float(x - arb(limit.input))))
        wrong = _limit_is_wrong(limit, truth, counts)
        if wrong:
            yield f"sweep to {end!r}: {wrong}"
    turn = 2 * arb.pi()
    for k, value in enumerate(motion.inputs["t2"]):
        counts["rows"] += 1
        here = arb(float(value))
        reached = any(low <= here + n * turn and here + n * turn <= high for n in (-1, 0, 1))
        if motion.limit[k]:
            counts["rows at limits"] += 1
        elif motion.found[k] and not reached:
            yield f"sweep to {end!r}: row at {value!r} is found beyond the dead point"
        elif reached and not motion.found[k]:
            yield f"sweep to {end!r}: row at {value!r} is missing ({motion.status[k].name})"


def _circuits(bar: NearChangePoint, counts: Counter[str]) -> Iterable[str]:
    found = lw.loads(bar.text(bar.start + 1.0, 10)).circuits()
    truth = bar.dead_points()
    own = [c for c in found.circuits if any(b.configuration for b in c.branches)]
    counts["circuits"] += len(found.circuits)
    limits = [limit for circuit in own for limit in circuit.dead_points]
    turn = 2.0 * math.pi
    for exact in truth:
        gaps = [abs(math.remainder(limit.input - float(exact), turn)) for limit in limits]
        if not gaps:
            yield f"circuits: no dead point at {float(exact)!r}"
            continue
        best = limits[int(np.argmin(gaps))]
        turns = round((best.input - float(exact)) / turn)
        wrong = _limit_is_wrong(best, exact + turns * 2 * arb.pi(), counts)
        if wrong:
            yield f"circuits: {wrong}"


def _family(bars: list[NearChangePoint], counts: Counter[str], certify: bool) -> Iterable[str]:
    """All four-bars over one table of 2π from a common start, as far as it lies in reach."""
    texts = [lw.loads(bar.text(bar.start + 1.0, 10)) for bar in bars]
    columns = {
        name: np.array([getattr(bar, name) for bar in bars]) for name in ("g", "a", "b", "c")
    }
    guesses = [described_as(Loops, text).guess for text in texts]
    columns |= {n: np.array([g[n] for g in guesses]) for n in guesses[0]}
    table = lw.loads(bars[0].text(bars[0].start + 2.0 * math.pi, _ROWS))
    motion = table.family(columns).sweep(certify=certify)
    limits = motion.limits
    for k, bar in enumerate(bars):
        low, high = bar.dead_points()
        for name, exact in (("lower", low), ("upper", high)):
            kind, value = getattr(limits, f"{name}_kind")[k], float(getattr(limits, name)[k])
            counts[f"family {kind or 'nothing'}"] += 1
            if kind == "dead point":
                off = abs(math.remainder(value - float(exact), 2.0 * math.pi))
                if off > _allowed(exact) + 1e-15:
                    yield f"family, four-bar {k} (margin {bar.margin:.1e}): {name} off by {off:.1e}"
            elif kind:
                yield f"family, four-bar {k} (margin {bar.margin:.1e}): {name} is a {kind}"
