"""Rows are played in the order in which the mechanism passes them."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.pages.packing import falling, play_order
from linkwork.core.mechanism.linkage import Linkage
from tests.described import described_as


def _steps(motion: lw.Motion, order: np.ndarray, closed: bool) -> np.ndarray:
    places = np.stack([motion.trace(name) for name in motion.points], axis=1)[order]
    way = np.concatenate((places, places[:1])) if closed else places
    return np.asarray(np.abs(np.diff(way, axis=0)).max(axis=1))


def test_a_full_turn_is_closed_and_its_last_row_not_passed_twice() -> None:
    order, closed = play_order(lw.example("jansen-leg").sweep())
    assert closed
    assert order.tolist() == list(range(360))


def test_time_runs_forward_where_the_speed_is_against_the_table() -> None:
    motion = lw.example("crank-slider").sweep()
    assert motion.speed is not None
    assert motion.speed < 0 < motion["θ2"][1]
    order, closed = play_order(motion)
    assert closed
    assert order.tolist() == [0, *range(359, 0, -1)]
    order, closed = play_order(lw.example("crank-slider").sweep(to=90))
    assert not closed
    assert order.tolist() == list(range(90, -1, -1))


def test_where_the_input_falls() -> None:
    motion = lw.example("four-bar").sweep()
    assert falling(motion, [0, 30, 60, 30, 0]) == [False, False, True, True, True]
    assert falling(motion, [350, 355, 5]) == [False, False, False]
    assert falling(motion, [7]) == [False]


def test_a_part_of_a_turn_is_open() -> None:
    order, closed = play_order(lw.example("jansen-leg").sweep(to=90))
    assert not closed
    assert order.tolist() == list(range(91))


def test_a_circuit_with_dead_points_is_passed_without_a_jump() -> None:
    motion = lw.example("rapier-drive-limited").sweep(through=True)
    order, closed = play_order(motion)
    assert closed
    assert order[0] == 0
    assert len(order) >= motion.found.sum() - 4  # rows where runs meet are passed once
    tabled = np.abs(np.diff(motion.trace("E")[motion.found]))
    steps = _steps(motion, order, closed)
    assert steps.max() < 0.1 * tabled.max()  # the table does jump, from branch to branch
    values = motion["θ12"][order]
    turned = np.flatnonzero(np.diff(np.sign(np.diff(np.unwrap(np.radians(values))))))
    assert len(turned) == 2  # the input turns back at the two dead points, and nowhere else


def test_a_range_with_a_gap_is_passed_from_dead_point_to_dead_point() -> None:
    jansen = lw.example("jansen-leg")
    motion = jansen.changed(lengths={**described_as(Linkage, jansen).lengths, "O A": 22}).sweep()
    order, closed = play_order(motion)
    assert not closed
    limits = [row for row, what in enumerate(motion.limit) if what]
    assert len(limits) == 2
    assert {int(order[0]), int(order[-1])} == set(limits)
    assert len(order) >= motion.found.sum() - 1  # 0 and 360 degrees are one position


def test_a_cam_is_played_through_its_dwell() -> None:
    motion = lw.example("cam-roller-follower").sweep()
    order, closed = play_order(motion)
    assert closed
    assert len(order) == 360


@pytest.mark.parametrize("name", ["planetary-gear", "rapier-drive", "crossed-belt"])
def test_whole_cycles_are_closed(name: str) -> None:
    assert play_order(lw.example(name).sweep())[1]
