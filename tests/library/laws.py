"""Every mechanism of the library has a law: the register of them, and what they share."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TypeVar

import numpy as np
import numpy.typing as npt

import linkwork as lw

__all__ = ["LAWS", "degrees", "law", "motion_of", "same"]

Test = TypeVar("Test", bound=Callable[..., None])

#: Name of a library file → the tests that state its laws.
LAWS: dict[str, list[Callable[..., None]]] = {}


def law(*names: str) -> Callable[[Test], Test]:
    """Mark a test as stating a law of these library files.

    The first line of its docstring is the law, as the gallery prints it.
    """

    def register(test: Test) -> Test:
        for name in names:
            LAWS.setdefault(name, []).append(test)
        return test

    return register


@cache
def motion_of(name: str) -> lw.Motion:
    """The sweep that the file asks for."""
    return lw.example(name).sweep()


def degrees(motion: lw.Motion, name: str) -> npt.NDArray[np.float64]:
    """A column of angles given in degrees, in radians."""
    return np.radians(motion[name])


def same(found: npt.ArrayLike, expected: npt.ArrayLike, size: float, within: float = 1e-12) -> None:
    """Both agree to a part of the mechanism's size; a missing row agrees with nothing."""
    difference = np.max(np.abs(np.asarray(found) - np.asarray(expected)))
    assert difference <= within * size, f"{difference / size:.2e} of the size"
