"""Equation numbers in comments of the source are those of the page on equations."""

from __future__ import annotations

import io
import re
import tokenize
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8")
CITED = re.compile(r"eqs?\. ((?:\(\d+\)(?:, | and |-)?)+)")


def numbered() -> list[int]:
    """The numbers of the page, in its order: at the ends of lines in blocks of formulas."""
    blocks = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
    return [int(n) for block in blocks for n in re.findall(r" \((\d+)\)$", block, re.MULTILINE)]


def cited(text: str) -> set[int]:
    """The numbers that the comments of a module cite; (3)-(5) cites all between."""
    found: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            for numbers in CITED.findall(token.string):
                for low, high in re.findall(r"\((\d+)\)(?:-\((\d+)\))?", numbers):
                    found.update(range(int(low), int(high or low) + 1))
    return found


def test_numbers_of_the_page_rise_by_one() -> None:
    found = numbered()
    assert found == list(range(1, len(found) + 1))
    assert len(found) > 50


def test_comments_cite_exactly_the_equations_of_the_page() -> None:
    places: dict[int, list[str]] = {}
    for path in sorted((ROOT / "src" / "linkwork").rglob("*.py")):
        for number in cited(path.read_text(encoding="utf-8")):
            places.setdefault(number, []).append(path.name)
    known = set(numbered())
    assert {number: places[number] for number in places.keys() - known} == {}
    assert known - places.keys() == set()


def test_ranges_and_lists_of_numbers_are_read() -> None:
    assert cited("a = 1  # eq. (3)\n") == {3}
    assert cited("# eqs. (3)-(5) and (8): why\n") == {3, 4, 5, 8}
    assert cited("# eqs. (3), (7)\n") == {3, 7}
    assert cited('"""eq. (3)"""\n') == set()
