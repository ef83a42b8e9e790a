"""Lengths along a turning direction that nothing else depends on: two solutions, one assembly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.kernels.phasor_rows import PhasorRows
from linkwork.motion.model import Model

__all__ = ["TurnedSlide", "turned_slides"]


@dataclass(frozen=True, kw_only=True)
class TurnedSlide:
    """An unknown angle that only directs these unknown lengths.

    (s, θ) and (-s, θ + π) are then the same assembly: no loop and no point distinguishes them.
    """

    angle: int
    lengths: tuple[int, ...]


def turned_slides(model: Model) -> tuple[TurnedSlide, ...]:
    """All of them, by block: a pair has to be solved together."""
    table = model.compiled.table
    tables = (table.loops, model.compiled.points.rows)
    tied = set(table.linear.variable.tolist())
    found = []
    for block in model.compiled.solver.blocks:
        own = set(block.unknowns.tolist())
        # an angle in a linear row determines other angles: turning it around moves them
        for angle in sorted(own - tied):
            if table.is_angle[angle]:
                lengths = _directed(tables, angle)
                if lengths and lengths <= own:
                    found.append(TurnedSlide(angle=angle, lengths=tuple(sorted(lengths))))
    return tuple(found)


def _directed(tables: tuple[PhasorRows, ...], angle: int) -> set[int]:
    """The lengths along an angle, if all its terms have one of them, and no other term has."""
    lengths: set[int] = set()
    for rows in tables:
        mine = _terms_with(rows, angle)
        if mine is None:
            return set()
        lengths |= {int(rows.length[t]) for t in mine}
    if -1 in lengths:
        return set()
    for rows in tables:
        mine = _terms_with(rows, angle) or set()
        using = {t for t, j in enumerate(rows.length) if int(j) in lengths}
        if using != mine:
            return set()
    return lengths


def _terms_with(rows: PhasorRows, angle: int) -> set[int] | None:
    """The terms that turn once with an angle; None if one turns otherwise."""
    entries = np.flatnonzero(rows.phase_variable == angle)
    if (np.abs(rows.phase_weight[entries]) != 1.0).any():
        return None
    return set(rows.phase_term[entries].tolist())
