"""Links and joints read off loop equations: the same as those the loops were written for."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

import linkwork as lw
from linkwork.circuits.classification import as_linkage
from linkwork.circuits.reading_loops import Seen
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops
from tests.core.equations.linkages import LINKAGES
from tests.core.motion.dyad_linkages import dyad_linkage
from tests.core.motion.written_loops import as_loops
from tests.library_mechanisms import read_example

_HIGHER = ("gears", "noncircular_gears", "belts", "racks", "rolling", "cams", "curves", "welds")


def _all() -> dict[str, lw.Mechanism]:
    """Linkages of pins and slides, each input the angle or the length of one part."""
    made = {name: read_example(name) for name in lw.examples()}
    made |= {name: make() for name, make in LINKAGES.items()}
    return {
        name: mechanism
        for name, mechanism in made.items()
        if isinstance(mechanism.description, Linkage)
        and not any(getattr(mechanism.description, kind) for kind in _HIGHER)
        and mechanism.loop_equations.loops
        and not mechanism.loop_equations.linear
        and not mechanism.loop_equations.redundant
    }


ALL = _all()


#: Names that tell which of two links that slide on each other is the block: loops do not.
ONE_OF = {"oscillating cylinder": "crank shaper", "rotary cylinder": "Whitworth quick return"}


def _said(mechanism: lw.Mechanism) -> dict[str, object]:
    """Everything that does not depend on names of links."""
    report = mechanism.check()
    found = report.classification
    assert found is not None, report.unclassified
    loop = found.loop
    told: object = None
    if loop is not None:
        told = (ONE_OF.get(loop.name, loop.name), loop.barker, loop.grashof, loop.turns_fully)
    return {
        "mobility": (report.mobility_count, report.mobility_rank),
        "chain": found.chain,
        "inversion": found.inversion,
        "links": found.links,
        "class": found.class_number,
        "groups": sorted(group.text for group in found.groups),
        "blocks": sorted("" if b.group is None else b.group.text for b in report.blocks),
        "loop": told,
        "margin": None if loop is None else pytest.approx(loop.margin, abs=1e-9),
    }


#: Its two multiple pins are where its loops touch at one link only, which no equation tells.
UNTOLD = {"kempe-translator"}


@pytest.mark.parametrize("name", sorted(ALL.keys() - UNTOLD))
def test_loops_are_classified_as_the_linkage_that_they_are_written_for(name: str) -> None:
    assert _said(as_loops(ALL[name])) == _said(ALL[name])
    assert _said(as_loops(ALL[name], seed=len(name), drawn=True)) == _said(ALL[name])


@given(st.integers(0, 10**6), st.booleans())
def test_loops_of_random_dyads_are_classified_as_their_linkage(seed: int, drawn: bool) -> None:
    linkage = dyad_linkage(seed)
    assert _said(as_loops(linkage, seed=seed, drawn=drawn)) == _said(linkage)


PAIRS = [
    ("rapier-drive", "rapier-drive-links"),
    ("rapier-drive-limited", "rapier-drive-limited-links"),
    ("crank-slider", "slider-crank"),
]


@pytest.mark.parametrize(("loops", "links"), PAIRS)
def test_one_mechanism_is_called_the_same_by_loops_and_by_links(loops: str, links: str) -> None:
    """Links have the file's names in both, so that even the names of groups agree."""
    one, other = (lw.example(name).check() for name in (loops, links))
    assert one.classification is not None
    assert other.classification is not None
    groups = [
        [replace(group, links=tuple(sorted(group.links))) for group in report.classification.groups]
        for report in (one, other)
        if report.classification is not None
    ]
    assert groups[0] == groups[1]
    assert replace(one.classification, groups=()) == replace(other.classification, groups=())
    assert (one.links, one.joints) == (other.links, other.joints)


def test_the_double_four_bar_is_called_as_by_points_and_links() -> None:
    drawn = lw.linkage(
        points={
            "O1": (0, 0), "O3": (100, 0), "O5": (230, 0), "A": (34.64, 20), "B": (145.6, 65.7),
            "C": (115.3, 58), "D": (220.7, 89.5),
        },
        links={
            "ground": ("O1", "O3", "O5"), "link1": ("O1", "A"), "link2": ("A", "B"),
            "link3": ("O3", "B", "C"), "link4": ("C", "D"), "link5": ("O5", "D"),
        },
        lengths={"O1 A": 40, "A B": 120, "O3 B": 80, "O3 C": 60, "C D": 110, "O5 D": 90},
        angles={"B O3 C": 20},
        inputs=lw.Input(link="link1"),
    )  # fmt: skip
    one, other = lw.example("double-four-bar").check(), drawn.check()
    assert one.classification is not None
    assert one.classification == other.classification


SEVEN = [name for name in lw.examples() if isinstance(read_example(name).description, Loops)]


@pytest.mark.parametrize("name", SEVEN)
def test_what_is_read_off_loops_moves_as_they_do(name: str) -> None:
    """Every point that both have is at the same place in every row."""
    mechanism = lw.example(name)
    seen = as_linkage(mechanism.model)
    assert isinstance(seen, Seen)
    assert not seen.loose
    asked, found = mechanism.sweep(), lw.Mechanism(seen.linkage).sweep()
    shared = asked.points.keys() & found.points.keys()
    assert len(shared) >= 3
    assert (asked.found == found.found).all()
    size = mechanism.loop_equations.length_scale
    for column in [f"{point}.{axis}" for point in shared for axis in "xy"]:
        gap = np.abs(np.subtract(asked[column], found[column]))[asked.found]
        assert gap.max() < 1e-9 * size, column


def _loops(*equations: str, unknowns: str, driven: str, **what: Any) -> lw.Mechanism:
    """Loops with links 1 to 5 long; angles and lengths are told apart by where they stand."""
    numbers = {"a": 1, "b": 4, "c": 3, "d": 3.5, "g": 2}
    guess = dict.fromkeys([*unknowns.split(), driven], 1.0)
    return lw.loops(
        dimensions=numbers,
        angle="rad",
        loops={f"L{k}": text for k, text in enumerate(equations, 1)},
        guess=guess,
        inputs=lw.Input(variable=driven, from_=0.5, to=1.0, step=0.1),
        **what,
    )


def _four_bar(text: str, **what: object) -> lw.Mechanism:
    return _loops(text, unknowns="θ3 θ4", driven="θ2", **what)


@pytest.mark.parametrize(
    "text",
    [
        "a*e^(i*θ2) + b*e^(i*θ3) - c*e^(i*θ4) - d = 0",
        "a*e^(i*θ2) + b*e^(i*θ3) = d + c*e^(i*θ4)",
        "a*e^(i*θ2) + b*e^(i*θ3) = c*e^(i*θ4) + d",
        "d + c*e^(i*θ4) = a*e^(i*θ2) + b*e^(i*θ3)",
        "-d - i + a*e^(i*θ2) + b*e^(i*θ3) + i = c*e^(i*θ4)",
        "0 = d - a*e^(i*θ2) - b*e^(i*θ3) + c*e^(i*θ4)",
    ],
)
def test_a_four_bar_is_read_whatever_side_its_vectors_stand_on(text: str) -> None:
    found = _four_bar(text).check().classification
    assert found is not None
    assert found.loop is not None
    assert found.loop.links == ("ground", "link_θ2", "link_θ3", "link_θ4")
    assert (found.loop.barker, found.class_number) == ("GCRR", 2)


@pytest.mark.parametrize(
    ("points", "coupler"),
    [
        ({}, "link_θ3"),
        ({"O": "0", "A": "b*e^(i*θ3)", "B": "d + c*e^(i*θ4)", "C": "d"}, "link_θ2"),
    ],
)
def test_points_of_the_file_tell_which_vectors_meet(points: dict[str, str], coupler: str) -> None:
    """The input is taken to drive a joint at ground, unless the pins are elsewhere."""
    mechanism = _four_bar("b*e^(i*θ3) + a*e^(i*θ2) = d + c*e^(i*θ4)", points=points)
    found = mechanism.check().classification
    assert found is not None
    assert found.loop is not None
    assert found.loop.links[2] == coupler


@pytest.mark.parametrize(
    ("mechanism", "chain", "kind"),
    [
        (
            _loops("x = i*y + b*e^(i*θ)", unknowns="x y", driven="θ"),
            "double-slider chain (RRPP)",
            "elliptic trammel",
        ),
        (
            _loops("b*e^(i*θ) = x + i*y", unknowns="x y", driven="θ"),
            "double-slider chain (RRPP)",
            "Scotch yoke",
        ),
        (
            _loops("a*e^(i*θ2) = i*c + s*e^(i*θ4)", unknowns="s θ4", driven="θ2"),
            "slider-crank chain (RRRP)",
            "crank shaper: the driven link turns fully",
        ),
        (
            _loops("c*e^(i*θ2) = i*a + s*e^(i*θ4)", unknowns="s θ4", driven="θ2"),
            "slider-crank chain (RRRP)",
            "Whitworth quick return: the driven link turns fully",
        ),
        (
            _loops("a*e^(i*θ2) + b*e^(i*(θ2 + φ)) = d + c*e^(i*θ4)", unknowns="θ2 θ4", driven="φ"),
            "four-bar chain",
            "crank-rocker: Grashof",
        ),
    ],
)
def test_textbook_equations_are_called_by_their_names(
    mechanism: lw.Mechanism, chain: str, kind: str
) -> None:
    found = mechanism.check().classification
    assert found is not None
    assert found.chain == chain
    assert found.type.startswith(kind)


@pytest.mark.parametrize(
    ("mechanism", "why"),
    [
        (
            _loops(
                "a*e^(i*θ2) + b*e^(i*θ3) = d + c*e^(i*θ4) + g*e^(2*i*θ2)",
                unknowns="θ3 θ4",
                driven="θ2",
            ),
            "the angles of its vectors depend on each other, as for gears",
        ),
        (
            _loops(
                "a*e^(i*θ2) + b*e^(i*θ3) = s",
                "g*e^(i*θ2) + b*e^(i*θ4) = 2*s + i*x",
                unknowns="θ3 θ4 s x",
                driven="θ2",
            ),
            '"s" is a length in two directions or scales',
        ),
        (
            _loops("a*e^(i*θ2) + b*e^(i*θ3) = c*e^(i*θ4)", unknowns="θ3 θ4", driven="θ2"),
            "no vector keeps its direction, so that no link is fixed",
        ),
    ],
)
def test_loops_that_show_no_links_say_why(mechanism: lw.Mechanism, why: str) -> None:
    report = mechanism.check()
    assert report.classification is None
    assert report.unclassified == report.to_dict()["unclassified"] == why
    assert (report.links, report.joints, report.mobility_count) == (0, 0, None)


def test_loops_without_a_common_link_are_not_counted_as_one_mechanism() -> None:
    report = lw.loops(
        loops={
            "one": "e^(i*θ2) + 4*e^(i*θ3) = 3.5 + 3*e^(i*θ4)",
            "other": "e^(i*θ5) + 2*e^(i*θ6) = 2*e^(i*θ7)",
        },
        guess={"θ2": 60, "θ3": 20, "θ4": 80, "θ5": 0, "θ6": 100, "θ7": 75},
        inputs=[lw.Input(variable="θ2"), lw.Input(variable="θ5")],
    ).check()
    assert (
        report.unclassified == "the equations do not determine which pins of its loops are the same"
    )


def test_an_input_is_counted_from_the_links_own_direction() -> None:
    """The driven vector stands across the crank: the crank is 90° ahead, and moves alike."""
    points = {"O": "0", "A": "i*a*e^(i*θ2)", "B": "d + c*e^(i*θ4)", "C": "d"}
    links = {"crank": ["O", "A"], "coupler": ["A", "B"], "rocker": ["C", "B"]}
    mechanism = _four_bar("i*a*e^(i*θ2) + b*e^(i*θ3) = d + c*e^(i*θ4)", points=points, links=links)
    seen = as_linkage(mechanism.model)
    assert isinstance(seen, Seen)
    asked, found = mechanism.sweep(), lw.Mechanism(seen.linkage).sweep()
    np.testing.assert_allclose(found["crank"], asked["θ2"] + np.pi / 2, rtol=1e-12)
    for column in ("A.x", "A.y", "B.x", "B.y"):
        np.testing.assert_allclose(found[column], asked[column], rtol=0, atol=1e-11)


def test_loops_are_inverted_as_the_links_that_they_are() -> None:
    loops, links = (lw.example(name) for name in PAIRS[0])
    assert {(e.ground, e.type) for e in lw.circuits.inversions(loops)} == {
        (e.ground, e.type) for e in lw.circuits.inversions(links)
    }
    one, other = (mechanism.inversion("rocker").sweep() for mechanism in (loops, links))
    np.testing.assert_allclose(one["frame"], other["frame"], atol=1e-9)


def test_pins_of_loops_that_share_one_link_only_are_not_made_up() -> None:
    """Where on the boom the stick's loop begins is in no equation: the chain does not need it."""
    excavator = as_loops(lw.example("excavator"))
    seen = as_linkage(excavator.model)
    assert isinstance(seen, Seen)
    assert seen.loose
    with pytest.raises(lw.InputError, match=r"do not determine where on .* they are joined"):
        excavator.inversion(seen.loose[0])
