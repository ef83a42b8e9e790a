"""Improvements of special mechanisms keep their relations; a standstill is no success."""

from __future__ import annotations

import math

import pytest

import linkwork as lw
from linkwork.synthesis.improvement.proved_design import proved_design

_GEARED = """format = 1
length = "mm"
angle = "deg"
[dimensions]
a = 40
b = 130
c = 120
d = 30
f = 110
[points]
O = [0, 0]
P = [110, 0]
A = [40, 0]
B = [135.98, 15]
C = [85, 120]
[links]
ground = ["O", "P"]
left = ["O", "A"]
right = ["P", "B"]
rod1 = ["A", "C"]
rod2 = ["B", "C"]
[lengths]
"O A" = "a"
"A C" = "b"
"B C" = "c"
"P B" = "d"
[[gears]]
name = "mesh"
wheels = ["left", "right"]
centers = ["O", "P"]
radii = ["2*f/3", "f/3"]
phase = 30
[input]
link = "left"
from = 0
to = 360
step = 5
"""


@pytest.mark.parametrize(
    ("name", "of"),
    [
        ("parallelogram", "stroke(A.x)"),
        ("antiparallelogram", "stroke(A.x)"),
        ("peaucellier", "stroke(P.x)"),
        ("geneva-drive", "stroke(A.x)"),
        ("cardan-circles", "stroke(P.x)"),
    ],
)
def test_a_tenth_more_stroke_is_reached_by_special_mechanisms(name: str, of: str) -> None:
    mechanism = lw.example(name)
    wanted = 1.1 * mechanism.sweep(certify=False).value(of)
    best = lw.synthesis.improve(mechanism, {"of": of, "target": wanted}, starts=2)[0]
    assert best.sound
    moved = lw.Mechanism(best.description).sweep(certify=False)
    assert moved.value(of) == pytest.approx(wanted, rel=1e-6)
    if name == "parallelogram":
        # which has no change point in its range, with opposite sides that are equal
        assert best.numbers["O2 A"] == pytest.approx(best.numbers["O4 B"], rel=1e-12)


def test_gears_keep_their_distance_of_centres() -> None:
    goals = [{"of": "max(C.y)", "target": 150}, {"of": "min(C.y)", "target": 90}]
    best = lw.synthesis.improve(lw.loads(_GEARED), goals, starts=2)[0]
    assert best.sound
    # of the weighted misses [mm]
    assert best.largest < 1e-6
    assert best.numbers["P.x"] - best.numbers["O.x"] == pytest.approx(best.numbers["f"], rel=1e-12)


def test_a_standstill_is_refused_with_its_reason() -> None:
    goals = [{"of": "stroke(rocker)", "target": 60}]
    held = {"A B": (120, 120), "O4 B": (80, 80)}
    task = lw.Task.improve("four-bar", goals=goals, vary=["A B", "O4 B"], bounds=held, starts=1)
    found = task.solve()
    assert (found.sound, found.delivered) == (0, ())
    assert found.defects == {lw.synthesis.DefectKind.UNMOVED: 1}
    (defect,) = found.designs[0].defects
    assert "the mechanism as it was is no farther from its goals" in defect.message
    assert "it misses stroke(rocker) by 13.78" in defect.message
    assert found.to_dict()["defects"] == {"unmoved": 1}
    # a mechanism that meets its goals is one
    bar = lw.example("four-bar")
    met = {"of": "stroke(rocker)", "target": bar.sweep().value("stroke(rocker)")}
    assert lw.synthesis.improve(bar, met, vary=["A B"], starts=1)[0].sound


@pytest.mark.parametrize(("angle", "sound"), [(0.05, False), (0.2, True)])
def test_a_design_next_to_a_dead_point_is_not_sound(angle: float, sound: bool) -> None:
    """At crank = 180 deg crank and ground are in line, and the coupler nearly with the rocker."""
    c, apart = 80.0, 140.0
    bend = c * math.cos(math.radians(180.0 - angle))
    coupler = bend + math.sqrt(bend**2 + apart**2 - c**2)
    bar = lw.example("four-bar").changed(lengths={"A B": coupler})
    design = proved_design(bar.description)
    assert design.sound == sound
    told = f"nearly a dead point: transmission angle down to {angle}° near crank = 180 deg"
    assert (told in design.message) != sound
