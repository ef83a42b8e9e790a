"""Linear couplings against closed forms: cylinders, links, a drum; and everywhere they appear."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.live.palette import PALETTE
from linkwork.core.textfile.writer import TextEdits
from linkwork.design.edits.unit_change import change_units

JACKS = """\
format = 1
name = "Master and slave cylinder"
[points]
O = [0, 0]
A = [0, 60]
P = [-80, 20]
Q = [200, 0]
B = [200, 80]
R = [300, 20]
[links]
ground = ["O", "P", "Q", "R"]
pedal = ["O", "A"]
arm = ["Q", "B"]
[[cylinders]]
name = "master"
between = ["P", "A"]
[[cylinders]]
name = "slave"
between = ["R", "B"]
[[couplings]]
name = "oil"
lengths = ["master", "slave"]
ratio = -0.5
offset = 160
[[loads]]
link = "arm"
torque = 1000
[input]
link = "pedal"
from = 70
to = 110
step = 10
"""

TRAIN = """\
format = 1
name = "Train"
[points]
O = [0, 0]
A = [10, 0]
P = [50, 0]
B = [60, 0]
[links]
ground = ["O", "P"]
first = ["O", "A"]
second = ["P", "B"]
[[couplings]]
name = "train"
links = ["first", "second"]
ratio = -2.5
offset = 30
[[loads]]
link = "second"
torque = 4
[input]
link = "first"
from = 0
to = 360
step = 30
"""

DRUM = """\
format = 1
name = "Drum"
[points]
O = [0, 0]
A = [0, 30]
S = [100, 0]
T = [100, 100]
B = [100, 40]
[links]
ground = ["O", "S", "T"]
drum = ["O", "A"]
cage = ["B"]
[[sliders]]
name = "height"
link = "cage"
points = ["B"]
on = "ground"
line = ["S", "T"]
[[couplings]]
name = "rope"
link = "drum"
length = "height"
radius = 30
offset = 10
[[loads]]
point = "B"
force = [0, -7]
[input]
link = "drum"
from = 0
to = 180
step = 45
"""


def test_cylinders_share_their_oil() -> None:
    motion = lw.loads(JACKS).sweep()
    assert motion.certified.all()
    theta = np.radians(motion.inputs["pedal"])
    master = np.abs(60 * np.exp(1j * theta) - (-80 + 20j))
    slave = 160 - 0.5 * master
    assert motion.series("slave").value == pytest.approx(slave, rel=1e-12)
    # the arm closes a triangle with its cylinder
    x, y = motion.points["B"]
    arm = x.value + 1j * y.value - (300 + 20j)
    assert np.abs(arm) == pytest.approx(slave, rel=1e-12)


def test_links_turn_in_their_ratio() -> None:
    motion = lw.loads(TRAIN).sweep()
    first = motion.inputs["first"]
    assert motion.series("second").value == pytest.approx(30 - 2.5 * first, abs=1e-9)
    assert motion.links["second"].first == pytest.approx(np.full(13, -2.5), rel=1e-12)


def test_a_drum_winds_up_its_rope() -> None:
    motion = lw.loads(DRUM).sweep()
    assert motion.series("height").value == pytest.approx(
        10 + 30 * np.radians(motion.inputs["drum"]), rel=1e-12
    )


def test_an_offset_is_sketched_unless_given() -> None:
    position = lw.loads(DRUM.replace("offset = 10\n", "")).solve(at=90)
    assert position["height"] == pytest.approx(40, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "at", "effort"),
    [
        # power of the load: torque times dθ2/dθ1 = -ratio of both, drum: force times radius
        (TRAIN, 60, 2.5 * 4),
        (DRUM, 60, 7 * 30.0),
    ],
)
def test_efforts_follow_from_the_ratio(text: str, at: float, effort: float) -> None:
    mechanism = lw.loads(text)
    forces = mechanism.forces(at=at)
    (effort_of_input,) = forces.efforts
    assert forces.values[effort_of_input] == pytest.approx(effort, rel=1e-12)
    assert forces.values["disagreement"] < 1e-12


def test_cylinders_carry_the_force_of_their_coupling() -> None:
    mechanism = lw.loads(JACKS)
    forces, position = mechanism.forces(at=90), mechanism.solve(at=90)
    # the torque of 1000 on the arm is held by the force of the slave cylinder at B
    b, q = complex(*position.points["B"]), 200
    along = (b - (300 + 20j)) / abs(b - (300 + 20j))
    push = -1000 / ((b - q).conjugate() * along).imag
    values = forces.values
    assert values["oil.force"] == pytest.approx(push, rel=1e-9)
    pin = math.hypot(values["P.force.x"], values["P.force.y"])
    assert pin == pytest.approx(0.5 * abs(push), rel=1e-9)
    assert values["disagreement"] < 1e-12


def test_configurations_are_complete() -> None:
    configurations = lw.loads(JACKS).configurations(at=90)
    assert len(configurations.positions) == 2
    assert configurations.completeness is lw.Completeness.PROVED


def test_the_mobility_counts_the_coupling() -> None:
    check = lw.loads(JACKS).check()
    assert (check.mobility_count, check.mobility_rank) == (1, 1)


def test_a_family_varies_the_offset() -> None:
    text = DRUM.replace("offset = 10", 'offset = "h"').replace(
        "[input]", "[dimensions]\nh = 10\n[input]"
    )
    offsets = np.array([8.0, 10.0])
    motion = lw.loads(text).family({"h": offsets}).sweep()
    turned = np.radians([0, 45, 90, 135, 180])
    assert motion.certified.all()
    assert motion["height"] == pytest.approx(offsets[:, None] + 30 * turned, rel=1e-12)


def test_units_convert_a_drum() -> None:
    edits = TextEdits(DRUM)
    change_units(edits, length="cm", convert=True)
    position = lw.loads(edits.text).solve(at=60)
    assert position["height"] == pytest.approx(1 + 3 * math.radians(60), rel=1e-12)


def test_a_picture_joins_the_coupled_parts(tmp_path: Path) -> None:
    lw.loads(JACKS).draw(tmp_path / "jacks.svg", at=90)
    assert "pitch:oil" in (tmp_path / "jacks.svg").read_text("utf-8")


def test_the_page_offers_couplings() -> None:
    (palette,) = [part for part in PALETTE if part.table == "couplings"]
    assert {field.name: field.entry for field in palette.fields}["lengths"] == "lengths"


@pytest.mark.parametrize(
    ("text", "old", "new", "message"),
    [
        (JACKS, "ratio = -0.5", "ratio = 0", "must not be zero"),
        (JACKS, "ratio = -0.5", "radius = 3", "does not fit two lengths or two links: give ratio"),
        (JACKS, "ratio = -0.5", "", "ratio *is missing"),
        (JACKS, '"slave"]\nratio', '"slav"]\nratio', '"slav" is not defined'),
        (JACKS, 'lengths = ["master", "slave"]', "", "needs either two lengths"),
        (DRUM, 'length = "height"\n', "", "needs either two lengths"),
        (TRAIN, '"second"]\nratio', '"ground"]\nratio', "from which angles are measured"),
    ],
)
def test_mistakes_are_named(text: str, old: str, new: str, message: str) -> None:
    assert text.count(old) == 1
    with pytest.raises(lw.MechanismError, match=message):
        lw.loads(text.replace(old, new))
