"""Friction of joints along a leg: reactions, friction and acceleration in one equilibrium.

Among the unknowns of the free bodies, the acceleration of the leader takes the place of the effort
of the input, so that a dead point needs no special case. Everything but friction itself is linear:
the answers to unit loads are functions of the leader's place alone, and are tabulated.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.numerics.newton import SolvedRows
from linkwork.forces.dynamics.collocation import Panels, fit_panels
from linkwork.forces.dynamics.reduction import Reduction
from linkwork.forces.reactions.coupling import Coupling, Sided, Size
from linkwork.forces.reactions.drives import drive_inputs, join_pins
from linkwork.forces.reactions.free_bodies import Act, FreeBodies, balance
from linkwork.forces.reactions.geometry import AppliedLoads
from linkwork.forces.reactions.parts import join_parts
from linkwork.forces.reactions.system import doubtful_followers

#: Positions with derivatives at values of the leader (B,), in any order.
Rows = Callable[[Array], SolvedRows]

_LOOKS = 9  # places at which the sizes of unit loads are compared
_STILL = 1e-12  # of the fastest motion: a joint that never moves
_TURNS_BACK = 1e-9  # of a joint's fastest motion: it is just turning back


@dataclass(frozen=True, kw_only=True, eq=False)
class Rubbing:
    """The signs of friction during a step.

    Parameters
    ----------
    direction : float
        1 or -1: that of the leader.
    ways : (K,)
        How the joints move as the leader grows: 1, -1, or 0.
    sides : tuple of int, optional
        The side of its edges on which every size is; ``None`` to take sizes as they are.
    """

    direction: float
    ways: Array
    sides: tuple[int, ...] | None = None

    @property
    def signs(self) -> Array:
        """Of what follows from reactions: of friction against the motion, (K,)."""
        return np.where(np.isnan(self.ways), 1.0, -self.direction * np.nan_to_num(self.ways))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Answers:
    """What unit loads do to the unknowns from which K sizes follow: (B, K, 2) each.

    ``still`` by weights and loads of position, ``bent`` by speed², ``motor`` by a unit of its
    torque, ``loads`` by units of all other loads, (B, K, 2, L), ``change`` by units of what
    follows, (B, K, 2, K); ``motions`` (B, K) by the leader; ``varying`` the factors of sizes.
    """

    still: Array
    bent: Array
    motor: Array
    loads: Array
    change: Array
    motions: Array
    varying: Array


class JointFriction:
    """Friction on a leg, from tables over the leader's place."""

    def __init__(
        self, reduction: Reduction, low: float, high: float, rows: Rows, steady: bool
    ) -> None:
        self.reduction, self.rows, self.steady = reduction, rows, steady
        looks = np.linspace(low, high, _LOOKS)
        first = _Bodies(reduction, rows(looks), steady)
        if first.doubtful.any():
            raise InputError(
                "friction acts in a joint whose force redundant links leave undetermined: leave "
                "out its friction, or release a link, to simulate"
            )
        #: Which sizes are friction, (K,).
        self.rubs = first.rubs
        self.sizes = first.sizes
        self.has_edges = any(size.side(np.ones(len(size.unknowns))) != 0 for size in self.sizes)
        self.loads = first.load_count
        least = first.scales
        #: The answers of a unit load compare with each other.
        self.table: Panels = fit_panels(
            lambda s: _Bodies(reduction, rows(s), steady).columns, (low, high), first.groups, least
        )
        self.fastest = np.abs(self._answers(looks).motions).max(axis=0)
        self.moving = self.fastest > _STILL * max(self.fastest.max(initial=0.0), first.pace)

    def _answers(self, s: Array) -> _Answers:
        columns, count = self.table(s), len(self.sizes)
        own = 2 * count
        parts = columns[:, : own * (3 + self.loads + count)].reshape(len(s), -1, count, 2)
        rest = columns[:, own * (3 + self.loads + count) :]
        parts = np.moveaxis(parts, 1, 3)
        return _Answers(
            still=parts[..., 0],
            bent=parts[..., 1],
            motor=parts[..., 2],
            loads=parts[..., 3 : 3 + self.loads],
            change=parts[..., 3 + self.loads :],
            motions=rest[:, :count],
            varying=rest[:, count:],
        )

    def ways(self, s: float, direction: float) -> Array:
        """How the joints move as the leader grows, at a place or just ahead of it, (K,)."""
        panel = int(self.table.locate(np.array([s]))[0][0])
        ahead = s + direction * 1e-6 * float(self.table.edges[panel + 1] - self.table.edges[panel])
        here, there = self._answers(np.array([s, ahead])).motions
        motion = np.where(np.abs(here) > _TURNS_BACK * self.fastest, here, there)
        found: Array = np.where(self.moving, np.sign(motion), 0.0)
        return np.where(self.rubs, found, np.nan)

    def hold(self, s: float, speed: float, known: Array, direction: float) -> Rubbing:
        """The signs for a motion from a state, with its ``known`` loads (1 + L,)."""
        ways = self.ways(s, direction)
        rubbing = Rubbing(direction=direction, ways=ways)
        if not self.has_edges:
            return rubbing
        answers = self._answers(np.array([s]))
        u, _ = self._solve(answers, np.array([speed]), known[None, :], rubbing)
        sides = tuple(
            size.side(np.nan_to_num(u[0, j, : len(size.unknowns)]))
            for j, size in enumerate(self.sizes)
        )
        return Rubbing(direction=direction, ways=ways, sides=sides)

    def force(self, s: Array, speed: Array, known: Array, rubbing: Rubbing) -> Array:
        """The generalised force of friction along the leader, (B,); NaN without equilibrium."""
        answers = self._answers(s)
        _, sizes = self._solve(answers, speed, known, rubbing)
        found: Array = (sizes * rubbing.signs * answers.motions)[:, self.rubs].sum(axis=1)
        return found

    def margins(self, s: Array, speed: Array, known: Array, rubbing: Rubbing) -> Array:
        """How far all joints are from turning back, and all sizes from their edges, (B, M)."""
        ways = np.nan_to_num(rubbing.ways)
        answers = self._answers(s)
        turning = np.where(ways != 0.0, ways * answers.motions, 1.0)[:, self.rubs]
        if rubbing.sides is None:
            return turning
        u, _ = self._solve(answers, speed, known, rubbing)
        inside = [
            size.inside(u[:, j, : len(size.unknowns)], side)
            for j, (size, side) in enumerate(zip(self.sizes, rubbing.sides, strict=True))
        ]
        return np.column_stack([turning, *inside])

    def _solve(
        self, answers: _Answers, speed: Array, known: Array, rubbing: Rubbing
    ) -> tuple[Array, Array]:
        """The unknowns of all sizes, (B, K, 2), and the sizes, (B, K)."""
        # eq. (94)
        start = answers.still + answers.bent * (speed**2)[:, None, None]
        start = start + answers.motor * known[:, 0, None, None]
        start = start + np.einsum("bjml,bl->bjm", answers.loads, known[:, 1:])
        change = answers.change * rubbing.signs
        sizes = self._sizes_at(answers.varying)
        if rubbing.sides is not None:
            sizes = [size.smooth(k) for size, k in zip(sizes, rubbing.sides, strict=True)]
        solved = Coupling(sizes=sizes, start=start, change=change, rubs=self.rubs).solve()
        u = start + np.einsum("bjmk,bk->bjm", change, solved.sizes)
        return u, solved.sizes

    def _sizes_at(self, varying: Array) -> list[Size]:
        """The sizes with the factors that they have at B places."""
        found: list[Size] = []
        taken = 0
        for size in self.sizes:
            if isinstance(size, Sided) and _varies(size):
                size = replace(size, plus=varying[:, taken], minus=varying[:, taken + 1])
                taken += 2
            found.append(size)
        return found


def _varies(size: Size) -> bool:
    return isinstance(size, Sided) and max(np.size(size.plus), np.size(size.minus)) > 1


class _Bodies:
    """The free bodies of B positions, in which the acceleration is unknown."""

    def __init__(self, reduction: Reduction, rows: SolvedRows, steady: bool) -> None:
        self.reduction, self.rows, self.steady = reduction, rows, steady
        linkage = reduction.description
        assert isinstance(linkage, Linkage)
        self.geometry = reduction.displaced(rows.v, rows.first, rows.second)
        self.bodies = FreeBodies(linkage, self.geometry, AppliedLoads(self.geometry, 1.0))
        with np.errstate(all="ignore"):
            join_pins(self.bodies)
            join_parts(self.bodies)
            self._join_motion()
            self.known = balance(self.bodies.matrix())

    def _join_motion(self) -> None:
        """Put the acceleration of the leader in the place of the effort."""
        reduction, rows, bodies = self.reduction, self.rows, self.bodies
        zero = np.zeros_like(rows.v)
        drive_inputs(bodies)
        ((column, factor),) = bodies.readings[-1].terms
        drive = [act.times(1.0 / factor) for act in bodies.unknowns[column]]
        lead = reduction.model.compiled.solver.unknowns
        flywheel = -reduction.inertia
        weight = self._masses(zero, zero)
        bent = self._masses(rows.first, rows.second)
        pushed = self._masses(zero, rows.first)
        bodies.unknowns[column] = (
            *_less(pushed, weight),
            *(act.times(flywheel * rows.first[:, lead]) for act in drive),
        )
        still = reduction.geometry(rows.v, zero, zero, np.zeros(len(rows.v)))
        given = self._unit_loads(reduction.loaded(still))
        steady = list(weight)
        if self.steady:
            steady += [act.times(amount) for acts, amount in given for act in acts]
            if reduction.motor is not None:
                steady += [act.times(reduction.motor.torque(np.zeros(1))[0]) for act in drive]
            given = []
        #: Acts of weights, of speed², of the motor, of all loads that vary.
        self.acting: list[Sequence[Act]] = [
            steady,
            [*_less(bent, weight), *(a.times(flywheel * rows.second[:, lead]) for a in drive)],
            drive if reduction.motor is not None and not self.steady else [],
            *(acts for acts, _ in given),
        ]
        self.load_count = len(given)

    def _masses(self, first: Array, second: Array) -> list[Act]:
        """Weight and inertia of all masses for given derivatives."""
        bodies = self.bodies
        applied = AppliedLoads(self.reduction.displaced(self.rows.v, first, second), 1.0)
        applied.weigh(self.reduction.description)
        return [
            Act(bodies.link(body.link), body.place, body.force, body.torque)
            for body in applied.masses
        ]

    def _unit_loads(self, applied: AppliedLoads) -> list[tuple[list[Act], Array]]:
        """A unit of every component of every load, and its amount."""
        bodies, geometry = self.bodies, self.geometry
        one, none = np.ones(geometry.rows, dtype=complex), np.zeros(geometry.rows, dtype=complex)
        found: list[tuple[list[Act], Array]] = []
        for point, force, link in applied.forces:
            on, place = bodies.link(link) if link else bodies.at(point), geometry.place(point).v
            found.append(([Act(on, place, one)], force.real))
            found.append(([Act(on, place, 1j * one)], force.imag))
        for link, torque in applied.torques:
            found.append(([Act(bodies.link(link), none, none, 1.0)], torque))
        return found

    @cached_property
    def sizes(self) -> list[Size]:
        return [follower.size for follower in self.bodies.following]

    @cached_property
    def rubs(self) -> BoolArray:
        """Which sizes are friction, (K,)."""
        return np.array([follower.motion is not None for follower in self.bodies.following])

    @cached_property
    def loads(self) -> list[Sequence[Act]]:
        """All that acts, and what follows."""
        return [*self.acting, *(follower.acts for follower in self.bodies.following)]

    @cached_property
    def answers(self) -> list[Array]:
        """The unknowns (B, n) for each of the loads."""
        return [self.known.solve(self.bodies.sums(acts)) for acts in self.loads]

    @property
    def doubtful(self) -> BoolArray:
        """Where a self-stress changes a size, (B, K)."""
        count = len(self.sizes)
        return doubtful_followers(self.bodies, self.known, self.answers[-count:])

    @property
    def columns(self) -> Array:
        """The columns of the table, (B, C)."""
        rows, count = self.geometry.rows, len(self.sizes)
        parts = np.zeros((rows, len(self.loads), count, 2))
        for k, answer in enumerate(self.answers):
            for j, size in enumerate(self.sizes):
                for m, own in enumerate(size.unknowns):
                    parts[:, k, j, m] = answer[:, own]
        motions = np.zeros((rows, count))
        for j, follower in enumerate(self.bodies.following):
            if follower.motion is not None:
                motions[:, j] = np.broadcast_to(follower.motion, (1, rows))[0]
        return np.column_stack([parts.reshape(rows, -1), motions, *self._varying])

    @property
    def _varying(self) -> list[Array]:
        """Factors of sizes that vary."""
        sides = [
            side
            for size in self.sizes
            if isinstance(size, Sided) and _varies(size)
            for side in (size.plus, size.minus)
        ]
        return [np.broadcast_to(side, self.geometry.rows) for side in sides]

    @property
    def groups(self) -> IndexArray:
        """What compares with each other: the answers of a load."""
        count, loads = len(self.sizes), len(self.loads)
        own = np.repeat(np.arange(loads), 2 * count)
        return np.concatenate([own, loads + np.arange(count + len(self._varying))])

    @property
    def scales(self) -> Array:
        """The least size of every column: that of its load, (C,)."""
        length = self.geometry.length
        sizes = []
        for acts in self.loads:
            pushes = [np.abs(act.force) + np.abs(act.moment) / length for act in acts]
            largest = max((float(np.max(push)) for push in pushes), default=0.0)
            sizes.append(largest or 1.0)
        own = np.repeat(sizes, 2 * len(self.sizes))
        rates = np.full(len(self.sizes), self.pace)
        return np.concatenate([own, rates, np.ones(len(self._varying))])

    @property
    def pace(self) -> float:
        """The fastest motion of all links."""
        return float(self.geometry.fastest.max())


def _less(acts: Sequence[Act], other: Sequence[Act]) -> list[Act]:
    """The differences of acts in the same places."""
    return [
        Act(a.on, a.place, a.force - b.force, a.moment - b.moment)
        for a, b in zip(acts, other, strict=True)
    ]
