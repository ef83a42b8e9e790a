"""Files in another unit: every position is the same, or the numbers stay."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.core.textfile.reader import example_text
from linkwork.core.textfile.writer import TextEdits
from linkwork.design.edits.unit_change import change_units

#: Gears, racks, belts, cams of both kinds, loops, formulas, slots, several inputs, speeds.
TRIED = [
    "geared-five-bar", "rack-and-pinion", "belt-drive", "cam-roller-follower",
    "cam-swinging-follower", "rapier-drive", "crank-slider", "excavator", "geneva-drive",
    "oval-gears", "garage-door", "cardan-circles", "planetary-gear", "curved-slot",
    "scissor-lift", "eccentric-cam", "stephenson-valve-gear",
]  # fmt: skip
PER_INCH = {"mm": 25.4, "cm": 2.54, "m": 0.0254, "in": 1.0}
#: With dimensions that no number depends on, units of unknown size, formulas of loads, or equations
#: of plain numbers.
REFUSED = {
    "ackermann-steering", "compressor", "crank-press", "door-closer", "klann-leg", "toggle-latch",
    "newton-another-root", "newton-convergence", "newton-extremum", "three-rpr", "trotbot-leg",
}  # fmt: skip


def changed(text: str, *, length: str = "", angle: str = "", convert: bool = True) -> str:
    edits = TextEdits(text)
    change_units(edits, length=length, angle=angle, convert=convert)
    return edits.text


def positions(mechanism: lw.Mechanism) -> np.ndarray:
    """All points over the whole motion, (points, 2, rows)."""
    if not mechanism.description.inputs:
        return np.array(list(mechanism.solve().points.values()))
    motion = mechanism.sweep()
    return np.array([[motion[f"{p}.x"], motion[f"{p}.y"]] for p in motion.points])


def check_same_positions(name: str) -> None:
    text = example_text(name)
    before = lw.loads(text)
    scale = PER_INCH[before.description.length]
    other = "rad" if before.description.angle is lw.AngleUnit.DEGREE else "deg"
    after = lw.loads(changed(text, length="in", angle="" if name == "pumpjack" else other))
    assert after.description.length == "in"
    old, new = positions(before), positions(after)
    assert old.size
    np.testing.assert_allclose(new * scale, old, rtol=0, atol=1e-12 * np.nanmax(np.abs(old)))


@pytest.mark.parametrize("name", TRIED)
def test_a_converted_mechanism_has_the_same_positions(name: str) -> None:
    check_same_positions(name)


@pytest.mark.extended
@pytest.mark.parametrize("name", sorted(set(lw.examples()) - set(TRIED) - REFUSED))
def test_every_converted_mechanism_has_the_same_positions(name: str) -> None:
    if lw.example(name).description.length in PER_INCH and lw.example(name).solve().points:
        check_same_positions(name)


def test_rates_of_a_converted_mechanism_are_the_same() -> None:
    text = example_text("crank-slider")
    assert "rad/s" in text
    before, after = lw.loads(text), lw.loads(changed(text, length="in", angle="rad"))
    point = before.description.trace[0] if before.description.trace else "B"
    old, new = (m.sweep()[f"{point}.x.velocity"] for m in (before, after))
    np.testing.assert_allclose(new * PER_INCH[before.description.length], old, rtol=1e-9, atol=1e-6)


SLIDING = """
format = 1
length = "mm"
[dimensions]
half = 20
ratio = 0.5
[points]
A = [0, 0]
B = ["2*half", 0]
C = [10, 0]
[links]
ground = ["A", "B"]
block = ["C"]
[[sliders]]
name = "s"
link = "block"
points = ["C"]
on = "ground"
line = ["A", "B"]
offset = "ratio*(half + 5)"  # kept
[input]
slider = "s"
from = 10
to = 30
step = 5
speed = "50 mm/s"
[outputs]
back = "2*half - s"
share = "s/half"
square = "s^2 + 100"
"""


def test_numbers_in_formulas_are_converted_where_they_are_lengths() -> None:
    text = changed(SLIDING, length="cm")
    assert 'B = ["2*half", 0]' in text
    assert "half = 2" in text
    assert "ratio = 0.5" in text
    assert 'offset = "ratio*(half + 0.5)"  # kept' in text
    assert 'speed = "5 cm/s"' in text
    assert 'square = "s^2 + 1"' in text
    old, new = lw.loads(SLIDING).sweep(), lw.loads(text).sweep()
    np.testing.assert_allclose(new["back"] * 10, old["back"])
    np.testing.assert_allclose(new["share"], old["share"])
    np.testing.assert_allclose(new["square"] * 100, old["square"])
    np.testing.assert_allclose(new["C.x.velocity"] * 10, old["C.x.velocity"])


def test_other_names_of_units_leave_the_numbers() -> None:
    text = changed(SLIDING, length="in", convert=False)
    assert text == SLIDING.replace('"mm"', '"in"').replace("mm/s", "in/s")
    text = changed(example_text("four-bar"), angle="rad", convert=False)
    assert text == example_text("four-bar").replace('"deg"', '"rad"')


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("ratio = 0.5", "ratio = 0.5\nn = 3", '"n" may be a length, an angle or a plain number'),
        ('"s/half"', '"s + s^2"', "mixes lengths, angles and plain numbers"),
        ('length = "mm"', 'length = "stride"', '"stride" cannot be converted to "in"'),
    ],
)
def test_what_cannot_be_converted_is_named(old: str, new: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        changed(SLIDING.replace('"50 mm/s"', "50").replace(old, new), length="in")
    assert message in str(caught.value)


def test_an_output_that_holds_for_one_unit_of_angles_is_refused() -> None:
    with pytest.raises(InputError, match=r"outputs\.rod multiplies or divides by angles"):
        changed(example_text("pumpjack"), angle="rad")


def test_a_file_in_inches_and_back_is_the_same() -> None:
    text = example_text("four-bar")
    back = changed(changed(text, length="in", angle="rad"), length="mm", angle="deg")
    assert lw.loads(back).description == lw.loads(text).description


def test_masses_and_loads_are_converted_with_the_lengths() -> None:
    lamp = example_text("balanced-lamp") + "[masses]\narm = { mass = 2, center = [100, 5] }\n"
    before, after = (lw.loads(t).forces(at=20) for t in (lamp, changed(lamp, length="in")))
    assert after["O.force.x"] == pytest.approx(before["O.force.x"], rel=1e-12)
    moment = "shaking.moment"
    assert after[moment] * 25.4 == pytest.approx(before[moment], rel=1e-12)
    with pytest.raises(InputError, match="formula of a load"):
        changed(example_text("crank-press"), length="in")
