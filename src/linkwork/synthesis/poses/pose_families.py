"""Dyads through three and two poses, with given pivots or with pivots spread over a region."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.foundation.arrays import Array, ComplexArray, CountArray, IndexArray
from linkwork.core.foundation.rounding import UNIT_ROUNDOFF
from linkwork.synthesis.loops.candidates import (
    Candidates,
    LoopKind,
    circumcentres,
    solve_with_bound,
)
from linkwork.synthesis.loops.limits import cross, meeting
from linkwork.synthesis.poses.dyad_set import DyadSet
from linkwork.synthesis.poses.dyads import FIVE
from linkwork.synthesis.precision.sampling import points_in_polygon
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
_PARTS, _STEPS = 5, 6
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
        for _ in range(_STEPS):
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
