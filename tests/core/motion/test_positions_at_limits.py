"""Positions exactly at dead points and change points: as the rows of a sweep have them."""

from __future__ import annotations

import math

import numpy as np
import pytest

import linkwork as lw
from tests.oracles.four_bar import FourBar


def _four_bar(bar: FourBar) -> lw.Mechanism:
    return lw.linkage(
        points=bar.points(math.radians(40.0), 1),
        links={
            "ground": ("O2", "O4"),
            "crank": ("O2", "A"),
            "coupler": ("A", "B"),
            "rocker": ("O4", "B"),
        },
        inputs=lw.Input(link="crank"),
    )


def _limited(name: str) -> lw.Mechanism:
    match name:
        case "triple rocker":  # between dead points at 6.2 and 88.0 degrees
            return _four_bar(FourBar(3.0, 2.6, 1.7, 2.2))
        case "parallelogram":
            return _four_bar(FourBar(2.0, 1.0, 2.0, 1.0))
        case _:
            return lw.example(name)


@pytest.mark.parametrize("name", ["rapier-drive-limited", "triple rocker", "parallelogram"])
@pytest.mark.parametrize("turns", [0, 1, -3])
def test_solve_at_a_limit_is_the_row_of_the_sweep(name: str, turns: int) -> None:
    mechanism = _limited(name)
    motion = mechanism.sweep()
    assert len(motion.limits) == 2
    (lead,) = motion.inputs.values()
    rows = [motion.limit[k] != "" for k in range(len(motion))]
    assert sum(rows) >= 2
    for row in np.flatnonzero(rows):
        position = mechanism.solve(at=float(lead[row]) + 360.0 * turns)
        assert position.status is lw.Status.CONVERGED
        assert "at a dead point or change point" in position.message
        assert position.condition == math.inf
        if not turns:
            assert position.certificate.certification is motion.certification[row]
        for unknown in position.unknowns:
            gap = math.remainder(position[unknown] - motion[unknown][row], 360)
            assert gap == pytest.approx(0, abs=1e-9)
            if motion.limit[row] == "dead point":
                assert math.isnan(position.first[unknown])


def test_what_is_proved_of_a_dead_point_needs_the_way_to_it() -> None:
    mechanism = _limited("triple rocker")
    (low, high) = (limit.input for limit in mechanism.sweep().limits)
    for value in (low, high):
        certificate = mechanism.solve(at=value).certificate
        assert certificate.certification is lw.Certification.CERTIFIED
        assert certificate.radius is not None
        assert certificate.radius < 1e-12
        certificate = mechanism.solve(at=value, certify=False).certificate
        assert certificate.certification is lw.Certification.NOT_ASKED


@pytest.mark.parametrize("beyond", [1e-8, 1e-4, 10.0])
def test_just_beyond_a_dead_point_there_is_no_position(beyond: float) -> None:
    mechanism = _limited("triple rocker")
    (low, high) = (limit.input for limit in mechanism.sweep().limits)
    for value, side in ((low, -1), (high, 1)):
        assert mechanism.solve(at=value + side * beyond).status is lw.Status.OUT_OF_REACH
        assert mechanism.solve(at=value - side * beyond).status is lw.Status.CONVERGED


def test_the_message_of_a_motion_tells_every_limit_once() -> None:
    motion = _limited("triple rocker").sweep()
    missing = int((~motion.found & motion.asked).sum())
    low, high = motion.limits
    assert motion.message == (
        f"{missing} of 361 positions were not found; {lw.Status.OUT_OF_REACH.value}; "
        f'dead point at crank = {low.input:.12g} deg, where loop "O2 A B O4" locks '
        "(coupler and rocker in line); "
        f'dead point at crank = {high.input:.12g} deg, where loop "O2 A B O4" locks '
        "(coupler and rocker in line)"
    )
    found = lw.example("four-bar").sweep()
    assert found.message == lw.Status.CONVERGED.value
