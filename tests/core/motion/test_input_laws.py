"""Inputs with laws: time drives the rows."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.arrays import Array
from linkwork.core.mechanism.inputs import INPUT_LAWS
from linkwork.core.textfile import write_text


def _driven(law: Any, name: str = "four-bar", **fields: Any) -> lw.Mechanism:
    """A mechanism of the library whose input has a law."""
    bar = lw.example(name)
    own = replace(bar.description.inputs[0], from_=None, to=None, step=None, speed=None)
    return bar.changed(inputs=replace(own, law=law, **fields))


@pytest.mark.parametrize("law", [law for law in INPUT_LAWS if law not in ("dwell", "ramp")])
def test_every_law_moves_the_input_by_its_displacement(law: str) -> None:
    over, by = 0.4, 60.0
    motion = _driven([lw.LawSegment(law=law, over=over, by=by)], begin=20).sweep()
    assert motion.certified.all()
    # rounding of a polynomial with coefficients up to 84
    assert motion["crank"][[0, -1]] == pytest.approx([20.0, 20.0 + by], abs=1e-11)
    x, value, rate = motion["t"] / over, motion["crank"], motion["crank.velocity"]
    for at, (place, slope) in _closed_form(law, x).items():
        assert value[at] == pytest.approx(20.0 + by * place, abs=1e-11)
        assert rate[at] == pytest.approx(math.radians(by) / over * slope, abs=1e-11)


def _closed_form(law: str, x: Array) -> dict[int, tuple[float, float]]:
    """Place and slope of the laws with one formula, at some rows."""
    forms: dict[str, Callable[[float], tuple[float, float]]] = {
        "constant": lambda x: (x, 1.0),
        "harmonic": lambda x: (
            (1 - math.cos(math.pi * x)) / 2, math.pi / 2 * math.sin(math.pi * x)
        ),
        "cycloidal": lambda x: (
            x - math.sin(2 * math.pi * x) / (2 * math.pi), 1 - math.cos(2 * math.pi * x)
        ),
        "3-4-5": lambda x: (10 * x**3 - 15 * x**4 + 6 * x**5, 30 * x**2 * (1 - x) ** 2),
        "4-5-6-7": lambda x: (
            35 * x**4 - 84 * x**5 + 70 * x**6 - 20 * x**7, 140 * x**3 * (1 - x) ** 3
        ),
        "trapezoid": lambda x: (2.25 * x**2, 4.5 * x) if x <= 1 / 3 else (1.5 * x - 0.25, 1.5),
    }  # fmt: skip
    rows = (10, 90, 200)
    return {k: forms[law](float(x[k])) for k in rows if law in forms}


def test_a_ramp_goes_on_from_the_speed_of_the_segment_before() -> None:
    law = [
        lw.LawSegment(law="ramp", over=0.1, by=10),
        lw.LawSegment(law="constant", over=0.2, by=40),
        lw.LawSegment(law="ramp", over="100 ms", by=10),
        lw.LawSegment(law="dwell", over=0.1),
    ]
    motion = _driven(law).sweep()
    speed = np.radians(200.0)
    t = motion["t"]
    expected = np.interp(t, [0.0, 0.1, 0.3, 0.4, 0.5], [0.0, speed, speed, 0.0, 0.0])
    assert motion.certified.all()
    assert motion["crank.velocity"] == pytest.approx(expected, abs=1e-12)
    # the input rests, and with it everything else
    assert np.abs(motion["rocker.velocity"][t > 0.4]).max() == pytest.approx(0.0, abs=1e-12)


def test_positions_and_rates_are_those_of_the_input_at_its_value_and_rate() -> None:
    motion = _driven("50 + 40*sin(360*t) - 8*t^2", to=1, step=0.05).sweep()
    t = motion["t"]
    angle = 50.0 + 40.0 * np.sin(2 * np.pi * t) - 8 * t**2
    rate = np.radians(40.0 * 2 * np.pi * np.cos(2 * np.pi * t) - 16 * t)
    bend = np.radians(-40.0 * (2 * np.pi) ** 2 * np.sin(2 * np.pi * t) - 16)
    assert motion["crank"] == pytest.approx(angle, abs=1e-11)
    assert motion["crank.acceleration"] == pytest.approx(bend, abs=1e-10)
    plain = lw.example("four-bar")
    for k in (0, 7, 13):
        here = plain.solve(at=float(angle[k]))
        # the same equations, solved twice to rounding
        assert motion["rocker"][k] == pytest.approx(here["rocker"], abs=1e-11)
        first, second = here["B.x.d1"], here["B.x.d2"]
        assert motion["B.x.velocity"][k] == pytest.approx(first * rate[k], rel=1e-11)
        exact = second * rate[k] ** 2 + first * bend[k]
        assert motion["B.x.acceleration"][k] == pytest.approx(exact, rel=1e-10)


def test_inputs_have_laws_of_their_own() -> None:
    robot = lw.example("five-bar-robot")
    left, right = robot.description.inputs
    bare: dict[str, Any] = {"from_": None, "to": None, "step": None}
    moved = robot.changed(
        inputs=[
            replace(left, **bare, law=(lw.LawSegment(law="3-4-5", over=1, by=-20),)),
            replace(
                right,
                **bare,
                law=(
                    lw.LawSegment(law="dwell", over=0.3),
                    lw.LawSegment(law="spline", times=(0.3, 0.7), values=(12, 20)),
                ),
            ),
        ],
        masses={"left": lw.Mass(mass=1, shape="rod"), "right": lw.Mass(mass=2, shape="rod")},
        gravity=lw.Gravity(),
    )
    motion = moved.sweep(limits_of=())
    assert motion.certified.all()
    right_at = np.interp(0.6, motion["t"], motion["right"])
    assert right_at - motion["right"][0] == pytest.approx(12.0, abs=1e-3)
    forces = moved.forces(motion=motion)
    assert forces.status.name == "FOUND"
    # rounding of a sum of a few terms
    assert np.max(forces["disagreement"]) < 1e-11
    balance = forces["power"] + forces["load_power"] - forces["energy_rate"]
    assert np.abs(balance).max() < 1e-12 * np.abs(forces["energy_rate"]).max()


_ARM = """\
format = 1
mass = "kg"
force = "N"
[points]
O = [0, 0]
A = [0, -1]
B = [-1, -2]
[links]
ground = ["O"]
upper = ["O", "A"]
lower = ["A", "B"]
[masses]
lower = {{ mass = 1, shape = "rod" }}
[[input]]
link = "upper"
law = "-90 + 10*t"
{first}
[[input]]
link = "lower"
law = [{{ law = "cycloidal", over = "0.8 s", by = 89 }}]
{second}
"""


@pytest.mark.parametrize(
    ("first", "second", "rows"),
    [
        ("from = 0\nto = 0.8\nstep = 0.01", "", 81),
        ("", "from = 0\nto = 0.8\nstep = 0.01", 81),
        ("to = 0.4", "step = 0.01", 41),
        ("step = 0.05", "step = 0.05", 17),  # a law of segments has an end
        ("", "", 361),
    ],
)
def test_inputs_with_laws_share_one_table_of_times(first: str, second: str, rows: int) -> None:
    arm = lw.loads(_ARM.format(first=first, second=second))
    motion = arm.sweep()
    assert len(motion) == rows
    assert motion.certified.all()
    t = motion["t"]
    # rounding of angles below a turn
    assert motion["upper"] == pytest.approx(-90.0 + 10.0 * t, abs=1e-12)
    x = t / 0.8
    turned = 89.0 * (x - np.sin(2.0 * np.pi * x) / (2.0 * np.pi))
    assert motion["lower"] - motion["lower"][0] == pytest.approx(turned, abs=1e-12)
    assert np.max(arm.forces(motion=motion)["disagreement"]) < 1e-12


def test_times_that_contradict_each_other_are_refused() -> None:
    with pytest.raises(lw.MechanismFileError, match="has other times than the first input"):
        lw.loads(_ARM.format(first="to = 0.4", second="to = 0.8"))


def test_a_length_with_a_law_and_a_held_length_need_no_range() -> None:
    text = lw.example_text("slider-input")
    head, _, rest = text.partition("[input]")
    tail = rest[rest.index("\n\n") :]
    variable = next(line for line in rest.splitlines() if line.startswith("variable"))
    moved = lw.loads(f'{head}[input]\n{variable}\nlaw = "150 - t"\nto = 1\nstep = 0.5{tail}')
    assert len(moved.sweep()) == 3
    held = lw.loads(f"{head}[input]\n{variable}\nfrom = 150\nto = 150{tail}")
    assert len(held.sweep()) == 1


def test_designs_driven_by_a_law_have_its_rates() -> None:
    bar = _driven([lw.LawSegment(law="cycloidal", over=0.5, by=60)], step=0.05)
    family = bar.family({"O2 A": [38.0, 40.0]}).sweep()
    # rounding of a Newton-Raphson step
    assert family["rocker.velocity"][1] == pytest.approx(bar.sweep()["rocker.velocity"], rel=1e-9)


def test_constant_speed_by_a_law_gives_the_forces_of_that_speed() -> None:
    press = lw.example("crank-press")
    law = (lw.LawSegment(law="constant", over=0.5, by=360),)
    timed = press.changed(inputs=lw.Input(link="crank", begin=90, law=law, step=0.05)).forces()
    plain = press.changed(
        inputs=lw.Input(link="crank", from_=90, to=450, step=36, speed=720.0)
    ).forces()
    for name in ("crank.effort", "A.force.x", "C.force.y", "power", "shaking.moment"):
        size = np.abs(plain[name]).max()
        assert timed[name] == pytest.approx(plain[name], abs=1e-11 * size)


def test_jerk_and_snap_of_a_slider_crank_are_those_of_its_closed_form() -> None:
    # in line: x = r cos φ + √(l² - r² sin²φ)
    r, rod = 3.0, 8.0
    engine = lw.linkage(
        points={"O": (0, 0), "A": (0, r), "B": (math.sqrt(rod**2 - r**2), 0), "T": (9, 0)},
        links={"ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "B"], "block": ["B"]},
        sliders=[lw.Slider(name="d", link="block", points=("B",), on="ground", line=("O", "T"))],
        inputs=lw.Input(link="crank", step=25, speed="10 rad/s"),
    )
    motion = engine.sweep()
    phi = np.radians(motion.inputs["crank"])
    for order, word in ((3, "jerk"), (4, "snap")):
        # Cauchy's integral on a circle: spectral, to rounding over its radius to the order
        expected = 10.0**order * _derivative(phi, r, rod, order)
        for name in ("d", "B.x"):
            difference = np.abs(motion[f"{name}.{word}"] - expected).max()
            assert difference < 1e-9 * np.abs(expected).max()


def _derivative(phi: Array, r: float, rod: float, order: int) -> Array:
    count, radius = 64, 0.3
    turn = np.exp(2j * np.pi * np.arange(count) / count)
    z = phi[:, None] + radius * turn
    x = r * np.cos(z) + np.sqrt(rod**2 - (r * np.sin(z)) ** 2)
    found: Array = (x * turn**-order).mean(axis=1).real * math.factorial(order) / radius**order
    return found


def test_a_law_that_leaves_the_reach_says_when_and_where() -> None:
    law = (lw.LawSegment(law="constant", over=1, by=40),)
    driven = lw.Input(link="rocker", begin=100, law=law)
    motion = lw.example("four-bar").changed(inputs=driven).sweep()
    (limit,) = motion.limits
    assert limit.kind.name == "DEAD_POINT"
    # the rocker turns at 40 degrees a second from 100 degrees to its dead point
    limits = lw.example("four-bar").sweep(limits_of="rocker").output_limits
    top = max(extreme.value for extreme in limits)
    assert limit.input == pytest.approx((top - 100.0) / 40.0, abs=1e-9)
    assert "dead point at t = " in motion.message
    assert f"rocker = {top:.7f}"[:18] in motion.message
    assert not motion.found[motion["t"] > limit.input].any()


def test_nothing_is_proved_past_a_corner_of_a_law() -> None:
    corner = [lw.LawSegment(law="table", times=(0.1, 0.2), values=(20, 30))]
    motion = _driven(corner).sweep()
    assert motion.found.all()
    assert {row.name for row in motion.certification} == {"MOTION_NOT_PROVED"}
    smooth = [lw.LawSegment(law="table", times=(0.1, 0.2), values=(20, 40))]
    assert _driven(smooth).sweep().certified.all()


_FILE = """
format = 1
[points]
A = [0, 0]
B = [40, 0]
C = [150, 60]
D = [120, 0]
[links]
ground = ["A", "D"]
crank = ["A", "B"]
coupler = ["B", "C"]
rocker = ["C", "D"]
[input]
link = "crank"
"""


@pytest.mark.parametrize(
    ("lines", "where", "message"),
    [
        ('law = [{ law = "3-4-5", over = "1 s", by = 9 }]\nspeed = "9 rpm"', "input.speed",
         "contradicts the law, which gives the speed: leave one out"),
        ('law = [{ law = "3-4-5", by = 9 }]', "input.law[0].over", "is missing: the duration"),
        ('law = [{ law = "3-4-5", over = -1, by = 9 }]', "input.law[0].over",
         "must be a positive time, got -1"),
        ('law = [{ law = "dwell", over = 1, by = 9 }]', "input.law[0].by",
         "must be 0: a dwell does not move"),
        ('law = [{ law = "dwell", over = "1 parsec" }]', "input.law[0].over", "parsec"),
        ('law = "90*x"\nto = 1', "input.law", '"x" is not defined: a law is a formula of t'),
        ('law = "90*t"', "input.to", "is missing: the last time [s]"),
        ('law = "90*(t > 0.5)"\nto = 1', "input.law", "jumps at t = 0.5"),
        ('law = "ln(t)"\nto = 1', "input.law", "has no finite value or rate at t = 0 s"),
        ('law = [{ law = "dwell", over = 1 }]\nto = 2', "input",
         "goes on to 2 s, but a law ends at 1 s"),
        ('law = [{ law = "table", times = [0.2, 0.1], values = [1, 2] }]', "input.law[0].times[1]",
         "must increase from 0"),
    ],
)  # fmt: skip
def test_a_wrong_law_is_refused_with_its_line(lines: str, where: str, message: str) -> None:
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(_FILE + lines)
    first = caught.value.problems[0]
    assert message in first.message
    key = "".join(f"[{k}]" if isinstance(k, int) else f".{k}" for k in first.key).lstrip(".")
    assert key == where
    assert (first.line or 0) >= 13


def test_a_law_is_saved_as_it_was_read() -> None:
    law = 'law = [{ law = "ramp", over = "0.5 s", by = 9 }, { law = "dwell", over = 1 }]\nbegin = 3'
    machine = lw.loads(_FILE + law)
    assert lw.loads(write_text(machine.description)).description == machine.description
