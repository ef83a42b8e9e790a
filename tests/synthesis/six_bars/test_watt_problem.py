"""Equations of Watt-II six-bars: derivatives, random members, start set."""

from __future__ import annotations

import numpy as np
import pytest

from linkwork.circuits.homotopy.bilinear_homotopy import normal_numbers
from linkwork.circuits.homotopy.path_tracking import ParameterPath
from linkwork.synthesis.six_bars import WATT, bell_crank_turns


def test_derivatives_are_those_of_the_equations() -> None:
    rng = np.random.default_rng(1)
    start, goal = WATT.random_parameters(rng), WATT.random_parameters(rng)
    path = ParameterPath(system=WATT, start=start, goal=goal)
    w = normal_numbers(rng, 2, WATT.unknowns)
    sigma, step = np.array([0.3, 0.6]), 1e-6
    _, jacobian, change = path.evaluate(w, sigma)
    for k in range(WATT.unknowns):
        aside = np.zeros(WATT.unknowns)
        aside[k] = step
        ahead, behind = (path.evaluate(w + s * aside, sigma)[0] for s in (1.0, -1.0))
        slope = (ahead - behind) / (2.0 * step)
        assert slope == pytest.approx(jacobian[:, :, k], rel=1e-6, abs=1e-6)
    ahead, behind = (path.evaluate(w, sigma + s * step)[0] for s in (1.0, -1.0))
    assert (ahead - behind) / (2.0 * step) == pytest.approx(change, rel=1e-6, abs=1e-6)


def test_a_random_six_bar_solves_its_own_pairs_with_couplers_of_constant_length() -> None:
    c, z = WATT.random_member(np.random.default_rng(2))
    path = ParameterPath(system=WATT, start=c, goal=c)
    f, jacobian = path.residual_and_jacobian(z[None])
    assert np.abs(np.linalg.solve(jacobian[0], f[0])).max() < 1e-9
    u, v = c.reshape(-1, 2).T
    t = bell_crank_turns(z[None], u, v)[0]
    for at, turned in ((z[:4], u), (z[4:], v)):
        a, a_bar, b, b_bar = at
        # the far end of the coupler turns about the pivot at 1
        coupler = 1.0 + b * t - a * turned
        coupler_bar = 1.0 + b_bar / t - a_bar / turned
        start = (1.0 + b - a) * (1.0 + b_bar - a_bar)
        assert coupler * coupler_bar == pytest.approx(np.full(8, start), rel=1e-9)


def test_solutions_whose_bell_crank_rests_are_none() -> None:
    """With B at A0 and C at C0 any crank and rocker turn by any angles."""
    rng = np.random.default_rng(3)
    c, six_bar = WATT.random_member(rng)
    x = normal_numbers(rng, 3, WATT.unknowns)
    x[:, [2, 3, 6, 7]] = -1.0
    x[1, 6] = x[2, 2] = -0.9
    path = ParameterPath(system=WATT, start=c, goal=c)
    f, jacobian = path.residual_and_jacobian(x[:1])
    assert np.abs(f).max() < 1e-14
    assert np.linalg.matrix_rank(jacobian[0]) < WATT.unknowns
    assert list(WATT.proper(np.append(x, six_bar[None], axis=0), c)) == [False, True, True, True]
