"""Harmonics of a quantity over a turn."""

from __future__ import annotations

import numpy as np

from linkwork.design.whole_turn import whole_turn
from linkwork.foundation.errors import InputError
from linkwork.motion.model import Model
from linkwork.results.machine_design import Harmonics
from linkwork.results.motion import Motion

__all__ = ["harmonics"]


def harmonics(model: Model, motion: Motion, of: str, count: int = 8) -> Harmonics:
    """The Fourier sum of a quantity over one turn of the input.

    Its coefficients are integrals, to rounding also of quantities that jump between rows.

    Raises
    ------
    UnknownNameError, InputError
        If there is no such quantity or no whole turn, or its rows are too few.
    """
    turn = whole_turn(model, motion, of)
    rows = len(turn.value) - 1
    if not 1 <= count < rows / 2.0:
        raise InputError(f"{rows} rows of a turn give from 1 to {(rows - 1) // 2} harmonics")
    orders = np.arange(1, count + 1)
    # eq. (79)
    parts = 2.0 * np.array([turn.curve.wave(order) for order in orders.tolist()])
    mean = turn.curve.mean()
    waves = np.exp(1j * orders[:, None] * turn.place[None, :-1])
    total = mean + (parts[:, None] * waves).real.sum(axis=0)
    period = 360.0 / orders
    return Harmonics(
        of=of,
        unit=motion.table(of).units[of],
        mean=mean,
        amplitude=np.abs(parts),
        phase=np.mod(np.degrees(np.angle(parts.conj())) / orders, period),
        rest=float(np.max(np.abs(turn.value[:-1] - total))),
    )
