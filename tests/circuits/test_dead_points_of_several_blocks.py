"""Dyads of one crank that lock at one input: copies of a dyad, mirrored, scaled, turned about O.

Two bars b and c close the distance L from the crank's pin to the fixed pin while
|b - c| ≤ L ≤ b + c (triangle inequality); L² = a² + d² - 2 a d cos θ gives the dead points.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.results.failure import LimitKind

A, B, C, D = 2.0, 2.5, 3.0, 4.0  # crank, coupler, rocker, ground
POLICIES = ("stop", "straight", "turn")


def dead_angle(reach: float = B + C) -> float:
    """The crank angle [deg] at which the bars are in line."""
    return math.degrees(math.acos((A * A + D * D - reach * reach) / (2.0 * A * D)))


def corner(a: complex, d: complex, b: float, c: float, side: int) -> complex:
    """Where bars b from a and c from d meet."""
    span = abs(d - a)
    along = (span * span + b * b - c * c) / (2.0 * span)
    return a + (d - a) / span * complex(along, side * math.sqrt(b * b - along * along))


def copies(
    turned: Sequence[tuple[float, float, int]], stop: float = 360.0, step: float = 6.0
) -> lw.Mechanism:
    """A crank at 20° with a dyad for every (size, turn [rad], side)."""
    points: dict[str, tuple[float, float]] = {"O": (0.0, 0.0)}
    links: dict[str, list[str]] = {"ground": ["O"], "crank": ["O"]}
    lengths: dict[str, float] = {}
    for k, (size, turn, side) in enumerate(turned):
        pins = next(j for j, other in enumerate(turned) if other[:2] == (size, turn))
        factor = cmath.rect(size, turn)
        a, d = factor * cmath.rect(A, math.radians(20.0)), factor * D
        e = corner(a, d, size * B, size * C, side)
        for name, z in ((f"A{pins}", a), (f"D{pins}", d), (f"E{k}", e)):
            points[name] = (z.real, z.imag)
        if pins == k:
            links["crank"].append(f"A{k}")
            links["ground"].append(f"D{k}")
        links |= {f"coupler{k}": [f"A{pins}", f"E{k}"], f"rocker{k}": [f"D{pins}", f"E{k}"]}
        lengths |= {f"A{pins} E{k}": size * B, f"D{pins} E{k}": size * C}
    return lw.linkage(
        points=points,
        links=links,
        lengths=lengths,
        inputs=lw.Input(link="crank", from_=0, to=stop, step=step),
    )


CASES = {
    "mirrored": ((1.0, 0.0, 1), (1.0, 0.0, -1)),
    "scaled": ((1.0, 0.0, 1), (1.7, 0.0, 1)),
    "turned": ((1.0, 0.0, 1), (1.0, 2.0, -1)),
    "three": ((1.0, 0.0, 1), (0.6, 1.0, -1), (1.3, 4.0, 1)),
}


@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("turned", CASES.values(), ids=CASES)
def test_dyads_that_lock_at_one_input_are_one_dead_point_of_all(
    turned: tuple[tuple[float, float, int], ...], policy: str
) -> None:
    motion = copies(turned).sweep(change_points=policy)
    angle = np.array(motion.inputs["crank"])[motion.asked]
    closes = np.cos(np.radians(angle)) > math.cos(math.radians(dead_angle()))
    np.testing.assert_array_equal(motion.found[motion.asked], closes)
    assert motion.certified[motion.asked][closes].all()
    # the sketch gives sides to rounding, which moves a dead point by the same relative size
    limits = sorted(limit.input for limit in motion.limits)
    assert limits == pytest.approx([dead_angle(), 360.0 - dead_angle()], abs=1e-10)
    for limit in motion.limits:
        assert limit.kind is LimitKind.DEAD_POINT
        assert limit.located
        assert len(limit.loops) == len(turned)
        bars = {f"{bar}{k}" for bar in ("coupler", "rocker") for k in range(len(turned))}
        assert set(limit.in_line) == bars


@pytest.mark.parametrize("policy", POLICIES)
def test_a_table_may_begin_or_end_where_both_dyads_lock(policy: str) -> None:
    two = CASES["mirrored"]
    motion = copies(two, stop=dead_angle(), step=dead_angle() / 4.0).sweep(change_points=policy)
    assert motion.found[motion.asked].all()
    assert motion.limit[-1] == "dead point"


def test_rows_a_turn_away_are_found_where_both_dyads_lock() -> None:
    motion = copies(CASES["mirrored"], stop=720.0, step=12.0).sweep(change_points="straight")
    angle = np.array(motion.inputs["crank"])[motion.asked]
    closes = np.cos(np.radians(angle)) > math.cos(math.radians(dead_angle()))
    np.testing.assert_array_equal(motion.found[motion.asked], closes)


def parallelogram_with_dyad(locks: float) -> lw.Mechanism:
    """A parallelogram, which has change points at 0° and 180°, and a dyad from its crank to a pin
    above O that locks at ``locks`` [deg] and 180° - ``locks``.
    """
    a, pin = cmath.rect(A, math.radians(120.0)), 3.0j
    reach = abs(cmath.rect(A, math.radians(locks)) - pin)
    c, e = a + D, corner(a, pin, 1.6, reach - 1.6, 1)
    place = {"O": 0j, "A": a, "P": complex(D), "C": c, "Q": pin, "E": e}
    return lw.linkage(
        points={name: (z.real, z.imag) for name, z in place.items()},
        links={
            "ground": ["O", "P", "Q"], "crank": ["O", "A"], "coupler": ["A", "C"],
            "rocker": ["P", "C"], "first": ["A", "E"], "second": ["Q", "E"],
        },
        lengths={"O A": A, "A C": D, "P C": A},
        inputs=lw.Input(link="crank", from_=0, to=360, step=5),
    )  # fmt: skip


@pytest.mark.parametrize("policy", POLICIES)
def test_a_branch_ends_at_a_dead_point_where_another_block_has_a_change_point(policy: str) -> None:
    motion = parallelogram_with_dyad(180.0).sweep(change_points=policy)
    angle = np.array(motion.inputs["crank"])[motion.asked]
    inside = (angle > 0.0) & (angle < 180.0)
    assert motion.certified[motion.asked][inside].all()
    assert not motion.found[motion.asked][(angle > 180.0) & (angle < 360.0)].any()
    kinds = {(limit.kind, limit.located) for limit in motion.limits}
    assert kinds == {(LimitKind.DEAD_POINT, True)}
    assert sorted(limit.input for limit in motion.limits) == pytest.approx([0, 180], abs=1e-10)


def test_a_change_point_before_a_dead_point_is_still_crossed() -> None:
    motion = parallelogram_with_dyad(181.0).sweep(change_points="straight")
    kinds = {round(limit.input, 6): limit.kind for limit in motion.limits}
    assert kinds[0.0] is kinds[180.0] is LimitKind.CHANGE_POINT
    assert kinds[181.0] is LimitKind.DEAD_POINT


def test_circuits_end_and_explanations_point_to_where_both_dyads_lock() -> None:
    two = copies(CASES["mirrored"])
    (circuit,) = two.circuits()
    # four curves meet there, so that circuits call it a change point
    assert not circuit.dead_points
    angles = sorted(limit.input for limit in circuit.change_points)
    assert angles == pytest.approx([-dead_angle(), dead_angle()], abs=1e-10)
    assert all(len(limit.loops) == 2 for limit in circuit.change_points)
    failure = two.solve(at=180).failure
    assert failure is not None
    assert failure.nearest_kind == "dead point"
