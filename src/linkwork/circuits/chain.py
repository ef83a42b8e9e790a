"""The kinematic chain of a linkage: its name, its contours, its inversions."""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

from linkwork.core.foundation.arrays import FrozenDict
from linkwork.core.foundation.errors import MissingPackageError
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.part import Joint, JointKind
from linkwork.core.mechanism.part.springs import Weld

# ----------------------------------------------------------------------
# The kinematic chain of a linkage: its links and joints, without dimensions.


@dataclass(frozen=True, kw_only=True)
class Chain:
    """Links and their joints.

    Parameters
    ----------
    links : tuple of str
        In the file's order. A cylinder has two, its ``barrel`` and its ``rod``.
    blocks : frozenset of str
        Links without extent that replace pins in slots; see :meth:`with_blocks`.
    united : Mapping[str, str]
        Welded links and the link to which each is welded; see :meth:`welded`.
    """

    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    ground: str = GROUND
    blocks: frozenset[str] = frozenset()
    united: Mapping[str, str] = FrozenDict()

    @classmethod
    def of(cls, linkage: Linkage) -> Chain:
        """The chain of a linkage, independent of its inputs."""
        links = [*linkage.links, *(end for part in linkage.parts for end in part.ends)]
        joints = [joint for part in linkage.parts if (joint := part.joint(linkage)) is not None]
        joints.sort(key=lambda joint: not joint.kind.lower)
        chain = cls(links=tuple(links), joints=(*_pins(linkage), *joints))
        welds = linkage.of(Weld)
        return chain.welded(weld.links for weld in welds) if welds else chain

    @property
    def mobility(self) -> int:
        """Grübler's count 3 (n - 1) - Σ (3 - freedoms), a pin of k links as k - 1 joints."""
        lost = sum((3 - joint.kind.freedom) * joint.count for joint in self.joints)
        return 3 * (len(self.links) - 1) - lost

    @property
    def simple(self) -> bool:
        """Whether every pin joins two links and no two links share two joints."""
        pairs = [frozenset(joint.links) for joint in self.joints]
        return len(set(pairs)) == len(pairs) and all(len(pair) == 2 for pair in pairs)

    def at(self, link: str) -> list[Joint]:
        """The joints of a link."""
        return [joint for joint in self.joints if link in joint.links]

    def with_blocks(self) -> Chain:
        """The chain of lower pairs only: a pin in a slot becomes a block, pinned and sliding.

        Motion and mobility do not change: the block adds three freedoms and removes three.
        """
        links, joints = list(self.links), []
        pins = {joint.name: joint for joint in self.joints if joint.kind is JointKind.REVOLUTE}
        for joint in self.joints:
            if joint.kind is not JointKind.PIN_IN_SLOT:
                continue
            pinned, guide = joint.links
            links.append(joint.name)
            there = pins.get(joint.point) or Joint(
                kind=JointKind.REVOLUTE, name=joint.point, links=(pinned,)
            )
            # a pin that exists already joins the block as a further link
            pins[joint.point] = replace(there, links=(*there.links, joint.name))
            joints.append(
                Joint(kind=JointKind.PRISMATIC, name=joint.name, links=(joint.name, guide))
            )
        kept = [joint for joint in self.joints if joint.kind is JointKind.PRISMATIC]
        higher = [j for j in self.joints if not j.kind.lower and j.kind != JointKind.PIN_IN_SLOT]
        return replace(
            self,
            links=tuple(links),
            joints=(*pins.values(), *kept, *joints, *higher),
            blocks=frozenset(links[len(self.links) :]),
        )

    def called(self, link: str) -> str:
        """The link of the chain that a link belongs to."""
        return self.united.get(link, link)

    def members(self, link: str) -> tuple[str, ...]:
        """A link of the chain and all links welded to it."""
        return (link, *(other for other, one in self.united.items() if one == link))

    def welded(self, pairs: Iterable[tuple[str, str]]) -> Chain:
        """The chain in which the two links of each pair are merged.

        The name is that of the ground if it is one of them, otherwise of the first in order.
        """
        became = {link: link for link in self.links} | dict(self.united)
        for first, second in pairs:
            one, other = became[first], became[second]
            # the merged link has the name of the ground, otherwise of the first link
            if other == self.ground or (
                one != self.ground and self.links.index(other) < self.links.index(one)
            ):
                one, other = other, one
            became = {link: one if now == other else now for link, now in became.items()}
        joints = []
        for joint in self.joints:
            left = tuple(dict.fromkeys(became[link] for link in joint.links))
            # a joint between welded links is no longer a joint
            if len(left) > 1:
                joints.append(replace(joint, links=left))
        return replace(
            self,
            links=tuple(link for link in self.links if became[link] == link),
            joints=tuple(joints),
            united=FrozenDict({link: one for link, one in became.items() if link != one}),
        )

    def loop_through(self, joint: Joint, first: str, second: str) -> list[tuple[Joint, ...]]:
        """The joints of every closed loop of four links through a joint, which comes first.

        The loop goes from ``first`` through ``joint`` to ``second`` and returns to ``first``.
        """
        found: list[tuple[Joint, ...]] = []
        for to_third in self.at(second):
            for third in to_third.across(second):
                if to_third is joint or third == first:
                    continue
                for to_fourth in self.at(third):
                    for fourth in to_fourth.across(third):
                        if fourth in (first, second) or to_fourth in (joint, to_third):
                            continue
                        found += [
                            (joint, to_third, to_fourth, back)
                            for back in self.at(fourth)
                            if first in back.links and back not in (joint, to_third, to_fourth)
                        ]
        return found


def _pins(linkage: Linkage) -> Iterator[Joint]:
    """A pin at every shared point; a cylinder's barrel is at its first point."""
    # a cylinder is a body of the sketch and two links of the chain, one at each end
    ends = {part.label: dict(zip(part.body, part.ends, strict=True)) for part in linkage.parts}
    for point, bodies in linkage.carriers().items():
        links = tuple(ends[body][point] if body in ends else body for body in bodies)
        if len(links) > 1:
            yield Joint(kind=JointKind.REVOLUTE, name=point, links=links)


# ----------------------------------------------------------------------
# Comparison of chains by graph isomorphism (networkx).


Graph = Any  # networkx has no type hints


def _networkx() -> Any:
    """Import on first use: it takes longer to load than the rest of the package."""
    try:
        import networkx
    except ModuleNotFoundError:
        raise MissingPackageError(
            "names of kinematic chains need networkx: pip install networkx"
        ) from None
    return networkx


def missing() -> str:
    """Why chains cannot be compared here; "" if they can."""
    try:
        _networkx()
    except MissingPackageError as error:
        return str(error)
    return ""


def _coloured(chain: Chain, ground: str) -> Graph:
    """Links and joints as vertices with their kinds; multiple pins are kept."""
    graph = _networkx().Graph()
    for link in chain.links:
        graph.add_node(("link", link), kind="ground" if link == ground else "link")
    # joints are vertices, since an edge cannot join the three links of a multiple pin
    for k, joint in enumerate(chain.joints):
        graph.add_node(("joint", k), kind=joint.kind.letter)
        graph.add_edges_from((("joint", k), ("link", link)) for link in joint.links)
    return graph


def same_graph(chain: Chain, graph6: str) -> bool:
    """Whether a chain without multiple joints has the graph given in graph6 format.

    References
    ----------
    B. D. McKay, graph6 format, https://users.cecs.anu.edu.au/~bdm/data/formats.txt
    """
    own = _networkx().Graph()  # links as vertices, joints as edges
    own.add_nodes_from(chain.links)
    own.add_edges_from(joint.links for joint in chain.joints)
    known = _networkx().from_graph6_bytes(graph6.encode("ascii"))
    return bool(_networkx().is_isomorphic(own, known))


def same_inversion(chain: Chain, ground: str, other: Chain, other_ground: str) -> bool:
    """Whether two chains have the same graph, kinds of joints and fixed link."""
    graphs = _coloured(chain, ground), _coloured(other, other_ground)
    same_kind = _networkx().isomorphism.categorical_node_match("kind", None)
    return bool(_networkx().is_isomorphic(*graphs, node_match=same_kind))


def orbits(chain: Chain) -> list[list[str]]:
    """Equivalence classes of links: fixing any link of a class gives the same inversion."""
    found: list[list[str]] = []
    for link in chain.links:
        alike = (known for known in found if same_inversion(chain, known[0], chain, link))
        known = next(alike, None)
        if known is None:
            found.append([link])
        else:
            known.append(link)
    return found


def contours(incidences: Iterable[tuple[str, str]]) -> list[int]:
    """Numbers of joints of the independent closed contours, from (link, joint) incidences.

    A minimum cycle basis (Horton 1987).
    """
    graph = _networkx().Graph()
    graph.add_edges_from((("link", link), ("joint", joint)) for link, joint in incidences)
    # links and joints alternate around a contour
    return [len(cycle) // 2 for cycle in _networkx().minimum_cycle_basis(graph)]


# ----------------------------------------------------------------------
# Names of kinematic chains, and of their inversions with a given link as ground.


_WORDS = ("", "", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
#: Joints around a loop of four links, in the lexicographically smallest rotation.
_FOUR_LINK = {
    "RRRR": "four-bar chain",
    "RRRP": "slider-crank chain (RRRP)",
    "RRPP": "double-slider chain (RRPP)",
    "RPRP": "crossed-slider chain (RPRP)",
    "RPPP": "four-link chain (RPPP)",
    "PPPP": "four-link chain (PPPP)",
}
_WATT, _STEPHENSON = "EgMo", "EbEg"  # graph6
_MOST_WAYS = 500  # ways to separate multiple pins; with more, a chain has no name


@dataclass(frozen=True, kw_only=True)
class EightLinkChain:
    """One of the sixteen eight-link chains with one freedom, in Linkwork's numbering."""

    number: int
    quaternary: int
    ternary: int
    binary: int
    graph6: str
    inversions: int

    @property
    def name(self) -> str:
        """Number and links: there is no standard name."""
        kinds = ((self.quaternary, "quaternary"), (self.ternary, "ternary"))
        more = " and ".join(f"{count} {kind}" for count, kind in kinds if count)
        return f"eight-link chain no. {self.number} of 16 ({more} links)"


@cache
def eight_link_chains() -> tuple[EightLinkChain, ...]:
    """The table of all eight-link chains."""
    text = Path(__file__).with_name("eight_link_chains.toml").read_text(encoding="utf-8")
    return tuple(EightLinkChain(**entry) for entry in tomllib.loads(text)["chain"])


def chain_name(chain: Chain) -> str:
    """The name of a chain, independent of its ground.

    Notes ----- Pins in slots count as blocks, see :meth:`Chain.with_blocks`. A chain with multiple
    pins has the name of the chain of simple joints that it degenerates from if that chain is
    unique. Prismatic joints of a chain with more than four links are counted after its name.
    """
    # names are those of chains of lower pairs: a pin in a slot counts as a block
    whole = chain.with_blocks()
    count = len(whole.links)
    plain = f"{_WORDS[count] if count < len(_WORDS) else count}-link chain"
    higher = [joint for joint in whole.joints if not joint.kind.lower]
    if higher:
        nouns = dict.fromkeys(joint.kind.noun for joint in higher)
        told = (_counted(sum(j.kind.noun == noun for j in higher), noun) for noun in nouns)
        return f"{plain} with {' and '.join(told)}"
    elements = Counter(link for joint in whole.joints for link in joint.links)
    if any(elements[link] < 2 for link in whole.links):
        return f"open {plain}"
    letters = loop_letters(whole) if len(whole.joints) == count else None
    if letters is not None and count == 4:
        return _FOUR_LINK[letters]
    name = _family(whole) or _degenerate_family(whole)
    multiple = sum(len(joint.links) > 2 for joint in whole.joints)
    sliding = sum(joint.kind is JointKind.PRISMATIC for joint in whole.joints)
    if name is None:
        freedom = "" if whole.mobility == 1 else f" with {whole.mobility} degrees of freedom"
        if whole.mobility < 1:  # but its actual mobility is larger
            freedom += " by Grübler's count"
        name = "five-bar chain" if count == 5 and letters == "RRRRR" else plain + freedom
    parts = [name]
    parts += [_counted(sliding, "prismatic joint")] if sliding else []
    parts += [_counted(multiple, "multiple pin")] if multiple else []
    return ", ".join(parts)


def inversion_name(chain: Chain) -> str | None:
    """The name of the inversion with the given ground, if it has one.

    Watt II has a ternary ground, Watt I a binary one. Stephenson III has a ternary ground;
    Stephenson I a binary one between the two ternary links, Stephenson II one of two adjacent
    binary links. The double-slider chain with ground at the link with two sliding joints is the
    elliptic trammel, with one sliding joint the Scotch yoke, with none Oldham's coupling.

    References
    ----------
    R. L. Norton, Design of Machinery, section on inversion; J. M. McCarthy and G. S. Soh,
    Geometric Design of Linkages, 2nd ed. 2011, doi:10.1007/978-1-4419-7892-9
    """
    whole = chain.with_blocks()
    own = whole.at(whole.ground)
    name = chain_name(chain)
    if name.startswith("double-slider"):
        sliding = sum(joint.kind is JointKind.PRISMATIC for joint in own)
        return ("Oldham coupling", "Scotch yoke", "elliptic trammel")[sliding]
    if name.startswith("crossed-slider"):
        return "Rapson's slide"
    if not whole.simple:
        return None
    if name.startswith("Watt"):
        return "Watt II" if len(own) == 3 else "Watt I"
    if name.startswith("Stephenson"):
        if len(own) == 3:
            return "Stephenson III"
        beside = {other for joint in own for other in joint.across(whole.ground)}
        return "Stephenson I" if all(len(whole.at(b)) == 3 for b in beside) else "Stephenson II"
    return None


def loop_letters(chain: Chain) -> str | None:
    """The kinds of joints around a single-loop chain, beginning with the longest sequence of R.

    With up to five joints both directions give the same letters.
    """
    start = chain.links[0]
    joints: list[Joint] = []
    here = start
    while True:
        onward = [joint for joint in chain.at(here) if joint not in joints[-1:]]
        if len(chain.at(here)) != 2 or not onward or len(onward[0].links) != 2:
            return None
        joints.append(onward[0])
        (here,) = onward[0].across(here)
        if here == start:
            break
    if len(joints) != len(chain.links):
        return None
    row = "".join(joint.kind.letter for joint in joints)
    return max(row[k:] + row[:k] for k in range(len(row)))  # R follows P in the alphabet


def _family(chain: Chain) -> str | None:
    """The name of a chain of simple joints with one freedom, if it has one."""
    if not chain.simple or chain.mobility != 1:
        return None
    if len(chain.links) == 6:
        known = {"Watt chain": _WATT, "Stephenson chain": _STEPHENSON}
    elif len(chain.links) == 8:
        # counts of links rule out most chains before graphs are compared
        degrees = [len(chain.at(link)) for link in chain.links]
        known = {
            entry.name: entry.graph6
            for entry in eight_link_chains()
            if (entry.quaternary, entry.ternary) == (degrees.count(4), degrees.count(3))
        }
    else:
        return None
    return next((name for name, graph6 in known.items() if same_graph(chain, graph6)), None)


def _degenerate_family(chain: Chain) -> str | None:
    """The chain whose joints coincide in the multiple pins, if it is unique."""
    if chain.simple or chain.mobility != 1 or len(chain.links) not in (6, 8):
        return None
    ways = 1
    for joint in chain.joints:
        # Cayley: k links have k^(k-2) trees
        ways *= max(1, len(joint.links) ** (len(joint.links) - 2))
    if ways > _MOST_WAYS:
        return None
    names: set[str] = set()
    for drawn in product(*(list(_drawn_apart(joint)) for joint in chain.joints)):
        apart = replace(chain, joints=tuple(joint for joints in drawn for joint in joints))
        name = _family(apart)
        if name is not None:
            names.add(name)
    return names.pop() if len(names) == 1 else None


def _drawn_apart(joint: Joint) -> Iterator[tuple[Joint, ...]]:
    """All sets of simple joints equivalent to a pin of k links: the trees of its links."""
    count = len(joint.links)
    if count == 2:
        yield (joint,)
        return
    for code in product(range(count), repeat=count - 2):
        yield tuple(
            replace(joint, name=f"{joint.name} {k}", links=(joint.links[a], joint.links[b]))
            for k, (a, b) in enumerate(_networkx().from_prufer_sequence(code).edges)
        )


def _counted(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
