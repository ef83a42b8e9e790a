"""A Watt-II six-bar of a task, with the verdict on it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.design.defects.defect_messages import Defect
from linkwork.design.defects.verdicts import DefectKind
from linkwork.design.loops.candidates import Drive
from linkwork.design.synthesis.improved_mechanism import ImprovedMechanism, SweptDesign
from linkwork.design.synthesis.watt_group import WattGroup
from linkwork.design.synthesis.watt_linkage import (
    ERROR,
    ROUNDED_ANGLE,
    SIDES,
    driven_range,
    first_angle,
    swept_mechanism,
    watt_linkage,
)
from linkwork.design.tasks.wanted_mechanisms import WATT_II
from linkwork.design.tasks.wishes import Wishes
from linkwork.foundation.internal import internal
from linkwork.mechanism.linkage import Linkage

__all__ = ["WattDesign"]


@internal("group", "index", "wishes", "changed", "swept", "linkage", "kinds")
@dataclass(frozen=True, kw_only=True, eq=False)
class WattDesign(SweptDesign):
    """One Watt-II six-bar with its verdict.

    Parameters
    ----------
    group : WattGroup
        All six-bars of the task.
    index : int
        Its place among them.
    wishes : Wishes
        Those of the task, in radians.
    changed : Defect, optional
        The change of circuit or branch of one of its loops, or that this is not decided.
    swept : ImprovedMechanism, optional
        Its motion through the driven range, of a design without such a change.

    Examples
    --------
    >>> import linkwork as lw
    >>> from linkwork.design.synthesis.watt_design import WattDesign
    >>> issubclass(WattDesign, lw.JudgedDesign)
    True
    """

    group: WattGroup
    index: int
    wishes: Wishes
    changed: Defect | None
    swept: ImprovedMechanism | None

    @classmethod
    def of(cls, group: WattGroup, k: int, wishes: Wishes) -> WattDesign:
        """The k-th six-bar, judged."""
        changed = group.defect(k)
        swept = None if changed else swept_mechanism(group, k, wishes)
        return cls(
            task=group.task, group=group, index=k, wishes=wishes, changed=changed, swept=swept
        )

    def __repr__(self) -> str:
        found = ", ".join(kind.value for kind in self.kinds) or "sound"
        return f"<WattDesign {self.number}: {found}>"

    @property
    def mechanism(self) -> str:
        """The kind of mechanism."""
        return WATT_II

    @property
    def driven(self) -> str:
        """The fixed pivot of the driven link."""
        return Drive.A0.value

    @property
    def numbers(self) -> dict[str, float]:
        """The numbers that vary; none, since all of them are found."""
        return {}

    @cached_property
    def points(self) -> dict[str, complex]:
        """The points at the first position [length]."""
        return self.group.points(self.index)

    @property
    def inputs(self) -> tuple[float, ...]:
        """The inputs at the positions [file units]."""
        radians = self.group.inputs + self._first_angle
        return tuple(map(self.task.angle.from_radians, radians.tolist()))

    @property
    def first_input(self) -> float:
        """The input at the first position [file units]."""
        return self.task.angle.from_radians(self._first_angle)

    @property
    def _first_angle(self) -> float:
        return first_angle(self.group, self.index, self.wishes)

    @cached_property
    def linkage(self) -> Linkage:
        """The mechanism."""
        return watt_linkage(self.group, self.index, self.wishes, self._name)

    @cached_property
    def moved(self) -> ImprovedMechanism:
        """Its motion through the driven range, also of a design that changes branch or circuit."""
        return self.swept or swept_mechanism(self.group, self.index, self.wishes)

    @property
    def transmission(self) -> float:
        """A lower bound of the least transmission angle of both loops in the driven range, NaN for
        a design that changes branch or circuit [file's angle unit].
        """
        return float("nan") if self.swept is None else self.swept.transmission

    @cached_property
    def size(self) -> float:
        """The longest side of a link, or distance of fixed pivots [length]."""
        return max(self._sides)

    @property
    def shortest(self) -> float:
        """The shortest side of a link, or distance of fixed pivots [length]."""
        return min(self._sides)

    @property
    def _sides(self) -> list[float]:
        return [abs(self.points[q] - self.points[p]) for p, q in SIDES]

    @cached_property
    def error(self) -> float:
        """The largest structural error in the rows of the function's own range, 0 for pairs, NaN
        for a design that changes branch or circuit [file's angle unit].
        """
        if self.swept is None:
            return float("nan")
        motion, described = self.swept.improved.motion, self.swept.improved.description
        goal = self.task.function
        if motion is None or ERROR not in described.outputs or goal is None:
            return 0.0
        found = motion.found
        wrong = goal.errors(motion["crank"][found], motion["rocker"][found], self.task.angle.turn)
        return float(np.abs(wrong).max(initial=0.0))

    @property
    def error_unit(self) -> str:
        """The unit of the error."""
        return self.task.angle.value

    @property
    def kinds(self) -> tuple[DefectKind, ...]:
        """The kinds of its defects; none for a sound design."""
        return tuple(defect.kind for defect in self.defects)

    @cached_property
    def defects(self) -> tuple[Defect, ...]:
        """Its defects in words; none for a sound design.

        Both loops are on one side at all positions, and a sweep without a dead point, each row
        proved, leads from the first position through the driven range: it passes all of them.
        """
        if self.changed is not None:
            return (self.changed,)
        swept = () if self.swept is None else self.swept.defects
        return (*self._outside(), *swept)

    def _outside(self) -> Iterator[Defect]:
        if self.wishes.range is not None and self.wishes.range.turn:
            return
        low, high = sorted(driven_range(self.group, self.index, self.wishes))
        places = self.group.inputs + self._first_angle
        outside = (places < low - ROUNDED_ANGLE) | (places > high + ROUNDED_ANGLE)
        if outside.any():
            told = f"position {outside.argmax() + 1} is outside the driven range"
            yield Defect(kind=DefectKind.RANGE, between=None, message=told)

    def _details(self) -> Mapping[str, Any]:
        swept = self.swept
        return {
            "inputs": list(self.inputs),
            "proved_in_motion": [] if swept is None else list(swept.proved_in_motion),
            "tested_in_rows": [] if swept is None else list(swept.tested_in_rows),
        }
