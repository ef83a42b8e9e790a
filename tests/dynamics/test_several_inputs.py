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
        lw.Input(slider="d", start=4, stop=6, step=1),
        lw.Input(link="bar", start=-90, stop=-80, step=5),
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


def test_a_stop_ends_the_motion_where_it_is_hit() -> None:
    """Shocks of several inputs are not computed: time and place are said."""
    stop = lw.Stop(of="d", start=4.9)
    motion = lw.linkage(**CART, stops=[stop]).simulate(
        until=1, at={"d": 5, "bar": -90}, start_speed={"d": -1}
    )
    assert motion.message.startswith("the motion ends at t = 0.")
    assert "d = 4.9 m" in motion.message
    assert "stop of d" in motion.limit
    assert not motion.found[-1]


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
        ({"stops": [lw.Stop(of="d", start=5.5)]}, {"at": {"d": 5, "bar": -90}}, "beyond its stop"),
    ],
)
def test_what_is_not_simulated_is_refused(
    change: dict[str, Any], asked: dict[str, Any], said: str
) -> None:
    """Each with its reason."""
    with pytest.raises(lw.InputError, match=said):
        lw.linkage(**(CART | change)).simulate(until=1, **asked)
