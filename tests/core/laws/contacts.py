"""A random mechanism with each kind of weld, gear, belt, rack, rolling wheel, cam and curve."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

import linkwork as lw

__all__ = ["KINDS", "contact", "outline_points", "xy"]

Rng = np.random.Generator


def xy(**places: complex) -> dict[str, tuple[float, float]]:
    """Coordinates of points by name."""
    return {name: (z.real, z.imag) for name, z in places.items()}


def _turn(link: str, stop: float = 360, step: float = 6) -> tuple[lw.Input, ...]:
    return (lw.Input(link=link, from_=0, to=stop, step=step),)


def _cis(degrees: float) -> complex:
    return cmath.rect(1.0, math.radians(degrees))


def weld(rng: Rng) -> lw.Mechanism:
    """A four-bar whose coupler carries a welded arm; the rocker is welded to another one."""
    return lw.linkage(
        points=xy(O2=0j, A=3 + 0j, B=8 + 7j, P=4 + 9j, O4=9 + 0j, Q=12 + 3j),
        links={
            "ground": ("O2", "O4"),
            "crank": ("O2", "A"),
            "coupler": ("A", "B"),
            "arm": ("B", "P"),
            "rocker": ("O4", "B"),
            "flag": ("O4", "Q"),
        },
        lengths={"O2 A": rng.uniform(1.5, 3), "A B": 9, "O4 B": 8, "B P": 4, "O4 Q": 3},
        welds=(
            lw.Weld(links=("coupler", "arm"), angle=float(rng.uniform(-170, 170))),
            lw.Weld(links=("rocker", "flag")),
        ),
        inputs=_turn("crank"),
    )


def _five_bar(rng: Rng, **parts: Any) -> lw.Mechanism:
    """Cranks at O and P, joined by two rods that always reach."""
    left, right = rng.uniform(5, 15, 2)
    start = [_cis(a) for a in rng.uniform(-180, 180, 2)]
    return lw.linkage(
        points=xy(
            O=0j, P=60 + 0j, A=left * start[0], B=60 + right * start[1], C=30 + 60j
        ),
        links={
            "ground": ("O", "P"),
            "left": ("O", "A"),
            "right": ("P", "B"),
            "rod1": ("A", "C"),
            "rod2": ("B", "C"),
        },
        lengths={"A C": 70, "B C": 65},
        inputs=_turn("left"),
        trace=("C",),
        **parts,
    )  # fmt: skip


def gear_external(rng: Rng) -> lw.Mechanism:
    sizes = [(20, 40), (30, 15), (17, 17), (40, 15)][int(rng.integers(4))]
    phase = float(rng.uniform(-90, 90)) if rng.random() < 0.5 else None
    gear = lw.Gear(
        name="mesh", wheels=("left", "right"), centers=("O", "P"), teeth=sizes, phase=phase
    )
    return _five_bar(rng, gears=(gear,))


def noncircular_law(rng: Rng) -> lw.Mechanism:
    """Ellipses about their foci, or a wheel that turns twice or half as fast as the other."""
    lobes, turns = [(1, 1), (2, 2), (2, 1), (1, 2)][int(rng.integers(4))]
    wave = f"atan(ecc*sin({lobes}*phi)/(1 - ecc*cos({lobes}*phi)))"
    law = f"-{lobes}/{turns}*phi - 2/{turns}*{wave}"
    phase = float(rng.uniform(-90, 90)) if rng.random() < 0.5 else None
    gear = lw.NoncircularGear(
        name="mesh", wheels=("left", "right"), centers=("O", "P"), law=law, phase=phase,
        start=float(rng.uniform(-90, 90)),
    )  # fmt: skip
    return _five_bar(
        rng, noncircular_gears=(gear,), dimensions={"ecc": float(rng.uniform(0.1, 0.4))}
    )


def noncircular_table(rng: Rng) -> lw.Mechanism:
    phi = np.linspace(0, 360, 25)
    psi = -phi - rng.uniform(5, 20) * np.sin(np.radians(phi) + rng.uniform(0, 6))
    psi[-1] = psi[0] - 360
    table = tuple(zip(phi.tolist(), psi.tolist(), strict=True))
    gear = lw.NoncircularGear(
        name="mesh", wheels=("left", "right"), centers=("O", "P"), table=table, start=20
    )
    return _five_bar(rng, noncircular_gears=(gear,))


def noncircular_curve(rng: Rng) -> lw.Mechanism:
    """An ellipse about its focus, with half of the centres' distance as semi-axis."""
    e, begin = rng.uniform(0.1, 0.4), rng.uniform(0, 6)
    angle = 2 * np.pi * np.arange(96) / 96
    z = 30 * (1 - e**2) / (1 - e * np.cos(angle)) * np.exp(1j * (angle + begin))
    gear = lw.NoncircularGear(
        name="mesh", wheels=("left", "right"), centers=("O", "P"),
        pitch_curve=tuple((float(p.real), float(p.imag)) for p in z),
    )  # fmt: skip
    return _five_bar(rng, noncircular_gears=(gear,))


def gear_internal(rng: Rng) -> lw.Mechanism:
    """A planet inside a ring that stands still; the sun drives. Its point P moves a rod."""
    start = _cis(rng.uniform(-180, 180))
    sun, planet = [(24, 12), (30, 15), (20, 30)][int(rng.integers(3))]
    ring = sun + 2 * planet
    arm = float(sun + planet)
    pin = arm * start + rng.uniform(3, planet) * _cis(rng.uniform(-180, 180))
    return lw.linkage(
        points=xy(O=0j, C=arm * start, P=pin, B=150 + 10j, Q=150 - 110j),
        links={
            "ground": ("O", "Q"),
            "carrier": ("O", "C"),
            "sun": ("O",),
            "planet": ("C", "P"),
            "rod": ("P", "B"),
            "rocker": ("Q", "B"),
        },
        lengths={"P B": 150, "Q B": 120},
        gears=(
            lw.Gear(
                name="outer", wheels=("ground", "planet"), centers=("O", "C"), arm="carrier",
                internal=True, radii=(ring, planet),
            ),
            lw.Gear(
                name="inner", wheels=("sun", "planet"), centers=("O", "C"), arm="carrier",
                teeth=(sun, planet),
            ),
        ),
        inputs=_turn("sun"),
    )  # fmt: skip


def gear_moving_arm(rng: Rng) -> lw.Mechanism:
    """A four-bar; a wheel on the crank's end rolls on one that stands still at its pivot."""
    crank = float(rng.uniform(1.5, 3))
    return lw.linkage(
        points=xy(O2=0j, A=crank + 0j, B=8 + 7j, O4=9 + 0j, W=crank + 1j),
        links={
            "ground": ("O2", "O4"),
            "crank": ("O2", "A"),
            "coupler": ("A", "B"),
            "rocker": ("O4", "B"),
            "wheel": ("A", "W"),
        },
        lengths={"A B": 9, "O4 B": 8},
        gears=(
            lw.Gear(
                name="mesh", wheels=("ground", "wheel"), centers=("O2", "A"), arm="crank",
                radii=(0.4 * crank, 0.6 * crank),
            ),
        ),
        inputs=_turn("crank"),
    )  # fmt: skip


def belt(rng: Rng, *, crossed: bool = False) -> lw.Mechanism:
    ratio = [(20, 10), (8, 24), (12, 12), (10, 15)][int(rng.integers(4))]
    given: dict[str, Any] = {"teeth": ratio} if rng.random() < 0.5 else {"radii": ratio}
    part = lw.Belt(name="b", wheels=("left", "right"), centers=("O", "P"), crossed=crossed, **given)
    return _five_bar(rng, belts=(part,))


def rack(rng: Rng) -> lw.Mechanism:
    """A pinion over or under a rack whose line leans; the rack pushes a rocker by a rod."""
    along = _cis(rng.uniform(-40, 40))
    radius = float(rng.uniform(8, 15))
    side = float(rng.choice([-1, 1]))
    places = {
        "O": 1j * side * radius,
        "S": -60 + 0j,
        "T": 60 + 0j,
        "R": 5 + 0j,
        "B": 60 + 20j,
        "Q": 60 - 50j,
    }
    return lw.linkage(
        points=xy(**{name: z * along for name, z in places.items()}),
        links={
            "ground": ("O", "S", "T", "Q"),
            "pinion": ("O",),
            "rack": ("R",),
            "rod": ("R", "B"),
            "rocker": ("Q", "B"),
        },
        sliders=(lw.Slider(name="s", link="rack", points=("R",), on="ground", line=("S", "T")),),
        racks=(lw.Rack(name="mesh", pinion="pinion", center="O", slider="s", radius=radius),),
        inputs=(lw.Input(link="pinion", from_=-50, to=50, step=2),),
    )


def rolling_line(rng: Rng) -> lw.Mechanism:
    """A crank and a rod push a wheel along a line, on one side of it."""
    radius = float(rng.uniform(5, 12))
    side = float(rng.choice([-1, 1]))
    crank, start = float(rng.uniform(6, 12)), _cis(rng.uniform(-180, 180))
    line = -side * radius + rng.uniform(-5, 5)
    return lw.linkage(
        points=xy(
            O=0j, A=crank * start, C=45 + 1j * (line + side * radius), W=45 + 3j,
            S=-10 + 1j * line, T=80 + 1j * line,
        ),
        links={
            "ground": ("O", "S", "T"),
            "crank": ("O", "A"),
            "rod": ("A", "C"),
            "wheel": ("C", "W"),
        },
        lengths={"A C": 45, "C W": 4},
        rolling=(lw.Rolling(name="x", wheel="wheel", center="C", radius=radius, line=("S", "T")),),
        inputs=_turn("crank"),
    )  # fmt: skip


def rolling_circle(rng: Rng, *, inside: bool) -> lw.Mechanism:
    """The wheel's pin moves a rocker by a rod."""
    large, small = float(rng.uniform(20, 30)), float(rng.uniform(4, 15))
    arm = (large - small if inside else large + small) * _cis(rng.uniform(-180, 180))
    pin = arm + rng.uniform(2, 6) * _cis(rng.uniform(-180, 180))
    return lw.linkage(
        points=xy(O=0j, C=arm, P=pin, B=150 + 10j, Q=150 - 110j),
        links={
            "ground": ("O", "Q"),
            "wheel": ("C", "P"),
            "rod": ("P", "B"),
            "rocker": ("Q", "B"),
        },
        lengths={"P B": 150, "Q B": 120},
        rolling=(
            lw.Rolling(
                name="way", wheel="wheel", center="C", radius=small, circle="O",
                circle_radius=large, inside=inside,
            ),
        ),
        inputs=_turn("wheel"),
    )  # fmt: skip


#: Rises and returns whose first two derivatives are continuous.
_LAWS = ("cycloidal", "modified sine", "modified trapezoid", "3-4-5", "4-5-6-7")


def segments(rng: Rng, lift: float) -> tuple[lw.Segment, ...]:
    """A rise, a dwell, a return and a dwell."""
    rise, back = rng.choice(_LAWS, 2)
    return (
        lw.Segment(law=str(rise), over=120, lift=lift),
        lw.Segment(law="dwell", over=50),
        lw.Segment(law=str(back), over=140, lift=-lift),
        lw.Segment(law="dwell", over=50),
    )


def outline_points(rng: Rng, count: int = 12) -> tuple[tuple[float, float], ...]:
    """A convex closed outline around the origin."""
    phi = 2 * np.pi * np.arange(count) / count
    size = 40 + rng.uniform(2, 5) * np.cos(phi - rng.uniform(0, 6)) + np.cos(2 * phi)
    z: npt.NDArray[np.complex128] = size * np.exp(1j * phi)
    return tuple((float(p.real), float(p.imag)) for p in z)


def _translating(rng: Rng, contact: str, **cam: Any) -> lw.Mechanism:
    offset = float(rng.uniform(-6, 6))
    along = _cis(rng.uniform(40, 140))
    places = {"O": 1 + 2j, "S": 1 + 2j + along * 1j * offset, "R": 0j}
    places["T"] = places["S"] + 100 * along
    places["R"] = places["S"] + 55 * along
    return lw.linkage(
        points=xy(**places),
        links={"ground": ("O", "S", "T"), "cam": ("O",), "stem": ("R",)},
        sliders=(lw.Slider(name="s", link="stem", points=("R",), on="ground", line=("S", "T")),),
        cams=(lw.Cam(name="law", cam="cam", center="O", slider="s", contact=contact, **cam),),
        inputs=_turn("cam"),
    )


def _swinging(rng: Rng, contact: str, **cam: Any) -> lw.Mechanism:
    """A follower that swings about P on either side of the line from P to the cam's centre."""
    side = float(rng.choice([-1, 1]))
    return lw.linkage(
        points=xy(O=0j, P=80 + 5j, R=20 + 42j * side, A=90 + 20j),
        links={"ground": ("O", "P"), "cam": ("O",), "arm": ("P", "R"), "lever": ("P", "A")},
        lengths={"P R": float(rng.uniform(72, 78))},
        welds=(lw.Weld(links=("arm", "lever")),),
        cams=(
            lw.Cam(
                name="law", cam="cam", center="O", link="arm", pivot="P", point="R",
                contact=contact, **cam,
            ),
        ),
        inputs=_turn("cam"),
    )  # fmt: skip


def _program(rng: Rng, lift: float) -> dict[str, Any]:
    return {"segments": segments(rng, lift), "base": 40, "start": float(rng.uniform(-180, 180))}


def _roller(contact: str, rng: Rng) -> dict[str, Any]:
    return {"radius": float(rng.uniform(4, 10))} if contact == "roller" else {}


def cam_program(rng: Rng, contact: str, *, swings: bool) -> lw.Mechanism:
    """The follower's motion is given."""
    if swings:
        return _swinging(rng, contact, **_program(rng, 8.0), **_roller(contact, rng))
    lift = 4.0 if contact == "flat" else 9.0
    return _translating(rng, contact, **_program(rng, lift), **_roller(contact, rng))


def cam_outline(rng: Rng, contact: str, *, swings: bool) -> lw.Mechanism:
    """The cam's outline is given."""
    make = _swinging if swings else _translating
    return make(rng, contact, profile=outline_points(rng), **_roller(contact, rng))


def curve_open(rng: Rng) -> lw.Mechanism:
    """The far end of a rod runs along a curve through given points."""
    x = np.linspace(40, 160, 7)
    y = rng.uniform(-6, 6, 7)
    return lw.linkage(
        points=xy(O=0j, A=15 + 0j, B=105 + 0j),
        links={"ground": ("O",), "crank": ("O", "A"), "rod": ("A", "B")},
        lengths={"A B": 90},
        curves=(
            lw.Curve(
                name="u", point="B", on="ground", origin="O",
                through=tuple(zip(x.tolist(), y.tolist(), strict=True)),
            ),
        ),
        inputs=_turn("crank"),
    )  # fmt: skip


def curve_closed(rng: Rng) -> lw.Mechanism:
    """A pin on a rocker runs along a closed curve of a link that turns once around."""
    return lw.linkage(
        points=xy(O=0j, D=10 + 0j, P=90 + 5j, R=20 + 40j),
        links={"ground": ("O", "P"), "plate": ("O", "D"), "arm": ("P", "R")},
        lengths={"P R": 80},
        curves=(
            lw.Curve(
                name="u", point="R", on="plate", origin="O", through=outline_points(rng),
                closed=True,
            ),
        ),
        inputs=_turn("plate"),
    )  # fmt: skip


KINDS: dict[str, Callable[[Rng], lw.Mechanism]] = {
    "weld": weld,
    "gear external": gear_external,
    "gear internal": gear_internal,
    "non-circular gears by a formula": noncircular_law,
    "non-circular gears by a table": noncircular_table,
    "non-circular gears by a pitch curve": noncircular_curve,
    "gear on a moving arm": gear_moving_arm,
    "belt open": belt,
    "belt crossed": lambda rng: belt(rng, crossed=True),
    "rack": rack,
    "rolling on a line": rolling_line,
    "rolling on a circle": lambda rng: rolling_circle(rng, inside=False),
    "rolling in a circle": lambda rng: rolling_circle(rng, inside=True),
    **{
        f"cam by its {word}, {way} {contact}": partial(
            make, contact=contact, swings=way == "swinging"
        )
        for word, make in (("follower", cam_program), ("outline", cam_outline))
        for way in ("sliding", "swinging")
        for contact in ("knife", "roller", "flat")
    },
    "curve open": curve_open,
    "curve closed": curve_closed,
}


def contact(kind: str, seed: int) -> lw.Mechanism:
    """A random mechanism of one kind."""
    return KINDS[kind](np.random.default_rng(seed))
