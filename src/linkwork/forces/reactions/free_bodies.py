"""Free bodies: the links of a mechanism with all forces and moments on them, in all rows.

Every joint contributes unknown forces; the equilibrium of all links determines them. Moments are
divided by the longest link, so that they compare with forces.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import (
    RANK_TOLERANCE,
    Array,
    BoolArray,
    ComplexArray,
    inverses,
    matrix_vector,
)
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.machine import Friction
from linkwork.core.mechanism.part.part import Part, carriers
from linkwork.core.results.quantity import Kind
from linkwork.forces.reactions.coupling import Size
from linkwork.forces.reactions.geometry import AppliedLoads, Geometry


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
    terms: tuple[tuple[int, Array | float], ...] = ()
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
        self.read(f"{name}.friction", kind, about, follow=own)

    def read(
        self, name: str, kind: Kind, about: str, unknown: int | None = None,
        factor: Array | float = 1.0, **further: Any,
    ) -> None:  # fmt: skip
        """Name an unknown, or a multiple of it; ``further`` fields of the :class:`Reading`."""
        terms = () if unknown is None else ((unknown, factor),)
        self.readings.append(Reading(name=name, kind=kind, about=about, terms=terms, **further))

    @property
    def rubs(self) -> bool:
        """Whether a joint has friction."""
        return any(follower.motion is not None for follower in self.following)

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


# ----------------------------------------------------------------------
# Solution of the equilibrium of free bodies, and which forces it does not determine.
#
# Forces on all bodies sum to zero: W r + b = 0, with W the transposed Jacobian of the joint
# conditions. Its null vectors are self-stresses: what they load is not determined. Null vectors of
# Wᵀ are freedoms in which nothing balances the loads, as at a dead point. Without both W is square
# and regular.


_REGULAR = 1e12  # condition up to which forces have digits
_BALANCED = 1e-8  # relative error of equilibrium
_LOADED = 1e-7  # part of a self-stress that counts as load


@dataclass(frozen=True, kw_only=True, eq=False)
class Balance:
    """The inverse of W in B rows.

    Parameters
    ----------
    matrix : (B, E, n)
    inverse : (B, n, E)
        A generalised inverse; NaN where W has no usable rank.
    stress : (B, n, n), optional
        The projector on self-stresses; ``None`` if there are none.
    """

    matrix: Array
    inverse: Array
    stress: Array | None

    def solve(self, loads: Array) -> Array:
        """The unknowns (B, n) for loads (B, E), refined once; NaN where nothing balances them."""
        # eq. (72)
        r = -matrix_vector(self.inverse, loads)
        # an explicit inverse loses digits where W is ill-conditioned
        rest = matrix_vector(self.matrix, r) + loads
        r -= matrix_vector(self.inverse, rest)
        if self.stress is not None:
            # loads on an idle freedom, or at a dead point, are not balanced by any force
            rest = np.abs(matrix_vector(self.matrix, r) + loads).max(axis=1, initial=0.0)
            size = np.abs(loads).max(axis=1, initial=0.0) + np.abs(r).max(axis=1, initial=0.0)
            r[~(rest <= _BALANCED * size)] = np.nan
        return r

    def undetermined(self, factors: Array) -> BoolArray:
        """Whether a self-stress changes Σ factor · unknown, (B,), for factors (B, n)."""
        if self.stress is None:
            return np.zeros(len(factors), dtype=bool)
        # eq. (73)
        part = np.linalg.norm(np.einsum("bi,bij->bj", factors, self.stress), axis=1)
        found: BoolArray = part > _LOADED * np.linalg.norm(factors, axis=1)
        return found


def balance(matrix: Array) -> Balance:
    """Invert W (B, E, n); rows that are not square or regular by singular values."""
    rows, equations, unknowns = matrix.shape
    size = _norms(matrix)
    fine = np.isfinite(size)
    inverse = np.full((rows, unknowns, equations), np.nan)
    regular = np.zeros(rows, dtype=bool)
    if equations == unknowns:
        if fine.all():
            inverse = inverses(matrix)
        else:
            inverse[fine] = inverses(matrix[fine])
        with np.errstate(all="ignore"):
            # forces and scaled moments have one unit, so that rows and columns compare
            regular = size * _norms(inverse) <= _REGULAR
    left = np.flatnonzero(fine & ~regular)
    if not len(left):
        return Balance(matrix=matrix, inverse=inverse, stress=None)
    stress = np.zeros((rows, unknowns, unknowns))
    # the square case is cheaper by far; self-stresses and idle freedoms need singular values
    u, sizes, vh = np.linalg.svd(matrix[left], full_matrices=False)
    kept = sizes > RANK_TOLERANCE * sizes[:, :1]
    with np.errstate(divide="ignore"):
        weights = np.where(kept, 1.0 / sizes, 0.0)
    used = np.where(kept[:, :, None], vh, 0.0)
    inverse[left] = np.einsum("bki,bk,bjk->bij", used, weights, u)
    # eq. (73)
    stress[left] = np.eye(unknowns) - np.einsum("bki,bkj->bij", used, used)
    return Balance(matrix=matrix, inverse=inverse, stress=stress)


def _norms(matrices: Array) -> Array:
    """The largest sum of sizes in a row of every matrix, (B,)."""
    # a product with ones adds up short rows several times faster than a sum
    rows, height, width = matrices.shape
    sums = np.abs(matrices).reshape(rows * height, width) @ np.ones(width)
    found: Array = sums.reshape(rows, height).max(axis=1, initial=0.0)
    return found
