"""Vector diagrams: head to tail, closed, over the links, each loop in its colour."""

from __future__ import annotations

from itertools import combinations

import pytest

import linkwork as lw
from linkwork.core.drawing import Polyline, Role, Scene, SceneOptions, Text, scene_of
from linkwork.core.drawing.dimensions import polygon
from linkwork.core.drawing.pose import Pose
from linkwork.core.foundation.errors import InputError
from linkwork.core.motion import vector_loops
from linkwork.core.results.position import LoopVector, VectorLoop
from tests.core.drawing.conftest import Sample
from tests.core.drawing.shared_area import shared_area


def drawn(name: str, at: float | None = None) -> tuple[lw.Position, tuple[VectorLoop, ...], Scene]:
    mechanism = lw.example(name)
    position = mechanism.solve(at)
    loops = vector_loops(mechanism.model, position)
    return position, loops, scene_of(position, options=SceneOptions(vectors=loops))


def arrows(scene: Scene, tone: int) -> list[Polyline]:
    return [p for p in scene.select(Polyline, Role.VECTOR) if p.tone == tone]


@pytest.mark.parametrize("name", ["four-bar", "rapier-drive", "jansen-leg", "crank-shaper"])
def test_every_vector_of_every_loop_is_an_arrow_of_its_length(name: str) -> None:
    _, loops, scene = drawn(name)
    for tone, loop in enumerate(loops, 1):
        lengths = {}
        for arrow in arrows(scene, tone):
            tail, tip = (complex(*end) for end in arrow.points)
            lengths[arrow.of] = abs(tip - tail)
            assert arrow.head > 0
        for vector in (*loop.left, *loop.right):
            assert lengths[vector.name] == pytest.approx(abs(vector.value), rel=1e-9)


@pytest.mark.parametrize("value", [20, 100, 250])
def test_the_vectors_of_a_four_bar_lie_over_its_links(value: float) -> None:
    position, _, scene = drawn("four-bar", value)
    o2, a, b, o4 = (position.points[name] for name in ("O2", "A", "B", "O4"))
    ends = [arrow.points for arrow in arrows(scene, 1)]
    wanted = [(o2, a), (a, b), (o4, b), (o2, o4)]
    for tail, tip in wanted:
        assert any(abs(complex(*t) - complex(*tail)) + abs(complex(*h) - complex(*tip)) < 1e-6
                   for t, h in ends), (tail, tip)  # fmt: skip


def test_a_vector_that_is_taken_off_points_its_own_way() -> None:
    """-d1 leads from A0 to the left: the arrow of d1 leads back to A0."""
    position, _, scene = drawn("rapier-drive")
    [arrow] = [p for p in arrows(scene, 1) if p.of == "d1"]
    assert arrow.points[0][0] < arrow.points[1][0]
    assert arrow.points[1] == pytest.approx(position.points["A0"], abs=1e-6)


@pytest.mark.parametrize("name", ["four-bar", "jansen-leg", "rapier-drive", "windscreen-wiper"])
def test_polygons_close_and_most_joints_are_points(name: str) -> None:
    mechanism = lw.example(name)
    position = mechanism.solve()
    pose = Pose.of(position, None)
    for loop in vector_loops(mechanism.model, position):
        edges = polygon(loop, pose)
        ends = [end for edge in edges for end in (edge.tail, edge.tip)]
        size = max(abs(edge.tip - edge.tail) for edge in edges)
        for end in ends:  # every joint belongs to two vectors
            assert sum(abs(end - other) < 1e-6 * size for other in ends) >= 2
        there = [any(abs(end - z) < 1e-6 * size for z in pose.points.values()) for end in ends]
        assert sum(there) >= 0.7 * len(there)  # corners of right angles have no names


def test_vectors_in_one_line_lie_side_by_side() -> None:
    """Both loops use d1, a1 and a5; s16 is a part of the line of d1."""
    _, _, scene = drawn("rapier-drive")
    lines = [tuple(complex(*end) for end in p.points) for p in scene.select(Polyline, Role.VECTOR)]
    for (tail, tip), (start, end) in combinations(lines, 2):
        along = (tip - tail) / abs(tip - tail)
        low, high = sorted(((z - tail) * along.conjugate()).real for z in (start, end))
        apart = max(abs(((z - tail) * along.conjugate()).imag) for z in (start, end))
        shared = min(high, abs(tip - tail)) - max(low, 0.0)
        assert shared < 1e-6 * abs(tip - tail) or apart > scene.measures.pin


def test_the_mechanism_is_faint_behind_its_vectors(four_bar: Sample) -> None:
    loop = VectorLoop(label="O2 A", left=(LoopVector(name="a", value=40 + 0j),), right=())
    plain, behind = (
        scene_of(four_bar.position(50), options=SceneOptions(vectors=loops))
        for loops in ((), (loop,))
    )
    assert {p.fade for p in plain.select(Polyline, Role.LINK)} == {0.0}
    assert min(p.fade for p in behind.select(Polyline, Role.LINK)) > 0.3


def test_equations_without_points_are_drawn_as_vectors() -> None:
    mechanism = lw.loops(
        name="Bare",
        loops={"1": "a*e^(i*p) + b*e^(i*q) = c + d*e^(i*r)"},
        dimensions={"a": 2, "b": 6, "c": 5, "d": 4},
        guess={"p": 60, "q": 20, "r": 80},
        inputs=[lw.Input(variable="p")],
    )
    with pytest.raises(InputError, match="has no points to draw"):
        mechanism.scene()
    scene = mechanism.scene(vectors=True)
    assert [p.of for p in scene.select(Polyline, Role.VECTOR)] == ["a∠p", "b∠q", "d∠r", "c"]
    assert {t.text for t in scene.select(Text)} == {"a∠p", "b∠q", "d∠r", "c", "loop 1"}


def test_names_of_vectors_cover_neither_each_other_nor_vectors() -> None:
    for name in ("four-bar", "rapier-drive", "jansen-leg", "double-four-bar"):
        _, _, scene = drawn(name)
        for one, other in combinations(scene.select(Text), 2):
            assert shared_area(one.box, other.box) == 0, (name, one.text, other.text)


def test_a_long_loop_keeps_its_order() -> None:
    vectors = tuple(LoopVector(name=str(k), value=1j**k) for k in range(12))
    loop = VectorLoop(label="long", left=vectors, right=())
    pose = Pose.of(lw.example("four-bar").solve(), None)
    assert [edge.vector.name for edge in polygon(loop, pose)] == [str(k) for k in range(12)]
