"""The known positions at one input value."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.angles import within_half_a_turn
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.completeness import Completeness
from linkwork.foundation.status import Status
from linkwork.kernels.loop_table import LoopTable
from linkwork.motion.assembly.assembling import positions_at
from linkwork.motion.failure.dyads import dyad_of
from linkwork.motion.model import Model
from linkwork.numerics.block_solver import Block, linearise_block
from linkwork.numerics.newton import NewtonOptions, newton
from linkwork.numerics.proof.position_proof import prove_block

__all__ = [
    "Elsewhere",
    "ElsewhereAt",
    "block_positions",
    "distance",
    "positions_elsewhere",
    "roots_in_block",
]

_STARTS = 192  # per block that is no dyad
_MOST_BLOCKS = 8
_MOST_LOOPS = 4  # coupled, whose configurations are listed: more take seconds
_MOST = 64  # positions; a chain of dyads has 2^blocks
_SAME_POSITION = 1e-6  # weighted
_REACH = 2.0  # lengths are looked for within this many times the longest link around the guess


@dataclass(frozen=True, kw_only=True, eq=False)
class Elsewhere:
    """All variables of every position found, (K, N); ``complete``: whether there are no others;
    ``likely``: that only with probability one. ``names``: of the configurations, if they have any.
    """

    v: Array
    complete: bool
    likely: bool = False
    names: tuple[str, ...] = ()


#: Finds the positions that exist for given inputs (p,), internal units; ``None``: not searched.
ElsewhereAt = Callable[[Model, Array], Elsewhere | None]


def positions_elsewhere(model: Model, inputs: Array) -> Elsewhere | None:
    """The positions of a mechanism for the inputs (p,): its configurations where they can be
    listed, else those that Newton-Raphson finds from many starts, block by block.
    """
    solver = model.compiled.solver
    if len(solver.blocks) > _MOST_BLOCKS:
        return None
    if max((len(block.equations) for block in solver.blocks), default=0) <= _MOST_LOOPS:
        listed = positions_at(model, inputs)
        if listed.completeness is not Completeness.NOT_LISTED:
            grade = listed.completeness
            likely = grade is Completeness.WITH_PROBABILITY_ONE
            return Elsewhere(v=listed.v, complete=grade.complete, likely=likely, names=listed.names)
    return _search_block(model, inputs)


def _search_block(model: Model, inputs: Array) -> Elsewhere:
    solver = model.compiled.solver
    guess = model.equations.start.copy()
    guess[solver.unknowns :] = inputs
    found, complete = guess[None, :], True
    for block in solver.blocks:
        pieces = []
        for v in found:
            here, all_of_them = block_positions(block, v)
            complete &= all_of_them
            piece = np.repeat(v[None, :], len(here), axis=0)
            piece[:, block.unknowns] = here
            pieces.append(piece)
        found = np.concatenate(pieces) if pieces else found[:0]
        if len(found) > _MOST:
            found, complete = found[:_MOST], False
    return Elsewhere(v=found, complete=complete)


def block_positions(block: Block, v: Array) -> tuple[Array, bool]:
    """The positions (K, n) of one block for the known variables in v (N,), and whether all.

    ``v`` also holds the block's guess, around which lengths and plain numbers are looked for.
    """
    dyad = dyad_of(block, v)
    if dyad is not None:
        polished, good = _solve_starts(block, v, dyad.roots)
        return polished, bool(good.all()) and dyad.all_roots
    start = v[block.variables]
    n = len(block.unknowns)
    linear = _is_linear(block)
    found, _ = _solve_starts(block, v, start[None, :n] if linear else _starts(block, start[:n]))
    distinct: list[Array] = []
    for x in found:
        if all(distance(block, x, other) > _SAME_POSITION for other in distinct):
            distinct.append(x)
    return np.array(distinct).reshape(-1, n), linear and len(distinct) == 1


def _is_linear(block: Block) -> bool:
    """Relative angles alone: one position."""
    table = block.system
    return isinstance(table, LoopTable) and not table.loops.rows and not table.functions


def _solve_starts(block: Block, v: Array, starts: Array) -> tuple[Array, BoolArray]:
    """Newton-Raphson from the starts (K, n); the positions found, and which starts led to one."""
    n = len(block.unknowns)
    if not len(starts):
        return np.zeros((0, n)), np.ones(0, dtype=bool)
    lanes = np.repeat(v[block.variables][None, :], len(starts), axis=0)
    lanes[:, :n] = starts
    done = newton(block.system, lanes, NewtonOptions(max_steps=40))
    # a small last step alone does not say that the equations hold
    good = (done.status == Status.CONVERGED.code) & (done.residual < 1e-10)
    if block.system.is_enclosed:  # nor does a small residual
        good[good] = roots_in_block(block, done.v[good])
    return done.v[good, :n], good


def roots_in_block(block: Block, v: Array) -> BoolArray:
    """Whether formulas are proved to have a root at positions v (B, N) of a block, (B,)."""
    n = len(block.unknowns)
    own = replace(block, unknowns=np.arange(n), variables=np.arange(v.shape[1]))
    return prove_block(own, linearise_block(own, v), v, np.zeros_like(v)).holds


def _starts(block: Block, guess: Array) -> Array:
    """Starts spread evenly by an additive recurrence: angles around, the rest around the guess."""
    n = len(guess)
    root = _recurrence_root(n)
    # the generalised golden ratio (Roberts): evenly spread whatever the number of starts
    steps = root ** -np.arange(1.0, n + 1.0)
    even = np.mod(0.5 + np.multiply.outer(np.arange(_STARTS), steps), 1.0)
    turns = block.system.is_angle[:n]
    size = block.system.variable_scale[:n]
    lengths = guess + _REACH * size * (2.0 * even - 1.0)
    # a plain number has no natural size: some starts near the guess, some far away
    wide = np.maximum(size, 1.0) * np.array([1.0, 30.0])[:, None]
    sizes = np.stack([size, *wide])[np.arange(_STARTS) % 3]
    numbers = guess + sizes * np.tan(np.pi * 0.99 * (even - 0.5))
    spread = numbers if _is_plain(block) else lengths
    starts: Array = np.where(turns, guess + 2.0 * np.pi * even, spread)
    return starts


def _is_plain(block: Block) -> bool:
    return block.system.is_enclosed


def _recurrence_root(n: int) -> float:
    """The root of x^(n+1) = x + 1 above 1, whose powers are badly approximable."""
    x = 2.0
    for _ in range(30):
        x = (1.0 + x) ** (1.0 / (n + 1.0))
    return x


def distance(block: Block, a: Array, b: Array) -> float:
    """How far apart two positions (n,) of a block are, weighted, modulo whole turns."""
    n = len(block.unknowns)
    gap = within_half_a_turn(b - a, block.system.is_angle[:n])
    return float(np.abs(gap / block.system.variable_scale[:n]).max(initial=0.0))
