"""Numbers from a caller: conversion to float, or an error for anything else."""

from __future__ import annotations

import math
from decimal import Decimal
from numbers import Integral, Real
from typing import Any, cast

import numpy as np

from linkwork.foundation.errors import InputError

__all__ = ["as_told", "finite_number", "plain_number", "told_beside", "whole_number"]

_LONGEST_TOLD = 40
_LARGE = 1e308  # no number below is infinite as a float


def plain_number(given: object) -> float | None:
    """A real number or an array without axes as a float; ``None`` for anything else.

    Booleans, texts and rows are not numbers; a number too large for a float is infinite.
    """
    if type(given) is float:  # most are, and abstract classes take long to ask
        return given
    if type(given) is int and -_LARGE < given < _LARGE:
        return float(given)
    if isinstance(given, np.ndarray) and given.ndim == 0:
        given = given[()]
    # True is a number for Python, and a mistake here
    if isinstance(given, bool) or not isinstance(given, Real | Decimal):
        return None
    try:
        return float(given)
    except OverflowError:
        # an integer beyond all floats: infinite, which callers refuse
        return math.inf if cast(Any, given) > 0 else -math.inf


def finite_number(what: str, given: object) -> float:
    """The float of a number.

    Raises
    ------
    InputError
        If it is not a number, or not finite; ``what`` names it in the message.
    """
    number = plain_number(given)
    if number is None or not math.isfinite(number):
        told = as_told(given if number is None else number)
        raise InputError(f"{what} must be a finite number, got {told}")
    return number


def whole_number(what: str, given: object, *, least: int = 0) -> int:
    """An integer that was given.

    Raises
    ------
    InputError
        If it is not an integer, or too small; ``what`` names it in the message.
    """
    if isinstance(given, bool) or not isinstance(given, Integral) or given < least:
        told = as_told(given)
        raise InputError(f"{what} must be a whole number, {least} or more, got {told}")
    return int(given)


def as_told(given: object) -> str:
    """A given value for a message: its ``repr``, with NumPy's numbers as plain ones, cut short."""
    told = repr(_plain(given))
    return told if len(told) <= _LONGEST_TOLD else f"{told[:_LONGEST_TOLD]}…"


def told_beside(number: float, other: float) -> str:
    """A number with so many digits, six or more, that it is told from another one."""
    digits = next((k for k in range(6, 16) if f"{number:.{k}g}" != f"{other:.{k}g}"), 6)
    return f"{number:.{digits}g}"


def _plain(given: Any) -> object:
    if isinstance(given, np.generic | np.ndarray):
        return given.tolist()
    if isinstance(given, list | tuple):
        return type(given)([_plain(part) for part in given])
    return given
