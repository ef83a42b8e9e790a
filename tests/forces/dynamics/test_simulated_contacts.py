"""What a simulation says of its contacts, its energy, its equilibria and its limits."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import linkwork as lw
from linkwork.core.commands.main import linkwork
from linkwork.core.results.listing import whole_energy

FEED = 0.02  # m, of the cam's lift


def cam(start_speed: str, inertia: float = 5.0) -> lw.Motion:
    """A harmonic cam of half a turn up and down, whose follower a spring presses on."""
    machine = lw.linkage(
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
                    lw.Segment(law="harmonic", over=180, lift=FEED),
                    lw.Segment(law="harmonic", over=180, lift=-FEED),
                ),
            )
        ],
        masses={"follower": lw.Mass(mass=0.5)},
        gravity=lw.Gravity(size="9.81 m/s^2"),
        springs=[lw.Spring(name="k", between=("F", "T"), stiffness=2000, free=0.075)],
        inputs=lw.Input(link="disc", inertia=inertia),
    )  # fmt: skip
    return machine.simulate(until=0.05, step=0.05, start_speed=start_speed)


def test_a_cam_that_lifts_off_says_when() -> None:
    """At nearly constant speed: m (g + s̈) + k (s - s₀) = 0 with s̈ = ω² (h/2) cos φ."""
    speed = 170.0
    motion = cam(f"{speed} rad/s", inertia=1e9)  # the flywheel keeps the speed to 1e-9
    a, b = 0.5 * speed**2 * FEED / 2.0, 2000.0 * FEED / 2.0
    # force = m g + k (0.015 + h/2) + (a - b) cos φ
    angle = math.acos((0.5 * 9.81 + 2000.0 * (0.015 + FEED / 2.0)) / (b - a))
    found = re.search(
        r"cam.normal lifts off at t = (.*) s: later rows keep the contact", motion.message
    )
    assert found is not None
    assert float(found[1]) == pytest.approx(angle / speed, rel=1e-8)
    assert "lifts off" not in cam("100 rad/s").message


def test_the_energy_of_a_simulation_contains_its_flywheel() -> None:
    motion = cam("100 rad/s", inertia=5.0)
    assert motion.flywheel_energy is not None
    assert motion.flywheel_energy[0] == pytest.approx(0.5 * 5.0 * 100.0**2)
    energy = whole_energy(motion)
    assert energy == pytest.approx(energy[0], rel=1e-12)


def rolling(mu: float) -> lw.Mechanism:
    """A solid wheel on a slope of 60°: it rolls if μ is at least tan 60° / 3."""
    slope = math.radians(60.0)
    down = np.array([-math.cos(slope), -math.sin(slope)])
    centre = 0.3 * np.array([-math.sin(slope), math.cos(slope)])
    return lw.linkage(
        length="m",
        points={"S": (0, 0), "T": tuple(10.0 * down), "C": tuple(centre)},
        links={"ground": ["S", "T"], "wheel": ["C"]},
        rolling=[lw.Rolling(name="x", wheel="wheel", center="C", radius=0.3, line=("S", "T"))],
        masses={"wheel": lw.Mass(mass=4, inertia=0.18)},
        gravity=lw.Gravity(size="9.81 m/s^2"),
        friction={"x": lw.Friction(mu=mu)},
        inputs=lw.Input(slider="x", from_=0, to=5, step=1),
    )


@pytest.mark.parametrize(
    ("mu", "says"), [(0.1, "x.tangent slips at t = 0 s"), (0.6, "x rolls without")]
)
def test_a_wheel_slips_or_rolls_and_says_so(mu: float, says: str) -> None:
    motion = rolling(mu).simulate(until=1)
    assert says in motion.message
    # rows roll on: g sin 60° / (1 + ½) downhill
    way = 9.81 * math.sin(math.radians(60.0)) / 1.5 / 2.0
    assert motion["x"][-1] == pytest.approx(way, rel=1e-12)


def test_a_strand_that_goes_slack_is_named() -> None:
    machine = lw.linkage(
        length="m",
        points={"O": (0, 0), "P": (1, 0)},
        links={"ground": ["O", "P"], "small": ["O"], "large": ["P"]},
        belts=[
            lw.Belt(name="b", wheels=("small", "large"), centers=("O", "P"), radii=(0.1, 0.2),
                    pretension=10)
        ],
        masses={"large": lw.Mass(mass=1, inertia=0.4)},
        loads=[lw.Load(link="small", torque="40*t")],
        inputs=lw.Input(link="small"),
    )  # fmt: skip
    motion = machine.simulate(until=1)
    # all inertia is on the large wheel: the pull 40 t / 0.1 loosens a strand of 10 N by its half
    assert "b.tension" in motion.message
    assert "goes slack at t = 0.05 s: later rows keep the strand tight" in motion.message


def slider(start: float, stop: float) -> lw.Mechanism:
    return lw.linkage(
        length="m",
        points={"S": (0, 0), "T": (10, 0), "B": (3, 0)},
        links={"ground": ["S", "T"], "block": ["B"]},
        masses={"block": lw.Mass(mass=2)},
        sliders=[lw.Slider(name="d", link="block", points=("B",), on="ground", line=("S", "T"))],
        inputs=lw.Input(slider="d", from_=start, to=stop, step=0.1),
        springs=[lw.Spring(name="k", between=("S", "B"), stiffness=50, free=0)],
    )


@pytest.mark.parametrize(("start", "stop"), [(3.0, 3.1), (3.0, 3.0), (-5.0, 5.0)])
def test_the_table_of_a_slider_does_not_limit_its_simulation(start: float, stop: float) -> None:
    machine = slider(start, stop)
    motion = machine.simulate(until=3, step=0.1)
    assert motion["d"] == pytest.approx(3.0 * np.cos(5.0 * motion["t"]), abs=1e-12)
    assert [round(each.input, 12) for each in lw.forces.equilibria(machine)] == [0.0]


def test_a_slider_goes_as_far_as_its_acceleration_takes_it() -> None:
    falling = slider(3.0, 4.0).changed(springs=(), gravity=lw.Gravity(size="9.81 m/s^2", angle=0))
    motion = falling.simulate(until=300, step=100)
    assert motion["d"] == pytest.approx(3.0 + 9.81 / 2.0 * motion["t"] ** 2, rel=1e-13)


def arm(balance: float, **more: Any) -> lw.Mechanism:
    """A spring balances an arm at every angle if k a b = m g l."""
    spring = lw.Spring(
        name="s", between=("H", "C"), stiffness=balance * 3 * 9.81 * 0.6 / (0.5 * 0.4), free=0
    )
    given = {"gravity": lw.Gravity(size="9.81 m/s^2"), "springs": [spring], **more}
    return lw.linkage(
        length="m",
        points={"O": (0, 0), "H": (0, 0.5), "A": (1, 0), "C": (0.4, 0)},
        links={"ground": ["O", "H"], "arm": ["O", "C", "A"]},
        lengths={"O C": 0.4, "O A": 1.0},
        masses={"arm": lw.Mass(mass=3, center=(0.6, 0), inertia=1.0)},
        inputs=lw.Input(link="arm"),
        **given,
    )


def test_an_arm_that_is_balanced_everywhere_has_one_indifferent_equilibrium() -> None:
    (found,) = lw.forces.equilibria(arm(1.0))
    assert (found.indifferent, found.stable, found.frequency) == ("everywhere", False, 0.0)
    # a millionth of imbalance leaves two
    assert [each.stable for each in lw.forces.equilibria(arm(1.000001))] == [False, True]


def test_loads_that_leave_a_stretch_free_have_an_equilibrium_on_it() -> None:
    loads = [lw.Load(link="arm", torque="-2*max(0, arm - 30) + max(0, -40 - arm)")]
    found = lw.forces.equilibria(arm(1.0, gravity=None, springs=(), loads=loads))
    assert [each.indifferent for each in found] == ["near"]
    assert -40 < found[0].input < 30


def test_an_arm_of_two_inputs_may_be_indifferent_alone() -> None:
    both = arm(1.0).description
    with_bar = arm(1.0).changed(
        points={**both.points, "P": (2, 0), "Q": (2, -0.5)},  # type: ignore[attr-defined]  # a linkage
        links={"ground": ["O", "H", "P"], "arm": ["O", "C", "A"], "bar": ["P", "Q"]},
        lengths={"O C": 0.4, "O A": 1.0, "P Q": 0.5},
        masses={"arm": lw.Mass(mass=3, center=(0.6, 0), inertia=1.0),
                "bar": lw.Mass(mass=2, shape="rod")},
        inputs=[lw.Input(link="arm"), lw.Input(link="bar")],
    )  # fmt: skip
    found = lw.forces.equilibria(with_bar)
    assert [round(each.values["bar"], 6) for each in found] == [-90, 90]
    assert {each.indifferent for each in found} == {"near"}
    # a rod about its end: ω² = 3 g / (2 l)
    assert found[0].frequencies[1] == pytest.approx(math.sqrt(3 * 9.81 / 1.0) / math.tau, rel=1e-9)


def test_the_mechanical_advantage_of_a_simulation_is_that_of_its_positions() -> None:
    engine = lw.example("compressor").changed(friction={})
    motion = engine.simulate(until=0.3, step=0.1, start_speed="60 rad/s")
    name = "d.mechanical_advantage"
    assert motion.quantity(name).unit == engine.model.quantities.find(name).unit
    for angle, value in list(zip(motion["crank"], motion[name], strict=True))[1:]:
        assert value == pytest.approx(engine.solve(at=float(angle))[name], rel=1e-11)
    # at rest the accelerations have the same ratio
    still = engine.changed(inputs=lw.Input(link="crank", inertia=1000, motor=lw.Motor(stall=100)))
    begins = still.simulate(until=0.01, step=0.01, at=70)
    assert begins[name][0] == pytest.approx(engine.solve(at=70)[name], rel=1e-9)
    several = lw.example("double-pendulum").simulate(until=0.1, step=0.1)
    assert not [each for each in several.quantities.derived if "advantage" in each]


def test_a_policy_that_is_refused_is_not_offered() -> None:
    assert "[stop|straight]" in CliRunner().invoke(linkwork, ["simulate", "--help"]).output
    with pytest.raises(lw.InputError, match="goes straight on or stops"):
        lw.forces.equilibria(arm(1.0), change_points="turn")
