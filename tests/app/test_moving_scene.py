"""A moving picture shows in every row what the picture of that row shows."""

from __future__ import annotations

from itertools import combinations, product

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.pages.moving_scene import moving_scene
from linkwork.core.drawing import SceneOptions, reach_of, scene_of
from linkwork.core.drawing.scene import Arc, Disc, Polyline, Primitive, Role, Scene, Text, corners
from linkwork.core.mechanism.linkage import Linkage
from tests.core.drawing.shared_area import shared_area
from tests.described import described_as
from tests.library_mechanisms import read_example
from tests.thinned import thinned

_DRAWN = [n for n in lw.examples() if read_example(n).model.compiled.points.names]
_FURTHEST = 1e-6  # of the drawn size: rows and positions agree to rounding


def _outline(primitive: Primitive) -> np.ndarray:
    arc = isinstance(primitive, Arc) or (primitive.role is Role.BELT)
    if arc and isinstance(primitive, Arc | Polyline):
        return np.array([complex(*primitive.points[0]), complex(*primitive.points[-1])])
    return corners(primitive)


def _kind(primitive: Primitive) -> str:
    shape = "line" if isinstance(primitive, Arc | Polyline) else type(primitive).__name__
    return f"{shape} {primitive.role.name} {primitive.of}"


def _compared(scene: Scene) -> dict[str, list[np.ndarray]]:
    found: dict[str, list[np.ndarray]] = {}
    for primitive in scene.primitives:
        if isinstance(primitive, Text) or primitive.role is Role.INPUT:
            continue
        found.setdefault(_kind(primitive), []).append(_outline(primitive))
    return found


def _apart(one: np.ndarray, other: np.ndarray) -> float:
    """The largest distance of a corner of one shape from the nearest of the other."""
    far = np.abs(one[:, None] - other)
    return float(max(far.min(axis=0).max(), far.min(axis=1).max()))


def _differences(one: Scene, other: Scene) -> dict[str, float]:
    a, b = _compared(one), _compared(other)
    assert a.keys() == b.keys()
    worst = {}
    for kind, shapes in a.items():
        assert len(shapes) == len(b[kind]), kind
        far = max(map(_apart, shapes, b[kind]))
        if far > _FURTHEST * one.measures.size:
            worst[kind] = far
    return worst


@pytest.mark.parametrize("name", thinned(_DRAWN, 9))
def test_moving_scene_agrees_with_the_scene_of_a_row(name: str) -> None:
    mechanism = lw.example(name)
    motion = mechanism.sweep(certify=False)
    moving = moving_scene(motion)
    rows = np.flatnonzero(motion.found)
    options = SceneOptions(within=reach_of(motion))
    for row in rows[np.linspace(0, len(rows) - 1, 6).round().astype(int)]:
        at = {name: float(values[row]) for name, values in motion.inputs.items()}
        position = mechanism.solve(at or None)
        assert _differences(moving.at(int(row)), scene_of(position, motion, options=options)) == {}


@pytest.mark.parametrize(
    ("name", "lengths"),
    [
        ("jansen-leg", {"O A": 14.0}),
        ("landing-gear", {}),
        ("planetary-gear", {}),
    ],
)
def test_scene_drawn_like_another_is_the_one_drawn_afresh(
    name: str, lengths: dict[str, float]
) -> None:
    mechanism = lw.example(name)
    before = moving_scene(mechanism.sweep(certify=False))
    changed = mechanism.changed(lengths={**described_as(Linkage, mechanism).lengths, **lengths})
    motion = changed.sweep(certify=False)
    quick, afresh = moving_scene(motion, like=before), moving_scene(motion)
    assert [part.frame for part in quick.parts] != []
    for row in np.flatnonzero(motion.found)[::25]:
        assert _differences(quick.at(int(row)), afresh.at(int(row))) == {}
    assert [p.shape.of for p in quick.parts if isinstance(p.shape, Text)] == [
        p.shape.of for p in afresh.parts if isinstance(p.shape, Text)
    ]


def test_names_keep_their_place_beside_their_points() -> None:
    motion = lw.example("jansen-leg").sweep(certify=False)
    moving = moving_scene(motion)
    for name, row in product(motion.points, range(0, 360, 20)):
        (text,) = moving.at(row).select(Text, Role.LABEL, name)
        point = motion.trace(name)[row]
        assert text.box.distance((point.real, point.imag)) < 7 * moving.scene.measures.pin
    offsets = [
        {text.of: (text.offset, text.align) for text in moving.at(row).select(Text)}
        for row in (0, 100, 200)
    ]
    assert offsets[0] == offsets[1] == offsets[2]
    assert len(offsets[0]) == 8


@pytest.mark.parametrize(
    "name", ["jansen-leg", "stephenson-valve-gear", "andrews-squeezer", "oldham-coupling"]
)
def test_names_of_a_moving_scene_cover_neither_each_other_nor_pins(name: str) -> None:
    """Over the whole cycle, not only in the rows that were looked at."""
    motion = lw.example(name).sweep(certify=False)
    moving = moving_scene(motion)
    rows = np.flatnonzero(motion.found)
    for row in rows[np.linspace(0, len(rows) - 1, 47).round().astype(int)]:
        scene = moving.at(int(row))
        for one, other in combinations(scene.select(Text), 2):
            assert shared_area(one.box, other.box) == 0, (row, one.text, other.text)
        for disc, text in product(scene.select(Disc, Role.PIN), scene.select(Text)):
            assert text.box.distance(disc.centre) >= 0.9 * disc.radius, (row, text.text, disc.of)


def test_view_holds_every_row() -> None:
    moving = moving_scene(lw.example("jansen-leg").sweep(certify=False))
    view = moving.view
    for row in range(0, 360, 7):
        for primitive in moving.at(row).primitives:
            for x, y in () if isinstance(primitive, Text) else primitive.outline:
                assert view.distance((x, y)) <= _FURTHEST * moving.scene.measures.size


def test_only_what_bends_has_a_course_of_its_own() -> None:
    rigid = moving_scene(lw.example("planetary-gear").sweep(certify=False))
    assert [part for part in rigid.parts if part.frame is None] == []
    excavator = moving_scene(lw.example("excavator").sweep(certify=False))
    own = {part.shape.of for part in excavator.parts if part.frame is None}
    assert own == {"boom_ram", "stick_ram", "bucket_ram"}


def test_rows_without_a_position_are_refused() -> None:
    moving = moving_scene(lw.example("rapier-drive-limited").sweep(certify=False))
    assert not moving.found[180]
    with pytest.raises(lw.InputError, match="row 180 of the motion has no position to draw"):
        moving.at(180)


@pytest.mark.parametrize("name", ["four-bar", "rapier-drive-limited", "slider-crank-engine"])
def test_a_scene_found_from_some_rows_carries_the_same_shapes(name: str) -> None:
    motion = lw.example(name).sweep(certify=False)
    every, some = moving_scene(motion), moving_scene(motion, sampled=True)
    # a name may turn with another link: it is placed for other rows
    for one, other in zip(every.parts, some.parts, strict=True):
        assert (one.shape.role, one.shape.of) == (other.shape.role, other.shape.of)
        assert isinstance(one.shape, Text) or one.frame == other.frame
    for one, other in zip(every.parts, some.parts, strict=True):
        assert (one.course is None) == (other.course is None)
        if one.course is not None and other.course is not None:
            np.testing.assert_allclose(one.course, other.course, atol=1e-9, equal_nan=True)
