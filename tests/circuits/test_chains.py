"""Kinematic chains: all of them up to eight links, told apart and named."""

from __future__ import annotations

import random
from itertools import pairwise
from typing import Any

import networkx
import pytest

import linkwork as lw
from linkwork.circuits.chain import (
    Chain,
    chain_name,
    eight_link_chains,
    inversion_name,
    orbits,
    same_inversion,
)
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.part import Joint, JointKind
from tests.described import described_as
from tests.oracles.chains import canonical_graph6, kinematic_chains, link_classes

R, P = JointKind.REVOLUTE, JointKind.PRISMATIC


def _chain(*edges: tuple[object, ...], ground: object = 0, kinds: str = "") -> Chain:
    """A chain with joints of the given kinds, R unless told otherwise."""
    letters = kinds or "R" * len(edges)
    joints = tuple(
        Joint(kind=R if letter == "R" else P, name=f"j{k}", links=tuple(map(str, links)))
        for k, (letter, links) in enumerate(zip(letters, edges, strict=True))
    )
    links = dict.fromkeys(str(link) for edge in edges for link in edge)
    return Chain(links=tuple(links), joints=joints, ground=str(ground))


def _of(graph: networkx.Graph, ground: object = 0) -> Chain:
    return _chain(*graph.edges, ground=ground)


def _loop(kinds: str, ground: int = 0) -> Chain:
    count = len(kinds)
    return _chain(*((k, (k + 1) % count) for k in range(count)), ground=ground, kinds=kinds)


def test_there_are_1_2_and_16_chains_of_4_6_and_8_links() -> None:
    assert [len(kinematic_chains(n)) for n in (4, 6, 8)] == [1, 2, 16]


def test_they_have_1_5_and_71_inversions() -> None:
    """Tuttle 1996 enumerates them; ours are counted by symmetry and by colouring the ground."""
    for n, known in ((4, 1), (6, 5), (8, 71)):
        assert sum(map(link_classes, kinematic_chains(n))) == known
        assert sum(len(orbits(_of(graph))) for graph in kinematic_chains(n)) == known


def test_the_classifier_tells_all_of_them_apart() -> None:
    assert [chain_name(_of(graph)) for graph in kinematic_chains(4)] == ["four-bar chain"]
    names = {chain_name(_of(graph)) for graph in kinematic_chains(6)}
    assert names == {"Watt chain", "Stephenson chain"}
    names = {chain_name(_of(graph)) for graph in kinematic_chains(8)}
    assert names == {entry.name for entry in eight_link_chains()}
    assert len(names) == 16


@pytest.mark.parametrize("seed", range(3))
def test_a_chain_has_its_name_whatever_its_links_are_called(seed: int) -> None:
    rng = random.Random(seed)
    for n in (6, 8):
        for graph in kinematic_chains(n):
            order = rng.sample(sorted(graph), n)
            other = networkx.relabel_nodes(graph, dict(zip(sorted(graph), order, strict=True)))
            edges = [
                tuple(rng.sample(edge, 2))
                for edge in rng.sample(list(other.edges), len(other.edges))
            ]
            assert chain_name(_chain(*edges)) == chain_name(_of(graph))


@pytest.mark.extended  # the table is a file that nobody edits
def test_the_table_of_eight_links_is_what_counting_gives() -> None:
    found: list[tuple[int, int, int, str, Any]] = []
    for graph in kinematic_chains(8):
        degrees = [degree for _, degree in graph.degree()]
        four, three, two = (degrees.count(k) for k in (4, 3, 2))
        found.append((four, three, two, canonical_graph6(graph), link_classes(graph)))
    found.sort(key=lambda row: (row[0], row[3].encode("ascii")))
    table = [
        (
            entry.number,
            entry.quaternary,
            entry.ternary,
            entry.binary,
            entry.graph6,
            entry.inversions,
        )
        for entry in eight_link_chains()
    ]
    assert table == [(k, *row) for k, row in enumerate(found, 1)]


def test_an_eight_link_chain_is_named_by_its_number_and_its_links() -> None:
    assert eight_link_chains()[0].name == "eight-link chain no. 1 of 16 (4 ternary links)"
    assert eight_link_chains()[9].name == (
        "eight-link chain no. 10 of 16 (1 quaternary and 2 ternary links)"
    )


def test_the_five_inversions_of_six_links_are_told_apart() -> None:
    """A name belongs to one inversion, and one inversion has one name."""
    found: dict[str, list[Chain]] = {}
    for graph in kinematic_chains(6):
        for ground in graph:
            chain = _of(graph, ground)
            found.setdefault(inversion_name(chain) or "", []).append(chain)
    assert set(found) == {"Watt I", "Watt II", "Stephenson I", "Stephenson II", "Stephenson III"}
    for chains in found.values():
        for one, other in pairwise(chains):
            assert same_inversion(one, one.ground, other, other.ground)


def test_watt_and_stephenson_are_named_by_their_ground() -> None:
    watt = [("T", "U"), ("T", "a"), ("a", "b"), ("b", "U"), ("T", "c"), ("c", "d"), ("d", "U")]
    for ground, name in (("T", "Watt II"), ("a", "Watt I")):
        assert inversion_name(_chain(*watt, ground=ground)) == name
    stephenson = [
        ("T", "a"),
        ("a", "U"),
        ("T", "b"),
        ("b", "U"),
        ("T", "c"),
        ("c", "d"),
        ("d", "U"),
    ]
    for ground, name in (("T", "Stephenson III"), ("a", "Stephenson I"), ("c", "Stephenson II")):
        assert inversion_name(_chain(*stephenson, ground=ground)) == name


def test_a_chain_with_a_rigid_part_has_no_name() -> None:
    """With a triangle in it, it has as many joints as Watt's chain."""
    rigid = [(0, 1), (1, 2), (2, 0), (0, 3), (3, 4), (4, 5), (5, 1)]
    assert _chain(*rigid).mobility == 1
    assert chain_name(_chain(*rigid)) == "six-link chain"


@pytest.mark.parametrize(
    ("kinds", "name"),
    [
        ("RRRR", "four-bar chain"),
        ("RPRR", "slider-crank chain (RRRP)"),
        ("PRRP", "double-slider chain (RRPP)"),
        ("PRPR", "crossed-slider chain (RPRP)"),
        ("PPRP", "four-link chain (RPPP)"),
        ("RRRRR", "five-bar chain"),
        ("RRRPR", "five-link chain with 2 degrees of freedom, 1 prismatic joint"),
        ("RRRRRR", "six-link chain with 3 degrees of freedom"),
    ],
)
def test_a_loop_is_named_by_its_joints_from_any_of_them(kinds: str, name: str) -> None:
    for k in range(len(kinds)):
        turned = kinds[k:] + kinds[:k]
        assert chain_name(_loop(turned)) == name
        assert chain_name(_loop(turned[::-1])) == name


@pytest.mark.parametrize(
    ("ground", "name"),
    [(0, "Oldham coupling"), (1, "Scotch yoke"), (2, "elliptic trammel"), (3, "Scotch yoke")],
)
def test_double_sliders_are_named_by_their_ground(ground: int, name: str) -> None:
    """Joints R between 3 0 and 0 1, P between 1 2 and 2 3."""
    assert inversion_name(_loop("RPPR", ground)) == name


def test_a_chain_of_multiple_pins_has_a_name_only_if_it_comes_from_one_chain() -> None:
    """Pin B of three links: from Watt's chain, or from Stephenson's."""
    ambiguous = _chain((0, 1), (1, 2), (2, 3, 4), (3, 0), (4, 5), (5, 0))
    assert chain_name(ambiguous) == "six-link chain, 1 multiple pin"
    assert inversion_name(ambiguous) is None
    watt = [("T", "U"), ("T", "a"), ("a", "b"), ("b", "U"), ("T", "c"), ("c", "d"), ("d", "U")]
    names = set()
    for drawn in (0, 1), (0, 3):  # joints that a link with three of them brings together
        together = tuple(dict.fromkeys(link for k in drawn for link in watt[k]))
        left = [edge for k, edge in enumerate(watt) if k not in drawn]
        names.add(chain_name(_chain(*left, together)))
    assert names == {"Watt chain, 1 multiple pin"}


def test_an_open_chain_is_called_open() -> None:
    assert chain_name(_chain((0, 1), (1, 2))) == "open three-link chain"


def test_links_that_are_welded_are_one() -> None:
    chain = _loop("RRRRR").welded([("3", "2"), ("1", "3")])
    assert chain.links == ("0", "1", "4")
    assert (chain.called("2"), chain.called("3"), chain.called("4")) == ("1", "1", "4")
    assert chain.members("1") == ("1", "2", "3")
    again = chain.welded([("1", "0")])
    assert (again.links, again.called("3"), again.called("1")) == (("0", "4"), "0", "0")
    assert [joint.links for joint in chain.joints] == [("0", "1"), ("1", "4"), ("4", "0")]
    grounded = _loop("RRRR").welded([("1", "0")])
    assert (grounded.links, grounded.mobility) == (("0", "2", "3"), 0)


def test_a_chain_is_read_with_every_kind_of_joint() -> None:
    mechanism = lw.linkage(
        points={
            "O": (0, 0),
            "M": (1.5, -0.5),
            "N": (1.8, 1.2),
            "H": (4, 2.5),
            "S": (4, 0),
            "T": (4, 3),
        },
        links={"ground": ("O", "M", "S", "T"), "boom": ("O", "N"), "rod": ("N", "H")},
        slots=[lw.Slot(name="y", point="H", on="ground", line=("S", "T"))],
        cylinders=[lw.Cylinder(name="ram", between=("M", "N"))],
        inputs=lw.Input(cylinder="ram", from_=1.2, to=2.0, step=0.1),
    )
    chain = Chain.of(described_as(Linkage, mechanism))
    assert chain.links == ("ground", "boom", "rod", "ram barrel", "ram rod")
    joints = {joint.name: (joint.kind.letter, joint.links) for joint in chain.joints}
    assert joints == {
        "O": ("R", ("ground", "boom")),
        "M": ("R", ("ground", "ram barrel")),
        "N": ("R", ("boom", "rod", "ram rod")),
        "ram": ("P", ("ram barrel", "ram rod")),
        "y": ("RP", ("rod", "ground")),
    }
    blocks = chain.with_blocks()
    assert (chain.mobility, blocks.mobility, blocks.blocks) == (1, 1, frozenset({"y"}))
    added = {joint.name: (joint.kind.letter, joint.links) for joint in blocks.joints}
    assert (added["H"], added["y"]) == (("R", ("rod", "y")), ("P", ("y", "ground")))
    assert chain_name(chain) == "six-link chain, 2 prismatic joints, 1 multiple pin"
