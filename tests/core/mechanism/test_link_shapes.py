"""Shapes of links from their dimensions: points on rays and circles."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.mechanism.link_shape import Distance, ShapeError, VertexAngle, place
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.varied_numbers import number_named, with_numbers
from linkwork.core.motion.model import model_of
from linkwork.synthesis.improvement.lanes import DesignWriter


@pytest.mark.parametrize("sketched", [0.7, 3.0])
@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_an_angle_and_the_side_across_have_the_triangle_of_the_sketch(
    sketched: float, turn: float
) -> None:
    """|AP| = 3, 40° at P, |AB| = 2: the law of cosines has two triangles."""
    angle = math.radians(40.0) * turn
    sketch = {"A": 0j, "P": 3 + 0j, "B": 3 + sketched * np.exp(1j * (math.pi + angle))}
    given = [Distance("A", "P", 3.0), Distance("A", "B", 2.0)]
    shape = place(("A", "P", "B"), sketch, given, [VertexAngle("A", "P", "B", angle)])
    half = math.sqrt(4.0 - (3.0 * math.sin(angle)) ** 2)
    length = 3.0 * math.cos(angle) + math.copysign(half, sketched - 2.0)
    assert shape.local["B"] == pytest.approx(3.0 - length * np.exp(1j * angle))
    assert not shape.measured


def test_a_side_that_is_too_short_for_the_angle_is_refused() -> None:
    given = [Distance("A", "P", 3.0), Distance("A", "B", 1.9)]
    sketch = {"A": 0j, "P": 3 + 0j, "B": 2 + 2j}
    with pytest.raises(ShapeError, match=r"no triangle has \|AB\| = 1.9 and this angle at P, 3 aw"):
        place(("A", "P", "B"), sketch, given, [VertexAngle("A", "P", "B", -math.radians(40.0))])


@pytest.mark.parametrize(
    ("name", "varied"),
    [("chebyshev", "A B"), ("watt-linkage", "A P B"), ("rapier-drive-links", "B C D")],
)
def test_designs_follow_the_side_across_an_angle(name: str, varied: str) -> None:
    model = lw.example(name).model
    number = number_named(model.description, varied)
    x = np.linspace(0.97, 1.03, 5)[:, None] * float(number.of(model.description))
    written = DesignWriter(model, [number]).written(x)
    assert written.fine.all()
    description = model.description
    assert isinstance(description, Draft)
    for k, value in enumerate(x[:, 0]):
        alone = model_of(with_numbers(description, {number: float(value)}))
        others = DesignWriter(alone, [number])
        own = others.written(x[k : k + 1])
        for node, (values, _) in written.known.items():
            assert values[k] == pytest.approx(own.known[node][0][0], rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("off", [7.5e-8, 1e-8, 1e-12])
def test_dimensions_that_contradict_each_other_move_no_other_point(off: float) -> None:
    """E is on the line O A and seen from A beside it; F has a flat triangle of its own."""
    given = [Distance("O", "A", 2.0)]
    vertices = [
        VertexAngle("O", "A", "E", math.radians(off)),
        VertexAngle("E", "O", "A", math.pi),
        VertexAngle("A", "O", "F", math.radians(4.4e-8)),
        VertexAngle("F", "A", "O", math.radians(179.99999988)),
    ]
    sketch = {"O": 0j, "A": 2 + 0j, "E": -0.5 + 0j, "F": 3.1579 + 0j}
    with pytest.raises(ShapeError, match=r"has an angle of \S+° at A, not \S+° \(\S+ rad apart\)"):
        place(("O", "A", "E", "F"), sketch, given, vertices)


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize(("off", "fits"), [(0.0, True), (3e-10, False), (-1e-12, False)])
def test_a_redundant_dimension_agrees_to_rounding(off: float, fits: bool, order: int) -> None:
    sides = [Distance("O", "A", 3.0), Distance("A", "P", 4.0), Distance("O", "P", 5.0)][::order]
    sketch = {"O": 0j, "A": 3 + 0j, "P": 3 + 4j}
    angles = [VertexAngle("A", "O", "P", math.atan2(4.0, 3.0) + off)]
    if fits:
        shape = place(("O", "A", "P"), sketch, sides, angles)
        assert shape.local["P"] == pytest.approx(3 + 4j, rel=1e-15)
        return
    why = r"\((\S+ rad apart|relative difference \S+)\)"
    message = rf"has 3 dimensions, 4 are given and disagree: .* {why}"
    with pytest.raises(ShapeError, match=message):
        place(("O", "A", "P"), sketch, sides, angles)


def test_sides_that_do_not_reach_each_other_are_refused() -> None:
    sides = [Distance("O", "A", 1.0), Distance("A", "P", 1.0), Distance("O", "P", 2.0 + 1e-10)]
    with pytest.raises(ShapeError, match="no link has these dimensions"):
        place(("O", "A", "P"), {"O": 0j, "A": 1 + 0j, "P": 2 + 0.1j}, sides, [])


@pytest.mark.parametrize("height", [1.0, 1e-2, 1e-4])
def test_all_distances_of_a_flat_link_agree_to_their_rounding(height: float) -> None:
    """Ten distances as written from coordinates, of which seven determine the link."""
    rng = np.random.default_rng(7)
    for _ in range(20):
        x, y = rng.uniform(-50, 50, 5), height * rng.uniform(-50, 50, 5)
        places = dict(zip("ABCDE", zip(x.tolist(), y.tolist(), strict=True), strict=True))
        lengths = {f"{p} {q}": math.dist(places[p], places[q]) for p, q in combinations(places, 2)}
        lw.linkage(
            points={"O": (0, 0), **places},
            links={"ground": ["O", "A"], "bar": [*places]},
            lengths=lengths,
            inputs=lw.Input(link="bar"),
        )
