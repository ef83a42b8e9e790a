"""Reasons in words for every defect of a design."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from linkwork.design.defects.verdicts import DefectKind, Verdicts
from linkwork.design.loops.candidates import Candidates, Drive
from linkwork.design.tasks.task import Task
from linkwork.foundation.arrays import Array
from linkwork.results.listing.number_text import rounded_down

__all__ = ["Defect", "defects_of", "tolerance_message"]


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
    between: tuple[int, int] | None
    message: str


def defects_of(
    task: Task, given: Candidates, drive: Drive, verdicts: Verdicts, k: int
) -> tuple[Defect, ...]:
    """All defects of the k-th design, in the order of :class:`DefectKind`."""
    words = _Words(task=task, given=given, drive=drive, verdicts=verdicts, k=k)
    return tuple(words.defects())


def tolerance_message(away: Array, reach: Array, unit: str) -> str:
    """Which position is missed most beyond its tolerance; distances (N,) and tolerances (N,)."""
    k = int((away - reach).argmax())
    return f"position {k + 1} is missed by {away[k]:.4g} {unit}, tolerance {reach[k]:g} {unit}"


@dataclass(frozen=True, kw_only=True, eq=False)
class _Words:
    task: Task
    given: Candidates
    drive: Drive
    verdicts: Verdicts
    k: int

    def defects(self) -> Iterator[Defect]:
        writers = {
            DefectKind.CIRCUIT: self._circuit,
            DefectKind.BRANCH: self._branch,
            DefectKind.ORDER: self._order,
            DefectKind.RANGE: self._range,
            DefectKind.TRANSMISSION: self._transmission,
            DefectKind.PIVOTS: self._pivots,
            DefectKind.LENGTHS: self._lengths,
            DefectKind.TOLERANCE: self._tolerance,
            DefectKind.OBSTACLE: self._obstacle,
            DefectKind.NOT_PROVED: self._not_proved,
        }
        for kind, found in self.verdicts.found.items():
            if found[self.k]:
                message, between = writers[kind]()
                yield Defect(kind=kind, between=between, message=message)

    def _circuit(self) -> tuple[str, tuple[int, int]]:
        after = int(self.verdicts.travel.circuit[self.k]) + 1
        return (
            f"circuit changes between positions {after} and {after + 1}: the mechanism would have "
            "to be taken apart",
            (after, after + 1),
        )

    def _branch(self) -> tuple[str, tuple[int, int]]:
        after = int(self.verdicts.travel.branch[self.k]) + 1
        place = self.verdicts.travel.place[self.k, after - 1 : after + 1]
        ends = self._dead_points()
        nearest = min(ends, key=lambda end: float(np.abs(place - end).sum()))
        return (
            f"branch changes between positions {after} and {after + 1} at the dead point "
            f"{self._input_text(nearest)}",
            (after, after + 1),
        )

    def _order(self) -> tuple[str, None]:
        order = np.argsort(self.verdicts.travel.place[self.k], kind="stable") + 1
        return f"the input passes the positions in the order {', '.join(map(str, order))}", None

    def _range(self) -> tuple[str, None]:
        unreached, wanted = int(self.verdicts.travel.unreached[self.k]), self.task.wanted
        if unreached < self.verdicts.travel.place.shape[1]:
            return f"position {unreached + 1} is outside the driven range", None
        if wanted.turns_fully and not self.drive.turns:
            return "the driven slider cannot turn fully", None
        if unreached > self.verdicts.travel.place.shape[1]:
            return "an end of the function's range is outside the driven range", None
        ends = " and ".join(map(self._input_text, filter(np.isfinite, self._dead_points())))
        return f"the driven range passes a dead point: the branch ends at {ends}", None

    def _transmission(self) -> tuple[str, None]:
        unit = self.task.angle
        least = rounded_down(unit.from_radians(float(self.verdicts.transmission[self.k])), 4)
        wanted = self.task.wanted.transmission
        return (
            f"transmission angle down to {least:.4g}{unit.sign}, wanted {wanted:g}{unit.sign}",
            None,
        )

    def _pivots(self) -> tuple[str, None]:
        both = {"A0": self.given.fixed_a[self.k], "B0": self.given.fixed_b[self.k]}
        pivots = {name: both[name] for name in self.given.kind.pivots}
        places = " and ".join(f"{n} at ({z.real:.6g}, {z.imag:.6g})" for n, z in pivots.items())
        return f"fixed pivots {places} are not all in their region", None

    def _lengths(self) -> tuple[str, None]:
        verdicts, k = self.verdicts, self.k
        shortest, longest, arm = verdicts.shortest[k], verdicts.size[k], verdicts.arm[k]
        if arm > self.task.wanted.longest:
            return f"an arm of the coupler is {arm:.4g} long, which is out of bounds", None
        return f"lengths from {shortest:.4g} to {longest:.4g} are out of bounds", None

    def _tolerance(self) -> tuple[str, None]:
        positions = self.task.positions
        points = np.array([complex(*position.point) for position in positions])
        reach = np.array([position.tolerance for position in positions])
        away = np.abs(self.given.guided[self.k] - points)
        return tolerance_message(away, reach, self.task.length), None

    def _obstacle(self) -> tuple[str, None]:
        return "a link meets an obstacle, or passes it too closely to exclude that", None

    def _not_proved(self) -> tuple[str, None]:
        loops, k = self.verdicts.loops, self.k
        if not np.isfinite(self.given.error[k]):
            return "not proved: the solution nearly coincides with another one", None
        limits = min(abs(loops.upper[k]), abs(loops.lower[k]))
        if not limits > loops.limit_error[k]:
            return "not proved: to rounding, the lengths are those of a change point", None
        sides = np.abs(loops.side[k])
        if not sides.min() > loops.sign_error[k]:
            return f"not proved: position {int(sides.argmin()) + 1} is at a dead point", None
        if self.verdicts.transmission[k] == 0.0:
            return "not proved: to rounding, the driven range touches a dead point", None
        return "not proved: the order of the positions depends on rounding", None

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
