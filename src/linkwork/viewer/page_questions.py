"""The questions of a page, and their answers by a motion."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from linkwork.foundation.errors import InputError
from linkwork.mechanism.question import LIMITS, Question
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind
from linkwork.viewer.page_data import AnswerData, QuestionData

__all__ = ["answers_of", "questions_of"]

_ONE_ROW = 1e-9  # of the larger number: input values that are one row


def questions_of(motion: Motion) -> Iterator[QuestionData]:
    """The questions of the mechanism; units are the same in all of its motions."""
    for question in motion.skeleton.questions:
        unit, turns = _measure(motion, question)
        yield QuestionData(
            text=question.text,
            unit=unit,
            tolerance=float(question.tolerance),
            turn=motion.units.angle.turn if turns else 0.0,
            hide=question.hide,
        )


def _measure(motion: Motion, question: Question) -> tuple[str, bool]:
    """The unit of the answer, and whether a whole turn more is the same."""
    answer = question.answer
    if not isinstance(answer, str):
        return question.unit, False
    try:
        if answer in LIMITS:
            unit = motion.input_units[next(iter(motion.inputs))]
            return unit, unit == motion.units.angle.value
        if question.at is None:
            return motion.quantities.find_of_motion(answer).unit, False
        asked = motion.quantity(answer)
    except InputError:  # such as a rate by time without a speed
        return "", False
    return asked.unit, asked.rate is None and asked.own.kind is Kind.ANGLE


def answers_of(motion: Motion) -> Iterator[AnswerData]:
    """The right answers, any one of which will do; unknown where no position gives them, or a limit
    is only nearly located.
    """
    for question in motion.skeleton.questions:
        values = _values(motion, question)
        known = all(map(math.isfinite, values)) and (bool(values) or question.answer in LIMITS)
        yield AnswerData(known=known, values=values if known else ())


def _values(motion: Motion, question: Question) -> tuple[float, ...]:
    answer = question.answer
    if not isinstance(answer, str):
        return (float(answer),)
    if answer in LIMITS:
        found = (limit for limit in motion.limits if limit.kind.name == LIMITS[answer])
        return tuple(limit.input if limit.located else math.nan for limit in found)
    try:
        if question.at is None:
            return (motion.value(answer),)
        lead = motion.inputs[next(iter(motion.inputs))]
        off = np.where(motion.found, np.abs(lead - question.at), np.inf)
        row = int(off.argmin())
        there = off[row] <= _ONE_ROW * max(1.0, abs(question.at))
        return (float(motion[answer][row]),) if there else ()
    except InputError:
        return ()
