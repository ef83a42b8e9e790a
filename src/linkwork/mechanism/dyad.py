"""Dyads: pairs of pinned links whose outer joints are on parts of known position.

The pin between the links transmits the force. The search starts from ground and the driven links;
structures that are not chains of dyads are skipped.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

from linkwork.foundation.names import GROUND
from linkwork.mechanism.figures import Guide
from linkwork.mechanism.skeleton import Bar, Skeleton

__all__ = ["Dyad", "dyads_of"]


@dataclass(frozen=True, kw_only=True)
class Dyad:
    """Two links with a common pin.

    Parameters
    ----------
    pin : str
        The point on both links.
    links : (str, str)
        The driving link and the driven link.
    arms : (str, str)
        The outer point of each link; "" for a sliding link.
    guide : Guide, optional
        The guide of the second link, if it slides.
    """

    pin: str
    links: tuple[str, str]
    arms: tuple[str, str]
    guide: Guide | None = None


def dyads_of(skeleton: Skeleton) -> tuple[Dyad, ...]:
    """The dyads of a mechanism in the order in which they can be solved.

    Cost: cubic in the number of links.
    """
    bodies = {GROUND: set(skeleton.fixed)} | {bar.name: set(bar.points) for bar in skeleton.bars}
    known = {GROUND, *_driven(skeleton)}
    found: list[Dyad] = []
    while True:
        fresh = next(_next_dyads(skeleton, bodies, known), None)
        if fresh is None:
            return tuple(found)
        found.append(fresh)
        known |= set(fresh.links)


def _driven(skeleton: Skeleton) -> Iterator[str]:
    """Links driven by an input: about a pin on ground, or along a line of ground."""
    fixed = set(skeleton.fixed)
    for part in skeleton.driven:
        if part.kind == "link" and part.pivot in fixed:
            yield part.name
        for guide in skeleton.guides:
            if part.kind == "slider" and guide.name == part.name and guide.link:
                yield guide.link


def _next_dyads(skeleton: Skeleton, bodies: dict[str, set[str]], known: set[str]) -> Iterator[Dyad]:
    held = set().union(*(bodies[name] for name in known))
    free = [bar for bar in skeleton.bars if bar.name not in known]
    for one, other in combinations(free, 2):
        for pin in sorted(set(one.points) & set(other.points) - held):
            yield from _pinned(one, other, pin, held)
            for link, block in ((one, other), (other, one)):
                yield from _sliding(skeleton.guides, link, block, pin, known, held)


def _pinned(one: Bar, other: Bar, pin: str, held: set[str]) -> Iterator[Dyad]:
    arms = [[p for p in bar.points if p in held] for bar in (one, other)]
    if len(arms[0]) == len(arms[1]) == 1 and arms[0] != arms[1]:
        yield Dyad(pin=pin, links=(one.name, other.name), arms=(arms[0][0], arms[1][0]))


def _sliding(
    guides: Sequence[Guide], link: Bar, block: Bar, pin: str, known: set[str], held: set[str]
) -> Iterator[Dyad]:
    """A link and the block it moves along a line of a known body."""
    arms = [p for p in link.points if p in held]
    mine = [g for g in guides if g.link == block.name and g.block and g.on in known]
    if len(arms) == 1 and mine and not set(block.points) & held:
        yield Dyad(pin=pin, links=(link.name, block.name), arms=(arms[0], ""), guide=mine[0])
