"""Arrows of rates, speeds by colour, instant centres and dimensions say what the motion says."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

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
    Text,
    scene_of,
)
from linkwork.core.drawing.annotations import LONGEST, SCALES, Force, usual_most
from linkwork.core.drawing.scene import round_up
from linkwork.core.foundation.errors import InputError
from tests.core.drawing.shared_area import shared_area

NAMES = ["four-bar", "jansen-leg", "slider-crank", "crank-shaper", "planetary-gear"]
_CACHE: dict[str, tuple[lw.Position, lw.Motion]] = {}


def moved(name: str) -> tuple[lw.Position, lw.Motion]:
    if name not in _CACHE:
        mechanism = lw.example(name)
        _CACHE[name] = mechanism.solve(), mechanism.sweep()
    return _CACHE[name]


def drawn(name: str, traces: Sequence[str] | None = None, **options: Any) -> Scene:
    return scene_of(*moved(name), traces=traces, options=SceneOptions(**options))


def vectors(scene: Scene, role: Role) -> dict[str, complex]:
    return {
        p.of: complex(*p.points[1]) - complex(*p.points[0]) for p in scene.select(Polyline, role)
    }


def scale_of(caption: str, word: str) -> float:
    """Length units per unit of the rate, as the caption has it."""
    found = re.search(rf"{word} scale: ([\d.e+-]+) \w+ = ([\d.e+-]+) ", caption)
    assert found
    return float(found[1]) / float(found[2])


@pytest.mark.parametrize(
    ("role", "word"), [("VELOCITY", "velocity"), ("ACCELERATION", "acceleration")]
)
def test_an_arrow_is_the_rate_at_the_scale_of_the_caption(role: str, word: str) -> None:
    position, _ = moved("four-bar")
    scene = drawn("four-bar", velocities=True, accelerations=True)
    rates = position.velocity if role == "VELOCITY" else position.acceleration
    scale = scale_of(scene.caption, word)
    found = vectors(scene, Role[role])
    assert set(found) == {"A", "B"}
    for name, arrow in found.items():
        assert arrow == pytest.approx(scale * complex(rates[f"{name}.x"], rates[f"{name}.y"]))


def test_arrows_without_a_speed_are_by_the_input() -> None:
    position, _ = moved("slider-crank")
    scene = drawn("slider-crank", velocities=True)
    assert scene.caption.endswith(" mm/rad")
    velocity = complex(position.first["A.x"], position.first["A.y"])
    arrow = vectors(scene, Role.VELOCITY)["A"]
    assert arrow == pytest.approx(scale_of(scene.caption, "velocity") * velocity)


@pytest.mark.parametrize("name", NAMES)
def test_the_longest_arrow_of_a_motion_is_at_most_the_stated_share_of_the_picture(
    name: str,
) -> None:
    position, motion = moved(name)
    scene = drawn(name, velocities=True)
    scale = scale_of(scene.caption, "velocity")
    rate = "velocity" if motion.speed else "d1"
    free = [p for p in position.points if p not in position.skeleton.fixed]
    most = max(np.nanmax(np.abs(motion.trace(f"{p}.{rate}"))) for p in free)
    assert LONGEST / 1.51 <= scale * most / scene.measures.size <= LONGEST * (1 + 1e-9)


def test_forces_are_arrows_at_their_points_at_the_scale_of_the_caption() -> None:
    forces = (Force(at="B", x=-40.0, y=0.0, unit="N"), Force(at="A", x=3.0, y=-15.0, unit="N"))
    position, _ = moved("slider-crank")
    scene = drawn("slider-crank", forces=forces)
    assert scene.caption.endswith(" N")
    found, scale = vectors(scene, Role.FORCE), scale_of(scene.caption, "force")
    assert found == pytest.approx({f.at: scale * complex(f.x, f.y) for f in forces})
    for arrow in scene.select(Polyline, Role.FORCE):
        assert arrow.points[0] == pytest.approx(position.points[arrow.of])
    assert LONGEST / 1.51 <= scale * 40.0 / scene.measures.size <= LONGEST * (1 + 1e-9)
    assert {text.text for text in scene.select(Text, Role.FORCE_NAME)} == {"F(A)", "F(B)"}


def test_forces_at_one_point_are_drawn_one_by_one_and_small_ones_are_told() -> None:
    forces = [Force(at="B", x=10.0, y=0.0), Force(at="B", x=0.0, y=10.0)]
    scene = drawn("slider-crank", forces=(*forces, Force(at="A", x=0.01, y=0.0)))
    assert len(scene.select(Polyline, Role.FORCE)) == 2
    assert scene.caption.endswith("(too short to draw: A)")
    zero = drawn("slider-crank", forces=(Force(at="B", x=0.0, y=0.0),))
    assert zero.caption.endswith("force: all are zero")


@pytest.mark.parametrize(
    ("forces", "said"),
    [
        ([("Q", 1.0, "N")], 'there is no point "Q" for a force'),
        ([("A", 1.0, "N"), ("B", 1.0, "kN")], "need one unit, these have several: N, kN"),
        ([("A", np.inf, "N")], "the force at A is not finite: inf, 0"),
    ],
)
def test_forces_that_cannot_be_drawn_are_refused(
    forces: list[tuple[str, float, str]], said: str
) -> None:
    with pytest.raises(InputError, match=said):
        drawn("slider-crank", forces=tuple(Force(at=p, x=x, y=0.0, unit=u) for p, x, u in forces))


def test_points_that_stand_still_or_say_where_a_line_runs_have_no_arrow() -> None:
    found = vectors(drawn("slider-crank", velocities=True), Role.VELOCITY)
    assert set(found) == {"A", "B"}


def test_rates_beside_a_dead_point_do_not_set_the_scale() -> None:
    sizes = np.concatenate([np.linspace(1, 2, 99), [500.0]])
    assert usual_most(sizes) < 2.1
    assert usual_most(np.linspace(1, 2, 100)) == 2.0
    assert usual_most(np.array([np.nan])) == 0.0


def test_scales_are_short_numbers_not_below_what_is_wanted() -> None:
    for wanted in np.geomspace(1e-7, 1e7, 203).tolist():
        found = round_up(wanted, SCALES)
        assert wanted * (1 - 1e-9) <= found <= 1.51 * wanted
        assert float(f"{found:.1e}") == pytest.approx(found)


def test_a_position_without_finite_rates_has_no_arrows() -> None:
    position, _ = moved("four-bar")
    ended = replace(position, velocity=dict.fromkeys(position.velocity, np.nan))
    with pytest.raises(InputError, match=r"has no velocity to draw .*not that of A, B: the input"):
        scene_of(ended, options=SceneOptions(velocities=True))


def test_a_path_is_coloured_by_its_speed_from_end_to_end() -> None:
    _, motion = moved("jansen-leg")
    scene = drawn("jansen-leg", speed=True)
    pieces = scene.select(Polyline, Role.SPEED_TRACE, of="F")
    assert not scene.select(Polyline, Role.TRACE)
    assert sum(len(piece.points) - 1 for piece in pieces) == len(motion) - 1
    speeds = np.abs(motion.trace("F.d1"))
    path = motion.trace("F")
    for piece in pieces:
        k = int(np.argmin(np.abs(path - complex(*piece.points[0]))))
        share = (speeds[k] + speeds[min(k + 1, len(path) - 1)]) / 2 / speeds.max()
        assert piece.level == pytest.approx(share, abs=0.08)  # a class, and a neighbouring row
    assert len({piece.level for piece in pieces}) > 5


def test_the_colour_scale_stands_below_the_drawing_and_says_the_largest_speed() -> None:
    _, motion = moved("jansen-leg")
    scene = drawn("jansen-leg", speed=True)
    steps = scene.select(Polygon, Role.SCALE)
    levels = [step.level for step in sorted(steps, key=lambda step: step.points[0])]
    assert levels == sorted(levels)
    top = max(y for step in steps for _, y in step.points)
    others = [p for p in scene.primitives if p.role not in (Role.SCALE, Role.SCALE_NAME)]
    assert top < min(y for p in others for _, y in p.outline)
    said = " ".join(text.text for text in scene.select(Text, Role.SCALE_NAME))
    assert f"{np.abs(motion.trace('F.d1')).max():.3g} mm/rad  speed of F" in said


def test_speeds_need_a_motion_and_a_path() -> None:
    position, motion = moved("four-bar")
    with pytest.raises(InputError, match="speeds along a path cannot be drawn from one position"):
        scene_of(position, options=SceneOptions(speed=True))
    with pytest.raises(InputError, match="there is no path to colour by speed"):
        scene_of(position, motion, options=SceneOptions(speed=True))
    with pytest.raises(InputError, match="centrodes cannot be drawn from one position"):
        scene_of(position, options=SceneOptions(centrodes=("coupler",)))


def test_instant_centres_are_numbered_and_the_caption_says_which_links() -> None:
    position, _ = moved("slider-crank")
    scene = drawn("slider-crank", centres=True)
    assert "instant centres of links 1:ground, 2:crank, 3:rod, 4:block" in scene.caption
    assert scene.caption.endswith("1 further away; 1 at infinity")
    crosses = {p.of: sum(complex(*z) for z in p.strokes[0]) / 2
               for p in scene.select(Hatch, Role.CENTRE)}  # fmt: skip
    assert crosses["I₁₂"] == pytest.approx(0)
    assert crosses["I₃₄"] == pytest.approx(complex(*position.points["B"]))
    assert set(crosses) == {text.text for text in scene.select(Text, Role.CENTRE_NAME)}


def test_centres_in_one_place_share_a_name() -> None:
    """At P of the leg ground, 1, the upper triangle, 5, and the lower rocker, 6, are joined."""
    texts = drawn("jansen-leg", centres=True).select(Text, Role.CENTRE_NAME)
    assert "I₁₅ I₁₆ I₅₆" in {text.text for text in texts}


def test_centrodes_touch_at_the_instant_centre() -> None:
    position, _ = moved("four-bar")
    scene = drawn("four-bar", centrodes=("coupler",))
    o2, a, b, o4 = (complex(*position.points[name]) for name in ("O2", "A", "B", "O4"))
    # Where the lines of both cranks meet.
    pole = o2 + (a - o2) * _cross(o4 - o2, b - o4) / _cross(a - o2, b - o4)
    size = scene.measures.size
    for role in (Role.FIXED_CENTRODE, Role.MOVING_CENTRODE):
        points = [z for p in scene.select(Polyline, role, of="coupler") for z in p.points]
        places = np.array([complex(*z) for z in points])
        # A row of the motion lies within half a degree of the position.
        assert np.abs(places - pole).min() < 0.05 * size
    assert "centrodes of coupler: fixed solid, moving dashed" in scene.caption


def _cross(a: complex, b: complex) -> float:
    return (a.conjugate() * b).imag


def test_a_dimension_is_as_long_as_its_number() -> None:
    scene = drawn("four-bar", dimensions=True)
    texts = {text.of: text.text for text in scene.select(Text, Role.DIMENSION_NAME)}
    assert texts == {"crank": texts["crank"], "coupler": "120", "rocker": "80", "ground": "100"}
    numbers = [t.text for t in scene.select(Text, Role.DIMENSION_NAME) if t.of == "crank"]
    assert sorted(numbers) == ["30.029°", "40"]
    for link, length in (("coupler", 120), ("rocker", 80), ("ground", 100)):
        tips = [p.points[-1] for p in scene.select(Polyline, Role.DIMENSION, of=link)]
        assert abs(complex(*tips[0]) - complex(*tips[1])) == pytest.approx(length)


def test_the_angle_of_the_input_is_an_arc_of_its_size() -> None:
    [arc] = drawn("four-bar", dimensions=True).select(Arc, Role.DIMENSION)
    assert arc.start == pytest.approx(0, abs=1e-9)
    assert np.degrees(arc.sweep) == pytest.approx(moved("four-bar")[0].input["crank"])


def test_driven_lengths_and_radii_are_dimensions() -> None:
    texts = {t.text for t in drawn("excavator", dimensions=True).select(Text, Role.DIMENSION_NAME)}
    assert "boom_ram = 264.39" in texts
    scene = drawn("planetary-gear", dimensions=True)
    assert {"R 30", "R 15"} <= {t.text for t in scene.select(Text, Role.DIMENSION_NAME)}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    "shown", [{"velocities": True, "accelerations": True}, {"centres": True}, {"dimensions": True}]
)
def test_texts_cover_neither_each_other_nor_pins(name: str, shown: dict[str, Any]) -> None:
    scene = drawn(name, **shown)
    for one, other in combinations(scene.select(Text), 2):
        assert shared_area(one.box, other.box) == 0, (one.text, other.text)
    for disc in scene.select(Disc, Role.PIN):
        for text in scene.select(Text):
            assert text.box.distance(disc.centre) >= 0.99 * disc.radius, (text.text, disc.of)
