"""What a textbook says of the best-known mechanisms: mobility, chain, type, class.

R. L. Norton, Design of Machinery (chains and inversions, Barker's types, Grashof); I. I.
Artobolevskii, Theory of mechanisms and machines (Assur groups and their class).
"""

from __future__ import annotations

import pytest

import linkwork as lw

#: Name → mobility by count and by rank, chain, the beginning of the type, class.
TEXTBOOK = {
    "four-bar": (1, 1, "four-bar chain", "crank-rocker (GCRR): Grashof", 2),
    "parallelogram": (1, 1, "four-bar chain", "parallelogram (S2X): change point", 2),
    "antiparallelogram": (1, 1, "four-bar chain", "antiparallelogram (S2X): change point", 2),
    "galloway": (1, 1, "four-bar chain", "deltoid (S2X): change point", 2),
    "hoeken": (1, 1, "four-bar chain", "crank-rocker (GCRR): Grashof", 2),
    "chebyshev": (1, 1, "four-bar chain", "double-rocker (GRCR): Grashof", 2),
    "watt-linkage": (1, 1, "four-bar chain", "triple-rocker (RRR1): not Grashof", 2),
    "roberts": (1, 1, "four-bar chain", "change-point double-rocker (SRCR)", 2),
    "pumpjack": (1, 1, "four-bar chain", "crank-rocker (GCRR): Grashof", 2),
    "slider-crank": (1, 1, "slider-crank chain (RRRP)", "slider-crank: the driven link turns", 2),
    "scott-russell": (1, 1, "slider-crank chain (RRRP)", "isosceles slider-crank", 2),
    "inverted-slider-crank": (1, 1, "slider-crank chain (RRRP)", "crank shaper", 2),
    "scotch-yoke": (1, 1, "double-slider chain (RRPP)", "Scotch yoke", 2),
    "elliptic-trammel": (1, 1, "double-slider chain (RRPP)", "elliptic trammel", None),
    "oldham-coupling": (1, 1, "double-slider chain (RRPP)", "Oldham coupling", 2),
    "crank-press": (
        1, 1, "slider-crank chain (RRRP)", "slider-crank: the driven link turns fully", 2,
    ),
    "crank-shaper": (1, 1, "Watt chain, 2 prismatic joints", "Watt II; its loop", 2),
    "whitworth": (1, 1, "Watt chain, 2 prismatic joints", "Watt II; its loop", 2),
    "drag-link": (1, 1, "Watt chain, 1 prismatic joint", "Watt II; its loop", 2),
    "hart-inversor": (1, 1, "Watt chain", "Watt I; its loop", 2),
    "klann-leg": (1, 1, "Stephenson chain", "Stephenson III; its loop", 2),
    "stephenson-far-crank": (1, 1, "Stephenson chain", "Stephenson III", 3),
    "jansen-leg": (1, 1, "eight-link chain, 3 multiple pins", "", 2),
    "peaucellier": (1, 1, "eight-link chain, 4 multiple pins", "", 2),
    "double-pendulum": (2, 2, "open three-link chain", "", None),
    "double-butterfly": (1, 1, "eight-link chain no. 5 of 16 (4 ternary links)", "", 3),
    "five-bar-robot": (2, 2, "five-bar chain", "", 2),
    "three-rpr": (3, 3, "eight-link chain with 3 degrees of freedom, 3 prismatic joints", "", 3),
    "planetary-gear": (1, 1, "four-link chain with 2 gear pairs", "", None),
    "planetary-differential": (2, 2, "five-link chain with 2 gear pairs", "", None),
    "cam-roller-follower": (1, 1, "three-link chain with 1 cam", "", None),
    "sun-and-planet": (1, 1, "five-link chain with 1 gear pair", "its loop ground, arm, rod", None),
    "boxer-engine": (1, 1, "Watt chain, 2 prismatic joints", "Watt II", 2),
    "atkinson-engine": (
        1, 1, "six-link chain, 1 prismatic joint, 1 multiple pin",
        "its loop ground, crank, rod, lever: crank-rocker", 2,
    ),
    "parallel-cranks": (
        0, 1, "five-link chain with 0 degrees of freedom by Grübler's count", "", None
    ),
    "dixon-one": (
        0, 1, "nine-link chain with 0 degrees of freedom by Grübler's count, 6 multiple pins",
        "", None,
    ),
    "dixon-two": (
        -3, 1, "16-link chain with -3 degrees of freedom by Grübler's count, 8 multiple pins",
        "", None,
    ),
    "ackermann-steering": (1, 1, "four-bar chain", "triple-rocker (RRR1): not Grashof", 2),
    "andrews-squeezer": (
        1, 1, "eight-link chain, 2 multiple pins",
        "its loop ground, K1, K2, K3: crank-rocker (GCRR): Grashof", 2,
    ),
    "balanced-lamp": (1, 1, "open two-link chain", "", 1),
    "door-closer": (1, 1, "open two-link chain", "", 1),
    "toggle-latch": (1, 1, "slider-crank chain (RRRP)", "slider-crank: the driven link turns", 2),
    "pendulum": (1, 1, "open two-link chain", "", 1),
    "compressor": (1, 1, "slider-crank chain (RRRP)", "slider-crank: the driven link turns", 2),
    "beam-engine": (
        1, 1, "eight-link chain, 1 multiple pin",
        "its loop ground, crank, connecting_rod, beam: crank-rocker (GCRR): Grashof", 2,
    ),
    "belt-drive": (1, 1, "five-link chain with 1 belt", "", None),
    "cam-swinging-follower": (1, 1, "three-link chain with 1 cam", "", None),
    "cardan-circles": (1, 1, "three-link chain with 1 gear pair", "", None),
    "cognate-1": (1, 1, "four-bar chain", "crank-rocker (GCRR): Grashof", 2),
    "cognate-2": (1, 1, "four-bar chain", "double-rocker: Grashof", None),
    "cognate-3": (1, 1, "four-bar chain", "crank-rocker (GCRR): Grashof", 2),
    "coupled-six-link": (1, 1, "Stephenson chain, 2 prismatic joints", "Stephenson III", 3),
    "crank-slider": (
        1, 1, "slider-crank chain (RRRP)",
        "slider-crank: the driven link turns fully", 2,
    ),
    "crossed-belt": (1, 1, "five-link chain with 1 belt", "", None),
    "curved-slot": (1, 1, "three-link chain with 1 pin on a curve", "", None),
    "double-four-bar": (
        1, 1, "Watt chain",
        "Watt II; its loop ground, link1, link2, link3: crank-rocker (GCRR): Grashof", 2,
    ),
    "double-wishbone": (1, 1, "four-bar chain", "triple-rocker (RRR2): not Grashof", 2),
    "eccentric-cam": (1, 1, "three-link chain with 1 cam", "", None),
    "elliptical-gears": (1, 1, "three-link chain with 1 non-circular gear pair", "", None),
    "evans": (1, 1, "four-bar chain", "triple-rocker (RRR1): not Grashof", 2),
    "excavator": (
        3, 3, "12-link chain with 3 degrees of freedom, 3 prismatic joints, 1 multiple pin",
        "", 2,
    ),
    "four-bar-crossed": (1, 1, "four-bar chain", "crank-rocker (GCRR): Grashof", 2),
    "garage-door": (1, 1, "three-link chain with 1 pin on a curve", "", None),
    "geared-five-bar": (1, 1, "five-link chain with 1 gear pair", "", None),
    "geneva-drive": (
        1, 1, "slider-crank chain (RRRP)",
        "crank shaper: the driven link turns fully", 2,
    ),
    "hoist": (1, 1, "four-link chain with 2 linear couplings", "", None),
    "hydraulic-clutch": (
        1, 1, "seven-link chain with 1 linear coupling", "its loop ground, pedal, master rod", None,
    ),
    "kempe-translator": (
        2, 2, "seven-link chain with 2 degrees of freedom, 2 multiple pins",
        "", None,
    ),
    "landing-gear": (1, 1, "Watt chain, 1 prismatic joint", "Watt II", 2),
    "macpherson": (
        1, 1, "slider-crank chain (RRRP)",
        "oscillating cylinder: the driven link turns fully", 2,
    ),
    "oval-gears": (1, 1, "three-link chain with 1 non-circular gear pair", "", None),
    "pantograph": (
        1, 1, "eight-link chain, 1 multiple pin",
        "its loop ground, crank, coupler, rocker: crank-rocker (GCRR): Grashof", 2,
    ),
    "rack-and-pinion": (
        1, 1, "five-link chain with 1 rack and pinion",
        "its loop ground, crank, rod, rack: slider-crank: the driven link turns fully", None,
    ),
    "rack-steering": (1, 1, "seven-link chain with 1 rack and pinion", "", None),
    "rapier-drive-limited-links": (
        1, 1, "Stephenson chain, 1 prismatic joint",
        "Stephenson III", 3,
    ),
    "rapier-drive-limited": (1, 1, "Stephenson chain, 1 prismatic joint", "Stephenson III", 3),
    "rapier-drive-links": (1, 1, "Stephenson chain, 1 prismatic joint", "Stephenson III", 3),
    "rapier-drive": (1, 1, "Stephenson chain, 1 prismatic joint", "Stephenson III", 3),
    "rolling-inside": (1, 1, "two-link chain with 1 rolling contact", "", None),
    "rolling-wheel": (1, 1, "two-link chain with 1 rolling contact", "", None),
    "ross-yoke": (
        1, 1, "slider-crank chain (RRRP)",
        "slider-crank: the driven link turns fully", 2,
    ),
    "scissor-lift": (
        1, 1, "eight-link chain no. 7 of 16 (4 ternary links), 2 prismatic joints",
        "its loop ground, x, arm2, arm1: isosceles slider-crank: change point", 2,
    ),
    "scissor-three-bars": (
        0, 1, "five-link chain with 0 degrees of freedom by Grübler's count",
        "", None,
    ),
    "slider-crank-engine": (
        1, 1, "slider-crank chain (RRRP)",
        "slider-crank: the driven link turns fully", 2,
    ),
    "slider-input": (1, 1, "slider-crank chain (RRRP)", "slider-crank: a link turns fully", 2),
    "stephenson-valve-gear": (
        1, 1,
        "eight-link chain no. 11 of 16 (1 quaternary and 2 ternary links), 2 prismatic joints",
        "", 3,
    ),
    "toggle-press": (
        1, 1, "six-link chain, 1 prismatic joint, 1 multiple pin",
        "its loop ground, crank, rod, upper_toggle: crank-rocker (GCRR): Grashof", 2,
    ),
    "trotbot-leg": (
        1, 1, "eight-link chain, 1 multiple pin",
        "its loop ground, crank, triangle, rocker: crank-rocker (GCRR): Grashof", 2,
    ),
    "windscreen-wiper": (
        1, 1, "six-link chain, 1 multiple pin",
        "its loop ground, crank, rod, blade1: crank-rocker (GCRR): Grashof", 2,
    ),
}  # fmt: skip

#: Files of plain equations, which are no mechanisms.
EQUATIONS = {
    "newton-another-root", "newton-convergence", "newton-extremum", "newton-inflection"
}  # fmt: skip


def test_every_library_file_has_its_statement() -> None:
    assert TEXTBOOK.keys() | EQUATIONS == set(lw.examples())


@pytest.mark.parametrize("name", sorted(EQUATIONS))
def test_plain_equations_are_called_nothing(name: str) -> None:
    report = lw.example(name).check()
    assert (report.classification, report.mobility_count) == (None, None)
    assert report.unclassified == "plain equations do not determine links and joints"


@pytest.mark.parametrize("name", TEXTBOOK)
def test_check_says_what_a_textbook_says(name: str) -> None:
    count, rank, chain, kind, number = TEXTBOOK[name]
    report = lw.example(name).check()
    found = report.classification
    assert found is not None
    assert (report.mobility_count, report.mobility_rank) == (count, rank)
    assert (found.chain, found.class_number) == (chain, number)
    assert found.type.startswith(kind)
    assert bool(found.type) == bool(kind)


CAM = "not an Assur group: it has a cam"


@pytest.mark.parametrize(
    ("name", "reasons"),
    [
        ("curved-slot", ["not an Assur group: it has a pin on a curve"]),
        ("garage-door", ["not an Assur group: it has a pin on a curve"]),
        ("eccentric-cam", [CAM, None, None, CAM]),
        ("cardan-circles", ["not an Assur group: it has a gear pair"]),
        (
            "rolling-inside",
            ["not an Assur group: an input drives the angle of a link away from its pin"],
        ),
    ],
)
def test_blocks_with_higher_pairs_say_why_they_have_no_class(
    name: str, reasons: list[str | None]
) -> None:
    """Coordinates of curves and contacts follow from the links, and do not hide the reason."""
    blocks = lw.example(name).check().blocks
    assert [block.group and block.group.text for block in blocks] == reasons
