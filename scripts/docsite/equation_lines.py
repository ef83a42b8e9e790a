"""Numbered equations of the page that has them all, to be shown on other pages."""

from __future__ import annotations

import re
import textwrap

__all__ = ["equation_lines"]

_BLOCK = re.compile(r"```text\n(.*?)```", re.DOTALL)
_NUMBER = re.compile(r" \((\d+[a-z]?)\)$")


def equation_lines(page: str, asked: str) -> str:
    """The lines of the equations with these numbers: ``"1, 25-27"``.

    Raises
    ------
    LookupError
        If the page has no equation of such a number.
    """
    known = dict(_numbered(page))
    names = list(known)
    shown: list[str] = []
    for part in asked.replace(" ", "").split(","):
        first, _, last = part.partition("-")
        if not {first, last or first} <= set(names):
            raise LookupError(f"there is no equation ({part}) on the page of equations")
        own = names[names.index(first) : names.index(last or first) + 1]
        shown += [known[name] for name in own]
    return "\n".join(shown)


def _numbered(page: str) -> list[tuple[str, str]]:
    """Numbers with the lines that end with them, continued lines included."""
    found: list[tuple[str, str]] = []
    for block in _BLOCK.findall(page):
        lines: list[str] = []
        for line in block.splitlines():
            lines.append(line)
            number = _NUMBER.search(line)
            if number:
                found.append((number[1], textwrap.dedent("\n".join(lines))))
                lines = []
        if lines and found:  # what follows a number belongs to its equation
            number_, text = found[-1]
            found[-1] = (number_, "\n".join([text, *lines]))
    return found
