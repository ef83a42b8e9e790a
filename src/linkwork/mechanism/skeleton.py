"""The structure of a drawing without coordinates: bars, rails, pins, figures and traces."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

from linkwork.foundation.names import GROUND
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.figures import Disc, Figure, Guide, Mesh, Outlines
from linkwork.mechanism.part.cylinder import Strut
from linkwork.mechanism.part.weld import RigidJoint
from linkwork.mechanism.question import Question

__all__ = ["Bar", "DrivenPart", "Rail", "Skeleton"]

F = TypeVar("F", bound=Figure)


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A rigid link and its points; three or more form a filled polygon."""

    name: str
    points: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Rail:
    """A straight line along which points of one body move; ``name`` is the variable of their
    displacement.

    On ground ``along`` is its direction, a unit vector; on a link it runs from the first to the
    second point of ``line``.
    """

    name: str
    points: tuple[str, ...]
    along: complex = 1.0 + 0.0j
    on: str = GROUND
    line: tuple[str, str] | None = None


@dataclass(frozen=True, kw_only=True)
class DrivenPart:
    """The driven part: ``kind`` is link, slider or cylinder; ``pivot`` is a pin of the link.

    ``backwards``: the driven quantity decreases.
    """

    kind: str
    name: str
    pivot: str | None = None
    backwards: bool = False


@dataclass(frozen=True, kw_only=True)
class Skeleton:
    """The data of a picture except coordinates.

    ``fixed`` are the points on ground, ``pins`` the points where bodies are joined; ``questions``
    are asked beside the picture.
    """

    fixed: tuple[str, ...] = ()
    bars: tuple[Bar, ...] = ()
    pins: tuple[str, ...] = ()
    guides: tuple[Guide, ...] = ()
    rails: tuple[Rail, ...] = ()
    struts: tuple[Strut, ...] = ()
    driven: tuple[DrivenPart, ...] = ()
    traced: tuple[str, ...] = ()
    figures: tuple[Figure, ...] = ()
    questions: tuple[Question, ...] = ()

    @classmethod
    def of_linkage(cls, linkage: Draft, outlines: Outlines) -> Skeleton:
        """The skeleton of a points-and-links mechanism.

        ``outlines``: body, centre and points of every cam and curve by name.
        """
        carriers = linkage.carriers()
        figures = _merged(f for part in linkage.parts for f in part.figures(linkage, outlines))
        pinned = {point for figure in figures for point in figure.pins}
        return cls(
            fixed=linkage.links[GROUND],
            bars=tuple(
                Bar(name=name, points=points)
                for name, points in linkage.links.items()
                if name != GROUND
            ),
            pins=tuple(p for p, n in _bodies(carriers, figures).items() if n > 1 or p in pinned),
            guides=tuple(figure for figure in figures if isinstance(figure, Guide)),
            struts=tuple(figure for figure in figures if isinstance(figure, Strut)),
            driven=tuple(_driven_parts(linkage, carriers)),
            traced=linkage.trace,
            figures=tuple(f for f in figures if not isinstance(f, Guide | Strut)),
        )

    def of(self, kind: type[F]) -> tuple[F, ...]:
        """The figures of one kind."""
        return tuple(figure for figure in self.figures if isinstance(figure, kind))

    @classmethod
    def of_points(
        cls,
        links: Mapping[str, tuple[str, ...]],
        fixed: tuple[str, ...],
        traced: tuple[str, ...],
        driven: tuple[DrivenPart, ...],
        rails: tuple[Rail, ...] = (),
    ) -> Skeleton:
        """The skeleton of a mechanism given by equations: its drawable points and links."""
        bars = tuple(
            Bar(name=name, points=points) for name, points in links.items() if name != GROUND
        )
        joined = [p for points in links.values() for p in points]
        bodies = Counter([*joined, *fixed, *_joined_to_blocks(links, rails)])
        pins = tuple(p for p in dict.fromkeys(joined) if bodies[p] > 1)
        return cls(fixed=fixed, bars=bars, pins=pins, rails=rails, driven=driven, traced=traced)


def _joined_to_blocks(
    links: Mapping[str, tuple[str, ...]], rails: tuple[Rail, ...]
) -> Iterator[str]:
    """Points at which a non-sliding link is joined to a block on a rail."""
    for rail in rails:
        for points in links.values():
            on = [point for point in points if point in rail.points]
            yield from on if len(on) < len(points) else ()


def _merged(figures: Iterable[Figure]) -> list[Figure]:
    """Figures without duplicate wheels, wheels first; teeth may be known from one mesh only."""
    found: dict[tuple[str, str, str], Disc] = {}
    others: list[Figure] = []
    for figure in figures:
        if not isinstance(figure, Disc):
            others.append(figure)
            continue
        known = found.setdefault(figure.key, figure)
        if known.teeth is None and figure.teeth is not None:
            found[figure.key] = replace(known, teeth=figure.teeth)
    for k, figure in enumerate(others):
        if isinstance(figure, Mesh):
            first, second = figure.discs
            others[k] = replace(figure, discs=(found[first.key], found[second.key]))
    return [*found.values(), *others]


def _bodies(carriers: Mapping[str, list[str]], figures: Iterable[Figure]) -> Mapping[str, int]:
    """The number of bodies at each point; links welded there count as one."""
    welded = [joint.point for joint in figures if isinstance(joint, RigidJoint)]
    return {point: len(links) - welded.count(point) for point, links in carriers.items()}


def _driven_parts(linkage: Draft, carriers: Mapping[str, list[str]]) -> list[DrivenPart]:
    found = []
    for which in linkage.inputs:
        kind, name = which.drives
        back = linkage.falls(which)
        if kind == "joint":
            part = DrivenPart(kind="link", name=carriers[name][-1], pivot=name, backwards=back)
            found.append(part)
        elif kind == "link":
            base = linkage.links[which.relative_to or GROUND]
            shared = [p for p in linkage.links[name] if p in base]
            pivot = shared[0] if shared else None
            found.append(DrivenPart(kind="link", name=name, pivot=pivot, backwards=back))
        else:
            found.append(DrivenPart(kind=kind, name=name, backwards=back))
    return found
