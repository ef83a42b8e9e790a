"""Inversion: the relative motion of the links is the same, whichever of them stands still."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits.inverted_linkage import inverted
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.mechanism.linkage import Linkage
from tests.core.laws.contacts import KINDS, contact
from tests.core.laws.mechanisms import NAMES, mechanism_of, motion_of, size_of
from tests.described import described_as
from tests.thinned import thinned

CYLINDER = "is part of a cylinder: write it as two links with a slider"
#: Stops are bounds on the ground that is there: an inversion refuses them.
LINKED = tuple(
    name
    for name in NAMES
    if isinstance(own := mechanism_of(name).description, Linkage) and not own.stops
)


linkage_of = partial(described_as, Linkage)


def _seen_from(motion: lw.Motion, link: tuple[str, ...], point: str) -> ComplexArray:
    """A point in the frame of a link's first two points, over the table's rows that are found."""
    rows = motion.asked & motion.found
    if len(link) < 2:  # a ground
        return motion.trace(point)[rows] - motion.trace(link[0])[rows]
    origin, tip = motion.trace(link[0])[rows], motion.trace(link[1])[rows]
    along = (tip - origin) / np.abs(tip - origin)
    return (motion.trace(point)[rows] - origin) / along


@cache
def _contact(kind: str) -> tuple[lw.Mechanism, lw.Motion]:
    """A mechanism with a weld, gear, cam ... whose unknowns are its outputs too, and its motion."""
    mechanism = contact(kind, 1)
    wheels = [name for name in linkage_of(mechanism).links if name != "ground"]
    found = lw.Mechanism(
        replace(mechanism.description, outputs={f"{name}_seen": name for name in wheels})
    )
    return found, found.sweep(certify=False)


@pytest.mark.parametrize("kind", KINDS)
def test_wheels_cams_and_curves_move_alike_whatever_is_ground(kind: str) -> None:
    """Every body as ground: points, turns against the old ground, displacements as before."""
    mechanism, motion = _contact(kind)
    assert motion.found.all()
    widest = max(linkage_of(mechanism).links.values(), key=len)
    others = [entry for entry in lw.circuits.inversions(mechanism) if entry.ground != "ground"]
    assert [entry.problem for entry in others] == [""] * len(others)
    for entry in others:
        other = mechanism.inversion(entry.ground).sweep(certify=False)
        assert other.found.all()
        for point in linkage_of(mechanism).points:
            before = _seen_from(motion, widest, point)
            after = _seen_from(other, widest, point)
            np.testing.assert_allclose(after, before, rtol=0, atol=1e-11 * size_of(mechanism))
        for output in mechanism.description.outputs:
            turns = np.exp(1j * np.radians(other[output] - motion[output]))
            np.testing.assert_allclose(turns, 1.0, rtol=0, atol=1e-11)
        for slide in linkage_of(mechanism).sliders:
            np.testing.assert_allclose(
                other[slide.name], motion[slide.name], rtol=0, atol=1e-11 * size_of(mechanism)
            )


@pytest.mark.parametrize("name", thinned(LINKED, 8))
def test_an_inversion_has_the_same_relative_motion(name: str) -> None:
    mechanism, motion = mechanism_of(name), motion_of(name)
    links = linkage_of(mechanism).links
    widest = max(links.values(), key=len)
    for entry in lw.circuits.inversions(mechanism):
        if entry.ground == "ground":
            continue
        if entry.problem:
            assert entry.problem.endswith(CYLINDER)
            continue
        other = mechanism.inversion(entry.ground).sweep(certify=False)
        found = motion.found[motion.asked]
        np.testing.assert_array_equal(found, other.found[other.asked])
        for point in linkage_of(mechanism).points:
            before = _seen_from(motion, widest, point)
            after = _seen_from(other, widest, point)
            # 1e-12 of the longest link: both are solved to rounding, and Jansen's leg adds up
            np.testing.assert_allclose(after, before, rtol=0, atol=1e-12 * size_of(mechanism))
        for output in mechanism.description.outputs:
            early = motion[output][motion.asked][found]
            late = other[output][other.asked][found]
            turns = (late - early + 180) % 360 - 180 if output == "mu" else late - early
            size = 1 + np.max(np.abs(early))
            np.testing.assert_allclose(turns, 0, atol=1e-12 * size)


@pytest.mark.parametrize("name", thinned(LINKED))
def test_the_inversion_of_an_inversion_is_the_mechanism(name: str) -> None:
    """Back on the old ground, every point moves as before but for where the axes are."""
    mechanism, motion = mechanism_of(name), motion_of(name)
    # formulas grow with every change of ground
    mechanism = lw.Mechanism(replace(mechanism.description, outputs={}))
    ground = linkage_of(mechanism).links["ground"]
    entry = next(
        e for e in lw.circuits.inversions(mechanism) if e.ground != "ground" and not e.problem
    )
    again = mechanism.inversion(entry.ground).inversion("frame")
    back, back_ground = again.sweep(certify=False), linkage_of(again).links["ground"]
    for point in linkage_of(mechanism).points:
        before = _seen_from(motion, ground, point)
        after = _seen_from(back, back_ground, point)
        np.testing.assert_allclose(after, before, rtol=0, atol=1e-12 * size_of(mechanism))


def test_the_new_ground_is_exact_and_keeps_its_formula() -> None:
    shaper = lw.example("inverted-slider-crank")
    whitworth = shaper.inversion("crank")
    assert linkage_of(whitworth).links == {
        "ground": ("O2", "A"),
        "frame": ("O2", "O4"),
        "lever": ("O4", "Q"),
    }
    assert linkage_of(whitworth).points["A"] == ("r", 0.0)
    assert linkage_of(whitworth).lengths["O2 O4"] == "d"
    wider = whitworth.with_dimensions(r=150).solve(at=40)
    known = shaper.with_dimensions(r=150).solve(at=-90 - 40)
    assert wider["s"] == pytest.approx(known["s"], rel=1e-13)


def test_ground_formulas_stay_formulas_in_the_old_ground() -> None:
    bar = lw.linkage(
        dimensions={"d": 3, "h": 0.5},
        points={"O": (0, "h"), "C": ("d", 0), "F": ("2*d", "h"), "A": (0, 1.5), "B": (3, 2)},
        links={"ground": ("O", "C", "F"), "a": ("O", "A"), "b": ("A", "B"), "c": ("C", "B")},
        lengths={"O A": 1, "A B": 3, "C B": 2},
        inputs=lw.Input(link="a"),
    )
    for changed in (bar, bar.with_dimensions(d=3.2, h=0.3)):
        fixed = changed.solve(at=70)
        turn = np.degrees(
            np.arctan2(-changed.description.numbers("h"), changed.description.numbers("d"))
        )
        inverted_bar = bar.inversion("b").with_dimensions(**changed.description.dimensions)
        other = inverted_bar.solve(at=70 - turn)
        for one, two in (("O", "F"), ("C", "F"), ("A", "F"), ("A", "C")):
            assert _gap(other, one, two) == pytest.approx(_gap(fixed, one, two), rel=1e-12)


def test_an_angle_against_ground_keeps_its_value_as_output() -> None:
    """The old ground's first two points lie on a slope of 20 deg."""
    slope = np.exp(1j * math.radians(20))
    places = {"O": 0j, "C": 3 * slope, "A": 1j, "B": 2.5 + 2.4j}
    bar = lw.linkage(
        points={name: (z.real, z.imag) for name, z in places.items()},
        links={"ground": ("O", "C"), "a": ("O", "A"), "b": ("A", "B"), "c": ("C", "B")},
        inputs=lw.Input(link="a"),
        outputs={"turned": "b", "still": "2*c"},
    )
    fixed = bar.solve(at=70)
    for ground in ("a", "b"):
        other = bar.inversion(ground).solve(at=20 - 70 if ground == "a" else 70 - 20)
        for output, turn in (("turned", 360), ("still", 720)):
            assert math.remainder(other[output] - fixed[output], turn) == pytest.approx(
                0, abs=1e-11
            )


def test_measured_lengths_are_written_down() -> None:
    """An assembled position is the new sketch: nothing is measured in it again."""
    bar = mechanism_of("link against link")
    wanted = {" ".join(entry.points): entry.length for entry in linkage_of(bar).shapes.measured}
    assert list(wanted) == ["A P", "B P"]
    turned = linkage_of(bar.inversion("rocker"))
    named = linkage_of(bar.changed(configuration="open").driven_by(link="crank"))
    for other in (turned, named):
        assert other.shapes.measured == ()
        assert {key: other.lengths[key] for key in wanted} == wanted


def _gap(position: lw.Position, one: str, two: str) -> float:
    return float(np.hypot(*np.subtract(position.points[one], position.points[two])))


def test_a_driven_link_that_becomes_ground_is_driven_against_the_other_way_round() -> None:
    bar = lw.example("four-bar")
    fixed = bar.inversion("crank").description
    turned = lw.Input(link="frame", from_=0, to=-360, step=-1, speed=-math.degrees(25))
    assert fixed.inputs == (turned,)
    assert bar.inversion("coupler").description.inputs == (
        lw.Input(link="crank", relative_to="frame", from_=0, to=360, step=1, speed="25 rad/s"),
    )
    chosen = bar.inversion("crank", input=lw.Input(link="coupler", from_=0, to=10))
    assert chosen.description.inputs == (lw.Input(link="coupler", from_=0, to=10),)


def test_a_sliding_block_as_ground_keeps_the_displacement() -> None:
    crank = lw.example("slider-crank")
    pump = crank.inversion("block")
    for at in (0, 50, 200):  # the frame's angle is that of O2 S, which points down
        assert pump.solve(at=at + 90)["d"] == pytest.approx(crank.solve(at=at)["d"], rel=1e-12)


def test_the_ground_itself_changes_nothing_but_the_input() -> None:
    bar = lw.example("four-bar")
    assert bar.inversion("ground") == bar
    other = lw.Input(link="rocker")
    assert bar.inversion("ground", input=other) == bar.changed(inputs=other)


def test_all_inversions_are_listed_with_their_names() -> None:
    told = [entry.text for entry in lw.circuits.inversions(lw.example("four-bar"))]
    assert told == [
        "ground: crank-rocker (GCRR): Grashof, s + l < p + q by 20 mm",
        "crank: double-crank (GCCC): Grashof, s + l < p + q by 20 mm",
        "coupler: crank-rocker: Grashof, s + l < p + q by 20 mm",
        "rocker: double-rocker: Grashof, s + l < p + q by 20 mm",
    ]
    shaper = lw.circuits.inversions(lw.example("inverted-slider-crank"))
    assert [entry.like for entry in shaper] == ["ground", "ground", "lever"]
    six = lw.circuits.inversions(lw.example("stephenson-far-crank"))
    assert [(entry.ground, entry.type, entry.like) for entry in six] == [
        ("ground", "Stephenson III", "ground"),
        ("left", "Stephenson I", "left"),
        ("coupler", "Stephenson III", "ground"),
        ("right", "Stephenson I", "left"),
        ("rod", "Stephenson II", "rod"),
        ("crank", "Stephenson II", "rod"),
    ]


def test_a_cylinder_is_listed_with_the_reason_why_it_cannot_be_ground() -> None:
    *_, last = lw.circuits.inversions(mechanism_of("cylinder as input"))
    assert last.text == (
        "ram rod: ram rod is part of a cylinder: write it as two links with a slider"
    )


def test_what_cannot_be_inverted_is_refused_with_the_reason() -> None:
    boom = mechanism_of("cylinder as input")
    refused = [
        (
            boom,
            "ram",
            '"ram" is a cylinder, whose length varies: it cannot be ground. '
            "Write it as two links with a slider",
        ),
        (
            lw.example("four-bar"),
            "rockr",
            '"rockr" is not a link of Four-bar linkage, open '
            "(links: rocker, ground, crank, coupler)",
        ),
        (
            lw.example("newton-extremum"),
            "crank",
            "Newton-Raphson starting at a local extremum is given by equations, and cannot be "
            "inverted without links and joints: plain equations do not determine links and joints",
        ),
    ]
    for mechanism, link, message in refused:
        with pytest.raises(lw.InputError, match=f"^{re.escape(message)}$"):
            mechanism.inversion(link)


def test_a_ground_of_one_point_gets_a_mark_that_shows_its_direction() -> None:
    lever = lw.linkage(
        points={"O": (2, 3), "A": (3, 3)},
        links={"ground": ("O",), "lever": ("O", "A")},
        inputs=lw.Input(link="lever"),
    )
    turned = lever.inversion("lever")
    assert linkage_of(turned).links == {"ground": ("O", "A"), "frame": ("O", "ground_mark")}
    position = turned.solve(at=-30)
    assert position.points["ground_mark"] == pytest.approx(
        (math.cos(math.radians(30)), -math.sin(math.radians(30))), abs=1e-15
    )


def test_a_wheel_of_one_point_as_ground_keeps_the_ratio_of_teeth() -> None:
    """Sun fixed: the carrier turns by 1 / (1 + ring / sun) of the ring."""
    gears = lw.example("planetary-gear")
    fixed = linkage_of(gears.inversion("sun"))
    assert fixed.links["ground"] == ("O", "sun_mark")
    before, after = gears.sweep(), gears.inversion("sun").sweep()
    turn = before["carrier"] - before["sun"]
    np.testing.assert_allclose(
        after["carrier"] - after["carrier"][0], turn - turn[0], rtol=0, atol=1e-9
    )


def test_a_table_that_an_inversion_does_not_know_is_refused() -> None:
    @dataclass(frozen=True, kw_only=True)
    class Noted(Linkage):
        notes: tuple[str, ...] = ()

    bar = lw.example("four-bar").description
    parts = {name: getattr(bar, name) for name in ("points", "links", "lengths", "inputs")}
    noted = Noted(name="Noted bar", notes=("weight",), **parts)
    places = {point: noted.sketched(point) for point in noted.points}
    with pytest.raises(
        lw.InputError,
        match=r"^an inversion of Noted bar cannot move \[notes\] to another ground: "
        r"remove it, or write the inversion by hand$",
    ):
        inverted(noted, "crank", places)


def test_another_input_by_one_call() -> None:
    bar = lw.example("four-bar")
    position = bar.solve(at=60)
    other = bar.driven_by(link="rocker", from_=80, to=100)
    assert [v.name for v in other.loop_equations.inputs] == ["rocker"]
    assert other.solve(at=position["rocker"])["crank"] == pytest.approx(60, abs=1e-10)
    loops = lw.example("crank-slider").driven_by(variable="d", from_=120, to=130, step=1)
    assert loops.solve(at=125)["d"] == 125


def test_another_input_starts_from_the_named_configuration_without_naming_it() -> None:
    """Names of configurations belong to an input: open by the crank, crossed by the rocker."""
    for name in ("four-bar", "crank-slider"):
        bar = lw.example(name)
        crossed = bar.changed(configuration="crossed")
        start = crossed.solve()
        unknown = next(iter(start.unknowns))
        again = crossed.driven_by(
            **({"link": unknown} if name == "four-bar" else {"variable": unknown})
        )
        assert again.description.configuration == ""
        (held,) = start.input
        assert again.solve()[held] == pytest.approx(start[held], rel=1e-10)
        assert again.solve()[unknown] == pytest.approx(start[unknown], rel=1e-10)
