"""Lengths a million times each other: proved all the same, with dead points in their places."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from flint import arb, ctx

import linkwork as lw
from linkwork.core.numerics import path_proof
from linkwork.core.results.failure import LimitKind
from tests.oracles.four_bar import FourBar
from tests.thinned import thinned


def four_bar(bar: FourBar, degrees: float, step: float = 10) -> lw.Mechanism:
    """With B left of the line from A to the rocker's pivot, exact for long and short links."""
    a = bar.r2 * cmath.exp(1j * math.radians(degrees))
    d = abs(bar.r1 - a)
    x = ((d - bar.r4) * (d + bar.r4) / d + bar.r3 * (bar.r3 / d)) / 2
    tip = a + (bar.r1 - a) / d * (x + 1j * math.sqrt((bar.r3 - x) * (bar.r3 + x)))
    return lw.loops(
        loops={"1": "b*e^(i*t) + c*e^(i*p) = a + d*e^(i*q)"},
        dimensions={"a": bar.r1, "b": bar.r2, "c": bar.r3, "d": bar.r4},
        guess={
            "t": degrees,
            "p": math.degrees(cmath.phase(tip - a)),
            "q": math.degrees(cmath.phase(tip - bar.r1)),
        },
        inputs=lw.Input(variable="t", from_=0, to=360, step=step),
    )


def exact_dead_points(bar: FourBar) -> list[float]:
    """[deg] from 0 to 180, in balls."""
    ctx.prec = 200
    r1, r2, r3, r4 = (arb(x) for x in (bar.r1, bar.r2, bar.r3, bar.r4))
    cosines = [(r1**2 + r2**2 - reach**2) / (2 * r1 * r2) for reach in (r3 - r4, r3 + r4)]
    return [float((c.acos() * 180 / arb.pi()).mid()) for c in cosines if abs(c) < 1]


@pytest.mark.parametrize("ratio", [1e4, 1e6, 1e8])
@pytest.mark.parametrize("shape", ["far pivot", "long rocker", "far pivot, almost folded"])
@pytest.mark.parametrize("step", [1, 60])
def test_a_crank_with_links_that_are_much_longer_is_proved_around(
    ratio: float, shape: str, step: float
) -> None:
    bar = {
        "far pivot": FourBar(ratio, 1.0, ratio, 1.5),
        "long rocker": FourBar(ratio, 1.0, 1.5, ratio),
        "far pivot, almost folded": FourBar(ratio, 1.0, ratio + 0.3, 1.5),
    }[shape]
    motion = four_bar(bar, 40, step).sweep()
    assert motion.certified.all()
    # as if the long links were parallel: the short ones as in a double slider
    short = "p" if shape == "long rocker" else "q"
    sign = -1.0 if shape == "long rocker" else 1.0
    offset = 0.3 if shape == "far pivot, almost folded" else 0.0
    cosine = sign * (np.cos(np.radians(motion["t"])) + offset) / 1.5
    found = np.cos(np.radians(motion[short]))
    np.testing.assert_allclose(found, cosine, rtol=0, atol=3.0 / ratio + 1e-14 * ratio)


@pytest.mark.parametrize("ratio", thinned([1e4, 1e6]))
@pytest.mark.parametrize("shape", ["far pivot", "long crank"])
def test_dead_points_between_long_links_are_located_and_proved(ratio: float, shape: str) -> None:
    bar = {
        "far pivot": FourBar(ratio, 1.5, ratio, 1.0),
        "long crank": FourBar(1.5, ratio, 1.2, ratio),
    }[shape]
    motion = four_bar(bar, 90).sweep()
    assert [limit.kind for limit in motion.limits] == [LimitKind.DEAD_POINT] * 2
    assert motion.certified[motion.found].all()
    exact = sorted(exact_dead_points(bar))
    assert len(exact) == 2
    for limit, true in zip(motion.limits, exact, strict=True):
        assert limit.located
        assert limit.bracket[0] < true < limit.bracket[1]
        assert limit.input == pytest.approx(true, abs=1e-9 + 1e-14 * ratio)
    assert motion.status.count(lw.Status.CONVERGED) == 2 + sum(
        exact[0] < t < exact[1] for t in range(0, 361, 10)
    )


@pytest.mark.extended
def test_a_proof_that_would_take_too_long_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    # the long links turn together: each step of the proof is as short as their ratio
    monkeypatch.setattr(path_proof, "_MOST", 3000)  # a tenth of what proofs are allowed
    motion = four_bar(FourBar(1.5, 1e8, 1.2, 1e8), 90).sweep()
    reasons = {c.name for c, found in zip(motion.certification, motion.found, strict=True) if found}
    assert reasons == {"CERTIFIED", "PROOF_TOO_LONG"}
    certified = motion["t"][motion.certified]
    assert 90.0 in certified
    unproved = motion["t"][motion.found & ~motion.certified]
    # certified rows are those next to the start
    assert np.abs(certified - 90).max() < np.abs(unproved - 90).min()
