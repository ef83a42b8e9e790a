"""The result of a synthesis: counts, dyads, delivered and refused designs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import AnyArray
from linkwork.core.foundation.errors import internal
from linkwork.core.foundation.statuses import Completeness
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.core.results.tables import Summary, Table
from linkwork.synthesis.defects.verdicts import (
    Defect,
    DefectKind,
    JudgedDesign,
    Verdicts,
    defects_of,
    judge,
)
from linkwork.synthesis.loops.limits import Candidates, Drive
from linkwork.synthesis.poses.burmester import DyadSet
from linkwork.synthesis.poses.guiding_linkage import Design, linkage_of
from linkwork.synthesis.tasks.conditions import Wishes
from linkwork.synthesis.tasks.task import Task

_NONE = Wishes()
#: Defects that are wishes of the task, not properties of its positions: their words, and what the
#: wishes are without them.
_WISHES: dict[DefectKind, tuple[str, dict[str, Any]]] = {
    DefectKind.ORDER: ("the order as given", {"ordered": False}),
    DefectKind.RANGE: ("the driven range", {"range": None}),
    DefectKind.TRANSMISSION: ("the least transmission angle", {"transmission": 0.0}),
    DefectKind.PIVOTS: ("the region of fixed pivots", {"region": _NONE.region}),
    DefectKind.LENGTHS: (
        "the bounds of lengths",
        {"shortest": 0.0, "longest": np.inf, "ratio": np.inf},
    ),
    DefectKind.TOLERANCE: ("the tolerances", {"points": _NONE.points, "reach": _NONE.reach}),
    DefectKind.OBSTACLE: ("clear_of", {"obstacles": _NONE.obstacles}),
}
_COUNTS = ("complex", "real", "proved", "triples", "linkages", "starts", "interrupted")
_MOST_JUDGED = 3  # sets of requirements that are left out to count the designs that they reject


@dataclass(frozen=True, kw_only=True)
class Dyad:
    """A dyad that carries the body through the poses.

    Parameters
    ----------
    kind : str
        RR, PR or RP: its joints from ground to body.
    moving : (float, float)
        The moving pivot in the body's frame, whose origin is the guided point; for RP a point of
        the body's line [length].
    fixed : (float, float)
        The fixed pivot; for PR a point of the fixed line [length].
    normal : (float, float), optional
        The unit normal of that line.
    proved : bool
    error : float
        A bound of the errors of both pivots, and of how far a line is missed [length].
    message : str
        "proved", or why it is not.

    Examples
    --------
    >>> import linkwork as lw
    >>> poses = [(0, 0, 0), (2, 1, 20), (3, 3, 50), (2, 5, 80), (0, 6, 100)]
    >>> [(dyad.kind, dyad.proved) for dyad in lw.Task.motion(poses).solve().dyads]
    [('RR', True), ('RR', True)]
    """

    kind: str
    moving: tuple[float, float]
    fixed: tuple[float, float]
    normal: tuple[float, float] | None
    proved: bool
    error: float
    message: str

    def to_dict(self) -> dict[str, Any]:
        """Plain data, as in the command line's JSON."""
        return {k: list(v) if isinstance(v, tuple) else v for k, v in vars(self).items()}


@internal("group", "index", "zero", "output", "drive", "design")
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SynthesizedDesign(JudgedDesign):
    """One design of a loop with its verdict.

    Parameters
    ----------
    group : Verdicts
        Those on the designs of its kind.
    index : int
        Its place among them.
    zero : (float, float), optional
        One of ``zeros`` of :class:`SolvedTask`.
    output : str
        That of :class:`SolvedTask`.

    Examples
    --------
    >>> import linkwork as lw
    >>> task = lw.Task.function("log10(x)", x=(1, 2), input=(45, 105), output=(0, 90))
    >>> design = task.solve().delivered[0]
    >>> design.number, design.defects
    (1, ())
    """

    group: Verdicts
    index: int
    zero: tuple[float, float] | None
    output: str

    @property
    def drive(self) -> Drive:
        """The driven link."""
        return self.group.drive

    @property
    def points(self) -> dict[str, complex]:
        """The points at the first position [length]."""
        return self.design.points

    @cached_property
    def kinds(self) -> tuple[DefectKind, ...]:
        """The kinds of its defects; none for a sound design."""
        return tuple(kind for kind, wrong in self.group.defects.items() if wrong[self.index])

    @cached_property
    def defects(self) -> tuple[Defect, ...]:
        """Its defects in words; none for a sound design."""
        return defects_of(self.task, self.group, self.index)

    @property
    def transmission(self) -> float:
        """A lower bound of the transmission angle over the driven range, NaN where that is not
        defined [file's angle unit].
        """
        return self.task.angle.from_radians(float(self.group.transmission[self.index]))

    @property
    def size(self) -> float:
        """The longest link, or the distance of the fixed pivots [length]."""
        return float(self.group.size[self.index])

    @property
    def shortest(self) -> float:
        """The shortest link, or the distance of the fixed pivots [length]."""
        return float(self.group.shortest[self.index])

    @property
    def error(self) -> float:
        """How far positions are missed, the largest distance, or the structural error."""
        miss = float(self.group.candidates.miss[self.index])
        return self.task.angle.from_radians(miss) if self.output == "rocker" else miss

    @cached_property
    def design(self) -> Design:
        """Its points at the first position, and its driven range."""
        group, k = self.group, self.index
        travel, loops = group.travel, group.loops
        inputs = loops.input[k] if self.kinds else travel.place[k] + loops.origin[k]
        ends = inputs[[0, -1]]
        if not self.kinds:
            ends = np.array([travel.first[k], travel.last[k]]) + loops.origin[k]
        return Design.of(group.candidates, k, group.drive, inputs, ends, self.zero)

    @property
    def inputs(self) -> tuple[float, ...]:
        """The inputs at the positions [file units]."""
        values = self.design.inputs
        return tuple(map(self.task.angle.from_radians, values)) if self.drive.turns else values

    @cached_property
    def linkage(self) -> Linkage:
        """The mechanism, with the name of its design."""
        return linkage_of(self.design, self.task, self._name, self.output)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Solutions:
    """How many solutions a task has, and whether these are all.

    Parameters
    ----------
    complex, real, proved : int
        Solutions of the equations, those that are real, and those that are proved.
    triples : int
        Triples of cognates, for tasks whose solutions are counted so.
    completeness : Completeness
        Whether the real solutions are all there are.
    message : str
        The same in words of the task.
    starts : int
        Starts of a least-squares fit; 0 where equations are solved.
    interrupted : bool
        Whether the user stopped it; the designs are the best so far.
    """

    complex: int
    real: int
    proved: int
    completeness: Completeness
    message: str
    triples: int = 0
    starts: int = 0
    interrupted: bool = False


@internal("helpful_change", "what_helps")
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Synthesis(Solutions):
    """All designs for a task, sound ones first.

    Parameters
    ----------
    task : Task
    linkages : int
        Mechanisms from the real solutions; each may be driven in several ways.
    dyads : tuple of Dyad
    designs : tuple of JudgedDesign
        Every mechanism with every driven link, each a SynthesizedDesign: sound ones by score, then
        refused ones. Of ``task = "improve"`` and of six-bars each is a SweptDesign.
    what_helps : callable
        Tries other tasks and says which of them has sound designs; "" if none has.
    """

    task: Task
    linkages: int
    dyads: tuple[Dyad, ...]
    designs: tuple[JudgedDesign, ...]
    what_helps: Callable[[], str] = str

    @cached_property
    def helpful_change(self) -> str:
        """A change of the task that gives sound designs, in words; evaluated at first use."""
        return self.what_helps()

    @property
    def delivered(self) -> tuple[JudgedDesign, ...]:
        """The sound designs that the task asks for."""
        return tuple(design for design in self.designs if design.delivered)

    @cached_property
    def of_loops(self) -> tuple[SynthesizedDesign, ...]:
        """The designs that are loops, without improved mechanisms and six-bars."""
        return tuple(d for d in self.designs if isinstance(d, SynthesizedDesign))

    @property
    def refused(self) -> tuple[JudgedDesign, ...]:
        """The designs with defects."""
        return tuple(design for design in self.designs if design.kinds)

    @property
    def sound(self) -> int:
        """The number of designs without defects, delivered or not."""
        return len(self.designs) - len(self.refused)

    @property
    def defects(self) -> dict[DefectKind, int]:
        """The number of designs with each defect."""
        counts = Counter(kind for design in self.designs for kind in design.kinds)
        return {kind: counts[kind] for kind in DefectKind if counts[kind]}

    @cached_property
    def most_restrictive(self) -> tuple[str, int] | None:
        """The requirement that rejects the most designs, and how many would be sound without it;
        several requirements together if no design breaks one alone.
        """
        wishes, wanted = {*_WISHES}, self.task.wanted
        if not wanted.turns_fully and wanted.range is None:
            wishes.remove(DefectKind.RANGE)
        broken = Counter(d.kinds for d in self.refused if wishes >= {*d.kinds})
        for number in sorted({len(kinds) for kinds in broken}):
            alike = Counter({kinds: n for kinds, n in broken.items() if len(kinds) == number})
            costs = [
                (self._sound_without(kinds), kinds) for kinds, _ in alike.most_common(_MOST_JUDGED)
            ]
            count, kinds = max(costs, key=lambda cost: cost[0])
            if count:
                first, *others = (_WISHES[kind][0] for kind in kinds)
                return first + (f", together with {' and '.join(others)}" * bool(others)), count
        return None

    def _sound_without(self, kinds: tuple[DefectKind, ...]) -> int:
        """How many of the rejected designs would be sound without some requirements.

        Loops are judged anew: without a driven range another one applies, and obstacles are
        checked only for designs with few other defects.
        """
        judged = [d for d in self.refused if {*kinds} & {*d.kinds} and _WISHES.keys() >= {*d.kinds}]
        loops = [design for design in judged if isinstance(design, SynthesizedDesign)]
        if not loops:
            return sum(design.kinds == kinds for design in judged)
        count = 0
        for group in {id(design.group): design.group for design in loops}.values():
            index = np.array([design.index for design in loops if design.group is group])
            without = group.wishes
            for kind in kinds:
                without = replace(without, **_WISHES[kind][1])
            count += int(judge(group.candidates.take(index), group.drive, without).sound.sum())
        return count

    def __repr__(self) -> str:
        solutions = f"{self.complex}: {self.real} real, {self.proved} proved"
        if self.starts:
            solutions = f"{self.real} fits from {self.starts} starts"
        rows = [
            ("solutions", solutions),
            ("designs", f"{len(self.designs)} of {self.linkages} mechanisms"),
            ("delivered", f"{len(self.delivered)} of {self.sound} without defects"),
            ("completeness", self.message),
        ]
        if not self.delivered and self.designs:
            rows += [(kind.value, str(count)) for kind, count in self.defects.items()]
            if self.most_restrictive is not None:
                wish, count = self.most_restrictive
                rows.append(("most restrictive", f"{wish}: without it {count} would be sound"))
        return str(Summary(f"Synthesis of {self.task.name}", tuple(rows)))

    @property
    def error_unit(self) -> str:
        """The unit of the errors of designs."""
        return self.designs[0].error_unit if self.designs else self.task.length

    def to_dict(self, files: Mapping[int, str] | None = None) -> dict[str, Any]:
        """Plain data, as in the command line's JSON; ``files`` of designs by their place."""
        named = files or {}
        cost = self.most_restrictive
        return {
            "task": self.task.name,
            "kind": self.task.kind,
            **{name: getattr(self, name) for name in _COUNTS},
            "completeness": self.completeness.name,
            "message": self.message,
            "delivered": len(self.delivered),
            "sound": self.sound,
            "defects": {kind.name.lower(): count for kind, count in self.defects.items()},
            "most_restrictive": None if cost is None else {"wish": cost[0], "designs": cost[1]},
            "dyads": [dyad.to_dict() for dyad in self.dyads],
            "designs": [design.to_dict(named.get(k)) for k, design in enumerate(self.designs)],
        }


# ----------------------------------------------------------------------
# What a solver of tasks hands on: designs of each kind, counts, and whether the list is complete.
#
# A solver for a further kind of task returns this; verdicts, ranking and delivery follow from it.


@dataclass(frozen=True, kw_only=True, eq=False)
class SolvedTask(Solutions):
    """The designs that solve a task, before their defects are known.

    Parameters
    ----------
    candidates : tuple of Candidates
        Designs, one container for each kind; their positions are those of the task.
    dyads : DyadSet, optional
        The real dyads, if the solver combines dyads.
    drives : tuple of Drive
        The links that may be driven.
    zeros : tuple of (float, float)
        Of each container, or none: the angles of crank and rocker, or the displacement of a slider,
        that the task has at the first position [rad or length]; a link that points the other way is
        measured from its moving pivot.
    output : str
        The name of the output link or slider of a function; "" for other tasks.
    """

    candidates: tuple[Candidates, ...] = ()
    dyads: DyadSet | None = None
    drives: tuple[Drive, ...] = tuple(Drive)
    zeros: tuple[tuple[float, float], ...] = ()
    output: str = ""


# ----------------------------------------------------------------------
# All designs of a synthesis as a table.


_POINTS = ("A0", "B0", "C0", "S", "T", "U", "V", "A", "B", "C", "D", "K", "P")


def designs_table(synthesis: Synthesis, files: Mapping[int, str] | None = None) -> Table:
    """Designs in their order: numbers, points at the first position, verdict and file.

    Points that a kind of mechanism does not have are NaN.
    """
    task, designs = synthesis.task, synthesis.designs
    columns: dict[str, AnyArray] = {
        "design": np.arange(1, len(designs) + 1),
        "mechanism": np.array([design.mechanism for design in designs]),
        "drive": np.array([design.driven for design in designs]),
        "delivered": np.array([design.delivered for design in designs]),
    }
    units = dict.fromkeys(columns, "")
    numbers = {
        "score": ("", [design.score for design in designs]),
        TRANSMISSION_ANGLE.word: (task.angle.value, [design.transmission for design in designs]),
        "size": (task.length, [design.size for design in designs]),
        "error": (synthesis.error_unit, [design.error for design in designs]),
    }
    for name, misses in goal_misses(designs).items():
        numbers[f"miss of {name}"] = "", misses
    for name in _POINTS:
        places = [design.points.get(name, complex(np.nan, np.nan)) for design in designs]
        if not np.isnan(np.array([*places, 0j])[:-1]).all():
            numbers[f"{name}.x"] = task.length, [place.real for place in places]
            numbers[f"{name}.y"] = task.length, [place.imag for place in places]
    for name, (unit, values) in numbers.items():
        columns[name], units[name] = np.array(values, dtype=float), unit
    reasons = [design.defects[0].message if design.kinds else "" for design in designs]
    columns["defect"], units["defect"] = np.array(reasons, dtype=str), ""
    named = [(files or {}).get(k, "") for k in range(len(designs))]
    columns["file"], units["file"] = np.array(named, dtype=str), ""
    return Table(columns=columns, units=units, index="design")


def front_of(synthesis: Synthesis) -> dict[str, list[float]]:
    """The misses of every goal of the delivered designs; none if they are no front."""
    improvement = synthesis.task.improvement
    return goal_misses(synthesis.delivered) if improvement is not None and improvement.front else {}


def goal_misses(designs: Sequence[JudgedDesign]) -> dict[str, list[float]]:
    """The misses of every goal that improved designs have, in their order."""
    names = dict.fromkeys(name for design in designs for name in design.goals)
    return {name: [design.goals.get(name, np.nan) for design in designs] for name in names}


def relative_misses(design: JudgedDesign) -> dict[str, float]:
    """The misses of the goals of an improved design, each relative to its largest target."""
    improvement = design.task.improvement
    goals = [] if improvement is None else [goal for goal in improvement.goals if not goal.is_bound]
    sizes = [max(map(abs, (*goal.values, goal.target or 0.0))) for goal in goals]
    usual = max(sizes, default=0.0) or 1.0
    # points are the first of all misses, and no goal
    misses = list(design.goals.items())[-len(goals) :] if goals else []
    return {name: x / (size or usual) for (name, x), size in zip(misses, sizes, strict=False)}
