"""Bounds of numbers of solutions: values, and where a bound does not hold."""

from __future__ import annotations

import math

import numpy as np
import pytest

from linkwork.circuits.homotopy import isolated_roots as roots_module
from linkwork.circuits.homotopy.bilinear_homotopy import StartHomotopy, distinct_solutions
from linkwork.circuits.homotopy.counts import (
    Products,
    Theorem,
    bound_by_products,
    bound_by_sums,
    laman_number,
)
from linkwork.circuits.homotopy.isolated_roots import Structure, isolated_roots, structure_of
from linkwork.circuits.homotopy.path_tracking import CAREFUL, track
from linkwork.core.numerics.bilinear import columns_of, prove_roots, sums_hold
from tests.circuits.homotopy.bilinear_systems import angles_only
from tests.thinned import thinned


def products(turning: int, *along: int) -> Products:
    """Directions, and lengths along those given; the ground is the last column."""
    one = turning + len(along)
    rows = [(k, k, one, one) for k in range(turning)]
    rows += [(z, a, a, z) for z, a in enumerate(along, turning)]
    return tuple(zip(*rows, strict=True))


@pytest.mark.parametrize("loops", range(1, 7))
def test_without_lengths_the_bound_is_the_number_of_bezout(loops: int) -> None:
    assert bound_by_products(products(2 * loops)).number == math.comb(2 * loops, loops)


@pytest.mark.parametrize(
    ("turning", "along", "bound"),
    [
        (2, (), 2), (1, (2,), 2), (1, (0,), 2), (0, (2, 2), 1),
        (3, (4,), 6), (2, (4, 4), 4), (1, (4, 4, 4), 2), (0, (4, 4, 4, 4), 1),
        (2, (0, 1), 6), (2, (0, 0), 4), (1, (4, 0, 0), 4),
        (4, (6, 6), 14), (3, (6, 6, 6), 8), (2, (6, 6, 0, 0), 10),
    ],
)  # fmt: skip
def test_bounds_of_systems_with_lengths_are_reached(
    turning: int, along: tuple[int, ...], bound: int
) -> None:
    rows = products(turning, *along)
    assert bound_by_products(rows).number == bound
    loops = len(rows[0]) // 2
    if loops > 1:
        free = tuple(tuple(int(i == j) for j in range(loops)) for i in range(loops))
        structure = Structure(rows=rows, columns=(free,) * (2 * loops + 1))
        system = structure.random(np.random.default_rng(0))
        assert len(isolated_roots(system, structure).x) == bound


def test_the_sharper_bound_is_taken_and_named() -> None:
    rows, free, flat = products(2, 4, 4), ((1, 0), (0, 1)), ((1,), (1,))
    dense = Structure(rows=rows, columns=(free,) * 5)
    plane = Structure(rows=rows, columns=(free, free, flat, flat, free))
    assert (dense.bound(0).number, dense.bound(0).theorem) == (4, Theorem.BEZOUT)
    assert (plane.bound(0).number, plane.bound(0).theorem) == (2, Theorem.LAMAN)
    assert plane.complete(2)
    assert not plane.complete(3)


def test_no_bound_where_lengths_of_zero_make_the_closures_dependent() -> None:
    """Two more solutions have lengths zero, which general ratios of U_z and V_z do not see."""
    rows = products(1, 0, 0, 4)
    columns = (((1,), (0,)), ((1,), (0,)), ((1,), (-1,)), ((0,), (-1,)), ((1,), (0,)))
    structure = Structure(rows=rows, columns=columns)
    assert laman_number(columns, [(1, 0), (2, 0), (3, 4)]) == 2
    assert len(isolated_roots(structure.random(np.random.default_rng(3)), structure).x) == 4
    assert bound_by_sums(rows, columns) is None


def test_sums_have_to_hold_within_rounding() -> None:
    a, b = 1.3 - 0.2j, 0.7 + 2.1j
    closures = np.array([[a, 1.0], [b, 0.0], [a + b, 1.0]])
    columns = columns_of(closures)
    assert columns[0] == ((1, 0), (0, 1), (1, 1))
    rounding = 4e-16 * np.abs(closures)
    assert sums_hold(columns, closures, rounding)
    for entry in ((2, 0), (1, 1)):
        near = closures.copy()
        near[entry] += 1e-13
        assert columns_of(near) == columns
        assert not sums_hold(columns, near, rounding)
        # what is known badly is no reason to believe in a sum
        assert not sums_hold(columns, near, rounding + 1e-9)
    off = closures.copy()
    off[2, 0] *= 1.0 + 1e-15  # rounded, but the numbers are said to be exact
    assert not sums_hold(columns, off, 0.0 * rounding)


@pytest.mark.parametrize("seed", thinned(range(30)))
def test_systems_of_small_integers_have_no_more_solutions_than_their_bound(seed: int) -> None:
    """Parallel, equal and congruent links by the dozen; solutions from products of forms."""
    rng = np.random.default_rng(seed)
    loops = int(rng.choice([2, 3]))
    shape = (loops, 2 * loops)
    closures = rng.integers(-2, 3, shape) + 1j * rng.integers(-1, 2, shape)
    closures *= rng.random(shape) < 0.75
    known = rng.integers(-3, 4, loops) + 1j * rng.integers(-3, 4, loops)
    if np.linalg.matrix_rank(np.column_stack([closures, known])) < loops:
        pytest.skip("dependent closures")
    system = angles_only(closures, known)
    start = StartHomotopy.of(system, rng)
    ends = roots_module._classify_ends(system, start, track(start, start.starts(), CAREFUL))
    x = distinct_solutions(ends.x[ends.regular])
    rounding = 1e-16 * np.abs(system.left)
    proofs = prove_roots(system, x, rounding)
    bound = structure_of(system).bound_of(system, rounding, len(x))
    assert not proofs.apart or proofs.holds.sum() <= bound.number
    if proofs.apart and proofs.holds.sum() == bound.number:
        assert not (ends.singular | ends.lost).any()
