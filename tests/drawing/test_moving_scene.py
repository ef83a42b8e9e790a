"""A moving picture shows in every row what the picture of that row shows."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.drawing import SceneOptions, reach_of, scene_of
from linkwork.drawing.moving_scene import moving_scene
from linkwork.drawing.scene import Arc, Polyline, Primitive, Role, Scene, Text
from linkwork.drawing.shape_corners import corners

_DRAWN = [n for n in lw.examples() if lw.example(n).model.compiled.points.names]
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


@pytest.mark.parametrize("name", _DRAWN)
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
