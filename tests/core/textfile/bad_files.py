"""Mechanism files that are wrong, each with its whole message: the cases of ``bad_files.txt``.

A case starts from a sample; ``- `` removes a line of it, ``+ `` adds one at the place of the last
removal (or at the end), and what follows ``---`` is the message.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tests.core.textfile.samples import SAMPLES

__all__ = ["CASES", "BadFile", "cases_in"]


@dataclass(frozen=True)
class BadFile:
    """A wrong file and what must be said about it."""

    title: str
    text: str
    message: str


def cases_in(table: str) -> list[BadFile]:
    """The cases of a table."""
    blocks = table.split("=== ")[1:]
    return [_case(*block.split("\n", 1)) for block in blocks]


def _case(title: str, body: str) -> BadFile:
    recipe, _, message = body.partition("\n---\n")
    sample, *edits = recipe.rstrip("\n").split("\n")
    lines = SAMPLES[sample].split("\n")[:-1] if sample != "nothing" else []
    at = len(lines)
    for edit in edits:
        if edit.startswith("- "):
            at = lines.index(edit[2:])
            del lines[at]
        else:
            lines.insert(at, edit[2:])
            at += 1
    text = "".join(line + "\n" for line in lines)
    return BadFile(title, text, message.rstrip("\n"))


CASES = cases_in((Path(__file__).parent / "bad_files.txt").read_text(encoding="utf-8"))
