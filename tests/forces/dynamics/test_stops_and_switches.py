"""Motions that rest on stops, and loads with jumps and kinks, against closed forms."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.forces.dynamics import collocation as panels, reduced_leg
from linkwork.forces.reactions.solving import forces_of_motion

BLOCK: dict[str, Any] = {
    "length": "m",
    "points": {"S": (0, 0), "T": (10, 0), "B": (3, 0)},
    "links": {"ground": ["S", "T"], "block": ["B"]},
    "masses": {"block": lw.Mass(mass=2)},
    "sliders": [lw.Slider(name="d", link="block", points=("B",), on="ground", line=("S", "T"))],
    "inputs": lw.Input(slider="d", from_=-5, to=8, step=0.1),
}
FOUR_BAR: dict[str, Any] = {
    "length": "m",
    "points": {"A": (0, 0), "B": (0.4, 0), "C": (1.5, 0.6), "D": (1.2, 0)},
    "links": {
        "ground": ["A", "D"], "crank": ["A", "B"], "coupler": ["B", "C"], "rocker": ["D", "C"],
    },
    "masses": {
        link: lw.Mass(mass=k + 1, shape="rod")
        for k, link in enumerate(("crank", "coupler", "rocker"))
    },
    "gravity": lw.Gravity(size="9.81 m/s^2"),
    "inputs": lw.Input(link="crank"),
}  # fmt: skip


def _block(force: float | str, **more: Any) -> lw.Mechanism:
    """A block of 2 kg on a line under a force along it."""
    return lw.linkage(
        **{**BLOCK, **more}, loads=[lw.Load(point="B", link="block", force=(force, 0))]
    )


@pytest.mark.parametrize(
    ("force", "at", "restitution", "leaves", "end"),
    [
        ("-5 + 10*(t > 1.5)", 3, 0, 1.5, 2.5 + 0.5 * 2.5 * 1.5**2),
        ("-5 + 10*(t > 1.5)", 3, 0.3, 1.5, 2.5 + 0.5 * 2.5 * 1.5**2),
        ("-5 + 10*(t > 1.5)", 2.5, 0, 1.5, 2.5 + 0.5 * 2.5 * 1.5**2),
        ("-5 + 4*t", 3, 0, 1.25, 2.5 + 2 * 1.75**3 / 6),
        ("-5 + 4*t", 2.5, 0, 1.25, 2.5 + 2 * 1.75**3 / 6),
        # a pulse of 2 ms within the rest, of 20 N·m/s
        ("-5 + 25*(t > 1.7)*(t < 1.702)", 2.5, 0, 1.7, 2.5),
    ],
)
def test_a_block_leaves_its_stop_where_the_contact_would_pull(
    force: str, at: float, restitution: float, leaves: float, end: float
) -> None:
    stop = lw.Stop(of="d", from_=2.5, restitution=restitution)
    motion = _block(force, stops=[stop]).simulate(until=3, step=0.1, at=at)
    assert motion.found.all()
    start = motion.limit.index("start")
    assert motion["t"][start] == pytest.approx(leaves, abs=1e-14)
    assert motion["d"][-1] == pytest.approx(end, abs=1e-12)
    rests = (motion["t"] < leaves) & (motion["t"] > 1.2)
    # it stays where it is, and the stop gives what the load takes
    assert np.ptp(motion["d"][rests]) == 0.0
    load = motion["B.load.x"][rests]
    assert motion["d.stop"][rests] == pytest.approx(-load, abs=1e-12)
    assert np.abs(motion["d.effort"]).max() < 1e-12
    hit = [k for k, event in enumerate(motion.limit) if event == "stop of d"]
    struck = -2 * (1 + restitution) * motion["d.velocity"][hit]
    if restitution:
        struck = struck[:-1]  # the last bounce is rest
    assert motion["d.stop.impulse"][hit[: len(struck)]] == pytest.approx(struck, rel=1e-12)


def test_a_block_with_friction_leaves_its_stop_when_the_load_exceeds_it() -> None:
    """Weight 20 N, μ = 0.1: from -5 + 4 t = 2 on the load overcomes friction."""
    given: dict[str, Any] = {"gravity": lw.Gravity(size="10 m/s^2")}
    given |= {"friction": {"d": lw.Friction(mu=0.1)}, "stops": [lw.Stop(of="d", from_=2.5)]}
    motion = _block("-5 + 4*t", **given).simulate(until=3, step=0.1, at=2.6)
    assert motion["t"][motion.limit.index("start")] == pytest.approx(1.75, abs=1e-12)
    assert motion["d"][-1] == pytest.approx(2.5 + 2 * 1.25**3 / 6, abs=1e-12)
    # while friction and the stop share the load, neither is determined
    rests = int(np.searchsorted(motion["t"], 0.9))
    assert np.isnan(motion["d.stop"][rests])


def test_blocks_at_stops_leave_one_after_the_other() -> None:
    """Two inputs: each block leaves its own stop at its own time."""
    points = {"S": (0, 0), "T": (10, 0), "B": (3, 0), "C": (3, 0)}
    sliders = [
        lw.Slider(name=name, link=link, points=(point,), on="ground", line=("S", "T"))
        for name, link, point in (("d", "block", "B"), ("f", "other", "C"))
    ]
    mechanism = lw.linkage(
        length="m", points=points, links={"ground": ["S", "T"], "block": ["B"], "other": ["C"]},
        masses={"block": lw.Mass(mass=2), "other": lw.Mass(mass=1)}, sliders=sliders,
        inputs=[lw.Input(slider=name, from_=1, to=8, step=1) for name in "df"],
        stops=[lw.Stop(of="d", from_=2.5), lw.Stop(of="f", from_=3)],
        loads=[
            lw.Load(point="B", link="block", force=("-5 + 4*t", 0)),
            lw.Load(point="C", link="other", force=("-1 + 3*(t > 2)", 0)),
        ],
    )  # fmt: skip
    motion = mechanism.simulate(until=3, step=0.1, at={"d": 3, "f": 3})
    starts = [
        float(t)
        for t, event in zip(motion["t"], motion.limit, strict=True)
        if event in ("start", "switch")
    ]
    assert starts == pytest.approx([1.25, 2], abs=1e-12)
    assert motion["d"][-1] == pytest.approx(2.5 + 2 * 1.75**3 / 6, abs=1e-11)
    assert motion["f"][-1] == pytest.approx(4, abs=1e-11)
    assert motion["f.stop"][5] == pytest.approx(1, abs=1e-12)


def test_reactions_at_rest_are_those_of_a_machine_that_the_stop_holds() -> None:
    """As the effort of a rocker that is held there; nothing else drives the crank."""
    mechanism = lw.linkage(**FOUR_BAR, stops=[lw.Stop(of="rocker", from_=50, to=80)])
    motion = mechanism.simulate(until=2, step=0.1)
    driven = {**FOUR_BAR, "inputs": lw.Input(link="rocker")}
    lengths = {"A B": 0.4, "B C": abs(1.1 + 0.6j), "D C": abs(0.3 + 0.6j)}
    moved = {name: tuple(float(motion[f"{name}.{axis}"][-1]) for axis in "xy") for name in "ABCD"}
    held = lw.linkage(**{**driven, "points": moved, "lengths": lengths}).forces(at=80)
    assert motion["rocker.stop"][-1] == pytest.approx(held["rocker.effort"], abs=1e-9)
    for name in ("A.force.x", "A.force.y", "B.force.x", "B.force.y", "C.force.x", "C.force.y"):
        assert motion[name][-1] == pytest.approx(held[name], abs=1e-9)
    assert motion["A.force.x"][-1] == pytest.approx(-11.395182966, abs=1e-8)
    assert motion["A.force.y"][-1] == pytest.approx(9.792812811, abs=1e-8)
    assert abs(motion["crank.effort"][-1]) < 1e-12
    assert "held by the stop of rocker" in motion.message
    # at the shock the kinetic energy is that of the impulse: J ω / 2
    hit = motion.limit.index("stop of rocker")
    shock = -0.5 * motion["rocker.stop.impulse"][hit] * motion["rocker.velocity"][hit]
    assert shock == pytest.approx(motion["kinetic_energy"][hit], rel=1e-12)
    # the rows of the motion have the same forces one by one
    assert np.array_equal(
        forces_of_motion(mechanism.model, motion)["A.force.x"], motion["A.force.x"]
    )


def test_a_stop_on_a_quantity_of_several_bodies_leaves_reactions_open() -> None:
    """It holds the machine, and says that its forces on the bodies are not known."""
    outputs = {"lean": "rocker - coupler"}
    mechanism = lw.linkage(**FOUR_BAR, outputs=outputs, stops=[lw.Stop(of="lean", to=50)])
    motion = mechanism.simulate(until=2, step=0.1)
    assert "held by the stop of lean" in motion.message
    assert motion["lean"][-1] == pytest.approx(50, abs=1e-9)
    assert np.isnan(motion["A.force.x"][-1])
    assert forces_of_motion(mechanism.model, motion).statuses[-1].name == "STOPPED"


def _kinks(force: str, smooth: str) -> None:
    """Two ways to write a load give the same motion."""
    one, other = (
        _block(each).simulate(until=0.6, step=0.05, at=3, start_speed="10 m/s")
        for each in (force, smooth)
    )
    for t, d in zip(one["t"], one["d"], strict=True):
        k = int(np.argmin(np.abs(other["t"] - t)))
        if abs(other["t"][k] - t) < 1e-13:
            assert d == pytest.approx(other["d"][k], abs=1e-11)


def test_bumpers_of_maximum_are_half_sines() -> None:
    """Elastic stops at 2 m and 4 m, with a block that flies between at 10 m/s."""
    for stiffness in (1e4, 1e8):
        force = f"-{stiffness}*max(0, d - 4) - {stiffness}*min(0, d - 2)"
        motion = _block(force).simulate(until=2, step=0.05, at=3, start_speed="10 m/s")
        w = math.sqrt(stiffness / 2)
        bump = math.pi / w
        u = np.mod(motion["t"] + 0.1, 2 * (0.2 + bump))
        exact = np.where(
            u < 0.2, 2 + 10 * u,
            np.where(
                u < 0.2 + bump, 4 + 10 / w * np.sin(w * (u - 0.2)),
                np.where(
                    u < 0.4 + bump, 4 - 10 * (u - 0.2 - bump),
                    2 - 10 / w * np.sin(w * (u - 0.4 - bump)),
                ),
            ),
        )  # fmt: skip
        # ten shocks, each of which keeps the roundings of its own place
        assert np.abs(motion["d"] - exact).max() < 5e-11


@pytest.mark.parametrize(
    ("force", "pieces"),
    [
        ("-40*abs(d - 3.5)", "-40*(d - 3.5)*((d > 3.5) - (d < 3.5))"),
        ("-20*max(d, 4, 7 - d)", "-20*(d*(d > 4) + 4*(d <= 4)*(d >= 3) + (7 - d)*(d < 3))"),
        ("-3*min(1, abs(d.velocity))", "-3*(d.velocity >= 1) - 3*d.velocity*(d.velocity < 1)"),
        # the angle of a vector behind half a turn jumps by a whole one
        ("-0.1*atan2(4 - d, -1)", "-0.1*(180*((d < 4) - (d > 4)) - atan(4 - d))"),
    ],
)  # fmt: skip
def test_kinks_are_located_like_comparisons(force: str, pieces: str) -> None:
    _kinks(force, pieces)


def test_a_spring_passes_zero_length_without_loss() -> None:
    """From 3 m with a free length of 1 m: half sines about ±1 m, the same after every pass."""
    spring = lw.Spring(name="k", between=("S", "B"), stiffness=50, free=1)
    motion = lw.linkage(**BLOCK, springs=[spring]).simulate(until=3, step=0.1, at=3)
    energy = motion["kinetic_energy"] + motion["stored_energy"]
    assert np.ptp(energy) < 1e-11 * energy.max()
    # to -3 and back: quarter swings of 2 about ±1, from amplitude to zero length
    quarter = (math.pi - math.acos(0.5)) / 5.0
    period = 4 * quarter
    back = np.abs(motion["t"] - period) < 0.05
    assert back.any()
    t = float(motion["t"][back][0])
    assert motion["d"][back][0] == pytest.approx(1 + 2 * math.cos(5 * (t - period)), abs=1e-12)


def test_a_spring_passes_its_anchor_on_a_curve() -> None:
    """The pin of a bar comes to a point on its circle, where the tension turns back."""
    anchor = (math.cos(-2.0), math.sin(-2.0))
    bar = lw.linkage(
        length="m", points={"O": (0, 0), "P": (1, 0), "F": anchor},
        links={"ground": ["O", "F"], "bar": ["O", "P"]}, gravity=lw.Gravity(),
        masses={"bar": lw.Mass(mass=1, shape="rod")}, inputs=lw.Input(link="bar"),
        springs=[lw.Spring(name="k", between=("F", "P"), stiffness=20, free=0.7)],
    )  # fmt: skip
    motion = bar.simulate(until=3)
    assert motion["bar"].min() < math.degrees(-2.0)
    energy = motion["kinetic_energy"] + motion["stored_energy"]
    assert np.ptp(energy) < 1e-11 * motion["kinetic_energy"].max()
    assert "switch" in motion.limit


def test_a_spring_of_several_inputs_passes_zero_length() -> None:
    """Two blocks on a line that a spring joins: their middle moves evenly."""
    points = {"S": (0, 0), "T": (10, 0), "B": (3, 0), "C": (5, 0)}
    sliders = [
        lw.Slider(name=name, link=link, points=(point,), on="ground", line=("S", "T"))
        for name, link, point in (("d", "block", "B"), ("f", "other", "C"))
    ]
    motion = lw.linkage(
        length="m", points=points, links={"ground": ["S", "T"], "block": ["B"], "other": ["C"]},
        masses={"block": lw.Mass(mass=2), "other": lw.Mass(mass=1)}, sliders=sliders,
        inputs=[lw.Input(slider=name, from_=1, to=8, step=1) for name in "df"],
        springs=[lw.Spring(name="k", between=("B", "C"), stiffness=50, free=1)],
    ).simulate(until=2, step=0.05, start_speed={"d": 8})  # fmt: skip
    assert (motion["f"] - motion["d"]).min() < 0
    assert (2 * motion["d"] + motion["f"]) / 3 == pytest.approx(
        (11 + 16 * motion["t"]) / 3, abs=1e-11
    )
    energy = motion["kinetic_energy"] + motion["stored_energy"]
    assert np.ptp(energy) < 1e-11 * energy.max()


def test_a_motor_passes_the_corners_of_its_table() -> None:
    """12 N·m up to 10 rad/s, falling to 2 at 30, level beyond; on an inertia of 1 kg·m²."""
    motor = lw.Motor(speeds=("0 rad/s", "10 rad/s", "30 rad/s"), torques=(12, 12, 2))
    bar = lw.linkage(
        length="m", points={"O": (0, 0), "P": (1, 0)}, links={"ground": ["O"], "bar": ["O", "P"]},
        masses={"bar": lw.Mass(mass=1, center=(0, 0), inertia=1)},
        inputs=lw.Input(link="bar", motor=motor),
    )  # fmt: skip
    motion = bar.simulate(until=6, step=0.5)
    first = 10 / 12
    second = first + 2 * math.log(6)  # ω = 34 - 24 e^{-t/2} reaches 30
    t = motion["t"]
    exact = np.where(
        t < first, 12 * t,
        np.where(t < second, 34 - 24 * np.exp(-(t - first) / 2), 30 + 2 * (t - second)),
    )  # fmt: skip
    assert motion["bar.velocity"] == pytest.approx(exact, abs=1e-11)
    assert motion.limit.count("switch") == 2


def test_rest_against_a_load_of_the_rate_is_exact_and_ends() -> None:
    """A brake of 6 N holds a block until the force exceeds it."""
    brake = "t - 6*(d.velocity > 0) + 6*(d.velocity < 0)"
    motion = _block(brake).simulate(until=8, step=0.5, at=3)
    assert np.ptp(motion["d"][motion["t"] <= 6]) == 0.0
    assert motion["t"][motion.limit.index("start")] == pytest.approx(6, abs=1e-12)
    assert motion["d"][-1] == pytest.approx(3 + 2**3 / 12, abs=1e-12)


def test_a_shock_turns_a_load_of_the_rate() -> None:
    """A brake of 3 N: from 4 m/s at 3 m to the stop at 2.5 m and back, 14.5/3 m far."""
    brake = "-3*(d.velocity > 0) + 3*(d.velocity < 0)"
    stop = lw.Stop(of="d", from_=2.5, restitution=1)
    motion = _block(brake, stops=[stop]).simulate(until=4, step=0.5, at=3, start_speed="-4 m/s")
    assert motion["d"][-1] == pytest.approx(2.5 + 14.5 / 3, abs=1e-12)
    assert "held by a load that switches there" in motion.message


def test_an_energy_that_drifts_is_said_and_not_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    """With tables that are too coarse for their rods."""
    mechanism = lw.linkage(**{**FOUR_BAR, "inputs": lw.Input(link="rocker")})
    fine = mechanism.simulate(until=1, step=0.05)
    assert fine.certified.all()
    assert "drifts" not in fine.message
    coarsely = partial(panels.fit_panels, deepest=0)
    monkeypatch.setattr(reduced_leg, "fit_panels", coarsely)
    coarse = mechanism.simulate(until=1, step=0.05)
    assert "its energy drifts by" in coarse.message
    assert "not certified" in coarse.message
    assert not coarse.certified[-1]
    assert coarse.certification[-1].name == "ENERGY_DRIFTS"
    assert coarse.certified[0]


def test_a_galloway_linkage_goes_straight_on_for_two_turns() -> None:
    """Its positions repeat after two turns of the crank, and its energy is kept."""
    links = {"ground": ["O2", "O4"], "crank": ["O2", "A"], "coupler": ["A", "B"]}
    mechanism = lw.linkage(
        points={"O2": (0, 0), "O4": (10, 0), "A": (0, 10), "B": (18.228757, 18.228757)},
        links={**links, "follower": ["O4", "B"]},
        lengths={"O2 A": 10, "A B": 20, "O4 B": 20}, gravity=lw.Gravity(size="9.81 m/s^2"),
        masses={
            "crank": lw.Mass(mass=1, center=(5, 3), inertia=60),
            "coupler": lw.Mass(mass=1, center=(2, 4), inertia=100),
            "follower": lw.Mass(mass=1.5, center=(-3, 6), inertia=80),
        },
        inputs=lw.Input(link="crank"),
    )  # fmt: skip
    motion = mechanism.simulate(
        until=0.5, step=0.01, start_speed="1 rad/s", change_points="straight"
    )
    assert motion.found.all()
    energy = motion["kinetic_energy"] + motion["stored_energy"]
    assert np.ptp(energy) < 1e-10 * motion["kinetic_energy"].max()
    # positions repeat after two turns, in which the follower turns once
    assert motion["crank"].max() - motion["crank"].min() > 360
    assert np.abs(np.diff(motion["follower"])).max() < 60


def test_energy_is_kept_near_a_straight_brace() -> None:
    gear = lw.linkage(
        points={
            "S": (0, 0), "U": (80, 10), "H": (100, 30), "J": (0, -70), "N": (25.9808, 15),
            "M": (41.3679, -38.4929),
        },
        links={
            "ground": ["S", "U", "H"], "leg": ["S", "J", "N"], "upper": ["U", "M"],
            "lower": ["M", "J"],
        },
        lengths={"S J": 70, "S N": 30, "U M": 62, "M J": 52}, angles={"J S N": 120},
        cylinders=[lw.Cylinder(name="actuator", between=("H", "N"))],
        gravity=lw.Gravity(size="9.81 m/s^2"),
        masses={
            "leg": lw.Mass(mass=1.3656, center=(-31.7787, -32.5069), inertia=5018.7),
            "upper": lw.Mass(mass=0.98658, center=(36.3679, 14.0905), inertia=12887.5),
            "lower": lw.Mass(mass=1.66606, center=(57.6273, -24.013), inertia=9171.3),
        },
        inputs=lw.Input(cylinder="actuator", from_=76, to=114, step=0.5),
    )  # fmt: skip
    motion = gear.simulate(until=0.4, step=0.004, start_speed="-20 mm/s")
    energy = motion["kinetic_energy"] + motion["stored_energy"]
    assert motion["actuator"].max() > 116.8
    assert np.ptp(energy) < 1e-10 * motion["kinetic_energy"].max()


def test_a_motion_that_turns_just_beyond_its_start_keeps_its_energy() -> None:
    """Straight on, the lap of a four-bar begins at the sketch, to which its swings come back."""
    bar = lw.example("four-bar")
    size = bar.model.equations.length_scale
    masses = {
        name: lw.Mass(mass=mass, center=(x * size, y * size), inertia=0.1 * size**2)
        for name, mass, x, y in (
            ("crank", 1.0, 0.2, 0.1), ("coupler", 1.5, 0.1, -0.2), ("rocker", 0.7, -0.1, 0.2)
        )
    }  # fmt: skip
    heavy = bar.changed(masses=masses, gravity=lw.Gravity(size="9.81 m/s^2"))
    for speed in (0, 1e-3, 0.1, 1):
        motion = heavy.simulate(until=2, step=0.01, start_speed=speed, change_points="straight")
        energy = motion["kinetic_energy"] + motion["stored_energy"]
        assert np.ptp(energy) < 1e-10 * motion["kinetic_energy"].max()


SHAFT: dict[str, Any] = {
    "length": "m",
    "points": {"O": (0, 0), "A": (1, 0)},
    "links": {"ground": ["O"], "crank": ["O", "A"]},
    "masses": {"crank": lw.Mass(mass=1, inertia=1, center=(0, 0))},
    "inputs": lw.Input(link="crank"),
}


def test_a_load_of_an_angle_counts_whole_turns() -> None:
    # a torsion pendulum of 10 rad: ω = 2 rad/s
    spring = lw.Spring(name="k", links=("ground", "crank"), stiffness=4)
    load = lw.Load(link="crank", torque="-4*crank*pi/180")
    for more in ({"springs": [spring]}, {"loads": [load]}):
        motion = lw.linkage(**SHAFT, **more).simulate(until=3, step=0.1, start_speed="20 rad/s")
        assert motion["crank"] == pytest.approx(np.degrees(10 * np.sin(2 * motion["t"])), abs=1e-8)
    # a load with a period of two turns, and one that differs from it by a comparison of no effect
    ends = []
    for formula in ("20*cos(crank/2)", "20*cos(crank/2)*(t > -1)"):
        shaft = lw.linkage(**SHAFT, loads=[lw.Load(link="crank", torque=formula)])
        ends.append(shaft.simulate(until=3, step=0.1, start_speed="10 rad/s")["crank"][-1])
    assert ends[0] == pytest.approx(ends[1], abs=1e-7)
    assert ends[0] == pytest.approx(1431.222369, abs=1e-4)


def test_a_block_that_has_bounced_off_its_stop_does_not_rest_on_it_later() -> None:
    # 4 N of the spring against 2 N of friction: it turns back at once
    motion = lw.linkage(
        **BLOCK, gravity=lw.Gravity(size="10 m/s^2"), friction={"d": lw.Friction(mu=0.1)},
        springs=[lw.Spring(name="k", between=("S", "B"), stiffness=4, free=3)],
        stops=[lw.Stop(of="d", from_=3, restitution=0.5)],
    ).simulate(until=1.2, step=0.1, start_speed=-4)  # fmt: skip
    turn = motion.limit.index("rest") if "rest" in motion.limit else int(np.argmax(motion["d"]))
    assert motion["d"][turn] == pytest.approx(4, abs=1e-2)
    assert motion["d"][-1] < 3.95


@pytest.mark.parametrize("force", [-50, 50])
def test_a_slider_crank_in_line_with_its_load_is_in_equilibrium(force: float) -> None:
    motion = lw.linkage(
        length="m", points={"O": (0, 0), "T": (2, 0), "A": (0.3, 0), "B": (1.3, 0)},
        links={
            "ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "B"], "block": ["B"],
        },
        sliders=[lw.Slider(name="s", link="block", points=("B",), on="ground", line=("O", "T"))],
        masses={
            "crank": lw.Mass(mass=1, shape="rod"), "rod": lw.Mass(mass=1, shape="rod"),
            "block": lw.Mass(mass=2),
        },
        loads=[lw.Load(point="B", link="block", force=(force, 0))],
        inputs=lw.Input(link="crank"),
    ).simulate(until=1, step=0.25)  # fmt: skip
    assert np.abs(motion["crank"]).max() == 0.0
    assert "equilibrium" in motion.message
