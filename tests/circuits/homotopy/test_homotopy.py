"""Following paths: what arrives, what ends where solutions meet, what runs to infinity."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from linkwork.circuits.homotopy.path_tracking import (
    ARRIVED,
    BOLD,
    CAREFUL,
    LOST,
    SINGULAR,
    PathOptions,
    track,
)
from linkwork.core.foundation.arrays import AnyArray, Array, ComplexArray

Right = Callable[[Array], tuple[AnyArray, AnyArray]]  # real or complex


class Power:
    """wᵏ = c(σ), one equation; solutions at σ = 1 are the k-th roots of c(1)."""

    def __init__(self, k: int, right: Right) -> None:
        self.k, self.right = k, right

    def evaluate(
        self, w: ComplexArray, sigma: Array
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        value, rate = self.right(sigma)
        return (
            w**self.k - value[:, None],
            (self.k * w ** (self.k - 1))[:, :, None],
            -rate[:, None] + 0j,
        )


def _roots(k: int) -> np.ndarray:
    return np.asarray(np.exp(2j * np.pi * np.arange(k) / k)[:, None])


@pytest.mark.parametrize("options", [PathOptions(), BOLD, CAREFUL])
def test_every_path_arrives_at_its_own_root(options: PathOptions) -> None:
    turn = Power(3, lambda s: (np.exp(1j * (1 - s)), -1j * np.exp(1j * (1 - s))))
    paths = track(turn, _roots(3), options)
    assert (paths.state == ARRIVED).all()
    np.testing.assert_allclose(paths.w, _roots(3) * np.exp(1j / 3), rtol=0, atol=1e-6)


def test_care_costs_steps() -> None:
    turn = Power(5, lambda s: (np.exp(4j * (1 - s)), -4j * np.exp(4j * (1 - s))))
    assert track(turn, _roots(5), BOLD).steps < track(turn, _roots(5), CAREFUL).steps


@pytest.mark.parametrize("k", [2, 3, 5])
def test_paths_that_meet_at_the_end_are_singular_and_near_the_meeting(k: int) -> None:
    meeting = Power(k, lambda s: (s + 0j, np.ones_like(s)))
    paths = track(meeting, _roots(k))
    assert (paths.state == SINGULAR).all()
    assert np.abs(paths.w).max() <= 1.01 * 1e-10 ** (1 / k)
    assert np.abs(paths.near).max() <= 1.01 * 1e-4 ** (1 / k)


def test_a_path_through_a_meeting_is_lost_not_guessed() -> None:
    # w² = (σ - 0.4)³: at σ = 0.4 both paths meet, and the straight way leads no further
    halt = Power(2, lambda s: ((s - 0.4) ** 3 / 0.216 + 0j, 3 * (s - 0.4) ** 2 / 0.216))
    paths = track(halt, _roots(2), CAREFUL)
    assert set(paths.state.tolist()) <= {LOST, ARRIVED}
    reached = paths.w[paths.state == ARRIVED]
    np.testing.assert_allclose(reached**2, -(0.4**3) / 0.216 * np.ones_like(reached), atol=1e-6)


def test_no_paths_are_no_trouble() -> None:
    paths = track(Power(2, lambda s: (s + 0j, np.ones_like(s))), np.zeros((0, 1), dtype=complex))
    assert len(paths.w) == 0
