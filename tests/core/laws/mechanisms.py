"""The mechanisms on which every law is tested, with their cycles, each solved once."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

import linkwork as lw
from tests.core.equations.linkages import LINKAGES
from tests.library_mechanisms import driven_examples, read_example
from tests.oracles.four_bar import FourBar, random_crank_rockers

__all__ = ["NAMES", "motion_of", "size_of"]

_LINKS = {
    "ground": ("O2", "O4"),
    "crank": ("O2", "A"),
    "coupler": ("A", "B", "P"),
    "rocker": ("O4", "B"),
}


def _four_bar(bar: FourBar, theta: float, side: int, tip: complex) -> lw.Mechanism:
    """With a coupler point P at ``tip`` times the coupler from A."""
    points = bar.points(theta, side)
    a, b = complex(*points["A"]), complex(*points["B"])
    p = a + (b - a) * tip
    return lw.linkage(
        points=points | {"P": (p.real, p.imag)},
        links=_LINKS,
        inputs=(lw.Input(link="crank", from_=0, to=360, step=1, speed="2 rad/s"),),
        outputs={"mu": "rocker - coupler", "reach": "hypot(P.x, P.y)", "twice": "2*P.x*P.y"},
        trace=("P",),
    )


def _random_four_bar(seed: int) -> lw.Mechanism:
    rng = np.random.default_rng(seed)
    bar = random_crank_rockers(1, seed)[0]
    if seed % 2:  # driven at the rocker, it goes to and fro between two dead points
        bar = FourBar(bar.r1, bar.r4, bar.r3, bar.r2)
    side = 1 if seed % 4 < 2 else -1
    theta = rng.uniform(0, 2 * math.pi)
    while not np.isfinite(bar.coupler_end(np.array(theta), side)):
        theta = rng.uniform(0, 2 * math.pi)
    return _four_bar(bar, theta, side, complex(rng.normal(), rng.normal()))


def _random_slider_crank(seed: int) -> lw.Mechanism:
    """Crank r, rod l, the slider's line in any direction past the crank's pivot."""
    rng = np.random.default_rng(seed)
    crank, rod = rng.uniform(0.5, 1.5), rng.uniform(2.5, 4.0)
    beside, offset = rng.uniform(-0.4, 0.4), rng.uniform(-0.3, 0.3)
    turn = np.exp(1j * rng.uniform(0, 2 * math.pi))
    theta = rng.uniform(0, 2 * math.pi)
    a = crank * np.exp(1j * theta)
    y = beside + offset
    b = math.sqrt(rod**2 - (y - a.imag) ** 2) + a.real + 1j * y
    places = {"O": 0j, "A": a, "B": b, "S": -1 + 1j * beside, "T": 3 + 1j * beside}
    points = {name: ((z * turn).real, (z * turn).imag) for name, z in places.items()}
    return lw.linkage(
        points=points,
        links={
            "ground": ("O", "S", "T"),
            "crank": ("O", "A"),
            "rod": ("A", "B"),
            "block": ("B",),
        },
        sliders=(
            lw.Slider(name="s", link="block", points=("B",), on="ground", line=("S", "T"),
                      offset=offset),
        ),
        inputs=(lw.Input(link="crank", from_=0, to=360, step=1, speed="60 rpm"),),
    )  # fmt: skip


_EXAMPLES = driven_examples()
NAMES = (
    *_EXAMPLES,
    *(f"four-bar {k}" for k in range(10)),
    *(f"slider-crank {k}" for k in range(8)),
    *LINKAGES,
)


@cache
def mechanism_of(name: str) -> lw.Mechanism:
    """A mechanism by its name in ``NAMES``."""
    if name in LINKAGES:
        return LINKAGES[name]()
    kind, _, number = name.rpartition(" ")
    match kind:
        case "four-bar":
            return _random_four_bar(100 + int(number))
        case "slider-crank":
            return _random_slider_crank(200 + int(number))
        case _:
            return read_example(name)


@cache
def motion_of(name: str) -> lw.Motion:
    """Its whole cycle."""
    return mechanism_of(name).sweep()


def size_of(mechanism: lw.Mechanism) -> float:
    """The longest link."""
    return mechanism.loop_equations.length_scale
