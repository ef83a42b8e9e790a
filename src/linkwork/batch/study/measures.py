"""Reductions and conditions of a plan, parsed from text.

``stroke(rocker)`` is one number per design; ``mu >= 40`` and ``stroke(rocker) <= 60`` are true or
false of it, as are the words of :data:`WORDS`. They are read by two patterns and never evaluated
as code.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.batch.family_motion import FamilyMotion
from linkwork.batch.reductions import REDUCTIONS
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.errors import InputError, choices
from linkwork.foundation.status import Status

__all__ = ["WORDS", "Comparison", "Condition", "Measured", "Reduced", "Word", "read_condition"]

_CALL = re.compile(r"\s*(\w+)\s*\(\s*([^()<>=]*[^()<>=\s])\s*\)\s*")
_COMPARISON = re.compile(r"(?P<left>[^<>=]+)(?P<sign>>=|<=|>|<)(?P<bound>[^<>=]+)")
_SIGNS: Mapping[str, Callable[[Array, float], BoolArray]] = {
    ">=": np.greater_equal,
    "<=": np.less_equal,
    ">": np.greater,
    "<": np.less,
}


class Measured:
    """The quantities of a motion, each computed once.

    Parameters
    ----------
    motion : FamilyMotion
        D designs over R rows.
    """

    def __init__(self, motion: FamilyMotion) -> None:
        self.motion = motion
        self._values: dict[str, Array] = {}

    def __getitem__(self, name: str) -> Array:
        """A quantity, (D, R), in file units."""
        if name not in self._values:
            self._values[name] = self.motion[name]
        return self._values[name]


@dataclass(frozen=True)
class Reduced:
    """One number per design of a quantity's values at the rows found: ``stroke(rocker)``."""

    take: str
    of: str

    @classmethod
    def read(cls, text: str) -> Reduced:
        """From text.

        Raises
        ------
        InputError
            If it is none.
        """
        call = _CALL.fullmatch(text)
        if call is None:
            raise InputError(
                f'must be a reduction of a quantity, as in "stroke(rocker)", got "{text}" '
                f"{choices('reductions', REDUCTIONS)}"
            )
        if call[1] not in REDUCTIONS:
            raise InputError(
                f'there is no reduction "{call[1]}" {choices("reductions", REDUCTIONS, call[1])}'
            )
        return cls(call[1], call[2])

    def __str__(self) -> str:
        return f"{self.take}({self.of})"

    def values(self, measured: Measured) -> Array:
        """(D,), NaN where no row is found."""
        return REDUCTIONS[self.take](measured[self.of])


@dataclass(frozen=True)
class Comparison:
    """A reduction against a number, in file units; false where no row is found."""

    reduced: Reduced
    sign: str
    bound: float

    @property
    def quantity(self) -> str:
        """What is compared."""
        return self.reduced.of

    def __str__(self) -> str:
        return f"{self.reduced} {self.sign} {str(self.bound).removesuffix('.0')}"

    def holds(self, measured: Measured) -> BoolArray:
        """(D,)."""
        return _SIGNS[self.sign](self.reduced.values(measured), self.bound)


@dataclass(frozen=True)
class Word:
    """A condition on the rows of a design; one of :data:`WORDS`."""

    word: str

    def __str__(self) -> str:
        return self.word

    def holds(self, measured: Measured) -> BoolArray:
        """(D,)."""
        return WORDS[self.word](measured.motion)


def _whole_cycle(motion: FamilyMotion) -> BoolArray:
    return np.asarray(motion.found.all(axis=1))


def _no_dead_point(motion: FamilyMotion) -> BoolArray:
    beyond = [Status.OUT_OF_REACH.code, Status.OUT_OF_CIRCUIT.code]
    stopped = np.isin(motion.status, beyond).any(axis=1)
    return np.asarray(motion.found.any(axis=1) & ~stopped)


def _certified(motion: FamilyMotion) -> BoolArray:
    return np.asarray(motion.certified.all(axis=1))


#: Conditions by name: every row is found; no row lies beyond a dead point; every row is proved.
WORDS: Mapping[str, Callable[[FamilyMotion], BoolArray]] = {
    "whole cycle": _whole_cycle,
    "no dead point": _no_dead_point,
    "certified": _certified,
}


Condition = Comparison | Word


def read_condition(text: str) -> Condition:
    """A condition from text: a word of :data:`WORDS`, or a comparison.

    A quantity by itself is compared at every row found: ``mu >= 40`` is ``min(mu) >= 40``.

    Raises
    ------
    InputError
        If it is none.
    """
    folded = " ".join(text.split())
    if folded in WORDS:
        return Word(folded)
    parts = _COMPARISON.fullmatch(folded)
    if parts is None:
        known = ", ".join(f'"{word}"' for word in WORDS)
        raise InputError(
            f'must be {known} or a comparison such as "mu >= 40" or "stroke(rocker) <= 60", '
            f'got "{text}"'
        )
    left = parts["left"].strip()
    if "(" in left:
        reduced = Reduced.read(left)
    else:
        reduced = Reduced("min" if parts["sign"].startswith(">") else "max", left)
    return Comparison(reduced, parts["sign"], _number(parts["bound"].strip(), text))


def _number(text: str, whole: str) -> float:
    try:
        bound = float(text)
    except ValueError:
        bound = math.nan
    if not math.isfinite(bound):
        raise InputError(f'"{text}" in "{whole}" must be a number, as in "mu >= 40"')
    return bound
