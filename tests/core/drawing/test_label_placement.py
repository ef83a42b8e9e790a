"""Names stand beside what they name and cover neither each other nor pins."""

from __future__ import annotations

from itertools import combinations

import pytest

from linkwork.core.drawing import Box, Disc, Polyline, Role, SceneOptions, Text, scene_of
from linkwork.core.drawing.pose import printed_name
from tests.core.drawing.conftest import Places, Sample
from tests.core.drawing.shared_area import shared_area

MECHANISMS = [
    "four_bar", "slider_crank", "inverted_slider_crank", "collar", "six_link", "jansen", "flat",
    "tall", "ternary",
]  # fmt: skip


@pytest.fixture(params=MECHANISMS)
def sample(request: pytest.FixtureRequest) -> Sample:
    found: Sample = request.getfixturevalue(request.param)
    return found


@pytest.mark.parametrize("value", [0, 45, 100, 190, 280])
def test_names_cover_neither_each_other_nor_pins(sample: Sample, value: float) -> None:
    if sample.at(value) is None:
        pytest.skip("no position at this input value")
    scene = scene_of(sample.position(value), sample.motion(), options=SceneOptions(link_names=True))
    texts = scene.select(Text)
    for one, other in combinations(texts, 2):
        assert shared_area(one.box, other.box) == 0, (one.of, other.of)
    discs = [d for d in scene.select(Disc) if d.role in (Role.PIN, Role.POINT, Role.TRACED)]
    for text in texts:
        for disc in discs:
            assert text.box.distance(disc.centre) >= disc.radius * 0.999, (text.of, disc.of)


@pytest.mark.parametrize("value", [20, 70, 130])
def test_names_of_points_keep_off_bars_where_there_is_room(four_bar: Sample, value: float) -> None:
    scene = scene_of(four_bar.position(value))
    for text in scene.select(Text, Role.LABEL):
        for bar in scene.select(Polyline, Role.LINK):
            (x0, y0), (x1, y1) = bar.points
            along = [(x0 + (x1 - x0) * k / 200, y0 + (y1 - y0) * k / 200) for k in range(201)]
            assert min(text.box.distance(p) for p in along) > 0, (text.of, bar.of)


def test_every_drawn_point_has_its_name_near_it(sample: Sample) -> None:
    position = sample.position(50)
    scene = scene_of(position, sample.motion())
    names = {text.of: text for text in scene.select(Text, Role.LABEL)}
    assert set(names) == {d.of for d in scene.select(Disc) if d.role is not Role.TRACE}
    for name, text in names.items():
        assert text.anchor == position.points[name]
        assert text.box.distance(text.anchor) < 7 * scene.measures.pin


def test_names_can_be_left_out(four_bar: Sample) -> None:
    assert not scene_of(four_bar.position(50), labels=False).select(Text)


def test_link_names_are_written_on_request_and_inside_plates(ternary: Sample) -> None:
    position = ternary.position(50)
    assert not scene_of(position).select(Text, Role.LINK_NAME)
    scene = scene_of(position, options=SceneOptions(link_names=True))
    names = {text.of: text for text in scene.select(Text, Role.LINK_NAME)}
    assert set(names) == {bar.name for bar in ternary.skeleton.bars}
    middle = sum(complex(*position.points[p]) for p in "ABC") / 3
    assert names["coupler"].box.distance((middle.real, middle.imag)) == 0


def test_two_points_in_one_place_get_two_places_for_their_names(four_bar: Sample) -> None:
    def at(value: float) -> Places:
        places = four_bar.at(value)
        assert places is not None
        return {**places, "P": places["B"]}

    double = type(four_bar)(four_bar.name, four_bar.skeleton, at)
    scene = scene_of(double.position(50))
    [one], [other] = (scene.select(Text, Role.LABEL, of=name) for name in "BP")
    assert shared_area(one.box, other.box) == 0


def test_names_are_printed_with_greek_letters_and_lowered_numbers() -> None:
    assert printed_name("O2") == "O₂"
    assert printed_name("theta12") == "θ₁₂"
    assert printed_name("boom_pin") == "boom_pin"
    assert printed_name("A0'") == "A₀'"


def test_boxes_measure_what_they_share() -> None:
    box = Box(0, 0, 2, 1)
    assert shared_area(box, Box(1, 0.5, 3, 3)) == pytest.approx(0.5)
    assert shared_area(box, Box(2, 0, 3, 1)) == 0
    assert box.distance((5, 5)) == pytest.approx(5)
