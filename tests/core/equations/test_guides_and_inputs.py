"""Sliders, slots, cylinders and inputs, checked with nothing but the resulting coordinates."""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt
import pytest

import linkwork as lw
from linkwork.core.mechanism.linkage import Linkage
from tests.core.equations.linkages import LINKAGES, five_bar
from tests.described import described_as

Array = npt.NDArray[np.float64]
Points = npt.NDArray[np.complex128]
# Lengths are a few units and conditions below a hundred; residuals are below 1e-14.
CLOSE = 1e-12


@cache
def solved(name: str) -> lw.Motion:
    motion = LINKAGES[name]().sweep()
    assert motion.found.sum() > 40
    return motion


def at(name: str, *points: str) -> list[Points]:
    motion = solved(name)
    return [motion.trace(p)[motion.found] for p in points]


def value(name: str, column: str) -> Array:
    motion = solved(name)
    return motion[column][motion.found]


def same(found: Array, wanted: float | Array) -> None:
    np.testing.assert_allclose(found, wanted, rtol=0, atol=CLOSE)


def same_angle(degrees: npt.NDArray[np.floating], direction: Points) -> None:
    wanted = direction / np.abs(direction)
    np.testing.assert_allclose(np.exp(1j * np.radians(degrees)), wanted, rtol=0, atol=CLOSE)


def placed(p: Points, s: Points, t: Points) -> tuple[Array, Array]:
    """How far along the line from s to t, and how far to its left, a point lies."""
    local = (p - s) * np.conj(t - s) / np.abs(t - s)
    return local.real, local.imag


SLIDERS = [
    ("slider of one point", 0.4, 30.0),
    ("slider of two points", 0.4, 0.0),
    # the sketch has Q ahead of B, so that from Q to B the block points backwards
    ("slider of two points backwards", 0.4, 0.0),
]


@pytest.mark.parametrize(("name", "offset", "angle"), SLIDERS)
def test_a_slider_keeps_its_offset_and_its_angle(name: str, offset: float, angle: float) -> None:
    a, b, q, s, t = at(name, "A", "B", "Q", "S", "T")
    guided = q if "backwards" in name else b
    along, beside = placed(guided, s, t)
    same(beside, offset)
    same(value(name, "s"), along)
    same_angle(np.full(len(b), angle), (q - b) * np.conj(t - s))
    same_angle(value(name, "block"), q - b)
    same(np.abs(a), 1.0)
    same(np.abs(b - a), 3.0)
    same(np.abs(q - b), 0.9)


def test_a_slider_without_an_angle_keeps_the_one_of_the_sketch() -> None:
    name = "slider of one point as sketched"
    b, q, s, t = at(name, "B", "Q", "S", "T")
    along, beside = placed(b, s, t)
    same(beside, -0.25)
    same(value(name, "s"), along)
    sketched = (0.8 + 0.5j) * (4.5 - 0.5j)
    same_angle(np.full(len(b), np.degrees(np.angle(sketched))), (q - b) * np.conj(t - s))


def test_both_points_of_a_slider_lie_beside_the_line() -> None:
    for name in ("slider of two points", "slider of two points backwards"):
        b, q, s, t = at(name, "B", "Q", "S", "T")
        same(placed(b, s, t)[1], 0.4)
        same(placed(q, s, t)[1], 0.4)


def test_a_slider_on_a_moving_link_turns_with_it() -> None:
    name = "slider on a moving link"
    a, r, c, q = at(name, "A", "R", "C", "Q")
    along, beside = placed(a, c, q)
    same(beside, -0.3)
    same(value(name, "s"), along)
    same_angle(np.full(len(a), 50.0), (r - a) * np.conj(q - c))
    same_angle(value(name, "lever"), q - c)
    same_angle(value(name, "block"), r - a)
    same_angle(value(name, "crank"), a)
    same(np.abs(q - c), 4.3)
    same(np.abs(r - a), 0.6)
    assert np.ptp(np.angle(q - c)) > 0.5  # the lever does swing


def test_a_pin_runs_along_a_slot_of_the_ground() -> None:
    name = "slot on ground"
    a, p, s, t = at(name, "A", "P", "S", "T")
    along, beside = placed(p, s, t)
    same(beside, 0.0)
    same(value(name, "s"), along)
    same(np.abs(p - a), 2.9)
    assert np.ptp(along) > 0.5


def test_a_pin_runs_along_a_slot_of_a_moving_link() -> None:
    name = "slot on a moving link"
    a, c, d, q = at(name, "A", "C", "D", "Q")
    along, beside = placed(a, d, q)
    same(beside, 0.0)
    same(value(name, "s"), along)
    same(np.abs(a), 1.0)
    same(np.abs(d - c), abs(-0.5 - 0.1j))
    same(np.abs(q - d), abs(2.5 - 0.2j))
    same_angle(value(name, "lever"), d - c)


def test_a_driven_cylinder_has_the_length_asked() -> None:
    name = "cylinder as input"
    m, n, h = at(name, "M", "N", "H")
    motion = solved(name)
    same(np.abs(n - m), motion["ram"][motion.found])
    same(motion.sliders["ram"].value[motion.found], motion["ram"][motion.found])
    same(np.abs(n), 2.2)
    same(np.abs(h), 4.7)
    same_angle(value(name, "boom"), n)
    same_angle(value(name, "ram_angle"), n - m)
    # the triangle O M N: law of cosines over the driven side
    base = abs(1.5 - 0.5j)
    cosine = (base**2 + 2.2**2 - motion["ram"][motion.found] ** 2) / (2 * base * 2.2)
    same(np.cos(np.angle(n) - np.angle(1.5 - 0.5j)), cosine)
    # motion beyond the range of a triangle is no position
    assert motion.found.all()


def test_a_cylinder_that_follows_measures_its_length_and_angle() -> None:
    name = "cylinder that follows"
    m, n = at(name, "M", "N")
    same(value(name, "ram"), np.abs(n - m))
    same_angle(value(name, "ram_angle"), n - m)
    same_angle(value(name, "boom"), n)
    same(value(name, "boom"), np.arange(151.0))


def test_a_driven_slider_stands_where_it_is_asked() -> None:
    name = "slider as input"
    a, b, s, t = at(name, "A", "B", "S", "T")
    along, beside = placed(b, s, t)
    same(along, value(name, "s"))
    same(beside, 0.0)
    same(np.abs(a), 1.0)
    same(np.abs(b - a), 3.0)


def test_a_link_is_driven_against_another_link() -> None:
    name = "link against link"
    a, b, c = at(name, "A", "B", "C")
    motion = solved(name)
    same_angle(motion["coupler-crank"][motion.found], (b - a) * np.conj(a))
    same(np.abs(a), 1.0)
    same(np.abs(b - a), 2.9)
    same(np.abs(b - c), 2.1)
    same_angle(value(name, "coupler"), b - a)
    same_angle(value(name, "crank"), a)


def test_a_joint_is_driven_by_the_angle_between_its_links() -> None:
    name = "joint as input"
    a, b, c = at(name, "A", "B", "C")
    motion = solved(name)
    coupler, rocker = b - a, b - c
    same_angle(motion["B"][motion.found], rocker * np.conj(coupler))
    same(np.abs(a), 1.0)


def test_a_joint_on_the_ground_drives_the_moving_link() -> None:
    mechanism = LINKAGES["pin of three links"]()
    links = dict(described_as(Linkage, mechanism).links)
    links["ground"] = links.pop("ground")  # named last: still the one that stands still
    driven = mechanism.changed(links=links, inputs=(lw.Input(joint="O"),)).sweep()
    (values,) = driven.inputs.values()
    assert driven.found.all()
    same_angle(values, driven.trace("A"))
    same(driven.links["crank"].first, 1.0)


def test_two_inputs_move_in_lock_step() -> None:
    motion = five_bar().sweep()
    assert motion.found.all()
    assert len(motion) == 101
    o, a, p, b, c = (motion.trace(q) for q in ("O", "A", "P", "B", "C"))
    same_angle(20.0 + np.arange(101), a - o)
    same_angle(160.0 - 0.5 * np.arange(101), b - c)
    same(np.abs(p - a), 2.5)
    same(np.abs(p - b), 2.2)
    # derivatives refer to the first input: the second one turns half as fast backwards
    step = np.radians(1.0)
    slope = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    wanted = np.convolve(motion.trace("P"), slope[::-1], mode="valid") / step
    x, y = motion.points["P"]
    found = (x.first + 1j * y.first)[4:-4]
    # eighth-order differences of one degree: truncation is near 1e-15, rounding 1e-14/step
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-10)
    same(motion.links["right"].first, -0.5)
    assert motion.speed == 2.0


def test_a_single_position_takes_every_input_by_name() -> None:
    position = five_bar().solve({"right": 120, "left": 90})
    a, p, b = (complex(*position.points[q]) for q in ("A", "P", "B"))
    assert a == pytest.approx(1j, abs=CLOSE)
    assert b == pytest.approx(2.5 + 0.75**0.5 * 1j, abs=CLOSE)
    assert abs(p - a) == pytest.approx(2.5, abs=CLOSE)
    assert abs(p - b) == pytest.approx(2.2, abs=CLOSE)


# ------------------------------------------------------------------ one mechanism, written twice


@pytest.mark.parametrize("kind", ["rapier-drive", "rapier-drive-limited"])
def test_rapier_drive_by_loops_and_by_links_have_equal_numbers(kind: str) -> None:
    loops, links = lw.example(kind).sweep(), lw.example(f"{kind}-links").sweep()
    assert loops.status == links.status
    found = loops.found
    assert (found & loops.asked).sum() == (361 if kind == "rapier-drive" else 309)
    assert loops.limit == links.limit
    assert loops.added.sum() == len(loops.limits) == (0 if kind == "rapier-drive" else 2)
    for point in ("A", "B", "C", "D", "E"):
        np.testing.assert_allclose(
            links.trace(point)[found], loops.trace(point)[found], rtol=0, atol=1e-9
        )  # mm, of 1225
    np.testing.assert_allclose(links["s16"][found], loops["s16"][found], rtol=0, atol=1e-9)
    regular = found & loops.asked  # there are no derivatives at dead points
    slope = np.abs(loops.series("s16").first[regular]).max()
    for one, other in (("s16", "s16"), ("rod", "θ13"), ("rocker", "θ15")):
        a, b = links.series(one), loops.series(other)
        atol = 1e-11 * slope
        np.testing.assert_allclose(a.first[regular], b.first[regular], rtol=0, atol=atol)
        atol = 1e-9 * np.abs(b.second[regular]).max()
        np.testing.assert_allclose(a.second[regular], b.second[regular], rtol=0, atol=atol)
        assert np.isnan(a.first[loops.added]).all()
        assert np.isnan(b.second[loops.added]).all()
    for mine, its in zip(loops.limits, links.limits, strict=True):
        assert mine.status == its.status
        assert mine.input == pytest.approx(its.input, rel=0, abs=1e-8)
