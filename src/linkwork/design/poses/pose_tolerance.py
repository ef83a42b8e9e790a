"""Poses with tolerances: exact tasks near the wanted one, and how far their designs miss it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from linkwork.design.loops.candidates import Candidates, LoopKind
from linkwork.design.loops.guide_loops import meeting
from linkwork.design.loops.loop_limits import cross
from linkwork.design.poses.dyads import FIVE
from linkwork.design.tasks.task import Task
from linkwork.foundation.arrays import Array, ComplexArray, IndexArray

__all__ = ["NearTasks", "drawn_within", "is_tolerant", "near_tasks", "with_misses"]

_SAMPLES = 400
_SEED = 1
# angles within their tolerances where points are missed least: of so many, then by Gauss-Newton
_PARTS, _STEPS = 5, 6
_SLIGHT = 1e-6  # rad: for slopes


@dataclass(frozen=True, kw_only=True, eq=False)
class NearTasks:
    """Five exact poses each of T tasks, (T, 5), and whether they are the wanted poses."""

    points: ComplexArray
    angles: Array
    is_exact: bool


def near_tasks(task: Task, points: ComplexArray, angles: Array) -> NearTasks:
    """The wanted poses, and with tolerances a sample of others within them.

    Of more than five poses each task takes five: the first, all exact ones, and a random choice.
    """
    count = len(points)
    if count == FIVE and not is_tolerant(task):
        return NearTasks(points=points[None], angles=angles[None], is_exact=True)
    rng = np.random.default_rng(_SEED)
    exact = np.array([p.tolerance == 0 and p.angle_tolerance == 0 for p in task.positions])
    rows, found = np.arange(_SAMPLES)[:, None], []
    # five of more also at their own angles: few of those turned meet the others
    turned = any(p.angle_tolerance for p in task.positions)
    for part in ((0.0, 1.0) if turned else (0.0,)) if count > FIVE else (1.0,):
        shift, turn = drawn_within(task, _SAMPLES, rng)
        if count > FIVE:
            # the others are compared from the angle of the first
            turn[:, 0] = 0.0
        index = _choices(rng, exact, count)
        found.append(((points + shift)[rows, index], (angles + part * turn)[rows, index]))
    return NearTasks(
        points=np.concatenate([own for own, _ in found]),
        angles=np.concatenate([own for _, own in found]),
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
    task: Task, points: ComplexArray, angles: Array, given: Candidates
) -> Candidates | None:
    """Designs at all wanted poses, and how far their points miss them; none beyond tolerance.

    Designs of five poses of more are placed at the angles of all poses, within their tolerances
    where points are missed least: for the better of both positions that have this angle.
    """
    if len(points) > FIVE:
        given = _at_all(task, given, points, angles)
    if not len(given):
        return None
    missed = np.abs(given.guided - points)
    reach = np.array([position.tolerance for position in task.positions])
    # a pose that is met exactly is met to rounding
    within = (missed <= reach + given.error[:, None]).all(axis=1)
    kept = replace(given, miss=missed.max(axis=1)).take(np.flatnonzero(within))
    return kept if len(kept) else None


def _at_all(task: Task, given: Candidates, points: ComplexArray, angles: Array) -> Candidates:
    """Designs whose first position is the first pose, at the angles of all poses."""
    swing = np.array([position.angle_tolerance for position in task.positions])
    swing = swing * task.angle.radians * (np.arange(len(points)) > 0)
    wanted = angles - angles[0]

    def misses(turn: Array) -> tuple[Array, ComplexArray, tuple[ComplexArray, ...]]:
        a, coupler, arm = _placed(given, points, np.exp(1j * (wanted + turn)))
        away = a + arm - points
        return np.nan_to_num(np.abs(away), nan=np.inf), away, (a, a + coupler, a + arm)

    turn = np.zeros((len(given), len(points)))
    if swing.any():
        tried = [swing * part + turn for part in np.linspace(-1.0, 1.0, _PARTS)]
        turn = np.choose(np.argmin([misses(own)[0] for own in tried], axis=0), tried)
        least, away, _ = misses(turn)
        for _ in range(_STEPS):
            slope = (misses(turn + _SLIGHT)[1] - misses(turn - _SLIGHT)[1]) / (2.0 * _SLIGHT)
            with np.errstate(all="ignore"):
                step = (away * slope.conj()).real / np.abs(slope) ** 2
            new = np.clip(turn - np.nan_to_num(step), -swing, swing)
            own, there, _ = misses(new)
            better = own < least
            turn, least = np.where(better, new, turn), np.where(better, own, least)
            away = np.where(better, there, away)
    return _moved_to(given, *misses(turn)[2])


def _placed(
    given: Candidates, points: ComplexArray, turns: ComplexArray
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """A, B from A and P from A of designs whose bodies are turned (D, N) from the first pose."""
    coupler = (given.moving_b[:, :1] - given.moving_a[:, :1]) * turns
    arm = (given.guided[:, :1] - given.moving_a[:, :1]) * turns
    crank = np.abs(given.moving_a[:, :1] - given.fixed_a[:, None])
    if not given.kind.has_crank:
        # A and B are on lines: fixed ones, or lines of the body through fixed pivots
        line_a = given.direction_a[:, None] * np.ones_like(turns)
        line_b = given.direction[:, None] * np.ones_like(turns)
        if given.kind is LoopKind.OLDHAM:
            line_a = given.lines_a[:, :1] * turns
        if given.kind.body_line:
            line_b = given.lines[:, :1] * turns
        with np.errstate(all="ignore"):
            a = meeting(given.fixed_a[:, None], line_a, given.fixed_b[:, None] - coupler, line_b)
        return a, coupler, arm
    # A is on its circle, and B on its circle or line moved back by the coupler
    centre = given.fixed_b[:, None] - coupler
    with np.errstate(invalid="ignore"):
        if given.kind is LoopKind.FOUR_BAR:
            rocker = np.abs(given.moving_b[:, :1] - given.fixed_b[:, None])
            base = centre - given.fixed_a[:, None]
            square = np.abs(base) ** 2
            along = 0.5 * (square + crank**2 - rocker**2)
            across = np.sqrt(square * crank**2 - along**2)
            ways = [base * (along + 1j * s * across) / square for s in (1.0, -1.0)]
        else:
            u = given.direction[:, None]
            if given.kind is LoopKind.INVERTED:
                # A keeps its distance from the line through the block
                u = given.lines[:, :1] * turns
                h = cross(u[:, :1], given.fixed_b[:, None] - given.moving_a[:, :1])
                centre = given.fixed_b[:, None] - 1j * h * u
            away = (centre - given.fixed_a[:, None]) * np.conj(u)
            reach = np.sqrt(crank**2 - away.imag**2)
            ways = [(s * reach + 1j * away.imag) * u for s in (1.0, -1.0)]
    pivots = [given.fixed_a[:, None] + way for way in ways]
    misses = [np.nan_to_num(np.abs(a + arm - points), nan=np.inf) for a in pivots]
    return np.where(misses[0] <= misses[1], *pivots), coupler, arm


def _moved_to(
    given: Candidates, a: ComplexArray, b: ComplexArray, guided: ComplexArray
) -> Candidates:
    closes = np.isfinite(a).all(axis=1)
    return replace(given, moving_a=a, moving_b=b, guided=guided).take(np.flatnonzero(closes))
