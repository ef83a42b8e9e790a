"""Best known four-bars for the curves of the literature, and Jansen's leg from changed lengths.

Each task is solved through the public interface with its usual starts. The referee computes the
coupler point of the delivered design from its points and lengths by intersecting circles, at the
crank angles that the design names, and takes the sum of squares of the distances itself. The best
values are those known before: of papers where they print better ones, and of differential
evolution and Levenberg-Marquardt on compiled residuals.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from time import process_time
from typing import Any

import numpy as np

import linkwork as lw
from linkwork.core.foundation.arrays import Array
from linkwork.core.mechanism.linkage import Linkage
from tests.campaigns import printed_curves as printed

__all__ = ["CURVES", "PARTS", "Curve", "improvement_campaign", "solve_curve_task", "squares"]

_WITHIN = 1.0001  # of the best known value
_SECONDS = 10.0  # of a processor for a task
_LEG_STARTS = 24
_LEG_RMS = 1e-8  # mm
_LEG_SHARE = 0.8  # of the starts
_LEG_POINTS = 36


@dataclass(frozen=True, kw_only=True)
class Curve:
    """A task, and the best sum of squares known before; ``step``: of the crank, 0 if it is free."""

    name: str
    points: tuple[tuple[float, float], ...]
    best: float
    step: float = 0.0
    first: float | None = None
    ordered: bool = True
    seconds: float = _SECONDS
    starts: int | None = None
    wanted: dict[str, Any] = field(default_factory=dict)
    bounds: dict[str, tuple[float, float]] = field(default_factory=dict)


_TURNS = {"input": "turns fully"}
_ZERO = (0.0, 0.0)
_AT_ORIGIN = {"A0.x": _ZERO, "A0.y": _ZERO, "B0.y": _ZERO, "input": _ZERO}
CURVES = (
    Curve(name="line of 6, free", points=printed.LINE, best=1e-20, starts=200,
          wanted={**_TURNS, "lengths": {"least": 5, "most": 60}}),
    Curve(name="5 timed", points=printed.TIMED_FIVE, best=7.41575e-7, step=15.0, first=30.0,
          wanted=_TURNS, bounds=_AT_ORIGIN),
    Curve(name="18 timed", points=printed.KRILL_EIGHTEEN, best=0.00902888, step=20.0),
    Curve(name="18 free", points=printed.KRILL_EIGHTEEN, best=0.00302929),
    Curve(name="ellipse of 10, free", points=printed.ELLIPSE, best=4.0266e-4,
          wanted={"lengths": {"least": 5, "most": 80}}),
    Curve(name="12 free", points=printed.KRILL_TWELVE, best=7.60894e-5),
    Curve(name="12 timed", points=printed.KRILL_TWELVE, best=0.0221133, step=30.0),
    Curve(name="25 free, any order", points=printed.KRILL_TWENTY_FIVE, best=0.0349689,
          ordered=False, seconds=30.0, starts=5000),
    Curve(name="25 free", points=printed.KRILL_TWENTY_FIVE, best=0.770565, seconds=30.0),
    Curve(name="25 timed", points=printed.KRILL_TWENTY_FIVE, best=1.31652, step=15.0,
          seconds=30.0),
    Curve(name="Yu 1, free", points=printed.YU_ONE, best=0.85426),
    Curve(name="Yu 2, free", points=printed.YU_TWO, best=7.76855,
          wanted={"lengths": {"most": 200}}),
    Curve(name="McGarva, free", points=printed.FINGER, best=6.05176),
)  # fmt: skip


def solve_curve_task(curve: Curve, starts: int | None = None) -> lw.synthesis.Synthesis:
    """The task of a curve, for four-bars."""
    inputs = None
    if curve.step:
        inputs = [(curve.first or 0.0) + curve.step * k for k in range(len(curve.points))]
    improve: dict[str, Any] = {"bounds": curve.bounds} if curve.bounds else {}
    if starts is not None:
        improve["starts"] = starts
    further: dict[str, Any] = {"improve": improve} if improve else {}
    task = lw.Task.path(
        curve.points,
        inputs=inputs,
        order="as given" if curve.ordered else "any",
        mechanism="four-bar",
        wanted=curve.wanted,
        rank={"by": {"error": 1}, "deliver": 1000},
        **further,
    )
    return task.solve()


def squares(
    design: lw.synthesis.SynthesizedDesign, points: tuple[tuple[float, float], ...]
) -> float:
    """The sum of squares of a design, by circles about its moving pivots."""
    there = {name: complex(*place) for name, place in design.linkage.points.items()}
    a0, b0, a, b = (there[name] for name in ("A0", "B0", "A", "B"))
    p = there.get("P", there[design.linkage.trace[0]])
    side = np.sign(((b - a) * np.conj(b0 - a)).imag)
    angles: Array = np.radians(design.inputs)
    moving = a0 + abs(a - a0) * np.exp(1j * angles)
    base, c, r = b0 - moving, abs(b - a), abs(b - b0)
    cosine = (np.abs(base) ** 2 + c**2 - r**2) / (2.0 * np.abs(base) * c)
    # the coupler lies on the same side of the line to B0 as at the first position
    coupler = base / np.abs(base) * np.exp(1j * side * np.arccos(cosine))
    place = moving + coupler * (p - a) / (b - a) * c
    return float(np.sum(np.abs(place - [complex(*point) for point in points]) ** 2))


def _curve(curve: Curve) -> tuple[Counter[str], list[str]]:
    begin = process_time()
    found = solve_curve_task(curve, curve.starts)
    seconds = process_time() - begin
    totals = [squares(d, curve.points) for d in found.of_loops if d.delivered]
    best = min(totals, default=np.inf)
    told = f"{curve.name}: {best:.6g} (known {curve.best:.6g}) in {seconds:.1f} s"
    false = []
    if not best <= curve.best * _WITHIN:
        false.append(f"{curve.name}: {best:.8g} is above {curve.best:.8g}")
    if seconds > curve.seconds:
        false.append(f"{curve.name}: {seconds:.1f} s of a processor")
    for design in found.delivered[:1]:
        steps = np.diff(design.inputs)
        if curve.ordered and not ((steps > 0).all() or (steps < 0).all()):
            false.append(f"{curve.name}: delivered out of order")
    counts = {"curves": 1, "curves reached": int(best <= curve.best * _WITHIN), told: 1}
    return Counter(counts), false


def _jansen() -> tuple[Counter[str], list[str]]:
    """The leg's eleven lengths from starts within 5 % of them, each start alone."""
    leg = lw.example("jansen-leg")
    motion = leg.sweep(certify=False)
    rows = np.arange(0, 360, 360 // _LEG_POINTS)
    inputs = motion.inputs["crank"][rows]
    path = motion.trace("F")[rows]
    places = np.stack([path.real, path.imag], axis=1)
    goal = {"point": "F", "points": places, "inputs": inputs}
    assert isinstance(leg.description, Linkage)
    lengths = {key: leg.description.numbers(own) for key, own in leg.description.lengths.items()}
    reached, begin = 0, process_time()
    for seed in range(_LEG_STARTS):
        rng = np.random.default_rng([5, seed])
        start = {name: own * (1.0 + rng.uniform(-0.05, 0.05)) for name, own in lengths.items()}
        changed = leg.with_dimensions(start)
        best = lw.synthesis.improve(changed, goal, vary=list(lengths), starts=1)
        if not best:
            continue
        # the referee solves the improved file by itself
        solved = lw.Mechanism(best[0].description).sweep(certify=False).trace("F")[rows]
        reached += bool(np.sqrt(np.mean(np.abs(solved - path) ** 2)) < _LEG_RMS)
    seconds = (process_time() - begin) / _LEG_STARTS
    told = f"leg: {seconds:.2f} s for a start"
    false = [] if reached >= _LEG_SHARE * _LEG_STARTS else [f"Jansen: only {reached} starts"]
    counts = {"legs from changed lengths": _LEG_STARTS, "legs reached": reached, told: 1}
    return Counter(counts), false


PARTS = len(CURVES) + 1


def improvement_campaign(part: int) -> tuple[Counter[str], list[str]]:
    """One curve, or the leg."""
    return _curve(CURVES[part]) if part < len(CURVES) else _jansen()
