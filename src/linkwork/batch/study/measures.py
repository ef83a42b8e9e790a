"""Conditions that a plan sets for the motion of a design, parsed from text.

Conditions are comparisons such as ``mu >= 40`` and ``stroke(rocker) <= 60``, or the words of
:data:`WORDS`. They are matched by patterns and never evaluated as code.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.batch.family_motion import FamilyMotion
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.errors import InputError
from linkwork.foundation.status import Status
from linkwork.results.quantities.registry import Call

__all__ = ["WORDS", "Comparison", "Condition", "Measured", "Word", "read_condition"]

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

    def value(self, name: str) -> Array:
        """A number of the whole motion, (D,): ``stroke(rocker)``."""
        asked = self.motion.quantities.find_of_motion(name)
        if asked.follows:
            return self.motion.value(name)
        return self.motion.number(asked, self[asked.of.name])


@dataclass(frozen=True)
class Comparison:
    """A number of a motion compared with a bound, in file units; false without found rows."""

    reduced: Call
    sign: str
    bound: float

    def __str__(self) -> str:
        return f"{self.reduced} {self.sign} {str(self.bound).removesuffix('.0')}"

    def holds(self, measured: Measured) -> BoolArray:
        """(D,)."""
        return _SIGNS[self.sign](measured.value(str(self.reduced)), self.bound)


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


#: Conditions by name: all rows found; no row beyond a dead point; all rows proved.
WORDS: Mapping[str, Callable[[FamilyMotion], BoolArray]] = {
    "whole cycle": _whole_cycle,
    "no dead point": _no_dead_point,
    "certified": _certified,
}


Condition = Comparison | Word


def read_condition(text: str) -> Condition:
    """A condition from text: a word of :data:`WORDS`, or a comparison.

    A plain quantity is compared at every row found: ``mu >= 40`` is ``min(mu) >= 40``.

    Raises
    ------
    InputError
        If the text is not a condition.
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
        call = Call.read(left)
    else:
        # a bound holds at every row if it holds at the worst one
        call = Call("min" if parts["sign"].startswith(">") else "max", left)
    return Comparison(call, parts["sign"], _number(parts["bound"].strip(), text))


def _number(text: str, whole: str) -> float:
    try:
        bound = float(text)
    except ValueError:
        bound = math.nan
    if not math.isfinite(bound):
        raise InputError(f'"{text}" in "{whole}" must be a number, as in "mu >= 40"')
    return bound
