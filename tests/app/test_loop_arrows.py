"""Vectors of loop equations over a motion: each is its term, in every row, head to tail."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.pages.packing import unpressed
from linkwork.app.pages.page_building import loop_arrows
from linkwork.app.pages.page_data import VectorData
from linkwork.core.drawing.pose import printed_formula
from linkwork.core.motion.iterating import moving_loops
from tests.app.unpacking import unpacked
from tests.library_mechanisms import read_example
from tests.thinned import thinned

LOOPED = [
    name
    for name in lw.examples()
    if (model := read_example(name).model).equations.loops
    and model.compiled.points.names
    and model.description.inputs
]


def ends_of(arrow: VectorData, motion: lw.Motion) -> tuple[np.ndarray, np.ndarray]:
    """Tail and tip over all rows."""
    if not arrow.course:
        ways = [motion.trace(name) for name in motion.points]
        return ways[arrow.start], ways[arrow.end]
    x0, y0, x1, y1 = (unpacked(column, motion.found) for column in arrow.course)
    return x0 + 1j * y0, x1 + 1j * y1


@pytest.mark.parametrize("name", thinned(LOOPED))
def test_every_arrow_is_its_term_in_every_row(name: str) -> None:
    mechanism = read_example(name)
    motion = mechanism.sweep(certify=False)
    loops = moving_loops(mechanism.model, motion)
    terms = {
        printed_formula(vector.name): vector.values * (-1 if vector.backwards else 1)
        for loop in loops
        for vector in (*loop.left, *loop.right)
    }
    arrows = list(loop_arrows(loops, motion, unpressed))
    assert {arrow.name for arrow in arrows} <= set(terms)
    size = max(float(np.nanmax(np.abs(values))) for values in terms.values())
    drawn = {arrow.name for arrow in arrows}
    for term, values in terms.items():
        assert term in drawn or np.nanmax(np.abs(values)) <= 1e-6 * size  # only what has no length
    for arrow in arrows:
        tail, tip = ends_of(arrow, motion)
        np.testing.assert_allclose(
            (tip - tail)[motion.found], terms[arrow.name][motion.found], atol=1e-5 * size
        )


def test_arrows_of_a_linkage_lie_between_its_points() -> None:
    mechanism = lw.example("four-bar")
    motion = mechanism.sweep(certify=False)
    points = list(motion.points)
    arrows = list(loop_arrows(moving_loops(mechanism.model, motion), motion, unpressed))
    assert {(points[a.start], points[a.end]) for a in arrows} == {
        ("O2", "A"), ("A", "B"), ("O4", "B"), ("O2", "O4"),
    }  # fmt: skip
    assert all(not arrow.course and arrow.tone == 1 for arrow in arrows)


def test_a_vector_that_no_points_hold_has_a_course_of_its_own() -> None:
    mechanism = lw.example("rapier-drive")
    motion = mechanism.sweep(certify=False)
    arrows = list(loop_arrows(moving_loops(mechanism.model, motion), motion, unpressed))
    own = {arrow.name for arrow in arrows if arrow.course}
    assert own
    assert {arrow.tone for arrow in arrows} == {1, 2}
    ends = [end for arrow in arrows for end in ends_of(arrow, motion)]
    for arrow in arrows:  # head to tail: each end is that of another arrow
        for end in ends_of(arrow, motion):
            assert sum(bool(np.abs(end - other).max() < 1e-6) for other in ends) >= 2


def test_what_has_no_loops_has_no_arrows() -> None:
    mechanism = lw.example("planetary-gear")
    motion = mechanism.sweep(certify=False)
    assert moving_loops(mechanism.model, motion) == ()
    assert list(loop_arrows((), motion, unpressed)) == []
