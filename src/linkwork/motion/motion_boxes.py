"""Boxes of all positions between the rows of a motion, and how far points move in them.

A box is a proved position with every input of an interval around its own: the unknowns stay within
its bounds (:func:`linkwork.numerics.proof.position_proof.reach`), and near the tangent.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from linkwork.foundation.arrays import AnyArray, Array, BoolArray, ComplexArray, IndexArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.foundation.status import CONVERGED
from linkwork.motion.drive import Drive
from linkwork.motion.leading_input import leading_input
from linkwork.motion.model import Model
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.continuation.branch_tracking import InputPath
from linkwork.numerics.continuation.path_proof import prove_paths
from linkwork.numerics.proof.kantorovich import Expansion
from linkwork.numerics.proof.position_proof import expansions, prove, reach, rounding_of_inputs
from linkwork.numerics.proof.tangent_bounds import tangent_errors
from linkwork.numerics.rows import SolvedRows
from linkwork.results.motion import Motion

__all__ = ["Boxes", "PointMotions", "boxes_of", "motions_of_points", "refined", "variables_of"]

_SLACK = 1.0 + 1e-9  # covers the rounding of sums of a few dozen terms
_MOST = 4000  # positions solved in between to prove the ways into halves of boxes,
_MOST_EACH = 1000  # and at least this many for each: 500 are needed 0.25° from a dead point
_HALVINGS = 24  # of a box, at most


@dataclass(frozen=True, kw_only=True, eq=False)
class Boxes:
    """B boxes around positions ``v`` (B, N), variables in internal units.

    ``half`` (B, p): how far inputs are from those in v; ``bound`` (B, N): how far all variables
    are; ``holds`` (B,): whether that is proved; ``known`` (B,): whether v is on its branch.
    ``near`` (B, N): how far the true position is from v; ``apart`` (B, n): how far all other
    positions are, in one unknown at least. ``first`` (B, N): rates of all variables with respect to
    the leading input; ``bend`` (B, N): how far variables are at most from the tangent.
    ``lead``, ``rate`` (p,): the leading input, and how fast the others follow it.
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
    lead: int
    rate: Array

    def __len__(self) -> int:
        return len(self.v)

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
        found: Array = self.v[:, self.v.shape[1] - len(self.rate) + self.lead]
        return found

    def take(self, rows: IndexArray) -> Boxes:
        """Some of the boxes."""
        return self._with({name: own[rows] for name, own in self._columns.items()})

    @classmethod
    def joined(cls, parts: Sequence[Boxes]) -> Boxes:
        """The boxes of all parts."""
        columns = [part._columns for part in parts]
        return parts[0]._with(
            {name: np.concatenate([own[name] for own in columns]) for name in columns[0]}
        )

    def _with(self, columns: Mapping[str, AnyArray]) -> Boxes:
        every: dict[str, Any] = {**vars(self), **columns}
        return Boxes(**every)

    @property
    def _columns(self) -> dict[str, AnyArray]:
        return {name: own for name, own in vars(self).items() if name not in ("lead", "rate")}


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
    boxes = replace(boxes, known=known & ~dead)
    open_ = np.flatnonzero(~apart & reached[:-1] & reached[1:])
    if not len(open_):
        return boxes
    # from the end that is no dead point
    begin = open_ + dead[open_]
    toward = np.where(dead[open_], open_, open_ + 1)
    wide = _reached(model, v[begin], steps[open_], lead, rate, boxes.known[begin])
    rising = inputs[toward, lead] > inputs[begin, lead]
    halves = _divided(model, wide)
    return Boxes.joined([boxes, halves.take(np.arange(len(open_)) + rising * len(open_))])


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
        bound[:, :n], holds = found.error_bound, holds & found.holds
        apart = found.isolation_radius
        near = prove(solver, v, rounding, places).error_bound
        first = solver.rates(v, rate, linear).first
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
        known=known,
        near=near,
        apart=apart,
        first=first,
        bend=bend,
        lead=lead,
        rate=rate,
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
    return Boxes.joined(left)


def _divided(model: Model, boxes: Boxes) -> Boxes:
    """Both halves of boxes, the lower ones first; ``known`` of a half: that it is proved to be on
    the same branch.
    """
    solver = (model.untimed or model).compiled.solver
    n, lead, rate = solver.unknowns, boxes.lead, boxes.rate
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
    return replace(found, holds=found.holds & known, known=known)


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
