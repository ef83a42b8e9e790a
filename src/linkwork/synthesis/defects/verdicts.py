"""Whether links meet circles anywhere on a driven range, with proof that they do not."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.core.foundation.errors import internal
from linkwork.core.mechanism.description import Description
from linkwork.core.results.listing import rounded_down
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.synthesis.loops.driven_loop import NOWHERE, Travel, pivots_at, travel_of
from linkwork.synthesis.loops.limits import (
    Candidates,
    Drive,
    DrivenLoops,
    LoopKind,
    Side,
    cross,
    driven_loops,
    meeting,
)
from linkwork.synthesis.tasks.conditions import Wishes, distances_to_segments
from linkwork.synthesis.tasks.task import Task

_PIECES = 64  # of a driven range, to begin with
_HALVINGS = 14  # pieces that are still in doubt then count as contacts
_MOST_PIECES = 200_000


def meets_obstacle(
    candidates: Candidates,
    drive: Drive,
    loops: DrivenLoops,
    travel: Travel,
    index: IndexArray,
    wishes: Wishes,
) -> BoolArray:
    """Whether a link of each design comes into a circle, or nearer than can be excluded.

    A piece of the range is clear if at its middle every link is farther from the circle than any of
    its points can move within half the piece, eq. (146). Other pieces are halved.

    Parameters
    ----------
    candidates : Candidates
        D designs; ``index`` is their place in ``loops`` and ``travel``.
    """
    loops, first, last = loops.take(index), travel.first[index], travel.last[index]
    speed = _fastest(candidates, drive, loops, first, last)
    met = ~np.isfinite(speed)
    width = (last - first) / _PIECES
    which = np.repeat(np.arange(len(candidates)), _PIECES)
    middle = (first[:, None] + width[:, None] * (np.arange(_PIECES) + 0.5)).ravel()
    half = np.repeat(np.abs(width) / 2, _PIECES)
    for _ in range(_HALVINGS):
        keep = ~met[which]
        which, middle, half = which[keep], middle[keep], half[keep]
        if not which.size:
            return met
        gap = _gaps(candidates.take(which), drive, loops.take(which), middle, wishes.obstacles)
        gap -= candidates.error[which]
        # NaN: no position, which cannot be within a driven range that is proved
        met[which[~(gap > 0)]] = True
        # eq. (146)
        doubt = (gap <= speed[which] * half) & ~met[which]
        which, middle, half = which[doubt], middle[doubt], half[doubt] / 2
        if which.size > _MOST_PIECES:
            break
        middle = np.concatenate([middle - half, middle + half])
        which, half = np.tile(which, 2), np.tile(half, 2)
    met[which] = True
    return met


def _gaps(
    candidates: Candidates, drive: Drive, loops: DrivenLoops, place: Array, circles: Array
) -> Array:
    """The smallest distances of links from circles, at one place of each design, (D,)."""
    a, b, p = (z[:, 0] for z in pivots_at(candidates, drive, loops, place[:, None]))
    ends: list[tuple[ComplexArray, ComplexArray]] = [(a, b), (a, p), (b, p)]
    # a crank, a rocker, or the body from its end to the block
    both = {"A0": (candidates.fixed_a, a), "B0": (candidates.fixed_b, b)}
    ends += [both[name] for name in candidates.kind.pivots]
    if candidates.kind.body_line:
        corner = _corner(candidates, a, b)
        ends += [(corner, a), (corner, b), (corner, candidates.fixed_b)]
        if candidates.kind is LoopKind.OLDHAM:
            ends.append((corner, candidates.fixed_a))
    gaps = [
        distances_to_segments(np.asarray(x + 1j * y), start, end) - radius
        for x, y, radius in circles
        for start, end in ends
    ]
    return np.asarray(np.min(gaps, axis=0))


def _corner(loops: Candidates, a: ComplexArray, b: ComplexArray) -> ComplexArray:
    """Where the body's line through B begins: the foot of A, or the crossing with that through A,
    at places of A and B (D,).
    """
    first, second, line = (loops.moving_a[:, 0], loops.moving_b[:, 0], loops.lines[:, 0])
    if loops.kind is LoopKind.OLDHAM:
        start = _crossing(loops)
    else:
        start = first + 1j * cross(line, second - first) * line
    return np.asarray(a + (start - first) * (b - a) / (second - first))


def _fastest(
    candidates: Candidates, drive: Drive, loops: DrivenLoops, first: Array, last: Array
) -> Array:
    """A bound of the speed of every point of every link, per unit of the input, (D,)."""
    driven, driver, other = candidates.driven_by(drive)
    a, b, p = driven.moving_a[:, 0], driven.moving_b[:, 0], driven.guided[:, 0]
    ground = driven.fixed_b - driven.fixed_a
    sine = np.sin(loops.least_transmission(first, last))
    with np.errstate(all="ignore"):
        if driver is not Side.BLOCK:
            centre, speed = a, np.ones(len(driven))
            if driver is Side.PIN:
                speed = np.abs(a - driven.fixed_a)
            lever = np.abs(b - a)
            if other is Side.BLOCK:
                # A moves across the line by at most its speed, at least q sin μ from the block
                lever = np.sqrt(
                    np.maximum(loops.extremes(first, last).min(axis=1) - loops.q_error, 0.0)
                )
            # the body turns fastest where the driving force is farthest from the line of the rocker
            turning = speed / (lever * sine)
        else:
            centre, turning = b, np.ones(len(driven))
            if other is Side.PIN:
                speed = (np.abs(b - driven.fixed_b) + np.abs(ground)) / sine
            elif other is Side.LINE:
                h = np.abs(cross(driven.lines_a[:, 0], driven.fixed_a - b))
                speed = (np.abs(cross(driven.direction, ground)) + h) / sine**2
            else:
                # the crossing of the body's lines runs around a circle through A0 and B0
                centre, speed = _crossing(driven), np.abs(ground) / sine
        farthest = np.max([np.abs(point - centre) for point in (a, b, p)], axis=0)
        fastest = speed + farthest * turning
    return np.where(np.isfinite(fastest), fastest, np.inf)


def _crossing(loops: Candidates) -> ComplexArray:
    """Where the body's lines through two blocks cross at the first position, (D,)."""
    return meeting(loops.fixed_a, loops.lines_a[:, 0], loops.fixed_b, loops.lines[:, 0])


# ----------------------------------------------------------------------
# The defects of designs: why a mechanism does not do its task.


class DefectKind(Enum):
    """A defect of a design; the value is its name in a table of counts.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.synthesis.DefectKind.CIRCUIT.value
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
    candidates : Candidates
    drive : Drive
    wishes : Wishes
        In radians and units of length.
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
    defects : Mapping[DefectKind, (D,) bool]
        Which designs have the defect. Defects other than circuit and branch are decided for
        designs that stay on one branch, obstacles for designs with at most one other defect.
    """

    candidates: Candidates
    drive: Drive
    wishes: Wishes
    loops: DrivenLoops
    travel: Travel
    transmission: Array
    size: Array
    shortest: Array
    arm: Array
    defects: dict[DefectKind, BoolArray]

    @property
    def sound(self) -> BoolArray:
        """Designs without any defect, (D,)."""
        return np.asarray(~np.any(list(self.defects.values()), axis=0))


def judge(group: Candidates, drive: Drive, wishes: Wishes) -> Verdicts:
    """Decide every defect of designs by signs with bounds of their errors.

    Parameters
    ----------
    group : Candidates
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
    loops = driven_loops(group, drive)
    travel = travel_of(loops, wishes.range, wishes.ordered, wishes.beyond)
    defects: dict[DefectKind, BoolArray] = {}
    open_ = travel.decided.copy()
    for kind, wrong in (
        (DefectKind.CIRCUIT, travel.circuit != NOWHERE),
        (DefectKind.BRANCH, travel.branch != NOWHERE),
    ):
        defects[kind] = open_ & wrong
        open_ &= ~wrong
    defects[DefectKind.ORDER] = open_ & travel.out_of_order
    defects[DefectKind.RANGE] = open_ & (travel.unreached != NOWHERE)
    transmission = loops.least_transmission(travel.first, travel.last)
    lengths = _lengths(group)
    size, shortest = lengths.max(axis=1), lengths.min(axis=1)
    defects[DefectKind.TRANSMISSION] = open_ & ~(transmission >= wishes.transmission)
    defects[DefectKind.PIVOTS] = open_ & ~_pivots_inside(group, wishes)
    arm = np.maximum(
        np.abs(group.guided - group.moving_a)[:, 0], np.abs(group.guided - group.moving_b)[:, 0]
    )
    if not group.kind.has_crank:
        # a rod between two guides may be short, and hold the guided point far away
        size = np.maximum(size, arm)
    defects[DefectKind.LENGTHS] = open_ & ~(wishes.allows(shortest, size) & (arm <= wishes.longest))
    defects[DefectKind.TOLERANCE] = open_ & wishes.exceeds(group.guided, group.error).any(axis=1)
    # a design with one other defect shows which requirement alone rejects it
    nearly = open_ & ~defects[DefectKind.RANGE] & (np.sum(list(defects.values()), axis=0) <= 1)
    met = np.zeros(len(group), dtype=bool)
    if wishes.obstacles.size and nearly.any():
        index = np.flatnonzero(nearly)
        met[index] = meets_obstacle(group.take(index), drive, loops, travel, index, wishes)
    defects[DefectKind.OBSTACLE] = met
    # a bound of zero leaves it open whether the range ends in front of a dead point
    defects[DefectKind.NOT_PROVED] = ~travel.decided | (
        open_ & (transmission == 0.0) & ~defects[DefectKind.RANGE]
    )
    return Verdicts(
        candidates=group,
        drive=drive,
        wishes=wishes,
        loops=loops,
        travel=travel,
        # to rounding at a dead point: the least that any design has
        transmission=np.where(open_, transmission, np.where(travel.decided, np.nan, 0.0)),
        size=size,
        shortest=shortest,
        arm=arm,
        defects=defects,
    )


def _lengths(loops: Candidates) -> Array:
    """The lengths of crank, rocker, coupler and ground, as far as there are any, (D, 1 to 4).

    A coupler that slides in a block is as long as its farthest position needs.
    """
    one, other = loops.kind.sides
    fixed_pins = ((one, loops.moving_a, loops.fixed_a), (other, loops.moving_b, loops.fixed_b))
    lengths = [
        np.abs(moving[:, 0] - fixed) for side, moving, fixed in fixed_pins if side is Side.PIN
    ]
    if other is Side.BLOCK and one is not Side.BLOCK:
        lengths.append(np.abs(loops.fixed_b[:, None] - loops.moving_a).max(axis=1))
    else:
        lengths.append(np.abs(loops.moving_b[:, 0] - loops.moving_a[:, 0]))
    if Side.LINE not in (one, other):
        lengths.append(np.abs(loops.fixed_b - loops.fixed_a))
    return np.stack(lengths, axis=1)


def _pivots_inside(candidates: Candidates, wishes: Wishes) -> BoolArray:
    """Whether all fixed pivots are in the region or, to their errors, on its border."""
    inside = np.ones(len(candidates), dtype=bool)
    for name, pivot in (("A0", candidates.fixed_a), ("B0", candidates.fixed_b)):
        if name in candidates.kind.pivots:
            inside &= wishes.within_region(pivot, candidates.error)
    return inside


# ----------------------------------------------------------------------
# Reasons in words for every defect of a design.


@dataclass(frozen=True, kw_only=True)
class Defect:
    """A defect of a design.

    Parameters
    ----------
    kind : DefectKind
    between : (int, int), optional
        The numbers of the positions between which it occurs.
    message : str

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.example("four-bar")
    >>> here, there = bar.solve(at=0).points["B"], bar.configurations(at=90)["crossed"].points["B"]
    >>> found = lw.Task.path([here, there]).defects_of(bar, (0, 90), point="B")
    >>> [defect.kind.name for defect in found]
    ['CIRCUIT']
    """

    kind: DefectKind
    between: tuple[int, int] | None = None
    message: str


def defects_of(task: Task, verdicts: Verdicts, k: int) -> tuple[Defect, ...]:
    """All defects of the k-th design, in the order of :class:`DefectKind`."""
    words = _DefectMessages(task, verdicts, k)
    return tuple(
        Defect(kind=kind, between=words.between(kind), message=words.of(kind))
        for kind, wrong in verdicts.defects.items()
        if wrong[k]
    )


def tolerance_message(away: Array, reach: Array, unit: str) -> str:
    """Which position is missed most beyond its tolerance; distances (N,) and tolerances (N,)."""
    k = int((away - reach).argmax())
    return f"position {k + 1} is missed by {away[k]:.4g} {unit}, tolerance {reach[k]:g} {unit}"


def order_message(inputs: Any) -> str:
    """In which order positions with these inputs (N,) are passed."""
    order = np.argsort(inputs, kind="stable") + 1
    return f"the input passes the positions in the order {', '.join(map(str, order))}"


def lengths_message(shortest: float, longest: float) -> str:
    """Between which lengths those of a design are, if they break their bounds."""
    return f"lengths from {shortest:.4g} to {longest:.4g} are out of bounds"


@dataclass(frozen=True, eq=False)
class _DefectMessages:
    task: Task
    verdicts: Verdicts
    k: int

    def of(self, kind: DefectKind) -> str:
        """What is wrong."""
        message: str = getattr(self, f"_{kind.name.lower()}")()
        return message

    def between(self, kind: DefectKind) -> tuple[int, int] | None:
        """The numbers of the positions between which circuit or branch changes."""
        changes = kind in (DefectKind.CIRCUIT, DefectKind.BRANCH)
        return self._change(kind.name.lower()) if changes else None

    def _change(self, word: str) -> tuple[int, int]:
        after = int(getattr(self.verdicts.travel, word)[self.k]) + 1
        return after, after + 1

    def _circuit(self) -> str:
        first, last = self._change("circuit")
        return (
            f"circuit changes between positions {first} and {last}: the mechanism would have to be "
            "taken apart"
        )

    def _branch(self) -> str:
        first, last = self._change("branch")
        place = self.verdicts.travel.place[self.k, first - 1 : last]
        nearest = min(self._dead_points(), key=lambda end: float(np.abs(place - end).sum()))
        at = self._input_text(nearest)
        return f"branch changes between positions {first} and {last} at the dead point {at}"

    def _order(self) -> str:
        return order_message(self.verdicts.travel.place[self.k])

    def _range(self) -> str:
        unreached, wanted = int(self.verdicts.travel.unreached[self.k]), self.task.wanted
        if unreached < self.verdicts.travel.place.shape[1]:
            return f"position {unreached + 1} is outside the driven range"
        if wanted.turns_fully and not self.verdicts.drive.turns:
            return "the driven slider cannot turn fully"
        if unreached > self.verdicts.travel.place.shape[1]:
            return "an end of the function's range is outside the driven range"
        ends = " and ".join(map(self._input_text, filter(np.isfinite, self._dead_points())))
        return f"the driven range passes a dead point: the branch ends at {ends}"

    def _transmission(self) -> str:
        unit, bound = self.task.angle, self.task.wanted.transmission
        least = rounded_down(unit.from_radians(float(self.verdicts.transmission[self.k])), 4)
        return f"transmission angle down to {least:.4g}{unit.sign}, wanted {bound:g}{unit.sign}"

    def _pivots(self) -> str:
        both = {
            "A0": self.verdicts.candidates.fixed_a[self.k],
            "B0": self.verdicts.candidates.fixed_b[self.k],
        }
        pivots = {name: both[name] for name in self.verdicts.candidates.kind.pivots}
        places = " and ".join(f"{n} at ({z.real:.6g}, {z.imag:.6g})" for n, z in pivots.items())
        return f"fixed pivots {places} are not all in their region"

    def _lengths(self) -> str:
        verdicts, k = self.verdicts, self.k
        if verdicts.arm[k] > self.task.wanted.longest:
            return f"an arm of the coupler is {verdicts.arm[k]:.4g} long, which is out of bounds"
        return lengths_message(verdicts.shortest[k], verdicts.size[k])

    def _tolerance(self) -> str:
        positions = self.task.positions
        points = np.array([complex(*position.point) for position in positions])
        reach = np.array([position.tolerance for position in positions])
        return tolerance_message(
            np.abs(self.verdicts.candidates.guided[self.k] - points), reach, self.task.length
        )

    def _obstacle(self) -> str:  # noqa: V105  # called by the name of the defect
        return "a link meets an obstacle, or passes it too closely to exclude that"

    def _not_proved(self) -> str:
        loops, k = self.verdicts.loops, self.k
        sides = np.abs(loops.side[k])
        if not np.isfinite(self.verdicts.candidates.error[k]):
            reason = "the solution nearly coincides with another one"
        elif not min(abs(loops.upper[k]), abs(loops.lower[k])) > loops.limit_error[k]:
            reason = "to rounding, the lengths are those of a change point"
        elif not sides.min() > loops.sign_error[k]:
            reason = f"position {int(sides.argmin()) + 1} is at a dead point"
        elif self.verdicts.transmission[k] == 0.0:
            reason = "to rounding, the driven range touches a dead point"
        else:
            reason = "the order of the positions depends on rounding"
        return f"not proved: {reason}"

    def _dead_points(self) -> list[float]:
        """The ends of the branch at the first position, as places."""
        loops, k = self.verdicts.loops, self.k
        q0, q1 = loops.q0[k], loops.q1[k]
        if not loops.turns:
            reach = [np.sqrt(max(limit - q0, 0.0)) for limit in (loops.low[k], loops.high[k])]
            sign = np.sign(loops.half[k, 0])
            ends = [sign * reach[0], sign * reach[1]]
            return ends if loops.lower[k] > 0 else [-reach[1], reach[1]]
        upper, lower = loops.upper[k] > 0, loops.lower[k] > 0
        high = float(np.arccos(np.clip((loops.high[k] - q0) / q1, -1.0, 1.0)))
        low = float(np.arccos(np.clip((loops.low[k] - q0) / q1, -1.0, 1.0)))
        if upper and lower:
            ends = [high, low]
            return ends if loops.half[k, 0] > 0 else [2.0 * np.pi - end for end in ends]
        return [high, 2.0 * np.pi - high] if upper else [-low, low]

    def _input_text(self, place: float) -> str:
        value = place + float(self.verdicts.loops.origin[self.k])
        if not self.verdicts.loops.turns:
            return f"{place:.6g} {self.task.length}"
        unit = self.task.angle
        return f"{unit.from_radians(float(np.mod(value, 2.0 * np.pi))):.4g}{unit.sign}"


# ----------------------------------------------------------------------
# One design of a synthesis with the verdict on it, whatever its kind.


@internal("linkage", "kinds", "task")
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class JudgedDesign(ABC):
    """A mechanism for a task, with its defects.

    Parameters
    ----------
    task : Task
    mechanism : str
        The kind of mechanism, or the mechanism that was improved as the task names it.
    driven : str
        The driven link in words, or the leading input.
    error_unit : str
        The unit of the error; "" of weighted misses.
    number : int
        Its rank among the sound designs from 1, or its place among the refused ones.
    delivered : bool
        Whether it is sound and among the designs that the task delivers.
    score : float
        The weighted score of the ranking, 0 to 1.

    Examples
    --------
    >>> import linkwork as lw
    >>> task = lw.Task.function("log10(x)", x=(1, 2), input=(45, 105), output=(0, 90))
    >>> design = task.solve().delivered[0]
    >>> isinstance(design, lw.synthesis.JudgedDesign), design.number, design.driven
    (True, 1, 'A0')
    """

    task: Task
    mechanism: str
    driven: str
    error_unit: str
    number: int = 0
    delivered: bool = False
    score: float = np.nan

    def __repr__(self) -> str:
        defects = ", ".join(kind.value for kind in self.kinds) or "sound"
        kind, number = type(self).__name__, self.number
        return f"<{kind} {number}: {self.mechanism} driven at {self.driven}, {defects}>"

    @property
    def numbers(self) -> dict[str, float]:
        """The numbers that vary [file units]; none for solvers that list all designs."""
        return {}

    @property
    def goals(self) -> dict[str, float]:
        """The misses of goals [file units]; none where positions are met, or miss by the error."""
        return {}

    @property
    @abstractmethod
    def points(self) -> dict[str, complex]:
        """The points at the first position [length]."""

    @property
    @abstractmethod
    def inputs(self) -> tuple[float, ...]:
        """The inputs at the positions [file units]."""

    @property
    def first_input(self) -> float:
        """The input at the first position [file units]."""
        return self.inputs[0]

    @property
    @abstractmethod
    def linkage(self) -> Description:
        """The mechanism, with the name of its design."""

    @property
    @abstractmethod
    def transmission(self) -> float:
        """The least transmission angle over the driven range, or a lower bound of it; NaN where
        that is not defined [file's angle unit].
        """

    @property
    @abstractmethod
    def size(self) -> float:
        """The longest link, or the largest distance of fixed pivots [length]."""

    @property
    @abstractmethod
    def shortest(self) -> float:
        """The shortest link, or distance of fixed pivots [length]."""

    @property
    @abstractmethod
    def error(self) -> float:
        """How far positions are missed, the largest distance; or the structural error."""

    @property
    def kinds(self) -> tuple[DefectKind, ...]:
        """The kinds of its defects; none for a sound design."""
        return tuple(defect.kind for defect in self.defects)

    @property
    @abstractmethod
    def defects(self) -> tuple[Defect, ...]:
        """Its defects in words; none for a sound design."""

    @property
    def _name(self) -> str:
        refused = ", refused" if self.kinds else ""
        return f"{self.task.name}, design {self.number}{refused}"

    def _details(self) -> Mapping[str, Any]:
        """Further plain data of a kind of designs."""
        return {}

    def to_dict(self, file: str | None = None) -> dict[str, Any]:
        """Plain data, as in the command line's JSON."""
        return {
            "file": file,
            "mechanism": self.mechanism,
            "points": {name: [z.real, z.imag] for name, z in self.points.items()},
            "drive": self.driven,
            "inputs": list(self.inputs),
            "delivered": self.delivered,
            TRANSMISSION_ANGLE.word: self.transmission,
            "size": self.size,
            "shortest": self.shortest,
            "error": self.error,
            "score": self.score,
            **self._details(),
            "defects": [
                {
                    "kind": defect.kind.name.lower(),
                    "between": None if defect.between is None else list(defect.between),
                    "message": defect.message,
                }
                for defect in self.defects
            ],
        }
