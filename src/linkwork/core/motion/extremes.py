"""Extremes of an output: positions at which its derivative with respect to the input is zero.

Rates, efforts and forces have no second derivative: they are compared at more and more positions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import (
    EPSILON,
    UNIT_ROUNDOFF,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
)
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import as_names
from linkwork.core.foundation.statuses import CONVERGED, Certification, Status
from linkwork.core.motion.following import Drive
from linkwork.core.motion.limits import BranchEnd
from linkwork.core.motion.model import Model, leading_input
from linkwork.core.motion.positions import RowValues
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.branch_tracking import InputPath, Track, rows_on_track
from linkwork.core.numerics.kantorovich import Expansion, tangent_errors
from linkwork.core.numerics.newton import Columns, SolvedRows
from linkwork.core.numerics.path_proof import prove_paths
from linkwork.core.numerics.position_proof import expansions, prove, reach, rounding_of_inputs
from linkwork.core.results.failure import OutputLimit
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Asked, Group
from linkwork.core.results.quantities.rows import columns_of, locate_rows

_NEAR = 1e-6  # of the leader: extremes of values alone are known so well
_AT_ONCE = 1e-12  # of the leader: a quantity and the input that turn back so near turn back at once


def check_quantities(model: Model, names: str | Iterable[str]) -> tuple[str, ...]:
    """One name or several, all of them of quantities of positions.

    Raises
    ------
    UnknownNameError
        With the names that exist.
    InputError
        For values that are no names, and for numbers about how a position was found.
    """
    names = as_names("the quantities", names)
    for name in names:
        asked = model.quantities.find(name)
        if asked.group is Group.EVIDENCE:
            raise InputError(
                f'limits of "{name}" are not known: it measures how a position was found'
            )
        asked.check_rate(model.speed)
    return names


def output_limits(drive: Drive, track: Track, name: str) -> list[tuple[float, OutputLimit]]:
    """Where a quantity is largest or smallest along a track.

    The quantity's derivative changes sign between two nodes; Newton-Raphson on it, kept inside the
    sign change, finds the place.

    Returns
    -------
    list of (t, limit)
    """
    t = np.unique([node.t for node in track.nodes])
    # between the nodes of a bold track a quantity may turn twice
    t = np.unique(np.concatenate([t, *(t[:-1] + s * np.diff(t) for s in (0.25, 0.5, 0.75))]))
    if len(t) < 2:
        return []
    asked = drive.model.quantities.find(name)
    if asked.needs:
        return list(_limits_by_values(drive, track, asked, t))
    search = _Search(drive, track, name)
    rate = search.at(t)[1]
    found = []
    for k in np.flatnonzero(rate[:-1] * rate[1:] < 0.0):
        here, error = search.between(float(t[k]), float(t[k + 1]), float(rate[k]))
        value, _, second, condition = (float(part[0]) for part in search.at(np.array([here])))
        # the derivative is known to its rounding only
        size = max(abs(float(rate[k])), abs(float(rate[k + 1])), abs(second))
        # errors of the position, magnified by the condition, shift the zero of the derivative
        noise = 8.0 * EPSILON * condition * size
        error = max(error, noise / abs(second)) if second else np.inf
        unit = drive.unit
        limit = OutputLimit(
            name=name,
            kind="maximum" if second < 0.0 else "minimum",
            input=float(here / unit),
            value=value,
            bracket=(float((here - error) / unit), float((here + error) / unit)),
            # a flat extreme is known by its value, hardly by its input
            located=bool(error <= 1e-9 * max(1.0, abs(here))),
        )
        found.append((here, limit))
    return found


def output_limit_at(drive: Drive, end: BranchEnd, name: str) -> OutputLimit | None:
    """A quantity's extreme at a dead point, if it rests there together with the input.

    The quantity's derivative by the input does not vanish there; that by the variable that leads
    through the dead point does.
    """
    if end.led is None or end.node is None or drive.model.quantities.find(name).needs:
        return None
    led, node, model = end.led, end.node, drive.model
    v, first, second = (led.whole(x)[None, :] for x in (node.v, node.first, node.second))
    series = RowValues(model, v, first, second, np.ones(1, dtype=bool)).series(name)
    rate, bend = float(series.first[0]), float(series.second[0])
    noise = 8.0 * EPSILON * node.condition * float(np.abs(series.first[0]) + np.abs(bend))
    # how far the leader would still have to move for the rate to vanish
    away = (abs(rate) + noise) / abs(bend) if bend else np.inf
    if not away <= _AT_ONCE * led.path.size * max(1.0, node.condition):
        return None
    return OutputLimit(
        name=name,
        kind="maximum" if bend < 0.0 else "minimum",
        input=end.limit.input,
        value=float(series.value[0]),
        bracket=end.limit.bracket,
        located=end.limit.located,
    )


class _Search:
    """A quantity along a track: value, first and second derivative by the leading input, and the
    condition of the positions.
    """

    def __init__(self, drive: Drive, track: Track, name: str) -> None:
        self.drive, self.track, self.name = drive, track, name

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """At the values t (B,)."""
        model = self.drive.model
        rows = rows_on_track(self.drive.solver, self.drive.path, self.track, t)
        good = rows.status == Status.CONVERGED.code
        series = RowValues(model, rows.v, rows.first, rows.second, good).series(self.name)
        return series.value, series.first, series.second, rows.condition

    def between(self, low: float, high: float, rate: float) -> tuple[float, float]:
        """Where the derivative is zero, and how far from it that may be."""
        here = best = 0.5 * (low + high)
        least, error = np.inf, high - low
        for _ in range(60):
            _, first, second, _ = (float(part[0]) for part in self.at(np.array([here])))
            if not np.isfinite(first):
                break
            step = -first / second if second else np.inf
            tiny = 4.0 * EPSILON * max(1.0, abs(here))
            if abs(first) < least:
                best, least, error = here, abs(first), abs(step)
            elif abs(step) < 1e-9:
                break  # to rounding
            if abs(step) <= tiny:
                break
            if first * rate > 0.0:
                low = here
            else:
                high = here
            here = here + step if low < here + step < high else 0.5 * (low + high)
        return best, max(error, 4.0 * EPSILON * max(1.0, abs(best)))


class _TrackRows(RowValues):
    """Quantities of positions on a track."""

    @property
    def found(self) -> BoolArray:
        """Whether a row has a position, (B,)."""
        return np.logical_not(self.lost)


@dataclass(frozen=True, eq=False)
class _OnTrack:
    """Solves positions between three values of t on a track."""

    drive: Drive
    track: Track

    @property
    def joined(self) -> BoolArray:
        """All of them."""
        return np.ones(2, dtype=bool)

    @property
    def switches(self) -> Array:
        """None: limits are those of quantities of positions alone."""
        return np.zeros(0)

    @property
    def far(self) -> float:
        """Tracks show their extremes themselves."""
        return np.inf

    def __call__(self, row: IndexArray, at: Array) -> _TrackRows:
        """At the values t (B,)."""
        rows = rows_on_track(self.drive.solver, self.drive.path, self.track, at)
        good = rows.status == Status.CONVERGED.code
        return _TrackRows(self.drive.model, rows.v, rows.first, rows.second, good)


def _limits_by_values(
    drive: Drive, track: Track, asked: Asked, t: Array
) -> Iterator[tuple[float, OutputLimit]]:
    """The extremes of a quantity whose second derivative is not known, next to values of t."""
    between, speed, unit = _OnTrack(drive, track), drive.model.speed, drive.unit
    solved = between(np.zeros(len(t), dtype=np.intp), t)
    for word, side in (("max", 1.0), ("min", -1.0)):
        number = drive.model.quantities.find_of_motion(f"{word}({asked.name})")
        columns = [np.broadcast_to(x, len(t)) for x in columns_of(number, solved, speed)]
        f = side * columns[0]
        higher = (f[1:-1] >= f[:-2]) & (f[1:-1] >= f[2:])
        bent = 2.0 * f[1:-1] - f[:-2] - f[2:] > 16.0 * EPSILON * np.abs(f[1:-1])
        for k in np.flatnonzero(higher & bent) + 1:
            part = slice(k - 1, k + 2)
            own = number.rows(t[part], *(column[part] for column in columns))
            rows = locate_rows(number, own, between, speed).rows
            best = int(np.clip((side * rows.value).argmax(), 1, len(rows.input) - 2))
            if np.isinf(rows.value[best]):
                continue  # a pole
            here = float(rows.input[best])
            # the last correction: a flat extreme is known by its value, hardly by its input
            error = float(np.abs(rows.input[[best - 1, best + 1]] - here).min())
            yield (
                here,
                OutputLimit(
                    name=asked.name,
                    kind="maximum" if side > 0.0 else "minimum",
                    input=here / unit,
                    value=float(rows.value[best]),
                    bracket=((here - error) / unit, (here + error) / unit),
                    located=error <= _NEAR * max(1.0, abs(here)),
                ),
            )


# ----------------------------------------------------------------------
# Boxes of all positions between the rows of a motion, and how far points move in them.
#
# A box is a proved position with every input of an interval around its own: the unknowns stay
# within its bounds (:func:`linkwork.core.numerics.position_proof.reach`), and near the tangent.


_SLACK = 1.0 + 1e-9  # covers the rounding of sums of a few dozen terms
_MOST = 4000  # positions solved in between to prove the ways into halves of boxes,
_MOST_EACH = 1000  # and at least this many for each: 500 are needed 0.25° from a dead point
_HALVINGS = 24  # of a box, at most


class Boxes(Columns):
    """B boxes around positions ``v`` (B, N), variables in internal units.

    ``half`` (B, p): how far inputs are from those in v; ``bound`` (B, N): how far all variables
    are; ``holds`` (B,): whether that is proved; ``known`` (B,): whether v is on its branch.
    ``near`` (B, N): how far the true position is from v; ``apart`` (B, n): how far all other
    positions are, in one unknown at least. ``first`` (B, N): rates of all variables with respect to
    the leading input; ``bend`` (B, N): how far variables are at most from the tangent.
    ``rate`` (B, p): how fast inputs follow the leading one, the same in all boxes.
    """

    v: Array
    half: Array
    bound: Array
    holds: BoolArray
    known: BoolArray
    near: Array
    apart: Array
    first: Array
    bend: Array
    rate: Array

    def __len__(self) -> int:
        return len(self.v)

    @property
    def lead(self) -> int:
        """The number of the leading input: the first one that moves."""
        return int(np.argmax((self.rate != 0.0).any(axis=0)))

    @property
    def span(self) -> Array:
        """How far the leading input is from that in v at most, (B,)."""
        found: Array = self.half[:, self.lead] * _SLACK
        return found

    @property
    def ends(self) -> tuple[Array, Array]:
        """The interval of the leading input, (B,) each."""
        middle, half = self.leading, self.half[:, self.lead]
        return middle - half, middle + half

    @property
    def leading(self) -> Array:
        """The leading input, (B,)."""
        found: Array = self.v[:, self.v.shape[1] - self.rate.shape[1] + self.lead]
        return found


def boxes_of(model: Model, motion: Motion, v: Array) -> Boxes:
    """A box around every row of a motion that has a position, half-way to its neighbours.

    The box of a row next to the last one, or next to a dead point, goes all the way to it; between
    two such rows is one more. A row next to one without a position, and no dead point between, is
    not ``known``.

    Parameters
    ----------
    v : (B, N)
        All variables of the mechanism with its own inputs in these rows.
    """
    found = motion.found
    inputs = v[:, (model.untimed or model).compiled.solver.unknowns :]
    steps = np.abs(np.diff(inputs, axis=0))
    dead = np.array([name != "" for name in motion.limit], dtype=bool)
    branch = np.array(motion.branch, dtype=object)
    end = dead[1:] | dead[:-1]
    joined = found[1:] & found[:-1] & ((branch[1:] == branch[:-1]) | end)
    # where no dead point ends the branch, positions beyond its rows may be missing
    ragged = np.zeros(len(found), dtype=bool)
    ragged[1:] |= ~joined & ~end
    ragged[:-1] |= ~joined & ~end
    if model.untimed is not None:  # time says nothing about inputs between rows
        ragged[:] = True
    met = np.flatnonzero(found)
    apart = (np.diff(met) > 1) | ~joined[met[:-1]]
    steps[apart] = 0.0
    last, dead = np.append(apart, True), dead[found]
    # boxes are symmetric: those of the first and the last row would leave the table
    reached = dead | last | np.insert(apart, 0, True)
    half = np.zeros_like(inputs)
    half[1:] = np.maximum(half[1:], steps * np.where(reached[:-1], 1.0, 0.5)[:, None])
    half[:-1] = np.maximum(half[:-1], steps * np.where(reached[1:], 1.0, 0.5)[:, None])
    half[reached] = 0.0
    # links that are redundant fit to rounding wherever the others do
    subset = np.array(Certification.SUBSET_CERTIFIED.where(motion.certification), dtype=bool)
    known = (motion.certified | subset)[found] & ~ragged[found]
    table = inputs[~motion.added[found]] if (~motion.added[found]).any() else inputs
    lead, rate = leading_input(table)
    boxes = _reached(model, v, half, lead, rate, known)
    boxes = boxes.with_columns(known=known & ~dead)
    open_ = np.flatnonzero(~apart & reached[:-1] & reached[1:])
    if not len(open_):
        return boxes
    # from the end that is no dead point
    begin = open_ + dead[open_]
    toward = np.where(dead[open_], open_, open_ + 1)
    wide = _reached(model, v[begin], steps[open_], lead, rate, boxes.known[begin])
    rising = inputs[toward, lead] > inputs[begin, lead]
    halves = _divided(model, wide)
    return Boxes.concatenate([boxes, halves.take(np.arange(len(open_)) + rising * len(open_))])


def variables_of(model: Model, motion: Motion) -> Array:
    """All variables in the rows that have a position, internal units, (B, N).

    ``model``: with its own inputs.
    """
    inputs = [motion.inputs[variable.name] for variable in model.equations.inputs]
    columns = np.stack(inputs, axis=1) * model.input_scale
    return np.concatenate([motion.q, columns], axis=1)[motion.found]


def _reached(
    model: Model, v: Array, half: Array, lead: int, rate: Array, known: BoolArray
) -> Boxes:
    solver = (model.untimed or model).compiled.solver
    n = solver.unknowns
    rounding = rounding_of_inputs(v, n)
    wide = half * _SLACK + rounding
    bound, bend, near = np.zeros_like(v), np.full_like(v, np.inf), np.full_like(v, np.inf)
    bound[:, n:] = wide
    apart, first = np.zeros((len(v), n)), np.zeros_like(v)
    holds = np.isfinite(half.sum(axis=1))
    if all(block.system.has_curvature_bound for block in solver.blocks) and holds.any():
        linear = solver.linearise(v)
        places = [at for at in expansions(solver, v, linear) if isinstance(at, Expansion)]
        found = reach(solver, v, np.where(holds[:, None], wide, 0.0), places)
        bound[:, :n], holds = found.error_bound[:, :n], holds & found.holds
        apart = found.isolation_radius
        near = prove(solver, v, rounding, places).error_bound
        first = solver.rates(v, rate).first
        # conversion of units, and the rate of inputs from one end of the table to the other
        lost = 2.0 * rounding + UNIT_ROUNDOFF * np.abs(half)
        span = half[:, lead] * _SLACK
        bend = tangent_errors(solver, linear, places, first, span, bound, lost)
    else:
        holds = np.zeros(len(v), dtype=bool)
    return Boxes(
        v=v,
        half=half,
        bound=bound,
        holds=holds & known,
        known=known.copy(),
        near=near,
        apart=apart,
        first=first,
        bend=bend,
        rate=np.tile(rate, (len(v), 1)),
    )


def refined(
    model: Model,
    boxes: Boxes,
    decide: Callable[[Boxes], BoolArray | None],
    *,
    most: int,
    progress: Callable[[float], None] | None = None,
) -> Boxes:
    """The boxes that are not decided although all others have been halved often enough.

    Parameters
    ----------
    decide : callable
        Whether boxes need not be halved, (B,); ``None``: no box does any more.
    most : int
        Boxes that may be asked about in all.
    progress : callable, optional
        Called with a finished fraction.
    """
    left, asked = [], 0
    for level in range(_HALVINGS):
        decided = decide(boxes)
        asked += len(boxes)
        rest = boxes if decided is None else boxes.take(np.flatnonzero(~decided))
        last = decided is None or level == _HALVINGS - 1 or asked + 2 * len(rest) > most
        wide = np.isfinite(rest.half).all(axis=1) & (rest.half > 0.0).any(axis=1)
        useful = rest.known & wide & (not last)
        left.append(rest.take(np.flatnonzero(~useful)))
        boxes = rest.take(np.flatnonzero(useful))
        if not len(boxes):
            break
        boxes = _divided(model, boxes)
        if progress is not None:
            progress(1.0 - 1.0 / (2 + level))
    return Boxes.concatenate(left)


def _divided(model: Model, boxes: Boxes) -> Boxes:
    """Both halves of boxes, the lower ones first; ``known`` of a half: that it is proved to be on
    the same branch.
    """
    solver = (model.untimed or model).compiled.solver
    n, lead, rate = solver.unknowns, boxes.lead, boxes.rate[0]
    path = Drive.through(model, boxes.v[0, n:], rate, lead).path
    step = np.concatenate([-0.5 * boxes.half[:, lead], 0.5 * boxes.half[:, lead]])[:, None]
    whole = np.tile(np.arange(len(boxes)), 2)
    old, twice = _rows(model, path, boxes.v, lead), boxes.take(whole)
    with np.errstate(all="ignore"):
        # both ways along the path of the inputs
        guess = twice.v + step * old.first[whole] + 0.5 * step**2 * old.second[whole]
        guess[:, n:] = twice.v[:, n:] + step * rate
        finite = np.isfinite(guess.sum(axis=1))
        solved = solver.solve(np.where(finite[:, None], guess, twice.v))
        known = np.asarray(twice.known & finite & (solved.status == CONVERGED))
        found = _reached(model, solved.v, twice.half / 2.0, lead, rate, known)
        # the only position of the whole box at this input: eq. (33)
        there = np.abs(solved.v - twice.v)[:, :n] + found.near[:, :n] < twice.apart
        ways = np.flatnonzero(known & ~(twice.holds & there.all(axis=1)))
        new = _rows(model, path, solved.v[ways], lead)
        known[ways] = _connected(solver, path, old.take(whole[ways]), new)
    return found.with_columns(holds=found.holds & known, known=known)


def _rows(model: Model, path: InputPath, v: Array, lead: int) -> SolvedRows:
    """Positions (B, N) with what proofs of the way between them need."""
    solver = (model.untimed or model).compiled.solver
    rates = solver.rates(v, path.rate)
    return SolvedRows(
        t=v[:, solver.unknowns + lead].copy(),
        v=v.copy(),
        first=rates.first,
        second=rates.second,
        input_radius=rounding_of_inputs(v, solver.unknowns),
    )


def _connected(solver: BlockSolver, path: InputPath, old: SolvedRows, new: SolvedRows) -> BoolArray:
    """Whether each new position is proved to be on the branch of the old one, (B,)."""
    found = np.zeros(len(old), dtype=bool)
    pairs = []
    for k in range(len(old)):
        pair = SolvedRows.concatenate([old.take(np.array([k])), new.take(np.array([k]))])
        pairs.append(pair if old.t[k] < new.t[k] else pair.take(np.array([1, 0])))
    if pairs:
        most = max(_MOST, _MOST_EACH * len(pairs))
        proofs = prove_paths(solver, path, pairs, anchors=[0] * len(pairs), most=most)
        found[:] = [bool(proof.connected.all()) for proof in proofs]
    return found


@dataclass(frozen=True, kw_only=True, eq=False)
class PointMotions:
    """The P points of a mechanism in B boxes, (B, P) each [length].

    ``place``: where they are in the middle; ``rate``: with respect to the leading input; ``moved``:
    how far they are at most from that place; ``bend``: how far from the tangent.
    """

    place: ComplexArray
    rate: ComplexArray
    moved: Array
    bend: Array


def motions_of_points(model: Model, boxes: Boxes) -> PointMotions:
    """How points move in boxes; without a proof they may be anywhere."""
    table = (model.untimed or model).compiled.points
    rows = table.rows
    weights = np.zeros((boxes.v.shape[1], len(rows.coefficient)))
    np.add.at(weights, (rows.phase_variable, rows.phase_term), np.abs(rows.phase_weight))
    place, rate, _ = table.jet(boxes.v, boxes.first, np.zeros_like(boxes.v))
    variable = np.flatnonzero(rows.length >= 0)
    own = rows.length[variable]

    def lengths(of: Array, otherwise: float) -> Array:
        found = np.full((len(boxes), len(rows.coefficient)), otherwise)
        found[:, variable] = np.abs(of[:, own])
        return found

    def summed(terms: Array) -> Array:
        points: Array = (np.abs(rows.coefficient) * terms) @ np.eye(len(table.names))[rows.row]
        for child, parent in table.levels:
            points[:, child] += points[:, parent]
        return points * _SLACK

    with np.errstate(all="ignore"):  # bounds of boxes without a proof are infinite
        turned, length = boxes.bound @ weights, lengths(boxes.v, 1.0)
        longer = lengths(boxes.bound, 0.0)
        # the chord of an arc is no longer than the arc, and no longer than its diameter
        moved = summed(length * np.minimum(turned, 2.0) + longer)
        # eq. (191)
        second = length * (0.5 * turned**2 + boxes.bend @ weights) + lengths(boxes.bend, 0.0)
        second += longer * (turned + 0.5 * turned**2)
        rounding = (8 + len(rows.coefficient)) * UNIT_ROUNDOFF * (length + longer)
        bend = summed(second + rounding)
    return PointMotions(place=place, rate=rate, moved=moved, bend=bend)
