"""Arms of plates: their outline, its fillets, and when a plate is filled instead."""

from __future__ import annotations

import itertools
from importlib import import_module
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.writers.plates.files import assembled
from linkwork.writers.plates.outlines import Arms, arms_between
from tests.library_mechanisms import read_example
from tests.writers.plate_checks import made, overlaps, simple, solid_error

shapely: Any = import_module("shapely")


def _polygon(arms: Arms) -> Any:
    return shapely.Polygon([(z.real, z.imag) for z in arms.outline.polygon()])


def test_a_lever_has_the_area_of_its_arms_and_fillet() -> None:
    radius, fillet = 5.0, 8.0
    lever = arms_between([40 + 0j, 0j, 30j], [], radius, fillet)
    assert lever is not None
    # two bars that share a square and a half disc, and what the fillet fills
    bars = 2.0 * radius * 70.0 + 1.25 * np.pi * radius**2 - radius**2
    wanted = bars + (1.0 - np.pi / 4.0) * fillet**2
    assert lever.outline.area == pytest.approx(wanted, rel=1e-14)
    # tangent everywhere: half the cut goes outside, also along the fillet
    grown = lever.outline.grown(0.5).area
    bars = 11.0 * 70.0 + (1.25 * np.pi - 1.0) * 5.5**2
    assert grown == pytest.approx(bars + (1.0 - np.pi / 4.0) * 7.5**2, rel=1e-14)


def test_outlines_are_bars_closed_by_a_disc_of_the_fillet() -> None:
    chance, several = np.random.default_rng(3), 0
    for _ in range(40):
        count, fillet = int(chance.integers(3, 7)), float(chance.uniform(0.5, 6.0))
        places = [complex(*z) for z in chance.uniform(0.0, 100.0, (count, 2))]
        arms = arms_between(places, [], 4.0, fillet)
        if arms is None:
            continue
        several += count > 3
        own = _polygon(arms)
        assert own.is_valid
        lines = [[(z.real, z.imag) for z in piece] for piece in arms.core if len(piece) == 2]
        tree = shapely.MultiLineString(lines)
        closed = tree.buffer(4.0 + fillet, 24).buffer(-fillet, 24)
        # chords of 96 and 256 sides a turn
        assert own.symmetric_difference(closed).area <= 2e-3 * own.area
        # what the proof of collisions assumes
        core = shapely.GeometryCollection([tree, *map(_triangle, arms.core[count - 1 :])])
        assert own.difference(core.buffer(4.0, 24)).area <= 1e-3 * own.area
    assert several >= 5


def _triangle(piece: Any) -> Any:
    return shapely.Polygon([(z.real, z.imag) for z in piece])


def test_arms_are_the_shortest_and_contain_slots() -> None:
    places = [0j, 50 + 0j, 20 + 30j]
    lengths = [abs(b - a) for a, b in itertools.combinations(places, 2)]

    def bars(slots: list[tuple[int, int]]) -> float:
        arms = arms_between(places, slots, 3.0, 3.0)
        assert arms is not None
        return sum(float(abs(piece[1] - piece[0])) for piece in arms.core if len(piece) == 2)

    assert bars([]) == pytest.approx(sum(lengths) - max(lengths), rel=1e-15)
    assert bars([(0, 1)]) == pytest.approx(sum(lengths) - sorted(lengths)[1], rel=1e-15)


@pytest.mark.parametrize(
    "places",
    [
        [0j, 25 + 0j, 12 + 22j],  # the fillet is longer than the arms
        [0j, 60 + 0j, 60 + 30j, 100 + 30j],  # two arms nearer than width and fillets
    ],
)
def test_plates_without_room_for_fillets_are_filled(places: list[complex]) -> None:
    assert arms_between(places, [], 5.0, 12.0) is None
    assert arms_between(places, [], 2.0, 1.0) is not None


def test_arms_in_line_have_no_corner_between_them() -> None:
    arms = arms_between([0j, 30 + 0j, 60 + 0j, 60 + 40j], [], 5.0, 5.0)
    assert arms is not None
    # the ends, the fillet and the outer corner, each an arc and a line
    assert len(arms.outline.corners) == 8
    assert np.count_nonzero(arms.outline.bulges < 0.0) == 1


def test_a_lever_of_the_library_has_arms_unless_the_fillet_is_large() -> None:
    mechanism = read_example("cognate-1")
    stack, motion = made(mechanism)
    filled, _ = made(mechanism, fillet=1000.0)
    areas = {plate.name: plate.area for plate in stack.plates}
    triangle = {plate.name: plate.area for plate in filled.plates}
    assert areas["coupler"] < 0.7 * triangle["coupler"]
    assert {name for name in areas if areas[name] != triangle[name]} == {"coupler"}
    assert stack.proved
    assert simple(stack)
    assert not overlaps(mechanism, stack, motion)
    assert max(solid_error(stack, item) for item in assembled(stack)) <= 1e-3


def test_a_cut_wider_than_inner_corners_is_refused() -> None:
    with pytest.raises(lw.InputError, match="a cut of 1 mm is too wide for inner corners with a"):
        made(read_example("cognate-1"), kerf=1.0, fillet=0.5)


def test_a_hole_within_a_slot_leaves_no_room_for_arms() -> None:
    places = [0j, 100 + 0j, 40 + 0j, -50j]
    assert arms_between(places, [(0, 1)], 5.0, 5.0) is None
