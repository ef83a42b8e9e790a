"""Function generation: all loops whose output follows given pairs, or fits a function best."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.core.foundation.rounding import UNIT_ROUNDOFF
from linkwork.core.foundation.statuses import Completeness
from linkwork.core.foundation.units import FULL_TURN
from linkwork.synthesis.lane_problems import Progress
from linkwork.synthesis.loops.candidates import Candidates, Drive, LoopKind, solve_with_bound
from linkwork.synthesis.loops.limits import cross
from linkwork.synthesis.poses.burmester import sampled_dyads
from linkwork.synthesis.poses.dyad_set import DyadSet, PoseSet
from linkwork.synthesis.poses.dyads import solve_five_poses
from linkwork.synthesis.solvers.functions import FittedPairs, fit_functions
from linkwork.synthesis.solvers.result import SolvedTask
from linkwork.synthesis.tasks.conditions import Wishes
from linkwork.synthesis.tasks.task import Task

#: Of the longest to the shortest link of fits without [wanted] lengths, so that one can draw them.
USUAL_RATIO = 20.0

_LOSS = 16.0 * UNIT_ROUNDOFF  # of angles, their sines, and sums of few of them
_SMALL = 0.05  # relative errors up to which a quotient's error is at most 1.1 times its first order
_STARTS = 24  # start angles in each direction, where two are free
_TRIVIAL = 1e-6  # relative: both moving pivots at the fixed ones move in every function
_FIVE, _FOUR = 5, 4
_SHARES = (0.067, 0.15, 0.25, 0.0)  # of the range, before the first point of a start
# for given start angles: before the first and behind the last point, and before the middle one
_FIRSTS, _MIDDLES = (0.0, 0.067, 0.15, 0.25, 0.35), (0.4, 0.5, 0.6)


def solve_function(task: Task, wishes: Wishes, progress: Progress | None = None) -> SolvedTask:
    """All designs, or a sample of the family, for a function task."""
    goal = task.function
    assert goal is not None, "a task of functions has one"
    slides = task.mechanisms[0] == "slider-crank"
    inputs, outputs = goal.points()
    u = np.array([inputs * task.angle.radians])
    v = np.array([outputs * (1.0 if slides else task.angle.radians)])
    if not goal.starts_fixed:
        u, v = u - u[:, :1], v - v[:, :1]
    # the ground of a four-bar, or a power of two near the outputs, which divides without rounding
    unit = float(2.0 ** np.frexp(np.abs(v).max())[1]) if slides else task.given.ground
    of_outputs = unit if slides else 1.0
    wishes = replace(wishes, shortest=wishes.shortest / unit, longest=wishes.longest / unit)
    solved = _solved(task, wishes, u, v / of_outputs, progress)
    first = complex(*(task.given.fixed_pivots or [(0.0, 0.0)])[0])
    return replace(
        solved,
        candidates=tuple(
            replace(part.moved(first, unit), miss=of_outputs * part.miss)
            for part in solved.candidates
        ),
        zeros=tuple((begin, of_outputs * output) for begin, output in solved.zeros),
    )


def _solved(
    task: Task, wishes: Wishes, u: Array, v: Array, progress: Progress | None
) -> SolvedTask:
    """Designs whose fixed pivot A0 is at 0, for inputs and outputs (1, K)."""
    goal, slides = task.function, task.mechanisms[0] == "slider-crank"
    assert goal is not None, "a task of functions has one"
    if goal.fit:
        return _fitted(task, wishes, u[0], v[0], slides, progress)
    if goal.starts_fixed:
        made, determined = _through_three(u, v, slides)
        zeros = ((float(u[0, 0]), float(v[0, 0])),) * len(made)
        return _solved_function(task, made, complete=1 if determined.all() else -1, zeros=zeros)
    if u.shape[1] == _FIVE:
        return _through_five(task, u, v, slides)
    if u.shape[1] == _FOUR:
        return _through_four(task, u, v, slides)
    made, _ = _through_three(*_freely_begun(u, v, slides), slides)
    return _solved_function(task, made, complete=0)


def _freely_begun(u: Array, v: Array, slides: bool) -> tuple[Array, Array]:
    """Inputs and outputs (1, K) from a grid of starts, (B, K) each."""
    # half a turn more is a negative length
    grid = np.linspace(0.0, np.pi, _STARTS, endpoint=False)
    first, second = (x.ravel() for x in np.meshgrid(grid, grid))
    if slides:
        # displacements may begin anywhere within twice their range
        second = (second * (2.0 / np.pi) - 1.0) * 2.0 * np.ptp(v)
    return u + first[:, None], v + second[:, None]


def freudenstein(u: Array, v: Array) -> tuple[Array, Array]:
    """K of cos(φ - ψ) = K1 cos ψ - K2 cos φ + K3, (B, 3), with bounds of the errors, eq. (149).

    Parameters
    ----------
    u, v : (B, 3)
        Angles φ of the crank and ψ of the rocker, both from the line of the ground [rad].

    Returns
    -------
    (B, 3), (B, 3)
        K1 = d/a, K2 = d/b, K3 = (a² + b² - c² + d²)/(2ab); a negative length points the other way.

    References
    ----------
    F. Freudenstein: Approximate synthesis of four-bar linkages. Transactions of the ASME 77 (1955)
    """
    # eq. (149)
    matrix = np.stack([np.cos(v), -np.cos(u), np.ones_like(u)], axis=-1)
    doubt = _LOSS * (1.0 + np.abs(u).max(axis=1) + np.abs(v).max(axis=1))
    return solve_with_bound(matrix, np.cos(u - v), doubt, doubt)


def _through_three(u: Array, v: Array, slides: bool) -> tuple[list[Candidates], BoolArray]:
    """Loops with given start angles, for B functions (B, 3), and which functions determine a loop,
    also with complex numbers only.
    """
    if slides:
        # eq. (150)
        matrix = np.stack([2.0 * v * np.cos(u), 2.0 * np.sin(u), np.ones_like(u)], axis=-1)
        far = _LOSS * (1.0 + np.abs(v).max(axis=1) ** 2) * (1.0 + np.abs(u).max(axis=1))
        k, error = solve_with_bound(matrix, v**2, far, far)
        with np.errstate(all="ignore"):
            a, e = k[:, 0], k[:, 1] / k[:, 0]
            square = k[:, 2] + a**2 + e**2
            doubt = 1.1 * error[:, 0] * (1.0 + np.abs(e)) / np.abs(a)
        determined = error[:, 0] < _SMALL * np.abs(k[:, 0])
        good = (square > 0) & determined
        return _loops(u[good], v[good], a[good], e[good], doubt[good], slides), determined
    k, error = freudenstein(u, v)
    with np.errstate(all="ignore"):
        a, b = 1.0 / k[:, 0], 1.0 / k[:, 1]
        square = a**2 + b**2 + 1.0 - 2.0 * a * b * k[:, 2]
        doubt = 1.1 * error[:, 0] * np.maximum(a**2, b**2)
    determined = np.asarray((error[:, :2] < _SMALL * np.abs(k[:, :2])).all(axis=1))
    good = (square > 0) & determined
    return _loops(u[good], v[good], a[good], b[good], doubt[good], slides), determined


def _loops(
    u: Array, v: Array, a: Array, second: Array, error: Array, slides: bool
) -> list[Candidates]:
    """Loops with A0 at 0, for cranks (D,) with rockers or offsets, inputs and outputs (D, K)."""
    if not len(u):
        return []
    zero = np.zeros(len(u), dtype=complex)
    moving = a[:, None] * np.exp(1j * u)
    fixed_b = np.asarray(1j * second if slides else zero + 1.0, dtype=np.complex128)
    output = v if slides else second[:, None] * np.exp(1j * v)
    return [
        Candidates(
            kind=LoopKind.SLIDER_CRANK if slides else LoopKind.FOUR_BAR,
            fixed_a=zero,
            fixed_b=fixed_b,
            direction=np.full(len(u), slides, dtype=complex),
            moving_a=moving,
            moving_b=fixed_b[:, None] + output,
            error=error,
        )
    ]


def _relative_poses(u: Array, v: Array, slides: bool) -> tuple[ComplexArray, Array]:
    """The output link as the crank's link sees it, (B, N) complex and (B, N) [rad].

    A dyad of these poses is the coupler: its fixed pivot is A in the crank's frame, its moving
    pivot B in the output's frame.
    """
    if slides:
        return np.asarray(np.exp(-1j * u) * v), -u
    return np.asarray(np.exp(-1j * u)), v - u


def _coupled(dyads: DyadSet, u: Array, v: Array, slides: bool) -> list[Candidates]:
    """Loops from the dyads of relative poses, without the trivial one."""
    size = 1.0 if not slides else float(np.abs(v).max())
    real = (dyads.kind == 0) & (np.abs(dyads.fixed) > _TRIVIAL * size)
    real &= slides | (np.abs(dyads.moving) > _TRIVIAL * size)
    some = dyads.take(real)
    crank = some.moving
    begin, second = (crank.real, crank.imag) if slides else (np.angle(crank), np.abs(crank))
    phi, out = u[some.task] + np.angle(some.fixed)[:, None], v[some.task] + begin[:, None]
    return _loops(phi, out, np.abs(some.fixed), second, some.error, slides)


def _through_five(task: Task, u: Array, v: Array, slides: bool) -> SolvedTask:
    points, angles = _relative_poses(u, v, slides)
    solved = solve_five_poses(points, angles)
    poses = PoseSet(points=points, turns=np.exp(1j * angles))
    made = _coupled(DyadSet.of_solutions(solved, poses), u, v, slides)
    return _solved_function(task, made, complete=3 if bool(solved.complete[0]) else -3)


def _through_four(task: Task, u: Array, v: Array, slides: bool) -> SolvedTask:
    points, angles = _relative_poses(u, v, slides)
    dyads = sampled_dyads(points[0], angles[0])
    return _solved_function(task, _coupled(dyads, u, v, slides), complete=0)


def _fitted(
    task: Task,
    wishes: Wishes,
    u: Array,
    v: Array,
    slides: bool,
    progress: Progress | None,
) -> SolvedTask:
    """Different fits of pairs, with given starts or by differences, from loops through three."""
    goal = task.function
    assert goal is not None, "a task of functions has one"
    first = None if goal.starts_fixed else _first_inputs(task, u)
    begun = _begins_at_fixed_angles(u, v) if goal.starts_fixed else _free_begins(u, v, slides)
    starts = [
        _lanes(loops, u[index[0]], v[index[0]], slides, goal.starts_fixed)
        for index, x_fit in begun
        for loops in _through_three(*x_fit, slides)[0]
    ]
    starts.append((np.zeros((0, 5)), np.zeros(0)))
    x, side = (np.concatenate(part) for part in zip(*starts, strict=True))
    if usual := has_usual_ratio(task):
        # a slider-crank's lengths may grow without end; its output has a size
        far = max(float(np.ptp(v)), float(np.abs(v).max()) if goal.starts_fixed else 0.0)
        longest = USUAL_RATIO * far if slides else math.inf
        wishes = replace(wishes, ratio=USUAL_RATIO, longest=longest)
    minimax = goal.fit == "minimax"
    pairs = FittedPairs(u=u, v=v, slides=slides, minimax=minimax, first=first, wishes=wishes)
    fits = fit_functions(pairs, (x, side), progress)
    made: list[Candidates] = []
    zeros: list[tuple[float, float]] = []
    for x_fit, wrong in zip(fits.x, fits.wrong, strict=True):
        miss = float(np.abs(wrong).max())
        # without bounds in the first turn
        begin = x_fit[3] if first is None or np.isfinite(first[0]) else x_fit[3] % FULL_TURN
        made += _fit_design(u + x_fit[3], v + x_fit[4] + wrong, x_fit[:3], slides, miss)
        zeros.append((float(u[0] + begin), float(v[0] + x_fit[4])))
    result = _solved_function(task, made, complete=0, zeros=tuple(zeros))
    text = f"1 {goal.fit} fit" if len(made) == 1 else f"{len(made)} different {goal.fit} fits"
    message = f"a sample: {text} from {len(x)} starts"
    if fits.interrupted:
        message = f"interrupted: the best so far of {len(x)} starts"
    if not made:
        message = "no result: no loop through three of the pairs follows all of them"
    if fits.minimal.any():
        message += f", {int(fits.minimal.sum())} of them proved to be local minima"
    if not fits.closes.all():
        message += "; the loop of the best one hardly closes: it may be no local minimum"
    if usual:
        of = "the shortest and the size of the output" if slides else "the shortest"
        message += f"; lengths up to {USUAL_RATIO:g} times {of} unless [wanted] bounds them"
    return replace(result, message=message, starts=len(x), interrupted=fits.interrupted)


def has_usual_ratio(task: Task) -> bool:
    """Whether the lengths of a fit are bounded though its task bounds none, but counts size."""
    goal, wanted = task.function, task.wanted
    bounded = wanted.shortest > 0.0 or min(wanted.longest, wanted.ratio) < math.inf
    return goal is not None and bool(goal.fit and task.rank.size) and not bounded


def _first_inputs(task: Task, u: Array) -> tuple[float, float]:
    """Bounds of the angle that is added to inputs (N,), of which the first is 0."""
    if task.wanted.range is None:
        return -np.inf, np.inf
    ends = sorted(map(task.in_radians, task.wanted.range))
    low, high = ends[0] - float(u.min()), ends[1] - float(u.max())
    return low, max(low, high)  # equal to rounding, if the pairs fill the range


#: Three places of pairs, and inputs and outputs there (B, 3).
_Begun = tuple[IndexArray, tuple[Array, Array]]


def _free_begins(u: Array, v: Array, slides: bool) -> Iterator[_Begun]:
    """A grid of starts, at a few places."""
    for share in _SHARES:
        index = _spread_index(len(u), (share, 0.5, 1.0 - share))
        yield index, _freely_begun(u[None, index], v[None, index], slides)


def _begins_at_fixed_angles(u: Array, v: Array) -> Iterator[_Begun]:
    """Many places."""
    for shares in product(_FIRSTS, _MIDDLES, _FIRSTS):
        index = _spread_index(len(u), (shares[0], shares[1], 1.0 - shares[2]))
        if len(set(index)) == len(index):
            yield index, (u[None, index], v[None, index])


def _spread_index(count: int, shares: Sequence[float]) -> IndexArray:
    return np.asarray((np.array(shares) * (count - 1)).round().astype(np.intp))


def _lanes(loops: Candidates, u: float, v: float, slides: bool, fixed: bool) -> tuple[Array, Array]:
    """Parameters (D, 5) and sides (D,) of loops at their first place, at input u and output v."""
    a = loops.moving_a[:, 0]
    coupler = loops.moving_b[:, 0] - a
    rocker = loops.moving_b[:, 0] - loops.fixed_b
    side = np.sign(coupler.real if slides else cross(coupler, rocker))
    crank, second = np.abs(a), loops.fixed_b.imag if slides else np.abs(rocker)
    begin = np.angle(a) - u, (rocker.real if slides else np.angle(rocker)) - v
    if fixed:
        crank, begin = (a * np.exp(-1j * u)).real, (np.zeros(len(a)), np.zeros(len(a)))
        second = second if slides else (rocker * np.exp(-1j * v)).real
    return np.stack([crank, second, np.abs(coupler), *begin], axis=1), side


def _fit_design(u: Array, v: Array, lengths: Array, slides: bool, miss: float) -> list[Candidates]:
    a, second, _ = (np.array([x]) for x in lengths)
    # the loop closes to rounding at every point, whatever its structural error
    error = np.array([_LOSS * (1.0 + np.abs(lengths).max()) * (1.0 + np.abs(u).max())])
    made = _loops(u[None], v[None], a, second, error, slides)
    for design in made:
        design.miss[:] = miss
    return made


def _solved_function(
    task: Task, made: list[Candidates], complete: int, zeros: tuple[tuple[float, float], ...] = ()
) -> SolvedTask:
    """The loops with their counts.

    ``complete``: the number of solutions of a complete list, negative if this is not proved, 0
    for a sample.
    """
    real = sum(map(len, made))
    proved = sum(int(np.isfinite(part.error).sum()) for part in made)
    grade, message = Completeness.SAMPLED, "a sample: these conditions leave a family of mechanisms"
    if complete > 0:
        grade = Completeness.PROVED
        message = "all solutions: the equations have no others"
    elif complete < 0:
        grade = Completeness.NOT_PROVED
        message = "not proved: to rounding, the equations are singular: families of mechanisms, "
        message += "such as parallelograms, are not listed"
    return SolvedTask(
        candidates=tuple(made),
        complex=abs(complete) or real,
        real=real,
        proved=proved,
        completeness=grade,
        message=message,
        drives=(Drive.A0,),
        zeros=zeros,
        output="slide" if task.mechanisms[0] == "slider-crank" else "rocker",
    )
