"""Bodies of MJCF that do not meet as drawn: lengths are those of their frames."""

from __future__ import annotations

import math

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import MechanismFileError
from linkwork.core.mechanism.linkage import Linkage
from linkwork.readers.assembly import LeftOut
from linkwork.readers.importing import read_foreign

_CRANK = """
<body name="crank"><joint name="O" axis="0 0 1"/>
  <body name="coupler" pos="0.2 0 0"><joint name="A" axis="0 0 1"/>{coupler}</body></body>"""
_ROCKER = """<body name="rocker" pos="0.45 0 0"><joint name="Q" axis="0 0 1"/>{rocker}</body>"""
_MOTOR = '<actuator><motor joint="O"/></actuator>'


def _read(bodies: str, equality: str, rest: str = _MOTOR) -> tuple[Linkage, tuple[LeftOut, ...]]:
    text = f"<mujoco><worldbody>{bodies}</worldbody><equality>{equality}</equality>{rest}</mujoco>"
    found = read_foreign(text.encode(), "gap.mjcf")
    return found.description, found.left_out


def test_lengths_of_links_whose_sites_are_apart_are_those_of_their_frames() -> None:
    bodies = _CRANK.format(
        coupler='<site name="tip" pos="0.35 0 0"/><site name="P" pos=".1 .2 0"/>'
    )
    bodies += _ROCKER.format(
        rocker='<site name="rt" pos="0 0.25 0"/><site name="S" pos="0.1 0 0"/>'
    )
    linkage, left_out = _read(bodies, '<connect site1="tip" site2="rt"/>')
    assert left_out == ()
    assert linkage.points["tip"] == (0.5, 0.125)  # a sketch: between both
    position = lw.Mechanism(linkage).solve(at=60)
    assert position.status.ok
    place = {name: complex(*position.points[name]) for name in linkage.points}
    wanted = {"A tip": 0.35, "A P": math.hypot(0.1, 0.2), "Q tip": 0.25, "Q S": 0.1, "O A": 0.2}
    for pair, length in wanted.items():
        a, b = pair.split()
        assert abs(place[b] - place[a]) == pytest.approx(length, rel=1e-14), pair
    # points keep their sides
    turned = (place["S"] - place["Q"]) / (place["tip"] - place["Q"])
    assert turned == pytest.approx(0.1 / 0.25j, rel=1e-13)


@pytest.mark.parametrize("how", ["relpose", "sites"])
def test_welded_bodies_have_the_pose_of_the_weld_whatever_is_drawn(how: str) -> None:
    half = math.radians(20)
    turn = f"{math.cos(half)} 0 0 {math.sin(half)}"
    bodies = _CRANK.format(coupler=f'<site name="a" pos="0.3 0.05 0" quat="{turn}"/>')
    bodies += _ROCKER.format(
        rocker='<body name="end" pos="0 0.25 0"><joint name="B" axis="0 0 1"/>'
        '<site name="b"/><site name="P" pos="0.1 0 0"/></body>'
    )
    weld = {
        "relpose": f'<weld body1="coupler" body2="end" relpose="0.3 0.05 0 {turn}"/>',
        "sites": '<weld site1="a" site2="b"/>',
    }
    linkage, _ = _read(bodies, weld[how])
    position = lw.Mechanism(linkage).solve(at=60)
    place = {name: complex(*position.points[name]) for name in linkage.points}
    end = next(p for p in linkage.links["rocker"] if p != "Q")
    assert set(linkage.links["coupler"]) == {"A", end, "P"}
    assert abs(place[end] - place["Q"]) == pytest.approx(0.25, rel=1e-13)
    arm = place[end] - place["A"]
    assert abs(arm) == pytest.approx(abs(0.3 + 0.05j), rel=1e-13)
    tip = 0.1 * np.exp(2j * half) / (0.3 + 0.05j)
    assert (place["P"] - place[end]) / arm == pytest.approx(tip, rel=1e-12)


def test_a_block_whose_pin_is_apart_keeps_its_angle_on_its_line() -> None:
    block = (
        '<body name="block" pos="0.5 0.02 0"><joint name="d" type="slide" axis="1 0 0"/>'
        '<site name="pin" pos="0.03 0.04 0"/></body>'
    )
    bodies = _CRANK.format(coupler='<site name="tip" pos="0.35 0 0"/>') + block
    linkage, _ = _read(bodies, '<connect site1="tip" site2="pin"/>')
    position = lw.Mechanism(linkage).solve(at=90)
    assert position.status.ok
    # the pin runs along y = 0.06, the crank's end is at (0, 0.2)
    assert position.points["tip"] == pytest.approx((math.sqrt(0.35**2 - 0.14**2), 0.06), rel=1e-13)


def test_what_no_position_meets_and_what_is_not_read_is_listed() -> None:
    two = (
        '<body name="a"><joint name="ja" axis="0 0 1"/><site name="sa" pos="0.3 0 0"/></body>'
        '<body name="b" pos="0.5 0 0"><joint name="jb" axis="0 0 1" armature="1"/>'
        '<site name="sb" pos="0 0.1 0"/><site name="c" fromto="0 0 0 1 0 0"/></body>'
    )
    rest = '<actuator><motor joint="ja"/><motor joint="jb"/></actuator><keyframe/><tendon/>'
    linkage, left_out = _read(two, '<weld site1="sa" site2="sb"/>', rest)
    assert {own.what for own in left_out} == {
        "<weld> that contradicts the lengths of the links", "section <keyframe>",
        "section <tendon>", "site with fromto", "inertia of the rotor of a joint",
    }  # fmt: skip
    assert list(linkage.links) == ["ground", "a", "b"]
    turned = f'<weld body1="a" body2="b" relpose="0 0 0 {math.sqrt(0.5)} {math.sqrt(0.5)} 0 0"/>'
    assert "weld that turns a body out of the plane" in {o.what for o in _read(two, turned)[1]}


def test_global_coordinates_are_refused_by_name() -> None:
    text = b'<mujoco>\n<compiler coordinate="global"/><worldbody/></mujoco>'
    with pytest.raises(MechanismFileError, match=r'coordinate="global" is not read'):
        read_foreign(text, "global.mjcf")


def test_a_body_without_a_joint_is_a_point_of_its_parent() -> None:
    tip = '<body name="tip" pos="0.12 0 0"/>'
    linkage, _ = _read(_CRANK.format(coupler=tip), "", '<actuator><motor joint="A"/></actuator>')
    assert linkage.links["coupler"] == ("A", "tip")
    urdf = (
        '<robot><link name="base"/><link name="arm"/><link name="tip"/>'
        '<joint name="O" type="continuous"><parent link="base"/><child link="arm"/>'
        '<axis xyz="0 0 1"/></joint><joint name="fixed" type="fixed"><parent link="arm"/>'
        '<child link="tip"/><origin xyz="0.12 0 0"/></joint></robot>'
    )
    assert read_foreign(urdf.encode(), "arm.urdf").description.links["arm"] == ("O", "tip")
