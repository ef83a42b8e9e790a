"""One design's rows, prepared once and computed again and again."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from benchmarks.peers.linkwork_kernel import rows_of_one
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.record.recorder import LANES
from linkwork.families import Family
from linkwork.families.compiled.execution import Execution
from linkwork.families.design_sweep import TablePath
from linkwork.families.family_march import FamilyMarch
from linkwork.families.march.rowwise import _is_smooth, prove_rows
from linkwork.families.march.step_trial import MarchResult
from tests.described import described_as


def _march(family: Family, certify: bool) -> tuple[FamilyMarch, np.ndarray]:
    designs = family.designs
    path = TablePath.of(designs.base)
    assert path is not None
    t = designs.base.rows[:, path.lead]
    return path.march(designs, certify, 1, Execution()), np.ascontiguousarray(t)


@pytest.mark.parametrize("certify", [False, True])
@pytest.mark.parametrize("name", ["four-bar", "jansen-leg", "crank-slider"])
def test_they_are_those_of_the_sweep_every_time(name: str, certify: bool) -> None:
    mechanism = lw.example(name)
    own = {"a": 40.0}
    table = described_as(Linkage, mechanism).lengths if name != "crank-slider" else own
    length, value = next(iter(table.items()))
    family = mechanism.family({length: [value]})
    march, t = _march(family, certify)
    one = rows_of_one(march, t)
    motion = mechanism.sweep()
    q = np.stack([motion[u.name] for u in mechanism.model.equations.unknowns])
    unit = np.array(
        [np.pi / 180 if u.kind == "angle" else 1.0 for u in mechanism.model.equations.unknowns]
    )
    for _ in range(2):
        found = one.run()
        assert found is not None
        v, radius = found
        assert v[:, :, 0] == pytest.approx(q * unit[:, None], rel=1e-12, abs=1e-12)
        assert radius.shape == (len(t) if certify else 0, 1)
        assert (radius > 0).all()
        assert (radius < 1e-9).all()


@pytest.mark.parametrize("certify", [False, True])
def test_a_table_that_is_not_reached_is_left_to_the_march(certify: bool) -> None:
    mechanism = lw.example("four-bar")
    march, t = _march(mechanism.family({"O2 A": [95.0]}), certify)
    assert rows_of_one(march, t).run() is None


def _near_crossing(apart: float, step: float) -> lw.Mechanism:
    """A crank-rocker whose branches come near to each other at 180 deg; no row lies there."""
    frame = 4.5 - apart
    return lw.linkage(
        points={"A": (0, 0), "B": (0, 1), "C": (3, 2), "D": (frame, 0)},
        links={"a": ["A", "B"], "b": ["B", "C"], "c": ["C", "D"], "ground": ["A", "D"]},
        lengths={"A B": 1, "B C": 2.5, "C D": 3},
        inputs=lw.Input(link="a", from_=step / 2, to=360 + step / 2, step=step),
    )


@pytest.mark.parametrize("certify", [False, True])
@pytest.mark.parametrize("step", [0.5, 1, 2, 5])
@pytest.mark.parametrize("apart", [1e-3, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12])
def test_near_crossings_are_not_passed_straight(apart: float, step: float, certify: bool) -> None:
    """Guesses from the rows before lie on the other branch, and all corrections are small."""
    mechanism = _near_crossing(apart, step)
    march, t = _march(mechanism.family({"A B": [1.0]}), certify)
    found = rows_of_one(march, t).run()
    if apart == 1e-3 and step <= 1:  # near, but the rows are nearer to each other
        assert found is not None
    if found is not None:
        motion = mechanism.sweep()
        assert motion.certified.all()
        away = found[0][:, :, 0] - np.radians([motion["b"], motion["c"]])
        assert np.abs(away).max() < 1e-9  # the other branch is 3.7e-3 away, or more


class Proving:
    """Rows of a four-bar, right ones to begin with, to be proved from the start at row 60."""

    def __init__(self) -> None:
        march, self.t = _march(lw.example("four-bar").family({"O2 A": [40.0]}), True)
        self.one = rows_of_one(march, self.t)
        found = self.one.run()
        assert found is not None
        self.rows, self.start = found[0], 60
        there = self.rows[:, self.start, 0]
        base = np.exp(1j * self.t) * 40  # the other branch: the rocker mirrored in the diagonal
        four_bar = described_as(Linkage, lw.example("four-bar"))
        turn = 2 * np.angle(four_bar.points["O4"][0] - base)[None, :]
        self.mirrored = (turn - found[0][:, :, 0])[:, :, None]
        self.begin = there

    def run(self, rows: np.ndarray, begin: np.ndarray) -> tuple[bool, np.ndarray]:
        topology, scout, space, _ = self.one.loaded.spaces
        node = np.zeros(scout.nodes.shape[1])
        node[: len(begin)], node[-1] = begin, self.t[self.start]
        kept = MarchResult(0, rows.copy(), np.empty((len(self.t), 1)), *self.one.room)
        alone = self.one.loaded.alone
        done = prove_rows(topology, space, node, alone.table, alone.scale[0], kept, self.one.counts)
        return bool(done), kept.unknowns


def test_rows_are_proved_as_far_as_they_may_be_off() -> None:
    proving = Proving()
    for off, proved in (
        (0.0, True),
        (0.9e-7, True),
        (-0.9e-7, True),
        (1.2e-7, False),
        (5e-7, False),
    ):
        rows = proving.rows.copy()
        rows[0, 100] += off
        done, kept = proving.run(rows, proving.begin)
        assert done == proved
        if proved:
            assert np.abs(kept - proving.rows).max() < 1e-13


def test_rows_on_another_branch_are_not_proved() -> None:
    proving = Proving()
    rows, other = proving.rows, proving.mirrored
    assert np.abs(rows - other).min() > 0.1
    assert proving.run(rows, proving.begin)[0]
    assert proving.run(other, other[:, proving.start, 0])[0]
    assert not proving.run(other, proving.begin)[0]  # as if all rows had left the start's branch
    assert not proving.run(rows, other[:, proving.start, 0])[0]
    for row in (1, 150, len(proving.t) - 1):
        both = np.concatenate([rows[:, :row], other[:, row:]], axis=1)
        assert not proving.run(both, proving.begin)[0]


@pytest.mark.parametrize("row", [0, 3, 7])
def test_without_proofs_rows_have_to_follow_from_the_rates_before_them(row: int) -> None:
    proving = Proving()
    scout, gap = proving.one.loaded.spaces[1], float(proving.t[1])
    x = proving.rows[:, :, 0]
    d = np.gradient(x, gap, axis=1)
    node = np.concatenate([x, d, np.ones((1, x.shape[1])), proving.t[None, :]])
    assert len(node) == scout.nodes.shape[1]

    def follow(place: int, off: float, *, is_first: bool = False) -> bool:
        space = np.zeros((scout.nodes.max() + 1, LANES))
        space[scout.nodes[0], :8] = node[:, 51:59]
        space[scout.nodes[0, place], row] += off
        return bool(
            _is_smooth(scout, 0, space, 8, node[:, 50].copy(), is_first, np.ones(2), gap, 0.6)
        )

    coupler, rate, side = 0, 2, 4
    assert follow(coupler, 0.0)
    assert follow(coupler, 0.03 * gap)
    assert not follow(coupler, 0.5 * gap)
    assert not follow(coupler, -0.5 * gap)
    assert not follow(coupler, np.nan)
    assert not follow(rate, 0.2 / gap)
    assert not follow(side, -2.0)
    # what stands before the first row of all is the start, which lies elsewhere
    assert follow(coupler, 0.0, is_first=True)
    assert follow(side, -2.0, is_first=True) is False
