"""Positions of a task in pictures of its designs."""

from __future__ import annotations

import cmath
import math

import pytest

import linkwork as lw
from linkwork.core.drawing.annotations import PositionMark
from linkwork.core.drawing.scene import Disc, Polyline, Role, Text


def test_poses_are_rings_with_numbers_and_lines_along_the_body() -> None:
    poses = [(70 + 60j, 20.0), (20 + 90j, 100.0)]
    marks = tuple(
        PositionMark(place=z, direction=cmath.rect(1.0, math.radians(a))) for z, a in poses
    )
    options = lw.SceneOptions(positions=marks)
    scene = lw.example("four-bar").scene(at=60, options=options)
    rings = scene.select(Disc, Role.POSITION)
    assert [ring.centre for ring in rings] == [(z.real, z.imag) for z, _ in poses]
    for line, (place, angle) in zip(scene.select(Polyline, Role.POSITION), poses, strict=True):
        start, end = (complex(*point) for point in line.points)
        assert math.degrees(cmath.phase(end - start)) == pytest.approx(angle, abs=1e-9)
        assert cmath.phase(end - place) == pytest.approx(cmath.phase(end - start), abs=1e-9)
    assert sorted(text.text for text in scene.select(Text, Role.POSITION_NAME)) == ["1", "2"]


def test_many_points_have_small_rings_and_the_first_its_number() -> None:
    few = tuple(PositionMark(place=complex(10 * k, 50)) for k in range(12))
    four_bar = lw.example("four-bar")
    scenes = [
        four_bar.scene(at=60, options=lw.SceneOptions(positions=marks))
        for marks in (few, (*few, PositionMark(place=60 + 60j)))
    ]
    names = [[t.text for t in s.select(Text, Role.POSITION_NAME)] for s in scenes]
    assert len(names[0]) == 12
    assert names[1] == ["1"]
    large, small = (scene.select(Disc, Role.POSITION)[0].radius for scene in scenes)
    assert small < large / 2
    assert scenes[1].select(Polyline, Role.POSITION) == []


def test_a_position_far_from_the_mechanism_is_in_the_picture() -> None:
    mark = PositionMark(place=900 + 0j)
    options = lw.SceneOptions(positions=(mark,))
    assert lw.example("four-bar").scene(at=60, options=options).within.right >= 900.0
