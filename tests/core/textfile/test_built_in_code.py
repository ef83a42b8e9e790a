"""What a file cannot say or the reader refuses is refused in code as well, as our own error."""

from __future__ import annotations

import math
from typing import Any

import pytest

from linkwork.core.foundation.errors import MechanismError, Problem
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.loops import Loops, PlainEquations
from linkwork.core.textfile import read_text
from tests.core.textfile.samples import SAMPLES


@pytest.mark.parametrize(("number", "shown"), [(True, "True"), (10**400, "inf"), (math.nan, "nan")])
def test_a_dimension_that_is_no_number_is_refused(number: float, shown: str) -> None:
    with pytest.raises(MechanismError) as caught:
        PlainEquations(equations={"f": "x = 1"}, guess={"x": 1}, dimensions={"a": number})
    message = f"must be a finite number, got {shown}"
    assert caught.value.problems == (Problem(key=("dimensions", "a"), message=message),)


def test_an_angle_unit_that_does_not_exist_is_refused() -> None:
    unit: Any = "grad"
    with pytest.raises(MechanismError) as caught:
        PlainEquations(equations={"f": "x = 1"}, guess={"x": 1}, angle=unit)
    assert caught.value.problems[0].message == 'must be "deg" or "rad", got "grad"'


def test_a_variable_is_not_measured_against_a_link() -> None:
    with pytest.raises(MechanismError) as caught:
        Loops(
            loops={"l": "cis(x) = 1"},
            guess={"x": 1},
            inputs=(Input(variable="x", relative_to="a"),),
        )
    message = 'must name only a variable of the equations: variable = "…"'
    assert caught.value.problems == (Problem(key=("input",), message=message),)


@pytest.mark.parametrize(
    ("angle", "speed", "per_second"),
    [
        ("deg", "300 rpm", 1800.0),
        ("rad", "300 rpm", 10.0 * math.pi),
        ("deg", "1 rad/s", 180.0 / math.pi),
        ("rad", "180 deg/s", math.pi),
        ("deg", "2*45deg/s", 90.0),
        ("deg", "45", 45.0),
    ],
)
def test_a_speed_is_counted_in_the_file_s_unit(angle: str, speed: str, per_second: float) -> None:
    text = SAMPLES["four_bar"].replace('"deg"', f'"{angle}"') + f'speed = "{speed}"\n'
    description = read_text(text.replace("to = 360", "to = 6")).description
    assert description.speed(description.inputs[0]) == pytest.approx(per_second, rel=1e-15)
