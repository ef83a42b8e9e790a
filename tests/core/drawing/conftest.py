"""Mechanisms with closed-form positions: positions and motions built by hand, nothing solved."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np
import pytest

from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.mechanism.bodies import Guide
from linkwork.core.mechanism.part.guides import Strut
from linkwork.core.mechanism.skeleton import Bar, DrivenPart, Skeleton
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from linkwork.core.results.quantities.definition import MechanismNames
from linkwork.core.results.quantities.registry import Quantities
from linkwork.core.results.quantity import Kind, Quantity, Units
from linkwork.core.results.tables import Series

Places = dict[str, complex]


@dataclass(frozen=True)
class Sample:
    """A mechanism whose points are a formula of its input; None where it cannot be assembled."""

    name: str
    skeleton: Skeleton
    at: Callable[[float], Places | None]
    inputs: tuple[float, ...] = tuple(range(0, 361, 3))
    input_name: str = "crank"
    units: Units = field(default=Units(AngleUnit.DEGREE, "mm"))
    speed: float | None = None

    @property
    def input_unit(self) -> str:
        return "deg" if self.skeleton.driven[0].kind == "link" else self.units.length

    @property
    def quantities(self) -> Quantities:
        first = next(places for value in self.inputs if (places := self.at(value)) is not None)
        kind = Kind.ANGLE if self.input_unit == "deg" else Kind.LENGTH
        names = MechanismNames(
            units=self.units,
            skeleton=self.skeleton,
            inputs={self.input_name: kind},
            points=tuple(first),
            by="rad" if kind is Kind.ANGLE else self.input_unit,
            lead=self.input_name,
        )
        return Quantities(names)

    def position(self, value: float) -> Position:
        places = self.at(value)
        status = Status.OUT_OF_REACH if places is None else Status.CONVERGED
        return Position(
            mechanism=self.name,
            units=self.units,
            skeleton=self.skeleton,
            quantities=self.quantities,
            status=status,
            message=status.value,
            input={self.input_name: value},
            input_units={self.input_name: self.input_unit},
            unknowns={},
            points={name: (z.real, z.imag) for name, z in (places or {}).items()},
            residual=0.0,
            iterations=1,
            condition=1.0,
            q=np.zeros(1),
        )

    def motion(self) -> Motion:
        rows = [self.at(value) for value in self.inputs]
        names = next(row for row in rows if row is not None)
        nan = complex(math.nan, math.nan)
        tracks = {n: np.array([nan if r is None else r[n] for r in rows]) for n in names}
        count = len(rows)
        return Motion(
            mechanism=self.name,
            units=self.units,
            skeleton=self.skeleton,
            quantities=self.quantities,
            inputs={self.input_name: np.array(self.inputs)},
            input_units={self.input_name: self.input_unit},
            derivative_unit="rad" if self.input_unit == "deg" else self.input_unit,
            unknowns={},
            points={n: (_series(n, z.real), _series(n, z.imag)) for n, z in tracks.items()},
            status=tuple(Status.OUT_OF_REACH if r is None else Status.CONVERGED for r in rows),
            residual=np.zeros(count),
            iterations=np.ones(count, dtype=np.int64),
            condition=np.ones(count),
            certification=(Certification.NOT_ASKED,) * count,
            radius=np.full(count, np.nan),
            unique_within=np.full(count, np.nan),
            branch=("",) * count,
            limit=("",) * count,
            added=np.zeros(count, dtype=bool),
            speed=self.speed,
            q=np.zeros((count, 1)),
        )


def _series(name: str, value: np.ndarray) -> Series:
    nothing = np.zeros_like(value)
    quantity = Quantity(name=name, kind=Kind.LENGTH)
    return Series(quantity=quantity, value=value, first=nothing, second=nothing)


def turn(degrees: float) -> complex:
    return cmath.exp(1j * math.radians(degrees))


def meet(a: complex, ra: float, b: complex, rb: float, side: int = 1) -> complex | None:
    """Where circles around a and b meet, to the left (side 1) or right (-1) of a → b."""
    d = abs(b - a)
    x = (d * d + ra * ra - rb * rb) / (2 * d)
    if ra * ra < x * x:
        return None
    return a + (x + side * 1j * math.sqrt(ra * ra - x * x)) * (b - a) / d


def met(a: complex, ra: float, b: complex, rb: float, side: int) -> complex:
    """Where circles meet that do."""
    found = meet(a, ra, b, rb, side)
    assert found is not None
    return found


def bars(**links: str) -> tuple[Bar, ...]:
    return tuple(Bar(name=name, points=tuple(points.split())) for name, points in links.items())


def crank_driven(pivot: str) -> tuple[DrivenPart, ...]:
    return (DrivenPart(kind="link", name="crank", pivot=pivot),)


def _four_bar_at(degrees: float, lengths: Iterable[float] = (40, 120, 80, 100)) -> Places | None:
    a, b, c, d = lengths
    crank = a * turn(degrees)
    joint = meet(crank, b, complex(d), c)
    if joint is None:
        return None
    coupler = crank + (joint - crank) * (0.55 + 0.45j)
    return {"O2": 0j, "A": crank, "B": joint, "O4": complex(d), "P": coupler}


_FOUR_BAR = Skeleton(
    fixed=("O2", "O4"),
    bars=bars(crank="O2 A", coupler="A B P", rocker="O4 B"),
    pins=("O2", "A", "B", "O4"),
    driven=crank_driven("O2"),
    traced=("P",),
)


@pytest.fixture
def four_bar() -> Sample:
    return Sample("Four-bar, Norton example 4-1", _FOUR_BAR, _four_bar_at)


@pytest.fixture
def rocking_four_bar() -> Sample:
    """Not a crank: assembled only between two dead points on either side of 0°."""
    lengths = (80, 60, 60, 120)
    return Sample("Double rocker", _FOUR_BAR, lambda u: _four_bar_at(u, lengths))


@pytest.fixture
def slider_crank() -> Sample:
    def at(degrees: float) -> Places:
        crank = 40 * turn(degrees)
        x = crank.real + math.sqrt(120**2 - (20 - crank.imag) ** 2)
        return {"O2": 0j, "A": crank, "B": x + 20j, "S": 0j, "T": 1 + 0j}

    guide = Guide(name="s", point="B", on="ground", line=("S", "T"), offset=20, block=True)
    skeleton = Skeleton(
        fixed=("O2", "S", "T"),
        bars=bars(crank="O2 A", rod="A B", piston="B"),
        pins=("O2", "A", "B"),
        guides=(guide,),
        driven=crank_driven("O2"),
    )
    return Sample("Slider-crank", skeleton, at)


def inclined(degrees: float) -> Sample:
    """A slider-crank turned by an angle, the slider being driven."""
    u = turn(degrees)

    def at(s: float) -> Places | None:
        joint = meet(0j, 40, s * u, 110)
        return None if joint is None else {"O": 0j, "A": joint, "B": s * u, "T": u}

    guide = Guide(name="s", point="B", on="ground", line=("O", "T"), block=True)
    skeleton = Skeleton(
        fixed=("O", "T"),
        bars=bars(crank="O A", rod="A B", piston="B"),
        pins=("O", "A", "B"),
        guides=(guide,),
        driven=(DrivenPart(kind="slider", name="s"),),
    )
    inputs = tuple(range(80, 150, 2))
    return Sample("Slider on a slope", skeleton, at, inputs, input_name="s")


@pytest.fixture
def inverted_slider_crank() -> Sample:
    def at(degrees: float) -> Places:
        pin = 100j + 45 * turn(degrees)
        return {"O2": 100j, "A": pin, "O4": 0j, "Q": 175 * pin / abs(pin)}

    skeleton = Skeleton(
        fixed=("O2", "O4"),
        bars=bars(crank="O2 A", lever="O4 Q"),
        pins=("O2", "A", "O4"),
        guides=(Guide(name="d", point="A", on="lever", line=("O4", "Q")),),
        driven=crank_driven("O2"),
        traced=("Q",),
    )
    return Sample("Inverted slider-crank", skeleton, at)


@pytest.fixture
def collar() -> Sample:
    """As the inverted slider-crank, with a block on a rod instead of a pin in a slot."""

    def at(degrees: float) -> Places:
        pin = 90j + 35 * turn(degrees)
        return {"O2": 90j, "A": pin, "O4": 0j, "Q": 40 * pin / abs(pin)}

    skeleton = Skeleton(
        fixed=("O2", "O4"),
        bars=bars(crank="O2 A", rod="O4 Q", collar="A"),
        pins=("O2", "A", "O4"),
        guides=(Guide(name="d", point="A", on="rod", line=("O4", "Q"), block=True),),
        driven=crank_driven("O2"),
    )
    return Sample("Collar on a rod", skeleton, at)


@pytest.fixture
def six_link() -> Sample:
    """A four-bar whose straight three-point rocker pushes a bar along a fixed line."""

    def at(degrees: float) -> Places | None:
        a0, c0 = 0j, -480 - 340j
        a = 100 * turn(degrees)
        b = meet(a, 560, c0, 400, -1)
        assert b is not None
        d = c0 + (b - c0) * 1.7
        x = d.real - math.sqrt(300**2 - (d.imag - 420) ** 2)
        e = complex(x, 420)
        return {
            "A0": a0, "A": a, "B": b, "C0": c0, "D": d, "E": e, "F": e - 260,
            "S": 420j, "T": 1 + 420j,
        }  # fmt: skip

    skeleton = Skeleton(
        fixed=("A0", "C0", "S", "T"),
        bars=bars(crank="A0 A", coupler="A B", rocker="C0 B D", rod="D E", rapier="E F"),
        pins=("A0", "A", "B", "C0", "D", "E"),
        guides=tuple(
            Guide(name="s16", point=p, on="ground", line=("S", "T"), block=True) for p in "EF"
        ),
        driven=crank_driven("A0"),
        traced=("B",),
    )
    return Sample("Rapier drive of a loom", skeleton, at)


@pytest.fixture
def boom() -> Sample:
    def at(length: float) -> Places | None:
        foot, base = 0j, 60 - 25j
        lug = meet(base, length, foot, 90, -1)
        if lug is None:
            return None
        along = lug / abs(lug) * turn(-12)
        return {"O": foot, "K": base, "L": lug, "E": 260 * along, "G": (150 - 12j) * along}

    skeleton = Skeleton(
        fixed=("O", "K"),
        bars=bars(boom="O L E G"),
        pins=("O", "K", "L"),
        struts=(Strut(name="ram", between=("K", "L")),),
        driven=(DrivenPart(kind="cylinder", name="ram"),),
        traced=("E",),
    )
    inputs = tuple(range(70, 121))
    return Sample("Boom with cylinder", skeleton, at, inputs, input_name="ram")


def jansen_at(degrees: float, far: bool = False) -> Places | None:
    m, b, c, d, e, f = 15, 41.5, 39.3, 40.1, 55.8, 39.4
    g, h, i, j, k = 36.7, 65.7, 49, 50, 61.9
    pivot = -38 - 7.8j
    flip = -1 if far else 1
    crank = m * turn(degrees)
    # The far leg is the mirror image, driven by the mirrored crank angle.
    z = complex(flip * crank.real, crank.imag)
    up = met(pivot, b, z, j, 1)
    down = met(pivot, c, z, k, -1)
    back = met(pivot, d, up, e, 1)
    knee = met(back, f, down, g, -1)
    foot = met(knee, h, down, i, -1)
    places = {"U": up, "V": back, "W": down, "N": knee, "F": foot}
    mirrored = {n: complex(flip * p.real, p.imag) for n, p in places.items()}
    return mirrored | {"Z": crank, "P": complex(flip * pivot.real, pivot.imag)}


@pytest.fixture
def jansen() -> Sample:
    """Two legs on one crank: fifteen points with the frame and a named middle of the body."""

    def at(degrees: float) -> Places:
        one, two = jansen_at(degrees), jansen_at(degrees, far=True)
        assert one
        assert two
        legs = {f"{n}1": p for n, p in one.items() if n != "Z"}
        legs |= {f"{n}2": p for n, p in two.items() if n != "Z"}
        return {"O": 0j, "Z": one["Z"], **legs, "M": 28j}

    links = {"crank": "O Z"}
    for k in "12":
        links |= {
            f"upper{k}": f"P{k} U{k} V{k}", f"j{k}": f"Z U{k}", f"k{k}": f"Z W{k}",
            f"c{k}": f"P{k} W{k}", f"f{k}": f"V{k} N{k}", f"lower{k}": f"N{k} W{k} F{k}",
        }  # fmt: skip
    pins = ("O", "Z", *(f"{n}{k}" for k in "12" for n in "PUVWN"))
    skeleton = Skeleton(
        fixed=("O", "P1", "P2", "M"),
        bars=bars(**links),
        pins=pins,
        driven=crank_driven("O"),
        traced=("F1", "F2"),
    )
    return Sample("Two legs after Theo Jansen", skeleton, at)


@pytest.fixture
def fifteen_points(jansen: Sample) -> Sample:
    return jansen


@pytest.fixture
def flat() -> Sample:
    """A chain ten times as wide as high."""

    def at(degrees: float) -> Places | None:
        crank = 30 * turn(degrees)
        joint = meet(crank, 500, 520 + 0j, 60)
        return None if joint is None else {"O2": 0j, "A": crank, "B": joint, "O4": 520 + 0j}

    skeleton = Skeleton(
        fixed=("O2", "O4"),
        bars=bars(crank="O2 A", coupler="A B", rocker="O4 B"),
        pins=("O2", "A", "B", "O4"),
        driven=crank_driven("O2"),
    )
    return Sample("Long flat four-bar", skeleton, at)


@pytest.fixture
def tall() -> Sample:
    """A slider-crank standing upright, its slider in a vertical guide."""

    def at(degrees: float) -> Places:
        crank = 30 * turn(degrees)
        y = crank.imag + math.sqrt(400**2 - crank.real**2)
        return {"O": 0j, "A": crank, "B": y * 1j, "T": 1j}

    skeleton = Skeleton(
        fixed=("O", "T"),
        bars=bars(crank="O A", rod="A B", piston="B"),
        pins=("O", "A", "B"),
        guides=(Guide(name="s", point="B", on="ground", line=("O", "T"), block=True),),
        driven=crank_driven("O"),
    )
    return Sample("Tall upright slider-crank with a long name that needs two lines", skeleton, at)


@pytest.fixture
def slope() -> Callable[[float], Sample]:
    return inclined


@pytest.fixture
def ternary() -> Sample:
    """A Stephenson-like six-link: two ternary links, one of them carried by the ground."""

    def at(degrees: float) -> Places | None:
        o2, o4, o6 = 0j, 120 + 0j, 190 + 30j
        a = 35 * turn(degrees)
        b = meet(a, 110, o4, 70)
        assert b is not None
        c = a + (b - a) * (0.5 + 0.5j)
        d = meet(c, 120, o6, 90, 1)
        if d is None:
            return None
        e = o6 + (d - o6) * (0.6 - 0.6j)
        return {"O2": o2, "A": a, "B": b, "C": c, "D": d, "E": e, "O4": o4, "O6": o6}

    skeleton = Skeleton(
        fixed=("O2", "O4", "O6"),
        bars=bars(crank="O2 A", coupler="A B C", rocker="O4 B", rod="C D", output="O6 D E"),
        pins=("O2", "A", "B", "C", "D", "O4", "O6"),
        driven=crank_driven("O2"),
        traced=("C", "E"),
    )
    return Sample("Stephenson six-link", skeleton, at)
