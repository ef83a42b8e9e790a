"""Printed positions of larger mechanisms."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw

SKETCH = {
    "O": (0, 0),
    "A": (9.61, 11.52),
    "P": (-38, -7.8),
    "B": (-35.24, 33.61),
    "D": (-77.75, -2.54),
    "C": (-20.1, -42.79),
    "E": (-56.05, -35.42),
    "F": (-22.22, -91.74),
}


@pytest.mark.parametrize(
    ("crank", "foot"),
    [(0, (-43.160111, -91.756933)), (90, (-7.689066, -90.389351))],
)
def test_jansen_leg_foot(crank: float, foot: tuple[float, float]) -> None:
    position = lw.example("jansen-leg").solve(at=crank)
    assert position.points["F"] == pytest.approx(foot, abs=5e-7)


@pytest.mark.parametrize(
    ("crank", "foot"),
    [(0, (-43.170055, -91.753226)), (45, (-24.406394, -91.789596))],
)
def test_jansen_leg_of_pyslvs_with_lengths_measured_in_its_sketch(
    crank: float, foot: tuple[float, float]
) -> None:
    mechanism = lw.example("jansen-leg").changed(points=SKETCH, lengths={})
    assert mechanism.solve(at=crank).points["F"] == pytest.approx(foot, abs=5e-7)
    assert len(mechanism.check().measured) == 11


def test_jansen_leg_has_mobility_one() -> None:
    report = lw.example("jansen-leg").check()
    assert (report.mobility_count, report.mobility_rank) == (1, 1)


def test_andrews_squeezer_moves_from_one_printed_position_to_the_other() -> None:
    motion = lw.example("andrews-squeezer").sweep()
    assert motion.found.all()
    first = {
        "Θ": 0.0,
        "γ": 0.455279819163070380,
        "Φ": 0.222668390165885885,
        "δ": 0.487364979543842550,
        "Ω": -0.222668390165885885,
        "ε": 1.23054744454982120,
    }
    last = {
        "Θ": -15.75637105984298,
        "γ": 0.04082224013073101,
        "Φ": -0.5347301163226948,
        "δ": 0.5244099658805304,
        "Ω": 0.5347301163226948,
        "ε": 1.048080741042263,
    }
    for row, printed in ((0, first), (-1, last)):
        for name, value in printed.items():
            # the end position was printed after integrating an ODE to about 12 digits
            assert motion[name][row] == pytest.approx(value, abs=1e-13 if row == 0 else 2e-11)


def test_coupled_six_link_reaches_a_printed_configuration() -> None:
    position = lw.example("coupled-six-link").solve()
    assert position["s6"] == pytest.approx(741.812501, abs=5e-7)


@pytest.mark.parametrize(
    "s6", [1252.618473, 741.812501, 40.140378, 25.672098, -102.590796, -657.652654]
)
def test_coupled_six_link_closes_in_all_six_printed_configurations(s6: float) -> None:
    mechanism = lw.example("coupled-six-link")
    found = set()
    rng = np.random.default_rng(3914)
    for _ in range(60):
        guess = {
            "θ12": 60,
            "θ14": rng.uniform(-180, 180),
            "θ15": rng.uniform(-180, 180),
            "s4": rng.uniform(-900, 900),
            "s6": s6,
        }
        position = mechanism.changed(guess=guess).solve()
        if position.status.ok:
            found.add(round(position["s6"], 6))
    assert s6 in found


def test_double_four_bar_is_solved_loop_by_loop() -> None:
    report = lw.example("double-four-bar").check()
    assert [block.unknowns for block in report.blocks] == [("θ2", "θ3"), ("θ4", "θ5")]


def test_stephenson_driven_at_the_far_crank_turns_fully() -> None:
    mechanism = lw.example("stephenson-far-crank")
    (block,) = mechanism.check().blocks
    assert len(block.unknowns) == 4
    motion = mechanism.sweep()
    assert motion.found.all()
    np.testing.assert_allclose(motion.q[-1], motion.q[0], rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", lw.examples())
def test_every_example_closes_to_1e_12_of_its_longest_link(name: str) -> None:
    mechanism = lw.example(name)
    if not mechanism.description.inputs:
        pytest.skip("a single equation has no cycle")
    motion = mechanism.sweep()
    assert motion.found.any()
    assert np.nanmax(motion.residual) <= 1e-12
