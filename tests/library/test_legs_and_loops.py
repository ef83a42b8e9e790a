"""Walking legs, robots, and mechanisms of several loops, coupled or one after the other."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq, root

import linkwork as lw
from linkwork.core.foundation.arrays import ComplexArray
from tests.library.laws import degrees, law, motion_of, same
from tests.oracles.circles import Jansen, circles_meet
from tests.oracles.four_bar import FourBar


@law("jansen-leg")
def test_jansen_foot_follows_its_five_dyads() -> None:
    """Five dyads, one after the other, place the foot F."""
    motion = motion_of("jansen-leg")
    same(motion.trace("F"), Jansen().foot(degrees(motion, "crank")), 100)


@law("klann-leg")
def test_klann_foot_makes_the_patents_stride_of_1() -> None:
    """From the patent's coordinates at 180°: the foot at (1.000, 0.000) at 0°, as printed."""
    motion = motion_of("klann-leg")
    a = complex(1.599, 0.75) + 0.268 * np.exp(1j * degrees(motion, "crank"))

    def dyad(
        first: np.ndarray, second: np.ndarray, ra: complex, rb: complex, side: int
    ) -> ComplexArray:
        return circles_meet(first, abs(ra), second, abs(rb), side)

    fixed = np.full(a.shape, complex(1.009, 0.574))
    elbow = dyad(a, fixed, 0.59, complex(0.268, 0.176), -1)
    knee = a + (elbow - a) * complex(-1.099, 0.116) / -0.59
    upper = np.full(a.shape, complex(1.366, 1.366))
    hip = dyad(knee, upper, complex(0.634, 0.634), complex(0.5, 0.134), 1)
    foot = knee + (hip - knee) * complex(-0.232, -0.866) / complex(0.634, 0.634)
    same(motion.trace("F"), foot, 2)
    printed = {"E1": (1.277, 0.75), "K": (0.768, 0.866), "H": (1.0, 1.732), "F": (1.0, 0.0)}
    position = lw.example("klann-leg").solve(at=0)
    for point, place in printed.items():
        assert position.points[point] == pytest.approx(place, abs=5e-4)


@law("trotbot-leg")
def test_trotbot_foot_follows_its_dyads() -> None:
    """Three dyads place the foot; it walks six units within 0.3 of height."""
    motion = motion_of("trotbot-leg")
    pin = 4 * np.exp(1j * degrees(motion, "crank"))
    frame = np.full(pin.shape, complex(-7, 6))
    top = circles_meet(pin, 6, frame, 8, -1)
    back = frame + (frame - top) / 4
    middle = circles_meet(pin, 11, back, 6, 1)
    low = back + (middle - back) * 8 / 6
    corner = pin + (top - pin) / 2 * np.exp(1j * math.radians(109.475))
    foot = circles_meet(corner, 9, low, 8, 1)
    same(motion.trace("J7"), foot, 15)
    stance = foot[foot.imag < foot.imag.min() + 0.3]
    assert np.ptp(stance.real) > 6  # a flat stance of six units, 0.3 high


# ------------------------------------------------------------------ robots


@law("five-bar-robot")
def test_five_bar_tool_is_on_both_forearms_circles() -> None:
    """P is where the circles of 120 about both elbows meet."""
    motion = motion_of("five-bar-robot")
    left = 90 * np.exp(1j * degrees(motion, "left"))
    right = 118 + 90 * np.exp(1j * degrees(motion, "right"))
    same(motion.trace("P"), circles_meet(left, 120, right, 120, 1), 120)


@law("three-rpr")
def test_three_rpr_platform_has_its_six_published_assemblies() -> None:
    """Six assemblies at the legs 14.98, 15.38, 12: angles 14.055°, 33.557°, … 357.288°."""
    motion = motion_of("three-rpr")
    for foot, joint, leg in ((0, "B1", "leg1"), (15.91, "B2", "leg2"), (10j, "B3", "leg3")):
        same(np.abs(motion.trace(joint) - foot), motion[leg], 20)
    at = {"leg1": 14.98, "leg2": 15.38, "leg3": 12.0}
    ways = lw.example("three-rpr").configurations(at=at)
    assert ways.completeness is lw.Completeness.PROVED
    found = sorted(way["platform"] % 360 for way in ways)
    printed = [14.05520080, 33.55657866, 57.41257925, 122.20641823, 303.45054168, 357.28811230]
    assert found == pytest.approx(printed, abs=1e-8)


# ------------------------------------------------------------------ several loops


@law("double-four-bar")
def test_double_four_bar_is_two_four_bars() -> None:
    """The rocker of the first four-bar, turned by 20°, drives the second."""
    motion = motion_of("double-four-bar")
    first = FourBar(100, 40, 120, 80)
    _, third = first.phasors(degrees(motion, "θ1"), 1)
    same(np.exp(1j * degrees(motion, "θ3")), third, 1)
    second = FourBar(130, 60, 110, 90)
    driving = np.angle(third) + math.radians(20)
    fourth, fifth = second.phasors(driving, 1)
    same(np.exp(1j * degrees(motion, "θ4")), fourth, 1)
    same(np.exp(1j * degrees(motion, "θ5")), fifth, 1)


@law("coupled-six-link")
def test_coupled_six_link_has_its_six_published_configurations() -> None:
    """Six configurations at 60°: s6 = 1252.618, 741.813, … -657.653."""
    ways = lw.example("coupled-six-link").configurations(at=60)
    printed = [1252.618473, 741.812501, 40.140378, 25.672098, -102.590796, -657.652654]
    assert sorted((way["s6"] for way in ways), reverse=True) == pytest.approx(printed, abs=5e-7)


@law("andrews-squeezer")
def test_andrews_squeezer_hangs_on_three_dyads() -> None:
    """F is on circles about P and B; G and H on circles about A and F."""
    motion = motion_of("andrews-squeezer")
    p = 0.007 * np.exp(1j * motion["β"])
    low, high = complex(-0.06934, -0.00227), complex(-0.03635, 0.03273)
    f = circles_meet(p, 0.028, np.full(p.shape, high), 0.035, 1)
    same(motion.trace("F"), f, 0.07)
    same(motion.trace("G"), circles_meet(np.full(p.shape, low), 0.04, f, 0.02, 1), 0.07)
    same(motion.trace("H"), circles_meet(np.full(p.shape, low), 0.04, f, 0.02, -1), 0.07)


@law("stephenson-far-crank")
def test_stephenson_far_crank_reaches_the_coupler_point_of_its_four_bar() -> None:
    """The coupler point C of the four-bar stays 150 from the crank's pin.

    The left link's angle that closes it is bisected around the row's own.
    """
    motion = motion_of("stephenson-far-crank")
    bar = FourBar(100, 60, 105, 75)
    along = (105**2 + 105**2 - 65**2) / (2 * 105**2)
    tip = complex(along, math.sqrt(1 - along**2))  # AC as long as AB

    for row in range(0, len(motion), 45):
        end = 190 + 60j + 20 * np.exp(1j * degrees(motion, "crank")[row])

        def gap(left: float, end: complex = end) -> float:
            a = complex(bar.crank_end(np.asarray(left)))
            b = complex(bar.coupler_end(np.asarray(left), 1))
            return abs(a + (b - a) * tip - end) - 150

        near = degrees(motion, "left")[row]
        same(brentq(gap, near - 0.05, near + 0.05, xtol=1e-15), near, 1, within=1e-11)


@law("double-butterfly")
def test_double_butterfly_lists_every_configuration_that_random_starts_find() -> None:
    """All configurations satisfy ten distances between pins; no other exists.

    Solved from scratch at crank 60°, from random starts.
    """
    turn = np.exp(1j * math.radians(60))
    apex = (16**2 + 16**2 - 30**2) / (2 * 16**2)
    c1, c2 = 16 * turn, 16 * turn * complex(apex, -math.sqrt(1 - apex**2))
    legs = [(0, -110 - 20j, 105), (1, c1, 91), (2, 120 - 10j, 100), (3, c2, 100)]
    bars = [(0, 1, 66), (1, 4, 70), (0, 4, 126), (2, 3, 66), (3, 4, 65), (2, 4, 123)]

    def gaps(x: np.ndarray) -> np.ndarray:
        z = x[0::2] + 1j * x[1::2]
        fixed = [abs(z[k] - foot) / length - 1 for k, foot, length in legs]
        return np.array(fixed + [abs(z[k] - z[n]) / length - 1 for k, n, length in bars])

    ways = lw.example("double-butterfly").configurations(at=60)
    assert ways.completeness is lw.Completeness.PROVED
    names = ("P1", "P2", "Q1", "Q2", "M")
    listed = np.array([[complex(*way.points[name]) for name in names] for way in ways])
    for places in listed:
        flat = np.column_stack([places.real, places.imag]).ravel()
        assert np.max(np.abs(gaps(flat))) < 1e-12
    rng = np.random.default_rng(8)
    found = set()
    for _ in range(60):
        start = rng.normal(0, 120, 10)
        end = root(gaps, start, method="hybr", tol=1e-13)
        z = end.x[0::2] + 1j * end.x[1::2]
        sides = [((z[1] - z[0]) / (z[4] - z[0])).imag, ((z[3] - z[2]) / (z[4] - z[2])).imag]
        if np.max(np.abs(gaps(end.x))) < 1e-11 and sides[0] < 0 < sides[1]:
            distance = np.max(np.abs(listed - z), axis=1)
            assert distance.min() < 1e-6
            found.add(int(distance.argmin()))
    assert len(found) >= 2


# ------------------------------------------------------------------ rapier drives


@law("rapier-drive", "rapier-drive-links", "rapier-drive-limited", "rapier-drive-limited-links")
@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("rapier-drive", (188.572556, 175.143712, 67.394934, 216.940343)),
        ("rapier-drive-links", (188.572556, 175.143712, 67.394934, 216.940343)),
        ("rapier-drive-limited", (191.349010, 180.211259, 65.174661, 275.864911)),
        ("rapier-drive-limited-links", (191.349010, 180.211259, 65.174661, 275.864911)),
    ],
)
def test_rapier_drive_keeps_its_lengths_and_its_printed_position(
    name: str, printed: tuple[float, float, float, float]
) -> None:
    """|AB| = 1225, E at its height, and the printed position at 60°.

    C and E are placed by the angles of rocker and lever.
    """
    motion = motion_of(name)
    full = "limited" not in name
    links = name.endswith("links")
    names = ("rod", "rocker", "lever", "s16") if links else ("θ13", "θ15", "θ14", "s16")
    found = motion.found
    crank, rocker, lever = (
        degrees(motion, column)[found]
        for column in ("crank" if links else "θ12", names[1], names[2])
    )
    c = complex(-623, -340) + 600 * np.exp(1j * rocker)
    b = c + 350 * np.exp(1j * lever)
    d = c + (-250 if full else 950) * np.exp(1j * lever)
    same(np.abs(b - 250 * np.exp(1j * crank)), 1225, 1225)
    same(d.imag, -520 if full else 520, 1225)
    same(d.real + 1100, (-1 if full else 1) * motion["s16"][found], 1225)
    position = lw.example(name).solve(at=60)
    assert position["s16"] == pytest.approx(printed[3], abs=5e-7)
    turns = [(position[column] - value) / 360 for column, value in zip(names, printed, strict=True)]
    assert np.abs(turns[:3] - np.round(turns[:3])) == pytest.approx(0, abs=5e-7 / 360)
