"""The whole cycle: a table of positions along one branch."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, CountArray, StatusArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.motion.limits import limits_of
from linkwork.motion.lock_step import lock_step
from linkwork.motion.model import Model
from linkwork.motion.proving import RowProofs, prove_rows, unproved, way_is_proved
from linkwork.motion.reading import Named, named_series
from linkwork.motion.start import Start, first_position
from linkwork.motion.tracking import leading_scale, track_to, turns_freely
from linkwork.numerics.newton import NewtonOptions
from linkwork.numerics.track import (
    BOLD,
    InputPath,
    Node,
    Rows,
    Track,
    TrackOptions,
    follow,
    joined_rows,
    node_at,
    rows_on_track,
)
from linkwork.results.motion import Limit, Motion

__all__ = ["sweep"]

_ENTRIES = (
    24  # rows, from the nearest on, at which a table of several inputs is tried to be entered
)
_CHUNK = 4096  # rows solved together: large enough to amortise NumPy calls, small enough for cache


@dataclass(frozen=True, kw_only=True)
class _Solved:
    """Rows of the table in internal units; ``v`` of rows that were not found is NaN."""

    v: Array
    first: Array
    second: Array
    status: StatusArray
    iterations: CountArray
    residual: Array
    condition: Array
    proofs: RowProofs


def sweep(
    model: Model,
    *,
    certify: bool = True,
    options: NewtonOptions | None = None,
    progress: Callable[[float], None] | None = None,
) -> Motion:
    """The positions at every row of the input's table, all on the branch of the guess.

    The branch is followed from the guess's own input value both ways with steps as small as
    safety asks, whatever the table's step. A row outside its reach is tried a whole turn away,
    and kept with its status if it is not there either.

    Parameters
    ----------
    certify : bool
        Prove every position, and that the motion to it stays on the start's branch.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.
    """
    options = options or NewtonOptions()
    start = first_position(model, model.start_inputs, options)
    rows = model.rows
    if not start.status.ok:
        return _without_start(model, rows, start)
    lead, rate = lock_step(rows)
    path = InputPath(origin=rows[0] - rate * rows[0, lead], rate=rate)
    scale = leading_scale(model, lead)
    t = rows[:, lead]
    entry = _onto_path(model, path, start, t, lead, certify)
    if entry is None:
        message = "no row of the table could be reached from the guess's own input values"
        return _without_start(model, rows, replace(start, message=message))
    anchor, entered = entry
    report = _Report(progress, anchor.t, float(t.min()), float(t.max()))
    provable = all(block.system.bends_boundedly for block in model.compiled.solver.blocks)
    tries = (BOLD, None) if certify and provable else (None,)
    for care in tries:
        track = _covering(model, path, anchor, t, scale, report, care)
        placed = _placed(track, t, turns_freely(model))
        solved = _solve_rows(model, path, track, placed, scale, report, certify)
        if care is None or not _doubtful(solved, placed):
            break
    if not entered:
        proved = solved.proofs.code == Certification.CERTIFIED.code
        solved.proofs.code[proved] = Certification.MOTION_NOT_PROVED.code
    limits = limits_of(model, path, track, lead)
    _mark_missing(solved, track, t, np.isnan(placed), limits)
    return _motion(model, solved, limits, start)


def _doubtful(solved: _Solved, placed: Array) -> bool:
    """Whether a bold track left rows that are on it unproved."""
    there = ~np.isnan(placed)
    unproved_rows = solved.proofs.code[there] != Certification.CERTIFIED.code
    return bool(unproved_rows.any()) or not solved.proofs.up_to_ends


class _Report:
    """Progress as a fraction: tracking, rows and proofs take about a third each."""

    def __init__(
        self, progress: Callable[[float], None] | None, start: float, low: float, high: float
    ) -> None:
        self.progress = progress
        self.start = start
        self.span = max(high, start) - min(low, start) or 1.0

    def tracked(self, t: float) -> None:
        """A step of the track has arrived at t."""
        if self.progress is not None:
            self.progress(min(1.0, abs(t - self.start) / self.span) / 3.0)

    def solved(self, fraction: float) -> None:
        """A fraction of the rows is done."""
        if self.progress is not None:
            self.progress((1.0 + fraction) / 3.0)

    def proved(self, fraction: float) -> None:
        """A fraction of the rows is proved."""
        if self.progress is not None:
            self.progress((2.0 + fraction) / 3.0)


def _onto_path(
    model: Model, path: InputPath, start: Start, t: Array, lead: int, certify: bool
) -> tuple[Node, bool] | None:
    """The start as a node of the table's path, and whether the way to it is proved.

    Several inputs are first led onto the path.
    """
    solver = model.compiled.solver
    own = model.start_inputs
    here = float(own[lead])
    if np.allclose(path.at(here), own, rtol=0, atol=1e-12 * leading_scale(model, lead)):
        return node_at(solver, path, here, start.v), True
    weights = solver.variable_scale[solver.unknowns :]
    distance = np.abs((path.at(t) - own) / weights).max(axis=1)
    nearest = np.argsort(distance, kind="stable")
    spread = np.linspace(0, len(t) - 1, min(len(t), _ENTRIES)).astype(np.intp)
    for row in (nearest[0], *nearest[spread[1:]]):
        entry = _led_to(model, path, start, float(t[row]), certify)
        if entry is not None:
            return entry
    return None


def _led_to(
    model: Model, path: InputPath, start: Start, t: float, certify: bool
) -> tuple[Node, bool] | None:
    """The start led to one row of the table along the straight line between their inputs."""
    solver = model.compiled.solver
    way = InputPath(origin=model.start_inputs, rate=path.at(t) - model.start_inputs)
    first = node_at(solver, way, 0.0, start.v)
    nodes, end = follow(solver, way, first, 1.0, 1.0)
    if end is not None:
        return None
    entered = certify and way_is_proved(solver, way, [first, *nodes])
    return node_at(solver, path, t, nodes[-1].v), entered


def _covering(
    model: Model,
    path: InputPath,
    anchor: Node,
    t: Array,
    scale: float,
    report: _Report,
    care: TrackOptions | None,
) -> Track:
    """A track over the table's range, wound on the other way where a limit cuts it short."""
    solver = model.compiled.solver
    track = track_to(solver, path, anchor, [t.min(), t.max()], scale, report.tracked, care)
    if not turns_freely(model):
        return track
    above, below = track.above, track.below
    turn = 2.0 * np.pi
    if above is not None and below is None:
        beyond = t[t > track.last_t]
        goals = [beyond.min() - turn, t.min(), t.max()]
        return track_to(solver, path, anchor, goals, scale, options=care)
    if below is not None and above is None:
        beyond = t[t < track.first_t]
        goals = [beyond.max() + turn, t.min(), t.max()]
        return track_to(solver, path, anchor, goals, scale, options=care)
    return track


def _placed(track: Track, t: Array, free: bool) -> Array:
    """Where on the track each row lies, whole turns apart if need be; NaN if nowhere."""
    placed = np.where((t >= track.first_t) & (t <= track.last_t), t, np.nan)
    if not free:
        return placed
    turn = 2.0 * np.pi
    for shift in (-turn, turn, -2 * turn, 2 * turn):
        moved = t + shift
        inside = np.isnan(placed) & (moved >= track.first_t) & (moved <= track.last_t)
        placed[inside] = moved[inside]
    return placed


def _solve_rows(
    model: Model,
    path: InputPath,
    track: Track,
    placed: Array,
    scale: float,
    report: _Report,
    certify: bool,
) -> _Solved:
    solver = model.compiled.solver
    count, n = len(placed), solver.variables
    v, first, second = (np.full((count, n), np.nan) for _ in range(3))
    status = np.zeros(count, dtype=np.int8)
    iterations = np.zeros(count, dtype=np.int64)
    residual, condition = np.full(count, np.nan), np.full(count, np.nan)
    proofs = unproved(count, Certification.NOT_ASKED if not certify else Certification.NO_POSITION)
    there = np.flatnonzero(~np.isnan(placed))
    there = there[np.argsort(placed[there], kind="stable")]
    pieces: list[Rows] = []
    for begin in range(0, len(there), _CHUNK):
        chunk = there[begin : begin + _CHUNK]
        rows = rows_on_track(solver, path, track, placed[chunk], scale)
        pieces.append(rows)
        v[chunk], first[chunk], second[chunk] = rows.v, rows.rates.first, rows.rates.second
        status[chunk], iterations[chunk] = rows.status, rows.iterations
        residual[chunk], condition[chunk] = rows.residual, rows.rates.condition
        report.solved((begin + len(chunk)) / len(there))
    if certify and pieces:
        found = prove_rows(
            solver,
            path,
            track,
            placed[there],
            joined_rows(pieces),
            model.rows[there],
            report.proved,
        )
        proofs.code[there], proofs.radius[there] = found.code, found.radius
        proofs.unique[there] = found.unique
    return _Solved(
        v=v,
        first=first,
        second=second,
        status=status,
        iterations=iterations,
        residual=residual,
        condition=condition,
        proofs=proofs,
    )


def _mark_missing(
    solved: _Solved, track: Track, t: Array, missing: BoolArray, limits: tuple[Limit, ...]
) -> None:
    """Rows that are nowhere on the track say what was met on the straight way to them."""
    if not limits:
        return
    lower = limits[0] if track.below is not None else limits[-1]
    upper = limits[-1] if track.above is not None else limits[0]
    solved.status[missing & (t < track.first_t)] = lower.status.code
    solved.status[missing & (t > track.last_t)] = upper.status.code


def _motion(model: Model, solved: _Solved, limits: tuple[Limit, ...], start: Start) -> Motion:
    found = solved.status == Status.CONVERGED.code
    named = named_series(model, solved.v, solved.first, solved.second, model.everyday_rows, found)
    return _assembled(model, named, solved, limits, start.message)


def _without_start(model: Model, rows: Array, start: Start) -> Motion:
    count, n = len(rows), model.compiled.solver.variables
    nothing = np.full((count, n), np.nan)
    solved = _Solved(
        v=nothing,
        first=nothing,
        second=nothing,
        status=np.full(count, Status.NO_START.code, dtype=np.int8),
        iterations=np.zeros(count, dtype=np.int64),
        residual=np.full(count, np.nan),
        condition=np.full(count, np.nan),
        proofs=unproved(count, Certification.NO_POSITION),
    )
    named = named_series(
        model, nothing, nothing, nothing, model.everyday_rows, np.zeros(count, dtype=bool)
    )
    return replace(_assembled(model, named, solved, (), start.message), failure=start.failure)


def _assembled(
    model: Model, named: Named, solved: _Solved, limits: tuple[Limit, ...], message: str
) -> Motion:
    count = len(solved.status)
    return Motion(
        mechanism=model.description.name,
        units=model.units,
        skeleton=model.skeleton,
        inputs=named.inputs,
        input_units=model.input_units,
        derivative_unit=model.derivative_unit,
        unknowns=named.unknowns,
        links=named.links,
        riding=model.riding,
        sliders=named.sliders,
        points=named.points,
        outputs=named.outputs,
        status=tuple(Status.of_code(int(code)) for code in solved.status),
        message=message,
        residual=solved.residual,
        iterations=solved.iterations,
        condition=solved.condition,
        certification=tuple(Certification.of_code(int(c)) for c in solved.proofs.code),
        radius=solved.proofs.radius,
        unique_within=solved.proofs.unique,
        branch=("",) * count,
        speed=model.speed,
        limits=limits,
        q=solved.v[:, : model.compiled.solver.unknowns],
    )
