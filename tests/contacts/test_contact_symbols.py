"""Wheels, belts, racks, cams and curved slots: every symbol stands where the parts touch."""

from __future__ import annotations

import cmath
import math
from functools import cache

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.drawing import (
    Arc,
    Disc,
    Hatch,
    Polygon,
    Polyline,
    Role,
    Scene,
    SceneOptions,
    reach_of,
    scene_of,
)
from linkwork.core.drawing.pose import Pose
from linkwork.core.drawing.wheels import tooth_outline, tooth_phases
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.mechanism.bodies import Contour, DiscFigure as Wheel
from linkwork.core.mechanism.part.gears import BeltRun
from linkwork.core.mechanism.part.springs import RigidJoint

EXAMPLES = [
    "planetary-gear", "planetary-differential", "cardan-circles", "geared-five-bar",
    "rolling-inside", "rolling-wheel", "belt-drive", "crossed-belt", "rack-and-pinion",
    "rack-steering", "cam-roller-follower", "cam-swinging-follower", "eccentric-cam",
    "curved-slot", "garage-door",
]  # fmt: skip

# Sums and turns of a few coordinates: rounding of the largest one.
ROUNDING = 1e-12


@cache
def motion_of(name: str) -> lw.Motion:
    return lw.example(name).sweep(certify=False)


@cache
def position_of(name: str, value: float | None) -> lw.Position:
    return lw.example(name).solve(value, certify=False)


@cache
def scene_at(name: str, value: float | None = None) -> Scene:
    return scene_of(position_of(name, value), motion_of(name))


def z(point: tuple[float, float]) -> complex:
    return complex(*point)


def line_of(part: Arc | Polygon | Polyline) -> ComplexArray:
    return np.array([z(point) for point in part.points])


def teeth_of(disc: Wheel) -> int:
    assert disc.teeth is not None
    return disc.teeth


def place(position: lw.Position, name: str) -> complex:
    return z(position.points[name])


def distance_to_line(point: complex, corners: ComplexArray) -> float:
    """From a point to a closed line through corners."""
    start, step = corners, np.roll(corners, -1) - corners
    share = np.clip(((point - start) * step.conj()).real / np.abs(step) ** 2, 0.0, 1.0)
    return float(np.abs(point - start - share * step).min())


def inside(point: complex, corners: ComplexArray) -> bool:
    """Whether a closed line runs around a point."""
    return bool(abs(np.angle((np.roll(corners, -1) - point) / (corners - point)).sum()) > 1.0)


@pytest.mark.parametrize(("name", "ends"), [("belt-drive", (25, 50)), ("crossed-belt", (30, 30))])
@pytest.mark.parametrize("value", [0, 77])
def test_the_runs_of_a_belt_touch_both_pulleys(
    name: str, ends: tuple[float, float], value: float
) -> None:
    position, scene = position_of(name, value), scene_at(name, value)
    [belt] = position.skeleton.of(BeltRun)
    centres = [place(position, point) for point in belt.centers]
    size = scene.measures.size
    runs = scene.select(Polyline, Role.BELT)
    assert len(runs) == 2
    sides = []
    for run in runs:
        start, end = line_of(run)
        along = (end - start) / abs(end - start)
        for point, centre, radius in zip((start, end), centres, ends, strict=True):
            assert abs(abs(point - centre) - radius) < ROUNDING * size
            assert abs(((point - centre) * along.conjugate()).real) < ROUNDING * size
        sides.append([((c - start) * along.conjugate()).imag > 0 for c in centres])
    # Pulleys of an open belt lie on one side of a run, those of a crossed one on both.
    assert all((one == other) is not belt.crossed for one, other in sides)


@pytest.mark.parametrize("name", ["belt-drive", "crossed-belt"])
def test_a_belt_is_closed_and_goes_around_the_far_sides(name: str) -> None:
    position, scene = position_of(name, 40), scene_at(name, 40)
    centres = [place(position, point) for point in position.skeleton.of(BeltRun)[0].centers]
    runs = [line_of(run) for run in scene.select(Polyline, Role.BELT)]
    arcs = scene.select(Arc, Role.BELT)
    for k, (arc, other) in enumerate(zip(arcs, (centres[1], centres[0]), strict=True)):
        points = line_of(arc)
        ends = {k: {round(abs(run[k] - p), 9) for run in runs for p in points[[0, -1]]}}
        assert 0.0 in ends[k]
        assert sorted(min(abs(run[k] - p) for p in points[[0, -1]]) for run in runs)[1] < 1e-9
        far = z(arc.centre) + arc.radius * (z(arc.centre) - other) / abs(z(arc.centre) - other)
        assert np.abs(points - far).min() < 0.06 * arc.radius  # pieces are 0.1 rad long


def test_gears_have_their_number_of_teeth() -> None:
    scene = scene_at("planetary-gear", 100)
    position = position_of("planetary-gear", 100)
    for link, teeth, centre in (("sun", 40, "O"), ("planet", 20, "A")):
        [outline] = scene.select(Polygon, Role.WHEEL, link)
        radii = np.abs(line_of(outline) - place(position, centre))
        pitch = 30.0 * teeth / 40
        beyond = radii > pitch
        assert int((beyond & ~np.roll(beyond, 1)).sum()) == teeth
        module = 2 * pitch / teeth
        assert radii.max() == pytest.approx(pitch + module, rel=ROUNDING)
    edge = next(
        line_of(line)
        for line in scene.select(Polyline, Role.FRAME)
        if len(line.points) > 200  # the other one is the plain outer circle
    )[:-1]
    radii = np.abs(edge - place(position, "O"))
    beyond = radii > 60
    assert int((beyond & ~np.roll(beyond, 1)).sum()) == 80
    assert radii.min() == pytest.approx(60 - 1.5, rel=ROUNDING)


@pytest.mark.parametrize("value", [0, 13, 100, 741])
@pytest.mark.parametrize("name", ["planetary-gear", "planetary-differential"])
def test_teeth_in_mesh_do_not_run_into_each_other(name: str, value: float) -> None:
    at = {"sun": value, "ring": value / 7} if name == "planetary-differential" else value
    mechanism = lw.example(name)
    position = mechanism.solve(at, certify=False)
    scene = scene_of(position)
    [planet] = [line_of(p) for p in scene.select(Polygon, Role.WHEEL, "planet")]
    [sun] = [line_of(p) for p in scene.select(Polygon, Role.WHEEL, "sun")]
    ring = next(
        line_of(line)[:-1]
        for role in (Role.FRAME, Role.WHEEL)
        for line in scene.select(Polyline, role)
        if len(line.points) > 200
    )
    # Flanks are drawn by short chords of the involute: they cut it by a hundredth of a module.
    near = 0.02 * 1.5
    for point in planet:
        assert not inside(point, sun) or distance_to_line(point, sun) < near
        assert inside(point, ring) or distance_to_line(point, ring) < near


@pytest.mark.parametrize(
    ("name", "first"), [("planetary-gear", "ground"), ("planetary-differential", "ring")]
)
def test_teeth_turn_with_their_links(name: str, first: str) -> None:
    mechanism = lw.example(name)
    within = []
    for value in (0, 10, 250, 1000):
        at = value if name == "planetary-gear" else {"sun": value, "ring": 90 - value / 9}
        pose = Pose.of(mechanism.solve(at, certify=False), None)
        within.append({
            disc.link: ((phase - pose.angle(disc.link)) * teeth_of(disc) / math.tau) % 1.0
            for disc, phase in tooth_phases(pose).items()
        })  # fmt: skip
    assert set(within[0]) == {first, "planet", "sun"}
    for other in within[1:]:
        for link, phase in other.items():
            off = abs(phase - within[0][link])
            assert min(off, 1 - off) < 1e-9, link


def test_a_tooth_is_half_a_pitch_wide_on_its_pitch_circle() -> None:
    disc = position_of("planetary-gear", 0).skeleton.of(Wheel)[1]
    outline = tooth_outline(disc)
    per_tooth = len(outline) // teeth_of(disc)
    tooth = outline[: per_tooth // 2]
    half = np.interp(disc.radius, np.abs(tooth), -np.angle(tooth))
    assert half == pytest.approx(math.tau / teeth_of(disc) / 4, rel=0.03)  # chords of the flank


def test_the_mark_of_a_wheel_turns_with_its_link() -> None:
    for name, link, centre in (
        ("planetary-gear", "sun", "O"),
        ("belt-drive", "motor", "M"),
        ("cam-roller-follower", "cam", "O"),
    ):
        for value in (0, 40, 200):
            position = position_of(name, value)
            [mark] = scene_at(name, value).select(Polyline, Role.MARK, link)
            start, end = line_of(mark)
            turned = cmath.exp(1j * math.radians(position.links[link]))
            off = ((end - start) / abs(end - start) / turned) - 1
            assert abs(off) < 1e-9
            assert abs(((start - place(position, centre)) / turned).imag) < 1e-9


@pytest.mark.parametrize(("name", "value"), [
    ("cam-roller-follower", 0), ("cam-roller-follower", 60), ("cam-roller-follower", 215),
    ("cam-swinging-follower", 0), ("cam-swinging-follower", 75), ("cam-swinging-follower", 230),
])  # fmt: skip
def test_the_outline_of_a_cam_touches_its_roller(name: str, value: float) -> None:
    position, scene = position_of(name, value), scene_at(name, value)
    [outline] = scene.select(Polygon, Role.WHEEL, "cam")
    [roller] = [d for d in scene.select(Disc, Role.WHEEL) if d.radius == 10]
    assert roller.centre == position.points["R"]
    # The outline is drawn by some 400 chords: they cut it by 1e-4 of its size at most.
    near = 1e-4 * scene.measures.size
    assert distance_to_line(z(roller.centre), line_of(outline)) == pytest.approx(10, abs=near)


@pytest.mark.parametrize("value", [0, 50, 200, 300])
def test_a_flat_face_touches_its_cam_within_its_ends(value: float) -> None:
    scene = scene_at("eccentric-cam", value)
    outline = line_of(scene.select(Polygon, Role.WHEEL, "cam")[0])
    face = next(
        ends
        for ends in map(line_of, scene.select(Polyline, Role.LINK, "follower"))
        if abs((ends[1] - ends[0]).imag) < 1e-9
    )
    top = outline[outline.imag.argmax()]
    assert top.imag == pytest.approx(face[0].imag, abs=1e-3)
    assert min(face.real) < top.real < max(face.real)


def test_the_block_of_a_follower_stands_clear_of_its_cam() -> None:
    for value in (0, 90, 270):
        scene = scene_at("eccentric-cam", value)
        [block] = scene.select(Polygon, Role.SLIDER)
        [rail] = scene.select(Polyline, Role.GROUND, "s")
        assert min(line_of(block).imag.min(), line_of(rail).imag.min()) > 42  # r + ecc
    scene = scene_at("cam-roller-follower", 0)
    [block] = scene.select(Polygon, Role.SLIDER)
    assert line_of(block).mean() == pytest.approx(place(position_of("cam-roller-follower", 0), "E"))
    assert len(scene.select(Polyline, Role.LINK, "follower")) == 1


@pytest.mark.parametrize("value", [-90, -200, -444])
def test_a_rolling_wheel_stands_on_its_line(value: float) -> None:
    scene = scene_at("rolling-wheel", value)
    [wheel] = scene.select(Disc, Role.WHEEL)
    [line] = scene.select(Polyline, Role.GROUND, "x")
    start, end = line_of(line)
    along = (end - start) / abs(end - start)
    foot = (z(wheel.centre) - start) * along.conjugate()
    assert foot.imag == pytest.approx(wheel.radius)
    assert 0 < foot.real < abs(end - start)
    [strokes] = scene.select(Hatch, of="x")
    assert all(((z(b) - z(a)) * along.conjugate()).imag < 0 for a, b in strokes.strokes)


def test_a_wheel_inside_a_circle_touches_it() -> None:
    scene = scene_at("rolling-inside", -333)
    [wheel] = scene.select(Disc, Role.WHEEL)
    rim = min(
        (line_of(line) for line in scene.select(Polyline, Role.FRAME)), key=lambda r: abs(r[0])
    )
    assert abs(z(wheel.centre)) + wheel.radius == pytest.approx(float(np.abs(rim).mean()))


@pytest.mark.parametrize(
    ("name", "values"), [("rack-and-pinion", (0, 90, 200)), ("rack-steering", (-300, 0))]
)
def test_the_pitch_line_of_a_rack_touches_the_pitch_circle_of_its_pinion(
    name: str, values: tuple[int, ...]
) -> None:
    for value in values:
        scene = scene_at(name, value)
        [pinion] = scene.select(Disc, Role.PITCH)
        [pitch] = scene.select(Polyline, Role.PITCH)
        start, end = line_of(pitch)
        along = (end - start) / abs(end - start)
        foot = (z(pinion.centre) - start) * along.conjugate()
        assert abs(foot.imag) == pytest.approx(pinion.radius)
        sliding = position_of(name, value).skeleton.guides[0].point
        assert start.imag == pytest.approx(place(position_of(name, value), sliding).imag)
        assert 0 < foot.real < abs(end - start)


def test_a_rack_moves_with_its_slider() -> None:
    ends = {}
    for value in (10, 150):
        [rack] = scene_at("rack-and-pinion", value).select(Polygon, Role.WHEEL, "rack")
        ends[value] = line_of(rack).real.max() - position_of("rack-and-pinion", value)["s"]
    assert ends[10] == pytest.approx(ends[150])


@pytest.mark.parametrize(
    ("name", "curve", "point"), [("curved-slot", "slot", "B"), ("garage-door", "track", "H")]
)
def test_a_pin_runs_in_the_middle_of_its_slot(name: str, curve: str, point: str) -> None:
    motion = motion_of(name)
    for row in (5, 40, 90):
        value = float(next(iter(motion.inputs.values()))[row])
        scene = scene_at(name, value)
        edge = line_of(scene.select(Polyline, Role.GROUND, curve)[0])[:-1]
        pin = place(position_of(name, value), point)
        assert inside(pin, edge)
        width = scene.measures.slot
        assert distance_to_line(pin, edge) == pytest.approx(width, rel=0.01)
        [contour] = position_of(name, value).skeleton.of(Contour)
        length = float(np.abs(np.diff(contour.points)).sum())
        area = abs(float((edge.conj() * np.roll(edge, -1)).imag.sum()) / 2)
        assert area == pytest.approx(2 * width * length + math.pi * width**2, rel=0.01)


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_picture_holds_everything_and_reach_holds_the_whole_motion(name: str) -> None:
    motion = motion_of(name)
    reach = reach_of(motion)
    slack = 1e-3 * max(reach.width, reach.height)  # outlines are followed at 90 places
    for value in next(iter(motion.inputs.values()))[motion.found][:: len(motion.found) // 4]:
        position = position_of(name, None if len(motion.inputs) > 1 else float(value))
        scene = scene_of(position, motion)
        skeleton, box = position.skeleton, scene.within
        pose = Pose.of(position, None)
        outermost = [
            place(position, disc.center) + disc.radius * 1j**k
            for disc in skeleton.of(Wheel)
            for k in range(4)
        ]
        outermost += [z for contour in skeleton.of(Contour) for z in pose.placed(contour)]
        assert outermost
        for point in outermost:
            assert box.grown(1e-9).distance((point.real, point.imag)) == 0
            assert reach.grown(slack).distance((point.real, point.imag)) == 0


@pytest.mark.parametrize(
    "name", ["planetary-gear", "belt-drive", "eccentric-cam", "planetary-differential"]
)
def test_an_input_wheel_of_one_point_has_its_arrow_around_its_centre(name: str) -> None:
    position = position_of(name, None)
    arrows = {arrow.of: arrow for arrow in scene_at(name).select(Arc, Role.INPUT)}
    for part in position.skeleton.driven:
        assert part.pivot is not None
        assert arrows[part.name].centre == position.points[part.pivot]
        assert (arrows[part.name].sweep < 0) is part.backwards
    if "ring" in arrows:
        assert arrows["ring"].radius > 60


def test_wheels_lie_below_pins_and_bear_the_tones_of_their_links() -> None:
    scene = scene_of(position_of("planetary-gear", 100), options=SceneOptions(link_names=True))
    layers = [p.role for p in scene.primitives]
    assert max(k for k, role in enumerate(layers) if role is Role.WHEEL) < layers.index(Role.LINK)
    tone = {p.of: p.tone for p in scene.primitives if p.role is Role.WHEEL}
    names = {p.of: p.tone for p in scene.primitives if p.role is Role.LINK_NAME}
    assert tone["sun"] == names["sun"] == 0
    assert tone["planet"] == names["planet"] != names["carrier"]


def test_faint_wheels_stand_at_their_further_positions() -> None:
    motion = motion_of("rolling-inside")
    scene = scene_of(position_of("rolling-inside", 0), motion, options=SceneOptions(further=6))
    faint = [d for d in scene.select(Disc, Role.WHEEL) if d.fade]
    assert len(faint) == 6
    for disc in faint:
        assert abs(z(disc.centre)) == pytest.approx(45)
        assert disc.radius == 15
    assert not [p for p in scene.primitives if p.fade and p.role in (Role.FRAME, Role.HATCH)]


def test_wheels_in_place_are_not_repeated_faintly() -> None:
    scene = scene_of(
        position_of("planetary-gear", 0),
        motion_of("planetary-gear"),
        options=SceneOptions(further=6),
    )
    faint = [p for p in scene.primitives if p.fade and p.role is Role.WHEEL]
    assert {p.of for p in faint} == {"planet"}
    assert len(faint) == 6
    assert all(isinstance(p, Disc) for p in faint)


def test_without_a_motion_the_picture_holds_the_line_to_roll_on() -> None:
    scene = scene_of(position_of("rolling-wheel", -90))
    [line] = scene.select(Polyline, Role.GROUND, "x")
    left, right = sorted(point[0] for point in line.points)
    assert left == pytest.approx(-32)  # 0.8 of the radius beyond the wheel
    assert right == pytest.approx(300)
    assert scene.within.right == right
    # What goes beyond are symbols, a few radii of a pin wide, and that margin.
    assert scene.box.left > scene.within.left - 5 * scene.measures.pin
    assert scene.box.right < scene.within.right + 5 * scene.measures.pin


@pytest.mark.parametrize(("name", "turn"), [("boxer-engine", 180.0), ("sun-and-planet", 0.0)])
def test_welded_links_have_their_corner_filled(name: str, turn: float) -> None:
    mechanism = lw.example(name)
    position = mechanism.solve()
    scene = mechanism.scene()
    (joint,) = mechanism.model.skeleton.of(RigidJoint)
    (corner,) = scene.select(Polygon, Role.WELD)
    assert corner.of == " ".join(joint.links)
    place, *arc = (complex(*xy) for xy in corner.points)
    assert place == pytest.approx(complex(*position.points[joint.point]))
    spread = math.degrees(abs(cmath.phase((arc[-1] - place) / (arc[0] - place))))
    assert spread == pytest.approx(turn or 50.0)


def test_links_that_are_welded_only_have_no_pin_there() -> None:
    text = """format = 1
[points]
O = [0, 0]
A = [10, 0]
B = [10, 8]
[links]
ground = ["O"]
arm = ["O", "A"]
hook = ["A", "B"]
[[welds]]
links = ["arm", "hook"]
[input]
link = "arm"
"""
    scene = lw.loads(text).scene()
    assert [disc.of for disc in scene.select(Disc, Role.PIN)] == ["O"]
    (corner,) = scene.select(Polygon, Role.WELD)
    start, end = (complex(*corner.points[k]) - 10 for k in (1, -1))
    assert {round(math.degrees(cmath.phase(z))) for z in (start, end)} == {180, 90}
