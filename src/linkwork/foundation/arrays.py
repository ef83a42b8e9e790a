"""Type names for NumPy arrays by their contents.

Importing ``numpy.typing`` costs a quarter of importing NumPy, so only type checkers do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from typing import Any

    import numpy.typing as npt

    AnyArray = npt.NDArray[Any]
    Array = npt.NDArray[np.float64]
    BoolArray = npt.NDArray[np.bool_]
    ComplexArray = npt.NDArray[np.complex128]
    CountArray = npt.NDArray[np.int64]
    IndexArray = npt.NDArray[np.intp]
    StatusArray = npt.NDArray[np.int8]
    TurnArray = npt.NDArray[np.int32]
else:
    AnyArray = Array = BoolArray = ComplexArray = np.ndarray
    CountArray = IndexArray = StatusArray = TurnArray = np.ndarray

__all__ = [
    "AnyArray",
    "Array",
    "BoolArray",
    "ComplexArray",
    "CountArray",
    "IndexArray",
    "StatusArray",
    "TurnArray",
]
