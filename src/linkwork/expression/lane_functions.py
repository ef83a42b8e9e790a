"""Functions of formulas on arrays of many designs, with the exceptions of ``math``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from typing import Any, cast

import numpy as np

from linkwork.foundation.lanes import Lanes

__all__ = ["FUNCTIONS", "applied"]


def least(*numbers: Any) -> Any:
    """The minimum, element by element."""
    return reduce(np.minimum, numbers)


def most(*numbers: Any) -> Any:
    """The maximum, element by element."""
    return reduce(np.maximum, numbers)


#: Functions of arrays by their name in formulas; angles in radians.
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sqrt": np.sqrt, "exp": np.exp, "ln": np.log, "log10": np.log10, "abs": np.fabs,
    "hypot": np.hypot, "sin": np.sin, "cos": np.cos, "tan": np.tan,
    "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2,
    "min": least, "max": most,
}  # fmt: skip

_PARTIAL = ("sqrt", "exp", "ln", "log10", "asin", "acos")


def applied(name: str, arguments: Sequence[float]) -> float:
    """Apply a function to numbers and lanes; angles in radians.

    Raises
    ------
    ValueError, OverflowError
        As in ``math``: outside the domain, or if the value is too large.
    """
    given: list[object] = list(arguments)
    first = next(number for number in given if isinstance(number, Lanes))
    found = first.apply(FUNCTIONS[name], *given)
    if name in _PARTIAL and not found.holds(np.isfinite):
        raise OverflowError if name == "exp" else ValueError
    return cast(float, found)
