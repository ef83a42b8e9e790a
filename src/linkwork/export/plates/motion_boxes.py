"""Boxes of all positions between the rows of a motion, and how far bodies move in them.

A box is a proved position with every input of an interval around its own: the unknowns stay within
its bounds (:func:`linkwork.numerics.proof.position_proof.reach`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwork.forces.geometry import Geometry
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.names import GROUND
from linkwork.foundation.status import CONVERGED
from linkwork.motion.drive import Drive
from linkwork.motion.leading_input import leading_input
from linkwork.motion.model import Model
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.continuation.branch_tracking import InputPath
from linkwork.numerics.continuation.path_proof import prove_paths
from linkwork.numerics.proof.position_proof import reach, rounding_of_inputs
from linkwork.numerics.rows import SolvedRows
from linkwork.results.motion import Motion

__all__ = ["BodyPoses", "Boxes", "boxes_of", "divided", "variables_of"]

_SLACK = 1.0 + 1e-9  # covers the rounding of sums of a few dozen terms
_MOST = 4000  # positions solved in between to prove the ways into halves of boxes


@dataclass(frozen=True, kw_only=True, eq=False)
class Boxes:
    """B boxes around positions ``v`` (B, N), variables in internal units.

    ``half`` (B, p): how far inputs are from those in v; ``bound`` (B, N): how far all variables
    are; ``holds`` (B,): whether that is proved; ``known`` (B,): whether v is on its branch.
    ``lead``, ``rate`` (p,): the leading input, and how fast the others follow it.
    """

    v: Array
    half: Array
    bound: Array
    holds: BoolArray
    known: BoolArray
    lead: int
    rate: Array

    def take(self, rows: IndexArray) -> Boxes:
        """Some of the boxes."""
        return Boxes(
            v=self.v[rows],
            half=self.half[rows],
            bound=self.bound[rows],
            holds=self.holds[rows],
            known=self.known[rows],
            lead=self.lead,
            rate=self.rate,
        )


def boxes_of(model: Model, motion: Motion) -> Boxes:
    """A box around every row of a motion that has a position, half-way to its neighbours.

    The box of a row next to the last one, or next to a dead point, goes all the way to it. A row
    next to one without a position, and no dead point between, is not ``known``.
    """
    v, found = variables_of(model, motion), motion.found
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
    first = np.insert(apart, 0, True) & ~np.append(last[1:], False)
    # boxes are symmetric: those of the first and the last row would leave the table
    reached = dead | last | first
    half = np.zeros_like(inputs)
    half[1:] = np.maximum(half[1:], steps * np.where(reached[:-1], 1.0, 0.5)[:, None])
    half[:-1] = np.maximum(half[:-1], steps * np.where(reached[1:], 1.0, 0.5)[:, None])
    half[reached] = 0.0
    # links that are redundant fit to rounding wherever the others do
    subset = np.array(Certification.SUBSET_CERTIFIED.where(motion.certification), dtype=bool)
    known = (motion.certified | subset)[found] & ~ragged[found]
    table = inputs[~motion.added[found]] if (~motion.added[found]).any() else inputs
    boxes = _reached(model, v, half, *leading_input(table))
    return replace(boxes, holds=boxes.holds & known, known=known & ~dead)


def variables_of(model: Model, motion: Motion) -> Array:
    """All variables of the mechanism with its own inputs, internal units, (B, N)."""
    if model.untimed is not None:
        return Geometry(model, motion).variables[motion.found]
    inputs = [motion.inputs[variable.name] for variable in model.equations.inputs]
    columns = np.stack(inputs, axis=1) * model.input_scale
    return np.concatenate([motion.q, columns], axis=1)[motion.found]


def _reached(model: Model, v: Array, half: Array, lead: int, rate: Array) -> Boxes:
    solver = (model.untimed or model).compiled.solver
    n = solver.unknowns
    wide = half * _SLACK + rounding_of_inputs(v, n)
    bound = np.zeros_like(v)
    bound[:, n:] = wide
    holds = np.isfinite(half.sum(axis=1))
    if all(block.system.has_curvature_bound for block in solver.blocks) and holds.any():
        found = reach(solver, v, np.where(holds[:, None], wide, 0.0))
        bound[:, :n], holds = found.error_bound, holds & found.holds
    else:
        holds = np.zeros(len(v), dtype=bool)
    known = np.ones(len(v), dtype=bool)
    return Boxes(v=v, half=half, bound=bound, holds=holds, known=known, lead=lead, rate=rate)


def divided(model: Model, boxes: Boxes) -> Boxes:
    """Both halves of boxes; ``known`` of a half: that it is proved to be on the same branch."""
    solver = (model.untimed or model).compiled.solver
    n = solver.unknowns
    lead, rate = boxes.lead, boxes.rate
    path = Drive.through(model, boxes.v[0, n:], rate, lead).path
    old = _rows(model, path, boxes.v, lead)
    parts = []
    with np.errstate(all="ignore"):
        for side in (-0.5, 0.5):
            # both ways along the path of the inputs
            step = side * boxes.half[:, lead]
            guess = boxes.v + step[:, None] * old.first + 0.5 * step[:, None] ** 2 * old.second
            guess[:, n:] = boxes.v[:, n:] + step[:, None] * rate
            finite = np.isfinite(guess.sum(axis=1))
            solved = solver.solve(np.where(finite[:, None], guess, boxes.v))
            half = _reached(model, solved.v, boxes.half / 2.0, lead, rate)
            known = np.zeros(len(step), dtype=bool)
            known[:] = boxes.known & finite & (solved.status == CONVERGED)
            ways = np.flatnonzero(known)
            new = _rows(model, path, solved.v[ways], lead)
            known[ways] = _connected(solver, path, old.take(ways), new)
            parts.append(replace(half, holds=half.holds & known, known=known))
    return replace(
        boxes,
        v=np.concatenate([part.v for part in parts]),
        half=np.concatenate([part.half for part in parts]),
        bound=np.concatenate([part.bound for part in parts]),
        holds=np.concatenate([part.holds for part in parts]),
        known=np.concatenate([part.known for part in parts]),
    )


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
        proofs = prove_paths(solver, path, pairs, anchors=[0] * len(pairs), most=_MOST)
        found[:] = [bool(proof.connected.all()) for proof in proofs]
    return found


class BodyPoses:
    """Places and directions of bodies in positions, and how far they may be in boxes.

    Parameters
    ----------
    model : Model
    first : Mapping[str, str]
        The link in whose frame a body is described, by body.
    millimetres : float
        Per length unit of the file.
    """

    def __init__(self, model: Model, first: Sequence[str], millimetres: float) -> None:
        self.model, self.millimetres = model.untimed or model, millimetres
        self.bodies = [body for body in first if body != GROUND]
        equations = self.model.equations
        numbered = tuple(enumerate(equations.variables))
        index = {v.symbol: k for k, v in numbered} | {v.name: k for k, v in numbered}
        angles = {body: equations.links[body] for body in self.bodies}
        self._angle = {
            body: (None if own.variable is None else index[own.variable], own.constant)
            for body, own in angles.items()
        }

    @cached_property
    def _origin(self) -> Mapping[str, int]:
        """The number of the first point of every body."""
        links = self.model.description.links  # type: ignore[attr-defined]
        names = self.model.compiled.points.names
        return {body: names.index(links[body][0]) for body in self.bodies}

    def of(self, v: Array) -> dict[str, tuple[ComplexArray, ComplexArray]]:
        """Origin [mm] and direction of every body in positions (B, N)."""
        nothing = np.zeros_like(v)
        places = self.millimetres * self.model.compiled.points.jet(v, nothing, nothing)[0]
        one = np.ones(len(v), dtype=complex)
        found: dict[str, tuple[ComplexArray, ComplexArray]] = {GROUND: (one - one, one)}
        for body in self.bodies:
            k, constant = self._angle[body]
            turn = np.full(len(v), constant) if k is None else constant + v[:, k]
            found[body] = (places[:, self._origin[body]], np.cos(turn) + 1j * np.sin(turn))
        return found

    def spread(self, boxes: Boxes) -> dict[str, tuple[Array, Array]]:
        """How far every body's origin moves [mm] and turns [rad] at most in boxes, (B,) each."""
        with np.errstate(all="ignore"):  # bounds of boxes without a proof are infinite
            return self._spread(boxes)

    def _spread(self, boxes: Boxes) -> dict[str, tuple[Array, Array]]:
        table = self.model.compiled.points
        rows = table.rows
        weights = np.zeros((boxes.v.shape[1], len(rows.coefficient)))
        np.add.at(weights, (rows.phase_variable, rows.phase_term), np.abs(rows.phase_weight))
        turned = boxes.bound @ weights
        length = np.ones_like(turned)
        longer = np.zeros_like(turned)
        variable = np.flatnonzero(rows.length >= 0)
        length[:, variable] = np.abs(boxes.v[:, rows.length[variable]])
        longer[:, variable] = boxes.bound[:, rows.length[variable]]
        # the chord of an arc is no longer than the arc, and no longer than its diameter
        moved = np.abs(rows.coefficient) * (length * np.minimum(turned, 2.0) + longer)
        points = moved @ np.eye(len(table.names))[rows.row]
        for child, parent in table.levels:
            points[:, child] += points[:, parent]
        points *= self.millimetres * _SLACK
        nothing = np.zeros(len(boxes.v))
        found = {GROUND: (nothing, nothing)}
        for body in self.bodies:
            k, _ = self._angle[body]
            turn = nothing if k is None else boxes.bound[:, k] * _SLACK
            found[body] = (points[:, self._origin[body]], np.minimum(turn, math.pi))
        return found
