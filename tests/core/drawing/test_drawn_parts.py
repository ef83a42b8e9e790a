"""The geometry of symbols: every one stands where its points are."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from linkwork.core.drawing import (
    Arc,
    Disc,
    Hatch,
    Polygon,
    Polyline,
    Role,
    SceneOptions,
    reach_of,
    scene_of,
)
from linkwork.core.drawing.links import convex_outline, uncovered
from linkwork.core.drawing.paths import drawn_once, thinned
from linkwork.core.foundation.statuses import Status
from linkwork.core.mechanism.part.springs import SpringFigure
from linkwork.core.results.position import Position
from tests.core.drawing.conftest import Places, Sample

MECHANISMS = [
    "four_bar", "slider_crank", "inverted_slider_crank", "collar", "six_link", "boom", "jansen",
    "flat", "tall", "ternary",
]  # fmt: skip
AT = {"boom": 95.0}

# Coordinates are copied or moved by sums of a few terms: rounding of the largest one, no more.
ROUNDING = 1e-12


def z(point: tuple[float, float]) -> complex:
    return complex(*point)


def close(a: complex, b: complex, size: float) -> bool:
    return abs(a - b) <= ROUNDING * size


@pytest.fixture(params=MECHANISMS)
def sample(request: pytest.FixtureRequest) -> tuple[Sample, Position]:
    found = request.getfixturevalue(request.param)
    return found, found.position(AT.get(request.param, 50.0))


def test_every_pin_is_a_circle_exactly_at_its_point(sample: tuple[Sample, Position]) -> None:
    mechanism, position = sample
    scene = scene_of(position, mechanism.motion())
    pins = {disc.of: disc for disc in scene.select(Disc, Role.PIN)}
    struts = {p for strut in mechanism.skeleton.struts for p in strut.between}
    assert set(pins) == set(mechanism.skeleton.pins) | struts
    for name, disc in pins.items():
        assert disc.centre == position.points[name]
        assert disc.radius == scene.measures.pin


def test_points_that_join_nothing_are_smaller_dots(four_bar: Sample) -> None:
    scene = scene_of(four_bar.position(50), four_bar.motion())
    [dot] = scene.select(Disc, Role.TRACED)
    assert dot.of == "P"
    assert dot.centre == four_bar.position(50).points["P"]
    assert dot.radius < scene.measures.pin


def test_nothing_is_drawn_at_points_that_only_tell_a_fixed_line(slider_crank: Sample) -> None:
    scene = scene_of(slider_crank.position(50), slider_crank.motion())
    assert not {p.of for p in scene.primitives} & {"S", "T"}


def test_every_binary_link_is_a_bar_between_its_points(four_bar: Sample) -> None:
    position = four_bar.position(50)
    scene = scene_of(position)
    for link, ends in (("crank", "O2 A"), ("rocker", "O4 B")):
        [bar] = scene.select(Polyline, Role.LINK, of=link)
        assert set(bar.points) == {position.points[name] for name in ends.split()}


def test_links_have_tones_of_their_own_and_the_driven_one_is_tone_zero(jansen: Sample) -> None:
    scene = scene_of(jansen.position(50))
    tones = {p.of: p.tone for p in scene.primitives if p.role in (Role.LINK, Role.PLATE)}
    assert tones["crank"] == 0
    assert sorted(tones.values()) == list(range(13))


def test_a_ternary_link_is_a_polygon_through_its_points(four_bar: Sample) -> None:
    position = four_bar.position(50)
    [plate] = scene_of(position).select(Polygon, Role.PLATE)
    assert plate.of == "coupler"
    assert set(plate.points) == {position.points[name] for name in "ABP"}


def test_a_plate_encloses_all_points_of_its_link_whatever_their_order(boom: Sample) -> None:
    shuffled = replace(boom.skeleton.bars[0], points=("O", "E", "L", "G"))
    skeleton = replace(boom.skeleton, bars=(shuffled,))
    position = replace(boom.position(95), skeleton=skeleton)
    [plate] = scene_of(position).select(Polygon, Role.PLATE)
    corners = [z(p) for p in plate.points]
    for name in shuffled.points:
        point = z(position.points[name])
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            assert ((b - a).conjugate() * (point - a)).imag >= -1e-9


def test_convex_outlines_run_counter_clockwise_and_leave_inner_points_out() -> None:
    square = [0j, 2 + 0j, 2 + 2j, 2j]
    outline = convex_outline([2j, 1 + 1j, 2 + 2j, 0j, 1 + 0j, 2 + 0j])
    assert outline == square


def test_upright_collinear_points_reach_from_end_to_end_in_spite_of_rounding() -> None:
    assert set(convex_outline([0j, -1e-14 + 100j, 1e-15 + 50j])) == {0j, -1e-14 + 100j}


def test_three_collinear_points_are_a_bar_from_the_first_to_the_last(six_link: Sample) -> None:
    position = six_link.position(60)
    scene = scene_of(position, six_link.motion())
    assert not scene.select(Polygon, Role.PLATE)
    [bar] = scene.select(Polyline, Role.LINK, of="rocker")
    assert set(bar.points) == {position.points["C0"], position.points["D"]}


def test_every_ground_pivot_is_a_triangle_with_hatching_below_it(
    sample: tuple[Sample, Position],
) -> None:
    mechanism, position = sample
    scene = scene_of(position, mechanism.motion())
    carried = {p for bar in mechanism.skeleton.bars for p in bar.points}
    carried |= {p for strut in mechanism.skeleton.struts for p in strut.between}
    standing = carried & set(mechanism.skeleton.fixed)
    assert {p.of for p in scene.select(Polygon, Role.GROUND)} == standing
    for name in standing:
        [triangle] = scene.select(Polygon, Role.GROUND, of=name)
        [floor] = scene.select(Polyline, Role.GROUND, of=name)
        [hatch] = scene.select(Hatch, of=name)
        place = position.points[name]
        assert triangle.points[0] == place
        assert max(y for _, y in triangle.points[1:]) < place[1] - scene.measures.pin
        level = floor.points[0][1]
        left, right = sorted(x for x, _ in floor.points)
        for start, end in hatch.strokes:
            assert start[1] == pytest.approx(level, abs=ROUNDING * scene.measures.size)
            assert end[1] < level
            slack = ROUNDING * scene.measures.size
            assert left - slack <= min(start[0], end[0])
            assert max(start[0], end[0]) <= right + slack


@pytest.mark.parametrize("degrees", [0, 30, 75, 110, -40, -140, 180])
def test_a_block_is_turned_with_its_line_and_centred_on_its_point(
    slope: Callable[[float], Sample], degrees: float
) -> None:
    mechanism = slope(degrees)
    position = mechanism.position(120)
    scene = scene_of(position, mechanism.motion())
    [block] = scene.select(Polygon, Role.SLIDER)
    corners = [z(p) for p in block.points]
    along = cmath.exp(1j * math.radians(degrees))
    assert close(sum(corners) / 4, z(position.points["B"]), scene.measures.size)
    side = (corners[1] - corners[0]) / along
    assert abs(side.imag) < 1e-9 * abs(side)
    assert abs(side) > abs(corners[2] - corners[1])


@pytest.mark.parametrize("degrees", [0, 30, 75, 110, -40, -140, 180])
def test_a_rail_touches_the_block_is_parallel_to_the_line_and_hatched_behind(
    slope: Callable[[float], Sample], degrees: float
) -> None:
    mechanism = slope(degrees)
    scene = scene_of(mechanism.position(120), mechanism.motion())
    [rail] = scene.select(Polyline, Role.GROUND, of="s")
    [hatch] = scene.select(Hatch, of="s")
    [block] = scene.select(Polygon, Role.SLIDER)
    start, end = (z(p) for p in rail.points)
    along = (end - start) / abs(end - start)
    heights = [((z(p) - start) / along).imag for p in block.points]
    block_side = sum(heights)
    touching = [h for h in heights if abs(h) < 1e-9 * scene.measures.size]
    assert len(touching) == 2
    for foot, tip in hatch.strokes:
        assert abs(((z(foot) - start) / along).imag) < 1e-9 * scene.measures.size
        assert ((z(tip) - start) / along).imag * block_side < 0


def test_a_rail_is_as_long_as_the_travel_of_the_block(slider_crank: Sample) -> None:
    motion = slider_crank.motion()
    scene = scene_of(slider_crank.position(50), motion)
    [rail] = scene.select(Polyline, Role.GROUND, of="s")
    [block] = scene.select(Polygon, Role.SLIDER)
    half = (max(x for x, _ in block.points) - min(x for x, _ in block.points)) / 2
    left, right = sorted(x for x, _ in rail.points)
    travel = motion["B.x"]
    assert left < travel.min() - half
    assert right > travel.max() + half
    assert right - left < np.ptp(travel) + 5 * half


def test_rails_lie_below_unless_links_always_come_from_below(
    slider_crank: Sample, six_link: Sample
) -> None:
    scene = scene_of(slider_crank.position(50), slider_crank.motion())
    [rail] = scene.select(Polyline, Role.GROUND, of="s")
    assert rail.points[0][1] < 20
    scene = scene_of(six_link.position(60), six_link.motion())
    [rail] = scene.select(Polyline, Role.GROUND, of="s16")
    assert rail.points[0][1] > 420


def test_a_sliding_bar_with_two_guided_points_has_one_block_at_its_pin(six_link: Sample) -> None:
    position = six_link.position(60)
    scene = scene_of(position, six_link.motion())
    [block] = scene.select(Polygon, Role.SLIDER)
    middle = sum(map(z, block.points)) / 4
    assert close(middle, z(position.points["E"]), scene.measures.size)


def test_a_sliding_bar_without_pins_has_one_block_at_its_first_point(six_link: Sample) -> None:
    skeleton = replace(six_link.skeleton, pins=("A0", "A", "B", "C0", "D"))
    position = replace(six_link.position(60), skeleton=skeleton)
    [block] = scene_of(position).select(Polygon, Role.SLIDER)
    middle = sum(map(z, block.points)) / 4
    assert close(middle, z(position.points["E"]), 1000)


def test_a_slot_runs_along_its_link_and_holds_the_pin_in_every_position(
    inverted_slider_crank: Sample,
) -> None:
    motion = inverted_slider_crank.motion()
    for value in (0, 50, 180, 270):
        position = inverted_slider_crank.position(value)
        scene = scene_of(position, motion)
        [slot] = scene.select(Polygon, Role.SLOT)
        along = z(position.points["Q"])
        along /= abs(along)
        turned = [z(p) / along for p in slot.points]
        pin = scene.measures.pin
        assert max(w.imag for w in turned) == pytest.approx(-min(w.imag for w in turned))
        assert max(w.imag for w in turned) > pin
        # Pin A is between 55 and 145 from O4; the slot ends round it, and not far away.
        assert 55 - 6 * pin < min(w.real for w in turned) < 55 - pin
        assert 145 + pin < max(w.real for w in turned) < 145 + 6 * pin


def test_a_slot_without_a_motion_still_holds_the_pin(inverted_slider_crank: Sample) -> None:
    position = inverted_slider_crank.position(50)
    scene = scene_of(position)
    [slot] = scene.select(Polygon, Role.SLOT)
    along = z(position.points["Q"]) / abs(z(position.points["Q"]))
    places = [(z(p) / along).real for p in slot.points]
    pin = (z(position.points["A"]) / along).real
    assert min(places) < pin - scene.measures.pin
    assert pin + scene.measures.pin < max(places)
    assert min(places) > 0
    assert max(places) < 175


def test_the_bar_of_a_slotted_link_stops_at_its_slot(inverted_slider_crank: Sample) -> None:
    position = inverted_slider_crank.position(50)
    scene = scene_of(position, inverted_slider_crank.motion())
    lever = scene.select(Polyline, Role.LINK, of="lever")
    [slot] = scene.select(Polygon, Role.SLOT)
    ends = {abs(z(p)) for bar in lever for p in bar.points}
    reach = [abs(z(p)) for p in slot.points]
    assert len(lever) == 2
    assert min(ends) == 0
    assert max(ends) == pytest.approx(175)
    assert sorted(ends)[1] == pytest.approx(min(reach), rel=0.01)
    assert sorted(ends)[2] == pytest.approx(max(reach), rel=0.01)


def test_a_slot_in_the_ground_is_hatched_and_no_link(slider_crank: Sample) -> None:
    guide = replace(slider_crank.skeleton.guides[0], block=False)
    skeleton = replace(slider_crank.skeleton, guides=(guide,))
    slotted = replace(slider_crank, skeleton=skeleton)
    scene = scene_of(slotted.position(50), slotted.motion())
    assert not scene.select(Polygon, Role.SLOT)
    [outline] = scene.select(Polyline, Role.GROUND, of="s")
    ys = [y for _, y in outline.points]
    assert (max(ys) + min(ys)) / 2 == pytest.approx(20)
    [hatch] = scene.select(Hatch, of="s")
    assert max(y for _, y in hatch.outline) <= min(ys) + 1e-9


def test_a_collar_rides_on_a_rod_that_reaches_from_its_link_over_the_travel(collar: Sample) -> None:
    position = collar.position(50)
    scene = scene_of(position, collar.motion())
    [block] = scene.select(Polygon, Role.SLIDER)
    middle = sum(map(z, block.points)) / 4
    assert close(middle, z(position.points["A"]), scene.measures.size)
    along = z(position.points["Q"]) / abs(z(position.points["Q"]))
    rod = [z(p) / along for bar in scene.select(Polyline, Role.LINK, of="rod") for p in bar.points]
    assert max(abs(w.imag) for w in rod) < 1e-9
    assert min(w.real for w in rod) == pytest.approx(0, abs=1e-9)
    assert max(w.real for w in rod) > 125
    half = scene.measures.block[0]
    at = abs(z(position.points["A"]))
    for start, end in zip(rod[::2], rod[1::2], strict=True):
        low, high = sorted((start.real, end.real))
        assert high < at - 0.99 * half or low > at + 0.99 * half


def test_an_offset_collar_hangs_on_an_arm(collar: Sample) -> None:
    def at(value: float) -> Places:
        places = collar.at(value)
        assert places is not None
        along = places["Q"] / abs(places["Q"])
        return {**places, "A": places["A"] + 12j * along}

    guide = replace(collar.skeleton.guides[0], offset=12)
    moved = replace(collar, at=at, skeleton=replace(collar.skeleton, guides=(guide,)))
    scene = scene_of(moved.position(50), moved.motion())
    along = z(moved.position(50).points["Q"])
    along /= abs(along)
    arms = [
        [z(p) / along for p in bar.points]
        for bar in scene.select(Polyline, Role.LINK, of="rod")
        if abs((z(bar.points[1]) - z(bar.points[0])) / along - 12j) < 1e-9
    ]
    assert len(arms) == 1


def test_hidden_pieces_of_a_bar_are_left_out() -> None:
    gaps = [(5 + 0j, 1 + 0j), (5 + 3j, 1 + 0j), (2 + 0j, 1j), (9 + 0j, 2 + 0j)]
    assert list(uncovered(0j, 10 + 0j, gaps)) == [(0j, 4 + 0j), (6 + 0j, 7 + 0j)]


def test_a_cylinder_has_its_barrel_on_the_line_and_a_rod_to_the_second_point(boom: Sample) -> None:
    for value in (70, 95, 120):
        position = boom.position(value)
        scene = scene_of(position, boom.motion())
        [barrel] = scene.select(Polygon, Role.CYLINDER)
        base, tip = (z(position.points[name]) for name in "KL")
        along = (tip - base) / abs(tip - base)
        corners = [(z(p) - base) / along for p in barrel.points]
        sides = [w.imag / scene.measures.barrel for w in corners]
        assert sides == pytest.approx([-1, -1, 1, 1])
        assert corners[0].real == pytest.approx(corners[3].real)
        assert corners[1].real == pytest.approx(corners[2].real)
        assert 0 < min(w.real for w in corners) < max(w.real for w in corners) < 70
        lines = scene.select(Polyline, Role.LINK, of="ram")
        [rod] = [line for line in lines if abs(z(line.points[1]) - tip) < 1e-9]
        piston = ((z(rod.points[0]) - base) / along).real
        assert min(w.real for w in corners) < piston < max(w.real for w in corners)


@pytest.mark.parametrize("values", [(70, 110, 150), (90, 95, 100)])
def test_a_barrel_keeps_its_length_and_is_shorter_than_the_cylinder_ever_is(
    boom: Sample, values: tuple[int, ...]
) -> None:
    motion = replace(boom, inputs=values).motion()
    within = reach_of(motion)
    lengths = []
    for value in values:
        scene = scene_of(boom.position(value), motion, options=SceneOptions(within=within))
        [barrel] = scene.select(Polygon, Role.CYLINDER)
        lengths.append(abs(z(barrel.points[1]) - z(barrel.points[0])))
    assert lengths == pytest.approx([lengths[0]] * 3, rel=1e-12)
    assert 0.3 * values[0] < lengths[0] < 0.9 * values[0]


def test_the_input_arrow_turns_counter_clockwise_around_the_pivot_beside_the_links(
    four_bar: Sample,
) -> None:
    for value in range(0, 360, 15):
        position = four_bar.position(value)
        [arrow] = scene_of(position).select(Arc, Role.INPUT)
        assert arrow.centre == position.points["O2"]
        assert arrow.sweep > 0
        crank = cmath.phase(z(position.points["A"]))
        assert (crank - arrow.start) % math.tau > arrow.sweep


def test_a_negative_speed_turns_the_arrow_round(four_bar: Sample) -> None:
    backwards = replace(four_bar, speed=-25.0)
    [arrow] = scene_of(backwards.position(50), backwards.motion()).select(Arc, Role.INPUT)
    assert arrow.sweep < 0


@pytest.mark.parametrize("degrees", [0, 30, 110, -140])
def test_a_driven_slider_has_a_straight_arrow_along_its_line_off_the_block(
    slope: Callable[[float], Sample], degrees: float
) -> None:
    mechanism = slope(degrees)
    scene = scene_of(mechanism.position(120), mechanism.motion())
    [arrow] = scene.select(Polyline, Role.INPUT)
    [block] = scene.select(Polygon, Role.SLIDER)
    [rail] = scene.select(Polyline, Role.GROUND, of="s")
    along = cmath.exp(1j * math.radians(degrees))
    vector = (z(arrow.points[1]) - z(arrow.points[0])) / along
    assert vector.real > 0
    assert abs(vector.imag) < 1e-9 * vector.real
    beyond = [((z(p) - z(arrow.points[0])) / along).imag for p in (*block.points, *rail.points)]
    assert min(map(abs, beyond)) > scene.measures.pin
    assert len({b > 0 for b in beyond}) == 1
    # The block lies between the arrow and the rail.
    assert max(map(abs, beyond[4:])) == pytest.approx(max(map(abs, beyond[:4])))
    assert min(map(abs, beyond[:4])) < min(map(abs, beyond[4:]))


def test_a_driven_cylinder_has_a_straight_arrow_beside_it(boom: Sample) -> None:
    position = boom.position(95)
    [arrow] = scene_of(position).select(Polyline, Role.INPUT)
    along = z(position.points["L"]) - z(position.points["K"])
    vector = (z(arrow.points[1]) - z(arrow.points[0])) / along
    assert vector.real > 0
    assert abs(vector.imag) < 1e-9
    assert len(arrow.arrow_head) == 3


def test_arrows_can_be_left_out(four_bar: Sample) -> None:
    scene = scene_of(four_bar.position(50), options=SceneOptions(arrows=False))
    assert not scene.select(Arc, Role.INPUT)


def test_a_trace_passes_through_all_positions_of_its_point(four_bar: Sample) -> None:
    motion = four_bar.motion()
    [trace] = scene_of(four_bar.position(51), motion).select(Polyline, Role.TRACE)
    assert trace.of == "P"
    assert trace.points == tuple(zip(motion["P.x"], motion["P.y"], strict=True))
    assert four_bar.position(51).points["P"] in trace.points


def test_a_trace_is_broken_where_there_is_no_position(rocking_four_bar: Sample) -> None:
    motion = rocking_four_bar.motion()
    traces = scene_of(rocking_four_bar.position(20), motion).select(Polyline, Role.TRACE)
    assert len(traces) == 2
    assert all(math.isfinite(c) for trace in traces for p in trace.points for c in p)
    found = {p for p in zip(motion["P.x"], motion["P.y"], strict=True) if math.isfinite(p[0])}
    assert {p for trace in traces for p in trace.points} == found


def test_a_row_that_failed_is_not_traced_even_if_it_holds_numbers(four_bar: Sample) -> None:
    motion = four_bar.motion()
    status = tuple(Status.LOST if k == 60 else s for k, s in enumerate(motion.status))
    traces = scene_of(four_bar.position(50), replace(motion, status=status)).select(
        Polyline, Role.TRACE
    )
    assert [len(trace.points) for trace in traces] == [60, 60]


def test_runs_of_a_path_keep_lone_points_and_drop_nan() -> None:
    nan = complex(math.nan, math.nan)
    runs = drawn_once(np.array([nan, 1j, 2j, nan, nan, 5j, nan]), 0.05)
    assert [list(run) for run in runs] == [[1j, 2j], [5j]]
    assert drawn_once(np.array([nan, nan]), 0.05) == []


def test_a_path_that_runs_back_over_itself_is_drawn_once() -> None:
    out = np.linspace(0, 10, 41) + 0j
    there_and_back = np.concatenate((out, out[-2::-1]))
    runs = drawn_once(there_and_back, 0.05)
    length = sum(float(np.abs(np.diff(run)).sum()) for run in runs)
    assert 10 <= length < 10.6
    loop = np.exp(1j * np.linspace(0, 2 * math.pi, 61))
    [whole] = drawn_once(loop, 0.005)
    assert len(whole) == 61


def test_a_stretch_beyond_a_gap_is_not_drawn_over_the_one_before_it() -> None:
    out = np.linspace(0, 10, 41) + 0j
    nan = complex(math.nan, math.nan)
    lone = np.array([nan, 4 + 0j, nan, 4 + 3j])
    runs = drawn_once(np.concatenate((out, [nan], out[::-1], lone)), 0.05)
    assert [len(run) for run in runs] == [41, 1]
    assert runs[1][0] == 4 + 3j


def test_a_path_of_tiny_steps_is_thinned_and_one_of_large_steps_is_not() -> None:
    fine = np.exp(1j * np.linspace(0, 2, 100_001))
    few = thinned(fine, 0.01)
    assert 190 < len(few) < 210
    assert (few[0], few[-1]) == (fine[0], fine[-1])
    assert np.abs(np.diff(few)).max() < 0.0101
    nan = complex(math.nan, math.nan)
    gaps = np.array([0j, 1e-4, 2e-4, nan, 2e-4, 3e-4, nan, 1, 2, 3])
    np.testing.assert_array_equal(
        thinned(gaps, 0.01), np.array([0j, 2e-4, nan, 2e-4, 3e-4, nan, 1, 2, 3])
    )


def test_pictures_of_one_motion_share_their_sizes(four_bar: Sample) -> None:
    motion = four_bar.motion()
    options = SceneOptions(within=reach_of(motion))
    scenes = [scene_of(four_bar.position(u), motion, options=options) for u in (0, 90, 200)]
    assert len({scene.measures for scene in scenes}) == 1


def test_what_lies_on_top_comes_later(ternary: Sample) -> None:
    layers = [p.role.layer for p in scene_of(ternary.position(50), ternary.motion()).primitives]
    assert layers == sorted(layers)
    assert Role.PLATE.layer < Role.LINK.layer < Role.PIN.layer < Role.LABEL.layer
    assert Role.HATCH.layer < Role.LINK.layer
    assert Role.CYLINDER.layer < Role.LINK.layer


def test_the_box_holds_every_primitive(sample: tuple[Sample, Position]) -> None:
    mechanism, position = sample
    scene = scene_of(position, mechanism.motion())
    for primitive in scene.primitives:
        for x, y in primitive.outline:
            assert scene.box.left <= x <= scene.box.right
            assert scene.box.bottom <= y <= scene.box.top


def test_a_scaled_mechanism_has_the_same_picture_scaled(ternary: Sample) -> None:
    def larger(value: float) -> Places:
        places = ternary.at(value)
        assert places is not None
        return {n: 1000 * p for n, p in places.items()}

    big = replace(ternary, at=larger)
    one, other = scene_of(ternary.position(50)), scene_of(big.position(50))
    assert len(one.primitives) == len(other.primitives)
    assert other.measures.stroke == pytest.approx(1000 * one.measures.stroke)
    for p, q in zip(one.primitives, other.primitives, strict=True):
        np.testing.assert_allclose(1000 * np.array(p.outline), q.outline, rtol=1e-9, atol=1e-6)


def test_a_spring_is_a_zigzag_from_point_to_point(four_bar: Sample) -> None:
    spring = SpringFigure(name="return", between=("O4", "A"))
    skeleton = replace(four_bar.skeleton, figures=(spring,))
    lengths = []
    for angle in (20.0, 200.0):
        position = replace(four_bar.position(angle), skeleton=skeleton)
        scene = scene_of(position)
        (drawn,) = scene.select(Polyline, Role.SPRING)
        start, end = (z(position.points[name]) for name in spring.between)
        assert drawn.of == "return"
        assert z(drawn.points[0]) == start
        assert close(z(drawn.points[-1]), end, abs(end - start))
        along = (end - start) / abs(end - start)
        beside = [((z(p) - start) / along).imag for p in drawn.points[2:-2]]
        assert [b > 0 for b in beside] == [k % 2 == 0 for k in range(9)]
        assert max(map(abs, beside)) == pytest.approx(2.6 * scene.measures.pin)
        lengths.append(abs(end - start))
    assert abs(lengths[0] - lengths[1]) > 10  # it follows the motion
