"""Reactions of single joints, by hand."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError, MechanismError
from linkwork.core.mechanism.linkage import Linkage
from linkwork.forces.results import ForceStatus
from tests.described import described_as

SLIDER_CRANK = {
    "points": {"O": (0, 0), "A": (3, 4), "B": (15, 0), "T": (10, 0)},
    "links": {"ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "B"], "block": ["B"]},
    "sliders": [lw.Slider(name="d", link="block", points=("B",), on="ground", line=("O", "T"))],
}


def test_a_rod_without_mass_carries_force_along_itself_only() -> None:
    crank = lw.linkage(
        **SLIDER_CRANK, inputs=lw.Input(link="crank"),
        loads=[lw.Load(point="B", link="block", force=(-100, 0))],
    )  # fmt: skip
    found = crank.forces(at=math.degrees(math.atan2(4, 3)))
    rod = complex(12, -4)
    push = complex(found["B.force.x"], found["B.force.y"])  # on the block
    assert push.real == pytest.approx(100)
    assert (push / rod).imag == pytest.approx(0, abs=1e-12)
    assert found["d.normal"] == pytest.approx(-push.imag)
    assert found["d.moment"] == pytest.approx(0, abs=1e-9)
    assert found["crank.effort"] == pytest.approx((complex(3, -4) * push).imag)
    assert found["shaking.x"] == pytest.approx(-100)


def test_bars_of_a_truss_carry_its_load() -> None:
    """A structure has no input: the bars are at 45 degrees under half the load each."""
    truss = lw.linkage(
        points={"A": (0, 0), "B": (10, 0), "C": (5, 5)},
        links={"ground": ["A", "B"], "left": ["A", "C"], "right": ["B", "C"]},
        loads=[lw.Load(point="C", force=(0, -10))],
    )
    found = truss.forces()
    for name, force in {"A": (5, 5), "B": (-5, 5)}.items():
        assert found[f"{name}.force.x"] == pytest.approx(force[0], abs=1e-14)
        assert found[f"{name}.force.y"] == pytest.approx(force[1], abs=1e-14)
    assert found.efforts == ()


TRUSS: dict[str, Any] = {
    "points": {"A": (0, 0), "B": (100, 0), "C": (40, 60), "E": (20, -10)},
    "links": {"ground": ["A", "B", "E"], "left": ["A", "C"], "right": ["B", "C"]},
    "loads": [lw.Load(point="C", force=(30, -100))],
}


def test_a_redundant_bar_leaves_the_forces_of_a_truss_undetermined() -> None:
    links = {**TRUSS["links"], "third": ["E", "C"]}
    found = lw.linkage(**{**TRUSS, "links": links}).forces()
    assert found.status is ForceStatus.UNDETERMINED
    assert np.isnan(found["A.force.x"])
    assert found["shaking.y"] == -100


def test_friction_at_rest_leaves_the_forces_of_a_truss_open() -> None:
    friction = {"C": lw.Friction(mu=0.3, radius=5)}
    found = lw.linkage(**TRUSS, friction=friction).forces()
    assert found.status is ForceStatus.HELD
    assert np.isnan(found["A.force.x"])


def test_a_load_in_time_needs_an_input() -> None:
    loads = [lw.Load(point="C", force=("30*t", -100))]
    truss = lw.linkage(**{**TRUSS, "loads": loads})
    assert truss.solve().status is lw.Status.CONVERGED
    with pytest.raises(MechanismError, match="the time t needs the speed of an input"):
        truss.forces()


def test_redundant_links_with_two_inputs_keep_their_reactions() -> None:
    """A bar of a parallelogram that two inputs move adds no equation."""
    cranks = lw.linkage(
        points={"A": (0, 0), "B": (0, 10), "C": (30, 0), "D": (30, 10), "E": (15, 0),
                "F": (15, 10), "G": (60, 40)},
        links={"ground": ["A", "C", "E"], "left": ["A", "B"], "right": ["C", "D"],
               "middle": ["E", "F"], "bar": ["B", "F", "D"], "arm": ["D", "G"]},
        inputs=[lw.Input(link="left", from_=90, to=100, step=5),
                lw.Input(link="arm", from_=40, to=40, step=0)],
        loads=[lw.Load(point="G", link="arm", force=(0, -5))],
    )  # fmt: skip
    found = cranks.forces(at={"left": 90, "arm": 40})
    assert found["shaking.y"] == -5


def test_a_block_pushed_beside_its_line_needs_a_moment() -> None:
    table = lw.linkage(
        points={"S": (0, 0), "T": (10, 0), "B": (3, 0), "C": (3, 2)},
        links={"ground": ["S", "T"], "block": ["B", "C"]},
        sliders=[lw.Slider(name="d", link="block", points=("B",), on="ground", line=("S", "T"))],
        inputs=lw.Input(slider="d", from_=0, to=5, step=1),
        loads=[lw.Load(point="C", force=(-7, -3))],
    )
    found = table.forces(at=2)
    assert found["d.effort"] == pytest.approx(7)
    assert found["d.normal"] == pytest.approx(3)
    assert found["d.moment"] == pytest.approx(-14)
    assert found.units["d.effort"] == "N"


def gears(*, internal: bool, torque: float) -> lw.forces.Reactions:
    """Two wheels about O and P; a torque on the second."""
    centre = 20 if internal else 60
    return lw.linkage(
        points={"O": (0, 0), "P": (centre, 0)},
        links={"ground": ["O", "P"], "first": ["O"], "second": ["P"]},
        gears=[
            lw.Gear(
                name="mesh", wheels=("first", "second"), centers=("O", "P"), radii=(20, 40),
                internal=internal, pressure_angle=25,
            )
        ],
        inputs=lw.Input(link="first"),
        loads=[lw.Load(link="second", torque=torque)],
    ).forces(at=30)  # fmt: skip


@pytest.mark.parametrize("torque", [-800.0, 800.0])
@pytest.mark.parametrize("internal", [False, True])
def test_teeth_push_apart_whichever_way_they_turn(internal: bool, torque: float) -> None:
    found = gears(internal=internal, torque=torque)
    size = 800.0 / 40.0
    assert abs(found["mesh.tangent"]) == pytest.approx(size)
    assert found["mesh.radial"] == pytest.approx(size * math.tan(math.radians(25)))
    # external wheels push each other away; a ring is pushed outwards from its pinion, at -x
    side = -1.0 if internal else 1.0
    assert found["P.force.x"] == pytest.approx(-side * found["mesh.radial"])
    assert found["O.force.x"] == pytest.approx(side * found["mesh.radial"])
    ratio = 0.5 if internal else -0.5
    assert found["first.effort"] == pytest.approx(-ratio * torque)


def test_a_gear_without_its_pressure_angle_has_twenty_degrees() -> None:
    found = loaded_pair("gears", lw.Gear, pretension=None)
    assert found["mesh.radial"] == pytest.approx(
        abs(float(found["mesh.tangent"])) * math.tan(math.radians(20))
    )


def loaded_pair(table: str, kind: type, pretension: float | None) -> lw.forces.Reactions:
    sizes = {"radii": (20, 40)}
    given = {} if pretension is None else {"pretension": pretension}
    part = kind(name="mesh", wheels=("first", "second"), centers=("O", "P"), **sizes, **given)
    distance = 60 if table == "gears" else 100
    return lw.linkage(
        points={"O": (0, 0), "P": (distance, 0)},
        links={"ground": ["O", "P"], "first": ["O"], "second": ["P"]},
        **{table: [part]},
        inputs=lw.Input(link="first"),
        loads=[lw.Load(link="second", torque=800)],
    ).forces(at=30)


def test_a_chain_has_a_slack_strand_and_a_belt_its_pretension() -> None:
    chain = loaded_pair("belts", lw.Belt, None)
    strands = sorted([chain["mesh.tension1"], chain["mesh.tension2"]])
    assert strands == pytest.approx([0, 20], abs=1e-12)
    belt = loaded_pair("belts", lw.Belt, 50)
    strands = sorted([belt["mesh.tension1"], belt["mesh.tension2"]])
    assert strands == pytest.approx([40, 60])
    # both strands pull the wheels together, at the angle of the tangents
    cosine = math.sqrt(1 - (20 / 100) ** 2)
    assert belt["P.force.x"] == pytest.approx(100 * cosine)
    assert not any(rows.any() for rows in belt.lifted.values())
    loose = loaded_pair("belts", lw.Belt, 5)
    assert [name for name, rows in loose.lifted.items() if rows.any()] in (
        ["mesh.tension1"], ["mesh.tension2"],
    )  # fmt: skip


def test_noncircular_teeth_are_inclined_with_the_pitch_curves() -> None:
    """Equal ellipses about their foci: r1 from the focus, the tangent from its slope."""
    mechanism = lw.example("elliptical-gears")
    gear = described_as(Linkage, mechanism).noncircular_gears[0]
    wheels = gear.wheels
    found = mechanism.changed(
        loads=[lw.Load(link=wheels[1], torque=100)]
    ).forces(at=70)  # fmt: skip
    name = gear.name
    position = mechanism.solve(at=70)
    first, second = (position.points[p] for p in gear.centers)
    distance = math.hypot(second[0] - first[0], second[1] - first[1])
    rate = position.first[wheels[1]]
    radius = -rate * distance / (1 - rate)
    assert abs(found[f"{name}.tangent"]) == pytest.approx(100 / (distance - radius))
    bend = position.second[wheels[1]]
    slope = math.atan2(-bend * distance / (1 - rate) ** 2, radius)
    side = math.copysign(1.0, found[f"{name}.tangent"])
    inclined = math.tan(math.radians(20) - side * slope)
    assert found[f"{name}.radial"] == pytest.approx(abs(float(found[f"{name}.tangent"])) * inclined)


def test_a_spring_pulls_and_its_damper_brakes() -> None:
    lever = lw.linkage(
        points={"O": (0, 0), "A": (30, 0), "K": (0, 40)},
        links={"ground": ["O", "K"], "lever": ["O", "A"]},
        springs=[
            lw.Spring(name="coil", between=("K", "A"), stiffness=2, free=40, damping=0.5),
            lw.Spring(name="hinge", links=("ground", "lever"), stiffness=50, free=-90),
        ],
        inputs=lw.Input(link="lever", speed="1 rad/s"),
    )
    found = lever.forces(at=0)
    along = complex(-30, 40) / 50
    rate = (complex(0, 30) * along.conjugate()).real * -1.0  # of the length, at 1 rad/s
    assert found["coil.tension"] == pytest.approx(2 * 10 + 0.5 * rate)
    assert found["hinge.torque"] == pytest.approx(50 * math.pi / 2)
    arm = 30 * along.imag * found["coil.tension"]
    assert found["lever.effort"] == pytest.approx(found["hinge.torque"] - arm)


def test_an_unloaded_spring_is_only_drawn() -> None:
    with pytest.raises(InputError, match="nothing loads"):
        lw.example("four-bar").forces()


def test_loads_are_formulas_of_time_rates_and_comparisons() -> None:
    lever = lw.linkage(
        points={"O": (0, 0), "A": (30, 0)},
        links={"ground": ["O"], "lever": ["O", "A"]},
        inputs=lw.Input(link="lever", from_=0, to=90, step=30, speed="60 deg/s"),
        loads=[lw.Load(link="lever", torque="-20*(t < 0.9) - 3*lever.velocity*(lever >= 45)")],
    )
    efforts = np.asarray(lever.forces()["lever.effort"])
    assert efforts == pytest.approx([20, 20, 3 * math.pi / 3, 3 * math.pi / 3])


def test_a_force_with_a_link_turns_along() -> None:
    lever = lw.linkage(
        points={"O": (0, 0), "A": (30, 0)},
        links={"ground": ["O"], "lever": ["O", "A"]},
        inputs=lw.Input(link="lever", step=45),
        loads=[lw.Load(point="A", force=(0, 2), turns_with="lever")],
    )
    assert np.asarray(lever.forces()["lever.effort"]) == pytest.approx([-60] * 9)


def test_three_links_at_a_pin_have_a_force_each_that_add_up_to_the_load() -> None:
    press = lw.example("toggle-press").changed(loads=[lw.Load(point="B", force=(5, -8))])
    found = press.forces(at=100)
    for axis, load in (("x", 5.0), ("y", -8.0)):
        links = ("rod", "upper_toggle", "lower_toggle")
        total = sum(found[f"B.force.{link}.{axis}"] for link in links)
        assert total == pytest.approx(load)


def test_forces_do_not_exist_at_a_dead_point() -> None:
    mechanism = lw.example("rapier-drive-limited-links")
    links = described_as(Linkage, mechanism).links
    body = next(link for link in links if link != "ground")
    point = links[body][-1]
    found = mechanism.changed(loads=[lw.Load(point=point, force=(1, 2))]).forces()
    counts = [status.name for status in found.statuses]
    assert counts.count("NO_RATES") == 2
    efforts = np.asarray(found[found.efforts[0]])
    assert np.isnan(efforts[[name != "FOUND" for name in counts]]).all()
    assert np.isfinite(efforts[[name == "FOUND" for name in counts]]).all()


def test_only_stressed_joints_are_undetermined() -> None:
    """Three parallel cranks: a fourth link on a joint of its own carries no self-stress."""
    cranks = lw.example("parallel-cranks")
    given = described_as(Linkage, cranks)
    links = {**given.links, "ground": [*given.links["ground"], "S", "T"], "hung": ["H", "I"]}
    coupler = next(
        link for link in links if link not in ("ground", "hung") and len(links[link]) > 2
    )
    links[coupler] = [*links[coupler], "H"]
    ground = {"S": (400.0, -300.0), "T": (500.0, -300.0)}
    x, y = (float(given.numbers(number)) for number in given.points[links[coupler][0]])
    points = {
        **given.points,
        **ground,
        "H": (x, y + 30.0),
        "I": (450.0, -300.0),
    }
    loaded = cranks.changed(
        points=points, links=links,
        slots=[lw.Slot(name="s", point="I", on="ground", line=("S", "T"))],
        loads=[lw.Load(point="I", force=(0, -10))],
    )  # fmt: skip
    found = loaded.forces(at=70)
    assert found.status is lw.forces.ForceStatus.UNDETERMINED
    assert found["disagreement"] < 1e-10
    unknown = {name.partition(".")[0] for name, rows in found.undetermined.items() if rows}
    assert unknown == {"A1", "A2", "A3", "O1", "O2", "O3"}
    assert math.isnan(found["A1.force.x"])
    assert math.isfinite(found["H.force.x"])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"loads": [lw.Load(point="Q", force=(1, 0))]}, 'point "Q" is not defined'),
        ({"loads": [lw.Load(link="rodd", torque=1)]}, 'link "rodd" is not defined'),
        ({"loads": [lw.Load(link="rod", torque="1 +")]}, "expected a number"),
        ({"loads": [lw.Load(link="rod", torque="2*rodd")]}, 'there is no "rodd"'),
        ({"loads": [lw.Load(point="A")]}, "needs either a force or a torque"),
        ({"loads": [lw.Load(point="A", link="block", force=(1, 0))]}, "does not carry A"),
        ({"masses": {"rod": lw.Mass(mass=-1, shape="rod")}}, "must not be negative"),
        ({"masses": {"rot": lw.Mass(mass=1)}}, 'link "rot" is not defined'),
        ({"masses": {"rod": lw.Mass(mass=1)}}, "center  is missing"),
        ({"masses": {"ground": lw.Mass(mass=1, shape="rod")}}, "its mass has no effect"),
        ({"mass": "stone"}, '"stone" is not a known unit'),
        ({"length": "cubit", "masses": {"block": lw.Mass(mass=1)}}, "cannot be converted"),
        ({"gravity": lw.Gravity(size="9.81 m")}, "must be a number and a unit"),
        (
            {"springs": [lw.Spring(name="s", links=("rod", "rod"), stiffness=1)]},
            "two different links",
        ),
    ],
)  # fmt: skip
def test_wrong_loads_are_refused_with_their_key(changes: dict[str, object], message: str) -> None:
    with pytest.raises(MechanismError) as refused:
        lw.linkage(**SLIDER_CRANK, inputs=lw.Input(link="crank"), **changes)
    assert message in str(refused.value)


def test_loads_in_time_need_a_speed_for_forces_but_not_for_simulations() -> None:
    loads = [lw.Load(link="rod", torque="t")]
    masses = {"rod": lw.Mass(mass=1, shape="rod")}
    engine = lw.linkage(**SLIDER_CRANK, inputs=lw.Input(link="crank"), loads=loads, masses=masses)
    with pytest.raises(MechanismError, match="needs the speed"):
        engine.forces()
    assert engine.simulate(0.1, step=0.1).found.all()


def test_loops_that_read_as_a_linkage_have_its_reactions() -> None:
    masses = {
        "crank": lw.Mass(mass=1, center=(3, 1), inertia=5),
        "rod": lw.Mass(mass=2, center=(30, 4), inertia=50),
    }
    given = {
        "masses": masses,
        "gravity": lw.Gravity(),
        "loads": [lw.Load(point="E", force=(-20, 5))],
    }
    loops = lw.example("rapier-drive").changed(**given).forces(at=50)
    links = lw.example("rapier-drive-links").changed(**given).forces(at=50)
    assert loops["θ12.effort"] == pytest.approx(links["crank.effort"], rel=1e-10)
    assert loops["disagreement"] < 1e-10
    for pin in ("A0", "A", "B", "C", "C0", "D"):
        for axis in "xy":
            name = f"{pin}.force.{axis}"
            assert loops[name] == pytest.approx(links[name], abs=1e-10)


BLOCK = """
format = 1
length = "mm"
[dimensions]
a = 40
b = 120
[loops]
main = "a*e^(i*θ2) + b*e^(i*θ3) = d"
[guess]
"θ2" = 60
"θ3" = -17
d = 135
[input]
variable = "θ2"
[points]
O = "0"
A = "a*e^(i*θ2)"
B = "d"
[links]
ground = ["O"]
crank = ["O", "A"]
rod = ["A", "B"]
block = ["B"]
[masses]
block = { mass = 2 }
"""


def test_loops_with_a_link_of_one_point_are_loaded_there() -> None:
    crank = lw.loads(BLOCK + '[[loads]]\npoint = "B"\nforce = [-10, 0]\n').forces(at=90)
    # virtual work: the block goes back by the crank's length per radian
    assert crank["θ2.effort"] == pytest.approx(-10 * 40)
    assert crank["disagreement"] < 1e-13
    # the rod comes from above and pushes the block along itself; the line holds it up
    assert crank["d.normal"] == pytest.approx(10 * 40 / math.sqrt(120**2 - 40**2))


@pytest.mark.parametrize(
    ("text", "key"),
    [
        (f'{BLOCK}[[loads]]\nlink = "block"\ntorque = 3\n', "loads[1].link"),
        (f'{BLOCK}[[loads]]\npoint = "B"\nforce = [1, 0]\nwith = "block"\n', "loads[1].with"),
        (BLOCK.replace("mass = 2", "mass = 2, inertia = 5"), "masses.block.inertia"),
    ],
)
def test_loops_do_not_tell_the_rotation_of_a_link_of_one_point(text: str, key: str) -> None:
    with pytest.raises(MechanismError, match="has only one point") as refused:
        lw.loads(text)
    assert key in str(refused.value)


def test_a_family_has_the_forces_of_its_designs() -> None:
    press = lw.example("crank-press")
    efforts = press.family({"O A": [55.0, 60.0]}).sweep()["crank.effort"]
    for k, length in enumerate((55.0, 60.0)):
        own = np.asarray(press.with_dimensions({"O A": length}).forces()["crank.effort"])
        assert efforts[k] == pytest.approx(own, rel=1e-9, abs=1e-6)


def test_an_inversion_has_no_loads() -> None:
    inverted = described_as(Linkage, lw.example("crank-press").inversion("rod"))
    assert not inverted.masses
    assert not inverted.loads


def test_both_sides_of_a_switch_are_known_between_rows() -> None:
    rotor = lw.linkage(
        length="m",
        points={"O": (0, 0), "A": (0.03, 0)},
        links={"ground": ["O"], "crank": ["O", "A"]},
        inputs=lw.Input(link="crank", from_=0, to=360, step=5, speed="150 rpm"),
        loads=[lw.Load(link="crank", torque="-(100 + 20000*(crank > 100.1)*(crank < 100.9))")],
    )
    found = rotor.forces()
    assert np.max(found["crank.effort"]) == pytest.approx(100.0)
    swept = rotor.sweep()
    for number, value in (("max", 20100.0), ("min", 100.0), ("stroke", 20000.0)):
        assert swept.value(f"{number}(crank.effort)") == pytest.approx(value, rel=1e-12)
    beside = found.at_switches
    # rows a few 1e-12 of the table beside the switches
    assert beside["crank"] == pytest.approx([100.1, 100.1, 100.9, 100.9], abs=360 * 3e-12)
    assert beside["crank.effort"] == pytest.approx([100.0, 20100.0, 20100.0, 100.0])
    smooth = rotor.changed(loads=[lw.Load(link="crank", torque="-5")]).forces()
    assert not len(smooth.at_switches["crank"])


def test_the_gas_of_an_engine_shakes_no_ground() -> None:
    """Head and crankcase are one: the load on ground is the opposite of that on the piston."""
    engine = lw.linkage(
        length="m",
        points={"O": (0, 0), "T": (0.3, 0), "A": (0.03, 0.04), "B": (0.23, 0)},
        links={"ground": ["O", "T"], "crank": ["O", "A"], "rod": ["A", "B"], "piston": ["B"]},
        sliders=[lw.Slider(name="d", link="piston", points=("B",), on="ground", line=("O", "T"))],
        masses={"piston": lw.Mass(mass=1)},
        inputs=lw.Input(link="crank", from_=0, to=360, step=45, speed="100 rad/s"),
    )
    gas = "1000*(d < 0.2)"
    piston = lw.Load(point="B", link="piston", force=(f"-{gas}", 0))
    ran, idle = engine.forces(), engine.changed(loads=[piston]).forces()
    for head in (lw.Load(point="T", link="ground", force=(gas, 0)),
                 lw.Load(point="T", force=(gas, 0))):  # fmt: skip
        both = engine.changed(loads=[piston, head]).forces()
        size = np.abs(ran["shaking.x"]).max()
        assert both["shaking.x"] == pytest.approx(ran["shaking.x"], abs=1e-12 * size)
        assert both["crank.effort"] == pytest.approx(idle["crank.effort"], abs=1e-12 * size)
    with pytest.raises(lw.MechanismError, match="is fixed: the force has no effect"):
        engine.changed(loads=[head])
