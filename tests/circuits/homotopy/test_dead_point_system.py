"""Dead points as polynomials: derivatives, starts, and a closed form."""

from __future__ import annotations

import numpy as np
import pytest

from linkwork.circuits.homotopy import isolated_roots as roots_module
from linkwork.circuits.homotopy.bilinear_homotopy import polish_roots
from linkwork.circuits.homotopy.dead_point_family import DeadPointFamily, dead_point_roots
from linkwork.circuits.homotopy.dead_points import DeadPointSystem

#: Own rates of a dyad: of two links; of a link and a length on a fixed line (third column: one).
LINKS = ((0, 0, 0, 1.0, 1.0), (1, 1, 1, 1.0, 1.0))
SLIDER = ((0, 0, 0, 1.0, 1.0), (2, 3, 1, 1.0, -1.0))


def four_bar(r1: complex, r2: complex, r3: complex, r4: complex) -> DeadPointSystem:
    """Coupler, rocker, crank."""
    left = np.array([[r3, -r4, r2, -r1]], dtype=complex)
    k, one = np.arange(3), np.full(3, 3)
    return DeadPointSystem(
        left=left, right=left.conj(), rows=np.array([k, k, one, one]), own=1, slots=LINKS
    )


def six_bar(seed: int) -> DeadPointSystem:
    """A platform on three legs, one of them on the crank: random closures."""
    rng = np.random.default_rng(seed)
    legs = rng.uniform(0.5, 2.0, 4)
    plate = rng.normal(size=2) + 1j * rng.normal(size=2)
    ground = rng.normal(size=2) + 1j * rng.normal(size=2)
    left = np.array(
        [
            [legs[0], -legs[1], 0, plate[0], legs[3], ground[0]],
            [legs[0], 0, -legs[2], plate[1], legs[3], ground[1]],
        ]
    )
    k, one = np.arange(5), np.full(5, 5)
    slots = tuple((d, d, d, 1.0, 1.0) for d in range(4))
    rows = np.array([k, k, one, one])
    return DeadPointSystem(left=left, right=left.conj(), rows=rows, own=2, slots=slots)


def test_jacobian_is_the_derivative_of_the_residual() -> None:
    slider = DeadPointSystem(
        left=np.array([[1.0, 0.5, -1.0, 0.2j]]),
        right=np.array([[1.0, 0.5, -1.0, -0.2j]]),
        rows=np.array([[0, 1, 2], [0, 1, 3], [3, 3, 3], [3, 3, 2]]),
        own=1,
        slots=SLIDER,
    )
    rng = np.random.default_rng(1)
    for system in (four_bar(4, 1, 3, 2.5), slider, six_bar(0)):
        size = 2 * system.size + 2 * system.own
        x = rng.normal(size=(2, size)) + 1j * rng.normal(size=(2, size))
        f, jacobian = system.residual_and_jacobian(x)
        assert f.shape == (2, size)
        assert jacobian.shape == (2, size, size)
        for k in range(size):
            step = 1e-6 * np.eye(size)[k]
            ahead, behind = (system.residual_and_jacobian(x + s * step)[0] for s in (1, -1))
            np.testing.assert_allclose((ahead - behind) / 2e-6, jacobian[:, :, k], atol=1e-8)


@pytest.mark.parametrize("kind", ["products", "relative"])
def test_homotopies_give_their_own_derivatives(kind: str) -> None:
    system, rng = six_bar(1), np.random.default_rng(4)
    family = DeadPointFamily.of(system)
    homotopy = (
        family.from_products(system, rng)
        if kind == "products"
        else family.between(family.random(rng), system, rng)
    )
    size = homotopy.patches.shape[1]
    w = rng.normal(size=(3, size)) + 1j * rng.normal(size=(3, size))
    sigma, h = np.array([0.2, 0.5, 0.9]), 1e-6
    _, jacobian, rate = homotopy.evaluate(w, sigma)
    assert jacobian.shape == (3, size, size)
    for k in range(size):
        e = np.eye(size)[k] * h
        change = homotopy.evaluate(w + e, sigma)[0] - homotopy.evaluate(w - e, sigma)[0]
        np.testing.assert_allclose(change / (2 * h), jacobian[:, :, k], rtol=0, atol=1e-6)
    change = homotopy.evaluate(w, sigma + h)[0] - homotopy.evaluate(w, sigma - h)[0]
    np.testing.assert_allclose(change / (2 * h), rate, rtol=0, atol=1e-6)


def test_starts_are_as_many_as_can_exist_and_solve_the_start() -> None:
    for system, count in ((four_bar(4, 1, 3, 2.5), 6), (six_bar(2), 40)):
        start = DeadPointFamily.of(system).from_products(system, np.random.default_rng(0))
        w = start.starts()
        assert len(w) == count == system.bound
        assert np.abs(start.evaluate(w, np.ones(count))[0]).max() < 1e-11
        apart = np.abs(w[:, None] - w[None]).max(axis=2) + np.eye(count)
        assert apart.min() > 1e-6


def test_a_relative_starts_where_the_other_one_ended() -> None:
    family = DeadPointFamily.of(six_bar(3))
    rng = np.random.default_rng(5)
    other = family.random(rng)
    x = dead_point_roots(other).x
    homotopy = family.between(other, six_bar(3), rng)
    w = homotopy.starts(x)
    # phases of the closures turn with the start, so it is the start's own equations that hold
    assert np.abs(homotopy.evaluate(w, np.ones(len(w)))[0]).max() < 1e-9
    np.testing.assert_allclose(homotopy.points(w)[0], x, rtol=0, atol=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_four_bars_lock_where_coupler_and_rocker_are_in_line(seed: int) -> None:
    rng = np.random.default_rng(seed)
    r1, r2, r3, r4 = rng.uniform(0.3, 3.0, 4)
    roots = dead_point_roots(four_bar(r1, r2, r3, r4))
    assert (len(roots.x), roots.expected, roots.failed, roots.sure) == (4, 4, 0, True)
    cosine = 0.5 * (roots.x[:, 2] + roots.x[:, 5])  # t and its partner; not conjugate if unreal
    theory = [(r1 * r1 + r2 * r2 - (r3 + s * r4) ** 2) / (2 * r1 * r2) for s in (1, -1)]
    np.testing.assert_allclose(
        np.sort(cosine.real), np.sort([*theory, *theory]), rtol=1e-11, atol=1e-11
    )
    assert np.abs(cosine.imag).max() < 1e-11


@pytest.mark.parametrize("seed", range(10))
def test_random_six_bars_have_24_complex_dead_points(seed: int) -> None:
    system = six_bar(seed)
    roots = dead_point_roots(system)
    assert (len(roots.x), roots.paths, roots.expected) == (24, 24, 24)
    assert (roots.failed, roots.singular, roots.sure, roots.continuum) == (0, 0, True, False)
    assert np.abs(system.residual_and_jacobian(roots.x)[0]).max() < 1e-9
    # complex ones come in mirror images
    mirrored = np.concatenate([roots.x[:, 5:10], roots.x[:, :5]], axis=1).conj()
    gaps = np.abs(mirrored[:, None] - roots.x[None, :, :10]).max(axis=2).min(axis=1)
    assert (gaps < 1e-7 * (1 + np.abs(mirrored).max(axis=1))).all()


def test_where_nothing_locks_every_path_runs_to_infinity() -> None:
    """Two lengths on fixed lines follow the crank without a dead point."""
    system = DeadPointSystem(
        left=np.array([[1.0, 1j, -1.0, 0.3]]),
        right=np.array([[1.0, -1j, -1.0, 0.3]]),
        rows=np.array([[0, 1, 2], [3, 3, 2], [3, 3, 3], [0, 1, 3]]),
        own=1,
        slots=((0, 3, 0, 1.0, -1.0), (1, 3, 1, 1.0, -1.0)),
    )
    roots = dead_point_roots(system)
    assert (len(roots.x), roots.expected, roots.failed, roots.sure) == (0, 0, 0, True)


def test_every_run_gives_the_same_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    first = dead_point_roots(six_bar(8)).x
    dead_point_roots(six_bar(9))
    monkeypatch.setattr(roots_module, "_KNOWN", {})
    assert np.array_equal(dead_point_roots(six_bar(8)).x, first)


def test_a_dead_point_is_reached_from_nearby() -> None:
    roots = dead_point_roots(six_bar(4))
    back, steps = polish_roots(six_bar(4), roots.x * (1 + 1e-6))
    assert (steps > 0).all()
    np.testing.assert_allclose(back, roots.x, rtol=0, atol=1e-8 * np.abs(roots.x).max())
