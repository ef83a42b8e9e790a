"""The reactions of a linkage as acts on its links: pins, parts, and the efforts of the inputs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.part import carriers
from linkwork.core.motion.model import Model
from linkwork.core.results.quantity import Kind
from linkwork.writers.workbook.acting import Act, Follower, Reading, Unknown, opposite


@dataclass
class Reactions:
    """All reactions.

    ``along`` has the unit vectors of lines by part, ``way`` those of contacts, whose places are
    points of the sheet; ``number`` gives a number of the sheet of loads by key.
    """

    model: Model
    linkage: Linkage
    along: dict[str, Any]
    way: dict[str, Any]
    number: Callable[[str], Any]
    unknowns: list[Unknown] = field(default_factory=list)
    followers: list[Follower] = field(default_factory=list)
    readings: list[Reading] = field(default_factory=list)

    def __post_init__(self) -> None:
        units = self.model.units
        self.force, self.moment = units.of(Kind.FORCE), units.of(Kind.MOMENT)
        self.carriers = carriers(self.linkage)
        self.joined = {
            point: [name for name in names if name in self.linkage.links]
            for point, names in self.carriers.items()
        }
        for point, links in self.joined.items():
            # loads on a pin act on its first link, so that this one needs no further unknown
            for other in links[1:]:
                stem = self.stem(point, "force", other)
                self.pair(f"{stem}.x", other, links[0], point, 1.0)
                self.pair(f"{stem}.y", other, links[0], point, 1j)

    def stem(self, point: str, what: str, link: str) -> str:
        """The name of a reaction on a link at a point that other links may share."""
        return f"{point}.{what}" if len(self.carriers[point]) < 3 else f"{point}.{what}.{link}"

    def pair(self, name: str, on: str, against: str, point: str, along: Any) -> None:
        """A force on one link at a point, and its reaction on another."""
        self.unknowns.append(Unknown(name, self.force, opposite(on, against, point, along)))

    def couple(self, name: str, on: str, against: str) -> None:
        """A moment on one link, and its reaction on another."""
        acts = Act(on, "", moment=1.0), Act(against, "", moment=-1.0)
        self.unknowns.append(Unknown(name, self.moment, acts))
