"""A motion in one picture: faint positions along it, its limits marked."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

import linkwork as lw
from linkwork.core.drawing import (
    LIGHT,
    Disc,
    Polygon,
    Polyline,
    Role,
    Scene,
    SceneOptions,
    Text,
    figure,
    render,
    scene_of,
)
from linkwork.core.drawing.paths import driven_point, further_positions
from linkwork.core.drawing.pose import Pose, lines_within, reached_caption
from linkwork.core.drawing.scene import Primitive, text_width
from linkwork.core.foundation.statuses import Status
from linkwork.core.mechanism.skeleton import DrivenPart
from linkwork.core.results.failure import LimitKind
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from tests.core.drawing.conftest import Sample
from tests.core.drawing.mechanisms import five_bar_of
from tests.core.drawing.pages import svg_texts
from tests.core.drawing.shared_area import shared_area

MECHANISMS = [
    "four_bar", "slider_crank", "inverted_slider_crank", "collar", "six_link", "boom", "jansen",
    "flat", "tall", "ternary",
]  # fmt: skip
SEVEN = SceneOptions(further=7)


def z(point: tuple[float, float]) -> complex:
    return complex(*point)


def with_limits(motion: Motion, **kinds: str) -> Motion:
    """The motion with limits at rows, given as ``row12="dead point"``."""
    rows = {int(name.removeprefix("row")): kind for name, kind in kinds.items()}
    return replace(motion, limit=tuple(rows.get(k, "") for k in range(len(motion))))


def faint(scene: Scene) -> list[Primitive]:
    return [p for p in scene.primitives if p.fade]


@pytest.fixture(params=MECHANISMS)
def sample(request: pytest.FixtureRequest) -> tuple[Sample, Position]:
    found = request.getfixturevalue(request.param)
    return found, found.position(95.0 if request.param == "boom" else 51.0)


# ------------------------------------------------------------------ which positions


def test_further_positions_are_rows_of_the_motion_as_they_are(
    sample: tuple[Sample, Position],
) -> None:
    mechanism, position = sample
    motion = mechanism.motion()
    shown = further_positions(Pose.of(position, motion), motion, 7)
    assert len(shown) == 7
    for further in shown:
        assert motion.found[further.row]
        assert further.limit is None
        for name, place in further.pose.points.items():
            assert place == motion.trace(name)[further.row]


def test_seven_more_positions_of_a_crank_are_an_eighth_of_a_turn_apart(
    slider_crank: Sample,
) -> None:
    motion = slider_crank.motion()
    shown = further_positions(Pose.of(slider_crank.position(60), motion), motion, 7)
    turned = sorted((motion["crank"][[further.row for further in shown]] - 60) % 360)
    assert np.diff([0, *turned, 360]) == pytest.approx([45] * 8, abs=3)  # a row is 3 degrees


def test_no_position_hides_behind_another(sample: tuple[Sample, Position]) -> None:
    mechanism, position = sample
    motion = mechanism.motion()
    shown = further_positions(Pose.of(position, motion), motion, 7)
    places = [np.array(list(further.pose.points.values())) for further in shown]
    places.append(np.array([z(position.points[name]) for name in shown[0].pose.points]))
    paths = np.stack([motion.trace(name)[motion.found] for name in motion.points], axis=1)
    gaps = [np.abs(one - other).max() for one, other in combinations(places, 2)]
    # whatever eight positions are chosen, some position of the motion is this far from them all
    nearest = np.min([np.abs(paths - place).max(axis=1) for place in places], axis=0)
    assert min(gaps) >= nearest.max()


def test_several_turns_show_no_position_twice(four_bar: Sample) -> None:
    turns = replace(four_bar, inputs=tuple(range(0, 1081, 3)))
    motion = turns.motion()
    shown = further_positions(Pose.of(turns.position(0), motion), motion, 7)
    assert len({round(motion["crank"][further.row] % 360) for further in shown} | {0}) == 8


def test_fewer_positions_than_asked_are_all_there_is(four_bar: Sample) -> None:
    three = replace(four_bar, inputs=(0, 120, 240, 360)).motion()
    shown = further_positions(Pose.of(four_bar.position(0), three), three, 7)
    assert sorted(three["crank"][[further.row for further in shown]]) == [120, 240]


def test_rows_that_were_not_found_are_not_shown(rocking_four_bar: Sample) -> None:
    motion = rocking_four_bar.motion()
    assert not motion.found.all()
    shown = further_positions(Pose.of(rocking_four_bar.position(21), motion), motion, 7)
    assert all(motion.found[further.row] for further in shown)
    nothing = replace(motion, status=(Status.LOST,) * len(motion))
    assert further_positions(Pose.of(rocking_four_bar.position(21), nothing), nothing, 7) == []


def test_every_limit_is_shown_besides_and_once(four_bar: Sample) -> None:
    motion = with_limits(
        four_bar.motion(), row0="dead point", row40="change point", row120="dead point",
        row60="maximum of B.x",
    )  # fmt: skip
    shown = further_positions(Pose.of(four_bar.position(51), motion), motion, 7)
    limits = [(further.row, further.limit) for further in shown if further.limit is not None]
    # row 120 is row 0 a turn later; an extreme is no limit
    assert limits == [
        (0, LimitKind.DEAD_POINT),
        (40, LimitKind.CHANGE_POINT),
    ]
    assert len(shown) == 9


# ------------------------------------------------------------------ what is drawn


def test_the_position_itself_is_drawn_as_without_the_motion_behind_it(
    sample: tuple[Sample, Position],
) -> None:
    mechanism, position = sample
    motion = mechanism.motion()
    scene = scene_of(position, motion, labels=False, options=replace(SEVEN, arrows=False))
    alone = scene_of(
        position, motion, labels=False, options=SceneOptions(arrows=False, within=scene.within)
    )
    assert [p for p in scene.primitives if not p.fade] == list(alone.primitives)
    assert len(faint(scene)) > 7


def test_faint_parts_lie_below_everything_else_and_inside_the_picture(
    sample: tuple[Sample, Position],
) -> None:
    mechanism, position = sample
    scene = scene_of(position, mechanism.motion(), options=SEVEN)
    fades = [p.fade > 0 for p in scene.primitives]
    assert fades == sorted(fades, reverse=True)
    assert max(p.layer for p in scene.primitives if p.fade) < min(
        p.layer for p in scene.primitives if not p.fade
    )
    for primitive in faint(scene):
        for x, y in primitive.outline:
            assert scene.box.left <= x <= scene.box.right
            assert scene.box.bottom <= y <= scene.box.top
    # symbols are measured by all that is shown, not by the start alone
    for disc in scene.select(Disc, Role.PIN):
        assert scene.within.distance(disc.centre) == 0


def test_what_stands_still_is_drawn_once(sample: tuple[Sample, Position]) -> None:
    mechanism, position = sample
    parts = faint(scene_of(position, mechanism.motion(), options=SEVEN))
    assert not {p.role for p in parts} & {Role.GROUND, Role.HATCH, Role.TRACE, Role.LABEL}
    pins = [p for p in parts if p.role is Role.PIN]
    assert not {p.of for p in pins} & set(mechanism.skeleton.fixed)
    moving = set(mechanism.skeleton.pins) - set(mechanism.skeleton.fixed)
    moving |= {p for strut in mechanism.skeleton.struts for p in strut.between}
    moving -= set(mechanism.skeleton.fixed)
    assert {p.of: [q.of for q in pins].count(p.of) for p in pins} == dict.fromkeys(moving, 7)


def test_faint_colours_are_pale_and_hide_what_is_below_them(four_bar: Sample) -> None:
    scene = scene_of(four_bar.position(51), four_bar.motion(), options=SEVEN)
    for part in faint(scene):
        strong = replace(part, fade=0.0)
        for colour in (LIGHT.line, LIGHT.fill):
            pale, full = colour(part), colour(strong)
            assert bool(pale) == bool(full)
            if full:
                assert len(pale) == 7
                for k in (1, 3, 5):
                    was, now = int(full[k : k + 2], 16), int(pale[k : k + 2], 16)
                    assert now == pytest.approx(was + part.fade * (255 - was), abs=0.51)


def test_only_a_motion_has_further_positions(four_bar: Sample) -> None:
    assert scene_of(four_bar.position(51), options=SEVEN) == scene_of(four_bar.position(51))
    motion = four_bar.motion()
    assert faint(scene_of(four_bar.position(51), motion)) == []


# ------------------------------------------------------------------ limits


def test_a_dead_point_is_a_stop_across_the_path_of_what_is_driven(four_bar: Sample) -> None:
    motion = with_limits(four_bar.motion(), row40="dead point")
    scene = scene_of(four_bar.position(51), motion, options=SEVEN)
    [stop] = scene.select(Polyline, Role.LIMIT)
    a, b = (z(p) for p in stop.points)
    tip = motion.trace("A")[40]
    assert (a + b) / 2 == pytest.approx(tip, abs=1e-9)
    along = (b - a) / abs(b - a) / cmath.exp(1j * math.radians(120))
    assert abs(along.imag) < 0.05  # along the crank, which turns: a row is 3 degrees
    assert abs(b - a) == pytest.approx(6 * scene.measures.pin)
    [name] = scene.select(Text, Role.LIMIT_NAME)
    assert name.text == "dead point 120°"
    assert z(name.anchor) == tip


def test_a_change_point_is_a_diamond(four_bar: Sample) -> None:
    motion = with_limits(four_bar.motion(), row60="change point")
    scene = scene_of(four_bar.position(51), motion, options=SEVEN)
    [diamond] = scene.select(Polygon, Role.LIMIT)
    assert sum(map(z, diamond.points)) / 4 == pytest.approx(motion.trace("A")[60], abs=1e-9)
    assert len(diamond.points) == 4
    [name] = scene.select(Text, Role.LIMIT_NAME)
    assert name.text == "change point 180°"


def test_positions_at_limits_stand_out_among_the_faint_ones(four_bar: Sample) -> None:
    motion = with_limits(four_bar.motion(), row40="dead point")
    scene = scene_of(four_bar.position(51), motion, options=SEVEN)
    cranks = scene.select(Polyline, Role.LINK, of="crank")
    by_fade = sorted({bar.fade for bar in cranks})
    assert len(by_fade) == 3
    [limit] = [bar for bar in cranks if bar.fade == by_fade[1]]
    assert motion.trace("A")[40] in [z(p) for p in limit.points]


def test_limits_are_marked_at_the_point_that_is_driven(
    slope: Callable[[float], Sample], boom: Sample, inverted_slider_crank: Sample, six_link: Sample
) -> None:
    def marked(mechanism: Sample, value: float) -> str:
        motion = mechanism.motion()
        return driven_point(Pose.of(mechanism.position(value), motion))

    assert marked(slope(30), 120) == "B"  # a slider
    assert marked(boom, 95) == "L"  # a cylinder: its moving end
    assert marked(inverted_slider_crank, 50) == "A"  # a crank: its tip
    nothing_drawn = (DrivenPart(kind="variable", name="u"),)
    unseen = replace(six_link, skeleton=replace(six_link.skeleton, driven=nothing_drawn))
    assert marked(unseen, 60) == "B"  # traced
    untraced = replace(unseen, skeleton=replace(unseen.skeleton, traced=()))
    travel = {n: np.ptp(untraced.motion()[f"{n}.x"]) for n in untraced.motion().points}
    assert travel[marked(untraced, 60)] == max(travel.values())


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("rapier-drive-limited", ["dead point 149.617°", "dead point 201.32°"]),
        ("rapier-drive", []),
    ],
)
def test_the_limits_of_a_sweep_are_named_with_their_input(name: str, told: list[str]) -> None:
    mechanism = lw.example(name)
    scene = scene_of(mechanism.solve(), mechanism.sweep(), options=SEVEN)
    assert [text.text for text in scene.select(Text, Role.LIMIT_NAME)] == told
    texts = scene.select(Text)
    for one, other in combinations(texts, 2):
        assert shared_area(one.box, other.box) == 0, (one.text, other.text)
    pins = [d for d in scene.select(Disc) if d.role is Role.PIN and not d.fade]
    for text in texts:
        for pin in pins:
            assert text.box.distance(pin.centre) >= pin.radius * 0.999, (text.text, pin.of)


# ------------------------------------------------------------------ captions


def test_the_caption_tells_the_start_and_the_range_behind_it(
    four_bar: Sample, rocking_four_bar: Sample, boom: Sample
) -> None:
    def caption(mechanism: Sample, value: float) -> str:
        return scene_of(mechanism.position(value), mechanism.motion(), options=SEVEN).caption

    assert caption(four_bar, 51) == "crank = 51°; faint: 0° to 360°"
    assert caption(boom, 95) == "ram = 95 mm; faint: 70 mm to 120 mm"
    assert caption(rocking_four_bar, 21) == "crank = 21°; faint: 0° to 69°, 291° to 360°"


def test_a_lone_row_and_negative_values_are_told_as_they_are(four_bar: Sample) -> None:
    motion = replace(four_bar, inputs=(-30, -27, 0, 45)).motion()
    alone = tuple(Status.LOST if k == 2 else status for k, status in enumerate(motion.status))
    assert reached_caption(replace(motion, status=alone)) == "−30° to −27°, 45°"


def test_further_branches_do_not_widen_the_range() -> None:
    around = lw.example("rapier-drive-limited").sweep(through=True)
    assert reached_caption(around) == "0° to 149.617°, 201.32° to 360°"
    assert reached_caption(lw.example("rapier-drive-limited").sweep()) == reached_caption(around)


def test_of_several_inputs_the_first_that_moves_is_told() -> None:
    five_bar = five_bar_of(left_stop=90)
    assert reached_caption(five_bar.sweep()) == "right 80° to 90°"


def test_text_is_broken_into_lines_that_fit() -> None:
    text = "a mechanism of a very long name indeed and " + "w" * 40
    lines = lines_within(text, 12.0)
    assert "".join(lines).replace(" ", "") == text.replace(" ", "")
    assert all(text_width(line, 1.0) <= 12.0 for line in lines)
    assert lines[0] == "a mechanism of a"
    assert lines_within("", 12.0) == []


# ------------------------------------------------------------------ the page


def test_an_svg_has_every_faint_part_and_names_the_limits() -> None:
    mechanism = lw.example("rapier-drive-limited")
    scene = scene_of(mechanism.solve(), mechanism.sweep(), options=SEVEN)
    svg = render(scene, "svg")
    text = svg.decode()
    assert text.count('id="faint-link:crank"') == 9  # seven and two limits
    assert text.count('id="link:crank"') == 1
    assert text.count('id="limit:A"') == 2
    assert {"dead point 149.617°", "dead point 201.32°"} <= set(svg_texts(svg))
    assert text.index('id="faint-link:crank"') < text.index('id="link:crank"')


@pytest.mark.parametrize("name", ["jansen-leg", "rapier-drive-limited-links", "slider-input"])
def test_nothing_of_a_sweep_is_cut_off(name: str) -> None:
    mechanism = lw.example(name)
    scene = scene_of(mechanism.solve(), mechanism.sweep(through=True), options=SEVEN)
    drawing = figure(scene)
    drawing.canvas.draw()
    assert isinstance(drawing.canvas, FigureCanvasAgg)
    renderer = drawing.canvas.get_renderer()
    [ax] = drawing.axes
    extents = [
        artist.get_window_extent(renderer)
        for artist in [*drawing.texts, *ax.texts, *ax.artists, *ax.patches]
    ]
    lines = [path for collection in ax.collections for path in collection.get_paths()]
    extents += [path.get_extents(ax.transData) for path in lines]
    for extent in extents:
        assert drawing.bbox.x0 <= extent.x0 <= extent.x1 <= drawing.bbox.x1
        assert drawing.bbox.y0 <= extent.y0 <= extent.y1 <= drawing.bbox.y1
