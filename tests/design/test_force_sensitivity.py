"""Sensitivities of forces equal differences of whole computations, with friction too."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.core.mechanism.linkage import Linkage
from tests.design.extrapolated import changed_by, extrapolated

MACHINE = """
format = 1
name = "Loaded slider-crank"
length = "mm"
[dimensions]
m2 = 0.8
mu = 0.1
[points]
O = [0, 0]
A = [20, 34.6]
B = [126.8, -20]
S = [0, -20]
T = [160, -20]
[links]
ground = ["O", "S", "T"]
crank = ["O", "A"]
rod = ["A", "B"]
block = ["B"]
[lengths]
"O A" = 40
"A B" = 120
[[sliders]]
name = "d"
link = "block"
points = ["B"]
on = "ground"
line = ["S", "T"]
[masses]
crank = { mass = 1.0, center = [15, 0], inertia = 300 }
rod = { mass = "m2", center = [50, 3], inertia = 900 }
block = { mass = 0.5 }
[gravity]
[[loads]]
point = "B"
force = ["-100 - 0.2*d", 0]
[[springs]]
name = "return"
between = ["T", "B"]
stiffness = 2
free = 20
damping = 0.01
[input]
link = "crank"
from = 0
to = 360
step = 10
speed = "300 rpm"
"""
FRICTION = """
[friction]
A = { mu = "mu", radius = 5 }
B = { mu = 0.2, radius = 4 }
d = { mu = 0.15 }
"""
FORCES = [
    "crank.effort", "O.force.x", "A.force.x", "B.force.y", "d.normal", "d.moment", "shaking.y",
    "return.tension", "power", "kinetic_energy", "stored_energy", "energy_rate", "load_power",
]  # fmt: skip


#: At rest, where friction holds a range of efforts.
STILL = (MACHINE + FRICTION).replace('speed = "300 rpm"\n', "").replace("damping = 0.01", "")
# a crank at a point that the file does not name, and a block on an inclined line
HIDDEN = """
format = 1
length = "mm"
[dimensions]
a = 40
b = 120
"α" = 25
[loops]
main = "a*e^(i*θ2) + b*e^(i*θ3) = d*e^(i*α)"
[guess]
"θ2" = 60
"θ3" = 10
d = 130
[input]
variable = "θ2"
[points]
O = "0"
B = "d*e^(i*α)"
[links]
ground = ["O"]
block = ["B"]
[[loads]]
point = "B"
force = [1, 2]
"""
RUBBING = ["A.friction", "efficiency", "friction_power"]
HELD = ["crank.effort", "crank.effort.backward", "efficiency", "A.friction", "d.normal"]


@pytest.mark.parametrize(
    ("text", "names_of"),
    [(MACHINE, FORCES), (MACHINE + FRICTION, FORCES + RUBBING), (STILL, HELD)],
    ids=["smooth", "rubbing", "held"],
)
def test_forces_have_the_derivatives_of_differences(text: str, names_of: list[str]) -> None:
    machine = lw.loads(text)
    names = ["O A", "A B", "m2", "T.y", *(["mu"] if text != MACHINE else [])]
    found = {of: lw.design.sensitivity(machine, of, at=50, by=names) for of in names_of}
    assert {s.status.name for s in found.values()} == {"FOUND"}
    for name in names:
        at = next(iter(found.values())).numbers[name]

        def forces(x: float, name: str = name) -> dict[str, float]:
            reactions = changed_by(machine, name, x).forces(at=50)
            return {of: float(reactions[of]) for of in names_of}

        other, here = extrapolated(forces, at, 4e-3 * abs(at)), forces(at)
        for of, slope in other.items():
            # differences of numbers of this size over steps of a thousandth
            assert found[of][name] == pytest.approx(
                slope, rel=1e-9, abs=1e-10 * (abs(here[of]) + 1.0) / abs(at)
            )


def test_efforts_of_several_inputs_have_the_derivatives_of_differences() -> None:
    robot = lw.example("five-bar-robot")
    given = cast(Linkage, robot.description)
    masses = {k: lw.Mass(mass=1.0, shape="rod") for k in given.links if k != "ground"}
    loaded = robot.changed(masses=masses, gravity=lw.Gravity())
    start, length = loaded.solve().input, next(iter(given.lengths))
    for name in start:
        of = f"{name}.effort"
        found = lw.design.sensitivity(loaded, of, at=start, by=[length])
        at = found.numbers[length]

        def effort(x: float, of: str = of) -> dict[str, float]:
            return {of: float(changed_by(loaded, length, x).forces(start)[of])}

        assert found[length] == pytest.approx(extrapolated(effort, at, 1e-3 * at)[of], rel=1e-8)


def test_rows_of_a_table_have_the_sensitivities_of_positions() -> None:
    machine = lw.loads(MACHINE)
    rows = np.asarray(lw.design.gradient(machine, "crank.effort", by=["A B"])["A B"])
    assert rows[5] == pytest.approx(
        lw.design.sensitivity(machine, "crank.effort", at=50)["A B"], rel=1e-10
    )


def test_forces_without_known_derivatives_are_refused_with_their_reason() -> None:
    machine = lw.loads(MACHINE)
    with pytest.raises(InputError, match=r'of "disagreement" are not known: it measures rounding'):
        lw.design.sensitivity(machine, "disagreement", at=50)
    law = (lw.LawSegment(law="3-4-5", over=1.0, by=90.0),)
    timed = machine.changed(inputs=[lw.Input(link="crank", law=law)])
    with pytest.raises(InputError, match="time drives the rows; give the input a speed"):
        lw.design.sensitivity(timed, "crank.effort", at=0.5)
    robot = lw.example("five-bar-robot")
    given = cast(Linkage, robot.description)
    masses = {k: lw.Mass(mass=1.0, shape="rod") for k in given.links if k != "ground"}
    rubbing = robot.changed(
        masses=masses, gravity=lw.Gravity(), friction={"E1": lw.Friction(mu=0.1, radius=1)}
    )
    start = rubbing.solve().input
    with pytest.raises(InputError, match="friction depends on the rates of several inputs"):
        lw.design.sensitivity(rubbing, f"{next(iter(start))}.effort", at=start)
    loops = lw.example("rapier-drive").changed(masses={"rod": lw.Mass(mass=1.0, shape="rod")})
    assert np.isfinite(float(lw.design.sensitivity(loops, "θ12.effort", at=60)["a2"]))
    hidden = lw.loads(HIDDEN)
    assert np.isfinite(float(hidden.forces(at=60)["B.force.x"]))
    with pytest.raises(InputError, match="a pin P1 that is no point of the file: add it to"):
        lw.design.sensitivity(hidden, "B.force.x", at=60)


def test_reactions_of_loops_have_the_derivatives_of_those_of_links() -> None:
    """The same rapier drive by loops and by links; its slider's line has no points in the loops."""
    given: dict[str, Any] = {
        "masses": {
            "crank": lw.Mass(mass=1, center=(3, 1), inertia=5),
            "rod": lw.Mass(mass=2, center=(30, 4), inertia=50),
        },
        "gravity": lw.Gravity(),
        "loads": [lw.Load(point="E", force=(-20, 5))],
    }
    loops = lw.example("rapier-drive").changed(**given)
    links = lw.example("rapier-drive-links").changed(**given)
    numbers = ["a1", "a2", "a3", "a4", "a5", "b4", "d1"]
    pins = (f"{pin}.force.{axis}" for pin in ("A0", "A", "B", "C", "C0", "D") for axis in "xy")
    for name in pins:
        found, wanted = (
            lw.design.sensitivity(each, name, at=50, by=numbers) for each in (loops, links)
        )
        size = max(abs(float(wanted[number])) for number in numbers)
        for number in numbers:
            assert float(found[number]) == pytest.approx(
                float(wanted[number]), rel=0, abs=1e-10 * size
            )


def test_a_machine_without_loads_has_no_forces_to_differentiate() -> None:
    with pytest.raises(InputError, match=r'there is no "crank\.effort"'):
        lw.design.sensitivity(lw.example("slider-crank"), "crank.effort", at=60)
