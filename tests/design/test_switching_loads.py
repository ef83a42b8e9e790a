"""Integrals over a cycle of loads that switch, in closed form."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import linkwork as lw

SPEED = 300.0 * math.tau / 60.0  # rad/s, of all rotors
ROUNDING = 1e-11  # of a sum over pieces


def rotor(
    torque: str, *, step: float = 1.0, start: float = 0.0, stop: float = 360.0
) -> lw.Mechanism:
    return lw.linkage(
        length="m",
        points={"O": (0, 0), "A": (0.03, 0)},
        links={"ground": ["O"], "crank": ["O", "A"]},
        inputs=lw.Input(link="crank", from_=start, to=stop, step=step, speed="300 rpm"),
        loads=[lw.Load(link="crank", torque=torque)],
    )


@pytest.mark.parametrize("step", [1.0, 5.0, 30.0])
@pytest.mark.parametrize("width", [0.01, 0.8, 3.9])
def test_a_pulse_is_seen_however_short_it_is(width: float, step: float) -> None:
    """The mean is 100 + 20,000 of the pulse's share; the flywheel gives what the pulse exceeds."""
    pulse = f"20000*(crank > 100.1)*(crank < {100.1 + width})"
    found = lw.design.flywheel(rotor(f"-(100 + {pulse})", step=step), 0.02)
    mean = 100.0 + 20000.0 * width / 360.0
    energy = (20100.0 - mean) * math.radians(width)
    assert found.mean == pytest.approx(mean, rel=ROUNDING)
    # the width itself is a difference of numbers of a hundred
    assert found.inertia == pytest.approx(energy / (0.02 * SPEED**2), rel=1e-14 * 400.0 / width)
    # the pulse ends slowest; between turns the speed rises up to its start
    assert found.slowest == pytest.approx(100.1 + width, rel=1e-12)
    assert found.fastest == pytest.approx(100.1, rel=1e-12)


@pytest.mark.parametrize(
    ("pulse", "area"),
    [
        ("2000*(abs(crank - 100.5) < 0.2)", 2000 * math.radians(0.4)),
        # ∫ (cos x - cos a) between its zeros, for a of 0.81 degrees
        (
            "2000*max(0, sin(crank) - 0.9999)",
            4000 * (math.sin(math.acos(0.9999)) - 0.9999 * math.acos(0.9999)),
        ),
        ("2000*(0.3 - min(0.3, abs(crank - 37.3)))", 2000 * 0.3 * math.radians(0.3)),
        ("2000*(A.x > 0.02999)", 4000 * math.acos(0.02999 / 0.03)),
    ],
)
def test_switches_lie_at_zeros_within_a_step(pulse: str, area: float) -> None:
    """Two changes of sign between neighbouring rows, also of functions with corners."""
    found = lw.design.flywheel(rotor(f"-(100 + {pulse})", step=5.0), 0.02)
    # arc cosines near 1 lose half their digits
    assert found.mean - 100.0 == pytest.approx(area / math.tau, rel=1e-9)


@pytest.mark.parametrize(("start", "stop"), [(0.0, 360.0), (360.0, 0.0), (-200.0, 160.0)])
def test_harmonics_of_a_pulse_are_its_fourier_series(start: float, stop: float) -> None:
    pulse = "-(100 + 2000*(crank > 100.1)*(crank < 100.9))"
    machine = rotor(pulse, step=math.copysign(1.0, stop - start), start=start, stop=stop)
    found = lw.design.harmonics(machine, "crank.effort", 40)
    orders = np.arange(1, 41)
    exact = 2.0 * 2000.0 / (math.pi * orders) * np.sin(orders * math.radians(0.4))
    assert found.amplitude == pytest.approx(exact, rel=1e-11)
    assert found.phase == pytest.approx(np.mod(100.5, 360.0 / orders), abs=1e-9)


def test_a_motor_bears_the_peak_and_the_mean_square_of_a_pulse() -> None:
    machine = rotor("-(100 + 2000*(crank > 100.1)*(crank < 100.9))", step=5.0)
    found = lw.design.motor_check(machine, stall=2000.0, free_speed="1200 rpm")
    square = 100.0**2 + (2100.0**2 - 100.0**2) * 0.8 / 360.0
    assert found.rms == pytest.approx(math.sqrt(square), rel=ROUNDING)
    assert found.peak == pytest.approx(2100.0, rel=1e-13)
    assert found.peak_at == pytest.approx(100.1, rel=1e-12)
    assert found.reserve == pytest.approx(1500.0 - 2100.0, rel=1e-12)
    assert not found.fits


def test_a_spring_through_no_length_turns_round_within_a_step() -> None:
    """A pin that passes the spring's fixed end: length 2 r |sin δ/2|, and the effort jumps by
    twice stiffness times free length times r.
    """
    r, stiffness, free, place = 0.03, 1000.0, 0.02, math.radians(50.3)
    machine = lw.linkage(
        length="m",
        points={"O": (0, 0), "P": (r * math.cos(place), r * math.sin(place)), "A": (r, 0)},
        links={"ground": ["O", "P"], "crank": ["O", "A"]},
        inputs=lw.Input(link="crank", from_=0, to=360, step=5, speed="300 rpm"),
        springs=[lw.Spring(name="k", between=("P", "A"), stiffness=stiffness, free=free)],
    )
    found = lw.design.motor_check(machine, stall=1.0, free_speed="1200 rpm")
    x, w = np.polynomial.legendre.leggauss(60)
    half = math.pi * (1.0 + x) / 2.0
    effort = stiffness * (2.0 * r * np.sin(half) - free) * r * np.cos(half)
    assert found.rms == pytest.approx(math.sqrt(float(w @ effort**2) / 2.0), rel=ROUNDING)
    # the pin meets the end to the rounding of the file's numbers
    assert found.peak == pytest.approx(stiffness * free * r, rel=1e-9)


def test_the_jumps_of_a_cams_law_are_closed_in() -> None:
    """Harmonic rise over 90° and return over 270°: the acceleration jumps where they meet. The
    mean square of m s̈ s' is a sum of two integrals of sin² 2α.
    """
    mass, speed, lift = 2.0, SPEED, 0.02
    cam = lw.linkage(
        length="m",
        points={"O": (0, 0), "F": (0, 0.04), "T": (0, 0.1)},
        links={"ground": ["O", "T"], "disc": ["O"], "follower": ["F"]},
        sliders=[
            lw.Slider(name="s", link="follower", points=("F",), on="ground", line=("O", "T"))
        ],
        cams=[
            lw.Cam(
                name="cam", cam="disc", center="O", slider="s", contact="flat", base=0.04,
                segments=(
                    lw.Segment(law="harmonic", over=90, lift=lift),
                    lw.Segment(law="harmonic", over=270, lift=-lift),
                ),
            )
        ],
        masses={"follower": lw.Mass(mass=mass)},
        inputs=lw.Input(link="disc", from_=0, to=360, step=7.2, speed="300 rpm"),
    )  # fmt: skip
    found = lw.design.motor_check(cam, stall=1e3, free_speed="1200 rpm")
    square = 0.0
    for over in (math.pi / 2, 1.5 * math.pi):
        n = math.pi / over
        # s' s'' = (lift/2)² n³ sin cos = (lift/2)² n³/2 sin 2α, whose mean square is ½
        size = mass * speed**2 * (lift / 2.0) ** 2 * n**3 / 2.0
        square += over * size**2 / 2.0
    assert found.rms == pytest.approx(math.sqrt(square / math.tau), rel=1e-9)


def arm(law: tuple[lw.LawSegment, ...]) -> lw.Mechanism:
    """A rod on a horizontal axis, moved by a law."""
    return lw.linkage(
        length="m",
        points={"O": (0, 0), "A": (1, 0)},
        links={"ground": ["O"], "arm": ["O", "A"]},
        masses={"arm": lw.Mass(mass=3, shape="rod")},
        gravity=lw.Gravity(size="9.81 m/s^2"),
        inputs=lw.Input(link="arm", from_=0, to=1, step=0.01, begin=0, law=law),
    )


def there_and_back() -> lw.Mechanism:
    return arm(
        (
            lw.LawSegment(law="3-4-5", over="0.5 s", by=90),
            lw.LawSegment(law="3-4-5", over="0.5 s", by=-90),
        )
    )


def test_a_motor_is_sized_over_the_whole_time_of_a_law() -> None:
    """Torque J φ̈ + m g cos φ / 2 of the 3-4-5 polynomial, on a fine grid."""
    found = lw.design.motor_check(there_and_back(), stall=200, free_speed="120 rpm")
    x = np.linspace(0.0, 1.0, 200_001)
    angle = math.pi / 2 * (10 * x**3 - 15 * x**4 + 6 * x**5)
    rate = math.pi / 2 / 0.5 * (30 * x**2 - 60 * x**3 + 30 * x**4)
    bend = math.pi / 2 / 0.25 * (60 * x - 180 * x**2 + 120 * x**3)
    weight = 3.0 * 9.81 * 0.5 * np.cos(angle)
    there, back = bend + weight, -bend + 3.0 * 9.81 * 0.5 * np.sin(angle)
    squares = (np.trapezoid(there**2, x) + np.trapezoid(back**2, x)) / 2.0
    # the trapezoidal rule's own error
    assert found.rms == pytest.approx(math.sqrt(squares), rel=1e-8)
    assert found.peak == pytest.approx(max(np.abs(there).max(), np.abs(back).max()), rel=1e-8)
    assert found.power == pytest.approx(np.max(there * rate), rel=1e-8)
    free = 120.0 * math.tau / 60.0
    left = 200.0 * (1.0 - rate / free) - np.abs(there)
    assert found.reserve == pytest.approx(left.min(), rel=1e-8)
    assert found.fits
    assert found.units["input"] == "s"
    # fast where it needs little torque, but too fast for this motor
    assert not lw.design.motor_check(there_and_back(), stall=200, free_speed="50 rpm").fits


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda m: lw.design.flywheel(m, 0.05), "a law fixes the speed of the input"),
        (
            lambda m: lw.design.harmonics(m, "arm.effort"),
            "needs a turn of the input at constant speed",
        ),
        (lambda m: lw.design.counterweights(m, 0.1), "no four-bar"),
        (lambda m: lw.forces.equilibria(m), "a law drives"),
        (
            lambda m: lw.design.motor_check(
                m, motor=lw.Motor(speeds=("0 rpm", "20 rpm"), torques=(9, 9))
            ),
            "from 0 rpm to 20 rpm, but the input turns at",
        ),
    ],
)
def test_questions_that_a_law_leaves_without_sense_say_so(ask: object, message: str) -> None:
    assert callable(ask)
    with pytest.raises(lw.InputError, match=message):
        ask(there_and_back())


def test_a_motor_check_needs_one_input() -> None:
    robot = lw.example("five-bar-robot")
    with pytest.raises(lw.InputError, match="needs one input, the mechanism has 2"):
        lw.design.motor_check(robot, stall=1, free_speed="1 rpm")


def test_counterweights_balance_a_four_bar_that_a_law_drives() -> None:
    bar = lw.example("four-bar").changed(masses={"coupler": lw.Mass(mass=2, shape="rod")})
    inputs = replace(
        bar.description.inputs[0], from_=0, to=1, step=0.05, speed=None,
        law=(lw.LawSegment(law="3-4-5", over="1 s", by=200),),
    )  # fmt: skip
    found = lw.design.counterweights(bar.changed(inputs=inputs), radius=20)
    assert found.force[1] < 1e-12 * found.force[0]
