"""The linear coupling as a part of a mechanism: its keys, checks and figure."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from linkwork.core.foundation.errors import choices
from linkwork.core.foundation.values import Key, ListOf, NumberValue, Text
from linkwork.core.mechanism.bodies import Bodies, Figure, Outlines
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.part.guides import Cylinder, GuidePart
from linkwork.core.mechanism.part.part import (
    LINK,
    Coupling,
    Inversion,
    JointKind,
    KinematicPairs,
    NamedPart,
    PartChecks,
)

Weights = tuple[tuple[str, float], ...]


@dataclass(frozen=True, kw_only=True)
class CouplingLine(Figure):
    """A dashed line between two coupled parts, to the middle between two points of each."""

    over: ClassVar[bool] = True

    spans: tuple[tuple[str, str], ...]


@dataclass(frozen=True, kw_only=True)
class LinearCoupling(NamedPart):
    """Two lengths, two angles, or a length and an angle that change in a fixed ratio.

    q2 - ratio · q1 = offset: the oil between a master and a slave cylinder, a rope over pulleys, a
    train of wheels that is not drawn. With a radius, length - radius · angle = offset: a drum.

    Parameters
    ----------
    name : str
        The name of the coupling.
    lengths : (str, str), optional
        Two displacements or lengths: names of sliders, slots or cylinders.
    links : (str, str), optional
        Instead: two links, whose angles are coupled.
    link, length : str, optional
        Instead: a drum, and the length that it winds up.
    on : str
        The link from which angles are measured.
    ratio : number, optional
        Change of the second per change of the first of ``lengths`` or ``links``.
    radius : number, optional
        Change of ``length`` per radian of ``link`` [length]; negative if it shortens.
    offset : number, optional
        The second of both, or ``length``, where the other one is zero [length, or the file's angle
        unit]; by default as sketched.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.LinearCoupling(name="oil", lengths=("master", "slave"), ratio=-0.5).ratio
    -0.5
    """

    wing: ClassVar[str] = "linkwork.couplings"
    title = "Linear coupling"
    doc = "Two lengths or angles change in a fixed ratio: coupled cylinders, a rope and a drum"
    keys = (
        Key("name", Text(), "Name of the coupling", required=True),
        Key("lengths", ListOf(Text(), "length", 2, 2), "Two sliders, slots or cylinders"),
        Key("links", ListOf(Text(), "link", 2, 2), "Or two links, whose angles are coupled"),
        Key("link", LINK, "Or one link, a drum"),
        Key("length", Text(of="length"), "and the slider, slot or cylinder that it moves"),
        Key("on", LINK, "The link from which angles are measured; default ground"),
        Key("ratio", NumberValue(), "Change of the second per change of the first"),
        Key("radius", NumberValue("length"), "With link and length: length per radian"),
        Key("offset", NumberValue("free"), "The second where the first is zero; default: sketched"),
    )
    kind = JointKind("L", 2, "linear coupling")

    lengths: tuple[str, str] | None = None
    links: tuple[str, str] | None = None
    link: str | None = None
    length: str | None = None
    on: str = "ground"
    ratio: Number | None = None
    radius: Number | None = None
    offset: Number | None = None

    @property
    def pushes(self) -> tuple[str, ...]:
        return self.lengths or ((self.length,) if self.length is not None else ())

    @property
    def turning(self) -> tuple[str, ...]:
        return self.links or ((self.link,) if self.link is not None else ())

    def joined(self, linkage: Bodies) -> tuple[str, ...]:
        return (
            *self.turning,
            *(self.moved(linkage, name).joined(linkage)[0] for name in self.pushes),
        )

    @staticmethod
    def moved(linkage: Bodies, name: str) -> GuidePart | Cylinder:
        """The slider, slot or cylinder with this name."""
        parts: tuple[GuidePart | Cylinder, ...] = (*linkage.of(GuidePart), *linkage.of(Cylinder))
        return next(part for part in parts if part.name == name)

    def weights(self, linkage: Bodies) -> tuple[Weights, Weights]:
        """The factors of angles of links and of lengths whose sum is the offset."""
        if self.link is not None:
            assert self.length is not None
            assert self.radius is not None
            radius = linkage.numbers(self.radius)
            return ((self.link, -radius), (self.on, radius)), ((self.length, 1.0),)
        assert self.ratio is not None
        ratio = linkage.numbers(self.ratio)
        first, second = self.links or self.lengths or ("", "")
        pair = ((first, -ratio), (second, 1.0))
        return ((*pair, (self.on, ratio - 1.0)), ()) if self.links is not None else ((), pair)

    def pairs(self, linkage: Bodies) -> KinematicPairs:
        turns, slides = self.weights(linkage)
        return KinematicPairs(couplings=(Coupling(name=self.name, turns=turns, slides=slides),))

    def check(self, checks: PartChecks) -> None:
        """Check for one of the three pairs, with its factor."""
        drum = self.link is not None or self.length is not None
        given = [self.lengths is not None, self.links is not None, drum]
        if sum(given) != 1 or (self.link is None) != (self.length is None):
            checks.add("needs either two lengths, two links, or a link and a length")
            return
        used, unused = ("radius", "ratio") if drum else ("ratio", "radius")
        if getattr(self, unused) is not None:
            pair = "a link and a length" if drum else "two lengths or two links"
            checks.add(f"does not fit {pair}: give {used}", unused)
        if getattr(self, used) is None:
            checks.add("is missing", used)
        elif checks.amount(getattr(self, used), used) == 0:
            checks.add("must not be zero: the coupling would hold one of both still", used)
        if self.offset is not None:
            checks.amount(self.offset, "offset")
        if self.lengths is not None:
            checks.two(self.lengths, "length", "lengths")
        known = {p.name for kind in (GuidePart, Cylinder) for p in checks.linkage.of(kind)}
        for name in self.pushes:
            if name not in known:
                listed = choices("sliders, slots and cylinders", sorted(known), name)
                checks.add(f'"{name}" is not defined {listed}', "length" if drum else "lengths")
        field = "link" if drum else "links"
        if self.links is not None and not checks.two(self.links, "link", field):
            return
        for link in self.turning:
            if checks.link(link, field) and link == self.on:
                checks.add(f'"{link}" is the link from which angles are measured', field)
        checks.link(self.on, "on")

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        spans = []
        for name in self.pushes:
            part = self.moved(linkage, name)
            point = "" if isinstance(part, Cylinder) else part.point_on_line
            spans.append(part.between if isinstance(part, Cylinder) else (point, point))
        for link in self.turning:
            pivots = [point for point in linkage.links[link] if point in linkage.links[self.on]]
            pivot = (pivots or linkage.links[link])[0]
            spans.append((pivot, pivot))
        yield CouplingLine(name=self.name, spans=tuple(spans))

    def inverted(self, inversion: Inversion) -> Self:
        """The coupling with the offset of the assembled position."""
        return replace(super().inverted(inversion), offset=None)
