"""What to do about delivered designs that a designer would not build, or about none at all."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

from linkwork.design.defects.judged_design import JudgedDesign
from linkwork.design.defects.verdicts import DefectKind
from linkwork.design.synthesis.curve_synthesis import usual_longest
from linkwork.design.synthesis.designs_table import goal_misses, relative_misses
from linkwork.design.synthesis.function_synthesis import USUAL_RATIO, has_usual_ratio
from linkwork.design.synthesis.kinship import alike_among
from linkwork.design.synthesis.result import Synthesis
from linkwork.design.tasks.task import Task
from linkwork.design.tasks.wanted_mechanisms import MECHANISMS
from linkwork.results.listing.number_text import rounded_down

__all__ = ["advice_of", "near_misses", "remark_on", "remarks_on"]

#: Handbooks ask for 40 deg or more; below 30 deg friction jams many mechanisms.
_LEAST_TRANSMISSION = 30.0  # [deg]
_MISSED = 1e-6  # of what is wanted: a goal that is not met
_AT_BOUND = 0.999  # of the longest link
_MOVING = (DefectKind.CIRCUIT, DefectKind.BRANCH, DefectKind.ORDER)


def remarks_on(found: Synthesis) -> tuple[str, ...]:
    """What is doubtful about delivered designs, and the wishes that refuse these.

    A task that states a wish gets no remark about it.
    """
    counts = [(sum(map(doubt.concerns, found.delivered)), doubt) for doubt in _doubts(found.task)]
    doubts = (
        f"Delivered designs with {doubt.what}: {count}. {doubt.wish} refuses them."
        for count, doubt in counts
        if count
    )
    return (*doubts, *_missed_goals(found), *alike_among(found))


def _missed_goals(found: Synthesis) -> Iterator[str]:
    """The goals that no delivered design comes near, with the smallest miss; of fronts none."""
    if found.task.improvement is None or found.task.improvement.front:
        return
    shares = [relative_misses(design) for design in found.delivered]
    for name, misses in goal_misses(found.delivered).items():
        share = min((own.get(name, 0.0) for own in shares), default=0.0)
        if share > _MISSED:
            yield f"Every delivered design misses {name} by {min(misses):.4g} or more."


def remark_on(design: JudgedDesign) -> str:
    """What is doubtful about a sound design, and the wish that refuses it; "" if nothing is."""
    if design.kinds:
        return ""
    doubts = (doubt for doubt in _doubts(design.task) if doubt.concerns(design))
    return " ".join(f"It has {doubt.what}: {doubt.wish} refuses it." for doubt in doubts)


class _Doubt(NamedTuple):
    what: str
    wish: str
    concerns: Callable[[JudgedDesign], bool]


def _doubts(task: Task) -> Iterator[_Doubt]:
    wanted = task.wanted
    if not wanted.transmission:
        least = _LEAST_TRANSMISSION * task.angle.turn / 360.0
        yield _Doubt(
            f"a transmission angle below {least:.4g} {task.angle.value}",
            f"[wanted] transmission = {{ least = {least:.4g} }}",
            lambda design: design.transmission < least,
        )
    if (wanted.shortest, wanted.longest, wanted.ratio) == (0.0, math.inf, math.inf):
        usual = has_usual_ratio(task)
        bound = USUAL_RATIO * (_AT_BOUND if usual else 1.0)
        told, ratio = ("at the default bound,", "…") if usual else ("over", f"{USUAL_RATIO:g}")
        yield _Doubt(
            f"a longest link {told} {USUAL_RATIO:g} times the shortest",
            f"[wanted] lengths = {{ ratio = {ratio} }}",
            lambda design: design.size > bound * design.shortest,
        )
    longest = usual_longest(task) if task.kind == "path" and task.is_approximate else math.inf
    if longest < math.inf:
        yield _Doubt(
            f"a longest link at the usual bound, {longest:.4g} {task.length}",
            "[wanted] lengths = { most = … }",
            lambda design: design.size > _AT_BOUND * longest,
        )


def advice_of(found: Synthesis) -> str:
    """What could be changed in a task without a sound design that no relaxed wish would help, or
    what is attained of one; of a function also what else helps, which is tried. "" if there is a
    sound design.
    """
    if found.sound:
        return ""
    if found.helpful_change:
        return found.helpful_change
    if found.costliest is not None:
        return _attained(found)
    if found.task.kind == "improve":
        if not found.designs:
            return _of_goals(found)
        unmoved = [own for own in found.designs if own.kinds == (DefectKind.UNMOVED,)]
        if unmoved:
            return (
                f"{unmoved[0].defects[0].message[:1].upper()}{unmoved[0].defects[0].message[1:]}."
            )
        settings = found.task.improvement
        wider = ", wider bounds" if settings is not None and settings.bounds else ""
        told = (
            f"The driven range is the table of {found.task.mechanisms[0]}. Try more starts{wider}, "
            "targets nearer to its own values, or a part of it: "
            "[wanted] input = { from = …, to = … }."
        )
        return told if DefectKind.RANGE in found.defects else ""
    if found.designs and not found.defects.keys() & {*_MOVING}:
        return ""
    first, *others = _changes(found)
    steps = first + "".join(f", or {other}" for other in others)
    blame = "No wish is to blame. " if found.designs else ""
    return f"{blame}Try to {steps}."


def near_misses(found: Synthesis) -> list[int]:
    """The places of designs that have too small a transmission angle and no other defect, the
    largest angle first.
    """
    own = [k for k, d in enumerate(found.designs) if d.kinds == (DefectKind.TRANSMISSION,)]
    return sorted(own, key=lambda k: -found.designs[k].transmission)


def _attained(found: Synthesis) -> str:
    for k in near_misses(found)[:1]:
        best = rounded_down(found.designs[k].transmission, 4)
        return f"The best least transmission angle is {best:g}{found.task.angle.sign}."
    return ""


def _of_goals(found: Synthesis) -> str:
    """How to see why no start of an improvement has all its goals."""
    settings = found.task.improvement
    names = [goal.of for goal in settings.goals] if settings is not None else []
    if not names:
        return "Start nearer to the positions."
    shown = ", ".join(f'"{name}"' for name in names)
    why = "No start has a value of every goal; the time ratio of a constant angle has none."
    if settings is not None and settings.bounds:
        why = "No start within the bounds closes and has a value of every goal."
    return f"{why} linkwork sweep {found.task.mechanisms[0]} --columns shows the values of {shown}."


def _changes(found: Synthesis) -> Iterator[str]:
    """Changes of a task that give further designs, the smallest first."""
    task = found.task
    if task.function is not None:
        yield "change the ranges of input and output"
        return
    if task.kind == "motion" and not {*MECHANISMS} <= {*task.mechanisms}:
        other = next(name for name in MECHANISMS if name not in task.mechanisms)
        yield f'allow other kinds of mechanism, such as "{other}"'
    if task.wanted.region:
        yield "enlarge the region of fixed pivots"
    if task.given.fixed_pivots or task.given.moving_pivots or task.given.lengths:
        yield "give fewer pivots and lengths"
    if found.starts:
        yield "search from more starts"
    elif not any(position.tolerance for position in task.positions):
        yield "give positions a tolerance"
    yield "move a position or leave it out"
