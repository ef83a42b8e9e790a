"""Simulated motions of several inputs against SciPy, closed forms and the motion of one input."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import linkwork as lw

G = 9.81
CART: dict[str, Any] = {
    "length": "m",
    "points": {"S": (-5, 0), "T": (5, 0), "B": (0, 0), "P": (0, -1)},
    "links": {"ground": ["S", "T"], "cart": ["B"], "bar": ["B", "P"]},
    "sliders": [lw.Slider(name="d", link="cart", points=("B",), on="ground", line=("S", "T"))],
    "masses": {"cart": lw.Mass(mass=3), "bar": lw.Mass(mass=1, center=(1, 0))},
    "gravity": lw.Gravity(),
    "inputs": (
        lw.Input(slider="d", from_=4, to=6, step=1),
        lw.Input(link="bar", from_=-90, to=-80, step=5),
    ),
}


def _arm(size: float, unit: str, **more: Any) -> lw.Mechanism:
    """A five-bar on two cranks, with a spring and a load that switches, in a unit of length."""
    given: dict[str, Any] = {
        "length": unit,
        "points": {
            name: (x * size, y * size)
            for name, (x, y) in {
                "O": (0, 0), "A": (-0.2, 0.45), "P": (0.3, 1.0), "B": (0.8, 0.45), "C": (0.6, 0),
            }.items()
        },
        "links": {
            "ground": ["O", "C"], "left": ["O", "A"], "long": ["A", "P"], "short": ["B", "P"],
            "right": ["C", "B"],
        },
        "masses": {
            "left": lw.Mass(mass=1, shape="rod"), "right": lw.Mass(mass=2, shape="rod"),
            "long": lw.Mass(mass=0.5, center=(0.2 * size, 0.05 * size), inertia=0.01 * size**2),
        },
        "gravity": lw.Gravity(),
        "loads": [lw.Load(point="P", force=("4*(t < 0.06)", 1))],
        "inputs": (
            lw.Input(link="left", inertia=0.1 * size**2),
            lw.Input(link="right", motor=lw.Motor(stall=0.5 * size, free_speed="60 rpm")),
        ),
    }  # fmt: skip
    return lw.linkage(**(given | more))


def _double_pendulum(_: float, y: Any) -> list[float]:
    a, b, u, w = y
    turned = a - b
    masses = [[2.0, math.cos(turned)], [math.cos(turned), 1.0]]
    right = [
        -math.sin(turned) * w * w - 2.0 * G * math.cos(a),
        math.sin(turned) * u * u - G * math.cos(b),
    ]
    return [u, w, *np.linalg.solve(masses, right)]


def test_a_double_pendulum_is_that_of_lagrange() -> None:
    """By SciPy from the textbook's equations; the energy is constant."""
    motion = lw.example("double-pendulum").simulate(
        until=2, step=1, start_speed={"upper": "2 rad/s"}
    )
    start = [-math.pi / 4, 0.0, 2.0, 0.0]
    oracle = solve_ivp(
        _double_pendulum, (0, 2), start, "DOP853", motion["t"], rtol=1e-13, atol=1e-13
    )
    assert np.radians(motion["upper"]) == pytest.approx(oracle.y[0], abs=1e-11)
    assert np.radians(motion["lower"]) == pytest.approx(oracle.y[1], abs=1e-11)
    assert motion["upper.velocity"] == pytest.approx(oracle.y[2], abs=1e-10)
    energy = motion["kinetic_energy"] + motion["stored_energy"]
    assert energy == pytest.approx(energy[0], rel=1e-12)
    # no input is driven: free bodies need no effort either
    assert np.abs(motion["upper.effort"]).max() < 1e-11
    assert motion.certified.all()


def test_a_cart_with_a_pendulum_swings_at_its_frequency() -> None:
    """ω² = (1 + m / M) g / l of small swings; the mass centre stays."""
    swing = 1e-4
    cart = lw.linkage(**CART)
    omega = math.sqrt((1 + 1 / 3) * G)
    at = {"d": 5.0, "bar": -90 + math.degrees(swing)}
    motion = cart.simulate(until=1, step=0.25, at=at)
    angle = np.radians(motion["bar"] + 90)
    assert angle == pytest.approx(swing * np.cos(omega * motion["t"]), abs=1e-7 * swing)
    centre = 3 * motion["B.x"] + motion["P.x"]
    assert centre == pytest.approx(centre[0], abs=1e-13)


def test_a_closed_loop_keeps_its_balance_and_its_units() -> None:
    """A five-bar with motor, flywheel and a switched load: in m and mm, and by power."""
    metres = _arm(1.0, "m").simulate(until=0.2, step=0.05)
    millimetres = _arm(1000.0, "mm").simulate(until=0.2, step=0.05)
    for name in ("left", "right", "left.velocity"):
        assert millimetres[name] == pytest.approx(metres[name], rel=1e-11)
    assert "switch" in metres.limit
    assert metres["t"][list(metres.limit).index("switch")] == pytest.approx(0.06, abs=1e-15)
    # the free inputs: of one a flywheel resists, the other has its motor alone
    asked = metres.asked
    flywheel = -0.1 * metres["left.acceleration"]
    assert metres["left.effort"][asked] == pytest.approx(flywheel[asked], abs=1e-10)
    torque = 0.5 * (1 - metres["right.velocity"] / (2 * math.pi))
    assert metres["right.effort"][asked] == pytest.approx(torque[asked], abs=1e-10)
    assert metres["disagreement"].max() < 1e-11


def test_a_cart_bounces_off_a_stop_and_its_pendulum_swings() -> None:
    """M = [[4, 1], [1, 1]] below: the impulse on the cart alone leaves 1 m/s and -2 rad/s."""
    stop = lw.Stop(of="d", from_=4.9, restitution=1)
    motion = lw.linkage(**CART, stops=[stop]).simulate(
        until=0.2, step=0.1, at={"d": 5, "bar": -90}, start_speed={"d": -1}
    )
    (hit,) = np.flatnonzero([word == "stop of d" for word in motion.limit])
    assert motion["t"][hit] == pytest.approx(0.1, abs=1e-12)
    assert motion["d.velocity"][hit] == pytest.approx(-1, abs=1e-12)
    energy = motion["kinetic_energy"] + motion["stored_energy"]
    assert energy == pytest.approx(energy[0], rel=1e-12)
    oracle = solve_ivp(
        _free_cart, (0, 0.1), [4.9, -math.pi / 2, 1, -2], "DOP853", rtol=1e-13, atol=1e-13
    )
    last = [motion["d"][-1], math.radians(motion["bar"][-1]), motion["d.velocity"][-1]]
    assert last == pytest.approx(oracle.y[:3, -1], abs=1e-10)


def _free_cart(_: float, y: Any) -> list[float]:
    _, angle, v, w = y
    masses = [[4, -math.sin(angle)], [-math.sin(angle), 1]]
    right = [math.cos(angle) * w**2, -G * math.cos(angle)]
    return [v, w, *np.linalg.solve(masses, right)]


def _arms(directions: tuple[complex, complex], joint: str, **more: Any) -> lw.Mechanism:
    """Two arms of length 1, the second about the end of the first one or about ground."""
    first, second = directions
    own = ["A", "B"] if joint == "A" else ["O", "B"]
    tip = second + (first if joint == "A" else 0.0)
    points = {"O": 0j, "A": first, "B": tip}
    given: dict[str, Any] = {
        "length": "m",
        "angle": "rad",
        "points": {name: (z.real, z.imag) for name, z in points.items()},
        "links": {"ground": ["O"], "a": ["O", "A"], "b": own},
        "masses": {x: lw.Mass(mass=1, center=("1/2", 0), inertia="1/10") for x in "ab"},
        "inputs": (lw.Input(link="a"), lw.Input(link="b")),
    }
    return lw.linkage(**(given | more))


@pytest.mark.parametrize(
    ("angles", "speeds", "leaves"),
    [
        ((0.37, 0.83), (-0.68, -2.5), True),  # the tip turns away from the wall by itself
        ((-1.02, 1.41), (-0.1, -2.3), False),
    ],
)
def test_whether_a_motion_stays_at_a_stop_depends_on_its_path_too(
    angles: tuple[float, float], speeds: tuple[float, float], leaves: bool
) -> None:
    directions = np.exp(1j * np.array(angles))
    wall = float(sum(directions).real) + 0.05
    stops = [lw.Stop(of="B.x", to=wall)]
    given = dict(zip("ab", speeds, strict=True))
    motion = _arms(tuple(directions), "A", stops=stops).simulate(
        until=0.4, step=0.02, start_speed=given
    )
    assert "stop of B.x" in motion.limit
    assert np.nanmax(motion["B.x"]) <= wall + 1e-12
    assert motion.found.all()
    hit = motion.limit.index("stop of B.x")
    stays = motion["B.x.stop"][hit + 1] < 0
    assert stays != leaves
    if stays:
        assert motion["B.x"][hit + 1] == pytest.approx(wall, abs=1e-13)
    # from just after the shock, without the stop
    a, b = (float(motion[name][hit]) for name in "ab")
    before = np.array([motion["a.d1"][hit], motion["b.d1"][hit]])
    mass = np.array([[1.35, 0.5 * np.cos(a - b)], [0.5 * np.cos(a - b), 0.35]])
    normal = np.array([np.sin(a), np.sin(b)])
    push = np.linalg.solve(mass, normal)
    after = before - (normal @ before) / (normal @ push) * push
    free = _arms((np.exp(1j * a), np.exp(1j * b)), "A").simulate(
        until=1e-3, step=5e-4, start_speed=dict(zip("ab", after.tolist(), strict=True))
    )
    assert (free["B.x"][-1] < wall) == leaves


def test_a_stop_that_a_law_moves_is_a_moving_wall() -> None:
    turning = (lw.LawSegment(law="constant", over=3, by=3),)
    inputs = (lw.Input(link="a", law=turning), lw.Input(link="b", from_=1.5, to=1.5))
    masses = {x: lw.Mass(mass=1, center=(0, 0), inertia=1) for x in "ab"}
    arms = _arms(
        (1 + 0j, np.exp(1.5j)), "O", inputs=inputs, masses=masses, outputs={"gap": "b - a"},
        stops=[lw.Stop(of="gap", from_=0.5, restitution=1)],
    )  # fmt: skip
    motion = arms.simulate(until=3, step=0.5, start_speed={"b": 0})
    (hit,) = np.flatnonzero([word == "stop of gap" for word in motion.limit])
    t = motion["t"]
    assert t[hit] == pytest.approx(1.0, abs=1e-12)
    # at rest before, away from the wall as fast as the wall came after
    assert motion["b"] == pytest.approx(np.where(t <= t[hit], 1.5, 1.5 + 2.0 * (t - 1.0)), abs=1e-9)


def test_a_law_that_moves_into_a_stop_ends_the_motion() -> None:
    turning = (lw.LawSegment(law="constant", over=3, by=3),)
    inputs = (lw.Input(link="a", law=turning), lw.Input(link="b", from_=1, to=1))
    stops = [lw.Stop(of="a", to=1)]
    motion = _arms((1 + 0j, 1j), "O", inputs=inputs, stops=stops).simulate(until=3, step=0.5)
    assert "a law drives the mechanism into the stop of a" in motion.message
    assert motion["t"][motion.found].max() == pytest.approx(1.0, abs=1e-12)


def test_a_cart_stays_at_a_stop_until_its_pendulum_pulls_it_away() -> None:
    """The stop gives what Newton's law of both bodies leaves; where that would pull, it ends."""
    push = lw.Load(point="B", link="cart", force=(-1, 0))
    cart = lw.linkage(**CART, stops=[lw.Stop(of="d", from_=4.9)], loads=[push])
    motion = cart.simulate(until=2, at={"d": 5, "bar": -90}, start_speed={"d": -1})
    assert motion.found.all()
    hit, off = motion.limit.index("stop of d"), motion.limit.index("start")
    closed = slice(hit + 1, off)
    assert off > hit + 2
    assert motion["d"][closed] == pytest.approx(4.9, abs=1e-13)
    angle, rate, bend = (
        motion[f"bar{word}"] for word in ("", ".velocity", ".acceleration")
    )  # fmt: skip
    angle = np.radians(angle)
    pull = bend * np.sin(angle) + rate**2 * np.cos(angle)
    assert motion["d.stop"][closed] == pytest.approx((1 - pull)[closed], abs=1e-10)
    assert motion["d.stop"][closed].min() > 0
    assert (1 - pull)[off] == pytest.approx(0, abs=1e-10)
    assert motion["d"][off + 1 :].min() > 4.9
    # energy is taken by the shock alone: the load's potential is d
    energy = motion["kinetic_energy"] + motion["stored_energy"] + motion["d"]
    assert np.ptp(energy[: hit + 1]) < 1e-11
    assert np.ptp(energy[hit + 1 :]) < 1e-11


def test_a_stretched_arm_ends_the_motion() -> None:
    """The inputs do not lead beyond the place at which both rods are in line."""
    speeds = {"left": "3 rad/s", "right": "-3 rad/s"}
    motion = _arm(1.0, "m", gravity=None).simulate(until=1, step=0.1, start_speed=speeds)
    assert "the motion ends at t = " in motion.message
    assert "left = " in motion.message
    assert "dead point" in motion.message


@pytest.mark.parametrize(
    ("change", "asked", "said"),
    [
        (
            {"friction": {"B": lw.Friction(mu=0.1, radius=0.1)}},
            {},
            "friction is simulated",
        ),
        ({}, {"change_points": "straight"}, "stops at change points"),
        ({}, {"start_speed": 1}, "name the start speed of each"),
        ({}, {"start_speed": {"bra": 1}}, 'no input "bra"'),
        ({"masses": {"cart": lw.Mass(mass=3)}}, {}, "without moving a mass"),
        ({"masses": {}}, {}, "has mass"),
        ({"stops": [lw.Stop(of="d", from_=5.5)]}, {"at": {"d": 5, "bar": -90}}, "beyond its stop"),
    ],
)
def test_what_is_not_simulated_is_refused(
    change: dict[str, Any], asked: dict[str, Any], said: str
) -> None:
    """Each with its reason."""
    with pytest.raises(lw.InputError, match=said):
        lw.linkage(**(CART | change)).simulate(until=1, **asked)


def _driven_cart(**more: Any) -> lw.Mechanism:
    """The cart moves 1 m by a law and stays, while its pendulum is free."""
    law = [lw.LawSegment(law="3-4-5", over=1, by=1), lw.LawSegment(law="dwell", over=1)]
    given: dict[str, Any] = {"begin": 5, "law": law} | more
    bar = lw.Input(link="bar", from_=-90, to=-90)
    return lw.linkage(**(CART | {"inputs": (lw.Input(slider="d", **given), bar)}))


def _on_driven_cart(t: float, y: Any) -> list[float]:
    """Angle, speed, and work of the drive of a pendulum of 1 kg, 1 m on a cart of 3 kg."""
    angle, rate, _ = y
    x = min(t, 1.0)
    speed = 30 * x**2 - 60 * x**3 + 30 * x**4
    bend = 60 * x - 180 * x**2 + 120 * x**3
    turn = bend * math.sin(angle) - G * math.cos(angle)
    force = 4 * bend - math.sin(angle) * turn - math.cos(angle) * rate**2
    return [rate, turn, force * speed]


def test_a_pendulum_on_a_cart_that_a_law_drives_is_that_of_newton() -> None:
    """By SciPy from equations written here; the drive's work is the energy that is gained."""
    motion = _driven_cart().simulate(until=2, step=0.25, start_speed={"bar": "1 rad/s"})
    oracle = solve_ivp(
        _on_driven_cart, (0, 2), [-math.pi / 2, 1, 0], "DOP853", motion["t"],
        rtol=1e-13, atol=1e-13, max_step=0.05,
    )  # fmt: skip
    assert np.radians(motion["bar"]) == pytest.approx(oracle.y[0], abs=1e-10)
    assert motion["bar.velocity"] == pytest.approx(oracle.y[1], abs=1e-10)
    energy = motion["kinetic_energy"] + motion["stored_energy"]
    assert energy - energy[0] == pytest.approx(oracle.y[2], abs=1e-10)
    # the cart follows its law exactly, and its force does all the work
    assert motion["d"][[0, 2, 8]] == pytest.approx([5, 5.5, 6], abs=1e-15)
    drawn = [_on_driven_cart(t, y)[2] for t, y in zip(motion["t"], oracle.y.T, strict=True)]
    assert motion["d.effort"] * motion["d.velocity"] == pytest.approx(drawn, abs=1e-9)
    assert np.abs(motion["bar.effort"]).max() < 1e-13
    assert np.abs(motion["power"] - motion["energy_rate"]).max() < 1e-12


def test_a_formula_of_the_time_drives_a_crank_of_a_five_bar() -> None:
    """Against the same motion with both cranks driven, by the law of this one and the table."""
    left = lw.Input(link="left", law="120 + 20*sin(180*t)", from_=0, to=1)
    right = lw.Input(link="right", from_=66, to=66)
    arm = _arm(1.0, "m", loads=(), inputs=(left, right))
    motion = arm.simulate(until=0.1, step=0.05)
    law = 120 + 20 * np.sin(np.pi * motion["t"])
    assert motion["left"] == pytest.approx(law, abs=1e-11)
    assert motion["disagreement"].max() < 1e-11
    assert np.abs(motion["right.effort"]).max() < 1e-10
    rate = motion["load_power"] + motion["power"] - motion["energy_rate"]
    assert np.abs(rate).max() < 1e-11


@pytest.mark.parametrize(
    ("change", "asked", "said"),
    [
        ({}, {"until": 3}, "the law of d ends at 2 s, before 3 s: add a segment"),
        ({}, {"start_speed": {"d": 1}}, "start speed: a law drives d, which has its speed"),
        ({}, {"at": {"d": 5.5}}, "a law drives d, which begins where the law does: leave it out"),
        ({}, {"at": 5.5}, "name the input that begins at 5.5, for example d=5.5"),
        ({}, {"at": {"bra": 1}}, '"bra" is not an input'),
        (
            {"law": [lw.LawSegment(law="constant", over=1, by=1),
                     lw.LawSegment(law="dwell", over=1)]},
            {},
            "the law of d changes its speed at once at 1 s, a shock for the free inputs",
        ),
        (
            {"law": "5 + t^3", "from_": 0.5, "to": 2, "begin": None},
            {},
            "the law of d begins at 0.5 s, after the simulation: let its formula begin at 0",
        ),
    ],
)  # fmt: skip
def test_laws_that_do_not_fit_a_simulation_are_refused(
    change: dict[str, Any], asked: dict[str, Any], said: str
) -> None:
    """Each with its time or its input."""
    with pytest.raises(lw.InputError) as caught:
        _driven_cart(**change).simulate(**({"until": 2} | asked))
    assert said in str(caught.value)


def test_a_double_pendulum_has_four_equilibria() -> None:
    """ω² = (2 ± √2) g/l about the hanging one, with signs for bars that stand."""
    found = lw.forces.equilibria(lw.example("double-pendulum"))
    places = [(each.values["upper"], each.values["lower"]) for each in found]
    signs = [(-1, -1), (-1, 1), (1, -1), (1, 1)]
    assert np.array(places) == pytest.approx(90 * np.array(signs), abs=1e-9)
    assert [each.stable for each in found] == [True, False, False, False]
    # K = -g diag(2 sin a, sin b), M = [[2, cos(a - b)], [cos(a - b), 1]]
    for each, (a, b) in zip(found, signs, strict=True):
        masses = np.array([[2, a * b], [a * b, 1]])
        squares = np.linalg.eigvals(np.linalg.solve(masses, -G * np.diag([2 * a, b])))
        rates = np.sort(np.sign(squares) * np.sqrt(np.abs(squares))) / (2 * math.pi)
        assert each.frequencies == pytest.approx(rates, rel=1e-9)
        assert each.frequency == each.frequencies[0]


@pytest.mark.extended
def test_equilibria_of_a_five_bar_are_at_rest() -> None:
    """A motion that starts at rest there does not begin to move; at the others a law is refused."""
    spring = lw.Spring(name="s", between=("A", "B"), stiffness=200, free=1)
    free = [lw.Input(link="left"), lw.Input(link="right")]
    arm = _arm(1.0, "m", loads=(), springs=[spring], inputs=free)
    stable = [each for each in lw.forces.equilibria(arm) if each.stable]
    assert len(stable) >= 2
    for each in stable[:2]:
        at = {name: each.values[name] for name in ("left", "right")}
        motion = arm.simulate(until=0.5, step=0.5, at=at)
        assert np.abs(motion["left.acceleration"]).max() < 1e-9
        assert motion["left"] == pytest.approx(at["left"], abs=1e-9)
    with pytest.raises(lw.InputError, match="leave it out for equilibria"):
        lw.forces.equilibria(_driven_cart())


def test_a_motion_of_several_inputs_may_begin_at_a_stop() -> None:
    masses = {x: lw.Mass(mass=1, center=(0, 0), inertia=1) for x in "ab"}
    begin = float(np.angle(np.exp(0.3j)))
    stops = [lw.Stop(of="a", from_=begin, restitution=1)]
    arms = _arms((np.exp(0.3j), 1j), "O", masses=masses, stops=stops)
    for speed in (-1, 1):
        motion = arms.simulate(until=1, step=0.5, start_speed={"a": speed})
        assert motion["a"][-1] == pytest.approx(1.3, abs=1e-12)
    push = [lw.Load(link="a", torque=-1)]
    held = _arms((np.exp(0.3j), 1j), "O", masses=masses, stops=stops, loads=push)
    motion = held.simulate(until=1, step=0.5)
    assert motion["a"] == pytest.approx(0.3, abs=1e-14)
    assert motion["a.stop"] == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("roundings", [0, 1, 2, 4, 8])
def test_a_stop_next_to_a_switch_is_hit_with_several_inputs(roundings: int) -> None:
    stop = lw.Stop(of="d", to=5.05 + roundings * float(np.spacing(5.05)), restitution=0.5)
    push = lw.Load(point="B", link="cart", force=("3 + 3*(d < 5.05)", 0))
    more: dict[str, Any] = {"gravity": None, "loads": [push], "stops": [stop]}
    motion = lw.linkage(**(CART | more)).simulate(until=0.6, step=0.2, at={"d": 5, "bar": -90})
    assert motion["d"].max() < 5.05 + 1e-9
    assert "stop of d" in motion.limit


@pytest.mark.parametrize("load", ["-1*(t > 0.2)", "-t"])
def test_a_stop_that_is_touched_before_it_is_pushed_holds(load: str) -> None:
    other = lw.Slider(name="f", link="other", points=("C",), on="ground", line=("U", "V"))
    motion = lw.linkage(
        length="m",
        points={"S": (0, 0), "T": (9, 0), "B": (3, 0), "U": (0, 1), "V": (9, 1), "C": (3, 1)},
        links={"ground": ["S", "T", "U", "V"], "block": ["B"], "other": ["C"]},
        sliders=[
            lw.Slider(name="d", link="block", points=("B",), on="ground", line=("S", "T")), other,
        ],
        masses={"block": lw.Mass(mass=2), "other": lw.Mass(mass=1)},
        loads=[lw.Load(point="C", link="other", force=(load, 0))],
        stops=[lw.Stop(of="f", from_=3)],
        inputs=tuple(lw.Input(slider=x, from_=1, to=8, step=1) for x in "df"),
    ).simulate(until=2, step=0.1, at={"d": 3, "f": 3})  # fmt: skip
    assert motion["f"] == pytest.approx(3, abs=1e-12)
