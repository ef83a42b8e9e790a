"""What a textbook calls a mechanism: type by lengths, Assur groups, class."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits.classification import as_linkage, block_groups, classify
from linkwork.circuits.reading_loops import Seen
from linkwork.core.results.check import Classification

FOUR_BAR = {
    "ground": ("O", "C"),
    "crank": ("O", "A"),
    "coupler": ("A", "B"),
    "rocker": ("C", "B"),
}


def _classified(mechanism: lw.Mechanism) -> Classification:
    seen = as_linkage(mechanism.model)
    assert isinstance(seen, Seen)
    return classify(seen)


def _four_bar(
    ground: float, driven: float, coupler: float, output: float, **what: Any
) -> lw.Mechanism:
    """A sketch is enough: the type is read off the lengths."""
    return lw.linkage(
        points={"O": (0, 0), "C": (ground, 0), "A": (0.1, 1), "B": (ground, 2)},
        links=FOUR_BAR,
        lengths={"O A": driven, "A B": coupler, "C B": output},
        inputs=lw.Input(**(what or {"link": "crank"})),
    )


@pytest.mark.parametrize(
    ("lengths", "name", "code"),
    [
        ((1, 3, 2.5, 2), "double-crank", "GCCC"),
        ((3, 1, 2.5, 2), "crank-rocker", "GCRR"),
        ((3, 2.5, 1, 2), "double-rocker", "GRCR"),
        ((3, 2.5, 2, 1), "rocker-crank", "GRRC"),
        ((5, 2, 2.5, 3), "triple-rocker", "RRR1"),
        ((2, 5, 2.5, 3), "triple-rocker", "RRR2"),
        ((2, 2.5, 5, 3), "triple-rocker", "RRR3"),
        ((2, 2.5, 3, 5), "triple-rocker", "RRR4"),
        ((1, 4, 3, 2), "change-point double-crank", "SCCC"),
        ((4, 1, 3, 2), "change-point crank-rocker", "SCRR"),
        ((4, 3, 1, 2), "change-point double-rocker", "SRCR"),
        ((4, 3, 2, 1), "change-point rocker-crank", "SRRC"),
        ((4, 2, 4, 2), "parallelogram", "S2X"),
        ((2, 2, 4, 4), "deltoid", "S2X"),
        ((2, 4, 4, 2), "deltoid", "S2X"),
        ((2, 2, 2, 2), "rhombus", "S3X"),
    ],
)
def test_barkers_types_of_four_bars(lengths: tuple[float, ...], name: str, code: str) -> None:
    """Barker 1985; Norton, Design of Machinery, table 2-4: ground, input, coupler, output."""
    loop = _classified(_four_bar(*lengths)).loop
    assert loop is not None
    assert (loop.name, loop.barker) == (name, code)
    s, p, q, l = sorted(lengths)  # noqa: E741 - the letters of the condition
    assert loop.margin == pytest.approx(p + q - s - l, rel=1e-14, abs=1e-15)
    assert loop.grashof == {"G": True, "R": False, "S": None}[code[0]]


@pytest.mark.parametrize(
    ("far", "name"),
    [
        ((5.0, 1.7), "parallelogram"),
        ((2.0, -1.7), "antiparallelogram"),
        ((5.1, 1.5), "parallelogram"),
    ],
)
def test_the_sketch_tells_a_parallelogram_from_an_antiparallelogram(
    far: tuple[float, float], name: str
) -> None:
    bar = lw.linkage(
        points={"O": (0, 0), "C": (4, 0), "A": (1, 1.7), "B": far},
        links=FOUR_BAR,
        lengths={"O A": 2, "A B": 4, "C B": 2},
        inputs=lw.Input(link="crank"),
    )
    loop = _classified(bar).loop
    assert loop is not None
    assert (loop.name, loop.barker) == (name, "S2X")
    position = bar.solve(at=60)
    same_way = abs(position["coupler"]) < 1e-6
    assert same_way == (name == "parallelogram")
    asked = lw.linkage(
        points={"O": (0, 0), "C": (4, 0), "A": (1, 1.7), "B": far},
        links=FOUR_BAR,
        lengths={"O A": 2, "A B": 4, "C B": 2},
        inputs=lw.Input(link="crank"),
        configuration="crossed",
    )
    loop = _classified(asked).loop
    assert loop is not None
    assert loop.name == "parallelogram or antiparallelogram"


def test_a_stretched_sketch_tells_neither() -> None:
    loop = _classified(
        lw.linkage(
            points={"O": (0, 0), "C": (4, 0), "A": (2, 0), "B": (6, 0)},
            links=FOUR_BAR,
            inputs=lw.Input(link="crank"),
        )
    ).loop
    assert loop is not None
    assert loop.name == "parallelogram or antiparallelogram"


def test_the_margin_of_a_change_point_is_a_trillionth_of_the_longest_link() -> None:
    for off, grashof in ((0, None), (3e-12, None), (5e-12, False), (-5e-12, True)):
        loop = _classified(_four_bar(4 + off, 1, 3, 2)).loop
        assert loop is not None
        assert loop.grashof is grashof
        assert loop.margin == pytest.approx(-off, abs=1e-15)
        assert loop.relative_margin == pytest.approx(-off / 4, abs=1e-15)


@pytest.mark.parametrize(
    ("lengths", "text"),
    [
        ((3, 1, 2.5, 2), "crank-rocker (GCRR): Grashof, s + l < p + q by 0.5 mm"),
        ((5, 2, 2.5, 3), "triple-rocker (RRR1): not Grashof, s + l > p + q by 1.5 mm"),
        ((4, 1, 3, 2), "change-point crank-rocker (SCRR): change point, s + l = p + q "
                       "(margin 0 mm)"),
    ],
)  # fmt: skip
def test_a_type_is_told_with_its_margin(lengths: tuple[float, ...], text: str) -> None:
    found = _classified(_four_bar(*lengths))
    assert (found.chain, found.type) == ("four-bar chain", text)


@pytest.mark.parametrize("lengths", [(3, 1, 2.5, 2), (3, 2, 2.5, 1)])
def test_a_four_bar_driven_elsewhere_than_at_ground_has_no_barker_code(
    lengths: tuple[float, ...],
) -> None:
    driven: tuple[dict[str, Any], ...] = ({"joint": "B"}, {"link": "coupler"})
    for what in driven:
        loop = _classified(_four_bar(*lengths, **what)).loop
        assert loop is not None
        assert (loop.name, loop.barker) == ("crank-rocker", "")


def test_the_rocker_as_input_makes_a_rocker_crank() -> None:
    loop = _classified(_four_bar(3, 1, 2.5, 2, link="rocker")).loop
    assert loop is not None
    assert loop.links == ("ground", "rocker", "coupler", "crank")
    assert (loop.name, loop.barker, loop.turns_fully) == ("rocker-crank", "GRRC", False)


@pytest.mark.parametrize("seed", range(12))
def test_a_driven_link_turns_fully_if_its_type_says_so(seed: int) -> None:
    """The sweep is the referee: every whole degree is reached, or not."""
    rng = np.random.default_rng(seed)
    while True:
        ground, driven, coupler, output = rng.uniform(1, 4, 4)
        angle = rng.uniform(0, 2 * math.pi)
        a = driven * np.exp(1j * angle)
        d = abs(a - ground)
        if abs(coupler - output) < 0.98 * d < 0.9 * (coupler + output):
            break
    x = (d * d + coupler**2 - output**2) / (2 * d)
    b = a + (ground - a) / d * (x + 1j * math.sqrt(coupler**2 - x * x))
    bar = lw.linkage(
        points={"O": (0, 0), "C": (ground, 0), "A": (a.real, a.imag), "B": (b.real, b.imag)},
        links=FOUR_BAR,
        inputs=lw.Input(link="crank"),
    )
    loop = _classified(bar).loop
    assert loop is not None
    assert loop.turns_fully == bool(bar.sweep(certify=False).found.all())


def _slider_crank(crank: float, rod: float, offset: float, pivot: float = 0.0) -> lw.Mechanism:
    return lw.linkage(
        points={"O": (0, pivot), "S": (-1, 0), "T": (5, 0), "A": (0.1, 1), "B": (3, offset)},
        links={"ground": ("O", "S", "T"), "crank": ("O", "A"), "rod": ("A", "B"), "block": ("B",)},
        lengths={"O A": crank, "A B": rod},
        sliders=[lw.Slider(name="s", link="block", points=("B",), on="ground", line=("S", "T"),
                           offset=offset)],
        inputs=lw.Input(link="crank"),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("crank", "rod", "offset", "pivot", "text"),
    [
        (1, 3, 0.5, 0, "slider-crank: the driven link turns fully, s + e < l by 1.5 mm"),
        (1, 3, 0.5, 1, "slider-crank: the driven link turns fully, s + e < l by 1.5 mm"),
        (1, 3, 2.5, 0, "slider-rocker: the driven link cannot turn fully, "
                       "s + e > l by 0.5 mm"),
        (3, 1, 0.5, 0, "slider-rocker (hand pump): the driven link cannot turn fully, "
                       "s + e < l by 1.5 mm"),
        (1, 3, 4.5, 0, "no closed loop: the offset pins are 0.5 mm further apart than "
                       "crank and rod reach"),
        (1, 3, 2, 0, "slider-crank: change point, s + e = l (margin 0 mm)"),
        (2, 2, 0, 0, "isosceles slider-crank: change point, s + e = l (margin 0 mm)"),
    ],
)  # fmt: skip
def test_slider_cranks_are_told_by_the_offset_condition(
    crank: float, rod: float, offset: float, pivot: float, text: str
) -> None:
    found = _classified(_slider_crank(crank, rod, offset, pivot))
    assert (found.chain, found.type) == ("slider-crank chain (RRRP)", text)


@pytest.mark.parametrize("angle", [0.0, 35.0])
def test_the_offset_counts_a_pin_beside_the_sliding_point(angle: float) -> None:
    """The block's pin Q is 0.7 from its sliding point B, at an angle to the line."""
    q = 3 + 0.2j + 0.7 * np.exp(1j * math.radians(angle))
    found = _classified(
        lw.linkage(
            points={"O": (0, 0), "T": (5, 0), "A": (0.1, 1), "B": (3, 0.2), "Q": (q.real, q.imag)},
            links={"ground": ("O", "T"), "crank": ("O", "A"), "rod": ("A", "Q"),
                   "block": ("B", "Q")},
            lengths={"O A": 1, "A Q": 3, "B Q": 0.7},
            sliders=[lw.Slider(name="s", link="block", points=("B",), on="ground",
                               line=("O", "T"), offset=0.2, angle=angle)],
            inputs=lw.Input(link="crank"),
        )
    )  # fmt: skip
    assert found.loop is not None
    offset = 0.2 + 0.7 * math.sin(math.radians(angle))
    assert found.loop.margin == pytest.approx(3 - 1 - offset, rel=1e-14)


def _inverted(crank: float, ground: float) -> lw.Mechanism:
    return lw.linkage(
        points={"O": (0, 0), "C": (0, -ground), "A": (crank, 0), "Q": (1, 1)},
        links={"ground": ("O", "C"), "crank": ("O", "A"), "lever": ("C", "Q")},
        slots=[lw.Slot(name="s", point="A", on="lever", line=("C", "Q"))],
        inputs=lw.Input(link="crank"),
    )


def test_the_inverted_slider_crank_is_a_shaper_or_whitworths() -> None:
    shaper = _classified(_inverted(1, 2.5))
    assert shaper.type == "crank shaper: the driven link turns fully, s + e < l by 1.5 mm"
    assert (shaper.chain, shaper.blocks) == ("slider-crank chain (RRRP)", ("s",))
    whitworth = _classified(_inverted(2.5, 1))
    assert whitworth.type == (
        "Whitworth quick return: the driven link turns fully, s + e < l by 1.5 mm"
    )


def test_a_pivoted_cylinder_makes_it_an_oscillating_or_rotary_cylinder() -> None:
    for crank, name in ((1.0, "oscillating cylinder"), (4.0, "rotary cylinder")):
        mechanism = lw.linkage(
            points={"O": (0, 0), "C": (2, 0), "A": (0.1, crank)},
            links={"ground": ("O", "C"), "crank": ("O", "A")},
            lengths={"O A": crank},
            cylinders=[lw.Cylinder(name="ram", between=("C", "A"))],
            inputs=lw.Input(cylinder="ram", from_=1.5, to=2.5, step=0.1),
        )
        found = _classified(mechanism)
        assert found.loop is not None
        assert (found.loop.name, found.loop.turns_fully) == (name, None)
        assert [group.text for group in found.groups] == ["dyad RRR, class II"]
        assert found.groups[0].links == ("crank", "ram barrel + ram rod")
        assert block_groups(mechanism.model, as_linkage(mechanism.model)) == found.groups


def test_a_loop_of_a_larger_chain_is_told_if_the_input_drives_it() -> None:
    found = _classified(_watt())
    assert found.chain == "Watt chain"
    assert found.type == (
        "Watt II; its loop ground, crank, coupler, rocker: crank-rocker (GCRR): "
        "Grashof, s + l < p + q by 0.5 mm"
    )
    far = _classified(lw.example("stephenson-far-crank"))
    assert (far.chain, far.type) == ("Stephenson chain", "Stephenson III")


def _watt() -> lw.Mechanism:
    return lw.linkage(
        points={"O": (0, 0), "C": (3, 0), "A": (0, 1), "B": (2.4, 1.8), "D": (4, 1.8),
                "E": (6, 2), "F": (6, 0)},
        links={"ground": ("O", "C", "F"), "crank": ("O", "A"), "coupler": ("A", "B"),
               "rocker": ("C", "B", "D"), "rod": ("D", "E"), "out": ("F", "E")},
        lengths={"O A": 1, "A B": 2.5, "C B": 2, "C D": 2.1, "B D": 1.6, "D E": 2, "F E": 2},
        inputs=lw.Input(link="crank"),
    )  # fmt: skip


def test_watts_mechanism_is_two_dyads() -> None:
    found = _classified(_watt())
    assert [group.links for group in found.groups] == [("coupler", "rocker"), ("rod", "out")]
    assert [group.name for group in found.groups] == ["dyad RRR", "dyad RRR"]
    assert found.class_number == 2


def _stephenson(ground: str, link: str) -> lw.Mechanism:
    """Stephenson's chain: ternary T and U, joined over a, over b, and over c and d."""
    points = {"Ta": (0, 0), "Tb": (3, 0.2), "Tc": (1.4, -2), "aU": (0.3, 2.1), "bU": (2.9, 2.6),
              "cd": (5.5, -1.5), "dU": (5.2, 3.1)}  # fmt: skip
    links = {
        "T": ["Ta", "Tb", "Tc"], "U": ["aU", "bU", "dU"], "a": ["Ta", "aU"], "b": ["Tb", "bU"],
        "c": ["Tc", "cd"], "d": ["cd", "dU"],
    }  # fmt: skip
    named = {"ground" if name == ground else name: held for name, held in links.items()}
    return lw.linkage(points=points, links=named, inputs=lw.Input(link=link))


@pytest.mark.parametrize(
    ("ground", "driven", "inversion", "groups", "order"),
    [
        ("T", "a", "Stephenson III", ["dyad RRR, class II", "dyad RRR, class II"], 2),
        ("T", "c", "Stephenson III", ["triad RR-RR-RR, class III"], 3),
        ("a", "T", "Stephenson I", ["dyad RRR, class II", "dyad RRR, class II"], 2),
        ("c", "d", "Stephenson II", ["tetrad, class IV"], 2),
        ("d", "c", "Stephenson II", ["tetrad, class IV"], 2),
        ("c", "T", "Stephenson II", ["triad RR-RR-RR, class III"], 3),
    ],
)
def test_the_class_of_stephensons_mechanism_depends_on_ground_and_input(
    ground: str, driven: str, inversion: str, groups: list[str], order: int
) -> None:
    """Artobolevskii, ch. 2: the class of a mechanism is that of its highest group."""
    found = _classified(_stephenson(ground, driven))
    assert found.inversion == inversion
    assert [group.text for group in found.groups] == groups
    assert {group.order for group in found.groups} == {order}
    assert found.class_number == max(group.class_number or 0 for group in found.groups)


def _scotch_yoke() -> lw.Mechanism:
    return lw.linkage(
        points={"O": (0, 0), "A": (0.8, 0.6), "S": (0, -1), "T": (4, -1), "B": (0.8, -1),
                "Y": (0.8, 3)},
        links={"ground": ("O", "S", "T"), "crank": ("O", "A"), "yoke": ("B", "Y")},
        sliders=[lw.Slider(name="x", link="yoke", points=("B",), on="ground", line=("S", "T"))],
        slots=[lw.Slot(name="y", point="A", on="yoke", line=("B", "Y"))],
        inputs=lw.Input(link="crank"),
    )  # fmt: skip


def _tangent_drive() -> lw.Mechanism:
    """Pin B of two blocks: one slides along the driven arm, the other on ground."""
    return lw.linkage(
        points={"O": (0, 0), "N": (4, 3), "S": (0, 1), "T": (4, 1), "B": (1.4, 1)},
        links={"ground": ("O", "S", "T"), "arm": ("O", "N"), "one": ("B",), "two": ("B",)},
        sliders=[
            lw.Slider(name="s", link="one", points=("B",), on="arm", line=("O", "N")),
            lw.Slider(name="t", link="two", points=("B",), on="ground", line=("S", "T")),
        ],
        inputs=lw.Input(link="arm", from_=20, to=60),
    )


@pytest.mark.parametrize(
    ("dyad", "made"),
    [
        ("RRR", lambda: _four_bar(3, 1, 2.5, 2)),
        ("RRP", lambda: _slider_crank(1, 3, 0)),
        ("RPR", lambda: _inverted(1, 2.5)),
        ("PRP", _tangent_drive),
        ("RPP", _scotch_yoke),
    ],
)
def test_the_five_dyads_are_named_by_their_joints(
    dyad: str, made: Callable[[], lw.Mechanism]
) -> None:
    """Outer, inner, outer joint."""
    mechanism = made()
    (group,) = _classified(mechanism).groups
    assert (group.text, group.order) == (f"dyad {dyad}, class II", 2)
    assert block_groups(mechanism.model, as_linkage(mechanism.model)) == (group,)


def test_the_scotch_yoke_is_known() -> None:
    found = _classified(_scotch_yoke())
    assert (found.chain, found.type) == ("double-slider chain (RRPP)", "Scotch yoke")


def test_a_triads_legs_are_named_by_outer_and_inner_joint() -> None:
    (group,) = _classified(lw.example("rapier-drive-links")).groups
    assert group.text == "triad RR-RR-PR, class III"


def test_every_block_of_the_library_is_the_group_of_its_links() -> None:
    """Blocks come from the equations, groups from the chain: they agree."""
    for name in (
        "jansen-leg",
        "four-bar",
        "slider-crank",
        "inverted-slider-crank",
        "rapier-drive-links",
    ):
        mechanism = lw.example(name)
        groups = _classified(mechanism).groups
        assert block_groups(mechanism.model, as_linkage(mechanism.model)) == groups
        assert len(groups) == len(mechanism.check().blocks)


def test_an_input_that_holds_no_joint_leaves_no_assur_group() -> None:
    """The coupler's angle against ground is no joint of the four-bar."""
    found = _classified(_four_bar(3, 1, 2.5, 2, link="coupler"))
    assert [group.text for group in found.groups] == [
        "not an Assur group: an input drives the angle of a link away from its pin"
    ]
    assert found.class_number is None


def test_plain_equations_have_no_classification() -> None:
    mechanism = lw.example("newton-extremum")
    report = mechanism.check()
    assert report.classification is None
    assert report.unclassified == "plain equations do not determine links and joints"
    assert block_groups(mechanism.model, as_linkage(mechanism.model)) == (None,)


def test_a_block_pinned_to_ground_swings_as_a_cylinder_does() -> None:
    """MacPherson's strut slides in its mount, which is pinned to the body: no slotted lever."""
    strut = _classified(lw.example("macpherson")).loop
    lever = _classified(lw.example("inverted-slider-crank")).loop
    assert strut is not None
    assert lever is not None
    assert (strut.name, lever.name) == ("oscillating cylinder", "crank shaper")
