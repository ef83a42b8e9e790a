"""Newton-Raphson: order of convergence, every exit, batches, the turn limit; the nearest miss."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from linkwork.core.foundation.statuses import Status
from linkwork.core.numerics.newton import NewtonOptions, SolvedRows, nearest_miss, newton
from linkwork.core.table.loop_table import LoopTable
from tests.core.numerics.systems import Cubic, four_bar_table, loop_table, watt_table
from tests.oracles.four_bar import FourBar, random_crank_rockers

Array = npt.NDArray[np.float64]


def four_bars(count: int, seed: int) -> list[tuple[LoopTable, Array]]:
    """Random crank-rockers, each at a random position."""
    rng = np.random.default_rng(seed)
    found = []
    for bar in random_crank_rockers(count, seed + 1):
        theta = rng.uniform(0, 2 * math.pi)
        e3, e4 = bar.phasors(np.array(theta), 1)
        found.append((four_bar_table(bar), np.array([np.angle(e3), np.angle(e4), theta])))
    return found


def six_links(count: int, seed: int) -> list[tuple[LoopTable, Array]]:
    """Random pairs of coupled loops; the two fixed vectors close them at a random position."""
    rng = np.random.default_rng(seed)
    found: list[tuple[LoopTable, Array]] = []
    while len(found) < count:
        root = rng.uniform(-math.pi, math.pi, 5)
        c = rng.normal(size=10) + 1j * rng.normal(size=10)
        e = np.exp(1j * root)
        c[4] = -(c[0] * e[0] + c[1] * e[1] + c[2] * e[2] + c[3] * e[4])
        c[9] = -(c[5] * e[1] + c[6] * e[2] + c[7] * e[3] + c[8] * e[4])
        table = watt_table(c)
        if np.linalg.cond(table.jacobian(root[None])[0][:, :4]) < 30:  # regular positions
            found.append((table, root))
    return found


def away_from(root: Array, n: int, size: float, rng: np.random.Generator) -> Array:
    direction = rng.normal(size=n)
    start = root.copy()
    start[:n] += size * direction / np.abs(direction).max()
    return start


def last_three(table: LoopTable, root: Array, start: Array) -> float:
    """log e2/e1 over log e1/e0 for the last three errors above 1e-11; NaN if there are fewer."""
    errors: list[float] = []

    def watch(k: int, v: Array, f: Array, change: Array | None) -> None:
        errors.append(float(np.abs(v[0] - root).max()))

    newton(table, start[None], NewtonOptions(largest_turn=math.inf), watch)
    above = [e for e in errors if e > 1e-11][-3:]
    if len(above) < 3:
        return math.nan
    return math.log(above[2] / above[1]) / math.log(above[1] / above[0])


BATCHES = {"four-bars": four_bars(200, 11), "six-links": six_links(100, 21)}


@pytest.mark.parametrize("kind", BATCHES)
def test_the_last_three_iterates_show_order_two(kind: str) -> None:
    # the constant of quadratic convergence depends on the direction of the error, which turns
    # from step to step: single runs scatter around two, their median does not
    rng = np.random.default_rng(31)
    found = [
        last_three(table, root, away_from(root, table.unknowns, 0.03, rng))
        for table, root in BATCHES[kind]
    ]
    assert np.isfinite(found).mean() > 0.9
    assert np.nanmedian(found) >= 1.95
    assert np.nanquantile(found, 0.1) >= 1.7


@pytest.mark.parametrize("kind", BATCHES)
def test_one_step_from_half_as_far_leaves_a_quarter_of_the_error(kind: str) -> None:
    # the same direction at two distances: here every single mechanism shows the order
    rng = np.random.default_rng(32)
    one = NewtonOptions(max_steps=1, largest_turn=math.inf)
    for table, root in BATCHES[kind]:
        far = away_from(root, table.unknowns, 1e-3, rng)
        both = np.stack([far, (far + root) / 2])
        done = newton(table, both, one)
        errors = np.abs(done.v - root).max(axis=1)
        assert math.log2(errors[0] / errors[1]) >= 1.9


# x³ + p x + q from x0: (x0, p, q), exit
LANES: list[tuple[tuple[float, float, float], Status]] = [
    ((3.0, 0.0, -8.0), Status.CONVERGED),
    ((1.0, -3.0, 3.0), Status.SINGULAR_JACOBIAN),
    ((1.0 + 1e-12, -3.0, 3.0), Status.DIVERGED),
    ((0.0, -2.0, 2.0), Status.STEP_LIMIT),
    ((2.0, 0.0, -8.0), Status.CONVERGED),
    ((math.nan, 0.0, -8.0), Status.DIVERGED),
    ((-2.0, -2.0, 2.0), Status.CONVERGED),
]
START = np.array([lane for lane, _ in LANES])


def test_every_exit_is_reached_in_one_batch() -> None:
    done = newton(Cubic(), START)
    assert [Status.of_code(int(code)) for code in done.status] == [status for _, status in LANES]
    # x = 2 is where two lanes end, one of them without a step; the third is Cardano's root
    h = math.sqrt(1 - 8 / 27)
    cardano = -math.cbrt(1 + h) - math.cbrt(1 - h)
    roots = done.v[[0, 4, 6], 0]
    np.testing.assert_allclose(roots, [2.0, 2.0, cardano], rtol=1e-15)
    assert done.iterations[4] == 0
    assert done.iterations[1] == 0
    assert done.iterations[3] == NewtonOptions().max_steps
    assert done.residual[4] == 0.0
    assert done.residual[1] == 1.0  # x³ - 3x + 3 at its minimum
    np.testing.assert_array_equal(done.v[:, 1:], START[:, 1:])  # inputs are left alone


def same(one: SolvedRows, lane: int, many: SolvedRows, atol: float) -> None:
    assert len(many.columns) == 6
    for name, batch in many.columns.items():
        alone = one.columns[name][0]
        np.testing.assert_allclose(alone, batch[lane], rtol=0, atol=atol, err_msg=name)


def test_rows_of_a_batch_equal_the_same_rows_alone() -> None:
    many = newton(Cubic(), START)
    for lane in range(len(LANES)):
        same(newton(Cubic(), START[lane : lane + 1]), lane, many, atol=0.0)


def test_four_bar_rows_of_a_batch_equal_the_same_rows_alone() -> None:
    table = four_bar_table(FourBar(4.0, 2.0, 5.0, 2.0))
    rng = np.random.default_rng(3)
    start = rng.uniform(-math.pi, math.pi, (40, 3))
    many = newton(table, start)
    assert len(set(many.status.tolist())) >= 2  # out of reach below acos(11/16)
    found = many.status == Status.CONVERGED.code
    assert 0 < found.sum() < len(start)
    for lane in np.flatnonzero(found):
        # matrix products round differently by batch size; a regular root forgets it
        same(newton(table, start[lane : lane + 1]), int(lane), many, atol=1e-9)


def test_two_tolerances_stop_the_iteration() -> None:
    start = np.array([[3.0, 0.0, -8.0]])
    loose = newton(Cubic(), start, NewtonOptions(equation_tolerance=1e-2, solution_tolerance=0.0))
    assert 1e-14 < loose.residual[0] <= 1e-2
    short = newton(Cubic(), start, NewtonOptions(equation_tolerance=0.0, solution_tolerance=0.3))
    tight = newton(Cubic(), start, NewtonOptions(equation_tolerance=0.0, solution_tolerance=1e-11))
    assert short.status[0] == tight.status[0] == Status.CONVERGED.code
    # 3 → 2.296 → 2.037 → 2.0007: the second change, 0.259, is the first below 0.3
    assert short.iterations[0] == 2
    assert tight.iterations[0] > 4


def test_first_step_and_contraction_are_measured() -> None:
    done = newton(Cubic(), np.array([[3.0, 0.0, -8.0]]))
    steps = [19 / 27]
    x = 3 - 19 / 27
    steps.append((x**3 - 8) / (3 * x * x))
    assert done.first_step[0] == pytest.approx(steps[0], rel=1e-14)
    assert done.contraction[0] == pytest.approx(steps[1] / steps[0], rel=1e-13)


def test_no_angle_turns_further_than_the_limit_and_the_direction_is_kept() -> None:
    table = four_bar_table(FourBar(4.0, 2.0, 5.0, 3.5))
    start = np.array([[-2.0, 2.9, 1.0]])
    limit = math.radians(40)
    bare: list[Array] = []
    short: list[Array] = []

    def keep(into: list[Array]) -> Callable[[int, Array, Array, Array | None], None]:
        def watch(k: int, v: Array, f: Array, change: Array | None) -> None:
            if change is not None:
                into.append(change[0].copy())

        return watch

    newton(table, start, NewtonOptions(largest_turn=math.inf), keep(bare))
    newton(table, start, NewtonOptions(), keep(short))
    assert np.abs(bare[0]).max() > 1.5 * limit  # the limit matters here
    assert np.abs(short[0]).max() == pytest.approx(limit, rel=1e-14)
    assert max(np.abs(change).max() for change in short) <= limit * (1 + 1e-14)
    np.testing.assert_allclose(short[0] / limit, bare[0] / np.abs(bare[0]).max(), rtol=1e-13)


def test_turn_limit_counts_angles_and_leaves_lengths_alone() -> None:
    # e^{iφ} + 3 e^{iθ} - s = 0: a block 50 away comes back in one step that turns the rod little
    table = loop_table([(0, 1.0, 2), (0, 3.0, 0), (0, -1.0, None)], 2, 1, 3.0)
    slides = replace(table.loops, length=np.array([-1, -1, 1]))
    table = replace(table, loops=slides, is_angle=np.array([True, False, True]))
    start = np.array([[-0.2, 53.0, 0.5]])
    done = newton(table, start)
    bare = newton(table, start, NewtonOptions(largest_turn=math.inf))
    assert done.first_step[0] > 49.0
    same(done, 0, bare, atol=0.0)
    s = math.cos(0.5) + math.sqrt(9 - math.sin(0.5) ** 2)
    assert done.v[0, 1] == pytest.approx(s, rel=1e-14)


def dyad(a: float, b: float) -> LoopTable:
    """a e^{iθ1} + b e^{iθ2} - 10 e^{iφ} = 0."""
    return loop_table([(0, a, 0), (0, b, 1), (0, -10.0, 2)], 2, 1, 10.0)


@pytest.mark.parametrize(
    ("a", "b", "gap"), [(4.0, 5.0, 1.0), (7.5, 1.25, 1.25), (16.0, 3.0, 3.0), (2.0, 12.5, 0.5)]
)
def test_nearest_miss_of_a_dyad_too_short_or_too_long_is_the_exact_gap(
    a: float, b: float, gap: float
) -> None:
    rng = np.random.default_rng(5)
    for _ in range(20):
        start = np.array([*rng.uniform(-1.2, 1.2, 2), 0.0])
        start[2] = rng.uniform(-0.3, 0.3)
        if a + b > 10.0:  # folded: the shorter arm points the other way
            start[int(a > b)] += math.pi
        _, f = nearest_miss(dyad(a, b), start)
        # the gap is stationary at the minimum: an angle error of 1e-7 changes it by 1e-14
        assert math.hypot(*f) == pytest.approx(gap, rel=1e-12)


def test_nearest_miss_of_loops_that_close_is_a_position() -> None:
    v, f = nearest_miss(dyad(6.0, 7.0), np.array([1.0, -1.0, 0.2]))
    assert math.hypot(*f) < 1e-12
    closed = 6.0 * np.exp(1j * v[0]) + 7.0 * np.exp(1j * v[1]) - 10.0 * np.exp(0.2j)
    assert abs(closed) < 1e-12
