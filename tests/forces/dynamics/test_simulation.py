"""Simulated motions against closed forms and published values."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from benchmarks.motions.machines import SQUEEZER_ANGLE, WINDOW_PLACES, squeezer, windows

PENDULUM: dict[str, Any] = {
    "length": "m",
    "points": {"O": (0, 0), "A": (-1, 0)},
    "links": {"ground": ["O"], "bar": ["O", "A"]},
    "masses": {"bar": lw.Mass(mass=1, center=(1, 0))},
    "gravity": lw.Gravity(),
    "inputs": lw.Input(link="bar"),
}
SLIDER: dict[str, Any] = {
    "length": "m",
    "points": {"S": (0, 0), "T": (10, 0), "B": (3, 0)},
    "links": {"ground": ["S", "T"], "block": ["B"]},
    "sliders": [lw.Slider(name="d", link="block", points=("B",), on="ground", line=("S", "T"))],
    "masses": {"block": lw.Mass(mass=2)},
    "inputs": lw.Input(slider="d", from_=0, to=5, step=1),
}


def test_a_pendulum_is_that_of_the_benchmark() -> None:
    """IFToMM A01, exact to 18 digits."""
    motion = lw.linkage(**PENDULUM).simulate(until=10, step=1)
    exact = {
        1: (0.986291751131875319, -0.165010853125541169),
        5: (-0.942305435043757335, -0.334754338414000581),
        10: (-0.27508746257611686, -0.961419205099125064),
    }
    for t, (x, y) in exact.items():
        assert motion["A.x"][t] == pytest.approx(x, abs=1e-12)
        assert motion["A.y"][t] == pytest.approx(y, abs=1e-12)
    # nothing drives it
    assert np.abs(motion["bar.effort"]).max() < 1e-12


@pytest.mark.parametrize("count", [2, pytest.param(40, marks=pytest.mark.extended)])
def test_four_bars_in_a_row_pass_the_flat_position_twice_a_turn(count: int) -> None:
    motion = windows(count).simulate(
        until=10, step=1, start_speed="-1 rad/s", change_points="straight"
    )
    assert motion.found.all()
    for t, (x, y) in WINDOW_PLACES[count].items():
        # rates that differ in their last bit move forty flat loops by 8e-10
        assert motion["B0.x"][t] == pytest.approx(x, abs=1e-10 if count < 40 else 2e-9)
        assert motion["B0.y"][t] == pytest.approx(y, abs=1e-10 if count < 40 else 2e-9)


def test_the_squeezer_is_that_of_the_test_set() -> None:
    motion = squeezer().simulate(until=0.03, step=0.03)
    assert motion["β.acceleration"][0] == pytest.approx(14222.4439199541138705911625887, rel=1e-12)
    assert motion["Θ.acceleration"][0] == pytest.approx(-10666.8329399655854029733419715, rel=1e-12)
    book = {
        "β": 15.81077119629904, "Θ": -15.75637105984298, "γ": 0.04082224013073101,
        "Φ": -0.5347301163226948, "δ": 0.5244099658805304, "Ω": 0.5347301163226948,
        "ε": 1.048080741042263,
    }  # fmt: skip
    # good to 1e-9 only: it misses the balance of energy
    for name, value in book.items():
        assert motion[name][-1] == pytest.approx(value, abs=1e-8)
    # two other methods agree on these
    converged = {
        "β": SQUEEZER_ANGLE, "Θ": -15.7563710584, "γ": 0.0408222401196, "Φ": -0.534730116342,
        "δ": 0.52440996588, "Ω": 0.534730116342, "ε": 1.04808074104194,
    }  # fmt: skip
    for name, value in converged.items():
        assert motion[name][-1] == pytest.approx(value, abs=1e-10)
    # Cartesian coordinates, stabilised, by DOP853 with tolerances down to 3e-14
    rates = {"β": 1139.9203022591, "γ": 11.0329119106, "δ": 0.5735699148277, "ε": 0.3231791492481}
    for name, value in rates.items():
        assert motion[f"{name}.velocity"][-1] == pytest.approx(value, rel=1e-10)


def test_rates_and_multipliers_of_the_squeezer_are_published() -> None:
    """Errors are those of the largest of each kind: the published state comes 1e-12 s later."""
    motion = squeezer().simulate(until=0.03, step=0.03)
    names = ("β", "Θ", "γ", "Φ", "δ", "Ω", "ε")
    published = {
        "velocity": ((1139.920302151208, -1424.379294994111, 11.03291221937134, 19.29337464421385,
                      0.5735699284790808, -19.29337464421385, 0.3231791658026955), 1e-8),
        "acceleration": ((-24631.76316944196, 51850.37701610329, 324102.5686413781,
                          566749.3645176213, 16743.62929479361, -566749.3645176222,
                          9826.520791458422), 1e-6),
    }  # fmt: skip
    for word, (values, near) in published.items():
        found = [motion[f"{name}.{word}"][-1] for name in names]
        assert found == pytest.approx(values, rel=0, abs=near * max(map(abs, values)))
    # the multipliers of the three loops are the forces of the pin F on the links that close them
    forces = [f"F.force.{link}.{axis}" for link in ("K3", "K4", "K6") for axis in "xy"]
    start = [98.5668703962410896, -6.12268834425566265, 0.0, 0.0, 0.0, 0.0]
    end = [199.1753333731910, -29.75531228015052, 23.06654119098399, 31.45271365475927,
           22.64249232082739, 11.61740700019673]  # fmt: skip
    assert [motion[name][0] for name in forces] == pytest.approx(start, rel=1e-12, abs=1e-10)
    assert [motion[name][-1] for name in forces] == pytest.approx(end, rel=0, abs=1e-6 * 200)


def crank_rocker(lead: str, **fields: Any) -> lw.Mechanism:
    masses = {"crank": 1, "coupler": 2, "rocker": 3}
    return lw.linkage(
        length="m",
        points={"A": (0, 0), "B": (0.4, 0), "C": (1.5, 0.6), "D": (1.2, 0)},
        links={"ground": ["A", "D"], "crank": ["A", "B"], "coupler": ["B", "C"],
               "rocker": ["C", "D"]},
        masses={link: lw.Mass(mass=mass, shape="rod") for link, mass in masses.items()},
        gravity=lw.Gravity(),
        inputs=lw.Input(link=lead),
        **fields,
    )  # fmt: skip


def test_a_thousand_turns_are_the_same_whichever_link_leads() -> None:
    slopes = crank_rocker("crank").solve().first
    found = {}
    for lead in ("crank", "coupler", "rocker"):
        speed = 30.0 * (1.0 if lead == "crank" else slopes[lead])
        motion = crank_rocker(lead).simulate(231, step=3.3, start_speed=math.degrees(speed))
        assert motion.certified.all()
        energy = motion["kinetic_energy"] + motion["stored_energy"]
        assert np.ptp(energy) < 1e-10 * np.abs(energy).max()
        found[lead] = motion["crank"]
    assert found["crank"][-1] > 1000 * 360
    for lead in ("coupler", "rocker"):
        # some twenty steps of a lap, each to 1e-13 of the speed, add in its period
        assert np.abs(found[lead] - found["crank"]).max() < 1e-11 * found["crank"][-1]


def test_a_damped_mass_on_a_spring_moves_by_its_closed_form() -> None:
    spring = lw.Spring(name="k", between=("S", "B"), stiffness=50, free=2, damping=3)
    motion = lw.linkage(**SLIDER, springs=[spring]).simulate(4, step=0.1)
    t, decay = motion["t"], 3 / (2 * 2)
    w = math.sqrt(50 / 2 - decay**2)
    expected = 2 + np.exp(-decay * t) * (np.cos(w * t) + decay / w * np.sin(w * t))
    assert motion["d"] == pytest.approx(expected, abs=1e-12)
    # the spring is as long on the other side of S
    rests = lw.forces.equilibria(lw.linkage(**SLIDER, springs=[spring]))
    assert [rest.input for rest in rests] == pytest.approx([-2, 2], abs=1e-12)
    for rest in rests:
        assert rest.stable
        # differences of 1e-4 of a panel
        assert rest.frequency == pytest.approx(math.sqrt(50 / 2) / (2 * math.pi), rel=1e-7)


def test_a_motor_runs_up_to_its_free_speed() -> None:
    motor = lw.Motor(stall=12, free_speed="1500 rpm")
    driven = lw.linkage(
        points=PENDULUM["points"], links=PENDULUM["links"], length="m",
        inputs=lw.Input(link="bar", motor=motor, inertia=0.4),
    )  # fmt: skip
    motion = driven.simulate(1, step=0.1)
    free = 1500 * math.tau / 60
    expected = free * (1 - np.exp(-12 / (free * 0.4) * motion["t"]))
    assert motion["bar.velocity"] == pytest.approx(expected, rel=1e-12)


def test_a_motor_by_a_table_is_level_beyond_it() -> None:
    """Two lines: the speed approaches the corner, and then grows evenly."""
    motor = lw.Motor(speeds=("0 rad/s", "10 rad/s"), torques=(8, 2))
    driven = lw.linkage(
        points=PENDULUM["points"], links=PENDULUM["links"], length="m",
        inputs=lw.Input(link="bar", motor=motor, inertia=0.4),
    )  # fmt: skip
    motion = driven.simulate(2, step=0.1)
    t, rate = motion["t"], 0.6 / 0.4
    corner = math.log(4.0) / rate
    falling = 8 / 0.6 * (1 - np.exp(-rate * t))
    expected = np.where(t < corner, falling, 10 + 2 / 0.4 * (t - corner))
    assert motion["bar.velocity"] == pytest.approx(expected, rel=1e-11)


def test_a_load_that_switches_is_met_when_it_does() -> None:
    push = lw.Load(point="B", link="block", force=("10*(t < 0.7)", 0))
    motion = lw.linkage(**SLIDER, loads=[push]).simulate(1, step=0.25)
    (event,) = np.flatnonzero([word == "switch" for word in motion.limit])
    # located to rounding
    assert motion["t"][event] == pytest.approx(0.7, abs=1e-15)
    # its row has the load and the acceleration after the switch
    after = [motion["d.acceleration"][event], motion["B.load.x"][event]]
    assert after == pytest.approx([0.0, 0.0], abs=1e-13)
    assert motion["d"][-1] == pytest.approx(3 + 0.5 * 5 * 0.49 + 5 * 0.7 * 0.3, abs=1e-13)
    stored = lw.Load(point="B", link="block", force=("10*(d < 3.1)", 0))
    motion = lw.linkage(**SLIDER, loads=[stored]).simulate(1, step=0.25)
    (event,) = np.flatnonzero([word == "switch" for word in motion.limit])
    assert motion["t"][event] == pytest.approx(math.sqrt(0.2 / 5), abs=1e-14)
    after = [motion["d.acceleration"][event], motion["B.load.x"][event]]
    assert after == pytest.approx([0.0, 0.0], abs=1e-13)


@pytest.mark.parametrize("force", ["10*(d < {})", "10*(d.velocity < {} - 2)"])
def test_rows_of_switches_have_the_load_after_them(force: str) -> None:
    for place in np.linspace(3.03, 3.4, 12):
        push = lw.Load(point="B", link="block", force=(force.format(place), 0))
        motion = lw.linkage(**SLIDER, loads=[push]).simulate(1, step=0.25)
        (event,) = np.flatnonzero([word == "switch" for word in motion.limit])
        assert motion["B.load.x"][event] == 0.0, place
        assert motion["d.acceleration"][event] == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize("roundings", [0, 1, 2, 4, 8, 16, 32, 64])
def test_a_stop_next_to_a_switch_is_hit(roundings: int) -> None:
    for place in np.linspace(3.05, 3.3, 6).tolist():
        push = lw.Load(point="B", link="block", force=(f"10 + 5*(d < {place!r})", 0))
        stop = lw.Stop(of="d", to=place + roundings * float(np.spacing(place)), restitution=0.5)
        motion = lw.linkage(**SLIDER, loads=[push], stops=[stop]).simulate(1, step=0.25)
        assert motion["d"].max() < place + 1e-9, place
        assert "stop of d" in motion.limit


def test_a_mass_bounces_on_a_stop_and_comes_to_rest() -> None:
    stop = lw.Stop(of="d", to=3.2, restitution=0.5)
    push = lw.Load(point="B", link="block", force=(10, 0))
    motion = lw.linkage(**SLIDER, loads=[push], stops=[stop]).simulate(3, step=0.5)
    hits = motion["t"][[word == "stop of d" for word in motion.limit]]
    first = math.sqrt(2 * 0.2 / 5)
    # flights halve from bounce to bounce
    assert hits[:3] == pytest.approx([first, 2 * first, 2.5 * first], abs=1e-12)
    assert motion["d"].max() <= 3.2 + 1e-14
    assert motion["d"][-1] == pytest.approx(3.2, abs=1e-9)
    assert motion["d.velocity"][-1] == 0.0
    dead = lw.linkage(**SLIDER, loads=[push], stops=[lw.Stop(of="d", to=3.2)]).simulate(1)
    assert sum(word == "stop of d" for word in dead.limit) == 1


def test_a_load_that_holds_back_stops_the_motion() -> None:
    brake = lw.Load(point="B", link="block", force=("10 - 30*(d.velocity > 0)", 0))
    motion = lw.linkage(**SLIDER, loads=[brake]).simulate(1, start_speed=2)
    # 2 m/s against 10 m/s²; then it can neither go on nor back
    assert "at rest since t = 0.2 s" in motion.message
    assert motion["d"][-1] == pytest.approx(3.2, abs=1e-9)


def test_a_switch_that_begins_at_rest_is_met() -> None:
    """The press starts at its upper dead point, where the rate in its load is 0."""
    press = lw.example("crank-press")
    for until in (0.5, 0.55):
        motion = press.simulate(until=until, start_speed="60 rad/s")
        # its energy suffices for a part of the way into the work, where it rests
        energy = motion["kinetic_energy"] + motion["stored_energy"]
        taken = energy[0] - energy[-1]
        assert taken == pytest.approx(20000 * (160 - motion["height"][-1]), rel=1e-9)
        assert "held by a load that switches there" in motion.message


def test_a_load_against_the_rate_holds_from_the_start() -> None:
    """A bar at rest under its weight of 4.9 N·m, held by a brake that is a load."""
    torque = "-6*(bar.velocity > 0) + 6*(bar.velocity < 0)"
    given = {**PENDULUM, "masses": {"bar": lw.Mass(mass=1, shape="rod")}}
    motion = lw.linkage(**given, loads=[lw.Load(link="bar", torque=torque)]).simulate(1)
    assert "at rest since t = 0 s" in motion.message
    assert np.ptp(motion["bar"]) < 1e-12


def test_a_load_that_switches_at_rest_acts_at_once() -> None:
    """A block of 2 kg under 10 N less 4 N that begin with its motion."""
    load = lw.Load(point="B", link="block", force=("-10 + 4*(d.velocity < 0)", 0))
    motion = lw.linkage(**SLIDER, loads=[load]).simulate(1, step=1)
    assert motion["d"][-1] == pytest.approx(3 - 1.5, abs=1e-12)


SYSTEMS: dict[str, tuple[dict[str, str], float, float, float]] = {
    "mm": ({"length": "mm", "mass": "kg", "force": "N"}, 1000.0, 1.0, 1.0),
    "m": ({"length": "m", "mass": "kg", "force": "N"}, 1.0, 1.0, 1.0),
    "in": ({"length": "in", "mass": "lb", "force": "lbf"}, 1 / 0.0254, 1 / 0.45359237,
           1 / 4.4482216152605),
}  # fmt: skip


def _in_units(system: str) -> lw.Motion:
    """One press in a system of units: a spring, a damper, a motor and a load."""
    units, length, mass, force = SYSTEMS[system]
    places = {"A": (0, 0), "B": (0.4, 0), "C": (1.5, 0.6), "D": (1.2, 0)}
    machine = lw.linkage(
        **units,
        points={name: (x * length, y * length) for name, (x, y) in places.items()},
        links={"ground": ["A", "D"], "crank": ["A", "B"], "coupler": ["B", "C"],
               "rocker": ["C", "D"]},
        masses={"crank": lw.Mass(mass=mass, center=(0.2 * length, 0),
                                 inertia=0.1 * mass * length**2),
                "coupler": lw.Mass(mass=2 * mass, shape="rod")},
        springs=[lw.Spring(name="s", between=("A", "C"), stiffness=40 * force / length,
                           free=1.2 * length, damping=0.5 * force / length)],
        loads=[lw.Load(link="rocker", torque=f"{-3 * force * length!r}*(rocker.velocity > 0)")],
        gravity=lw.Gravity(),
        inputs=lw.Input(link="crank", inertia=0.2 * mass * length**2,
                        motor=lw.Motor(stall=9 * force * length, free_speed="90 rpm")),
    )  # fmt: skip
    return machine.simulate(0.7, step=0.1, start_speed="2 rad/s")


def test_units_change_nothing() -> None:
    metric = _in_units("m")
    for system in ("mm", "in"):
        other, (_, length, _, force) = _in_units(system), SYSTEMS[system]
        asked = other.asked
        # rounding of converted numbers: 1e-15 of their size changes the angles by 1e-13 degrees
        assert other["crank"][asked] == pytest.approx(metric["crank"][metric.asked], abs=1e-12)
        effort = other["crank.effort"][asked] / (force * length)
        assert effort == pytest.approx(metric["crank.effort"][metric.asked], rel=1e-12)


def test_efforts_are_those_of_the_motor_less_its_flywheel() -> None:
    motion = _in_units("m")
    speed = motion["crank.velocity"]
    torque = 9 * (1 - speed / (90 * math.tau / 60)) - 0.2 * motion["crank.acceleration"]
    smooth = np.array([word == "" for word in motion.limit])
    assert motion["crank.effort"][smooth] == pytest.approx(torque[smooth], abs=1e-9)


def test_a_motion_ends_at_a_change_point_unless_it_goes_straight() -> None:
    stopped = windows(2).simulate(until=5, start_speed="-1 rad/s")
    assert "the motion ends at t = " in stopped.message
    assert not stopped.found.all()


@pytest.mark.parametrize(
    ("changes", "options", "message"),
    [
        ({"masses": {}}, {}, "nothing in .* has mass"),
        ({}, {"until": -1}, "until must be a positive time"),
        ({}, {"until": 5e-324}, "until must be at least 1e-100 s, got 5e-324"),
        ({}, {"step": 0}, "step must be a part of until, 1 s, that makes 1 to"),
        ({}, {"step": 2}, "step must be a part of until, 1 s, that makes 1 to"),
        ({}, {"start_speed": "3 mm/s"}, "start speed: must be a number and a unit"),
        ({}, {"change_points": "turn"}, "goes straight on or stops"),
        ({"stops": [lw.Stop(of="bar", to=100)]}, {}, "bar begins at 180, beyond its stop at 100"),
        ({"inputs": lw.Input(link="bar", law="180 + t", to=1)}, {}, "a law drives"),
    ],
)
def test_wrong_input_is_refused(
    changes: dict[str, Any], options: dict[str, Any], message: str
) -> None:
    machine = lw.linkage(**{**PENDULUM, **changes})
    with pytest.raises(lw.LinkworkError, match=message):
        machine.simulate(**{"until": 1, **options})


def test_wrong_keys_are_told_with_their_place() -> None:
    text = """format = 1
[points]
O = [0, 0]
A = [1, 0]
[links]
ground = ["O"]
bar = ["O", "A"]
[[stops]]
of = "bar"
restitution = 2
from = 1
[input]
link = "bar"
inertia = -1
motor = { stall = 2, free_speed = "9 mm/s" }
"""
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(text)
    told = {problem.line: problem.message for problem in caught.value.problems}
    assert "must be from 0 to 1, got 2" in told[10]
    assert "must not be negative, got -1" in told[14]
    assert "rpm, rad/s, deg/s" in told[15]


def _lever(direction: complex, **more: Any) -> lw.Mechanism:
    return lw.linkage(
        length="m", angle="rad", points={"O": (0, 0), "A": (direction.real, direction.imag)},
        links={"ground": ["O"], "a": ["O", "A"]}, inputs=(lw.Input(link="a"),),
        masses={"a": lw.Mass(mass=1, center=(0, 0), inertia=1)}, **more,
    )  # fmt: skip


@pytest.mark.parametrize(("of", "restitution"), [("a", 0.5), ("A.y", 0.8), ("A.x", 0.3)])
def test_short_bounces_do_not_go_through_a_stop(of: str, restitution: float) -> None:
    places: dict[str, Any] = {"a": float, "A.x": np.cos, "A.y": np.sin}
    for start in (0.65, 0.7, 0.9, 1.25):
        value = float(places[of](start - 0.1))
        side = "to" if of == "A.x" else "from_"
        stop = lw.Stop(of=of, restitution=restitution, **{side: value})
        push = lw.Load(link="a", torque=-1)
        motion = _lever(np.exp(1j * start), stops=[stop], loads=[push]).simulate(until=5, step=1)
        assert (motion["a"] - (start - 0.1)).min() >= -1e-9
        assert motion["a"][-1] == pytest.approx(start - 0.1, abs=1e-9)  # it comes to rest


@pytest.mark.parametrize("side", ["from_", "to"])
@pytest.mark.parametrize("start", [0.3, 1.1])
def test_a_motion_may_begin_at_a_stop(start: float, side: str) -> None:
    into = -1 if side == "from_" else 1
    stop = lw.Stop(of="a", restitution=1, **{side: start})
    lever = _lever(np.exp(1j * start), stops=[stop])
    bounced = lever.simulate(until=1, step=0.5, start_speed=into)
    assert bounced.limit.count("stop of a") == 1
    assert bounced["a"][-1] == pytest.approx(start - into, abs=1e-12)
    left = lever.simulate(until=1, step=0.5, start_speed=-into)
    assert left["a"][-1] == pytest.approx(start - into, abs=1e-12)
    pushed = _lever(np.exp(1j * start), stops=[stop], loads=[lw.Load(link="a", torque=into)])
    assert pushed.simulate(until=1, step=0.5)["a"] == pytest.approx(start, abs=1e-12)


def test_a_crank_without_mass_does_not_start_at_its_dead_point() -> None:
    parts: dict[str, Any] = {
        "points": {"O": (0, 0), "T": (3, 0), "A": (0.5, 0), "B": (2.3, 0)},
        "links": {"ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "B"], "piston": ["B"]},
        "masses": {"piston": lw.Mass(mass=1)},
        "sliders": [
            lw.Slider(name="d", link="piston", points=("B",), on="ground", line=("O", "T"))
        ],
        "inputs": lw.Input(link="crank"),
    }
    with pytest.raises(lw.InputError, match="no body with mass moves at the start"):
        lw.linkage(length="m", **parts).simulate(until=0.1, start_speed="20 rad/s")
    heavier = {**parts, "masses": {**parts["masses"], "crank": lw.Mass(mass=1, shape="rod")}}
    motion = lw.linkage(length="m", **heavier).simulate(until=0.1, start_speed="20 rad/s")
    assert motion.certified.all()


@pytest.mark.parametrize("start", [1.0, 0.9])
def test_a_stop_one_length_from_the_start_is_hit(start: float) -> None:
    """There the leg of positions ends, too."""
    block = lw.linkage(
        length="m",
        points={"O": (0, 0), "T": (1, 0), "P": (start, 0)},
        links={"ground": ["O", "T"], "block": ["P"]},
        sliders=[lw.Slider(name="s", link="block", points=("P",), on="ground", line=("O", "T"))],
        masses={"block": lw.Mass(mass=1)},
        loads=[lw.Load(point="P", force=(-1, 0))],
        stops=[lw.Stop(of="s", from_=0)],
        inputs=lw.Input(slider="s", from_=0, to=1, step=1),
    )
    motion = block.simulate(until=3)
    assert motion["s"][-1] == pytest.approx(0.0, abs=1e-13)
    hit = motion.limit.index("stop of s")
    assert motion["t"][hit] == pytest.approx(math.sqrt(2 * start), abs=1e-12)
    assert "held by the stop of s" in motion.message


@pytest.mark.parametrize(
    ("torque", "works"),
    [
        ("1 - 2*(sin(crank) < 0)", [1.0, 0.0, 1.0, 0.0]),
        ("1*(sin(crank) > 0)", [1.0, 1.0, 2.0, 2.0]),
    ],
)
def test_switches_half_a_turn_from_the_start_are_met(torque: str, works: list[float]) -> None:
    """There a leg of positions ends, too; works are in half turns of a unit torque."""
    rotor = lw.linkage(
        length="m",
        points={"O": (0, 0), "P": (1, 0)},
        links={"ground": ["O"], "crank": ["O", "P"]},
        masses={"crank": lw.Mass(mass=1, center=(1, 0))},
        loads=[lw.Load(link="crank", torque=torque)],
        inputs=lw.Input(link="crank"),
    )
    motion = rotor.simulate(until=4.9, start_speed="2 rad/s", step=0.7)
    at = [k for k, event in enumerate(motion.limit) if event == "switch"][:4]
    assert motion["crank"][at] == pytest.approx([180.0, 360.0, 540.0, 720.0], abs=1e-9)
    speeds = [math.sqrt(4.0 + 2.0 * math.pi * work) for work in works]
    assert motion["crank.velocity"][at] == pytest.approx(speeds, rel=1e-9)


@pytest.mark.parametrize(("speed", "key"), [("2 rad/s", "from_"), ("-2 rad/s", "to")])
def test_a_crank_that_leaves_its_stop_comes_back_to_it(speed: str, key: str) -> None:
    """The stop is where the curve of positions begins and ends."""
    bar = lw.linkage(
        length="m",
        points={"A": (0, 0), "B": (0.4, 0), "C": (1.5, 0.6), "D": (1.2, 0)},
        links={
            "ground": ["A", "D"], "crank": ["A", "B"], "coupler": ["B", "C"], "rocker": ["D", "C"],
        },
        masses={
            "crank": lw.Mass(mass=1, shape="rod"),
            "coupler": lw.Mass(mass=2, shape="rod"),
            "rocker": lw.Mass(mass=3, shape="rod"),
        },
        gravity=lw.Gravity(angle=-90 if key == "from_" else 90),
        stops=[lw.Stop(of="crank", **{key: 0})],
        inputs=lw.Input(link="crank"),
    )  # fmt: skip
    motion = bar.simulate(until=1.5, start_speed=speed)
    inside = motion["crank"] if key == "from_" else -motion["crank"]
    assert inside.min() > -1e-9
    assert inside.max() > 10.0
    assert "stop of crank" in motion.limit


def test_a_short_pulse_ends_a_rest() -> None:
    pushed = {
        **SLIDER,
        "loads": [lw.Load(point="B", force=("-1 + 2e4*(t > 1.03)*(t < 1.0303)", 0))],
    }
    stopped = lw.linkage(**pushed, stops=[lw.Stop(of="d", from_=3)])
    motion = stopped.simulate(until=4, step=0.5)
    # an impulse of 6 Ns less that of the steady load
    expected = (6.0 - (4.0 - 1.03)) / 2.0
    assert motion["d.velocity"][-1] == pytest.approx(expected, abs=1e-9)


def test_nothing_that_moves_an_unloaded_machine_is_rest() -> None:
    motion = lw.linkage(**SLIDER).simulate(until=1)
    assert motion.message == "simulated to t = 1 s; at rest since t = 0 s, in equilibrium"
    assert (motion["d"] == 3.0).all()
    assert motion.certified.all()


def test_a_start_at_a_change_point_is_refused() -> None:
    bars = lw.linkage(
        length="m",
        points={"A": (0, 0), "B": (0.3, 0), "C": (1.3, 0), "D": (1, 0)},
        links={
            "ground": ["A", "D"],
            "crank": ["A", "B"],
            "coupler": ["B", "C"],
            "rocker": ["D", "C"],
        },
        masses={"crank": lw.Mass(mass=1, shape="rod"), "coupler": lw.Mass(mass=1, shape="rod")},
        inputs=lw.Input(link="crank"),
    )
    with pytest.raises(lw.InputError, match="cannot start at a change point"):
        bars.simulate(until=1, at=0)


@pytest.mark.parametrize("start", [3.0, 1.0, 0.9, 0.0])
def test_equilibria_at_a_stop_and_on_a_stretch_do_not_hang_on_the_start(start: float) -> None:
    machine = {**SLIDER, "points": {**SLIDER["points"], "B": (start, 0)}}
    stop = lw.Stop(of="d", from_=0)

    def places(force: str) -> list[tuple[float, bool, str]]:
        load = lw.Load(point="B", force=(force, 0))
        found = lw.forces.equilibria(lw.linkage(**machine, stops=[stop], loads=[load]))
        return [(round(each.input, 9), each.stable, each.indifferent) for each in found]

    assert places("-d") == [(0.0, True, "")]
    ((place, _, indifferent),) = places("-max(0, d - 1)")
    assert 0.0 <= place <= 1.0
    assert indifferent == "near"
