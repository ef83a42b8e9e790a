"""Linear systems of stacked matrices, some of which may be singular."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray

__all__ = ["inverses", "solutions"]

Numbers = TypeVar("Numbers", Array, ComplexArray)


def solutions(matrices: Numbers, right: Numbers) -> Numbers:
    """X with A X = B for stacked (B, n, n) and (B, n, k); NaN where a matrix is singular."""
    found: Numbers = _each(np.linalg.solve, matrices, right)
    return found


def inverses(matrices: Numbers) -> Numbers:
    """The inverses of stacked matrices (B, n, n); NaN where one is singular."""
    found: Numbers = _each(np.linalg.inv, matrices)
    return found


def _each(function: Callable[..., Any], *stacks: Any) -> Any:
    try:
        return function(*stacks)
    except np.linalg.LinAlgError:
        # one singular matrix makes NumPy refuse all: the others are solved one by one
        found = np.full(stacks[-1].shape, np.nan, dtype=stacks[-1].dtype)
        for k, own in enumerate(zip(*stacks, strict=True)):
            with suppress(np.linalg.LinAlgError):
                found[k] = function(*own)
        return found
