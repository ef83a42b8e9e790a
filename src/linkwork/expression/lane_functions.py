"""The functions of formulas for numbers of many designs, with the exceptions of ``math``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from typing import Any, cast

import numpy as np

from linkwork.foundation.lanes import Lanes, many

__all__ = ["applied"]

_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sqrt": np.sqrt, "exp": np.exp, "ln": np.log, "log10": np.log10, "abs": np.abs,
    "hypot": np.hypot, "sin": np.sin, "cos": np.cos, "tan": np.tan,
    "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2,
    "min": lambda *numbers: reduce(np.minimum, numbers),
    "max": lambda *numbers: reduce(np.maximum, numbers),
}  # fmt: skip

_PARTIAL = ("sqrt", "exp", "ln", "log10", "asin", "acos")


def applied(name: str, arguments: Sequence[float]) -> float:
    """A function of numbers of which some are lanes; angles in radians.

    Raises
    ------
    ValueError, OverflowError
        Where ``math`` raises them: outside the domain; for a value that is too large.
    """
    given: list[object] = list(arguments)
    first = next(number for number in given if isinstance(number, Lanes))
    bare = [number.values if many(number) else number for number in given]
    found = np.asarray(_FUNCTIONS[name](*bare))
    if name in _PARTIAL and (wrong := ~np.isfinite(found)).any() and first.consensus.decide(wrong):
        raise OverflowError if name == "exp" else ValueError
    return cast(float, first.like(found))
