"""Check that a mechanism has the quantities that its questions ask for."""

from __future__ import annotations

from linkwork.foundation.errors import InputError, Problem
from linkwork.mechanism.question import LIMITS, Question
from linkwork.results.quantities.registry import Quantities

__all__ = ["question_problems"]


def question_problems(questions: tuple[Question, ...], known: Quantities) -> list[Problem]:
    """The questions whose answers the mechanism does not have."""
    found = ((k, _trouble(question, known)) for k, question in enumerate(questions))
    return [Problem(key=("questions", k, "answer"), message=text) for k, text in found if text]


def _trouble(question: Question, known: Quantities) -> str:
    answer = question.answer
    if not isinstance(answer, str) or answer in LIMITS:
        return ""
    try:
        (known.find_of_motion if question.at is None else known.find)(answer)
    except InputError as error:
        if question.at is None and _is_of_rows(answer, known):
            return (
                f'"{answer}" differs from row to row: add the input, at = 90, or ask for a number '
                f'of the whole motion, "max({answer})"'
            )
        words = " or ".join(f'"{word}"' for word in LIMITS)
        return f"{error}; or ask for {words}"
    return ""


def _is_of_rows(name: str, known: Quantities) -> bool:
    try:
        known.find(name)
    except InputError:
        return False
    return True
