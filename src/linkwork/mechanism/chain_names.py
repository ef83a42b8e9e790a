"""What a kinematic chain is called, and its inversion with a given link as ground."""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from pathlib import Path

from linkwork.mechanism.chain import Chain
from linkwork.mechanism.chain_graph import same_graph
from linkwork.mechanism.joint import Joint, JointKind

__all__ = ["EightLinkChain", "chain_name", "eight_link_chains", "inversion_name", "loop_letters"]

_WORDS = {
    2: "two",
    3: "three",
    4: "four",
    5: "five",
    6: "six",
    7: "seven",
    8: "eight",
    9: "nine",
    10: "ten",
}
#: Joints around a loop of four links, smallest turn of the letters first.
_FOUR_LINK = {
    "RRRR": "four-bar chain",
    "RRRP": "slider-crank chain (RRRP)",
    "RRPP": "double-slider chain (RRPP)",
    "RPRP": "crossed-slider chain (RPRP)",
    "RPPP": "four-link chain (RPPP)",
    "PPPP": "four-link chain (PPPP)",
}
_WATT, _STEPHENSON = "EgMo", "EbEg"  # graph6
_MOST_WAYS = 500  # of drawing multiple pins apart; more leave a chain without a name


@dataclass(frozen=True, kw_only=True)
class EightLinkChain:
    """One of the sixteen chains of eight links with one freedom, by Linkwork's own numbering."""

    number: int
    quaternary: int
    ternary: int
    binary: int
    graph6: str
    inversions: int

    @property
    def name(self) -> str:
        """Number and links: there is no name that everybody uses."""
        kinds = ((self.quaternary, "quaternary"), (self.ternary, "ternary"))
        more = " and ".join(f"{count} {kind}" for count, kind in kinds if count)
        return f"eight-link chain no. {self.number} of 16 ({more} links)"


@cache
def eight_link_chains() -> tuple[EightLinkChain, ...]:
    """The table of all of them."""
    text = Path(__file__).with_name("eight_link_chains.toml").read_text(encoding="utf-8")
    return tuple(EightLinkChain(**entry) for entry in tomllib.loads(text)["chain"])


def chain_name(chain: Chain) -> str:
    """The name of a chain, whatever link is its ground.

    Notes
    -----
    Pins in slots count as blocks, see :meth:`Chain.with_blocks`. A chain with multiple pins has
    the name of the chain of simple joints that it degenerates from if there is only one such
    chain. Prismatic joints of a chain with more than four links are counted behind its name.
    """
    # names are those of chains of lower pairs: a pin in a slot counts as a block
    whole = chain.with_blocks()
    count = len(whole.links)
    plain = f"{_WORDS.get(count, count)}-link chain"
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
        if whole.mobility < 1:  # and more in truth, or it would be no mechanism
            freedom += " by Grübler's count"
        name = "five-bar chain" if count == 5 and letters == "RRRRR" else plain + freedom
    parts = [name]
    parts += [_counted(sliding, "prismatic joint")] if sliding else []
    parts += [_counted(multiple, "multiple pin")] if multiple else []
    return ", ".join(parts)


def inversion_name(chain: Chain) -> str | None:
    """What fixing the ground link makes of a chain, where that has a name of its own.

    Watt II has a ternary ground, Watt I a binary one. Stephenson III has a ternary ground;
    Stephenson I a binary one between the two ternary links, Stephenson II one of the two binary
    links that follow each other. Of the double-slider chain, the elliptic trammel has the link
    with two sliding joints as ground, the Scotch yoke one with one, Oldham's coupling that with
    none.

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
    """The kinds of joints around a chain that is one loop, beginning with the longest row of R.

    Up to five joints read alike in both directions.
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
    return max(row[k:] + row[:k] for k in range(len(row)))  # R is behind P in the alphabet


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
    """The chain that multiple pins come from when joints of one link move together, if unique."""
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
    """Every set of simple joints that a pin of k links can stand for: the trees of its links."""
    count = len(joint.links)
    if count == 2:
        yield (joint,)
        return
    for code in product(range(count), repeat=count - 2):
        yield tuple(
            replace(joint, name=f"{joint.name} {k}", links=(joint.links[a], joint.links[b]))
            for k, (a, b) in enumerate(_tree(code, count))
        )


def _tree(code: Iterable[int], count: int) -> list[tuple[int, int]]:
    """The tree of a Prüfer code (H. Prüfer, Archiv der Math. und Physik 27 (1918) 742-744)."""
    left = list(code)
    degree = [1 + left.count(vertex) for vertex in range(count)]
    edges = []
    for vertex in left:
        leaf = degree.index(1)
        edges.append((leaf, vertex))
        degree[leaf], degree[vertex] = 0, degree[vertex] - 1
    first, second = (vertex for vertex in range(count) if degree[vertex] == 1)
    return [*edges, (first, second)]


def _counted(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
