"""Blocks as bilinear systems: the same equations, and a reason where there is no such form."""

from __future__ import annotations

import re

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.equations.compiling import NoDirectionForm, direction_form
from linkwork.core.table.loop_table import LoopTable
from tests.core.laws.mechanisms import NAMES, mechanism_of


@pytest.mark.parametrize("name", NAMES)
def test_a_solved_position_solves_every_bilinear_system_and_comes_back(name: str) -> None:
    mechanism = mechanism_of(name)
    solver = mechanism.model.compiled.solver
    v = np.append(mechanism.solve(throw=True).q, mechanism.model.start_inputs)[None, :]
    for block in solver.blocks:
        n = len(block.unknowns)
        assert isinstance(block.system, LoopTable)
        if block.system.functions or block.system.is_straight:
            continue  # cams, curves and racks have no directions
        assert isinstance(block.system, LoopTable)
        form = direction_form(block.system)
        known = v[:, block.variables[n:]]
        left, off = form.closures(known, np.zeros_like(known))
        # directions from angles, backwards through what `unknowns` does
        turning, lengths = form.turning, form.sliding
        ones = np.ones((1, 1))
        angles = v[:, block.unknowns[turning]] - np.append(known, ones, axis=1) @ form.shift.T
        psi = np.linalg.lstsq(form.angles, angles[0], rcond=None)[0]
        t = np.exp(1j * psi)
        s = v[0, block.unknowns[lengths]] / form.table.variable_scale[lengths]
        z = [x * (t[a] if a >= 0 else 1.0) for x, a in zip(s, form.along, strict=True)]
        u = np.append(t, z)
        x = np.concatenate([u, u.conj()])
        x[len(t) : len(u)] = z
        f, _ = form.system(left[0]).residual_and_jacobian(x[None, :])
        assert np.abs(f).max() < 1e-12
        near = v[0, block.unknowns] + np.where(form.table.is_angle[:n], 1.0, 0.0)
        back = form.unknowns(x[None, :], known, near)
        np.testing.assert_allclose(back[0], v[0, block.unknowns], rtol=1e-12, atol=1e-12)
        assert (off >= 0).all()
        assert off.max() < 1e-14


def test_what_is_known_approximately_moves_the_closures_by_less_than_said() -> None:
    model = lw.example("jansen-leg").model
    block = model.compiled.solver.blocks[1]
    assert isinstance(block.system, LoopTable)
    form = direction_form(block.system)
    n = len(block.unknowns)
    rng = np.random.default_rng(0)
    known = rng.normal(size=(50, len(block.variables) - n))
    spread = np.full(known.shape, 1e-4)
    moved = known + spread * rng.uniform(-1, 1, known.shape)
    left, off = form.closures(known, spread)
    change = np.abs(form.closures(moved, spread)[0] - left)
    assert (change <= off).all()
    assert change.max() > 0.1 * off.max()


def _with(equation: str, **guess: float) -> lw.Mechanism:
    return lw.loops(
        name="one loop",
        loops={"l": equation},
        guess={"q": 60, **guess},
        inputs=(lw.Input(variable="q", from_=0, to=10, step=1),),
    )


@pytest.mark.parametrize(
    ("equation", "guess", "reason"),
    [
        (
            "e^(i*q) + 2*e^(i*t) + 0.3*e^(2*i*t) = s",
            {"t": 0, "s": 3},
            "contain more sums of angles than angles, as gears do",
        ),
        (
            "e^(i*q) + 2*e^(2*i*t) = s",
            {"t": 0, "s": 3},
            "contain angles with ratios other than 1, as gears do",
        ),
        (
            "e^(i*q) + 2*e^(i*t) + 0.3*e^(-i*t) = s",
            {"t": 0, "s": 3},
            "contain an angle both forwards and backwards",
        ),
        (
            "e^(i*q) + s*e^(i*t) = s + 4*i",
            {"t": 0, "s": 3},
            "use one length along several directions",
        ),
    ],
)
def test_equations_without_the_form_say_why(
    equation: str, guess: dict[str, float], reason: str
) -> None:
    mechanism = _with(equation, **guess)
    (block,) = mechanism.model.compiled.solver.blocks
    assert isinstance(block.system, LoopTable)
    with pytest.raises(NoDirectionForm, match=f"^{re.escape(reason)}$"):
        direction_form(block.system)
    found = mechanism.configurations()
    assert found.completeness is lw.Completeness.NOT_LISTED
    assert found.message.endswith(f"the equations of {', '.join(guess)} {reason}")
    assert len(found) == 0


def test_sums_of_angles_are_directions_of_their_own() -> None:
    plain = lw.loops(
        name="absolute",
        loops={"l": "e^(i*q) + 3*e^(i*a) - 2*e^(i*b) = 2.5"},
        guess={"q": 60, "a": 20, "b": 70},
        inputs=(lw.Input(variable="q", from_=0, to=10, step=1),),
    )
    relative = lw.loops(
        name="relative",
        loops={"l": "e^(i*q) + 3*e^(i*(q + c)) - 2*e^(i*(q + c + d)) = 2.5"},
        guess={"q": 60, "c": -40, "d": 50},
        inputs=(lw.Input(variable="q", from_=0, to=10, step=1),),
    )
    for a, b in zip(plain.configurations(), relative.configurations(), strict=True):
        assert np.exp(1j * np.radians(a["a"] - 60 - b["c"])) == pytest.approx(1, abs=1e-12)
        assert np.exp(1j * np.radians(a["b"] - a["a"] - b["d"])) == pytest.approx(1, abs=1e-12)
        assert a.configuration == b.configuration
