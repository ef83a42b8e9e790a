"""The kinematic pairs of a part: pins, slides, rigid joints, and fixed ratios of turns."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

__all__ = [
    "AddedBody",
    "Coupling",
    "KinematicPairs",
    "Pair",
    "PairKind",
    "meshing",
    "sliding_block",
]


class PairKind(Enum):
    """How two bodies are joined; the value is the order in which a tree takes the pairs."""

    FIXED = 0
    SLIDE = 1
    PIN = 2


@dataclass(frozen=True, kw_only=True)
class Pair:
    """A pair of two bodies.

    ``point`` is its place; a slide is along ``line`` of the first body, and its displacement is
    the variable ``name``.
    """

    kind: PairKind
    name: str
    bodies: tuple[str, str]
    point: str
    line: tuple[str, str] | None = None


@dataclass(frozen=True, kw_only=True)
class Coupling:
    """A sum of multiples of the angles of bodies and of displacements that is constant."""

    name: str
    turns: tuple[tuple[str, float], ...]
    slide: tuple[str, float] | None = None


@dataclass(frozen=True, kw_only=True)
class AddedBody:
    """A body of the part that is no link.

    ``angle`` is the variable that is its angle, or it turns with the body ``on`` which it slides;
    ``pinned``: whether links that have its points are pinned to it there.
    """

    name: str
    points: tuple[str, ...]
    angle: str = ""
    on: str = ""
    pinned: bool = False


@dataclass(frozen=True, kw_only=True)
class KinematicPairs:
    """The bodies that a part adds, its pairs, and its couplings."""

    bodies: tuple[AddedBody, ...] = ()
    pairs: tuple[Pair, ...] = ()
    couplings: tuple[Coupling, ...] = ()

    def with_pin(self, link: str) -> KinematicPairs:
        """A copy in which a link is pinned to the body that the part adds."""
        (body,) = self.bodies
        (point,) = body.points
        pin = Pair(kind=PairKind.PIN, name=point, bodies=(body.name, link), point=point)
        return replace(self, pairs=(*self.pairs, pin))


def sliding_block(name: str, on: str, line: tuple[str, str], point: str) -> KinematicPairs:
    """A block at a point that slides along a line of a body."""
    block = AddedBody(name=f"{name} block", points=(point,), on=on)
    ends = (on, block.name)
    slide = Pair(kind=PairKind.SLIDE, name=name, bodies=ends, point=point, line=line)
    return KinematicPairs(bodies=(block,), pairs=(slide,))


def meshing(
    name: str, wheels: tuple[str, str], arm: str, radii: tuple[float, float], *, outside: bool
) -> Coupling:
    """The coupling of two wheels on an arm: r1 (θ1 - θarm) ± r2 (θ2 - θarm) is constant."""
    first, second = radii[0], radii[1] if outside else -radii[1]
    turns = ((wheels[0], first), (wheels[1], second), (arm, -first - second))
    return Coupling(name=name, turns=turns)
