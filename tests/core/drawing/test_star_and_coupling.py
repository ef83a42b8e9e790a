"""A Geneva wheel is drawn as a star, an Oldham coupling with its discs."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.drawing import Disc, Polygon, Polyline, Role, Scene
from linkwork.core.drawing.links import couplings
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.errors import MechanismError
from tests.library_mechanisms import read_example


def outline(scene: Scene, of: str) -> ComplexArray:
    (wheel,) = scene.select(Polygon, Role.WHEEL, of)
    return np.array([complex(*corner) for corner in wheel.points])


def winding(corners: ComplexArray, point: complex) -> int:
    """How often an outline runs around a point."""
    angles = np.angle((np.roll(corners, -1) - point) / (corners - point))
    return round(float(angles.sum()) / math.tau)


@pytest.mark.parametrize("slots", [4, 6])
def test_a_geneva_wheel_is_a_star_with_its_number_of_slots(slots: int) -> None:
    drive = lw.example("geneva-drive").with_dimensions(n=slots)
    for at in (-30.0, 0.0, 20.0):
        position = drive.solve(at)
        scene = drive.scene(at)
        star = outline(scene, "wheel")
        centre, pin = (complex(*position.points[name]) for name in "CA")
        turned = centre + (star - centre) * cmath.exp(2j * math.pi / slots)
        assert np.abs(turned[:, None] - star).min(axis=1).max() < 1e-9 * 100
        assert np.abs(star - centre).max() == pytest.approx(100 * math.cos(math.pi / slots))
        assert winding(star, pin) == 0  # the pin is in a slot, not in the wheel
        assert winding(star, centre) == 1


def test_the_locking_disc_is_cut_out_where_the_wheel_turns() -> None:
    scene = lw.example("geneva-drive").scene(0.0)
    star, lock = outline(scene, "wheel"), outline(scene, "driver")
    assert not any(winding(lock, corner) for corner in star)
    assert winding(lock, 0j) == 1


def test_a_number_of_slots_is_a_whole_number() -> None:
    text = lw.example_text("geneva-drive").replace('count = "n"', "count = 2.5")
    with pytest.raises(MechanismError, match=r"must be a whole number from 3 to 60, it is 2\.5"):
        lw.loads(text)


def test_an_oldham_coupling_has_two_discs_and_a_cross_in_their_grooves() -> None:
    coupling = lw.example("oldham-coupling")
    for at in (0.0, 40.0, 205.0):
        scene, position = coupling.scene(at), coupling.solve(at)
        discs = {disc.of: disc for disc in scene.select(Disc, Role.WHEEL)}
        assert {name: disc.radius for name, disc in discs.items()} == pytest.approx(
            {"disc1": 40.0, "disc2": 40.0}
        )
        assert discs["disc1"].centre == position.points["O1"]
        assert discs["disc2"].centre == position.points["O2"]
        assert not scene.select(Polyline, Role.LINK)
        cross = scene.select(Polygon, Role.SLIDER, "cross")
        middles = [sum(complex(*p) for p in tongue.points) / 4 for tongue in cross]
        assert np.allclose(middles, complex(*position.points["M"]), atol=1e-9)
        one, other = (np.diff([complex(*p) for p in tongue.points[:2]])[0] for tongue in cross)
        assert abs((one / other).real) < 1e-9 * abs(one / other)


def test_discs_with_near_points_still_reach_the_middle_of_the_cross() -> None:
    text = lw.example_text("oldham-coupling")
    for far, near in (
        ("A  = [30.6418, 25.7115]", "A = [0.0306418, 0.0257115]"), ('"O1 A" = 40', '"O1 A" = 0.04'),
        ("B  = [-13.711504, 30.6418]", "B = [11.974288, 0.0306418]"),
        ('"O2 B" = 40', '"O2 B" = 0.04'),
    ):  # fmt: skip
        assert far in text
        text = text.replace(far, near)
    coupling = lw.loads(text)
    for at in (0.0, 40.0, 130.0):
        scene, middle = coupling.scene(at), complex(*coupling.solve(at).points["M"])
        for disc in scene.select(Disc, Role.WHEEL):
            assert abs(complex(*disc.centre) - middle) <= disc.radius * (1 + 1e-9)


def test_only_the_oldham_coupling_of_the_library_is_drawn_as_one() -> None:
    models = {
        name: read_example(name).model for name in lw.examples() if not name.startswith("newton-")
    }
    found = {name for name, model in models.items() if couplings(model.skeleton)}
    assert found == {"oldham-coupling"}


def test_a_link_with_a_pin_is_no_cross_of_a_coupling() -> None:
    skeleton = read_example("oldham-coupling").model.skeleton
    (coupling,) = couplings(skeleton)
    assert (coupling.cross, coupling.guides) == ("cross", {"s1", "s2"})
    assert couplings(replace(skeleton, pins=(*skeleton.pins, "N"))) == []
