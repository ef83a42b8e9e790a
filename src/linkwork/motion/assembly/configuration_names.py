"""The order and the names of configurations."""

from __future__ import annotations

import numpy as np

from linkwork.equations.directions import DirectionForm
from linkwork.foundation.arrays import Array, BoolArray, IndexArray, StatusArray
from linkwork.numerics.block_solver import Block

__all__ = ["combined_name", "order_configurations"]

_ROUND = 1e-9  # rad: angles are ordered from 0 to a full turn, this much below counts as 0
_OF_DYADS = ("open", "crossed", "double")


def order_configurations(
    block: Block,
    form: DirectionForm,
    v: Array,
    rows: IndexArray,
    sign: StatusArray,
    double: BoolArray,
    folded: bool,
) -> tuple[list[int], dict[int, str]]:
    """The documented order of a block's configurations, and their names."""
    dyad = form.table.loops.rows == 1
    single = len(form.turning) == 0 or form.rows.shape[1] == 0 or (dyad and folded)
    turns = block.system.is_angle[: len(block.unknowns)]
    own = v[:, block.unknowns]
    # an angle that is zero but for rounding is sorted as zero, not as a full turn
    angle = np.mod(own + _ROUND, 2.0 * np.pi)
    keys: list[tuple[float, ...]] = []
    names = []
    for k, values in enumerate(np.round(np.where(turns, angle, own) / _ROUND).tolist()):
        name = "" if single else "number"
        rank = 0.0
        if dyad and not single:
            name = "double" if double[k] else "open" if _is_open(form, sign[k]) else "crossed"
            rank = float(_OF_DYADS.index(name))
        names.append(name)
        keys.append((float(rows[k]), rank, *values))
    order = sorted(range(len(v)), key=keys.__getitem__)
    labels: dict[int, str] = {}
    number = {int(row): 0 for row in rows}
    for k in order:
        number[int(rows[k])] += 1
        labels[k] = str(number[int(rows[k])]) if names[k] == "number" else names[k]
    return order, labels


def _is_open(form: DirectionForm, sign: float) -> bool:
    """Which of two configurations of a dyad is called open; ``sign`` is that of det J.

    Two links: the turn from the first one to the second, head to tail, is clockwise. A link and a
    length along a known direction: the link points towards larger lengths. A length along the
    turning link: the side of larger lengths.
    """
    length_first = len(form.sliding) > 0 and form.sliding[0] < form.turning[0]
    turned = -sign if length_first else sign
    if len(form.sliding) and form.along[0] < 0:
        return turned > 0
    return turned < 0


def combined_name(labels: tuple[str, ...], number: int) -> str:
    """The name of a configuration: ``open``, ``open-crossed``, ``configuration 3``."""
    parts = [label for label in labels if label]
    if not parts:
        return f"configuration {number}"
    if len(parts) == 1 and parts[0].isdigit():
        return f"configuration {parts[0]}"
    return "-".join(parts)
