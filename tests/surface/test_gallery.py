"""In the picture of every library mechanism names cover neither each other nor symbols."""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.pages.moving_scene import moving_scene
from linkwork.core.commands.sweep import sweep_scene
from linkwork.core.drawing import Disc, Role, Scene, SceneOptions, Text, scene_of
from linkwork.core.drawing.labels import Obstacles
from linkwork.core.motion import vector_loops
from tests.core.drawing.shared_area import shared_area
from tests.thinned import thinned

NAMES = [name for name in lw.examples() if not name.startswith("newton-")]  # those have no points
SYMBOLS = {
    Role.LINK, Role.PLATE, Role.INPUT, Role.SLIDER, Role.CYLINDER, Role.GROUND, Role.BELT,
    Role.PIN, Role.POINT, Role.TRACED,
}  # fmt: skip
_TOUCHED = 2.0  # of cost: less is to lie inside a plate


@cache
def solved(name: str) -> tuple[lw.Mechanism, lw.Position]:
    mechanism = lw.example(name)
    return mechanism, mechanism.solve()


def assert_texts_are_apart(scene: Scene) -> None:
    for one, other in combinations(scene.select(Text), 2):
        assert shared_area(one.box, other.box) == 0, (one.text, other.text)
    for disc in (disc for disc in scene.select(Disc, Role.PIN) if not disc.fade):
        for text in scene.select(Text):
            assert text.box.distance(disc.centre) >= 0.99 * disc.radius, (text.text, disc.of)


@pytest.mark.parametrize("name", NAMES)
def test_names_cover_neither_each_other_nor_symbols(name: str) -> None:
    _, position = solved(name)
    assert_names_are_free(scene_of(position))


@pytest.mark.parametrize("name", thinned(NAMES, 8))
def test_larger_names_with_paths_and_further_positions_cover_nothing_either(name: str) -> None:
    mechanism, position = solved(name)
    motion = mechanism.sweep(certify=False) if mechanism.description.inputs else None
    assert_names_are_free(scene_of(position, motion, options=SceneOptions(larger=1.4)))
    if motion is not None:
        assert_names_are_free(sweep_scene(position, motion))


@pytest.mark.parametrize("name", thinned(NAMES, 8))
def test_names_of_moving_scenes_cover_neither_each_other_nor_pins(name: str) -> None:
    """In 31 rows over the whole cycle."""
    mechanism, _ = solved(name)
    if not mechanism.description.inputs:
        pytest.skip("nothing moves")
    motion = mechanism.sweep(certify=False)
    moving, rows = moving_scene(motion), np.flatnonzero(motion.found)
    for row in dict.fromkeys(rows[np.linspace(0, len(rows) - 1, 31).round().astype(int)].tolist()):
        assert_texts_are_apart(moving.at(row))


def assert_names_are_free(scene: Scene) -> None:
    assert_texts_are_apart(scene)
    for symbol in scene.primitives:
        if symbol.role in SYMBOLS and not symbol.fade:
            obstacle = Obstacles.of([symbol])
            for text in scene.select(Text):
                box = text.box.grown(-0.05 * text.height)
                assert obstacle.cost([box]) < _TOUCHED, (text.text, symbol.role, symbol.of)


@pytest.mark.parametrize("name", NAMES[::5])
def test_names_of_vectors_cover_neither_each_other_nor_pins(name: str) -> None:
    mechanism, position = solved(name)
    if not mechanism.loop_equations.loops:
        pytest.skip("no loops: nothing but wheels or cams")
    loops = vector_loops(mechanism.model, position)
    assert_texts_are_apart(scene_of(position, options=SceneOptions(vectors=loops)))
