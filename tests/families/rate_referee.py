"""Referee: rates, evidence and limits of a family's design against its own motion."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Kind
from linkwork.families.family_motion import FamilyMotion

__all__ = ["assert_same_evidence", "assert_same_limits", "assert_same_rates"]

Array = npt.NDArray[np.float64]
_ROUNDING = 1e-12  # of the size of a rate, times the condition for every solution by the Jacobian
_TURN = 360.0


def assert_same_rates(motion: FamilyMotion, k: int, alone: Motion) -> None:
    """Both derivatives of everything that has a name."""
    asked = alone.asked
    condition = np.where(np.isfinite(alone.condition), alone.condition, 1.0)[asked]
    tables = (alone.unknowns, alone.links, alone.sliders, alone.outputs)
    places = [f"{point}.{axis}" for point in alone.points for axis in "xy"]
    for name in dict.fromkeys([*(name for table in tables for name in table), *places]):
        own, other = motion.series(name), alone.series(name)
        assert own.quantity.kind is other.quantity.kind
        is_length = own.quantity.kind is Kind.LENGTH
        unit = float(motion.designs.length_scale[k]) if is_length else 1.0
        found = motion.found[k]  # where whole turns away, there in both
        np.testing.assert_allclose(
            own.value[k][found], other.value[asked][found], rtol=1e-9, atol=1e-9 * max(unit, 360.0)
        )
        for order, ours, theirs in ((1, own.first, other.first), (2, own.second, other.second)):
            there = theirs[asked]
            np.testing.assert_array_equal(
                np.isnan(ours[k][motion.found[k]]),
                np.isnan(there[motion.found[k]]),
                err_msg=name,
            )
            assert np.isnan(ours[k][~motion.found[k]]).all(), name
            room = _ROUNDING * condition**order * np.maximum(np.abs(there), unit)
            off = np.abs(ours[k] - there) > room  # false where both are not there
            assert not off.any(), (name, order, np.flatnonzero(off))


def assert_same_evidence(motion: FamilyMotion, k: int, alone: Motion) -> None:
    """Condition to rounding; residuals are nothing but rounding."""
    asked, there = alone.asked, motion.found[k]
    own, other = motion.condition[k], alone.condition[asked]
    assert np.isnan(own[~there]).all()
    np.testing.assert_array_equal(np.isinf(own[there]), np.isinf(other[there]))
    fine = there & np.isfinite(own)
    np.testing.assert_array_less(
        np.abs(own[fine] / other[fine] - 1.0), _ROUNDING * np.maximum(other[fine], 1.0)
    )
    assert np.isnan(motion.residual[k][~there]).all()
    assert (motion.residual[k][there] < 1e-9).all()


def assert_same_limits(motion: FamilyMotion, k: int, alone: Motion) -> None:
    """The limits of a motion, which may be named whole turns away."""
    limits = motion.limits
    ends = [
        (limits.lower[k], str(limits.lower_kind[k])),
        (limits.upper[k], str(limits.upper_kind[k])),
    ]
    met = [(value, kind) for value, kind in ends if kind]
    if not alone.found.any():
        assert np.isnan([value for value, _ in ends]).all()
        return
    assert sorted(kind for _, kind in met) == sorted(limit.kind.word for limit in alone.limits)
    for value, kind in ends:
        assert kind or math.isinf(value)
    for (value, _), limit in zip(met, alone.limits, strict=True):
        if not limit.located:
            assert math.isnan(value)
            continue
        width = limit.bracket[1] - limit.bracket[0] + 1e-12 * max(1.0, abs(limit.input))
        gap = value - limit.input
        turns = round(gap / _TURN) if motion.designs.base.description.angle.value == "deg" else 0
        assert abs(gap - turns * _TURN) <= 4.0 * width
