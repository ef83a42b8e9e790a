"""Circuits and branches: what theory says of four-bars, the rapier drive, change points."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits import branches, circuit_list
from linkwork.core.numerics import curve_tracing, path_proof as curve_proof
from tests.oracles.four_bar import FourBar
from tests.oracles.trains import Loop, train
from tests.thinned import thinned

LINKS = {
    "ground": ("O2", "O4"),
    "crank": ("O2", "A"),
    "coupler": ("A", "B"),
    "rocker": ("O4", "B"),
}


def four_bar(bar: FourBar, theta: float, side: int = 1) -> lw.Mechanism:
    return lw.linkage(points=bar.points(theta, side), links=LINKS, inputs=lw.Input(link="crank"))


def random_four_bars(count: int, seed: int) -> list[tuple[FourBar, float]]:
    """Any lengths that can be assembled, away from change points, with a crank angle in reach."""
    rng = np.random.default_rng(seed)
    found: list[tuple[FourBar, float]] = []
    while len(found) < count:
        bar = FourBar(*rng.uniform(0.3, 3.0, 4).tolist())
        lengths = sorted((bar.r1, bar.r2, bar.r3, bar.r4))
        excess = lengths[0] + lengths[3] - lengths[1] - lengths[2]
        if 1.98 * lengths[3] > sum(lengths) or abs(excess) < 0.02 * sum(lengths):
            continue
        theta = float(rng.uniform(0.0, 2.0 * math.pi))
        if np.isfinite(bar.coupler_end(np.array(theta), 1)):
            found.append((bar, theta))
    return found


def grashof(bar: FourBar) -> bool:
    lengths = sorted((bar.r1, bar.r2, bar.r3, bar.r4))
    return lengths[0] + lengths[3] < lengths[1] + lengths[2]


FOUR_BARS = random_four_bars(40, 11)


@pytest.mark.parametrize("number", thinned(range(40), 4))
def test_circuits_of_four_bars_are_those_of_grashof(number: int) -> None:
    bar, theta = FOUR_BARS[number]
    circuits = four_bar(bar, theta).circuits()
    assert len(circuits) == (2 if grashof(bar) else 1)
    lengths = {"ground": bar.r1, "crank": bar.r2, "coupler": bar.r3, "rocker": bar.r4}
    shortest = min(lengths, key=lengths.__getitem__)
    for circuit in circuits:
        assert circuit.closed
        assert circuit.certified
        turning = {link for link, turns in circuit.turning.items() if turns}
        if not grashof(bar):
            assert turning == set()
        elif shortest == "ground":
            assert turning == {"crank", "coupler", "rocker"}
        else:
            assert turning == {shortest}
        full = grashof(bar) and shortest in ("ground", "crank")
        assert circuit.turns == (1 if full else 0)
        assert len(circuit.branches) == (1 if full else 2)
        assert len(circuit.dead_points) == (0 if full else 2)
        for dead in circuit.dead_points:
            off = [abs(math.cos(math.radians(dead.input)) - math.cos(d)) for d in bar.dead_points()]
            assert min(off) < 1e-12
            assert dead.located
            assert dead.in_line == ("coupler", "rocker")


def test_every_position_along_a_circuit_closes_and_is_near_the_next() -> None:
    for bar, theta in random_four_bars(6, 12):
        for circuit in four_bar(bar, theta).circuits():
            motion = circuit.motion
            a, b = motion.trace("A"), motion.trace("B")
            assert np.abs(np.abs(b - a) - bar.r3).max() < 1e-12 * bar.r3
            assert np.abs(np.abs(b - bar.r1) - bar.r4).max() < 1e-12 * bar.r4
            for branch in circuit.branches:
                mine = [k for k, name in enumerate(motion.branch) if name == branch.name]
                for j, k in pairwise(mine):
                    assert k == j + 1
                    assert abs(b[k] - b[j]) < 0.3 * max(bar.r3, bar.r4)


def test_full_turn_rapier_has_three_circuits_one_of_them_with_dead_points() -> None:
    circuits = lw.example("rapier-drive").circuits()
    assert [circuit.turns for circuit in circuits] == [1, 1, 0]
    assert all(circuit.closed and circuit.certified for circuit in circuits)
    about: Any = pytest.approx  # a part of a tuple
    low, high = sorted(limit.input for limit in circuits[2].dead_points)
    assert low == pytest.approx(0.302876213349, abs=1e-11)
    assert high == pytest.approx(155.227836297534, abs=1e-11)
    assert [branch.input_range for branch in circuits[2].branches] == [
        (about(low), about(high))
    ] * 2
    # circuit 1 holds the guess; its positions are a few degrees apart
    assert circuits[0].range("s16") == pytest.approx((-54.69985, 304.25187), abs=0.3)


def test_limited_rapier_has_one_circuit_with_two_branches() -> None:
    (circuit,) = lw.example("rapier-drive-limited").circuits()
    assert (circuit.closed, circuit.certified, circuit.turns) == (True, True, 0)
    inputs = sorted(limit.input for limit in circuit.dead_points)
    assert inputs == pytest.approx([-158.679899604109, 149.617278637485], abs=1e-11)
    assert len(circuit.branches) == 2
    assert circuit.smallest_singular_value == 0.0


@pytest.mark.parametrize(
    ("lengths", "change_points", "branches"),
    [((2.0, 1.0, 2.0, 1.0), [0.0, 180.0], 4), ((4.0, 1.0, 3.0, 2.0), [180.0], 2)],
)
def test_change_points_join_branches_to_one_circuit(
    lengths: tuple[float, ...], change_points: list[float], branches: int
) -> None:
    (circuit,) = four_bar(FourBar(*lengths), 1.0).circuits()
    assert circuit.end is lw.CircuitEnd.CHANGE_POINT
    found = sorted(round(limit.input % 360.0, 9) % 360.0 for limit in circuit.change_points)
    assert found == change_points
    assert len(circuit.branches) == branches
    assert circuit.certified
    assert circuit.smallest_singular_value == 0.0


def test_a_step_across_two_change_points_at_once_is_found() -> None:
    # at its change points two loops of Peaucellier's linkage fold, and det J keeps its sign
    found = lw.example("peaucellier").circuits().circuits
    assert len(found) == 2
    for circuit in found:
        assert circuit.certified
        assert circuit.end is lw.CircuitEnd.CHANGE_POINT
        assert all(limit.located for limit in circuit.change_points)
        assert circuit.dead_points == ()


@pytest.mark.parametrize(
    ("name", "branches"), [("peaucellier", [2, 2]), ("galloway", [4]), ("kempe-translator", [24])]
)
def test_unproved_circuits_do_not_step_across_change_points(name: str, branches: list[int]) -> None:
    found = lw.example(name).circuits(certify=False)
    assert [len(circuit.branches) for circuit in found] == branches
    assert all(circuit.dead_points == () for circuit in found)


def test_a_kite_moves_while_its_crank_stands_still() -> None:
    """Galloway's mechanism: at 0 degrees coupler and rocker turn as one about the ground pivot."""
    (circuit,) = four_bar(FourBar(1.0, 1.0, 2.0, 2.0), 1.0).circuits()
    assert circuit.end is lw.CircuitEnd.CHANGE_POINT
    spans = [high - low for low, high in (branch.input_range for branch in circuit.branches)]
    assert sorted(np.round(spans, 6).tolist()) == [0.0, 0.0, 360.0, 360.0]
    rest = lw.CircuitEnd.INPUT_CONSTANT
    assert [branch.end is rest for branch in circuit.branches] == [span < 1e-6 for span in spans]


def test_a_length_that_grows_without_bound_ends_a_circuit() -> None:
    """A pin on a line runs to infinity where the line and its arm become parallel."""
    mechanism = lw.loops(
        name="ray and line",
        loops={"O P": "r*e^(i*θ) = 1 + i*s"},
        guess={"θ": 0.3, "r": 1.05, "s": 0.3},
        angle="rad",
        inputs=lw.Input(variable="θ", from_=0, to=6, step=0.1),
    )
    ends = {circuit.end for circuit in mechanism.circuits()}
    assert ends == {lw.CircuitEnd.RUNS_TO_INFINITY}


def test_branches_are_chosen_by_name_to_solve_and_to_sweep() -> None:
    mechanism = lw.example("rapier-drive")
    circuits = mechanism.circuits()
    for circuit in circuits:
        for branch in circuit.branches:
            low, high = branch.input_range
            at = 0.3 * low + 0.7 * high
            position = mechanism.solve(at, configuration=branch.name)
            assert position.certificate.certified
            motion = circuit.motion
            mine = [k for k, name in enumerate(motion.branch) if name == branch.name]
            order = np.argsort(motion["θ12"][mine])
            here = np.interp(at, motion["θ12"][mine][order], motion["s16"][mine][order])
            assert position["s16"] == pytest.approx(here, abs=2.0)
            swept = mechanism.sweep(configuration=branch.name)
            assert set(swept.branch) <= {branch.name, ""}
            assert swept.certified[swept.found].all()


def test_a_name_that_does_not_exist_is_told_with_those_that_do() -> None:
    mechanism = lw.example("rapier-drive-limited")
    with pytest.raises(lw.UnknownNameError) as caught:
        mechanism.solve(60, configuration="circuit 2 branch 1")
    assert str(caught.value) == (
        'there is no "circuit 2 branch 1" of Rapier drive of a loom, limited crank '
        "(branches: circuit 1 branch 1, circuit 1 branch 2)"
    )


def test_a_file_names_the_branch_to_start_from() -> None:
    text = lw.example_text("rapier-drive")
    mechanism = lw.loads(f'configuration = "circuit 3 branch 1"\n{text}')
    assert mechanism.solve()["s16"] == pytest.approx(-1172.005855, abs=1e-5)
    assert set(mechanism.sweep().branch) == {"circuit 3 branch 1", ""}
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(f'configuration = "circuit 9"\n{text}', "loom.toml")
    assert "line 1  configuration  there is no" in str(caught.value)


def test_a_crank_alone_has_one_circuit() -> None:
    crank = lw.loads(
        'format = 1\n[points]\nO = [0, 0]\nA = [3, 4]\n[links]\nground = ["O"]\n'
        'crank = ["O", "A"]\n[input]\nlink = "crank"\n'
    )
    [circuit] = crank.circuits()
    assert circuit.certified
    assert circuit.smallest_singular_value == np.inf


def test_motions_and_weakest_positions_are_computed_when_first_read(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    calls: list[str] = []
    for name in ("motion_of_rows", "weakest_place"):
        own = getattr(circuit_list, name)

        def counted(*arguments: Any, name: str = name, own: Any = own) -> Any:
            calls.append(name)
            return own(*arguments)

        monkeypatch.setattr(circuit_list, name, counted)
    circuits = lw.example("four-bar").circuits()
    assert repr(circuits)
    assert not calls
    assert circuits[0].smallest_singular_value > 0.0
    assert circuits[0].weakest == circuits[0].weakest
    assert circuits[0].motion.certified.all()
    assert circuits[0].range("rocker") == circuits[0].range("rocker")
    assert calls == ["weakest_place", "motion_of_rows"]
    copy = pickle.loads(pickle.dumps(circuits))
    assert copy[1].weakest == circuits[1].weakest


@pytest.mark.parametrize("name", ["rapier-drive-limited", "stephenson-far-crank"])
def test_curves_of_bold_steps_without_a_proof_are_followed_again(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = lw.example(name).circuits().to_dict()
    careful: list[bool] = []

    def traced(*arguments: Any) -> Any:
        careful.append(arguments[3] is branches._CAREFUL)
        return curve_tracing.trace(*arguments)

    def refused(*arguments: Any) -> Any:
        found = curve_proof.prove_curve(*arguments)
        return found if careful[-1] else replace(found, legs=~found.legs)

    monkeypatch.setattr(branches, "trace", traced)
    monkeypatch.setattr(branches, "prove_curve", refused)
    found = lw.example(name).circuits().to_dict()
    # every curve twice
    assert careful == [False, True] * (len(careful) // 2)
    for one, other in zip(expected["circuits"], found["circuits"], strict=True):
        assert one["certified"]
        assert other["certified"]
        for key in ("name", "end", "turns", "turning"):
            assert one[key] == other[key]
        assert one["input_range"] == pytest.approx(other["input_range"], abs=1e-12)


def test_a_change_point_next_to_another_block_s_is_one() -> None:
    """The blocks come near their change points 0.001 rad apart."""
    folding = Loop(3.666523, 1.452951, 1.452951, 3.666523, side=-1.0)
    next_one = Loop(2.2, 3.1, 1.1, 4.2, offset=0.001, side=-1.0)
    circuit = train([folding, next_one], (30.0, 390.0, 10.0)).circuits()[0]
    assert (len(circuit.branches), len(circuit.change_points)) == (12, 5)
