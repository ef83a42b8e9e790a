"""A question about a mechanism, whose answer is hidden on a page until it is asked for."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from linkwork.foundation.internal import internal
from linkwork.foundation.value_types import check_values

__all__ = ["HIDDEN", "LIMITS", "Question"]

#: The answers that are places of the input, and the kinds of limits there.
LIMITS = {"dead points": "DEAD_POINT", "change points": "CHANGE_POINT"}

#: What a question can hide on a page.
HIDDEN = ("numbers", "charts", "limits", "input", "equations")


@internal("problems", "given")
@dataclass(frozen=True, kw_only=True)
class Question:
    """A question with an answer that is computed, or a number that is given.

    Parameters
    ----------
    text : str
        The question.
    answer : str or float
        ``"dead points"`` or ``"change points"``: input values, any one of which is right; a number
        of the whole motion, ``"stroke(rocker)"``; with ``at`` a quantity of a row, ``"mu"``; or the
        number itself, in ``unit``.
    tolerance : float
        How far an answer may be from the right one, in the unit of the answer.
    at : float, optional
        The value of the leading input, in file units, at which ``answer`` is asked.
    unit : str
        The unit of an answer that is given.
    hide : tuple of str
        What the page hides until the question is answered: ``numbers`` of the position and the
        motion, ``charts``, ``limits`` (marks and sentences about dead points), the ``input``'s
        value, ``equations``.

    Examples
    --------
    >>> import linkwork as lw
    >>> ask = lw.Question(text="How far does it turn?", answer="stroke(rocker)", tolerance=1)
    >>> lw.example("four-bar").changed(questions=[ask]).sweep().skeleton.questions[0].answer
    'stroke(rocker)'
    """

    text: str
    answer: str | float
    tolerance: float
    at: float | None = None
    unit: str = ""
    hide: tuple[str, ...] = HIDDEN[:4]

    def __post_init__(self) -> None:
        check_values(self)

    @property
    def given(self) -> bool:
        """Whether the answer is a number in the file."""
        return not isinstance(self.answer, str)

    def problems(self) -> Iterator[tuple[str, str]]:
        """Keys and messages of what is wrong, without regard to the mechanism."""
        if not self.text.strip():
            yield "text", "is empty: write the question"
        if not 0 < self.tolerance < math.inf:
            yield "tolerance", "must be a positive number, in the unit of the answer"
        known = ", ".join(f'"{word}"' for word in HIDDEN)
        for word in self.hide:
            if word not in HIDDEN:
                yield "hide", f'"{word}" cannot be hidden (known: {known})'
        placed = not self.given and self.answer not in LIMITS
        if self.at is not None and not placed:
            yield "at", "has no effect: it is for a quantity that differs from row to row"
        if self.unit and not self.given:
            yield "unit", "has no effect: a computed answer has the unit of its quantity"
