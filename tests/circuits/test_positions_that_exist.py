"""The positions that exist at one input: dyads in closed form, others from many starts."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits.failure.reach import block_positions, positions_elsewhere
from tests.oracles.four_bar import FourBar
from tests.thinned import thinned

KINDS = {
    "RRR": ("a*e^(i*φ) + b*e^(i*x) = d + c*e^(i*y)", {"x": 20, "y": 80}),
    "RRP": ("a*e^(i*φ) + b*e^(i*x) = y + i*c", {"x": 20, "y": 3}),
    "RPR": ("a*e^(i*φ) = d + (y + i*c)*e^(i*x)", {"x": 120, "y": 3}),
    "PP": ("a*e^(i*φ) = x + y*(b + i*c)", {"x": 1, "y": 2}),
}


def kind_of(text: str, guess: dict[str, float], sizes: dict[str, float]) -> lw.Mechanism:
    used = {name: value for name, value in sizes.items() if name in text}
    return lw.loops(
        name="dyad",
        loops={"L": text},
        dimensions=used,
        guess={"φ": 40, **guess},
        inputs=lw.Input(variable="φ"),
    )


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", thinned(range(8), 8))
@pytest.mark.parametrize("order", [1, -1])
def test_a_dyad_has_the_positions_that_newton_finds_from_everywhere(
    kind: str, seed: int, order: int
) -> None:
    rng = np.random.default_rng(seed)
    text, guess = KINDS[kind]
    sizes = dict(zip("abcd", rng.uniform(0.5, 4, 4), strict=True))
    mechanism = kind_of(text, dict(list(guess.items())[::order]), sizes)
    model = mechanism.model
    block = model.compiled.solver.blocks[0]
    found = positions_elsewhere(model, model.start_inputs)
    assert found is not None
    assert found.complete
    assert len(found.v) in ((1,) if kind == "PP" else (0, 2))
    own, all_of_them = block_positions(block, model.equations.start)
    assert all_of_them
    assert len(own) == len(found.v)
    for x in own:
        away = [np.abs(np.exp(1j * (x - v[:2])) - 1).max() for v in found.v]
        assert min(away) < 1e-9
    residual = block.system.residual(found.v[:, block.variables])
    np.testing.assert_allclose(residual, 0, rtol=0, atol=1e-12)
    # from random guesses Newton finds these and no others
    for _ in range(5):
        values = {name: rng.uniform(-180, 180) for name in list(guess)[::order]}
        position = mechanism.changed(guess={"φ": 40, **values}).solve(certify=False)
        if position.status.ok:
            near = [np.abs(np.exp(1j * (position.q - v[:2])) - 1).max() for v in found.v]
            assert min(near) < 1e-8
        else:
            assert not len(own) or position.status is not lw.Status.CANNOT_CLOSE


def test_both_four_bar_positions_are_those_of_the_closed_form() -> None:
    bar = FourBar(100, 40, 120, 80)
    model = lw.example("four-bar").model
    found = positions_elsewhere(model, np.array([math.radians(30)]))
    assert found is not None
    assert found.complete
    phases = np.exp(1j * found.v[:, :2])
    for side in (1, -1):
        exact = np.array([complex(e) for e in bar.phasors(np.array(math.radians(30)), side)])
        assert np.abs(phases - exact).max(axis=1).min() < 1e-12


@pytest.mark.parametrize(
    ("name", "count", "complete"),
    [
        ("jansen-leg", 8, True),
        ("double-four-bar", 4, True),
        ("coupled-six-link", 6, True),
        ("stephenson-far-crank", 4, True),
        ("rapier-drive", 4, True),
    ],
)
def test_the_known_numbers_of_positions_are_found(name: str, count: int, complete: bool) -> None:
    model = lw.example(name).model
    found = positions_elsewhere(model, model.start_inputs)
    assert found is not None
    assert (len(found.v), found.complete) == (count, complete)
    residual = model.compiled.table.residual(found.v) / model.equations.length_scale
    np.testing.assert_allclose(residual, 0, rtol=0, atol=1e-10)


def test_a_pin_that_meets_its_pivot_has_a_position_for_every_angle_and_none_is_claimed() -> None:
    a = cmath.exp(1j)
    end = 1 + 2 * (a - 1)
    mechanism = lw.linkage(
        points={"O": (0, 0), "A": (a.real, a.imag), "Q": (1, 0), "P": (end.real, end.imag)},
        links={"ground": ["O", "Q"], "crank": ["O", "A"], "rocker": ["Q", "P"]},
        lengths={"O A": 1},
        slots=[lw.Slot(name="s", point="A", on="rocker", line=("Q", "P"))],
        inputs=lw.Input(link="crank"),
    )
    found = positions_elsewhere(mechanism.model, np.zeros(1))
    assert found is not None
    assert not found.complete
    assert found.v.shape == (0, 3)


def test_a_long_chain_is_not_listed() -> None:
    count = 25
    loops = {f"L{k}": f"3*e^(i*a{k}) + 4*e^(i*b{k}) = 5 + 3*e^(i*a{k + 1})" for k in range(count)}
    guess = {"a0": 60.0}
    for k in range(count):
        guess |= {f"b{k}": 10.0, f"a{k + 1}": 60.0}
    mechanism = lw.loops(
        name="chain", loops=loops, guess=guess, inputs=lw.Input(variable="a0", from_=0, to=9)
    )
    assert positions_elsewhere(mechanism.model, mechanism.model.start_inputs) is None
