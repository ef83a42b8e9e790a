"""Where solutions begin to exist: located to rounding, on the right side, or not claimed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from linkwork.core.numerics.change_point import Fold, FoldFamily, locate_fold
from linkwork.core.numerics.decomposition import JoinedBlocks
from linkwork.core.numerics.newton import nearest_miss
from linkwork.core.table.loop_table import LoopTable
from tests.core.numerics.systems import blocks_of, loop_table

Array = npt.NDArray[np.float64]


def dyad(a: float, b: float) -> LoopTable:
    """a e^{iθ1} + b e^{iθ2} - 10 e^{iφ} = 0."""
    return loop_table([(0, a, 0), (0, b, 1), (0, -10.0, 2)], 2, 1, 10.0)


def fold_of(b: float, begin: float, inputs: Array) -> Fold | None:
    """The length a at which the dyad with b begins to close, searched from ``begin``."""

    def at(a: float) -> JoinedBlocks:
        return JoinedBlocks(blocks_of(dyad(a, b)), [0])

    start = np.array([0.3, -0.4, *inputs])
    if begin + b > 10.0:
        start[int(begin > b)] += math.pi
    x, _ = nearest_miss(dyad(begin, b), start)
    family = FoldFamily(
        at=at, inputs=inputs, low=at(begin - 1e-5), high=at(begin + 1e-5), step=2e-5, size=10.0
    )
    return locate_fold(family, x[:2], begin)


@pytest.mark.parametrize(
    ("b", "begin", "needed", "opens"),
    [(4.0, 5.0, 6.0, 1.0), (1.25, 14.0, 11.25, -1.0), (17.0, 2.0, 7.0, 1.0), (3.0, 0.5, 7.0, 1.0)],
)
@pytest.mark.parametrize("phi", [0.0, 2.5])
def test_the_length_that_just_closes_a_dyad(
    b: float, begin: float, needed: float, opens: float, phi: float
) -> None:
    fold = fold_of(b, begin, np.array([phi]))
    assert fold is not None
    assert fold.p == pytest.approx(needed, rel=1e-14)
    assert (fold.opens, fold.checked) == (opens, True)
    closed = fold.p * np.exp(1j * fold.x[0]) + b * np.exp(1j * fold.x[1]) - 10 * np.exp(1j * phi)
    assert abs(closed) < 1e-12
    assert math.sin(fold.x[0] - fold.x[1]) == pytest.approx(0.0, abs=1e-7)  # both in line


def test_a_parameter_that_changes_nothing_has_no_fold() -> None:
    system = JoinedBlocks(blocks_of(dyad(4.0, 3.0)), [0])
    x, _ = nearest_miss(dyad(4.0, 3.0), np.array([0.3, -0.2, 0.0]))
    family = FoldFamily(
        at=lambda p: system, inputs=np.zeros(1), low=system, high=system, step=1.0, size=10.0
    )
    assert locate_fold(family, x[:2], 1.0) is None


def test_a_family_that_ends_before_its_fold_has_none() -> None:
    def at(a: float) -> JoinedBlocks:
        if a > 5.5:
            raise ValueError("no such mechanism")
        return JoinedBlocks(blocks_of(dyad(a, 4.0)), [0])

    x, _ = nearest_miss(dyad(5.0, 4.0), np.array([0.3, -0.2, 0.0]))
    family = FoldFamily(
        at=at, inputs=np.zeros(1), low=at(4.99), high=at(5.01), step=0.02, size=10.0
    )
    assert locate_fold(family, x[:2], 5.0) is None
    whole = replace(family, at=lambda a: JoinedBlocks(blocks_of(dyad(a, 4.0)), [0]))
    fold = locate_fold(whole, x[:2], 5.0)
    assert fold is not None
    assert fold.p == pytest.approx(6.0, rel=1e-14)
