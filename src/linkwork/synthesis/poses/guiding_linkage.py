"""Dyads through three and two poses, with given pivots or with pivots spread over a region."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from linkwork.core.foundation.arrays import (
    UNIT_ROUNDOFF,
    Array,
    ComplexArray,
    CountArray,
    IndexArray,
)
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.units import FULL_TURN, AngleUnit
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.guides import Slider
from linkwork.core.results.listing import significant
from linkwork.synthesis.loops.limits import (
    Candidates,
    Drive,
    LoopKind,
    circumcentres,
    cross,
    dot,
    meeting,
    solve_with_bound,
)
from linkwork.synthesis.poses.burmester import DyadSet
from linkwork.synthesis.poses.dyads import FIVE
from linkwork.synthesis.precision.solving import points_in_polygon
from linkwork.synthesis.tasks.conditions import Wishes
from linkwork.synthesis.tasks.task import Task

_SHARES = np.array([-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0])  # along the bisector of two poses
_AROUND = 1.5  # sizes of the task, for pivots without a region
_LOSS = 16.0 * UNIT_ROUNDOFF


def spread_pivots(points: ComplexArray, wishes: Wishes, count: int) -> ComplexArray:
    """Pivots spread evenly over the region of the task, or around its points."""
    corners = wishes.region
    if not corners.size:
        middle, size = points.mean(), np.abs(points - points.mean()).max()
        size = max(float(size), UNIT_ROUNDOFF) * _AROUND
        corners = middle + size * np.array([-1 - 1j, 1 - 1j, 1 + 1j, -1 + 1j])
    low = complex(corners.real.min(), corners.imag.min())
    extent = complex(np.ptp(corners.real), np.ptp(corners.imag))
    parts: list[ComplexArray] = []
    number, inside = 0, 0
    # Halton's sequence fills any box evenly; a polygon takes its share of it
    while inside < count and number < 64 * count:
        k = np.arange(number + 1, number + count + 1)
        z = np.zeros(count, dtype=complex) + low
        z.real += _halton(k, 2) * extent.real
        z.imag += _halton(k, 3) * extent.imag
        z = z[wishes.within_region(z, np.zeros(count))]
        parts.append(z)
        number, inside = number + count, inside + len(z)
    if inside >= count:
        return np.concatenate(parts)[:count]
    # of a narrow polygon the box has too few points: all of them are mapped into it
    k = np.arange(1, count + 1)
    return points_in_polygon(corners, np.stack([_halton(k, 2), _halton(k, 3)], axis=1))


def _halton(k: CountArray, base: int) -> Array:
    """Numbers of Halton's sequence in (0, 1)."""
    rest, share, total = np.asarray(k, dtype=float), 1.0, np.zeros(len(k))
    while (rest > 0).any():
        share /= base
        total += share * np.mod(rest, base)
        rest = np.floor(rest / base)
    return total


def through_fixed(pivots: ComplexArray, points: ComplexArray, turns: ComplexArray) -> DyadSet:
    """The RR dyads with fixed pivots (K,): one each for three poses, several for two."""
    images = (pivots[:, None] - points) * turns.conj()
    fixed, moving, error = _other_pivots(pivots, images, points)
    return DyadSet.made(0, moving, fixed, error)


def through_moving(moving: ComplexArray, points: ComplexArray, turns: ComplexArray) -> DyadSet:
    """The RR dyads with moving pivots (K,) in the body's frame."""
    images = points + moving[:, None] * turns
    moving, fixed, error = _other_pivots(moving, images, points)
    return DyadSet.made(0, moving, fixed, error)


def _other_pivots(
    pivots: ComplexArray, images: ComplexArray, points: ComplexArray
) -> tuple[ComplexArray, ComplexArray, Array]:
    """Pivots, the other pivots of their dyads, and bounds of the errors of these.

    ``images`` (K, N): the pivots in all poses, as the other body sees them. Of two poses the other
    pivot is anywhere on the bisector.
    """
    far = np.abs(pivots) + np.abs(points).max()
    if len(points) > 2:
        return pivots, *circumcentres(images, far)
    middle, across = images.mean(axis=1), 1j * (images[:, 1] - images[:, 0])
    others = (middle[:, None] + across[:, None] * _SHARES).ravel()
    pivots, far = (np.repeat(x, len(_SHARES)) for x in (pivots, far))
    return pivots, others, _LOSS * far + _LOSS * np.abs(others)


def timed_dyads(
    pivots: ComplexArray, points: ComplexArray, turns: ComplexArray, inputs: Array
) -> DyadSet:
    """The cranks that turn by given angles from pose to pose.

    d + m e^{iθ} = p + w e^{iβ}: three poses determine m, p and the crank w; two poses m and w for
    each of the fixed pivots (K,). ``inputs``: β (N,) [rad].
    """
    cranks = np.exp(1j * (inputs - inputs[0]))
    if len(points) == 2:
        # m e^{iθ} - w e^{iβ} = p - d for each of the pivots
        columns = np.array([turns, -cranks]).T
        right = pivots[:, None] - points
    else:
        columns = np.array([turns, -cranks, -np.ones(3)]).T
        right = -points[None]
    many = len(right)
    # as real equations: complex numbers as matrices
    real = np.block([[columns.real, -columns.imag], [columns.imag, columns.real]])
    vector = np.concatenate([right.real, right.imag], axis=1)
    doubt, rounding = np.full(many, _LOSS), _LOSS * np.abs(vector).max(axis=1)
    x, error = solve_with_bound(np.tile(real, (many, 1, 1)), vector, doubt, rounding)
    n = columns.shape[1]
    solution = x[:, :n] + 1j * x[:, n:]
    fixed = pivots if n == 2 else solution[:, 2]
    return DyadSet.made(0, solution[:, 0], fixed, 1.5 * error.max(axis=1))


def on_lines(normals: ComplexArray, points: ComplexArray, turns: ComplexArray) -> DyadSet:
    """The PR dyads through three poses whose lines have given unit normals (K,)."""
    # Re(n̄ (d + m e^{iθ})) = k, linear in m and k
    lever = normals.conj()[:, None] * turns
    matrix = np.stack([lever.real, -lever.imag, -np.ones(lever.shape)], axis=-1)
    right = -(normals.conj()[:, None] * points).real
    doubt = np.full(len(right), _LOSS)
    x, error = solve_with_bound(matrix, right, doubt, doubt * np.abs(points).max())
    moving, fixed = x[:, 0] + 1j * x[:, 1], x[:, 2] * normals
    return DyadSet.made(1, moving, fixed, 1.5 * error[:, 0], normals)


def through_line(moving: ComplexArray, points: ComplexArray, turns: ComplexArray) -> DyadSet:
    """The PR dyads through two poses with moving pivots (K,) in the body's frame."""
    images = points + moving[:, None] * turns
    along = images[:, 1] - images[:, 0]
    with np.errstate(all="ignore"):
        normals = 1j * along / np.abs(along)
    error = _LOSS * (np.abs(moving) + np.abs(points).max())
    return DyadSet.made(1, moving, images[:, 0], np.where(along != 0, error, np.inf), normals)


def inverted(points: ComplexArray, turns: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """The ground's poses as the body sees them: there an RP dyad is a PR dyad."""
    return np.asarray(-points * turns.conj()), turns.conj()


# ----------------------------------------------------------------------
# Poses with tolerances: exact tasks near the given one, and how far their designs miss it.


_SAMPLES = 400
_SEED = 1
# angles within their tolerances where points are missed least: of so many, then by Gauss-Newton
_PARTS, _FAMILY_STEPS = 5, 6
_SLIGHT = 1e-6  # rad: for slopes


@dataclass(frozen=True, kw_only=True, eq=False)
class NearTasks:
    """Five exact poses each of T tasks, (T, 5), and whether they are the poses of the task."""

    points: ComplexArray
    angles: Array
    is_exact: bool


def near_tasks(task: Task, points: ComplexArray, angles: Array) -> NearTasks:
    """The poses of the task, and with tolerances a sample of poses within these.

    Of more than five poses each task takes five: the first, all exact ones, and a random choice.
    """
    count = len(points)
    if count == FIVE and not is_tolerant(task):
        return NearTasks(points=points[None], angles=angles[None], is_exact=True)
    rng = np.random.default_rng(_SEED)
    exact = np.array([p.tolerance == 0 and p.angle_tolerance == 0 for p in task.positions])
    rows, tasks = np.arange(_SAMPLES)[:, None], []
    # five of more poses also at their given angles: few turned ones meet the other poses
    turned = any(p.angle_tolerance for p in task.positions)
    for part in ((0.0, 1.0) if turned else (0.0,)) if count > FIVE else (1.0,):
        shift, turn = drawn_within(task, _SAMPLES, rng)
        if count > FIVE:
            # angles of the other poses are compared relative to the first
            turn[:, 0] = 0.0
        index = _choices(rng, exact, count)
        tasks.append(((points + shift)[rows, index], (angles + part * turn)[rows, index]))
    return NearTasks(
        points=np.concatenate([one for one, _ in tasks]),
        angles=np.concatenate([one for _, one in tasks]),
        is_exact=False,
    )


def is_tolerant(task: Task) -> bool:
    """Whether a position may be missed."""
    return any(position.tolerance or position.angle_tolerance for position in task.positions)


def drawn_within(
    task: Task, count: int, rng: np.random.Generator | None = None
) -> tuple[ComplexArray, Array]:
    """Shifts [length] and turns [rad] of positions within their tolerances, (T, N).

    Shifts are spread evenly in discs; the first task has none.
    """
    rng = rng or np.random.default_rng(_SEED)
    reach = np.array([position.tolerance for position in task.positions])
    swing = np.array([position.angle_tolerance for position in task.positions])
    shape = (count, len(reach))
    radius, direction = np.sqrt(rng.random(shape)), rng.uniform(0.0, 2.0 * np.pi, shape)
    shift, turn = radius * np.exp(1j * direction), rng.uniform(-1.0, 1.0, shape)
    shift[0], turn[0] = 0.0, 0.0
    return reach * shift, swing * task.angle.radians * turn


def _choices(rng: np.random.Generator, exact: Array, count: int) -> IndexArray:
    """Five poses for every task, in their order, (T, 5)."""
    order = rng.random((_SAMPLES, count))
    order[:, exact] -= 1.0
    order[:, 0] = -2.0
    return np.sort(np.argsort(order, axis=1)[:, :FIVE], axis=1)


def with_misses(
    task: Task, points: ComplexArray, angles: Array, candidates: Candidates
) -> Candidates | None:
    """Designs at all poses of the task, and how far their points miss them; none beyond tolerance.

    Designs of five poses of more are placed at the angles of all poses, within their tolerances
    where points are missed least: for the better of both positions that have this angle.
    """
    if len(points) > FIVE:
        candidates = _at_all(task, candidates, points, angles)
    if not len(candidates):
        return None
    missed = np.abs(candidates.guided - points)
    reach = np.array([position.tolerance for position in task.positions])
    # a pose that is met exactly is met to rounding
    within = (missed <= reach + candidates.error[:, None]).all(axis=1)
    kept = replace(candidates, miss=missed.max(axis=1)).take(np.flatnonzero(within))
    return kept if len(kept) else None


def _at_all(task: Task, candidates: Candidates, points: ComplexArray, angles: Array) -> Candidates:
    """Designs whose first position is the first pose, at the angles of all poses."""
    swing = np.array([position.angle_tolerance for position in task.positions])
    swing = swing * task.angle.radians * (np.arange(len(points)) > 0)
    turned = angles - angles[0]

    def misses(turn: Array) -> tuple[Array, ComplexArray, tuple[ComplexArray, ...]]:
        a, coupler, arm = _placed(candidates, points, np.exp(1j * (turned + turn)))
        away = a + arm - points
        return np.nan_to_num(np.abs(away), nan=np.inf), away, (a, a + coupler, a + arm)

    turn = np.zeros((len(candidates), len(points)))
    if swing.any():
        tried = [swing * part + turn for part in np.linspace(-1.0, 1.0, _PARTS)]
        turn = np.choose(np.argmin([misses(missed)[0] for missed in tried], axis=0), tried)
        least, away, _ = misses(turn)
        for _ in range(_FAMILY_STEPS):
            slope = (misses(turn + _SLIGHT)[1] - misses(turn - _SLIGHT)[1]) / (2.0 * _SLIGHT)
            with np.errstate(all="ignore"):
                step = (away * slope.conj()).real / np.abs(slope) ** 2
            new = np.clip(turn - np.nan_to_num(step), -swing, swing)
            missed, there, _ = misses(new)
            better = missed < least
            turn, least = np.where(better, new, turn), np.where(better, missed, least)
            away = np.where(better, there, away)
    return _moved_to(candidates, *misses(turn)[2])


def _placed(
    group: Candidates, points: ComplexArray, turns: ComplexArray
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """A, B from A and P from A of designs whose bodies are turned (D, N) from the first pose."""
    coupler = (group.moving_b[:, :1] - group.moving_a[:, :1]) * turns
    arm = (group.guided[:, :1] - group.moving_a[:, :1]) * turns
    crank = np.abs(group.moving_a[:, :1] - group.fixed_a[:, None])
    if not group.kind.has_crank:
        # A and B are on lines: fixed ones, or lines of the body through fixed pivots
        line_a = group.direction_a[:, None] * np.ones_like(turns)
        line_b = group.direction[:, None] * np.ones_like(turns)
        if group.kind is LoopKind.OLDHAM:
            line_a = group.lines_a[:, :1] * turns
        if group.kind.body_line:
            line_b = group.lines[:, :1] * turns
        with np.errstate(all="ignore"):
            a = meeting(group.fixed_a[:, None], line_a, group.fixed_b[:, None] - coupler, line_b)
        return a, coupler, arm
    # A is on its circle, and B on its circle or line moved back by the coupler
    centre = group.fixed_b[:, None] - coupler
    with np.errstate(invalid="ignore"):
        if group.kind is LoopKind.FOUR_BAR:
            rocker = np.abs(group.moving_b[:, :1] - group.fixed_b[:, None])
            base = centre - group.fixed_a[:, None]
            square = np.abs(base) ** 2
            along = 0.5 * (square + crank**2 - rocker**2)
            across = np.sqrt(square * crank**2 - along**2)
            ways = [base * (along + 1j * s * across) / square for s in (1.0, -1.0)]
        else:
            u = group.direction[:, None]
            if group.kind is LoopKind.INVERTED:
                # A keeps its distance from the line through the block
                u = group.lines[:, :1] * turns
                h = cross(u[:, :1], group.fixed_b[:, None] - group.moving_a[:, :1])
                centre = group.fixed_b[:, None] - 1j * h * u
            away = (centre - group.fixed_a[:, None]) * np.conj(u)
            reach = np.sqrt(crank**2 - away.imag**2)
            ways = [(s * reach + 1j * away.imag) * u for s in (1.0, -1.0)]
    pivots = [group.fixed_a[:, None] + way for way in ways]
    misses = [np.nan_to_num(np.abs(a + arm - points), nan=np.inf) for a in pivots]
    return np.where(misses[0] <= misses[1], *pivots), coupler, arm


def _moved_to(
    candidates: Candidates, a: ComplexArray, b: ComplexArray, guided: ComplexArray
) -> Candidates:
    closes = np.isfinite(a).all(axis=1)
    return replace(candidates, moving_a=a, moving_b=b, guided=guided).take(np.flatnonzero(closes))


# ----------------------------------------------------------------------
# A design as the description of an ordinary mechanism, in file units.


_STEP = math.pi / 180.0  # of an angle [rad]
_STEPS = 100  # of a displacement
_ON_LINE = 1e-9  # of a coupler's length: a pivot on its line
_SAME_TURN = 1e-12  # relative: the rounding of a few angles
_GUIDE = "slide"
#: Of each side: moving and fixed pivot, points of a line on ground, names of slider and block.
_SIDES = (("A", "A0", "UV", "slide_a", "block_a"), ("B", "B0", "ST", _GUIDE, "block"))
_GROUND_POINTS = ("A0", "B0", "U", "V", "S", "T")
_MOST_LISTED = 9  # positions whose inputs are listed
_DIGITS = 6


@dataclass(frozen=True, kw_only=True)
class Design:
    """One design at its first position, with its driven range.

    Parameters
    ----------
    kind : LoopKind
    drive : Drive
    points : Mapping[str, complex]
        A0, B0, A, B, P of a four-bar; A0, S, T, A, B, P of a slider-crank, with S, T on the line of
        the slider, S where its displacement is zero; A0, B0, A, B, P of an inverted one, with B on
        the coupler's line, and C, the foot of A, if A is not on it. U, V on the line of a slider at
        A; K, where the lines of an Oldham coupling cross [length].
    inputs : tuple of float
        The input at the positions, unwrapped [rad or length].
    start, stop : float
        The driven range [rad or length].
    backward : tuple of Drive
        Links whose angle is measured from the moving pivot to the fixed one.
    output : float, optional
        What a function has for the output at the first position, if that is not the output of the
        design [rad or length].
    """

    kind: LoopKind
    drive: Drive
    points: dict[str, complex]
    inputs: tuple[float, ...]
    start: float
    stop: float
    backward: tuple[Drive, ...] = ()
    output: float | None = None

    @classmethod
    def of(
        cls,
        candidates: Candidates,
        k: int,
        drive: Drive,
        inputs: Array,
        ends: Array,
        zero: tuple[float, float] | None = None,
    ) -> Design:
        """The k-th of some designs.

        ``inputs`` (N,), ``ends`` (2,): at the positions, and of the driven range; ``zero``: the
        angles of crank and rocker at the first position as a task measures them, opposite to the
        links where a length is negative, or the displacement of a slider [rad or length].
        """
        points = {
            "A0": candidates.fixed_a[k],
            "B0": candidates.fixed_b[k],
            "A": candidates.moving_a[k, 0],
            "B": candidates.moving_b[k, 0],
            "P": candidates.guided[k, 0],
        }
        backward = []
        if zero is not None:
            sides = (Drive.A0, "A", "A0", zero[0]), (Drive.B0, "B", "B0", zero[1])
            pinned = sides if candidates.kind is LoopKind.FOUR_BAR else sides[:1]
            for side, moving, fixed, angle in pinned:
                if ((points[moving] - points[fixed]) * np.exp(-1j * angle)).real < 0:
                    backward.append(side)
        guides = (
            ("B0", "S", "T", candidates.direction[k], candidates.moving_b[k]),
            ("A0", "U", "V", candidates.direction_a[k], candidates.moving_a[k]),
        )
        for name, start, end, direction, moving in guides:
            if name not in candidates.kind.pivots:
                line = points.pop(name)
                along = dot(direction, moving - line)
                reach = max(np.abs(along).max(), abs(points["B"] - points["A"]))
                points |= {start: line, end: line + reach * direction}
        if candidates.kind is LoopKind.OLDHAM:
            axes = (points["A0"], candidates.lines_a[k, 0], points["B0"], candidates.lines[k, 0])
            points["K"] = meeting(*map(np.asarray, axes))
        elif candidates.kind.body_line:
            # the foot of A on the line of the coupler, if A is not on it
            line = candidates.lines[k, 0]
            away = cross(line, points["B"] - points["A"])
            if abs(away) > _ON_LINE * abs(points["B"] - points["A"]):
                points["C"] = points["A"] + 1j * away * line
        if drive.turns:
            # measured as the file measures it, in the first turn to begin with or as the task does
            shift = np.pi if drive in backward else 0.0
            turns = np.floor((ends[0] + shift) / FULL_TURN + _SAME_TURN)
            if zero is not None and drive is Drive.A0:
                turns = np.round((inputs[0] + shift - zero[0]) / FULL_TURN)
            shift -= FULL_TURN * turns
            inputs, ends = inputs + shift, ends + shift
        return cls(
            kind=candidates.kind,
            drive=drive,
            points={name: complex(point) for name, point in points.items()},
            inputs=tuple(inputs.tolist()),
            start=float(ends[0]),
            stop=float(ends[1]),
            backward=tuple(backward),
            output=zero and zero[1],
        )


def linkage_of(design: Design, task: Task, name: str, output: str = "") -> Linkage:
    """The description of a design for a task; of crank and rocker the driven one is the crank.

    ``output``: the name of the output of a function, whose structural error is an output of the
    mechanism.
    """
    z, kind, ground = design.points, design.kind, _ground_names(design)
    guided = next((key for key in ("A", "B") if z[key] == z["P"]), "P")
    corners = ("A", "B") if guided != "P" else ("A", "B", "P")
    feet = tuple(key for key in ("C", "K") if key in z)
    turning = 2 if kind is LoopKind.FOUR_BAR else int(kind.has_crank)
    arms: list[tuple[str, ...]] = [_bar(design, side) for side in (Drive.A0, Drive.B0)[:turning]]
    if design.drive is Drive.B0:
        arms.reverse()
    crank, rocker = [*arms, (), ()][:2]  # none of guided sides
    sliders = []
    way: tuple[str, str]
    for moving, fixed, line, slider, block in _SIDES[turning:]:
        if fixed in kind.pivots:
            way, carried, on = (feet[0] if feet else "A", moving), fixed, "coupler"
        else:
            way, carried, on = (ground[line[0]], ground[line[1]]), moving, GROUND
        sliders.append(Slider(name=slider, link=block, points=(carried,), on=on, line=way))
    grounded = [ground[key] for key in (*kind.pivots, *"UVST") if key in z]
    links = {
        GROUND: tuple(dict.fromkeys(grounded)),
        "crank": crank,
        "coupler": (*corners, *feet),
        "rocker": rocker,
        **{slider.link: slider.points for slider in sliders},
    }
    sides = [*combinations(corners, 2), *((end, key) for key in feet for end in "AB")]
    bars = [bar for bar in (crank, *sides, rocker) if bar]
    formula = _error_formula(design, task, output)
    return Linkage(
        name=name,
        purpose=_purpose(design, task),
        length=task.length,
        angle=task.angle,
        points={
            key: (place.real, place.imag)
            for key, place in z.items()
            # without P where that is a pivot
            if ground.get(key, key) == key and (key != "P" or guided == "P")
        },
        links={link: points for link, points in links.items() if points},
        lengths={f"{one} {other}": abs(z[other] - z[one]) for one, other in bars},
        sliders=tuple(sliders),
        inputs=(_input(design, task.angle),),
        trace=(guided,),
        outputs={"structural_error": formula} if formula else {},
    )


def _ground_names(design: Design) -> dict[str, str]:
    """The name of every ground point: of points at one place, such as a pivot on the line of a
    slider, that of the first.
    """
    z, first = design.points, dict[complex, str]()
    return {key: first.setdefault(z[key], key) for key in _GROUND_POINTS if key in z}


def _error_formula(design: Design, task: Task, output: str) -> str:
    """The structural error of a function, whose start angles the solver may have chosen."""
    goal, unit = task.function, task.angle.from_radians
    if not output or goal is None or design.drive is not Drive.A0:
        return ""
    if goal.free:
        begin = _first_output(design) if design.output is None else design.output
        begin = begin if design.kind is LoopKind.SLIDER_CRANK else unit(begin)
        goal = goal.begun_at(unit(design.inputs[0]), begin)
    return goal.formula("crank", output, task.angle)


def _first_output(design: Design) -> float:
    """The angle of the rocker, or the displacement of the slider [rad or length]."""
    z = design.points
    if design.kind is LoopKind.FOUR_BAR:
        return float(np.angle(z["B"] - z["B0"]))
    line = z["T"] - z["S"]
    return float(dot(np.asarray(line / abs(line)), np.asarray(z["B"] - z["S"])))


def _purpose(design: Design, task: Task) -> str:
    """What it is for; with the inputs at its positions, if they are few."""
    if task.function is not None or len(design.inputs) > _MOST_LISTED:
        return task.purpose
    turns = design.drive.turns
    driven = _input(design, task.angle)
    values = [task.angle.from_radians(v) if turns else v for v in design.inputs]
    listed = ", ".join(significant(value, _DIGITS) for value in values)
    unit = task.angle.value if turns else task.length
    return task.purpose.replace(";", f" at {driven.link or driven.slider} = {listed} {unit};", 1)


def _bar(design: Design, side: Drive) -> tuple[str, str]:
    """The ends of a link, in the direction in which its angle is measured."""
    fixed, moving = ("A0", "A") if side is Drive.A0 else ("B0", "B")
    return (moving, fixed) if side in design.backward else (fixed, moving)


def _input(design: Design, angle: AngleUnit) -> Input:
    span = design.stop - design.start
    if not design.drive.turns:
        step = span / _STEPS
        slider = "slide_a" if design.drive is Drive.SLIDER_A else _GUIDE
        return Input(slider=slider, from_=design.start, to=design.stop, step=step)
    start, stop = angle.from_radians(design.start), angle.from_radians(design.stop)
    count = max(1, math.ceil(abs(span) / _STEP - _SAME_TURN))
    if math.isclose(abs(span), FULL_TURN, rel_tol=_SAME_TURN):
        stop = start + math.copysign(angle.turn, span)
    # so many equal steps that the last row is the last position
    driven = "crank"
    if design.kind.body_line and design.drive is Drive.B0:
        driven = "block"
    elif not design.kind.has_crank:
        driven = "block_a"
    return Input(link=driven, from_=start, to=stop, step=(stop - start) / count)
