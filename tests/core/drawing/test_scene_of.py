"""What a picture is called, what it refuses and why."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from linkwork.core.drawing import Polyline, Role, SceneOptions, reach_of, scene_of
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.foundation.statuses import Status
from linkwork.core.mechanism.skeleton import Bar, Skeleton
from tests.core.drawing.conftest import Sample


def message(raised: pytest.ExceptionInfo[Exception]) -> str:
    return str(raised.value)


def test_a_position_that_was_not_found_is_refused_with_its_reason(rocking_four_bar: Sample) -> None:
    position = rocking_four_bar.position(180)
    with pytest.raises(InputError) as raised:
        scene_of(position)
    assert message(raised) == (
        '"Double rocker" has no position to draw at this input value: ' + Status.OUT_OF_REACH.value
    )


def test_a_mechanism_without_points_says_what_to_add(four_bar: Sample) -> None:
    bare = replace(four_bar.position(50), points={}, skeleton=Skeleton())
    with pytest.raises(InputError) as raised:
        scene_of(bare)
    assert message(raised) == (
        '"Four-bar, Norton example 4-1" has no points to draw: '
        "add [points] with the coordinates of its pins"
    )


def test_a_link_with_an_unknown_point_is_refused(four_bar: Sample) -> None:
    skeleton = Skeleton(bars=(Bar(name="crank", points=("A", "X")),))
    with pytest.raises(InputError) as raised:
        scene_of(replace(four_bar.position(50), skeleton=skeleton))
    assert message(raised) == (
        "links and joints name points without coordinates: X (points: O2, A, B, O4, P)"
    )


def test_points_at_no_place_are_refused(four_bar: Sample) -> None:
    position = four_bar.position(50)
    broken = replace(position, points={**position.points, "P": (np.nan, 0.0)})
    with pytest.raises(InputError) as raised:
        scene_of(broken)
    assert message(raised) == "points without coordinates cannot be drawn: P"


def test_a_guide_between_two_equal_points_is_refused(slider_crank: Sample) -> None:
    position = slider_crank.position(50)
    broken = replace(position, points={**position.points, "T": position.points["S"]})
    with pytest.raises(InputError) as raised:
        scene_of(broken)
    assert message(raised) == ('the line of "s" has no direction: points S and T coincide')


def test_a_motion_of_another_mechanism_is_refused(four_bar: Sample, flat: Sample) -> None:
    with pytest.raises(InputError) as raised:
        scene_of(four_bar.position(50), flat.motion())
    assert message(raised) == (
        "position and motion are of different mechanisms: "
        '"Four-bar, Norton example 4-1" with points O2, A, B, O4, P; '
        '"Long flat four-bar" with O2, A, B, O4'
    )


def test_an_unknown_trace_is_refused_with_what_exists(four_bar: Sample) -> None:
    with pytest.raises(UnknownNameError) as raised:
        scene_of(four_bar.position(50), four_bar.motion(), traces=["Q"])
    assert message(raised) == 'there is no point "Q" to trace (points: O2, A, B, O4, P)'


def test_a_trace_without_a_motion_is_refused(four_bar: Sample) -> None:
    with pytest.raises(InputError) as raised:
        scene_of(four_bar.position(50), traces=["P"])
    assert message(raised) == (
        "the paths of P cannot be drawn from one position: give the motion too"
    )


def test_traces_are_those_of_the_mechanism_unless_named(four_bar: Sample) -> None:
    position, motion = four_bar.position(50), four_bar.motion()

    def traced(**options: Any) -> set[str]:
        return {p.of for p in scene_of(position, **options).select(Polyline, Role.TRACE)}

    assert traced() == set()
    assert traced(motion=motion) == {"P"}
    assert traced(motion=motion, traces=["A", "B"]) == {"A", "B"}
    assert traced(motion=motion, traces=[]) == set()


def test_title_and_caption_name_the_mechanism_and_its_input_with_unit(
    four_bar: Sample, boom: Sample
) -> None:
    scene = scene_of(four_bar.position(50))
    assert (scene.title, scene.caption) == ("Four-bar, Norton example 4-1", "crank = 50°")
    assert scene_of(boom.position(95)).caption == "ram = 95 mm"
    assert scene_of(boom.position(95), options=SceneOptions(title="Arm")).title == "Arm"
    assert scene.unit == "mm"


def test_the_reach_of_a_motion_holds_every_position(rocking_four_bar: Sample) -> None:
    motion = rocking_four_bar.motion()
    box = reach_of(motion)
    xs = np.concatenate([motion[f"{p}.x"] for p in motion.points])
    assert box.left == np.nanmin(xs)
    assert box.right == np.nanmax(xs)


def test_a_motion_without_positions_has_no_reach(four_bar: Sample) -> None:
    motion = four_bar.motion()
    lost = replace(motion, status=(Status.LOST,) * len(motion))
    with pytest.raises(InputError) as raised:
        reach_of(lost)
    assert message(raised) == (
        'the motion of "Four-bar, Norton example 4-1" has nothing to draw: 0 positions, 5 points'
    )


def test_one_single_point_can_be_drawn(four_bar: Sample) -> None:
    position = replace(four_bar.position(50), points={"X": (1e6, 1e6)}, skeleton=Skeleton())
    scene = scene_of(position)
    assert scene.measures.size == 1.0
    assert scene.box.width > 0


def test_scenes_need_no_matplotlib() -> None:
    code = "import linkwork.core.drawing, sys; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
