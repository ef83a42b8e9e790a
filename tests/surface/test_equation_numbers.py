"""Equation numbers in comments of the source are those of the page on equations."""

from __future__ import annotations

import io
import itertools
import re
import tokenize
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8")
CITED = re.compile(r"eqs?\. ((?:\(\d+[a-z]?\)(?:, | and |-)?)+)")

#: A number with its letter, if any: an equation added after (58) is (58a).
Label = tuple[int, str]


def label(text: str) -> Label:
    return int(text.rstrip("abcdefghijklmnopqrstuvwxyz")), text.lstrip("0123456789")


def numbered(page: str) -> list[Label]:
    """The labels of a page, in its order: at the ends of lines in blocks of formulas."""
    blocks = re.findall(r"```text\n(.*?)```", page, re.DOTALL)
    return [
        label(n) for block in blocks for n in re.findall(r" \((\d+[a-z]?)\)$", block, re.MULTILINE)
    ]


def ascends(labels: Sequence[Label]) -> bool:
    """Whether every label is greater than the one before; numbers may be left out."""
    return all(one < other for one, other in itertools.pairwise(labels))


def cited(text: str, page: Sequence[Label] = ()) -> set[Label]:
    """The labels that the comments of a module cite; (3)-(5) cites all of a page between."""
    found: set[Label] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            for numbers in CITED.findall(token.string):
                for low, high in re.findall(r"\((\w+)\)(?:-\((\w+)\))?", numbers):
                    first, last = label(low), label(high or low)
                    found |= {first, last, *(own for own in page if first <= own <= last)}
    return found


def test_numbers_of_the_page_ascend() -> None:
    found = numbered(PAGE)
    assert ascends(found)
    assert len(found) > 50


def test_comments_cite_exactly_the_equations_of_the_page() -> None:
    page = numbered(PAGE)
    places: dict[Label, list[str]] = {}
    for path in sorted((ROOT / "src" / "linkwork").rglob("*.py")):
        for number in cited(path.read_text(encoding="utf-8"), page):
            places.setdefault(number, []).append(path.name)
    known = set(page)
    assert {number: places[number] for number in places.keys() - known} == {}
    assert known - places.keys() == set()


def test_ranges_and_lists_of_numbers_are_read() -> None:
    page = [(k, "") for k in range(1, 9)]
    assert cited("a = 1  # eq. (3)\n") == {(3, "")}
    assert cited("# eqs. (3)-(5) and (8): why\n", page) == {(k, "") for k in (3, 4, 5, 8)}
    assert cited("# eqs. (3), (7)\n") == {(3, ""), (7, "")}
    assert cited('"""eq. (3)"""\n') == set()


def test_an_added_equation_has_a_letter_and_a_double_one_is_seen() -> None:
    page = numbered("```text\na = b   (3)\nb = c   (3a)\nc = d   (5)\n```\n")
    assert page == [(3, ""), (3, "a"), (5, "")]
    assert cited("# eqs. (3)-(5)\n", page) == set(page)
    assert cited("# eq. (3a)\n") == {(3, "a")}
    assert ascends(page)
    assert not ascends([*page, (5, "")])
    assert not ascends([*page, (4, "")])
