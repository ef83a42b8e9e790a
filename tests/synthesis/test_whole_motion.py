"""Transmission angles and obstacles between the rows, and bounds of fits between them."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.motion.extremes import motions_of_points
from linkwork.core.motion.model import model_of
from linkwork.synthesis.improvement import proved_design as whole_motion
from linkwork.synthesis.improvement.goals import BetweenRows
from linkwork.synthesis.improvement.proved_design import WholeMotion
from tests.campaigns import whole_motions as campaign
from tests.library_mechanisms import driven_examples, read_example


def _whole(name: str, step: float) -> WholeMotion:
    mechanism = read_example(name)
    found = WholeMotion.of(mechanism.model, mechanism.sweep(step=step))
    assert found is not None
    return found


def _sides(name: str) -> list[tuple[str, str]]:
    links = read_example(name).model.description.links  # type: ignore[attr-defined]
    return [s for link, own in links.items() if link != GROUND for s in combinations(own, 2)]


def test_the_least_transmission_angle_is_found_between_rows() -> None:
    """Of a centred slider-crank: cos μ = a / b where the crank is normal to the line."""
    found = _whole("slider-crank", 40.0).least_transmission(0.0)
    row = lw.example("slider-crank").sweep(step=40)["B.transmission"]
    assert np.degrees(found.low) < 60.0 <= np.degrees(found.high) + 1e-9
    assert np.minimum(row, 180.0 - row).min() > 60.3
    assert np.degrees(found.high) == pytest.approx(60.0, abs=1e-4)
    assert found.at % 180.0 == pytest.approx(90.0, abs=0.2)
    # the bounds are drawn together until a wanted angle is decided
    close = _whole("slider-crank", 40.0).least_transmission(np.radians(60.0 - 1e-9))
    assert close.low >= np.radians(60.0 - 1e-9)


def test_the_least_angle_is_found_where_many_rows_lie_near_a_dead_point() -> None:
    """A leg, a dyad of which stays near its dead point for ten rows: a quarter of a degree."""
    lengths = {
        "O A": 15.907775626002605, "A B": 51.03469313221023, "P B": 39.358517768202624,
        "A C": 55.73301826609086, "P C": 37.55925084780406, "B D": 68.83997435266795,
        "P D": 38.14007411176997, "D E": 42.44365257810582, "C E": 42.99332279872897,
        "E F": 41.08127583435382, "C F": 55.79005714393648,
    }  # fmt: skip
    pivots = {
        "O": (-1.4346927020143332, 2.3413926983668953),
        "P": (-40.47784426107378, -4.263913083408191),
    }
    description = lw.example("jansen-leg").description
    assert isinstance(description, Draft)
    tables = {"lengths": lengths, "points": {**description.points, **pivots}}
    leg = lw.Mechanism(description.with_tables(tables))
    whole = WholeMotion.of(model_of(leg.description), leg.sweep())
    assert whole is not None
    found = whole.least_transmission(0.0)
    near = leg.sweep(from_=192, to=194, step=1e-3)["E.transmission"]
    least = np.minimum(near, 180.0 - near).min()
    assert np.degrees(found.low) == pytest.approx(least, abs=6e-5)
    assert np.degrees(found.low) < least < np.degrees(found.high) + 1e-6


def test_a_thin_obstacle_between_two_rows_is_met() -> None:
    """The coupler's end goes round a circle: at 7.5° it is between the rows 5° and 10°."""
    mechanism, whole, sides = read_example("four-bar"), _whole("four-bar", 5.0), _sides("four-bar")
    tip = 1.0001 * complex(*mechanism.solve(at=7.5).points["A"])
    size = mechanism.model.equations.length_scale
    rows = mechanism.sweep(step=5)
    away = campaign.distances([(rows.trace(p), rows.trace(q)) for p, q in sides], tip)
    radius = 1e-3 * size
    assert away > 3.0 * radius
    found = whole.contact(sides, np.array([[tip.real, tip.imag, radius]]))
    assert found.met is not None
    assert found.met[1] == pytest.approx(7.5, abs=1.0)
    side = sides[found.met[0]]
    assert "A" in side
    # a circle that is as small and a hundredth of its radius too far away is not
    beyond = tip * (1.0 + (1.01 * radius - (abs(tip) - abs(tip) / 1.0001)) / abs(tip))
    clear = whole.contact([("O2", "A")], np.array([[beyond.real, beyond.imag, radius]]))
    assert clear.met is clear.open is None


def test_contact_that_lasts_is_not_decided_within_the_limit() -> None:
    """A circle about the crank's pivot through its end, less than rounding away."""
    whole, size = _whole("four-bar", 10.0), read_example("four-bar").model.equations.length_scale
    crank = abs(read_example("four-bar").sweep(step=90).trace("A")[0])
    assert crank > 0.0
    away = 1e-13 * size
    found = whole.contact([("A", "A")], np.array([[0.0, 0.0, crank - away]]))
    assert found.met is None
    assert found.open == pytest.approx((0.0, 360.0))


@pytest.mark.parametrize("name", ["klann-leg", "crank-shaper"])
def test_whole_motions_agree_with_finer_rows(name: str) -> None:
    counts, false = campaign.whole_motion_campaign(driven_examples().index(name))
    assert not false
    assert counts["mechanisms"] == 1
    assert not counts["obstacles not decided"]
    assert counts["obstacles met"] > 5
    assert counts["obstacles kept clear of"] > 5


def test_the_referee_finds_bounds_that_are_too_small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Boxes whose points do not move keep clear of obstacles that they meet."""
    right = motions_of_points

    def still(model, boxes):  # type: ignore[no-untyped-def]
        found = right(model, boxes)
        found.rate[:], found.bend[:] = 0.0, 0.0
        return found

    monkeypatch.setattr(whole_motion, "motions_of_points", still)
    _, false = campaign.whole_motion_campaign(driven_examples().index("klann-leg"))
    assert false


def test_extremes_between_rows_are_those_of_the_function_or_beyond() -> None:
    def f(x: np.ndarray) -> np.ndarray:
        return np.asarray(60 + 20 * np.cos(x - 0.3) + 7 * np.sin(2 * x + 0.1))

    at = np.radians(np.arange(0.0, 301.0, 10.0))
    value, fine = f(at)[None], f(np.linspace(at[0], at[-1], 100_001))
    by_x = np.stack([np.ones_like(value), value], axis=2)
    between = BetweenRows(at)
    assert between.is_regular
    for greatest, seen, rows in ((False, fine.min(), value.min()), (True, fine.max(), value.max())):
        found, slopes = between.extremes(value, by_x, np.full(value.shape, greatest))
        beyond = (found.max() - seen) if greatest else (seen - found.min())
        assert -1e-9 <= beyond <= 1e-3 < abs(rows - seen)
        # derivatives of a constant, and of the function itself
        assert slopes[0, :, 0] == pytest.approx(1.0)
        assert slopes[0, :, 1] == pytest.approx(found[0], abs=1e-2)
    assert not BetweenRows(np.array([0.0, 1.0, 2.0, 4.0, 5.0])).is_regular
    assert not BetweenRows(at[:4]).is_regular
