"""The first input of a table that moves, and the rates of the other inputs with respect to it."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array

__all__ = ["leading_input"]


def leading_input(rows: Array) -> tuple[int, Array]:
    """The leading input, and the rate of every input with respect to it.

    Parameters
    ----------
    rows : (rows, p)
        The table of input values.

    Returns
    -------
    lead : int
        The first input that changes from row to row, 0 if none does.
    rate : (p,)
        1 for the leading input.
    """
    inputs = rows.shape[1]
    # from end to end, so that the rounding of one step is not multiplied by their number
    changes = rows[-1] - rows[0] if len(rows) > 1 else np.zeros(inputs)
    moving = np.flatnonzero(changes)
    if not len(moving):
        return 0, np.eye(1, inputs)[0]
    lead = int(moving[0])
    return lead, changes / changes[lead]
