"""Families: on one core against pylinkage's Ensemble, a harder mechanism, and a second core."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

import linkwork as lw
from benchmarks.peers.linkwork_sweep import family_of
from benchmarks.peers.pylinkage_numba import PylinkageEnsemble
from benchmarks.peers.work import Work, four_bar_family
from benchmarks.timing import Clock, bar, interleaved
from linkwork.core.foundation.loading import cores
from linkwork.families import Family

__all__ = ["measure", "rapier_family"]

_DESIGNS, _ROWS = 10_000, 200

#: Certified, compiled: limit of the ratio to Ensemble.
_GEARS = {
    (False, False): 1 / 4,
    (True, False): 1 / 1.5,
    (False, True): 1 / 8,
    (True, True): 1 / 1.5,
}
_RAPIER = 3.0
_SECOND_CORE = 1 / 1.8
_EFFORT = 2.0


def measure(repeats: int = 9) -> bool:
    """Limits: time per position, warm, designs built in advance."""
    print(f"families of {_DESIGNS:,} designs × {_ROWS} inputs, one thread, ratios of time")
    work = four_bar_family(_DESIGNS, _ROWS)
    four_bars, rapiers = family_of(work), rapier_family(_DESIGNS, _ROWS)
    held = True
    for (certify, compiled), limit in _GEARS.items():
        ours, harder = (_sweep(family, certify, compiled) for family in (four_bars, rapiers))
        what = ("compiled" if compiled else "general") + (", certified" if certify else "")
        for theirs in _ensemble(work):
            ratios = _ratios(ours, theirs, repeats, time.process_time)
            held = bar(f"four-bars, {what} / pylinkage Ensemble", ratios, limit) and held
        ratios = _ratios(harder, ours, repeats, time.process_time)
        held = bar(f"rapier drives / four-bars, {what}", ratios, _RAPIER) and held
    held = _effort(repeats) and held
    if cores() > 1:
        held = _two_cores(four_bars, repeats) and held
    return held


def _effort(repeats: int) -> bool:
    """Slider-cranks with the torque at the crank, against the same family without it."""
    family = _loaded_slider_cranks(100_000)
    without = partial(family.reduced, ["max(d)"], threads=1)
    with_effort = partial(family.reduced, ["max(d)", "max(crank.effort)"], threads=1)
    ratios = _ratios(with_effort, without, repeats, time.process_time)
    return bar("slider-cranks, certified, with effort / without", ratios, _EFFORT)


def _loaded_slider_cranks(designs: int) -> Family:
    """Masses on all links, gravity and a load on the slider; 37 rows."""
    crank = lw.example("slider-crank").changed(
        masses={
            "crank": lw.Mass(mass=1.0, center=(15, 0), inertia=300),
            "rod": lw.Mass(mass=0.8, center=(50, 3), inertia=900),
            "block": lw.Mass(mass=0.5),
        },
        gravity=lw.Gravity(),
        loads=[lw.Load(point="B", force=(-100, 0))],
        inputs=[lw.Input(link="crank", from_=0, to=360, step=10, speed="300 rpm")],
    )
    rng = np.random.default_rng(1)
    sizes = {"O2 A": rng.normal(40, 0.5, designs), "B A": rng.normal(120, 1, designs)}
    return crank.family(sizes)


def rapier_family(designs: int, rows: int) -> Family:
    """Rapier drives with every length within half a per cent, over a full turn."""
    drive = lw.example("rapier-drive")
    (own,) = drive.description.inputs
    turn = replace(own, from_=0.0, to=360.0 - 360.0 / rows, step=360.0 / rows)
    rng = np.random.default_rng(1)
    return drive.changed(inputs=(turn,)).family(
        {
            name: float(value) * rng.uniform(0.995, 1.005, designs)
            for name, value in drive.description.dimensions.items()
            if value
        }
    )


def _sweep(family: Family, certify: bool, compiled: bool, threads: int = 1) -> Callable[[], object]:
    run = partial(family.sweep, certify=certify, specialised=compiled, threads=threads)
    found = run().found
    assert found.all(), f"{(~found).sum()} rows of {family} were not found"
    return run


def _ratios(
    one: Callable[[], object],
    other: Callable[[], object],
    repeats: int,
    clock: Clock,
    *,
    steady: bool = False,
) -> list[float]:
    """Ratios of times, alternating."""
    pair = interleaved([one, other], repeats, clock, steady=steady)
    return [a / b for a, b in zip(*pair, strict=True)]


def _ensemble(work: Work) -> list[Callable[[], object]]:
    peer = PylinkageEnsemble()
    return [] if peer.missing() else [peer.prepare(work).run]


def _two_cores(family: Family, repeats: int) -> bool:
    """Wall time of two threads against one, in continuous work."""
    held = True
    for certify, compiled in product((False, True), repeat=2):
        one, two = (_sweep(family, certify, compiled, threads) for threads in (1, 2))
        what = ("compiled" if compiled else "general") + (", certified" if certify else "")
        ratios = _ratios(two, one, repeats, time.perf_counter, steady=True)
        held = bar(f"four-bars, two threads / one, {what}", ratios, _SECOND_CORE) and held
    return held
