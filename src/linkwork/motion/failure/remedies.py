"""Changes of single lengths with which the loops just close."""

from __future__ import annotations

from functools import cache

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.motion.failure.dyads import dyad_of
from linkwork.motion.failure.lengths import ChangeableLength, lengths_of, model_with
from linkwork.motion.model import Model
from linkwork.numerics.continuation.fold import FoldFamily, locate_fold
from linkwork.numerics.joined_blocks import JoinedBlocks, closure_of
from linkwork.results.failure import Remedy

__all__ = ["remedies_of"]

_MOST_LENGTHS = 40
_MOST_UNKNOWNS = 80
_STEP = 1e-6  # of the longest link, for derivatives by a length
_ROUND = 4e-15  # of the longest link: a length this near to a short decimal number is that number


def remedies_of(model: Model, number: int, v: Array) -> tuple[Remedy, ...]:
    """The lengths that alone would let a block just close, smallest change first.

    Parameters
    ----------
    number : int
        The block that cannot be closed.
    v : (N,)
        With the earlier blocks solved, and this block as near to closure as possible.

    Notes
    -----
    The block and those it depends on are one family of systems with the length as parameter; the
    value with which they just close is a fold of that family.
    """
    solver = model.compiled.solver
    members = closure_of(solver, number)
    joined = JoinedBlocks(solver, members)
    if joined.unknowns > _MOST_UNKNOWNS:
        return ()
    exact = all(
        len(solver.blocks[k].unknowns) == 1 or dyad_of(solver.blocks[k], v) for k in members
    )
    found = []
    for length in lengths_of(model.description)[:_MOST_LENGTHS]:
        needed = _needed(model, length, members, v)
        if needed is not None:
            remedy = Remedy(length=length.name, now=length.value, needed=needed, exact=bool(exact))
            found.append(remedy)
    return tuple(sorted(found, key=lambda r: float(f"{abs(r.change):.9e}")))


def _needed(model: Model, length: ChangeableLength, members: list[int], v: Array) -> float | None:
    """The value of one length with which the blocks just close, if there is one."""
    solver = model.compiled.solver
    own = [solver.blocks[k].equations for k in members]
    joined = JoinedBlocks(solver, members)
    n, size = joined.unknowns, model.equations.length_scale

    @cache
    def at(p: float) -> JoinedBlocks:
        changed = model_with(length, p)
        if changed is None:
            raise ValueError(f"no mechanism has {length.name} = {p}")
        blocks = changed.compiled.solver.blocks
        # with another topology the unknowns would not correspond
        if [blocks[k].equations for k in members] != own:
            raise ValueError(f"other blocks with {length.name} = {p}")
        return JoinedBlocks(changed.compiled.solver, members)

    step = _STEP * size
    try:
        family = FoldFamily(
            at=at,
            inputs=v[solver.unknowns :],
            low=at(length.value - step),
            high=at(length.value + step),
            step=2.0 * step,
            size=size,
        )
    except (ValueError, IndexError):
        return None
    fold = locate_fold(family, v[joined.order[:n]], length.value)
    # a fold without a solution next to it would be no remedy
    if fold is None or not fold.checked or (fold.p <= 0.0 and not length.signed):
        return None
    # a special value, such as the sum of two lengths, is meant exactly
    short = float(np.round(fold.p, 9))
    return short if abs(short - fold.p) <= _ROUND * size else fold.p
