"""Flywheels, motors, harmonics, counterweights and inflection circles in closed form."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.mechanism.linkage import Linkage
from tests.described import described_as
from tests.forces.random_loads import loaded


def rotor(
    torque: str, *, speed: str = "300 rpm", length: str = "mm", step: float = 1.0
) -> lw.Mechanism:
    """A crank with a torque that resists."""
    return lw.linkage(
        length=length,
        points={"O": (0, 0), "A": (30, 0)},
        links={"ground": ["O"], "crank": ["O", "A"]},
        inputs=lw.Input(link="crank", from_=0, to=360, step=step, speed=speed),
        loads=[lw.Load(link="crank", torque=torque)],
    )


def test_a_flywheel_for_a_double_frequency_torque() -> None:
    """Torque 20 + 10 sin 2φ: the energy between its zeros is ∫ 10 sin 2φ dφ over a quarter = 10."""
    found = lw.design.flywheel(rotor("-(20 + 10*sin(2*crank))"), 0.02)
    speed = 300.0 * math.tau / 60.0
    # straight lines between rows of a degree: (2 h)² / 12
    assert found.energy == pytest.approx(10.0, rel=1.01 * (2 * math.radians(1)) ** 2 / 12)
    assert found.mean == pytest.approx(20.0)
    # 1 N mm is 1000 kg mm²/s²
    assert found.inertia == pytest.approx(1000.0 * found.energy / (0.02 * speed**2), rel=1e-12)
    assert found.units["inertia"] == "kg·mm²"
    # slowest after the quarter that takes more than the mean
    assert found.slowest % 180.0 == pytest.approx(90.0)
    assert found.fastest % 180.0 == pytest.approx(0.0)


def test_a_flywheel_lets_the_speed_fluctuate_as_asked() -> None:
    """Integrated: I ω dω = (mean - effort) dφ from the slowest to the fastest row."""
    machine = rotor("-(20 + 10*sin(2*crank) + 4*cos(5*crank))")
    fluctuation = 0.05
    found = lw.design.flywheel(machine, fluctuation)
    motion = machine.sweep()
    angle = np.radians(np.asarray(motion["crank"]))
    surplus = found.mean - np.asarray(motion["crank.effort"])
    energy = np.concatenate([[0.0], np.cumsum((surplus[1:] + surplus[:-1]) / 2.0 * np.diff(angle))])
    mean = 300.0 * math.tau / 60.0
    middle = (energy.max() + energy.min()) / 2.0
    speed = np.sqrt(mean**2 + 2.0 * (energy - middle) * 1000.0 / found.inertia)
    assert (speed.max() - speed.min()) / mean == pytest.approx(fluctuation, rel=2e-3)


def test_a_motor_has_to_give_the_peak_at_its_speed_and_the_mean_square_without_end() -> None:
    machine = rotor("-(20 + 10*sin(crank))")
    found = lw.design.motor_check(machine, stall=40.0, free_speed="1200 rpm", rated=22.0)
    assert found.available == pytest.approx(40.0 * (1.0 - 300.0 / 1200.0))
    assert (found.peak, found.peak_at) == pytest.approx((30.0, 90.0))
    # rms² = 20² + 10² / 2
    assert found.rms == pytest.approx(math.sqrt(450.0), rel=1e-4)
    assert found.power == pytest.approx(30.0 * 300.0 * math.tau / 60.0)
    assert found.fits
    assert not lw.design.motor_check(machine, stall=39.0, free_speed="1200 rpm").fits
    assert not lw.design.motor_check(machine, stall=60.0, free_speed="1200 rpm", rated=21.0).fits


def test_a_motor_may_be_a_table_or_that_of_the_file() -> None:
    machine = rotor("-(20 + 10*sin(crank))")
    table = lw.Motor(speeds=("0 rpm", "200 rpm", "400 rpm"), torques=(50, 38, 24))
    # straight between its speeds
    assert lw.design.motor_check(machine, motor=table).available == pytest.approx(31.0, rel=1e-14)
    own = machine.changed(inputs=replace(machine.description.inputs[0], motor=table))
    assert lw.design.motor_check(own).available == pytest.approx(31.0, rel=1e-14)
    short = lw.Motor(speeds=("0 rpm", "200 rpm"), torques=(50, 38))
    with pytest.raises(lw.InputError, match="from 0 rpm to 200 rpm, but the input turns at 300"):
        lw.design.motor_check(machine, motor=short)
    with pytest.raises(lw.InputError, match="there is no motor"):
        lw.design.motor_check(machine)


def test_harmonics_of_a_sum_of_sines_are_its_terms() -> None:
    found = lw.design.harmonics(
        rotor("-(7 + 3*cos(crank - 0.5) + 2*sin(4*crank))"), "crank.effort", 5
    )
    assert found.mean == pytest.approx(7.0)
    assert found.amplitude == pytest.approx([3.0, 0.0, 0.0, 2.0, 0.0], abs=1e-12)
    assert found.phase[0] == pytest.approx(0.5)  # degrees, as all angles in formulas of this file
    assert found.phase[3] == pytest.approx(22.5)
    assert found.rest < 1e-12


def test_a_slider_crank_shakes_at_once_and_twice_its_speed() -> None:
    """Norton, Design of Machinery, ch. 13: -m r ω² (cos φ + λ cos 2φ), to the fourth power of λ."""
    crank, rod, mass, speed = 20.0, 200.0, 3.0, 10.0
    engine = lw.linkage(
        length="mm",
        points={"O": (0, 0), "T": (10, 0), "A": (0, crank), "B": (math.sqrt(rod**2 - 400.0), 0)},
        links={"ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "B"], "piston": ["B"]},
        lengths={"O A": crank, "A B": rod},
        sliders=[lw.Slider(name="d", link="piston", points=("B",), on="ground", line=("O", "T"))],
        masses={"piston": lw.Mass(mass=mass)},
        inputs=lw.Input(link="crank", from_=0, to=360, step=5, speed=f"{speed} rad/s"),
    )
    found = lw.design.harmonics(engine, "shaking.x", 4)
    size, ratio = mass * crank * speed**2 / 1000.0, crank / rod
    second = size * (ratio + ratio**3 / 4.0 + 15.0 * ratio**5 / 128.0)
    assert found.amplitude[0] == pytest.approx(size, rel=1e-12)
    assert found.amplitude[1] == pytest.approx(second, rel=1e-6)
    assert found.amplitude[2] == pytest.approx(0.0, abs=1e-12)


def test_counterweights_remove_the_shaking_force_whatever_the_masses_are() -> None:
    bar = loaded(lw.example("four-bar"), seed=5)
    found = lw.design.counterweights(bar, radius={"crank": 15.0, "rocker": 25.0})
    assert found.force[1] < 1e-12 * found.force[0]
    crank, rocker = found.weights
    assert math.hypot(*crank.place) == pytest.approx(15.0)
    assert rocker.link == "rocker"
    assert rocker.mass * 25.0 == pytest.approx(rocker.product)
    # with gravity the ground carries the weight alone, which does not change
    balanced = lw.design.balanced(bar.changed(loads=()), {"crank": 15.0, "rocker": 25.0}).forces()
    numbers = [float(mass.mass) for mass in balanced_masses(bar)]
    assert np.asarray(balanced["shaking.y"]) == pytest.approx(-9.81 * sum(numbers), rel=1e-12)
    assert np.asarray(balanced["shaking.x"]) == pytest.approx(0.0, abs=1e-9 * sum(numbers))


def balanced_masses(bar: lw.Mechanism) -> list[lw.Mass]:
    balanced = lw.design.balanced(bar, {"crank": 15.0, "rocker": 25.0})
    return list(described_as(Linkage, balanced).masses.values())


def test_counterweights_of_a_uniform_four_bar() -> None:
    """Uniform rods: the crank's own half, and the coupler's mass shared by both of its pins."""
    lengths = {"ground": 80.0, "crank": 30.0, "coupler": 90.0, "rocker": 70.0}
    density = 0.01
    bar = lw.linkage(
        length="mm",
        points={"P": (0, 0), "Q": (80, 0), "A": (0, 30), "B": (75, 69)},
        links={
            "ground": ["P", "Q"],
            "crank": ["P", "A"],
            "coupler": ["A", "B"],
            "rocker": ["Q", "B"],
        },
        lengths={"P A": 30, "A B": 90, "Q B": 70},
        masses={
            name: lw.Mass(mass=density * lengths[name], shape="rod")
            for name in ("crank", "coupler", "rocker")
        },
        inputs=lw.Input(link="crank", from_=0, to=360, step=10, speed="60 rpm"),
    )
    crank, rocker = lw.design.counterweights(bar, radius=10.0).weights
    for weight, own in ((crank, 30.0), (rocker, 70.0)):
        assert weight.product == pytest.approx(density * (own + 90.0) / 2.0 * own)
        assert abs(weight.angle) == pytest.approx(180.0)


def test_a_rolling_wheel_has_its_inflection_circle_through_its_centre() -> None:
    """The centre moves straight, and the pole is the contact: the diameter is the radius."""
    wheel = lw.example("rolling-wheel")
    circle = lw.design.inflection_circle(wheel, "wheel", at=-120)
    centre = wheel.solve(at=-120).points["C"]
    assert circle.inflection_pole == pytest.approx(centre)
    assert circle.diameter == pytest.approx(abs(centre[1]))
    assert circle.pole == pytest.approx((centre[0], 0.0))


def test_points_on_the_inflection_circle_have_straight_paths() -> None:
    bar = lw.example("four-bar")
    circle = lw.design.inflection_circle(bar, "coupler", at=100)
    radius = circle.diameter / 2.0
    for angle in (10.0, 130.0, 250.0):
        way = radius * np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
        place = np.add(circle.center, way)
        found = bar.solve(at=100)
        a, b = (complex(*found.points[p]) for p in ("A", "B"))
        local = (complex(*place) - a) / (b - a)
        # the point fixed in the coupler
        first, second = (
            complex(1 - local.real, -local.imag) * complex(rates["A.x"], rates["A.y"])
            + local * complex(rates["B.x"], rates["B.y"])
            for rates in (found.first, found.second)
        )
        size = abs(first) * abs(second)
        assert (first.conjugate() * second).imag == pytest.approx(0.0, abs=1e-9 * size)


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda m: lw.design.flywheel(m, 0.0), "must be positive, got 0"),
        (
            lambda m: lw.design.flywheel(m.changed(inputs=lw.Input(link="crank")), 0.1),
            "needs the speed",
        ),
        (
            lambda m: lw.design.harmonics(
                m.changed(inputs=lw.Input(link="crank", to=90, speed="1 rpm")), "crank.effort"
            ),
            "needs a whole turn in equal steps, the table goes from 0 to 90 deg",
        ),
        (
            lambda m: lw.design.harmonics(m, "crank.effort", 200),
            "360 rows of a turn give from 1 to 179",
        ),
        (lambda m: lw.design.motor_check(m, stall=0, free_speed="1 rpm"), "stall must be positive"),
        (
            lambda m: lw.design.motor_check(m, stall=1, free_speed="9 mm/s"),
            "free_speed must be a number and",
        ),
        (lambda m: lw.design.counterweights(m, 10), "no four-bar with pins only"),
        (lambda m: lw.design.counterweights(lw.example("four-bar"), 10), "no masses to balance"),
        (
            lambda m: lw.design.inflection_circle(lw.example("crank-press"), "ram", at=60),
            "does not turn",
        ),
    ],
)
def test_wrong_questions_say_what_is_missing(ask: object, message: str) -> None:
    assert callable(ask)
    with pytest.raises(InputError, match=message):
        ask(rotor("-5"))


def test_an_unknown_link_has_no_inflection_circle() -> None:
    with pytest.raises(UnknownNameError, match='there is no link "rod"'):
        lw.design.inflection_circle(lw.example("four-bar"), "rod")
