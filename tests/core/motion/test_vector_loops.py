"""The vectors of a loop equation close, and are called as the equation calls them."""

from __future__ import annotations

import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.core.motion import vector_loops
from linkwork.core.results.position import VectorLoop

MECHANISMS = [
    "four-bar",
    "rapier-drive",
    "crank-shaper",
    "excavator",
    "double-four-bar",
    "three-rpr",
]


def loops_of(name: str, at: float | None = None) -> tuple[VectorLoop, ...]:
    mechanism = lw.example(name)
    return vector_loops(mechanism.model, mechanism.solve(at))


@pytest.mark.parametrize("name", MECHANISMS)
def test_both_sides_of_every_loop_lead_to_one_place(name: str) -> None:
    loops = loops_of(name)
    assert len(loops) == len(lw.example(name).loop_equations.loops)
    for loop in loops:
        left, right = (sum(v.value for v in side) for side in (loop.left, loop.right))
        size = max(abs(v.value) for v in (*loop.left, *loop.right))
        assert abs(left - right) < 1e-9 * size


def test_vectors_are_named_in_polar_form() -> None:
    first, second = loops_of("rapier-drive")
    assert [v.name for v in first.left] == ["a2∠θ12", "a3∠θ13"]
    assert [v.name for v in first.right] == ["d1", "a1∠90°", "a5∠θ15", "a4∠θ14"]
    assert [v.name for v in second.right] == ["s16", "b1∠90°"]
    assert [v.backwards for v in first.right] == [True, True, False, False]


def test_a_vector_is_as_long_and_turned_as_its_link() -> None:
    mechanism = lw.example("four-bar")
    position = mechanism.solve(75)
    [loop] = vector_loops(mechanism.model, position)
    a, b = (complex(*position.points[name]) for name in "AB")
    assert abs(loop.left[1].value - (b - a)) < 1e-9


def test_plain_equations_have_no_vectors() -> None:
    mechanism = lw.example("newton-convergence")
    with pytest.raises(InputError, match="has no loop equations to show as vectors"):
        vector_loops(mechanism.model, mechanism.solve())


def test_a_position_that_was_not_found_has_no_vectors() -> None:
    mechanism = lw.example("landing-gear")
    lost = mechanism.solve(1e6)
    assert not lost.status.ok
    with pytest.raises(InputError, match="has no position here"):
        vector_loops(mechanism.model, lost)
