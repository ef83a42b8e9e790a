"""Mechanisms with few rows, for tests that read workbooks cell by cell."""

from __future__ import annotations

from typing import Any

import linkwork as lw

__all__ = ["coarse"]


def coarse(mechanism: Any, steps: int) -> Any:
    """The mechanism with few steps from the first to the last row."""
    inputs = []
    for which in mechanism.description.inputs:
        number = mechanism.description.numbers
        first, last = number(which.from_ or 0), number(360 if which.to is None else which.to)
        inputs.append(lw.Input(**{**vars(which), "step": (last - first) / steps or 1}))
    return mechanism.changed(inputs=inputs)
