"""A mechanism of any kind with the verdict on its sweep."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations, islice
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.errors import internal
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.values import told_beside
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.results.failure import LimitKind
from linkwork.core.results.motion import Motion, branch_end
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.synthesis.defects.verdicts import (
    Defect,
    DefectKind,
    JudgedDesign,
    lengths_message,
    order_message,
    tolerance_message,
)
from linkwork.synthesis.improvement.proved_design import ImprovedDesign, least_in_rows
from linkwork.synthesis.tasks.conditions import (
    EQUAL_LENGTHS,
    Wishes,
    distances_to_segments,
    outside_range,
)
from linkwork.synthesis.tasks.task import Task


@internal("improved", "wishes", "place", "changed", "of")
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SweptDesign(JudgedDesign):
    """A mechanism of any kind that is judged by a sweep, with its defects.

    Parameters
    ----------
    improved : ImprovedDesign
        The design with its proof.
    wishes : Wishes
        The requirements of the task, in radians.
    place : Mapping[str, complex], optional
        The points at the first position; by default in the first row that has one [length].
    changed : Defect, optional
        A change of circuit or branch that is known before the sweep, or that this is not decided.

    Examples
    --------
    >>> import linkwork as lw
    >>> goals = [{"of": "stroke(d)", "target": 70}]
    >>> task = lw.Task.improve("slider-crank", goals=goals, vary=["O2 A"], starts=2)
    >>> [design.numbers for design in task.solve().delivered]
    [{'O2 A': 34.46567317588864}]
    """

    improved: ImprovedDesign
    wishes: Wishes
    place: Mapping[str, complex] | None = None
    changed: Defect | None = None

    @classmethod
    def of(cls, task: Task, improved: ImprovedDesign, wishes: Wishes) -> SweptDesign:
        """A design of a task that improves a mechanism."""
        motion = improved.motion
        return cls(
            task=task,
            mechanism=task.mechanisms[0],
            driven="" if motion is None else motion.quantities.names.lead,
            error_unit=task.length if improved.misses else "",
            improved=improved,
            wishes=wishes,
        )

    @property
    def numbers(self) -> dict[str, float]:
        """The numbers that vary [file units]."""
        return dict(self.improved.numbers)

    @property
    def goals(self) -> dict[str, float]:
        """The root mean squares of the misses of goals that are no bounds [file units]."""
        return dict(self.improved.goals)

    @property
    def _motion(self) -> Motion | None:
        return self.improved.motion

    @cached_property
    def _moving_points(self) -> dict[str, ComplexArray]:
        """The points in the rows that have a position."""
        motion = self._motion
        if motion is None:
            return {}
        return {name: motion.trace(name)[motion.found] for name in motion.points}

    @property
    def points(self) -> dict[str, complex]:
        """The points at the first position, or in the first row that has one [length]."""
        if self.place is not None:
            return dict(self.place)
        return {name: complex(path[0]) for name, path in self._moving_points.items() if len(path)}

    @property
    def inputs(self) -> tuple[float, ...]:
        """The inputs at the positions [file units]."""
        return self.improved.inputs

    @property
    def first_input(self) -> float:
        """The input at the first position [file units]."""
        if self.inputs:
            return self.inputs[0]
        motion = self._motion
        if motion is None or not motion.found.any():
            return float("nan")
        return float(motion.inputs[motion.quantities.names.lead][motion.found][0])

    @cached_property
    def linkage(self) -> Description:
        """The mechanism, with the name of its design."""
        return replace(self.improved.description, name=self._name)

    # Measures

    @cached_property
    def transmission(self) -> float:
        """A lower bound of the least transmission angle of all dyads in the whole motion, or the
        least one in its rows where that is not proved; NaN without dyads [file's angle unit].
        """
        whole, motion = self.improved.whole_motion, self._motion
        if whole is not None and whole.dyads:
            least = whole.least_transmission(self.wishes.transmission)
            return self.task.angle.from_radians(least.low)
        return float("nan") if motion is None else least_in_rows(motion)

    @cached_property
    def _links(self) -> dict[str, tuple[str, ...]]:
        """The points of the links, of the ground those of moving links."""
        description = self.improved.description
        links = dict(description.links) if isinstance(description, Draft) else {}
        fixed = links.pop(GROUND, ())
        moving = {name for held in links.values() for name in held}
        return {**links, GROUND: tuple(name for name in fixed if name in moving)}

    @property
    def _sides(self) -> list[tuple[str, tuple[str, str]]]:
        """The lines between two points of every moving link."""
        return [
            (name, ends)
            for name, held in self._links.items()
            for ends in combinations(held, 2)
            if name != GROUND
        ]

    @property
    def _pivots(self) -> dict[str, complex]:
        """The fixed points of moving links."""
        return {name: self.points[name] for name in self._links[GROUND]}

    @cached_property
    def _lengths(self) -> Array:
        """The lengths of links, and the distances of fixed pivots [length]."""
        points = self.points
        held = self._links.values() if points else ()
        ends = [ends for names in held for ends in combinations(names, 2)]
        lengths = np.array([abs(points[p] - points[q]) for p, q in ends])
        return lengths[lengths > 0.0]

    @property
    def size(self) -> float:
        """The longest link, or the largest distance of fixed pivots [length]."""
        return float(self._lengths.max()) if len(self._lengths) else float("nan")

    @property
    def shortest(self) -> float:
        """The shortest link, or distance of fixed pivots [length]."""
        return float(self._lengths.min()) if len(self._lengths) else float("nan")

    @property
    def error(self) -> float:
        """The largest distance from a point, or without points the largest weighted miss."""
        if self.improved.misses:
            return float(np.nan_to_num(np.max(self.improved.misses), nan=np.inf))
        return self.improved.largest

    # Verdict

    @cached_property
    def defects(self) -> tuple[Defect, ...]:
        """Its defects in words; none for a sound design.

        A sweep without a dead point, each row proved, passes all positions of a six-bar whose loops
        are on one side at all of them.
        """
        if self.changed is not None:
            return (self.changed,)
        messages = tuple(self._defect_messages())
        if not messages and not self.improved.sound:
            messages = ((DefectKind.NOT_PROVED, self.improved.message),)
        return tuple(Defect(kind=kind, message=message) for kind, message in messages)

    def _defect_messages(self) -> Iterator[tuple[DefectKind, str]]:
        motion, task = self._motion, self.task
        if motion is None or not motion.found.any():
            yield DefectKind.RANGE, self.improved.message
            return
        lost = int(np.count_nonzero(~motion.found))
        if lost:
            reason = "the input does not turn fully: " if task.wanted.turns_fully else ""
            yield DefectKind.RANGE, f"{reason}{lost} of {len(motion)} rows have no position"
        elif (end := branch_end(motion)) is not None:
            kind, place = end.kind, self._input_text(end.input)
            if kind is LimitKind.DEAD_POINT:
                yield DefectKind.RANGE, f"the driven range reaches the dead point {place}"
            else:
                yield DefectKind.NOT_PROVED, f"not proved: a {kind.word} at {place}"
        elif not motion.certified.all():
            unproved = int(np.count_nonzero(~motion.certified))
            yield DefectKind.NOT_PROVED, f"{unproved} of {len(motion)} rows are not proved"
        if self.improved.near_dead:
            yield DefectKind.RANGE, self.improved.near_dead
        if self.improved.unmoved and not lost:
            yield DefectKind.UNMOVED, self.improved.unmoved
        yield from self._out_of_range(motion)
        misses = np.array(self.improved.misses)
        for k in np.flatnonzero(~np.isfinite(misses))[:1]:
            yield DefectKind.BRANCH, f"position {k + 1} is not on the branch of the table"
        reach = self.wishes.reach
        if reach.size and (np.nan_to_num(misses) > reach).any():
            yield DefectKind.TOLERANCE, tolerance_message(misses, reach, task.length)
        if self.wishes.ordered and task.positions and not _is_in_order(self.improved.inputs):
            yield DefectKind.ORDER, order_message(self.improved.inputs)
        for reason in self.improved.broken:
            yield DefectKind.BOUND, reason
        yield from self._transmission_defects()
        yield from self._geometric_defects()

    def _transmission_defects(self) -> Iterator[tuple[DefectKind, str]]:
        angle, least_wanted = self.task.angle, self.task.wanted.transmission
        whole, least = self.improved.whole_motion, self.wishes.transmission
        if not least_wanted or self.transmission >= least_wanted:
            return
        kind, text, place = DefectKind.TRANSMISSION, "transmission angle down to", ""
        down = self.transmission
        if whole is not None and whole.dyads:
            bound = whole.least_transmission(least)
            down, place = angle.from_radians(bound.high), f" at {self._input_text(bound.at)}"
            if bound.high >= least:
                kind = DefectKind.NOT_PROVED
                text = "not proved: the transmission angle comes down to"
        shown = told_beside(down, least_wanted)
        yield kind, f"{text} {shown}{angle.sign}{place}, wanted {least_wanted:g}{angle.sign}"

    def _input_text(self, value: float) -> str:
        """A value of the leading input with its name."""
        assert self._motion is not None
        lead = self._motion.quantities.names.lead
        unit, angle = self._motion.input_units[lead], self.task.angle
        return f"{lead} = {value:.6g}{angle.sign if unit == angle.value else f' {unit}'}"

    def _out_of_range(self, motion: Motion) -> Iterator[tuple[DefectKind, str]]:
        """The first position outside the driven range."""
        table = np.asarray(motion.inputs[motion.quantities.names.lead])[motion.asked]
        turn = self.task.angle.turn if motion.derivative_unit == "rad" else math.inf
        for k, at, place in islice(outside_range(self.improved.inputs, table, turn), 1):
            yield DefectKind.RANGE, f"position {k + 1} is passed at {at:.6g}, {place}"

    def _geometric_defects(self) -> Iterator[tuple[DefectKind, str]]:
        if self.task.kind != "improve":  # improvements vary what their tasks name
            yield from self._missed_dimensions()
        outside = [
            name
            for name, place in self._pivots.items()
            if not self.wishes.within_region(np.array([place]), np.zeros(1))[0]
        ]
        if outside:
            yield DefectKind.PIVOTS, f"fixed pivots outside their region: {', '.join(outside)}"
        lengths = self._lengths
        if len(lengths):
            shortest, longest = lengths.min(), lengths.max()
            if not self.wishes.allows(shortest, longest):
                yield DefectKind.LENGTHS, lengths_message(shortest, longest)
        yield from self._obstacle_defects()

    def _obstacle_defects(self) -> Iterator[tuple[DefectKind, str]]:
        whole, links = self.improved.whole_motion, self._sides
        if not len(self.wishes.obstacles) or not links:
            return
        if whole is None:
            if self._meets_obstacle():
                text = "a link meets an obstacle in a row, or passes it too closely to exclude that"
                yield DefectKind.OBSTACLE, text
            return
        contact = whole.contact([ends for _, ends in links], self.wishes.obstacles)
        if contact.met is not None:
            side, place = contact.met
            text = f'"{links[side][0]}" meets an obstacle at {self._input_text(place)}'
            yield DefectKind.OBSTACLE, text
        elif contact.open is not None:
            first, last = map(self._input_text, contact.open)
            text = "not proved: the links may meet an obstacle between"
            yield DefectKind.NOT_PROVED, f"{text} {first} and {last}"

    def _missed_dimensions(self) -> Iterator[tuple[DefectKind, str]]:
        """Pivots and lengths that the task gives and the design does not have."""
        given, points, unit = self.task.given, self.points, self.task.length
        near = EQUAL_LENGTHS * self.size
        pivots = np.array([*self._pivots.values()], dtype=complex)
        for place in given.fixed_pivots:
            if not np.abs(pivots - complex(*place)).min(initial=np.inf) <= near:
                yield DefectKind.PIVOTS, f"no fixed pivot at ({place[0]:g}, {place[1]:g}) as given"
        for name, goal in given.lengths.items():
            one, other = name.split()
            if not {one, other} <= points.keys():
                yield DefectKind.LENGTHS, f'no length "{name}", given as {goal:g} {unit}'
                continue
            length = abs(points[one] - points[other])
            if abs(length - goal) > EQUAL_LENGTHS * goal:
                message = f'the length "{name}" is {length:.6g} {unit}, given as {goal:g} {unit}'
                yield DefectKind.LENGTHS, message

    def _meets_obstacle(self) -> bool:
        """Whether a side of a link comes nearer to a circle than its ends move between rows."""
        for _, ends in self._sides:
            one, other = (self._moving_points[point] for point in ends)
            moved = max(_largest_step(one), _largest_step(other))
            for x, y, radius in self.wishes.obstacles:
                away = distances_to_segments(np.array(complex(x, y)), one, other)
                if away.min() <= radius + 0.5 * moved:
                    return True
        return False

    @property
    def proved_in_motion(self) -> tuple[str, ...]:
        """Wishes that are judged in the whole motion."""
        return () if self.improved.whole_motion is None else wishes_in_motion(self.task)

    def _details(self) -> Mapping[str, Any]:
        improved, proved = self.improved, self.proved_in_motion
        tested = () if proved or self.changed else wishes_in_motion(self.task)
        details = {
            "numbers": self.numbers,
            "inputs": list(self.inputs),
            "proved_in_motion": list(proved),
            "tested_in_rows": list(tested),
            "goals": self.goals,
            "misses": list(improved.misses),
            "total": improved.total,
            "message": improved.message,
        }
        of_all = ("inputs", "proved_in_motion", "tested_in_rows")
        return details if self.task.kind == "improve" else {key: details[key] for key in of_all}


def wishes_in_motion(task: Task) -> tuple[str, ...]:
    """Requirements of a task that depend on all positions: not lengths and fixed pivots."""
    conditions = (
        (TRANSMISSION_ANGLE.word, task.wanted.transmission),
        ("clear_of", task.wanted.obstacles),
    )
    return tuple(word for word, requested in conditions if requested)


def _is_in_order(inputs: tuple[float, ...]) -> bool:
    steps = np.diff(inputs)
    return bool((steps > 0.0).all() or (steps < 0.0).all())


def _largest_step(path: ComplexArray) -> float:
    return float(np.abs(np.diff(path)).max(initial=0.0))
