"""Delivered designs that are alike: Roberts' cognates, and images of one mechanism."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, replace
from functools import partial
from itertools import zip_longest
from typing import NamedTuple, TypeVar

import numpy as np

from linkwork.core.foundation.arrays import EQUAL_ROWS, Array
from linkwork.core.foundation.errors import MechanismError
from linkwork.core.foundation.statuses import Completeness
from linkwork.core.foundation.values import check_flags
from linkwork.core.results.listing import rounded_down
from linkwork.synthesis.defects.verdicts import DefectKind, JudgedDesign, Verdicts, judge
from linkwork.synthesis.improvement.settings import FITS, Improvement
from linkwork.synthesis.loops.driven_loop import Range
from linkwork.synthesis.loops.limits import Candidates, Drive
from linkwork.synthesis.poses.dyads import Refusal
from linkwork.synthesis.precision.problem import cognates, exchange_legs
from linkwork.synthesis.solvers.functions import USUAL_RATIO, has_usual_ratio, solve_function
from linkwork.synthesis.solvers.improvement import improve_mechanism
from linkwork.synthesis.solvers.motions import solve_motion
from linkwork.synthesis.solvers.paths import is_closed, solve_curve, solve_path, usual_longest
from linkwork.synthesis.solvers.result import (
    Dyad,
    Solutions,
    SolvedTask,
    Synthesis,
    SynthesizedDesign,
    goal_misses,
    relative_misses,
)
from linkwork.synthesis.solvers.swept_design import SweptDesign, wishes_in_motion
from linkwork.synthesis.solvers.watt import solve_watt
from linkwork.synthesis.tasks.conditions import Wanted, Wishes
from linkwork.synthesis.tasks.function_goal import FunctionGoal
from linkwork.synthesis.tasks.task import MECHANISMS, Task

_ALIKE = 0.01  # of the longest link of the smaller one: fits of one minimum from several starts
_EQUAL_NUMBERS = 1e-3  # relative: numbers of mirror images

_LEGS = ("A", "A0", "B", "B0")
_Pair = tuple[SynthesizedDesign, SynthesizedDesign]


def alike_among(synthesis: Synthesis) -> Iterator[str]:
    """The groups of delivered loops that are alike, in words."""
    loops = [design for design in synthesis.of_loops if design.delivered]
    images = list(_images(loops))
    # of a symmetric curve a cognate may be the mirror image, which has the same links
    others = [pair for pair in _cognates(loops) if pair not in images]
    for title, pairs in (
        ("Cognates draw one curve with different links", others),
        ("The same links in different places", images),
    ):
        groups: list[set[int]] = []
        for one, other in pairs:
            pair = {one.number, other.number}
            joined = [group for group in groups if group & pair]
            groups = [g for g in groups if g not in joined] + [pair.union(*joined)]
        shown = [", ".join(map(str, sorted(group))) for group in sorted(groups, key=min)]
        if shown:
            yield f"{title}: designs {'; '.join(shown)}."


def _cognates(loops: Sequence[SynthesizedDesign]) -> Iterator[_Pair]:
    """Four-bars with P in one place, the second of which is a cognate of the first."""
    loops = [design for design in loops if design.points.keys() == {*_LEGS, "P"}]
    places = np.array([[d.points[name] for name in (*_LEGS, "P")] for d in loops]).reshape(-1, 5)
    legs, sizes = places[:, :4] - places[:, 4:], np.array([design.size for design in loops])
    linkages = np.stack([legs, legs.conj()], axis=2).reshape(-1, 8)
    for k, one in enumerate(loops):
        rest = slice(k + 1, None)
        others = np.array([linkages[rest], exchange_legs(linkages[rest])])
        of_linkage = np.array(cognates(linkages[k : k + 1]))[:, None]
        away = np.abs(of_linkage - others).max(axis=3).min(axis=(0, 1))
        away = np.maximum(away, np.abs(places[rest, 4] - places[k, 4]))
        near = away <= _ALIKE * np.minimum(sizes[rest], sizes[k])
        yield from ((one, loops[k + 1 + int(i)]) for i in np.flatnonzero(near))


def _images(loops: Sequence[SynthesizedDesign]) -> Iterator[_Pair]:
    """Designs with the same links, by their longest, their shortest and their angle."""
    numbers = np.array([(d.size, d.shortest, d.transmission) for d in loops]).reshape(-1, 3)
    for k, one in enumerate(loops):
        alike = np.isclose(numbers[k + 1 :], numbers[k], rtol=_EQUAL_NUMBERS, atol=0.0)
        for other in (loops[k + 1 + int(i)] for i in np.flatnonzero(alike.all(axis=1))):
            if one.mechanism == other.mechanism and one.drive is other.drive:
                yield one, other


# ----------------------------------------------------------------------
# What to do about delivered designs that a designer would not build, or about none at all.


#: Handbooks ask for 40 deg or more; below 30 deg friction jams many mechanisms.
_LEAST_TRANSMISSION = 30.0  # [deg]
_MISSED = 1e-6  # of the target: a goal that is not met
_AT_BOUND = 0.999  # of the longest link
_MOVING = (DefectKind.CIRCUIT, DefectKind.BRANCH, DefectKind.ORDER)


def remarks_on(result: Synthesis) -> tuple[str, ...]:
    """Remarks on doubtful delivered designs, and the requirements that would reject them.

    A task that states a requirement gets no remark about it.
    """
    counts = [(sum(map(doubt.concerns, result.delivered)), doubt) for doubt in _doubts(result.task)]
    doubts = (
        f"Delivered designs with {doubt.what}: {count}. {doubt.wish} refuses them."
        for count, doubt in counts
        if count
    )
    return (*doubts, *_missed_goals(result), *alike_among(result))


def _missed_goals(synthesis: Synthesis) -> Iterator[str]:
    """The goals that no delivered design comes near, with the smallest miss; of fronts none."""
    if synthesis.task.improvement is None or synthesis.task.improvement.front:
        return
    shares = [relative_misses(design) for design in synthesis.delivered]
    for name, misses in goal_misses(synthesis.delivered).items():
        share = min((by_goal.get(name, 0.0) for by_goal in shares), default=0.0)
        if share > _MISSED:
            yield f"Every delivered design misses {name} by {min(misses):.4g} or more."


def remark_on(design: JudgedDesign) -> str:
    """A remark on a doubtful sound design, with what would reject it; "" for none."""
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
        over, ratio = ("at the default bound,", "…") if usual else ("over", f"{USUAL_RATIO:g}")
        yield _Doubt(
            f"a longest link {over} {USUAL_RATIO:g} times the shortest",
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


def advice_of(synthesis: Synthesis) -> str:
    """Advice for a task without a sound design: a change that helps, or how near designs come to
    the most restrictive requirement. Changes of a function are tried. "" if there is a sound
    design.
    """
    if synthesis.sound:
        return ""
    if synthesis.helpful_change:
        return synthesis.helpful_change
    if synthesis.most_restrictive is not None:
        return _attained(synthesis)
    if synthesis.task.kind == "improve":
        return _of_improvement(synthesis) if synthesis.designs else _of_goals(synthesis)
    if synthesis.designs and not synthesis.defects.keys() & {*_MOVING}:
        return ""
    blame = "No requirement alone is to blame. " if synthesis.designs else ""
    return f"{blame}Try to {', or '.join(_changes(synthesis))}."


def _of_improvement(synthesis: Synthesis) -> str:
    """Why nothing was improved, or what may give a sound design in the driven range."""
    settings = synthesis.task.improvement
    for design in synthesis.designs:
        if design.kinds == (DefectKind.UNMOVED,):
            reason = design.defects[0].message
            return f"{reason[:1].upper()}{reason[1:]}."
    if DefectKind.RANGE not in synthesis.defects:
        return ""
    wider = ", wider bounds" if settings is not None and settings.bounds else ""
    return (
        f"The driven range is the table of {synthesis.task.mechanisms[0]}. Try more "
        f"starts{wider}, targets nearer to its present values, or a part of the range: "
        "[wanted] input = { from = …, to = … }."
    )


def near_misses(synthesis: Synthesis) -> list[int]:
    """The places of designs that have too small a transmission angle and no other defect, the
    largest angle first.
    """
    near = [k for k, d in enumerate(synthesis.designs) if d.kinds == (DefectKind.TRANSMISSION,)]
    return sorted(near, key=lambda k: -synthesis.designs[k].transmission)


def _attained(synthesis: Synthesis) -> str:
    for k in near_misses(synthesis)[:1]:
        best = rounded_down(synthesis.designs[k].transmission, 4)
        return f"The best least transmission angle is {best:g}{synthesis.task.angle.sign}."
    return ""


def _of_goals(synthesis: Synthesis) -> str:
    """How to see why no start of an improvement has all its goals."""
    settings = synthesis.task.improvement
    names = [goal.of for goal in settings.goals] if settings is not None else []
    if not names:
        return "Start nearer to the positions."
    shown = ", ".join(f'"{name}"' for name in names)
    why = "No start has a value of every goal; the time ratio of a constant angle has none."
    if settings is not None and settings.bounds:
        why = "No start within the bounds closes and has a value of every goal."
    name = synthesis.task.mechanisms[0]
    return f"{why} linkwork sweep {name} --columns shows the values of {shown}."


def _changes(synthesis: Synthesis) -> list[str]:
    """Changes of a task that give further designs, the smallest first."""
    task, given = synthesis.task, synthesis.task.given
    if task.function is not None:
        return ["change the ranges of input and output"]
    others = [name for name in MECHANISMS if name not in task.mechanisms and task.kind == "motion"]
    tolerant = any(position.tolerance for position in task.positions)
    changes = {
        f'allow other kinds of mechanism, such as "{"".join(others[:1])}"': others,
        "enlarge the region of fixed pivots": task.wanted.region,
        "give fewer pivots and lengths": given.fixed_pivots or given.moving_pivots or given.lengths,
        "search from more starts": synthesis.starts,
        "give positions a tolerance": not (synthesis.starts or tolerant),
        "move a position or leave it out": True,
    }
    return [change for change, helps in changes.items() if helps]


# ----------------------------------------------------------------------
# From a task to its designs: solve, judge, rank, describe.
#
# :data:`SOLVERS` holds one solver for each kind of task; a further one needs a line there.


Solver = Callable[[Task, Wishes, Callable[[float], None] | None], SolvedTask]

#: The solvers by kind of task.
SOLVERS: dict[str, Solver] = {
    "motion": lambda task, wishes, progress: solve_motion(task, wishes),
    "path": lambda task, wishes, progress: (
        solve_curve(task, wishes, progress)
        if task.is_approximate
        else solve_path(task, wishes, progress, _sound_designs(task))
    ),
    "mixed": lambda task, wishes, progress: solve_path(
        task, wishes, progress, _sound_designs(task)
    ),
    "function": solve_function,
}
_RIGHT = math.pi / 2.0
_Design = TypeVar("_Design", bound=JudgedDesign)


def solve_task(task: Task, *, progress: Callable[[float], None] | None = None) -> Synthesis:
    """All designs for a task, each with its defects.

    Raises
    ------
    InputError
        If the task contradicts itself.
    """
    check_flags(progress)
    if task.kind == "improve":
        return _improved(task, progress)
    if task.is_six_bar:
        return _six_bars(task, progress)
    return replace(_of_loops(task, progress), what_helps=partial(_what_helps, task))


def _of_loops(task: Task, progress: Callable[[float], None] | None = None) -> Synthesis:
    """Designs of one loop."""
    solved = SOLVERS[task.kind](task, wishes_of(task, Drive.A0), progress)
    judged = [
        (judge(part, drive, _measured(wishes_of(task, drive), part, zero)), zero)
        for part, zero in zip_longest(solved.candidates, solved.zeros)
        for drive in part.drives
        if drive in solved.drives
    ]
    if task.function is not None:
        solved = replace(solved, message=solved.message + task.function.note)
    designs = _ranked_loops(task, judged, solved.output)
    return _synthesis(task, solved, designs, sum(map(len, solved.candidates)))


def _synthesis(
    task: Task, solved: SolvedTask, designs: Sequence[JudgedDesign], linkages: int
) -> Synthesis:
    return Synthesis(
        task=task,
        linkages=linkages,
        dyads=() if solved.dyads is None else tuple(_dyads(solved)),
        designs=tuple(designs),
        **{field.name: getattr(solved, field.name) for field in fields(Solutions)},
    )


def _what_helps(task: Task) -> str:
    """The first change of a task of a function with sound designs, and their number."""
    goal = task.function
    if goal is None:
        return ""
    changes: dict[str, FunctionGoal] = {}
    if goal.starts_fixed:
        free = goal.freed
        spans = [f"{name} = {getattr(free, name)[1]:g}" for name in free.free]
        change = "leave out input and output" if goal.pairs else " and ".join(spans)
        changes[f"With free start angles ({change})"] = free
    changes |= {f'With fit = "{fit}"': replace(goal, fit=fit) for fit in FITS if fit != goal.fit}
    for change, other in changes.items():
        try:
            count = _of_loops(replace(task, function=other)).sound
        except MechanismError:  # more pairs than free start angles meet
            continue
        if count:
            designs = "is 1 design" if count == 1 else f"are {count} designs"
            return f"{change} there {designs} without defects."
    return ""


def _measured(wishes: Wishes, part: Candidates, zero: tuple[float, float] | None) -> Wishes:
    """Wishes with the range of a crank that the task measures from its moving pivot."""
    span = wishes.range
    crank = (part.moving_a[:1, 0] - part.fixed_a[:1]) * np.exp(-1j * (zero or (0.0, 0.0))[0])
    if span is None or zero is None or (crank.real > 0.0).all():
        return wishes
    return replace(
        wishes, range=replace(span, start=span.start + math.pi, stop=span.stop + math.pi)
    )


def _sound_designs(task: Task) -> Callable[[Candidates], int]:
    """What counts the sound designs of candidates, with any link driven."""

    def number(part: Candidates) -> int:
        verdicts = (judge(part, drive, wishes_of(task, drive)) for drive in part.drives)
        return sum(int(verdict.sound.sum()) for verdict in verdicts)

    return number


def _improved(task: Task, progress: Callable[[float], None] | None) -> Synthesis:
    """Improved designs, sound ones by falling score."""
    designs, starts, interrupted = improve_mechanism(task, wishes_of(task, Drive.A0), progress)
    settings = task.improvement or Improvement()
    rank = partial(_ranked_alone, task, designs, in_order=bool(settings.front))
    try:
        ranked = rank()
    except KeyboardInterrupt:
        # verdicts so far are kept; a further interruption ends the rest
        interrupted, ranked = True, rank()
    kind = "different fits"
    if settings.front:
        kind = "a front of designs, each the best one in some goal or trade-off,"
    message = f"a sample: {kind} from {starts} starts with seed {settings.seed}"
    message += _of_motion(task, ranked)
    message += "" if task.curve is None else task.curve.note
    count = len(designs)
    solved = SolvedTask(
        complex=count,
        real=count,
        proved=sum(design.improved.sound for design in designs),
        completeness=Completeness.SAMPLED,
        message=f"interrupted: the best so far of {starts} starts" if interrupted else message,
        starts=starts,
        interrupted=interrupted,
    )
    return _synthesis(task, solved, ranked, count)


def _six_bars(task: Task, progress: Callable[[float], None] | None) -> Synthesis:
    """All Watt-II six-bars of a function, sound ones by falling score."""
    designs, solved = solve_watt(task, wishes_of(task, Drive.A0), progress)
    ranked = _ranked_alone(task, designs)
    solved = replace(solved, message=solved.message + _of_motion(task, ranked))
    return _synthesis(task, solved, ranked, len(designs))


def _of_motion(task: Task, designs: Sequence[SweptDesign]) -> str:
    """A note whether requirements of swept sound designs are proved or tested in rows."""
    sound, wishes = [d for d in designs if not d.kinds], " and ".join(wishes_in_motion(task))
    if not wishes or not sound:
        return ""
    if all(design.proved_in_motion for design in sound):
        return f"; {wishes} proved on the whole motion"
    return f"; {wishes} tested in the rows of the table, all else on the whole motion"


def _ranked_alone(
    task: Task, designs: Sequence[_Design], *, in_order: bool = False
) -> tuple[_Design, ...]:
    """Designs that were judged one by one: sound ones by falling score, then the others.

    ``in_order``: sound ones keep their order, and all are delivered.
    """
    # an angle in radians, as those of four-bars are
    unit = {task.angle.value: task.angle.radians}
    measured = [
        (
            task.in_radians(d.transmission),
            d.size,
            max(relative_misses(d).values(), default=0.0)  # of bounds alone
            if task.has_goals_alone
            else d.error * unit.get(d.error_unit, 1.0),
        )
        for d in designs
    ]
    scores = _scores(task, *np.array(measured, dtype=float).reshape(-1, 3).T)
    refused = [bool(design.kinds) for design in designs]
    return _ranked(task, designs, refused, scores, in_order=in_order)


def _ranked(
    task: Task,
    designs: Sequence[_Design],
    refused: Sequence[bool],
    scores: Array,
    *,
    in_order: bool = False,
) -> tuple[_Design, ...]:
    """Sound designs by falling score, then the others in their order."""
    order = sorted(
        (wrong, 0.0 if wrong or in_order else -score, k)
        for k, (wrong, score) in enumerate(zip(refused, scores.tolist(), strict=True))
    )
    sound, ranked = len(designs) - sum(refused), list[_Design]()
    for place, (wrong, _, k) in enumerate(order, start=1):
        number = place - sound if wrong else place
        delivered = not wrong and (in_order or number <= task.rank.deliver)
        design = replace(designs[k], number=number, delivered=delivered, score=float(scores[k]))
        ranked.append(design)
    return tuple(ranked)


def wishes_of(task: Task, drive: Drive) -> Wishes:
    """The requirements of a task in radians, lengths and complex points, for one driven link."""
    wanted = task.wanted
    reach = np.array([position.tolerance for position in task.positions])
    # designs for five poses meet them within tolerance; for more poses only such designs are kept
    judged = task.kind != "motion" and reach.any()
    points = np.array([complex(*position.point) for position in task.positions])
    return Wishes(
        ordered=wanted.ordered and not _is_timed_around(task),
        range=_range(task, wanted, drive),
        beyond=_beyond(task),
        transmission=task.in_radians(wanted.transmission),
        region=np.array([complex(*corner) for corner in wanted.region]),
        shortest=wanted.shortest,
        longest=wanted.longest,
        ratio=wanted.ratio,
        obstacles=np.array(wanted.obstacles, dtype=float).reshape(-1, 3),
        points=points[: len(points) * judged],
        reach=reach[: len(reach) * judged],
    )


def _is_timed_around(task: Task) -> bool:
    """Whether the given inputs rise or fall by a whole turn. The first and last position then have
    one input, and the inputs state the order.
    """
    inputs = [position.input for position in task.positions]
    if len(inputs) < 2 or any(value is None for value in inputs):
        return False
    steps = np.diff(np.array(inputs, dtype=float))
    monotone = bool((steps > 0.0).all() or (steps < 0.0).all())
    return monotone and abs(steps.sum()) >= task.angle.turn * (1.0 - EQUAL_ROWS)


def _range(task: Task, wanted: Wanted, drive: Drive) -> Range | None:
    if wanted.turns_fully:
        return Range(turn=True)
    if wanted.range is None:
        fitted = task.kind == "path" and task.is_approximate
        return Range(turn=True) if fitted and is_closed(task) else None
    start, stop = wanted.range
    if drive.turns:
        start, stop = task.in_radians(start), task.in_radians(stop)
    return Range(start=start, stop=stop)


def _beyond(task: Task) -> float:
    """How far the range of a function reaches beyond its first and last precision point [rad]."""
    goal = task.function
    if goal is None or goal.pairs or goal.input is None:
        return 0.0
    return task.in_radians(float(abs(goal.points()[0][0] - goal.input[0])))


def _ranked_loops(
    task: Task, judged: Sequence[tuple[Verdicts, tuple[float, float] | None]], output: str
) -> tuple[SynthesizedDesign, ...]:
    """Designs of loops, which were judged together."""
    designs = [
        SynthesizedDesign(
            task=task,
            mechanism=part.candidates.kind.value,
            driven=part.drive.value,
            error_unit=task.angle.value if output == "rocker" else task.length,
            group=part,
            index=k,
            zero=zero,
            output=output,
        )
        for part, zero in judged
        for k in range(len(part.candidates))
    ]
    scores = [
        _scores(task, part.transmission, part.size, part.candidates.miss) for part, _ in judged
    ]
    refused = [bool(wrong) for part, _ in judged for wrong in ~part.sound]
    return _ranked(task, designs, refused, np.concatenate([np.zeros(0), *scores]))


def _scores(task: Task, transmission: Array, sizes: Array, miss: Array) -> Array:
    """Weighted means of transmission, smallness and exactness, (D,), each from 0 to 1."""
    rank, (size, usual_miss) = task.rank, _task_sizes(task, sizes)
    with np.errstate(invalid="ignore"):
        parts = [
            (rank.transmission, transmission / _RIGHT),
            (rank.size, size / (size + sizes)),
            (rank.error, 1.0 / (1.0 + miss / usual_miss)),
        ]
    total = sum(weight for weight, _ in parts) or 1.0
    return np.asarray(sum(weight * np.nan_to_num(score) for weight, score in parts) / total)


def _task_sizes(task: Task, sizes: Array) -> tuple[float, float]:
    """The size that scores divide lengths by (of the task, or the median of designs (D,) for goals
    alone), and the size that they divide misses by (1 for goals alone, which are relative).
    """
    goal = task.function
    if task.has_goals_alone:
        known = sizes[np.isfinite(sizes)]
        return float(np.median(known)) if len(known) else 1.0, 1.0
    if goal is not None and "slider-crank" not in task.mechanisms:
        return task.given.ground, 1.0
    points = np.array([complex(*position.point) for position in task.positions] or [0.0])
    points = points if goal is None else goal.points()[1]
    span = float(np.abs(points - points.mean()).max()) or 1.0
    return span, span


def _dyads(solved: SolvedTask) -> Iterator[Dyad]:
    assert solved.dyads is not None
    for kind, moving, fixed, normal, error, refusal in solved.dyads.dyads():
        yield Dyad(
            kind=kind,
            moving=(moving.real, moving.imag),
            fixed=(fixed.real, fixed.imag),
            normal=(normal.real, normal.imag) if normal else None,
            proved=refusal is Refusal.NONE,
            error=error,
            message=refusal.value,
        )
