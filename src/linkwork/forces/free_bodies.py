"""Free bodies: the links of a mechanism with all forces and moments on them, in all rows.

Every joint contributes unknown forces; the equilibrium of all links determines them. Moments are
divided by the longest link, so that they compare with forces.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

from linkwork.forces.applied import AppliedLoads
from linkwork.forces.geometry import Geometry
from linkwork.forces.size import Size
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.names import GROUND
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.friction import Friction
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.part import Part, carriers
from linkwork.results.quantity import Kind

__all__ = ["Act", "Follower", "FreeBodies", "Holder", "Reading"]


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

    def times(self, factor: Array | float) -> Act:
        """The act multiplied."""
        return Act(self.on, self.place, factor * self.force, factor * self.moment)


@dataclass(frozen=True, kw_only=True, eq=False)
class Follower:
    """Acts whose size follows from unknowns.

    ``motion``: of friction, the relative motion that it opposes, per unit of each input, (p, B) in
    radians or lengths; the acts are those of a unit along this motion.
    """

    size: Size
    acts: tuple[Act, ...]
    motion: Array | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Reading:
    """A quantity Σ factor · unknown + constant, (B,) each, and the amount of ``follow``.

    ``pushes``: the joint can only push, so that a negative value means that it lifts off;
    ``adhesion``: it slips beyond this part of an unknown. ``pin``: of a force in a pin its point,
    the link on which it acts, and the one that exerts it, "" if several do.
    """

    name: str
    kind: Kind
    about: str
    terms: tuple[tuple[int, Array | float], ...]
    constant: Array | float = 0.0
    follow: int | None = None
    pushes: bool = False
    adhesion: tuple[int, float] | None = None
    pin: tuple[str, ...] = ()


@dataclass(eq=False)
class FreeBodies:
    """The links of a linkage, and what acts on them.

    ``unknowns`` are the acts of each unknown, ``following`` those whose sizes follow from unknowns.
    """

    linkage: Linkage
    geometry: Geometry
    applied: AppliedLoads
    unknowns: list[tuple[Act, ...]] = field(default_factory=list)
    following: list[Follower] = field(default_factory=list)
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

    def follow(self, size: Size, *acts: Act, motion: Array | None = None) -> int:
        """Acts whose size follows from unknowns, or friction; returns their number."""
        self.following.append(Follower(size=size, acts=acts, motion=motion))
        return len(self.following) - 1

    def friction(self, joint: str) -> Friction | None:
        """The friction of a pin or part."""
        return self.linkage.friction.get(joint)

    def number(self, number: Number | None) -> float:
        """A number of the file that is given."""
        assert number is not None
        return self.linkage.numbers(number)

    def rub_couple(self, name: str, size: Size, on: Holder, against: Holder) -> None:
        """Friction as a moment between two bodies."""
        geometry = self.geometry
        turning = geometry.turning(on.body) - geometry.turning(against.body)
        zero = np.zeros(1, dtype=complex)
        acts = (Act(on, zero, zero, 1.0), Act(against, zero, zero, -1.0))
        self._rub(name, Kind.MOMENT, f"moment of friction on {on.body}", size, acts, turning)

    def rub_force(
        self, name: str, size: Size, pair: tuple[Holder, Holder], place: ComplexArray,
        along: ComplexArray, sliding: ComplexArray,
    ) -> None:  # fmt: skip
        """Friction as a force between two bodies along a unit vector, with the velocity of sliding
        of the first on the second, (p, B).
        """
        on, against = pair
        acts = (Act(on, place, along), Act(against, place, -along))
        motion = (np.conj(along) * sliding).real
        about = f"force of friction on {on.pin or on.body}"
        self._rub(name, Kind.FORCE, about, size, acts, motion)

    def _rub(
        self, name: str, kind: Kind, about: str, size: Size, acts: tuple[Act, ...], motion: Array
    ) -> None:
        own = self.follow(size, *acts, motion=motion)
        self.readings.append(
            Reading(name=f"{name}.friction", kind=kind, about=about, terms=(), follow=own)
        )

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
        # all rows of one entry side by side, as acts have them
        entries = np.zeros((self.equations, len(self.unknowns), self.geometry.rows))
        for k, acts in enumerate(self.unknowns):
            for act in acts:
                self._add(entries[:, k], act)
        return np.ascontiguousarray(entries.transpose(2, 0, 1))

    def sums(self, acts: Iterable[Act]) -> Array:
        """The sums of forces and scaled moments of known acts, (B, E)."""
        sums = np.zeros((self.equations, self.geometry.rows))
        for act in acts:
            self._add(sums, act)
        return np.ascontiguousarray(sums.T)

    @property
    def equations(self) -> int:
        """E."""
        return 3 * len(self.bodies) - len(self.free_points)

    def _add(self, sums: Array, act: Act) -> None:
        for row, value in self.entries(act):
            sums[row] += value

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
