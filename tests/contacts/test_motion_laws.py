"""Motion laws of cams against the formulas of the textbooks, written out here.

Formulas and factors: Norton, Cam Design and Manufacturing Handbook, 2nd ed., chapters 3 and 4
(x = θ/β, displacement for a lift of 1).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pytest

from linkwork.contacts.profiles import program
from linkwork.core.mechanism.inputs import LAWS, pieces_of

Array = npt.NDArray[np.float64]
PI = math.pi
MOVING = [law for law in LAWS if law != "dwell"]


def derivatives(law: str, x: Array) -> Array:
    """Displacement, velocity, acceleration and jerk (4, K), from the pieces' numbers alone."""
    pieces = pieces_of(law)
    begins = np.concatenate([[0.0], np.cumsum([piece.over for piece in pieces])])
    number = np.clip(np.searchsorted(begins, x, side="right") - 1, 0, len(pieces) - 1)
    found = np.zeros((4, len(x)))
    for k, piece in enumerate(pieces):
        mine = number == k
        t = x[mine] - begins[k]
        a, w, p = piece.sine
        for order in range(4):
            total = a * w**order * np.sin(w * t + p + order * PI / 2)
            for degree, c in enumerate(piece.powers):
                if degree >= order:
                    total = total + c * math.perm(degree, order) * t ** (degree - order)
            found[order, mine] = total
    return found


def harmonic(x: Array) -> Array:
    return np.array(
        [
            (1 - np.cos(PI * x)) / 2,
            PI / 2 * np.sin(PI * x),
            PI**2 / 2 * np.cos(PI * x),
            -(PI**3) / 2 * np.sin(PI * x),
        ]
    )


def cycloidal(x: Array) -> Array:
    turn = 2 * PI
    return np.array(
        [
            x - np.sin(turn * x) / turn,
            1 - np.cos(turn * x),
            turn * np.sin(turn * x),
            turn**2 * np.cos(turn * x),
        ]
    )


def polynomial_345(x: Array) -> Array:
    return np.array(
        [
            10 * x**3 - 15 * x**4 + 6 * x**5,
            30 * x**2 - 60 * x**3 + 30 * x**4,
            60 * x - 180 * x**2 + 120 * x**3,
            60 - 360 * x + 360 * x**2,
        ]
    )


def polynomial_4567(x: Array) -> Array:
    return np.array(
        [
            35 * x**4 - 84 * x**5 + 70 * x**6 - 20 * x**7,
            140 * x**3 - 420 * x**4 + 420 * x**5 - 140 * x**6,
            420 * x**2 - 1680 * x**3 + 2100 * x**4 - 840 * x**5,
            840 * x - 5040 * x**2 + 8400 * x**3 - 4200 * x**4,
        ]
    )


def modified_sine(x: Array) -> Array:
    k = 1 / (4 + PI)
    first = [
        k * (PI * x - np.sin(4 * PI * x) / 4),
        k * PI * (1 - np.cos(4 * PI * x)),
        4 * PI**2 * k * np.sin(4 * PI * x),
        16 * PI**3 * k * np.cos(4 * PI * x),
    ]
    angle = 4 * PI * x / 3 + PI / 3
    second = [
        k * (2 + PI * x - 9 / 4 * np.sin(angle)),
        k * PI * (1 - 3 * np.cos(angle)),
        4 * PI**2 * k * np.sin(angle),
        16 * PI**3 / 3 * k * np.cos(angle),
    ]
    third = [
        k * (4 + PI * x - np.sin(4 * PI * x) / 4),
        k * PI * (1 - np.cos(4 * PI * x)),
        4 * PI**2 * k * np.sin(4 * PI * x),
        16 * PI**3 * k * np.cos(4 * PI * x),
    ]
    return np.array(
        [
            np.select([x < 1 / 8, x < 7 / 8], [a, b], c)
            for a, b, c in zip(first, second, third, strict=True)
        ]
    )


def modified_trapezoid(x: Array) -> Array:
    """Integrated by hand from its acceleration; the second half mirrors the first."""
    peak = 8 * PI / (2 + PI)
    half = np.minimum(x, 1 - x)
    t, u = half - 1 / 8, half - 3 / 8
    speed_1 = peak / (4 * PI)
    place_1 = peak / (4 * PI) * (1 / 8 - 1 / (4 * PI))
    speed_2 = speed_1 + peak / 4
    place_2 = place_1 + speed_1 / 4 + peak / 32
    parts = [
        [
            peak / (4 * PI) * (half - np.sin(4 * PI * half) / (4 * PI)),
            peak / (4 * PI) * (1 - np.cos(4 * PI * half)),
            peak * np.sin(4 * PI * half),
            4 * PI * peak * np.cos(4 * PI * half),
        ],
        [
            place_1 + speed_1 * t + peak * t**2 / 2,
            speed_1 + peak * t,
            np.full_like(x, peak),
            np.zeros_like(x),
        ],
        [
            place_2 + speed_2 * u + peak / (16 * PI**2) * (1 - np.cos(4 * PI * u)),
            speed_2 + peak / (4 * PI) * np.sin(4 * PI * u),
            peak * np.cos(4 * PI * u),
            -4 * PI * peak * np.sin(4 * PI * u),
        ],
    ]
    s, v, a, j = (
        np.select([half < 1 / 8, half < 3 / 8], rows[:2], rows[2])
        for rows in zip(*parts, strict=True)
    )
    late = x > 1 / 2
    return np.array([np.where(late, 1 - s, s), v, np.where(late, -a, a), j])


BOOK: dict[str, Callable[[Array], Array]] = {
    "harmonic": harmonic,
    "cycloidal": cycloidal,
    "modified sine": modified_sine,
    "modified trapezoid": modified_trapezoid,
    "3-4-5": polynomial_345,
    "4-5-6-7": polynomial_4567,
}
#: Largest velocity and acceleration for a unit lift over a unit angle (Norton, table 3-4).
PEAKS = {
    "harmonic": (1.5708, 4.9348),
    "cycloidal": (2.0, 6.2832),
    "modified sine": (1.7596, 5.5280),
    "modified trapezoid": (2.0, 4.8881),
    "3-4-5": (1.875, 5.7735),
    "4-5-6-7": (2.1875, 7.5132),
}


def test_every_law_that_moves_has_a_formula_in_a_book() -> None:
    assert sorted(BOOK) == sorted(PEAKS) == sorted(MOVING)


@pytest.mark.parametrize("law", MOVING)
def test_displacement_velocity_acceleration_and_jerk_are_those_of_the_book(law: str) -> None:
    x = (np.arange(1000) + 0.5) / 1000  # beside the joints, where jerk jumps
    found, wanted = derivatives(law, x), BOOK[law](x)
    for order in range(4):
        size = np.abs(wanted[order]).max()
        np.testing.assert_allclose(found[order], wanted[order], rtol=0, atol=1e-13 * size)


@pytest.mark.parametrize("law", MOVING)
def test_largest_velocity_and_acceleration_are_those_of_the_book(law: str) -> None:
    x = np.linspace(0, 1, 100_001)
    _, velocity, acceleration, _ = derivatives(law, x)
    # four decimals are printed
    assert np.abs(velocity).max() == pytest.approx(PEAKS[law][0], rel=0, abs=5.1e-5)
    assert np.abs(acceleration).max() == pytest.approx(PEAKS[law][1], rel=0, abs=5.1e-5)


@pytest.mark.parametrize("law", MOVING)
def test_a_law_leads_from_0_to_1_and_rests_at_both_ends(law: str) -> None:
    ends = derivatives(law, np.array([0.0, 1.0]))
    np.testing.assert_allclose(ends[0], [0.0, 1.0], rtol=0, atol=1e-14)
    np.testing.assert_allclose(ends[1], [0.0, 0.0], rtol=0, atol=1e-13)
    if law != "harmonic":  # which starts with a jerk
        np.testing.assert_allclose(ends[2], [0.0, 0.0], rtol=0, atol=1e-12)


@pytest.mark.parametrize("law", MOVING)
def test_pieces_of_a_law_meet_in_displacement_velocity_and_acceleration(law: str) -> None:
    pieces = pieces_of(law)
    assert sum(piece.over for piece in pieces) == 1.0
    for before, after in pairwise(pieces):
        for order in range(3):
            left, right = (
                sum(
                    c * math.perm(k, order) * t ** (k - order)
                    for k, c in enumerate(piece.powers)
                    if k >= order
                )
                + piece.sine[0]
                * piece.sine[1] ** order
                * math.sin(piece.sine[1] * t + piece.sine[2] + order * PI / 2)
                for piece, t in ((before, before.over), (after, 0.0))
            )
            assert left == pytest.approx(right, rel=0, abs=1e-13)


def test_a_dwell_moves_nothing() -> None:
    x = np.linspace(0, 1, 7)
    np.testing.assert_array_equal(derivatives("dwell", x), np.zeros((4, 7)))


# ------------------------------------------------------------------ programs of several laws


def test_a_program_does_each_law_over_its_angle_by_its_lift() -> None:
    overs, lifts = [1.0, 0.5, 2.0, 2 * PI - 3.5], [8.0, 0.0, -11.0, 3.0]
    laws = ["modified trapezoid", "dwell", "cycloidal", "modified sine"]
    motion = program(list(zip(laws, overs, lifts, strict=True)))
    begin, height = 0.0, 0.0
    for law, over, lift in zip(laws, overs, lifts, strict=True):
        x = (np.arange(50) + 0.5) / 50
        s, s1, s2 = motion.jet(begin + over * x)
        book = BOOK[law](x) if law in BOOK else np.zeros((4, 50))
        np.testing.assert_allclose(s, height + lift * book[0], rtol=0, atol=1e-12)
        np.testing.assert_allclose(s1, lift * book[1] / over, rtol=0, atol=1e-11)
        np.testing.assert_allclose(s2, lift * book[2] / over**2, rtol=0, atol=1e-10)
        begin, height = begin + over, height + lift


@pytest.mark.parametrize("off", [1e-9, -3e-10])
def test_a_program_that_nearly_closes_is_smooth_where_it_repeats_itself(off: float) -> None:
    over = [PI, PI + off]
    motion = program([("harmonic", over[0], 5.0), ("harmonic", over[1], -5.0 * (1 + off))])
    assert motion.breaks[-1] == 2 * PI
    eps = 1e-13
    before, after = motion.jet(np.array([-eps])), motion.jet(np.array([eps]))
    assert before[0] == pytest.approx(after[0], rel=0, abs=1e-14)
    # a harmonic return ends with acceleration: cut short, its slope would jump by 2.5 · 1e-9
    assert before[1] == pytest.approx(after[1], rel=0, abs=1e-11)
    assert motion.gaps[0] < 1e-13


def test_lifts_whose_sum_is_rounded_bring_the_follower_back_exactly() -> None:
    third = 2 * PI / 3
    motion = program([("3-4-5", third, 0.1), ("3-4-5", third, 0.2), ("3-4-5", third, -0.3)])
    assert 0.1 + 0.2 - 0.3 != 0.0
    assert motion(np.array([0.0]))[0] == 0.0
    assert motion.gaps[0] < 1e-14
