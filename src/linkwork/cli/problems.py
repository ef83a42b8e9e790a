"""Error messages as lines for a terminal."""

from __future__ import annotations

from typing import Any

from linkwork.cli.terminal import wrapped
from linkwork.foundation.errors import LinkworkError, MechanismError, Problem, key_text

__all__ = ["problem_data", "problem_lines"]

_WIDEST_KEY = 28  # longer keys are printed on a separate line
_FORMULA = "    "  # lines with this indent are formulas with a caret below, never wrapped


def problem_lines(error: LinkworkError) -> list[str]:
    """The message of an error in lines that fit the terminal; formulas keep their shape."""
    first, *rest = str(error).split("\n")
    lines = wrapped(first, "Error: ", "  ")
    if isinstance(error, MechanismError):
        return [*lines, *_listed(error.problems)]
    return lines + [line for text in rest for line in _wrapped_or_formula(text, "  ")]


def problem_data(error: LinkworkError) -> dict[str, Any]:
    """The message of an error for JSON; every problem of a file with its line and key."""
    if not isinstance(error, MechanismError):
        return {"error": str(error)}
    problems = [
        {"line": p.line, "key": key_text(p.key), "message": p.message} for p in error.problems
    ]
    return {"error": str(error), "problems": problems}


def _listed(problems: tuple[Problem, ...]) -> list[str]:
    """Line, key and message of every problem, in columns."""
    places = ["" if p.line is None else f"line {p.line}" for p in problems]
    keys = [key_text(p.key) for p in problems]
    place_width = max(map(len, places), default=0)
    key_width = max((len(key) for key in keys if len(key) <= _WIDEST_KEY), default=0)
    lines: list[str] = []
    for place, key, problem in zip(places, keys, problems, strict=True):
        head = f"  {place:<{place_width}}  " if place_width else "  "
        below = " " * (len(head) + (key_width + 2 if key_width else 0))
        message, *rest = problem.message.split("\n")
        # a long key has its own line instead of widening the column
        if len(key) > key_width:
            lines += [head + key, *wrapped(message, below)]
        else:
            lines += wrapped(message, f"{head}{key:<{key_width}}  " if key_width else head, below)
        for text in rest:
            lines += _wrapped_or_formula(text, below)
    return lines


def _wrapped_or_formula(text: str, indent: str) -> list[str]:
    return [text] if text.startswith(_FORMULA) else wrapped(text, indent)
