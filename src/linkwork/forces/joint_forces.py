"""The forces of all joints: unknowns by equilibrium, friction and what else follows from them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.forces.coupling import Coupling
from linkwork.forces.equilibrium import Balance, balance
from linkwork.forces.free_bodies import Act, FreeBodies, Reading
from linkwork.foundation.arrays import Array, BoolArray

__all__ = ["FrictionEfforts", "JointForces", "doubtful_followers", "joint_forces"]

_STRESSED = 1e-9  # part of a doubtful force that makes another one doubtful
_AT_REST = 1e-12  # of the fastest motion: rounding of a joint that does not move


@dataclass(frozen=True, kw_only=True, eq=False)
class FrictionEfforts:
    """What friction adds to the efforts of p inputs in B rows.

    Parameters
    ----------
    efforts, largest : (p, B)
        The sum of its terms, and the size of the largest one.
    doubt : (B,)
        Where a self-stress changes the sum.
    """

    efforts: Array
    largest: Array
    doubt: BoolArray


@dataclass(frozen=True, kw_only=True, eq=False)
class JointForces:
    """The solution in B rows: n unknowns and K amounts of what follows from them.

    Parameters
    ----------
    unknowns : (B, n)
    amounts : (B, K)
        Times the acts of the followers; of friction opposite to the motion.
    doubtful : (B, K)
        Where a self-stress changes an amount.
    found, proved : (B,)
        Whether friction leaves an equilibrium, and whether this is proved.
    """

    bodies: FreeBodies
    balance: Balance
    answers: Sequence[Array]
    unknowns: Array
    amounts: Array
    doubtful: BoolArray
    found: BoolArray
    proved: BoolArray

    def read(self, reading: Reading) -> tuple[Array, BoolArray]:
        """A reading and where it is not determined, (B,) each."""
        value: Array = np.zeros(len(self.unknowns)) + reading.constant
        for k, factor in reading.terms:
            value += factor * self._given[:, k]
        if reading.follow is not None:
            value += self.amounts[:, reading.follow]
        if self.balance.stress is None and not self.doubtful.any():
            return value, np.zeros(len(value), dtype=bool)
        factors = np.zeros_like(self.unknowns)
        for k, factor in reading.terms:
            factors[:, k] += factor
        doubt = self.balance.undetermined(factors)
        for k, answer in enumerate(self.answers):
            change = np.abs((factors * answer).sum(axis=1))
            doubt |= self.doubtful[:, k] & ((change > _STRESSED) | (reading.follow == k))
        return value, doubt

    @cached_property
    def _given(self) -> Array:
        """The unknowns; 0 where they do not exist, for readings that need none of them."""
        return np.nan_to_num(self.unknowns)

    def acts(self) -> Iterable[Act]:
        """What follows from the unknowns."""
        for follower, amount in zip(self.bodies.following, self.amounts.T, strict=True):
            for act in follower.acts:
                yield Act(act.on, act.place, act.force * amount, act.moment * amount)

    def friction_efforts(self) -> FrictionEfforts:
        """What friction adds to the efforts."""
        rows, inputs = len(self.unknowns), len(self.bodies.geometry.input_rates)
        total, largest = np.zeros((inputs, rows)), np.zeros((inputs, rows))
        doubt = np.zeros(rows, dtype=bool)
        for k, follower in enumerate(self.bodies.following):
            if follower.motion is None:
                continue
            term = self.amounts[:, k] * follower.motion
            total -= term
            largest = np.maximum(largest, np.abs(term))
            doubt |= self.doubtful[:, k] & (np.abs(follower.motion) > 0.0).any(axis=0)
        return FrictionEfforts(efforts=total, largest=largest, doubt=doubt)


def joint_forces(bodies: FreeBodies, acts: Iterable[Act], direction: Array) -> JointForces:
    """Solve the equilibrium of all bodies under known acts.

    Parameters
    ----------
    direction : (B,)
        1 or -1: which way the leading input moves, or is about to.
    """
    known = balance(bodies.matrix())
    start = known.solve(bodies.sums(acts))
    followers = bodies.following
    rows, count = len(start), len(followers)
    signs = np.ones((rows, count))
    for k, follower in enumerate(followers):
        if follower.motion is not None:
            signs[:, k] = -_way(follower.motion, bodies) * direction
    # the equations are linear: what follows is added to the first solution
    answers = [known.solve(bodies.sums(follower.acts)) for follower in followers]
    if not count:
        every = np.ones(rows, dtype=bool)
        return JointForces(
            bodies=bodies, balance=known, answers=(), unknowns=start, amounts=np.zeros((rows, 0)),
            doubtful=np.zeros((rows, 0), dtype=bool), found=every, proved=every,
        )  # fmt: skip
    # friction in a stressed joint is as unknown as its force
    doubtful = doubtful_followers(bodies, known, answers)
    first, change = np.zeros((rows, count, 2)), np.zeros((rows, count, 2, count))
    for j, follower in enumerate(followers):
        for m, own in enumerate(follower.size.unknowns):
            first[:, j, m] = start[:, own]
            for k, answer in enumerate(answers):
                # what is not determined must not spoil the rest
                change[:, j, m, k] = np.where(doubtful[:, k], 0.0, answer[:, own] * signs[:, k])
    rubs = np.array([follower.motion is not None for follower in followers])
    sizes = [follower.size for follower in followers]
    solved = Coupling(sizes=sizes, start=first, change=change, rubs=rubs).solve()
    amounts = np.where(doubtful, 0.0, solved.sizes * signs)
    total = start + sum(amounts[:, k, None] * answer for k, answer in enumerate(answers))
    # rows without equilibrium of other reasons have no friction to blame
    lost = ~np.isfinite(start).all(axis=1)
    return JointForces(
        bodies=bodies, balance=known, answers=answers, unknowns=total, amounts=amounts,
        doubtful=doubtful, found=solved.found | lost, proved=solved.proved,
    )  # fmt: skip


def _way(motion: Array, bodies: FreeBodies) -> Array:
    """The sign of a relative motion when the leading input grows; 0 at rest, (B,)."""
    geometry = bodies.geometry
    each = np.broadcast_to(motion, (len(motion), geometry.rows))
    rate = (geometry.input_ways.T * each.T).sum(axis=-1)
    limit = _AT_REST * geometry.fastest * max(1.0, geometry.length)
    found: Array = np.where(np.abs(rate) > limit, np.sign(rate), 0.0)
    return found


def doubtful_followers(bodies: FreeBodies, known: Balance, answers: Sequence[Array]) -> BoolArray:
    """Which followers a self-stress changes, of itself or through others, (B, K)."""
    rows, count = len(answers[0]), len(answers)
    found = np.zeros((rows, count), dtype=bool)
    unit = np.zeros_like(answers[0])
    for k, follower in enumerate(bodies.following):
        # a self-stress may load one component of a force only
        for own in follower.size.unknowns:
            unit[:] = 0.0
            unit[:, own] = 1.0
            found[:, k] |= known.undetermined(unit)
    # doubts spread by reactions: at most through all followers
    for _ in range(count):
        for k, follower in enumerate(bodies.following):
            for own in follower.size.unknowns:
                for other, answer in enumerate(answers):
                    found[:, k] |= found[:, other] & (np.abs(answer[:, own]) > _STRESSED)
    return found
