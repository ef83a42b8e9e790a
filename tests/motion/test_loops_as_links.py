"""Links and joints read off loop equations: the same as those the loops were written for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import linkwork as lw
from linkwork.mechanism.linkage import Linkage
from linkwork.motion.classifying.as_linkage import Seen, as_linkage
from tests.equations.linkages import LINKAGES
from tests.motion.dyad_linkages import dyad_linkage
from tests.motion.written_loops import as_loops

_HIGHER = ("gears", "belts", "racks", "rolling", "cams", "curves", "welds")


def _all() -> dict[str, lw.Mechanism]:
    """Linkages of pins and slides, each input the angle or the length of one part."""
    made = {name: lw.example(name) for name in lw.examples()}
    made |= {name: make() for name, make in LINKAGES.items()}
    return {
        name: mechanism
        for name, mechanism in made.items()
        if isinstance(mechanism.description, Linkage)
        and not any(getattr(mechanism.description, kind) for kind in _HIGHER)
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


@pytest.mark.parametrize("name", ALL.keys() - {"kempe-translator"})
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


SEVEN = [name for name in lw.examples() if lw.example(name).check().form == "loops"]


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
    for point in shared:
        for one, other in zip(asked.points[point], found.points[point], strict=True):
            gap = np.abs(np.asarray(one) - np.asarray(other))[asked.found]
            assert gap.max() < 1e-9 * size, point
