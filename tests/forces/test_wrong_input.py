"""Wrong masses, loads, springs, stops, motors and tolerances: messages with line and key."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import key_text

BAR = """format = 1
length = "mm"
[points]
A = [0, 0]
B = [0, 40]
C = [110, 80]
D = [100, 0]
[links]
ground = ["A", "D"]
crank = ["A", "B"]
coupler = ["B", "C"]
rocker = ["D", "C"]
[lengths]
"A B" = 40
"B C" = 120
"D C" = 80
[masses]
rocker = { mass = 1, shape = "rod" }
"""
INPUT = '[input]\nlink = "crank"\nfrom = 90\nto = 180\nstep = 30\n'


def _told(text: str, driven: str = INPUT) -> list[str]:
    """The messages below the bar, each with its line counted from the end of BAR."""
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(BAR + text + "\n" + driven, "bar.toml")
    first = BAR.count("\n")
    return [
        f"{(problem.line or 0) - first} {key_text(problem.key)} "
        # without the formula and its caret
        + problem.message.partition("\n")[0]
        for problem in caught.value.problems
    ]


@pytest.mark.parametrize(
    ("load", "message"),
    [
        ('link = "ground"\ntorque = 1',
         "2 loads[1].link is fixed: the torque has no effect, remove it"),
        ('point = "A"\nforce = [1, 0]',
         "2 loads[1].point A is fixed: the force has no effect, remove it"),
        (
            'point = "C"\nforce = [1, 0]\nwith = "ground"',
            "4 loads[1].with does not turn: leave it out, as the axes of ground are the default",
        ),
        (
            'point = "C"\nforce = ["1/0", 0]',
            "3 loads[1].force[1] column 2: division by zero",
        ),
        (
            'point = "C"\nforce = [0, "t*sqrt(2 - 3)"]',
            "3 loads[1].force[2] column 3: sqrt(-1) is not a real number",
        ),
        ('link = "rocker"\ntorque = "10^10^10"',
         "3 loads[1].torque the value is too large"),
        ('link = "rocker"\ntorque = 1e308',
         "3 loads[1].torque 1e+308 is too large: at most 1e+100"),
        ('link = "rocker"\ntorque = "-1e308*t"',
         "3 loads[1].torque -1e+308 is too large: at most 1e+100"),
        (
            'link = "rocker"\ntorque = "rocker.acceleration"',
            '3 loads[1].torque column 1: "rocker.acceleration" follows from accelerations, which '
            "follow from the loads: a load has positions, velocities and t",
        ),
        (
            'link = "rocker"\ntorque = "1 N*m"',
            "3 loads[1].torque column 3: numbers carry no unit here: write 1 and set "
            'force = "N" for the whole file; a product is written "1*N"'
        ),
    ],
)  # fmt: skip
def test_a_load_without_a_value_or_an_effect_is_refused(load: str, message: str) -> None:
    """With file, line and key."""
    assert _told(f"[[loads]]\n{load}") == [message]


SPRING = '[[springs]]\nname = "s"\n'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            SPRING + 'between = ["A", "C"]\nstiffness = "2 N/mm"',
            "4 springs[1].stiffness column 3: numbers carry no unit here: write 2 and set "
            'force = "N" for the whole file; a product is written "2*N"'
        ),
        (
            SPRING + 'between = ["A", "B"]\nstiffness = 2',
            '3 springs[1].between has both ends on "crank", where it does nothing: connect two '
            "links",
        ),
        (
            SPRING + 'between = ["A", "C"]\ndamping = 1e200',
            "4 springs[1].damping 1e+200 is too large: at most 1e+100",
        ),
        (
            '[gravity]\nsize = "1e200 m/s^2"',
            "2 gravity.size 1e+203 is too large: at most 1e+100",
        ),
        (
            "[masses.crank]\nmass = 1e300\ncenter = [0, 0]",
            "2 masses.crank.mass 1e+300 is too large: at most 1e+100",
        ),
        (
            "[friction]\nA = { mu = 1e300, radius = 5 }",
            "2 friction.A.mu 1e+300 is too large: at most 1e+100",
        ),
        (
            '[[stops]]\nof = "nix"\nfrom = 40',
            '2 stops[1].of there is no "nix" (nearest: condition, D.x, C.x; all: linkwork '
            "quantities FILE)",
        ),
        (
            '[[stops]]\nof = "crank.effort"\nfrom = 40',
            '2 stops[1].of there is no "crank.effort" (nearest: crank, rocker, coupler; all: '
            "linkwork quantities FILE)",
        ),
        (
            '[[stops]]\nof = "rocker.velocity"\nto = 3',
            '2 stops[1].of "rocker.velocity" cannot be stopped: name a quantity of positions, '
            "such as a link or B.x",
        ),
        (
            '[[stops]]\nof = "condition"\nto = 3',
            '2 stops[1].of "condition" cannot be stopped: name a quantity of positions, such as '
            "a link or B.x",
        ),
        (
            '[tolerances]\n"B A" = { deviation = 40 }',
            '2 tolerances."B A".deviation must be smaller than the length itself, 40, got 40',
        ),
        (
            "[tolerances]\n\"D.x\" = { deviation = 200 }",
            '2 tolerances."D.x".deviation must be smaller than the largest length, 136.015, '
            "got 200",
        ),
        (
            "[clearances]\nB = 1e9",
            "2 clearances.B must be smaller than the largest length, 136.015, got 1e+09",
        ),
    ],
)  # fmt: skip
def test_what_has_no_effect_or_no_sense_is_refused(text: str, message: str) -> None:
    """With file, line and key."""
    assert _told(text) == [message]


@pytest.mark.parametrize(
    ("motor", "messages"),
    [
        (
            'speeds = ["0 rpm", "900 rpm", "500 rpm"]\ntorques = [12, 5, 3]',
            ["2 input.motor.speeds[3] must rise: 500 rpm is not above the speed before it"],
        ),
        (
            'speeds = ["0 rpm", "500 rpm", "500 rpm"]\ntorques = [12, 5, 3]',
            ["2 input.motor.speeds[3] must rise: 500 rpm is not above the speed before it"],
        ),
        ('speeds = ["0 rpm"]\ntorques = [12]',
         ["2 input.motor.speeds needs at least two speeds, got 1",
          "3 input.motor.torques needs at least two torques, got 1"]),
        ('speeds = ["0 rpm", "5 kg"]\ntorques = ["1/0", 1]',
         ["2 input.motor.speeds[2] must be a number and a unit (rpm, rad/s, deg/s), got \"5 kg\"",
          "3 input.motor.torques[1] column 2: division by zero"]),
        ('speeds = ["0 rpm", "5 rpm"]\ntorques = [nan, 1]',
         ["3 input.motor.torques[1] must be a finite number, got nan"]),
        ('speeds = ["0 rpm", "5 rpm"]\ntorques = [1]',
         ["3 input.motor.torques needs at least two torques, got 1"]),
        ('speeds = ["0 rpm", "5 rpm"]\ntorques = [1, 2]\nfree_speed = 3',
         ["4 input.motor.free_speed is used with stall only"]),
        ('stall = 1\nfree_speed = "0 rpm"', ["3 input.motor.free_speed must not be 0"]),
        ('stall = -12\nfree_speed = "1500 rpm"',
         ["3 input.motor.free_speed must have the sign of stall: the torque falls with the speed"]),
        ("stall = 1e200", ["2 input.motor.stall 1e+200 is too large: at most 1e+100"]),
    ],
)  # fmt: skip
def test_a_motor_is_refused_at_the_row_of_its_table(motor: str, messages: list[str]) -> None:
    """Not at the stall torque, which it does not have."""
    told = _told("", INPUT + "[input.motor]\n" + motor)
    lines = INPUT.count("\n") + 1
    found = [f"{int(each.split()[0]) - lines} {each.partition(' ')[2]}" for each in told]
    assert found == messages


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ('{ law = "3-4-5", over = 1 }',
         "input.law[1].by is missing: how far the input moves, as in by = 90"),
        ('{ law = "ramp", over = 1 }',
         "input.law[1].by is missing: how far the input moves, as in by = 90"),
        ('{ law = "constant", over = 1, by = "1/0" }',
         "input.law[1].by column 2: division by zero"),
        ('{ law = "table", times = [1, 1], values = [1, 2] }',
         "input.law[1].times[2] must increase from 0"),
    ],
)  # fmt: skip
def test_a_segment_of_a_law_says_how_far_it_moves(law: str, message: str) -> None:
    """A dwell alone has no displacement."""
    told = _told("", f'[input]\nlink = "crank"\nlaw = [{law}]\n')
    assert [each.partition(" ")[2] for each in told] == [message]


@pytest.mark.parametrize(
    ("formula", "time", "said"),
    [
        ("1/t", 0.0, "has no finite value there"),
        ("9/(t - 0.02)", 0.02, "grows without bound there"),
        ("sqrt(0.02 - t)", 0.02, "has no finite value there"),
    ],
)
@pytest.mark.filterwarnings("error")
def test_a_load_that_loses_its_value_ends_a_motion(formula: str, time: float, said: str) -> None:
    """It is named with time, file and line; positions after it are not found."""
    text = BAR + f'[[loads]]\nlink = "rocker"\ntorque = "{formula}"\n' + INPUT
    motion = lw.loads(text, "bar.toml").simulate(until=1, step=0.1)
    head, _, why = motion.message.partition(" s: ")
    assert why == f'bar.toml line 21, loads[1].torque "{formula}" {said}'
    assert float(head.removeprefix("the motion ends at t = ")) == pytest.approx(time, abs=1e-8)
    assert not motion.found[-1]


def test_so_it_does_with_several_inputs() -> None:
    """Both bars of a double pendulum are free."""
    arm = lw.example("double-pendulum").changed(
        loads=[lw.Load(link="upper", torque="sqrt(0.02 - t)")]
    )
    motion = arm.simulate(until=1, step=0.1)
    assert motion.message.endswith('loads[1].torque "sqrt(0.02 - t)" has no finite value there')


def test_a_load_without_a_value_has_a_status() -> None:
    """In the rows where it has none; the others have forces."""
    text = BAR + '[[loads]]\nlink = "rocker"\ntorque = "1/(crank - 90)"\n' + INPUT
    forces = lw.loads(text, "bar.toml").forces()
    assert [status.name for status in forces.statuses] == ["NO_LOAD", "FOUND", "FOUND", "FOUND"]
    assert np.isnan(forces["crank.effort"]).tolist() == [True, False, False, False]
    name = 'bar.toml line 21, loads[1].torque "1/(crank - 90)"'
    assert forces.undefined[name].tolist() == [True, False, False, False]


def test_a_load_with_a_gap_leaves_the_rest_of_the_motion_exact() -> None:
    """Elsewhere it is the same as without the gap: energy is kept to rounding."""
    load = '[[loads]]\nlink = "rocker"\ntorque = "{}"\n'
    smooth, gap = (
        lw.loads(BAR + load.format(formula) + INPUT).simulate(until=0.05, start_speed=100)
        for formula in ("5", "5 + 0*sqrt(rocker - 75)")
    )
    assert gap.found.all()
    assert gap["rocker"] == pytest.approx(smooth["rocker"], rel=1e-12)


ANGLE = """format = 1
length = "m"
[dimensions]
a = 0.04
b = 0.12
"α" = 0
[loops]
main = "a*e^(i*θ2) + b*e^(i*θ3) = d*e^(i*α)"
[guess]
"θ2" = 60
"θ3" = -17
d = 0.135
[input]
variable = "θ2"
[tolerances]
"""


def test_a_dimension_of_loops_may_be_an_angle() -> None:
    """Half a degree is more than every length in metres, and no mistake."""
    tilted = lw.loads(ANGLE + '"α" = { deviation = 0.5 }\n')
    assert lw.design.tolerance(tilted, "d", at=60).root_sum_square > 0.0
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(ANGLE + "a = { deviation = 1e9 }\n")
    assert [problem.message for problem in caught.value.problems] == [
        "must be smaller than all lengths and a full turn, got 1e+09"
    ]
