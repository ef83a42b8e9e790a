"""Dwells of circles, ramps and cams against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError


def circle(start: float, stop: float, step: float = 1.0) -> lw.Mechanism:
    return lw.loops(
        loops={"1": "r*e^(i*t) = x + i*y"},
        dimensions={"r": 2.0},
        guess={"t": 30, "x": 1.0, "y": 1.0},
        inputs=lw.Input(variable="t", from_=start, to=stop, step=step),
        outputs={"ramp": "t/9"},
    )


@pytest.mark.parametrize("band", [0.01, 0.3, 1.5])
def test_a_cosine_dwells_about_its_extremes(band: float) -> None:
    motion = circle(-90, 90).sweep()
    expected = 2 * np.degrees(np.arccos(1 - band / 2))
    assert motion.value(f"dwell(x, {band})") == pytest.approx(expected, abs=1e-3)
    assert motion.value(f"dwell_start(x, {band})") == pytest.approx(-expected / 2, abs=1e-3)
    assert motion.quantities.find_of_motion("dwell(x, 1)").unit == "deg"


def test_a_ramp_stays_in_a_band_as_long_as_it_needs() -> None:
    assert circle(0, 90).sweep().value("dwell(ramp, 2)") == pytest.approx(18, rel=1e-9)


def test_a_whole_turn_goes_on_at_its_end() -> None:
    motion = circle(0, 360).sweep()  # its maximum lies where the table begins and ends
    expected = 2 * np.degrees(np.arccos(1 - 0.3 / 2))
    assert motion.value("dwell(x, 0.3)") == pytest.approx(expected, abs=1e-3)
    assert motion.value("dwell(x, 5)") == 360.0
    reverse = circle(360, 0, -1).sweep()
    assert reverse.value("dwell(x, 0.3)") == pytest.approx(expected, abs=1e-3)


def test_a_cam_dwells_as_it_was_designed_to() -> None:
    motion = lw.example("cam-roller-follower").sweep()
    assert 80 < motion.value("dwell(s, 0.001)") < 84  # 80 deg and a little of rise and fall
    assert motion.value("dwell_start(s, 0.001)") == pytest.approx(280, abs=2.5)


def test_dense_sampling_finds_the_same() -> None:
    mechanism, band, step = lw.example("four-bar"), 4.0, 0.02
    dense = mechanism.sweep(step=step)["rocker"]
    twice = np.concatenate([dense, dense[1:]])
    best, begin = 0, 0
    for end in range(len(twice)):
        while np.ptp(twice[begin : end + 1]) > band:
            begin += 1
        best = max(best, end - begin)
        if end - begin == best:
            begin_of_best = begin
    motion = mechanism.sweep()
    assert motion.value(f"dwell(rocker, {band})") == pytest.approx(best * step, abs=3 * step)
    begins = (begin_of_best * step) % 360
    assert motion.value(f"dwell_start(rocker, {band})") % 360 == pytest.approx(begins, abs=3 * step)


def test_designs_have_it_as_they_have_it_alone() -> None:
    mechanism, cranks = lw.example("four-bar"), [38.0, 40.0, 400.0]
    found = mechanism.family({"O2 A": cranks}).reduced(["dwell(rocker, 1)"])["dwell(rocker, 1)"]
    assert found[1] == pytest.approx(mechanism.sweep().value("dwell(rocker, 1)"), rel=1e-9)
    assert np.isnan(found[2])


def test_a_dwell_needs_the_height_of_its_band() -> None:
    motion = circle(0, 90).sweep()
    for text in ("dwell(x)", "dwell(x, wide)", "dwell(x, 1, 2)", "dwell(x, inf)"):
        with pytest.raises(InputError, match=r"must be dwell\(x, BAND\)"):
            motion.value(text)
    for band in (0, -1):
        with pytest.raises(InputError, match=f"band must be positive, got {band}"):
            motion.value(f"dwell(x, {band})")


def slider(start: float, stop: float, step: float, **outputs: str) -> lw.Mechanism:
    return lw.loops(
        loops={"1": "a*e^(i*t) + b*e^(i*q) = s"},
        dimensions={"a": 1.0, "b": 3.0},
        guess={"t": start, "q": 0.0, "s": 3.0},
        inputs=lw.Input(variable="t", from_=start, to=stop, step=step),
        outputs=outputs,
    )


@pytest.mark.parametrize(
    ("start", "stop", "step"), [(90, 180, 1), (90, 180, 30), (0, 180, 10), (180, 90, -10)]
)
def test_a_range_may_end_where_a_table_does(start: float, stop: float, step: float) -> None:
    """s = cos t + sqrt(9 - sin² t) is 2.1 at cos t = (1 + 2.1² - 9) / 4.2, and 2 at 180 deg."""
    mechanism = slider(start, stop, step)
    begin = math.degrees(math.acos((1 + 2.1**2 - 9) / 4.2))
    motion = mechanism.sweep()
    assert motion.value("dwell(s, 0.1)") == pytest.approx(180 - begin, abs=1e-8)
    assert motion.value("dwell_start(s, 0.1)") == pytest.approx(begin, abs=1e-8)
    found = lw.design.sensitivity(mechanism, "dwell(s, 0.1)", by=["a"])

    def begins(a: complex) -> complex:
        s = 3.0 - a + 0.1
        return complex(np.arccos((a**2 + s**2 - 9.0) / (2.0 * a * s)))

    slope = -math.degrees(begins(1.0 + 1e-30j).imag * 1e30)
    assert found["a"] == pytest.approx(slope, rel=1e-7)
    assert mechanism.family({"a": [1.0, 1.1]}).reduced("dwell(s, 0.1)")["dwell(s, 0.1)"][
        0
    ] == pytest.approx(180 - begin, abs=1e-3 * step**2 + 1e-6)


@pytest.mark.parametrize("step", [1.0, 10.0, 30.0])
@pytest.mark.parametrize("start", [-90.0, -90.3])
def test_a_range_about_an_inflection_is_where_it_is_longest(start: float, step: float) -> None:
    """t - sin t stays within 0.01 rad from -h to h, with h - sin h = 0.005."""
    half = 0.3
    for _ in range(20):
        half -= (half - math.sin(half) - 0.005) / (1 - math.cos(half))
    motion = slider(start, start + 180, step, u=f"t - {math.degrees(1)!r}*sin(t)").sweep()
    band = f"{math.degrees(0.01)!r}"
    assert motion.value(f"dwell(u, {band})") == pytest.approx(math.degrees(2 * half), abs=1e-9)
    # where it is longest its length hardly changes with its place
    begins = motion.value(f"dwell_start(u, {band})")
    assert begins == pytest.approx(-math.degrees(half), abs=1e-5)


@pytest.mark.parametrize("step", [2.0, 10.0, 30.0, 90.0])
@pytest.mark.parametrize("start", [0.0, 7.3])
def test_corners_between_rows_do_not_end_a_range(start: float, step: float) -> None:
    motion = slider(start, start + 360, step, z="max(sin(t), 0.5)", y="cos(t)^21").sweep()
    beyond = math.degrees(math.asin(0.5001)) - 30
    assert motion.value("dwell(z, 0.0001)") == pytest.approx(240 + 2 * beyond, abs=1e-8)
    flat = 180 - 2 * math.degrees(math.acos(0.0005 ** (1 / 21)))
    assert motion.value("dwell(y, 0.001)") == pytest.approx(flat, abs=1e-6)


@pytest.mark.parametrize(
    ("of", "band", "lengths", "length", "start"),
    [
        ("y", 0.022157716373724556, (0.37362196340917564, 1.8801584085273477, 1.1179423425639365,
         2.3743507413094416, -1.9657008354018894, -1.5440968819260528), 33.717, 89.972),
        ("w", 0.8357339603943704, (1.7311318213986158, 2.4836062707945676, 2.53211692701091,
         2.14582299899129, 0.8393092822950536, -1.6192552760218497), 175.673, 167.431),
    ],
)  # fmt: skip
def test_the_longest_of_several_ranges_is_the_same_at_every_step(
    of: str, band: float, lengths: tuple[float, ...], length: float, start: float
) -> None:
    dimensions = dict(zip(("a", "b", "c", "d", "p", "q"), lengths, strict=True))
    a, b, c, d = lengths[:4]
    size = abs(d - a)
    turn = math.degrees(math.acos((b**2 + size**2 - c**2) / (2 * b * size)))
    found = []
    for step in (5.0, 10.0, 30.0):
        mechanism = lw.loops(
            loops={"1": "a*e^(i*t) + b*e^(i*u) = d + c*e^(i*v)"},
            dimensions=dimensions,
            guess={"t": 0.0, "u": turn, "v": 90.0},
            inputs=lw.Input(variable="t", from_=0, to=360, step=step),
            outputs={
                "y": "a*sin(t) + p*sin(u) + q*cos(u)",
                "w": "hypot(a*cos(t) + p*cos(u) - q*sin(u), a*sin(t) + p*sin(u) + q*cos(u) - 1)",
            },
        )
        motion = mechanism.sweep()
        found.append([motion.value(f"{word}({of}, {band!r})") for word in ("dwell", "dwell_start")])
    for own in found[1:]:
        assert own == pytest.approx(found[0], abs=1e-8)
    # among 360,000 positions of the closed form
    assert found[0] == pytest.approx([length, start], abs=2e-3)


def test_a_range_in_time_ends_where_the_law_does() -> None:
    """By 60 deg of 3-4-5 over half a second, from 60 to 120 deg, then rest: 2.5 s to the end."""
    text = """
format = 1
[loops]
L = "1*e^(i*θ) + 3*e^(i*q) = s"
[guess]
"θ" = 60
q = -17
s = 3.3
[input]
variable = "θ"
begin = 60
law = [{law = "3-4-5", over = 0.5, by = 60}, {law = "dwell", over = 0.5}]
from = 0
to = 1
step = STEP
"""
    for step in ("0.01", "0.1"):
        motion = lw.loads(text.replace("STEP", step)).sweep()
        begin = motion.value("dwell_start(s, 0.1)")
        assert motion.value("dwell(s, 0.1)") == pytest.approx(1.0 - begin, abs=1e-9)
        x = 2.0 * begin
        crank = math.radians(60 + 60 * (10 * x**3 - 15 * x**4 + 6 * x**5))
        end = math.radians(120)
        slid = [math.cos(u) + math.sqrt(9 - math.sin(u) ** 2) for u in (crank, end)]
        assert slid[0] - slid[1] == pytest.approx(0.1, abs=1e-9)
