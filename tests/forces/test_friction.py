"""Friction by hand: lines of force that touch friction circles, wedges, teeth, and self-locking."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping

import numpy as np
import pytest
from scipy.optimize import brentq

import linkwork as lw
from linkwork.core.foundation.errors import MechanismError, MechanismFileError
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.textfile.writer import TextEdits, write_text
from linkwork.design.edits.entries import copy_selection, rename
from tests.described import described_as
from tests.forces.random_loads import loaded, rubbed

CRANK, ROD, LOAD = 200.0, 800.0, 100.0


def slider_crank(
    mu: float, radius: float, guide: float, *, driven: str = "crank", speed: float | None = None
) -> lw.Mechanism:
    """A crank of 200 and a rod of 800 in line; 100 N push the block, or a torque resists."""
    friction = {name: lw.Friction(mu=mu, radius=radius) for name in "OAB"}
    load = lw.Load(point="B", link="block", force=(-LOAD, 0))
    which = lw.Input(link="crank", from_=0, to=360, step=5, speed=speed)
    if driven == "d":
        load = lw.Load(link="crank", torque=-3000)
        which = lw.Input(slider="d", from_=999.5, to=900, step=-33, speed=speed)
    return lw.linkage(
        length="mm",
        points={"O": (0, 0), "T": (10, 0), "A": (115, 164), "B": (897, 0)},
        links={"ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "B"], "block": ["B"]},
        lengths={"O A": CRANK, "A B": ROD},
        sliders=[lw.Slider(name="d", link="block", points=("B",), on="ground", line=("O", "T"))],
        loads=[load],
        friction={**friction, "d": lw.Friction(mu=guide)},
        inputs=which,
    )


def line_of_force(theta: float, at_a: float, at_b: float) -> tuple[complex, complex]:
    """A point and the direction of the line that touches the friction circles of the rod's pins,
    at these signed distances to the left of A and of B as seen from A.
    """
    a = CRANK * cmath.exp(1j * theta)
    b = complex(a.real + math.sqrt(ROD**2 - a.imag**2), 0.0)
    rod = (b - a) / ROD
    # the distances from the line grow from at_a to at_b over the rod
    turn = cmath.exp(1j * math.asin((at_b - at_a) / ROD))
    return a + at_a * 1j * rod * turn, rod * turn


def arm(theta: float, at_a: float, at_b: float) -> float:
    """The distance of that line from O, positive if O is to its left."""
    point, along = line_of_force(theta, at_a, at_b)
    return (along.conjugate() * -point).imag


def test_without_friction_the_torque_is_exact() -> None:
    found = slider_crank(0.0, 20.0, 0.0).forces(at=55)
    # the length of the crank times the sine of its angle with the rod over the cosine of the rod's
    assert abs(float(found["crank.effort"])) == pytest.approx(18783.139283, abs=5e-7)
    assert found["efficiency"] == pytest.approx(1.0, rel=1e-14)


def test_the_limit_of_small_friction_is_none() -> None:
    efforts = [
        float(slider_crank(mu, 20.0, mu).forces(at=55)["crank.effort"]) for mu in (0.0, 1e-8, 2e-8)
    ]
    assert efforts[1] == pytest.approx(efforts[0], rel=1e-8)
    # and linear in the coefficient
    assert efforts[2] - efforts[0] == pytest.approx(2.0 * (efforts[1] - efforts[0]), rel=1e-5)


@pytest.mark.parametrize(("mu", "radius", "guide"), [(0.1, 20.0, 0.1), (0.9, 30.0, 0.3)])
@pytest.mark.parametrize("turning", [1.0, -1.0])
def test_the_rod_pushes_along_a_line_that_touches_the_friction_circles(
    mu: float, radius: float, guide: float, turning: float
) -> None:
    theta, rho = math.radians(55.0), mu * radius
    found = slider_crank(mu, radius, guide, speed=turning).forces(at=55)
    # rates of the rod are opposite to the crank's here, so that both pins turn the same way
    _, along = line_of_force(theta, -turning * rho, turning * rho)
    # friction holds the block against the load where the crank turns forwards
    push = LOAD / (along.real + turning * guide * abs(along.imag))
    force = complex(found["B.force.x"], found["B.force.y"])
    assert force.imag / force.real == pytest.approx(along.imag / along.real, rel=1e-12)
    assert abs(force) == pytest.approx(push, rel=1e-12)
    distance = arm(theta, -turning * rho, turning * rho)
    torque = push * (distance + turning * rho)
    assert found["crank.effort"] == pytest.approx(torque, rel=1e-12)
    assert found["disagreement"] < 1e-13


def test_at_rest_any_effort_between_those_of_both_directions_holds() -> None:
    forwards, backwards = (
        float(slider_crank(0.2, 20.0, 0.1, speed=way).forces(at=55)["crank.effort"])
        for way in (1.0, -1.0)
    )
    rest = slider_crank(0.2, 20.0, 0.1).forces(at=55)
    assert rest["crank.effort"] == pytest.approx(forwards, rel=1e-13)
    assert rest["crank.effort.backward"] == pytest.approx(backwards, rel=1e-13)
    assert backwards < forwards < 0.0  # the load drives the crank forwards: it has to be held


def test_a_slider_crank_driven_at_its_slider_stalls_where_the_rod_meets_the_friction_circle() -> (
    None
):
    """Force lines that touch the circles of A, B and O transmit no torque to the crank."""
    mechanism = slider_crank(0.3, 30.0, 0.2, driven="d")
    (stall,) = lw.forces.stalls(mechanism)
    rho = 0.3 * 30.0
    angle = brentq(lambda theta: arm(theta, -rho, rho) + rho, 0.01, 0.5, xtol=1e-15)
    assert math.radians(stall.position["crank"]) == pytest.approx(angle, abs=1e-9)
    assert stall.proved
    moves, locked = stall.bracket
    assert locked - moves == pytest.approx(0.0, abs=1e-3)
    assert mechanism.forces(at=moves).status is lw.forces.ForceStatus.FOUND
    lock = mechanism.forces(at=locked)
    assert lock.status is lw.forces.ForceStatus.SELF_LOCKING
    assert lock.proved
    assert math.isnan(lock["d.effort"])


def trammel(mu: float) -> lw.Mechanism:
    """A rod between a driven slide along x and a loaded one along y."""
    return lw.linkage(
        points={"O": (0, 0), "X": (1, 0), "Y": (0, 1), "P": (60, 0), "Q": (0, 80)},
        links={"ground": ["O", "X", "Y"], "rod": ["P", "Q"], "first": ["P"], "second": ["Q"]},
        sliders=[
            lw.Slider(name="x", link="first", points=("P",), on="ground", line=("O", "X")),
            lw.Slider(name="y", link="second", points=("Q",), on="ground", line=("O", "Y")),
        ],
        loads=[lw.Load(point="Q", link="second", force=(0, -10))],
        friction={"x": lw.Friction(mu=mu), "y": lw.Friction(mu=mu)},
        inputs=lw.Input(slider="x", from_=99, to=50, step=-16),
    )


def test_a_wedge_locks_at_the_angle_of_friction() -> None:
    """The rod at φ lifts the load while tan φ exceeds μ; the effort follows by two triangles."""
    mu = 0.4
    mechanism = trammel(mu)
    (stall,) = lw.forces.stalls(mechanism)
    assert stall.value == pytest.approx(100.0 * math.cos(math.atan(mu)), rel=1e-9)
    assert stall.proved
    rows = mechanism.forces()
    x = np.asarray(rows.inputs["x"])
    slope = np.sqrt(100.0**2 - x**2) / x
    moves = slope > mu
    push = 10.0 / (slope - mu)  # across, of a rod that lifts the load and the slide's friction
    wanted = np.where(moves, -push * (1.0 + mu * slope), np.nan)
    assert np.asarray(rows["x.effort"]) == pytest.approx(wanted, rel=1e-11, nan_ok=True)
    assert [s.name for s in rows.statuses] == ["FOUND" if m else "SELF_LOCKING" for m in moves]
    assert rows.proved.all()
    # the frictionless effort over that with friction
    useful = 10.0 / slope / (push * (1.0 + mu * slope))
    efficiency = np.where(moves, useful, np.nan)
    assert np.asarray(rows["efficiency"]) == pytest.approx(efficiency, rel=1e-11, nan_ok=True)


def drawer(length: float, side: float) -> lw.Mechanism:
    """A drawer that is pulled back by a force beside its line."""
    return lw.linkage(
        points={"S": (0, 0), "T": (10, 0), "B": (3, 0), "C": (3, side)},
        links={"ground": ["S", "T"], "block": ["B", "C"]},
        sliders=[lw.Slider(name="d", link="block", points=("B",), on="ground", line=("S", "T"))],
        loads=[lw.Load(point="C", force=(-7, 0))],
        friction={"d": lw.Friction(mu=0.25, length=length)},
        inputs=lw.Input(slider="d", from_=0, to=5, step=1),
    )


def test_the_ends_of_a_guide_press_with_the_moment() -> None:
    found = drawer(20.0, 4.0).forces(at=2)
    # 28 N mm press each end with 28 / 20 N
    assert abs(float(found["d.friction"])) == pytest.approx(2.0 * 0.25 * 28.0 / 20.0)
    assert found["d.effort"] == pytest.approx(7.0 + 0.7)
    assert found["d.effort.backward"] == pytest.approx(7.0 - 0.7)


def test_a_light_load_on_its_own_does_not_drive_a_mechanism_back() -> None:
    found = drawer(20.0, 50.0).forces(at=2)
    assert found["d.effort.backward"] < 0.0 < found["d.effort"]
    driven = drawer(20.0, 50.0).changed(
        inputs=lw.Input(slider="d", from_=5, to=0, step=-1)
    ).forces(at=2)  # fmt: skip
    assert driven["efficiency"] == pytest.approx((7.0 - 2.0 * 0.25 * 7.0 * 50.0 / 20.0) / 7.0)


@pytest.mark.parametrize("speed", [2.0, -2.0])
def test_teeth_lose_power_by_sliding(speed: float) -> None:
    mu, radius, pressure = 0.08, 3.0, 25.0
    pair = lw.linkage(
        length="mm",
        points={"O": (0, 0), "P": (60, 0)},
        links={"ground": ["O", "P"], "first": ["O"], "second": ["P"]},
        gears=[
            lw.Gear(
                name="mesh", wheels=("first", "second"), centers=("O", "P"), radii=(20, 40),
                pressure_angle=pressure,
            )
        ],
        inputs=lw.Input(link="first", speed=speed),
        loads=[lw.Load(link="second", torque=800.0 * math.copysign(1.0, speed))],
        friction={"mesh": lw.Friction(mu=mu, radius=radius)},
    )  # fmt: skip
    found = pair.forces(at=30)
    # T on the second wheel balances 800 and the moment of friction μ g T / cos α
    tangent = 800.0 / (40.0 - mu * radius / math.cos(math.radians(pressure)))
    couple = mu * radius * tangent / math.cos(math.radians(pressure))
    assert abs(float(found["mesh.tangent"])) == pytest.approx(tangent, rel=1e-12)
    assert abs(float(found["mesh.friction"])) == pytest.approx(couple, rel=1e-12)
    # pitch lines move together, and the wheels turn on each other at the sum of their speeds
    rates = math.radians(2.0) * (1.0 + 0.5)
    assert found["friction_power"] == pytest.approx(couple * rates, rel=1e-12)
    assert found["efficiency"] == pytest.approx(400.0 / (400.0 + 1.5 * couple), rel=1e-12)


def test_a_wheel_slips_beyond_its_adhesion() -> None:
    wheel = lw.example("rolling-wheel")
    given = described_as(Linkage, wheel)
    (rolling,) = given.rolling
    loads = [lw.Load(point=rolling.center, force=(3, -10))]
    for mu, slips in ((0.5, False), (0.1, True)):
        found = wheel.changed(loads=loads, friction={rolling.name: lw.Friction(mu=mu)}).forces()
        assert bool(np.any(found.slipping[f"{rolling.name}.tangent"])) is slips


RUBBING = (
    "slider-crank", "whitworth", "geared-five-bar", "rack-and-pinion", "elliptical-gears",
    "cam-swinging-follower", "curved-slot", "stephenson-valve-gear", "toggle-press", "scotch-yoke",
)  # fmt: skip


@pytest.mark.parametrize("name", RUBBING)
def test_two_ways_agree_with_friction_in_every_joint(name: str) -> None:
    mechanism = rubbed(loaded(lw.example(name), seed=len(name)), 0.1)
    values = mechanism.description.rows(mechanism.description.inputs[0])
    at = float(values[len(values) // 3])
    found = mechanism.forces(at)
    assert found.status is lw.forces.ForceStatus.FOUND
    assert found["disagreement"] < 1e-10
    names = ("power", "load_power", "energy_rate", "friction_power")
    power, loads, rate, friction = (float(found[n]) for n in names)
    assert friction > 0.0
    # the ways are independent: without the friction in the sum of works they differ
    terms = (power, loads, rate, friction)
    assert abs(power + loads - friction - rate) < 1e-11 * sum(map(abs, terms))


def _rubbing_in(length: str, size: float) -> lw.forces.Reactions:
    """A slider-crank with a geared wheel and friction everywhere, in units of 1/size mm."""
    friction = {p: lw.Friction(mu=0.1, radius=6 * size) for p in "AB"}
    return lw.linkage(
        length=length,
        points={name: (x * size, y * size) for name, (x, y) in {
            "O": (0, 0), "T": (10, 0), "A": (30, 25), "B": (140, 0), "Q": (0, -60)}.items()},
        links={"ground": ["O", "T", "Q"], "crank": ["O", "A"], "rod": ["A", "B"], "block": ["B"],
               "wheel": ["Q"]},
        gears=[lw.Gear(name="mesh", wheels=("crank", "wheel"), centers=("O", "Q"),
                       radii=(20 * size, 40 * size))],
        sliders=[lw.Slider(name="d", link="block", points=("B",), on="ground", line=("O", "T"))],
        loads=[lw.Load(point="B", link="block", force=(-80, 5)),
               lw.Load(link="wheel", torque=-2000 * size)],
        friction={**friction, "d": lw.Friction(mu=0.12, length=40 * size),
                  "mesh": lw.Friction(mu=0.06, radius=2 * size)},
        inputs=lw.Input(link="crank", from_=0, to=360, step=15),
    ).forces()  # fmt: skip


def test_the_unit_of_length_changes_no_friction() -> None:
    """Moments are small numbers in metres; they are solved as precisely as forces."""
    millimetres, metres = _rubbing_in("mm", 1.0), _rubbing_in("m", 1e-3)
    for name, values in millimetres.values.items():
        if name == "disagreement":
            continue
        factor = 1e-3 if "mm" in millimetres.units[name] else 1.0
        wanted = factor * np.asarray(values)
        near = 1e-13 * np.abs(wanted).max()
        assert np.asarray(metres[name]) == pytest.approx(wanted, rel=0, abs=near), name


def test_friction_of_stressed_joints_leaves_the_effort_undetermined() -> None:
    cranks = loaded(lw.example("parallel-cranks"))
    given = described_as(Linkage, cranks)
    pin = next(p for p in given.points if len(list(given.bodies_at(p))) == 2)
    found = cranks.changed(friction={pin: lw.Friction(mu=0.1, radius=5)}).forces(at=70)
    assert found.status is lw.forces.ForceStatus.UNDETERMINED
    assert math.isnan(found[found.efforts[0]])


def test_friction_reads_back_and_is_renamed_with_its_joint() -> None:
    given = slider_crank(0.1, 20.0, 0.15)
    text = write_text(given.description)
    assert lw.loads(text).description == given.description
    edits = TextEdits(text)
    rename(edits, "point", "B", "Q")
    rename(edits, "part", "d", "way")
    friction = described_as(Linkage, lw.loads(edits.text)).friction
    assert set(friction) == {"O", "A", "Q", "way"}
    edits.put(("points", "A2"), [0, 5])
    edits.put(("points", "Q2"), [9, 5])
    names = {"crank": "crank2", "rod": "rod2", "A": "A2", "Q": "Q2"}
    copy_selection(edits, names, mirrored=False)
    assert edits.get(("friction", "A2")) == edits.get(("friction", "A"))
    assert "Q2" not in edits.keys(("friction",))  # on one link only: no pin


TEXT = """format = 1
[points]
O = [0, 0]
T = [10, 0]
A = [3, 4]
B = [15, 0]
[links]
ground = ["O", "T"]
crank = ["O", "A"]
rod = ["A", "B"]
block = ["B"]
[input]
link = "crank"
[[sliders]]
name = "d"
link = "block"
points = ["B"]
on = "ground"
line = ["O", "T"]
[friction]
"""
PIN = {"mu": 0.1, "radius": 5}


@pytest.mark.parametrize(
    ("friction", "message"),
    [
        ({"A": {"mu": 0.1}}, "line 21 friction.A.radius is missing: the friction of a pin needs"),
        ({"A": {"mu": -0.1, "radius": 5}}, "line 21 friction.A.mu must not be negative, got -0.1"),
        ({"A": {"mu": 0.1, "radius": 0}}, "friction.A.radius must be a positive length"),
        ({"T": PIN}, "friction.T is no pin of two links"),
        ({"Z": PIN}, "friction.Z is neither a pin nor a part"),
        ({"d": PIN}, "friction.d.radius the friction of a slider does not depend on it"),
        ({"A": {"radius": 5}}, "line 21 friction.A.mu is missing"),
        ({"A": {"mu": 0.1, "radius": 5, "oil": 1}}, "friction.A.oil"),
    ],
)
def test_wrong_friction_is_refused_with_its_line(
    friction: Mapping[str, Mapping[str, float]], message: str
) -> None:
    rows = [
        f"{name} = {{ {', '.join(f'{key} = {number}' for key, number in own.items())} }}"
        for name, own in friction.items()
    ]
    with pytest.raises(MechanismFileError) as refused:
        lw.loads(TEXT + "\n".join(rows))
    assert message in " ".join(str(refused.value).split())


def test_parts_without_friction_say_so() -> None:
    belt = lw.example("belt-drive")
    name = described_as(Linkage, belt).belts[0].name
    with pytest.raises(MechanismError, match="a belt or chain has no friction of its own"):
        belt.changed(friction={name: lw.Friction(mu=0.1)})
