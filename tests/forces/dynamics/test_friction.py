"""Simulations with friction against closed forms, and an integrator of SciPy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import linkwork as lw

G = 9.81


def block(mu: float, tilt: float = 0.0, **fields: Any) -> lw.Mechanism:
    """A block of 2 kg on an incline, at 3 m of its way up."""
    way = complex(math.cos(tilt), math.sin(tilt))
    places = {"S": 0.0, "T": 10.0, "B": 3.0}
    return lw.linkage(
        length="m",
        points={name: (x * way.real, x * way.imag) for name, x in places.items()},
        links={"ground": ["S", "T"], "block": ["B"]},
        sliders=[lw.Slider(name="d", link="block", points=("B",), on="ground", line=("S", "T"))],
        masses={"block": lw.Mass(mass=2)},
        gravity=lw.Gravity(),
        friction={"d": lw.Friction(mu=mu)},
        inputs=lw.Input(slider="d", from_=0, to=5, step=1),
        **fields,
    )


def events(motion: lw.Motion, word: str) -> list[float]:
    return [float(t) for t, own in zip(motion["t"], motion.limit, strict=True) if own == word]


def test_a_block_on_an_incline_stops_and_is_held() -> None:
    mu, tilt, speed = 0.4, 0.3, 3.0
    motion = block(mu, tilt).simulate(2, step=0.25, start_speed=speed)
    slow = G * (math.sin(tilt) + mu * math.cos(tilt))
    assert events(motion, "rest") == pytest.approx([speed / slow], abs=1e-14)
    far = speed**2 / (2 * slow)
    assert motion["d"][-1] == pytest.approx(3 + far, abs=1e-13)
    assert motion["d.velocity"][-1] == 0.0
    assert "held by friction" in motion.message
    assert motion.friction_work is not None
    assert motion.friction_work[-1] == pytest.approx(mu * 2 * G * math.cos(tilt) * far, rel=1e-13)
    # at rest the friction is anything up to its limit
    statuses = block(mu, tilt).forces(motion=motion).statuses
    assert {s.name for s in statuses[:2]} == {"FOUND"}
    assert {s.name for s in statuses[2:]} == {"HELD"}
    assert np.isnan(motion["d.friction"][-1])


def test_a_block_on_a_steeper_incline_slides_back() -> None:
    mu, tilt, speed = 0.2, 0.3, 3.0
    motion = block(mu, tilt).simulate(2, step=0.25, start_speed=speed)
    up, down = (G * (math.sin(tilt) + way * mu * math.cos(tilt)) for way in (1, -1))
    turn = speed / up
    expected = 3 + speed * turn / 2 - 0.5 * down * (2 - turn) ** 2
    assert motion["d"][-1] == pytest.approx(expected, abs=1e-13)
    assert not events(motion, "rest")


def test_a_growing_force_starts_a_block_when_it_exceeds_friction() -> None:
    pull = lw.Load(point="B", link="block", force=("10*t", 0))
    motion = block(0.3, loads=[pull]).simulate(2, step=0.25)
    begin = 0.3 * 2 * G / 10
    # what is less than 1e-12 of the friction does not start it
    assert events(motion, "start") == pytest.approx([begin], rel=3e-12)
    # 2 s̈ = 10 (t - begin)
    assert motion["d"][-1] == pytest.approx(3 + 5 / 6 * (2 - begin) ** 3, abs=1e-12)
    assert motion["d"][motion["t"] < begin] == pytest.approx(3.0, abs=0.0)


def test_a_torsion_pendulum_loses_the_same_angle_every_half_swing() -> None:
    """A disc of 3 kg on a pin, which its weight loads: the moment of friction is μ r m g."""
    stiffness, inertia, moment = 2.0, 0.05, 0.6 * 0.01 * 3 * G
    begin = 1.0
    disc = lw.linkage(
        length="m",
        angle="rad",
        points={"O": (0, 0), "A": (math.cos(begin), math.sin(begin))},
        links={"ground": ["O"], "bar": ["O", "A"]},
        masses={"bar": lw.Mass(mass=3, center=(0, 0), inertia=inertia)},
        gravity=lw.Gravity(),
        springs=[lw.Spring(name="s", links=("ground", "bar"), stiffness=stiffness, free=0)],
        friction={"O": lw.Friction(mu=0.6, radius=0.01)},
        inputs=lw.Input(link="bar"),
    )
    half = math.pi * math.sqrt(inertia / stiffness)
    motion = disc.simulate(8 * half, step=half)
    loss = 2 * moment / stiffness
    for k in range(1, 6):
        swing = begin - k * loss
        assert motion["bar"][k] == pytest.approx((-1) ** k * swing, abs=1e-12)
    # it rests where the spring no longer overcomes the friction
    swings = math.ceil((begin - moment / stiffness) / loss)
    assert events(motion, "rest") == pytest.approx([swings * half], abs=1e-12)
    assert abs(motion["bar"][-1]) == pytest.approx(abs(begin - swings * loss), abs=1e-12)


def test_a_pendulum_with_a_rubbing_pin_is_that_of_an_integrator() -> None:
    """The moment of friction follows from the force in the pin, which depends on it."""
    arm, mass, inertia, rho = 0.8, 1.5, 0.02, 0.3 * 0.05

    def pull(angle: float, speed: float) -> float:
        def rest(bend: float) -> float:
            along = mass * (G * math.cos(angle) + arm * speed**2)
            across = mass * (G * math.sin(angle) + arm * bend)
            moment = rho * math.hypot(along, across)
            total = (inertia + mass * arm**2) * bend + mass * G * arm * math.sin(angle)
            return total + math.copysign(moment, speed)

        return float(brentq(rest, -100.0, 100.0, xtol=1e-14, rtol=1e-15))

    pendulum = lw.linkage(
        length="m",
        points={"O": (0, 0), "A": (1, 0)},
        links={"ground": ["O"], "bar": ["O", "A"]},
        masses={"bar": lw.Mass(mass=mass, center=(arm, 0), inertia=inertia)},
        gravity=lw.Gravity(),
        friction={"O": lw.Friction(mu=0.3, radius=0.05)},
        inputs=lw.Input(link="bar"),
    )
    # from the horizontal down and up to the first turn
    motion = pendulum.simulate(0.8, step=0.1, start_speed="-0.1 rad/s")
    wanted = solve_ivp(
        lambda _, y: (y[1], pull(*y)), (0, 0.8), (math.pi / 2, -0.1), "DOP853",
        t_eval=motion["t"], rtol=1e-12, atol=1e-13,
    )  # fmt: skip
    assert np.all(motion["bar.velocity"] < 0.0)
    assert np.radians(motion["bar"]) + math.pi / 2 == pytest.approx(wanted.y[0], abs=1e-11)
    # the forces of the rows are computed in another way: nothing drives the bar
    assert np.abs(motion["bar.effort"]).max() < 1e-11


def engine(mu: float = 0.1, guide: float = 0.1, length: float | None = None) -> lw.Mechanism:
    return lw.linkage(
        length="m",
        points={"O": (0, 0), "T": (0.01, 0), "A": (0.115, 0.164), "B": (0.897, 0)},
        links={"ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "B"], "block": ["B"]},
        lengths={"O A": 0.2, "A B": 0.8},
        sliders=[lw.Slider(name="d", link="block", points=("B",), on="ground", line=("O", "T"))],
        masses={
            "crank": lw.Mass(mass=3, center=(0.1, 0), inertia=0.05),
            "rod": lw.Mass(mass=1.5, shape="rod"),
            "block": lw.Mass(mass=1),
        },
        gravity=lw.Gravity(),
        friction={
            **{pin: lw.Friction(mu=mu, radius=0.02) for pin in "OAB"},
            "d": lw.Friction(mu=guide, length=length),
        },
        inputs=lw.Input(link="crank"),
    )


@pytest.mark.parametrize("length", [None, pytest.param(0.15, marks=pytest.mark.extended)])
def test_the_energy_of_an_engine_goes_into_its_friction(length: float | None) -> None:
    """Over a turn every joint turns back, and the guide's force changes sides."""
    motion = engine(length=length).simulate(0.4, step=0.02, start_speed="20 rad/s")
    assert motion["crank"][-1] > 400.0
    energy = motion["kinetic_energy"] + motion["stored_energy"]
    assert motion.friction_work is not None
    assert motion.friction_work[-1] > 0.05 * energy[0]
    assert energy + motion.friction_work == pytest.approx(energy[0], rel=1e-13)
    # the reactions of the rows, solved apart, leave nothing for the input to do
    assert np.abs(motion["crank.effort"]).max() < 1e-11
    assert motion["disagreement"].max() < 1e-12


@pytest.mark.extended
def test_little_friction_changes_little() -> None:
    """The limit without friction, which is linear in the coefficient."""
    ends = []
    for mu in (0.0, 1e-7, 2e-7):
        motion = engine(mu, mu).simulate(0.3, step=0.3, start_speed="20 rad/s")
        ends.append(float(motion["crank"][-1]))
    assert ends[1] == pytest.approx(ends[0], rel=1e-7)
    assert ends[2] - ends[0] == pytest.approx(2 * (ends[1] - ends[0]), rel=1e-4)


@pytest.mark.extended
def test_at_rest_an_engine_starts_where_the_effort_of_statics_is_exceeded() -> None:
    """And on the other side of its stall nothing starts it."""
    friction = {pin: lw.Friction(mu=0.3, radius=30) for pin in "OAB"}

    def pushed(force: float) -> lw.Mechanism:
        motor = lw.Motor(stall=force)
        return lw.linkage(
            length="mm",
            points={"O": (0, 0), "T": (10, 0), "A": (115, 164), "B": (897, 0)},
            links={"ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "B"], "block": ["B"]},
            lengths={"O A": 200, "A B": 800},
            sliders=[
                lw.Slider(name="d", link="block", points=("B",), on="ground", line=("O", "T"))
            ],
            masses={"crank": lw.Mass(mass=1, center=(0, 0), inertia=2000)},
            loads=[lw.Load(link="crank", torque=-3000)],
            friction={**friction, "d": lw.Friction(mu=0.2)},
            inputs=lw.Input(slider="d", from_=999.5, to=900, step=-33, motor=motor),
        )

    (stall,) = lw.forces.stalls(pushed(0))
    moves, locked = stall.bracket
    # the block moves against the direction of its slide there
    effort = float(pushed(0).forces(at=moves - 0.5)["d.effort"])
    for factor, held in ((0.999, True), (1.001, False)):
        motion = pushed(factor * effort).simulate(1e-5, step=1e-5, at=moves - 0.5)
        assert ("at rest since t = 0 s, held by friction" in motion.message) is held
        assert (motion["d"][-1] < motion["d"][0]) is not held
    motion = pushed(1000 * effort).simulate(1e-3, step=1e-3, at=locked)
    assert "held by friction" in motion.message


def test_friction_where_redundant_links_leave_forces_open_is_refused() -> None:
    cranks = lw.example("parallel-cranks")
    points = dict(cranks.description.points)  # type: ignore[attr-defined]
    pin = next(p for p in points if len(list(cranks.description.bodies_at(p))) == 2)  # type: ignore[attr-defined]
    links = [n for n in cranks.description.links if n != "ground"]  # type: ignore[attr-defined]
    loaded = cranks.changed(
        masses={link: lw.Mass(mass=1, shape="rod") for link in links},
        friction={pin: lw.Friction(mu=0.1, radius=5)},
    )
    with pytest.raises(lw.InputError, match="redundant links leave undetermined"):
        loaded.simulate(0.1)


@pytest.mark.extended
def test_events_at_the_same_place_are_all_met() -> None:
    """The compressor starts where its guide's force changes sides: after a turn both meet."""
    motion = lw.example("compressor").simulate(0.4, step=0.1)
    assert motion.found.all()
    assert motion["crank"][-1] > 90 + 2 * 360
