"""The defects of designs: what keeps a mechanism from doing its task."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from linkwork.design.defects.obstacles import meets_obstacle
from linkwork.design.loops.candidates import Candidates, Drive, LoopKind
from linkwork.design.loops.driven_loop import driven_loops
from linkwork.design.loops.loop_limits import DrivenLoops
from linkwork.design.loops.travel import NOWHERE, Travel, travel_of
from linkwork.design.tasks.wishes import Wishes
from linkwork.foundation.arrays import Array, BoolArray

__all__ = ["DefectKind", "Verdicts", "judge"]


class DefectKind(Enum):
    """What is wrong with a design; the value is what a count of them says.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.DefectKind.CIRCUIT.value
    'circuit changes'
    """

    CIRCUIT = "circuit changes"
    BRANCH = "branch changes"
    ORDER = "positions out of order"
    RANGE = "driven range not reached"
    TRANSMISSION = "transmission angle too small"
    PIVOTS = "fixed pivot outside its region"
    LENGTHS = "length out of bounds"
    TOLERANCE = "tolerance exceeded"
    OBSTACLE = "meets an obstacle"
    BOUND = "bound of a goal broken"
    UNMOVED = "nothing improved"
    NOT_PROVED = "not proved"


@dataclass(frozen=True, kw_only=True, eq=False)
class Verdicts:
    """The verdicts on D designs with one driven link.

    Parameters
    ----------
    loops : DrivenLoops
    travel : Travel
    transmission : (D,)
        A lower bound of the transmission angle over the driven range [rad], 0 where rounding
        decides about a dead point; NaN where the range is not defined.
    size : (D,)
        The longest link or distance of fixed pivots, of two guides also the longest arm [length].
    shortest : (D,)
        The shortest link [length].
    arm : (D,)
        The longest distance of the guided point from a moving pivot [length].
    found : Mapping[DefectKind, (D,) bool]
        Which designs have the defect. Others than circuit and branch are noted of designs on one
        branch only, obstacles of those with at most one defect.
    """

    loops: DrivenLoops
    travel: Travel
    transmission: Array
    size: Array
    shortest: Array
    arm: Array
    found: dict[DefectKind, BoolArray]

    @property
    def sound(self) -> BoolArray:
        """Designs without any defect, (D,)."""
        return np.asarray(~np.any(list(self.found.values()), axis=0))


def judge(given: Candidates, drive: Drive, wishes: Wishes) -> Verdicts:
    """Decide every defect of designs by signs with bounds of their errors.

    Parameters
    ----------
    given : Candidates
    drive : Drive
    wishes : Wishes
        In radians and units of length.

    Returns
    -------
    Verdicts

    References
    ----------
    T. R. Chase, J. A. Mirth: Circuits and branches of single-degree-of-freedom planar linkages.
    Journal of Mechanical Design 115 (1993) 223-230.
    """
    loops = driven_loops(given, drive)
    travel = travel_of(loops, wishes.range, wishes.ordered, wishes.beyond)
    found: dict[DefectKind, BoolArray] = {}
    open_ = travel.decided.copy()
    for kind, wrong in (
        (DefectKind.CIRCUIT, travel.circuit != NOWHERE),
        (DefectKind.BRANCH, travel.branch != NOWHERE),
    ):
        found[kind] = open_ & wrong
        open_ &= ~wrong
    found[DefectKind.ORDER] = open_ & travel.out_of_order
    found[DefectKind.RANGE] = open_ & (travel.unreached != NOWHERE)
    transmission = loops.least_transmission(travel.first, travel.last)
    lengths = _lengths(given)
    size, shortest = lengths.max(axis=1), lengths.min(axis=1)
    found[DefectKind.TRANSMISSION] = open_ & ~(transmission >= wishes.transmission)
    found[DefectKind.PIVOTS] = open_ & ~_pivots_inside(given, wishes)
    arm = np.maximum(
        np.abs(given.guided - given.moving_a)[:, 0], np.abs(given.guided - given.moving_b)[:, 0]
    )
    if not given.kind.has_crank:
        # a rod between two guides may be short, and hold the guided point far away
        size = np.maximum(size, arm)
    found[DefectKind.LENGTHS] = open_ & ~(wishes.allows(shortest, size) & (arm <= wishes.longest))
    found[DefectKind.TOLERANCE] = open_ & wishes.exceeds(given.guided, given.error).any(axis=1)
    # a design with one other defect tells what that wish costs, if nothing else is wrong
    nearly = open_ & ~found[DefectKind.RANGE] & (np.sum(list(found.values()), axis=0) <= 1)
    met = np.zeros(len(given), dtype=bool)
    if wishes.obstacles.size and nearly.any():
        index = np.flatnonzero(nearly)
        met[index] = meets_obstacle(given.take(index), drive, loops, travel, index, wishes)
    found[DefectKind.OBSTACLE] = met
    # a bound of zero leaves it open whether the range ends in front of a dead point
    found[DefectKind.NOT_PROVED] = ~travel.decided | (
        open_ & (transmission == 0.0) & ~found[DefectKind.RANGE]
    )
    return Verdicts(
        loops=loops,
        travel=travel,
        # to rounding at a dead point: the least that any design has
        transmission=np.where(open_, transmission, np.where(travel.decided, np.nan, 0.0)),
        size=size,
        shortest=shortest,
        arm=arm,
        found=found,
    )


def _lengths(given: Candidates) -> Array:
    """The lengths of crank, coupler, and of a four-bar rocker and ground, (D, 2 to 4).

    A coupler that slides in a block is as long as its farthest position needs.
    """
    if given.kind is LoopKind.RAPSON:
        return np.asarray(np.abs(given.fixed_b[:, None] - given.moving_a).max(axis=1)[:, None])
    if not given.kind.has_crank:
        rod = np.abs(given.moving_b[:, 0] - given.moving_a[:, 0])
        ground = np.abs(given.fixed_b - given.fixed_a)
        return np.stack([rod, ground] if given.kind is LoopKind.OLDHAM else [rod], axis=1)
    if given.kind is LoopKind.INVERTED:
        reach = np.abs(given.fixed_b[:, None] - given.moving_a).max(axis=1)
        ground = np.abs(given.fixed_b - given.fixed_a)
        return np.stack([np.abs(given.moving_a[:, 0] - given.fixed_a), ground, reach], axis=1)
    lengths = [given.moving_a[:, 0] - given.fixed_a, given.moving_b[:, 0] - given.moving_a[:, 0]]
    if given.kind is LoopKind.FOUR_BAR:
        lengths += [given.moving_b[:, 0] - given.fixed_b, given.fixed_b - given.fixed_a]
    return np.abs(np.stack(lengths, axis=1))


def _pivots_inside(given: Candidates, wishes: Wishes) -> BoolArray:
    """Whether all fixed pivots are in the region or, to their errors, on its border."""
    inside = np.ones(len(given), dtype=bool)
    for name, pivot in (("A0", given.fixed_a), ("B0", given.fixed_b)):
        if name in given.kind.pivots:
            inside &= wishes.within_region(pivot, given.error)
    return inside
