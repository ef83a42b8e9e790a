"""Files with thousands of mistakes: as many problems as there are mistakes."""

from __future__ import annotations

import pytest

import linkwork as lw
from linkwork.core.foundation.errors import choices

FRAME = """\
format = 1
[points]
O = [0, 0]
A = [1, 0]
B = [2, 1]
C = [3, 0]
[links]
ground = ["O", "C"]
crank = ["O", "A"]
rocker = ["C", "B"]
"""
INPUT = '[input]\nlink = "crank"\n'
COUNT = 1000


def test_links_between_the_same_points_are_one_problem() -> None:
    bars = "".join(f'bar{k} = ["A", "B"]\n' for k in range(COUNT))
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(FRAME + bars + INPUT)
    (problem,) = caught.value.problems
    assert problem.key == ("links", "bar1")
    assert problem.message == (
        f'shares A and B with "bar0" and {COUNT - 2} more: they move as one body: '
        "make one link of A, B"
    )


def test_wrong_names_are_compared_with_names_that_begin_alike(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    compared = []

    def count(wanted: str, names: list[str], n: int) -> list[str]:
        compared.append(len(names))
        return names[-1:]

    monkeypatch.setattr("linkwork.core.foundation.errors.get_close_matches", count)
    names = [f"P{k}" for k in range(COUNT)] + ["crank"]
    assert choices("links", names, "crnk").startswith("(links: crank, P0, ")
    choices("points", names, "P1x")
    assert max(compared) <= 100
