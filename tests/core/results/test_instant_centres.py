"""Instant centres obey Aronhold and Kennedy; centrodes roll on each other."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.results.link_motion import centrodes, instant_centres

MECHANISMS = [
    "four-bar",
    "slider-crank",
    "jansen-leg",
    "rapier-drive",
    "planetary-gear",
    "klann-leg",
]


def position_of(name: str) -> lw.Position:
    return lw.example(name).solve()


@pytest.mark.parametrize("name", MECHANISMS)
def test_the_three_centres_of_three_links_lie_in_one_line(name: str) -> None:
    position = position_of(name)
    found = {c.links: c.place for c in instant_centres(position)}
    links = list(dict.fromkeys(link for pair in found for link in pair))
    size = max(abs(complex(*place)) for place in position.points.values())
    seen = 0
    for trio in combinations(links, 3):
        places = [found.get(pair) for pair in combinations(trio, 2)]
        known = [place for place in places if place is not None]
        if len(known) < 3 or max(map(abs, known)) > 20 * size:
            continue
        a, b, c = known
        if min(abs(a - b), abs(b - c), abs(a - c)) < 1e-3 * size:
            continue  # two of them are one place: any third is in line
        # Rounding of velocities moves a centre by about 1e-12 of its distance.
        sine = ((b - a).conjugate() * (c - a)).imag / (abs(b - a) * abs(c - a))
        assert abs(sine) < 1e-7, trio
        seen += 1
    assert seen


@pytest.mark.parametrize("name", MECHANISMS)
def test_there_is_one_centre_for_every_pair_of_links(name: str) -> None:
    centres = instant_centres(position_of(name))
    links = {link for centre in centres for link in centre.links}
    assert len(centres) == len(links) * (len(links) - 1) // 2
    for centre in centres:
        assert (centre.place is None) != (centre.direction is None)


def test_the_coupler_of_a_four_bar_turns_about_where_its_cranks_meet() -> None:
    position = position_of("four-bar")
    o2, a, b, o4 = (complex(*position.points[name]) for name in ("O2", "A", "B", "O4"))
    [pole] = [c.place for c in instant_centres(position) if c.links == ("ground", "coupler")]
    assert pole is not None
    for pivot, pin in ((o2, a), (o4, b)):
        assert abs(((pin - pivot).conjugate() * (pole - pivot)).imag) < 1e-9 * abs(pole) ** 2


def test_pins_are_permanent_centres() -> None:
    position = position_of("four-bar")
    pins = {c.links: c.place for c in instant_centres(position) if c.permanent}
    assert len(pins) == 4
    assert pins["coupler", "rocker"] == complex(*position.points["B"])


def test_a_sliding_block_has_its_centre_at_infinity_across_its_rail() -> None:
    centres = instant_centres(position_of("slider-crank"))
    [centre] = [c for c in centres if c.links == ("ground", "block")]
    assert centre.place is None
    assert centre.direction is not None
    assert abs(centre.direction.real) < 1e-12
    assert not centre.permanent


def test_the_trammel_rolls_one_of_cardans_circles_in_the_other() -> None:
    """The rod of length l between the slots: a circle of radius l/2 inside one of radius l."""
    motion = lw.example("elliptic-trammel").sweep()
    found = centrodes(motion, "rod")
    a, b = motion.trace("A"), motion.trace("B")
    length = abs(b[0] - a[0])
    assert np.abs(np.abs(found.fixed) - length).max() < 1e-9 * length
    middle = (b[0] - a[0]) / 2 / np.exp(1j * np.radians(motion.links["rod"].value[0]))
    assert np.abs(np.abs(found.moving - middle) - length / 2).max() < 1e-9 * length


def test_centrodes_roll_without_slipping() -> None:
    """Between two positions both have the same length of arc."""
    motion = lw.example("four-bar").sweep(from_=40, to=100, step=0.1)
    found = centrodes(motion, "coupler")
    one, other = (np.abs(np.diff(path)) for path in (found.fixed, found.moving))
    # Chords differ from arcs by the third power of the step.
    np.testing.assert_allclose(one, other, rtol=1e-4)


def test_a_dead_point_has_no_instant_centres() -> None:
    position = position_of("four-bar")
    ended = replace(position, first=dict.fromkeys(position.first, np.nan))
    with pytest.raises(InputError, match="has no instant centres here: the rates of crank"):
        instant_centres(ended)


def test_ground_and_unknown_links_have_no_centrodes() -> None:
    motion = lw.example("four-bar").sweep(from_=0, to=10, step=5)
    with pytest.raises(InputError, match="the ground has no centrodes"):
        centrodes(motion, "ground")
    with pytest.raises(UnknownNameError, match='there is no link "arm" \\(links: ground, crank'):
        centrodes(motion, "arm")


def test_a_link_that_only_slides_has_no_centrodes() -> None:
    motion = lw.example("slider-crank").sweep(from_=0, to=10, step=5)
    with pytest.raises(InputError, match='"block" does not turn'):
        centrodes(motion, "block")


def test_equations_without_points_have_no_instant_centres() -> None:
    position = position_of("newton-convergence")
    with pytest.raises(InputError, match="has no links with points, so no instant centres"):
        instant_centres(position)


def test_rows_that_were_not_found_have_no_centre() -> None:
    motion = lw.example("rapier-drive-limited").sweep(certify=False)
    found = centrodes(motion, "lever")
    assert not motion.found.all()
    assert np.isnan(found.fixed[~motion.found]).all()
    assert np.isfinite(found.fixed[motion.found]).any()
