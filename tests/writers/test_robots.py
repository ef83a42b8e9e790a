"""Robots: trees whose forward kinematics give the sweep's points, and refusals."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as Tree

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.part.part import Pair, PairKind
from linkwork.core.results.motion import Motion
from linkwork.writers.robot.files import mjcf_of, sdf_of, urdf_of
from linkwork.writers.robot.robot import Robot
from tests.library_mechanisms import read_example
from tests.writers.coarse import coarse

# forward kinematics through five bodies at most, in units of the longest link
_ROUNDING = 1e-12


def _robot(name: str) -> tuple[Robot, Motion]:
    mechanism = read_example(name)
    return Robot(mechanism.model, mechanism.solve()), mechanism.sweep()


def _numbers(element: Tree.Element, key: str) -> list[float]:
    return [float(number) for number in element.attrib[key].split()]


def _places(
    body: Tree.Element,
    origin: complex,
    turn: complex,
    values: dict[str, float],
    found: dict[str, complex],
) -> None:
    """Forward kinematics of nested bodies of MJCF in the plane."""
    for site in body.findall("site"):
        x, y, _ = _numbers(site, "pos")
        found[site.attrib["name"]] = origin + turn * complex(x, y)
    for child in body.findall("body"):
        x, y, _ = _numbers(child, "pos")
        w, _, _, z = _numbers(child, "quat")
        place, angle = origin + turn * complex(x, y), turn * complex(w, z) ** 2
        joint = child.find("joint")
        if joint is not None and joint.attrib["type"] == "slide":
            a, b, _ = _numbers(joint, "axis")
            place += angle * complex(a, b) * values[joint.attrib["name"]]
        elif joint is not None:
            angle *= np.exp(1j * values[joint.attrib["name"]])
        _places(child, place, angle, values, found)


@pytest.mark.parametrize("name", ["four-bar", "crank-shaper", "geared-five-bar", "rolling-wheel"])
def test_trees_move_as_the_sweep(name: str) -> None:
    robot, motion = _robot(name)
    root = Tree.fromstring(mjcf_of(robot))
    world = root.find("worldbody")
    assert world is not None
    values, size = robot.values(motion), robot.start.length * robot.metre
    for row in np.flatnonzero(motion.found)[::40]:
        found: dict[str, complex] = {}
        now = {joint: float(value[row]) for joint, (value, _) in values.items()}
        _places(world, 0j, 1.0 + 0j, now, found)
        for site, place in found.items():
            point = site.partition("/")[2]
            wanted = motion.place(point).v[row] * robot.metre
            assert abs(place - wanted) <= _ROUNDING * size, (site, row)
        # couplings of wheels stay as they are in the start position
        for fixed in root.iter("fixed"):
            total = sum(
                float(j.attrib["coef"]) * now[j.attrib["joint"]] for j in fixed.findall("joint")
            )
            assert abs(total) <= 1e-11, fixed.attrib["name"]


def test_files_have_all_bodies_and_joints(tmp_path: Path) -> None:
    mechanism = coarse(read_example("crank-shaper"), 48)
    robot = Robot(mechanism.model, mechanism.solve())
    bodies, joints = len(robot.tree.graph.bodies) - 1, len(robot.tree.joints)
    roots = {}
    for suffix in ("mjcf", "urdf", "sdf"):
        mechanism.write(tmp_path / f"x.{suffix}")
        roots[suffix] = Tree.parse(tmp_path / f"x.{suffix}").getroot()
    closing = len(robot.tree.closing)
    assert bodies == joints
    assert len(list(roots["mjcf"].iter("body"))) == bodies
    assert len(roots["mjcf"].findall("equality/*")) == closing > 0
    assert len(roots["urdf"].findall("link")) == bodies + 1
    assert len(roots["urdf"].findall("joint/mimic")) == len(roots["urdf"].findall("coupling"))
    assert len(roots["sdf"].findall("model/joint")) == joints + closing


def test_a_urdf_ends_at_the_dead_points(tmp_path: Path) -> None:
    lengths = {"O2 A": 80, "A B": 120, "O4 B": 80, "O2 O4": 100}
    mechanism = coarse(lw.example("four-bar").changed(lengths=lengths), 72)
    motion, start = mechanism.sweep(), mechanism.solve()
    from_start = np.radians(motion.limits[0].input - start.input["crank"])
    mechanism.write(tmp_path / "x.urdf", motion=motion)
    root = Tree.parse(tmp_path / "x.urdf").getroot()
    limit = next(j for j in root.findall("joint") if j.find("mimic") is None).find("limit")
    assert limit is not None
    ends = [float(limit.attrib[key]) for key in ("lower", "upper")]
    assert min(abs(end - from_start) for end in ends) <= 1e-9


# its input has dead points at 60 and 300 degrees, in rows of the table
_DEAD_ROWS = """
format = 1
name = "Dead rows"
length = "mm"
angle = "deg"
[points]
O = [0, 0]
A = [0, 100]
B = [180, 80]
C = [100, 0]
[links]
ground = ["O", "C"]
crank = ["O", "A"]
coupler = ["A", "B"]
rocker = ["C", "B"]
[lengths]
"O A" = 100
"A B" = 180
"C B" = 80
"O C" = 100
[input]
link = "crank"
to = 360
step = 2
"""


def _urdf(mechanism: lw.Mechanism, at: float | None = None) -> Tree.Element:
    return Tree.fromstring(urdf_of(Robot(mechanism.model, mechanism.solve(at)), mechanism.sweep()))


def _limits(root: Tree.Element, link: str) -> list[float]:
    joint = next(j for j in root.findall("joint") if j.attrib["name"].endswith(f":{link}"))
    limit = joint.find("limit")
    assert limit is not None
    return [float(limit.attrib[key]) for key in ("lower", "upper")]


def test_dead_points_in_rows_of_the_table_end_the_polynomials() -> None:
    mechanism = lw.loads(_DEAD_ROWS)
    root, motion = _urdf(mechanism), mechanism.sweep()
    at_start = mechanism.solve()
    for link in ("crank", "rocker"):
        # the rows of the dead points are the ends of all ranges that they are in
        moved = np.radians(motion[link][motion.found] - at_start[link])
        assert _limits(root, link) == pytest.approx([moved.min(), moved.max()], abs=1e-9)
    for own in root.findall("coupling"):
        series = np.array((own.text or "").split(), float)
        low, high = float(own.attrib["low"]), float(own.attrib["high"])
        value = np.polynomial.chebyshev.chebval(-(low + high) / (high - low), series)
        assert abs(value) <= float(own.attrib["error"]) <= 0.01


def test_inputs_that_follow_the_leading_one_have_polynomials() -> None:
    errors = {own.attrib["joint"]: float(own.attrib["error"])
              for own in _urdf(read_example("excavator")).findall("coupling")}  # fmt: skip
    assert len(errors) == 10
    assert max(errors.values()) <= 1e-9
    assert all(np.isfinite(list(errors.values())))


def test_a_start_outside_of_the_table_is_said() -> None:
    bar = read_example("four-bar")
    said = "The start position is not between these limits."
    texts = [urdf_of(Robot(bar.model, bar.solve(at)), bar.sweep()) for at in (-90.0, 90.0)]
    assert [said in text for text in texts] == [True, False]


@pytest.mark.parametrize(
    ("name", "file", "reason"),
    [
        ("eccentric-cam", "x.mjcf", '"disc" (cam'),
        ("rapier-drive", "x.mjcf", "is given by equations"),
        ("three-rpr", "x.sdf", '"unit" cannot be converted to metres'),
        ("geared-five-bar", "x.sdf", "couples turning wheels"),
        ("rolling-wheel", "x.urdf", "URDF has no loops"),
        ("four-bar", "x.xml", "the suffix of a robot is one of .mjcf, .urdf, .sdf"),
    ],
)
def test_refusals_say_why(name: str, file: str, reason: str, tmp_path: Path) -> None:
    with pytest.raises(lw.InputError) as raised:
        read_example(name).write(tmp_path / file, kind="robot")
    assert reason in str(raised.value)
    assert not (tmp_path / file).exists()


@pytest.mark.parametrize("suffix", ["mjcf", "sdf"])
def test_a_link_with_the_name_of_the_ground_of_simulators_is_refused(
    suffix: str, tmp_path: Path
) -> None:
    mechanism = lw.loads(_DEAD_ROWS.replace("coupler =", "world ="))
    with pytest.raises(lw.InputError, match='link "world" has the name of the ground'):
        mechanism.write(tmp_path / f"x.{suffix}")


@pytest.mark.parametrize("name", ["", "world", "__model__", "Crank::rocker"])
def test_titles_that_sdf_does_not_allow_are_replaced_and_noted(name: str, tmp_path: Path) -> None:
    mechanism = lw.loads(_DEAD_ROWS.replace("Dead rows", name))
    mechanism.write(tmp_path / "x.sdf")
    text = (tmp_path / "x.sdf").read_text()
    assert f'The model is named "mechanism": SDF does not allow "{name}".' in text
    model = Tree.fromstring(text).find("model")
    assert model is not None
    assert model.attrib["name"] == "mechanism"


def test_a_link_with_a_name_that_sdf_reserves_is_refused(tmp_path: Path) -> None:
    mechanism = lw.loads(_DEAD_ROWS.replace("coupler =", "__coupler__ ="))
    with pytest.raises(lw.InputError, match='link "__coupler__" has a name that SDF reserves'):
        mechanism.write(tmp_path / "x.sdf")
    mechanism.write(tmp_path / "x.mjcf")


def test_points_are_frames_of_an_sdf_model() -> None:
    robot, _ = _robot("crank-shaper")
    root = Tree.fromstring(sdf_of(robot))
    poses = {own.attrib["name"]: own.findtext("pose") or "" for own in root.iter("link")}
    frames = root.findall("model/frame")
    named = [(body, p) for body, own in robot.tree.graph.bodies.items() for p in own]
    moving = {f"{body}/{point}" for body, point in named if body != GROUND}
    assert {own.attrib["name"] for own in frames} == moving
    for own in frames:
        body, _, point = own.attrib["name"].partition("/")
        assert own.attrib["attached_to"] == body
        x, y, *_, angle = map(float, poses[body].split())
        a, b, *_ = map(float, (own.findtext("pose") or "").split())
        place = complex(x, y) + np.exp(1j * angle) * complex(a, b)
        size = robot.start.length * robot.metre
        assert abs(place - robot.place(point)) <= _ROUNDING * size, own.attrib


def test_a_weld_to_the_ground_names_the_world() -> None:
    mechanism = read_example("four-bar")
    robot = Robot(mechanism.model, mechanism.solve())
    robot.tree.closing.append(
        Pair(kind=PairKind.FIXED, name="more", bodies=("rocker", "ground"), point="O4")
    )
    weld = Tree.fromstring(mjcf_of(robot)).find("equality/weld")
    assert weld is not None
    assert weld.attrib == {"body1": "rocker", "body2": "world"}


def test_bodies_without_mass_and_of_micrometres_have_what_simulators_need() -> None:
    mechanism = lw.loads(
        _DEAD_ROWS.replace('length = "mm"', 'length = "µm"')
        + '[masses]\ncoupler = { mass = 0, shape = "rod" }\n'
    )
    robot = Robot(mechanism.model, mechanism.solve())
    bodies = [robot.inertia(name) for name in ("crank", "coupler", "rocker")]
    assert all(own.mass >= 1e-14 and own.inertia >= 1e-14 for own in bodies)
    assert bodies[1].mass < 1e-3 * bodies[0].mass
    assert "A small mass instead of none, which simulators refuse: coupler." in robot.notes()


def test_a_joint_that_rests_has_a_polynomial_that_is_constant() -> None:
    yoke = read_example("scotch-yoke").changed(name="yoke")
    text = urdf_of(Robot(yoke.model, yoke.solve()), yoke.sweep(step=360 / 11))
    assert Tree.fromstring(text).findall("coupling")


def test_every_input_has_an_actuator_of_its_joint(tmp_path: Path) -> None:
    robot = read_example("five-bar-robot")
    texts = {}
    for suffix in (".mjcf", ".sdf", ".urdf"):
        robot.write(tmp_path / f"robot{suffix}")
        texts[suffix] = (tmp_path / f"robot{suffix}").read_text("utf-8")
    motors = Tree.fromstring(texts[".mjcf"]).iterfind("actuator/motor")
    assert [(own.get("name"), own.get("joint")) for own in motors] == [
        ("input:left", "O1:left"), ("input:right", "O2:right"),
    ]  # fmt: skip
    assert "whose motors a model cannot give: O1:left, O2:right." in texts[".sdf"]
    assert "in step with it as in the table: O2:right." in texts[".urdf"]
    bar = coarse(read_example("four-bar"), 36).driven_by(link="coupler")
    bar.write(tmp_path / "bar.mjcf", at=20)
    text = (tmp_path / "bar.mjcf").read_text("utf-8")
    assert "Not driven, between bodies without a common joint: coupler." in text
    assert "<motor" not in text
