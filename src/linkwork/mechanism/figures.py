"""Geometric figures that parts are drawn as: discs, contours and guides."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import ClassVar

from linkwork.foundation.names import GROUND

__all__ = ["Contour", "Disc", "Figure", "Guide", "Mesh", "Outlines"]

#: Body, centre and points about it in the body's frame of every outline, by name.
Outlines = Mapping[str, tuple[str, str, Iterable[complex]]]


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A figure of a part.

    ``over`` tells that it is drawn over the links, not under them; ``shown_again`` that it is
    drawn in further positions of a motion too.
    """

    over: ClassVar[bool] = False
    shown_again: ClassVar[bool] = False

    name: str

    @property
    def pins(self) -> tuple[str, ...]:
        """Points that are drawn as pins, however few links they are on."""
        return ()

    @property
    def ends(self) -> tuple[str, ...]:
        """Points to which the figure is fastened."""
        return ()

    @property
    def laid_by(self) -> tuple[str, ...]:
        """Points of the ground that only tell where the figure lies."""
        return ()

    @property
    def travelling(self) -> tuple[str, ...]:
        """Points whose whole travel belongs to the picture."""
        return ()

    @property
    def extent(self) -> tuple[str, ...]:
        """Points up to which the figure reaches where no motion tells it."""
        return ()

    @property
    def turns_with(self) -> tuple[str, str] | None:
        """The two points whose line the figure turns with."""
        return None


@dataclass(frozen=True, kw_only=True)
class Disc(Figure):
    """A round part of a link about one of its points.

    ``kind`` is gear, pulley, wheel or roller; a ``ring`` has what it touches inside. ``teeth`` is
    their number, if it is known.
    """

    link: str
    center: str
    radius: float
    kind: str
    ring: bool = False
    teeth: int | None = None

    @property
    def pins(self) -> tuple[str, ...]:
        return (self.center,) if self.kind == "roller" else ()

    @property
    def key(self) -> tuple[str, str, str]:
        """What it shares with the same wheel in another mesh: radii from teeth are rounded."""
        return (self.link, self.center, f"{self.radius:.9g}")


@dataclass(frozen=True, kw_only=True)
class Mesh(Figure):
    """Two gears whose teeth are in mesh; one may be a ring."""

    discs: tuple[Disc, Disc]


@dataclass(frozen=True, kw_only=True)
class Contour(Figure):
    """An outline of a link: points about its ``center`` in the link's frame.

    ``filled`` tells a body from a line on a body.
    """

    shown_again: ClassVar[bool] = True
    filled: ClassVar[bool] = True

    link: str
    center: str
    points: tuple[complex, ...]
    closed: bool = True

    @property
    def laid_by(self) -> tuple[str, ...]:
        return (self.center,) if self.link == GROUND else ()


@dataclass(frozen=True, kw_only=True)
class Guide(Figure):
    """A slider or slot: ``point`` runs along the line through two points of the body ``on``.

    ``offset`` is the distance of ``point`` to the left of the line. ``block`` tells a sliding
    block (prismatic joint) from a pin in a slot; ``link`` is the one that slides.
    """

    point: str
    on: str
    line: tuple[str, str]
    offset: float = 0.0
    block: bool = False
    link: str = ""

    @property
    def pins(self) -> tuple[str, ...]:
        return () if self.block else (self.point,)
