"""Geometric figures of parts: discs, contours and guides."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import ClassVar

from linkwork.foundation.names import GROUND

__all__ = ["Contour", "Disc", "Figure", "Guide", "Mesh", "Outline", "Outlines", "circle"]

_CORNERS = 72  # of a circle

#: Body, centre, and points relative to it in the body's frame [length].
Outline = tuple[str, str, Iterable[complex]]
#: Outlines by name.
Outlines = Mapping[str, Outline]


def circle(radius: float) -> list[complex]:
    """Corners of a circle about the origin [length]."""
    return [cmath.rect(radius, math.tau * k / _CORNERS) for k in range(_CORNERS)]


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A figure of a part.

    ``over``: drawn over the links, not under them; ``shown_again``: also drawn in further positions
    of a motion.
    """

    over: ClassVar[bool] = False
    shown_again: ClassVar[bool] = False

    name: str

    @property
    def pins(self) -> tuple[str, ...]:
        """Points always drawn as pins, regardless of the number of their links."""
        return ()

    @property
    def ends(self) -> tuple[str, ...]:
        """Points to which the figure is attached."""
        return ()

    @property
    def laid_by(self) -> tuple[str, ...]:
        """Ground points that only locate the figure."""
        return ()

    @property
    def travelling(self) -> tuple[str, ...]:
        """Points whose whole path must be inside the picture."""
        return ()

    @property
    def extent(self) -> tuple[str, ...]:
        """Points that give the extent of the figure without a motion."""
        return ()

    @property
    def turns_with(self) -> tuple[str, str] | None:
        """The two points whose line rotates with the figure."""
        return None


@dataclass(frozen=True, kw_only=True)
class Disc(Figure):
    """A round part of a link about one of its points.

    ``kind`` is gear, pulley, wheel or roller; a ``ring`` surrounds its partner. ``teeth`` is the
    number of teeth, if known.
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
        """A key equal for the same wheel in another mesh: radii from teeth are rounded."""
        return (self.link, self.center, f"{self.radius:.9g}")


@dataclass(frozen=True, kw_only=True)
class Mesh(Figure):
    """Two gears whose teeth are in mesh; one may be a ring."""

    discs: tuple[Disc, Disc]


@dataclass(frozen=True, kw_only=True)
class Contour(Figure):
    """An outline of a link: points about its ``center`` in the link's frame.

    ``filled`` marks a body; otherwise it is a line on a body.
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

    ``offset`` is the distance of ``point`` to the left of the line. ``block`` marks a sliding
    block (prismatic joint), otherwise a pin in a slot; ``link`` is the sliding link.
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
