"""Values of wrong types, and numbers beyond all floats, in every kind of call."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork import families as batch
from linkwork.core.drawing.pose import Pose
from linkwork.core.motion.iterating import moving_loops, pulled_guess
from linkwork.families.study import summary_of
from tests.core.failures.test_words_that_help import BAR as PARTS

BAR = lw.example("four-bar")
PRESS = lw.example("crank-press")


@pytest.mark.parametrize(
    ("ask", "told"),
    [
        (
            lambda: lw.Gear(name="g", wheels=True, centers=("A", "B")),  # type: ignore[arg-type]
            "wheels of lw.Gear must be a list of 2 texts, got True",
        ),
        (
            lambda: lw.Gear(name="g", wheels=("a", 3), centers=("A", "B")),  # type: ignore[arg-type]
            "wheels of lw.Gear must be a list of 2 texts, got ('a', 3)",
        ),
        (lambda: lw.Segment(law=3, over=1), "law of lw.Segment must be a text, got 3"),  # type: ignore[arg-type]
        (lambda: lw.Input(link=3), "link of lw.Input must be a text, got 3"),  # type: ignore[arg-type]
        (
            lambda: lw.forces.Force(at="A", x="1", y=2),  # type: ignore[arg-type]
            "x of lw.Force must be a number, got '1'",
        ),
        (
            lambda: lw.NewtonOptions(max_steps=2.5),  # type: ignore[arg-type]
            "max_steps of lw.NewtonOptions must be a whole number, got 2.5",
        ),
        (lambda: BAR.driven_by(x=3), 'there is no field "x" (fields: '),
        (lambda: BAR.changed(joint=3), 'there is no field "joint" (fields: '),
        (lambda: moving_loops(BAR.model, {}), "the cycle must be a Motion, got {}"),  # type: ignore[arg-type]
        (lambda: PRESS.forces(motion="a"), "the motion must be a Motion, got 'a'"),  # type: ignore[arg-type]
        (
            lambda: PRESS.forces(motion=BAR.sweep()),
            'the motion belongs to "Four-bar linkage, open", not to "Crank press with forces"',
        ),
        (lambda: batch.from_table("\0"), "'\\x00' cannot be read: embedded null"),
        (lambda: batch.from_table({"A": 1}, 1.5), "the columns must be a list of names, got 1.5"),  # type: ignore[arg-type]
        (lambda: summary_of("x" * 5000), "cannot be read: File name too long"),
        (lambda: batch.designs_of("A", {}), "the mechanism of a family must be a Model, got 'A'"),
        (lambda: BAR.iterates(1.5), "a guess is given by name, as "),  # type: ignore[arg-type]
        (lambda: BAR.inversion(slice(3)), "a name must be a text, got slice(None, 3, None)"),  # type: ignore[arg-type]
        (lambda: BAR.sweep(step=90).place("Z"), 'there is no point "Z" (points: '),
        (lambda: BAR.sweep(step=90).quantity([1]), "a name must be a text, got [1]"),  # type: ignore[arg-type]
        (lambda: BAR.scene(60, traces=3), "traces must be a list of names, got 3"),  # type: ignore[arg-type]
        (
            lambda: pulled_guess(BAR.model, "A", "no"),  # type: ignore[arg-type]
            "the coordinates of A must be two finite numbers",
        ),
        (lambda: BAR.circuits(certify=[]), "certify must be True or False, got []"),  # type: ignore[arg-type]
        (lambda: BAR.solve(throw="no"), "throw must be True or False, got 'no'"),  # type: ignore[arg-type]
        (lambda: BAR.sweep(progress=3), "progress must be a function of the fraction, got 3"),  # type: ignore[arg-type]
        (lambda: BAR.sweep(options=3), "options must be a NewtonOptions, got 3"),  # type: ignore[arg-type]
        (lambda: lw.load("x" * 5000), "cannot be read: File name too long"),
        (lambda: lw.linkage(**PARTS | {"inputs": np.array(1.0)}), "inputs must be a list, got 1.0"),
    ],
)
def test_a_wrong_type_is_refused_with_what_it_should_be(
    ask: Callable[[], object], told: str
) -> None:
    with pytest.raises(lw.InputError) as refused:
        ask()
    assert told in str(refused.value)


def test_a_table_of_one_design_may_be_bare_numbers() -> None:
    assert batch.from_table({"A": 1}).count == 1


def changed(example: str, old: str, new: str) -> str:
    text = lw.example_text(example)
    assert old in text
    return text.replace(old, new, 1)


HUGE_CAM = re.sub(
    r"(?s)profile *= *\[.*?\],?\s*\]",
    "profile = [[1e200, 0], [0, 1e200], [-1e200, 0], [0, -1e200]]",
    lw.example_text("eccentric-cam"),
)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            changed("rapier-drive", '"-d1 - i*a1"', '"1e308*10"'),
            "column 6: a coefficient here is not a finite number",
        ),
        (
            changed("scotch-yoke", "V = [34.641, 50]", "V = [34.641, 0.0]"),
            "C and V are sketched at the same place: draw them apart",
        ),
        (HUGE_CAM, "is too far from the origin: at most 1e+100"),
    ],
)
def test_numbers_beyond_all_floats_are_refused(text: str, told: str) -> None:
    with pytest.raises(lw.InputError) as refused:
        lw.loads(text).solve()
    assert told in str(refused.value)


def test_the_smallest_of_all_numbers_has_a_direction() -> None:
    text = changed("scissor-three-bars", "O = [0, 0]", "O = [0, 5e-324]")
    assert lw.loads(text).solve().status.ok


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("newton-extremum", "x = 1", "x = 1e155"),
        ("newton-extremum", '"x^3 - 3*x + 3 = 0"', '"x^20 - 1e308*x = 0"'),
        ("andrews-squeezer", "u  = 0.04", "u  = 0.0"),
    ],
)
def test_overflow_and_singular_matrices_are_no_warnings(name: str, old: str, new: str) -> None:
    position: Any = lw.loads(changed(name, old, new)).solve()
    assert position.message or position.status.ok


def test_rates_beyond_all_floats_at_a_dead_point_are_no_warnings() -> None:
    text = """\
format = 1
[equations]
F = "x^3 - 3*x + t = 0"
[guess]
x = 2
t = 5e-324
[input]
variable = "t"
from = -1
to = 1
step = 0.5
"""
    assert lw.loads(text).sweep().found.all()


def test_forces_at_a_speed_beyond_all_accelerations_have_a_status() -> None:
    fast = changed("crank-press", 'speed = "120 rpm"', "speed = 1e308")
    found = lw.loads(fast).forces(at=30)
    assert found.status is not lw.forces.ForceStatus.FOUND


def test_a_load_is_no_complex_number() -> None:
    text = changed("crank-press", '[0, "20000', '["cis(30)", "20000')
    with pytest.raises(
        lw.MechanismError, match=r"column 1: cis is complex, a load is a real number"
    ):
        lw.loads(text)


def test_a_jacobian_too_small_to_invert_is_no_warning() -> None:
    product = "*".join(["sin(x)"] * 30)
    found = lw.loads(f'format = 1\n[equations]\nF = "{product} = 0"\n[guess]\nx = 1e-9\n').solve()
    assert np.isinf(found.condition)


def test_a_link_whose_direction_is_below_all_floats_is_drawn() -> None:
    skeleton = BAR.model.skeleton
    places = {"O2": 0j, "A": 30 + 5e-324j, "B": 90 + 40j, "O4": 100 + 0j}
    assert Pose.still(skeleton, places).angles["crank"] == 0.0
