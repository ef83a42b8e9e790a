"""Free bodies: the links of a mechanism with all forces and moments on them, in all rows.

Every joint contributes unknown forces; the equilibrium of all links determines them. Moments are
divided by the longest link, so that they compare with forces.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

from linkwork.forces.applied import AppliedLoads
from linkwork.forces.geometry import Geometry
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.names import GROUND
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.part import Part, carriers
from linkwork.results.quantity import Kind

__all__ = ["Act", "FreeBodies", "Holder", "Reading"]


@dataclass(frozen=True)
class Holder:
    """What a force on a point acts on: a body, for a shared point through its pin."""

    body: str
    pin: str = ""


@dataclass(frozen=True, eq=False)
class Act:
    """A force at a place and a moment on a body, (B,) each or constant."""

    on: Holder
    place: ComplexArray
    force: ComplexArray
    moment: Array | float = 0.0

    def times(self, factor: float) -> Act:
        """The act multiplied."""
        return Act(self.on, self.place, factor * self.force, factor * self.moment)


@dataclass(frozen=True, kw_only=True, eq=False)
class Reading:
    """A quantity Σ factor · unknown + constant, (B,) each, and the size of ``follow``.

    ``pushes``: the joint can only push, so that a negative value means that it lifts off.
    """

    name: str
    kind: Kind
    about: str
    terms: tuple[tuple[int, Array | float], ...]
    constant: Array | float = 0.0
    follow: int | None = None
    pushes: bool = False


@dataclass(eq=False)
class FreeBodies:
    """The links of a linkage, and what acts on them.

    ``unknowns`` are the acts of each unknown, ``following`` those whose size follows from another
    unknown: its number, the size as a function of it, the acts of a unit.
    """

    linkage: Linkage
    geometry: Geometry
    applied: AppliedLoads
    unknowns: list[tuple[Act, ...]] = field(default_factory=list)
    following: list[tuple[int, Callable[[Array], Array], tuple[Act, ...]]] = field(
        default_factory=list
    )
    readings: list[Reading] = field(default_factory=list)

    def __post_init__(self) -> None:
        links = self.linkage.links
        #: The links at every point, and cylinders, in the file's order.
        self.carriers = carriers(self.linkage)
        self.joined = {
            point: [name for name in names if name in links]
            for point, names in self.carriers.items()
        }
        #: Points that no link carries: pins between cylinders.
        self.free_points = [point for point, names in self.joined.items() if not names]
        self.bodies = [link for link in links if link != GROUND] + self.free_points

    def at(self, point: str) -> Holder:
        """What a force on a point acts on."""
        own = self.joined[point]
        # pins of cylinders alone are bodies themselves
        if not own:
            return Holder(point)
        return Holder(own[0], point if len(self.carriers[point]) > 1 else "")

    def link(self, link: str) -> Holder:
        """A link by itself."""
        return Holder(link)

    def pair(self, on: Holder, against: Holder, place: ComplexArray, along: ComplexArray) -> int:
        """An unknown force along a unit vector on one body, and its reaction on another."""
        return self.unknown(Act(on, place, along), Act(against, place, -along))

    def couple(self, on: Holder, against: Holder) -> int:
        """An unknown moment in units of force · longest link, and its reaction."""
        zero, size = np.zeros(1, dtype=complex), self.geometry.length
        return self.unknown(Act(on, zero, zero, size), Act(against, zero, zero, -size))

    def unknown(self, *acts: Act) -> int:
        """An unknown that multiplies acts; returns its number."""
        self.unknowns.append(acts)
        return len(self.unknowns) - 1

    def follow(self, unknown: int, size: Callable[[Array], Array], *acts: Act) -> int:
        """Acts whose size follows from an unknown, which they do not change; returns a number."""
        self.following.append((unknown, size, acts))
        return len(self.following) - 1

    def read(
        self, name: str, kind: Kind, about: str, unknown: int, factor: Array | float = 1.0,
        *, pushes: bool = False,
    ) -> None:  # fmt: skip
        """Name an unknown, or a multiple of it."""
        self.readings.append(
            Reading(name=name, kind=kind, about=about, terms=((unknown, factor),), pushes=pushes)
        )

    def matrix(self) -> Array:
        """The sum of forces and scaled moments on every body for a unit of each unknown.

        (B, E, n), E rows: two forces and a moment of every link, two forces of a free point.
        """
        # W of eq. (72)
        rows = np.zeros((self.geometry.rows, self.equations, len(self.unknowns)))
        for k, acts in enumerate(self.unknowns):
            for act in acts:
                self._add(rows[:, :, k], act)
        return rows

    def sums(self, acts: Iterable[Act]) -> Array:
        """The sums of forces and scaled moments of known acts, (B, E)."""
        rows = np.zeros((self.geometry.rows, self.equations))
        for act in acts:
            self._add(rows, act)
        return rows

    @property
    def equations(self) -> int:
        """E."""
        return 3 * len(self.bodies) - len(self.free_points)

    def _add(self, rows: Array, act: Act) -> None:
        for row, value in self.entries(act):
            rows[:, row] += value

    def entries(self, act: Act) -> Iterator[tuple[int, Array]]:
        """What an act adds to the sums of forces and scaled moments, by row."""
        # ground is not free: nothing has to balance there
        if act.on.body == GROUND:
            return
        k = self.bodies.index(act.on.body)
        links = len(self.bodies) - len(self.free_points)
        first = 3 * k if k < links else 3 * links + 2 * (k - links)
        yield first, act.force.real
        yield first + 1, act.force.imag
        # a pin between cylinders has no moment to balance
        if k < links:
            arm = act.place - self._centre(act.on.body)
            turning = (arm.conj() * act.force).imag + act.moment
            yield first + 2, turning / self.geometry.length

    def _centre(self, link: str) -> ComplexArray:
        """The place about which moments on a link are taken."""
        found: ComplexArray = self.geometry.place(self.linkage.links[link][0]).v
        return found

    def through(self, pin: str, acts: Iterable[Act]) -> ComplexArray:
        """The force of acts through a pin, (B,)."""
        total = np.zeros(self.geometry.rows, dtype=complex)
        for act in acts:
            if act.on.pin == pin:
                total = total + act.force
        return total

    @property
    def parts(self) -> tuple[Part, ...]:
        """The parts of the linkage."""
        return self.linkage.parts
