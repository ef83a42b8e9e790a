"""Lengths typed for a draft that is not a mechanism yet."""

from __future__ import annotations

from pathlib import Path

import pytest

import linkwork as lw
from linkwork.app.live import requests as ask
from linkwork.app.live.file_state import FileState
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.workbench import Workbench


@pytest.mark.parametrize("ground", ["", 'ground = ["A", "B"]'])
def test_a_length_of_a_draft_is_set_without_ground_and_between_coinciding_points(
    tmp_path: Path, ground: str
) -> None:
    path = tmp_path / "draft.toml"
    points = "A = [0, 0]\nB = [0, 0]\nC = [3, 4]" if ground else "A = [0, 0]\nB = [5, 0]"
    path.write_text(
        f'format = 1\n[points]\n{points}\n[links]\nrod = ["A", "B"]\n{ground}\n'
        '[lengths]\n"A B" = 5\n',
        encoding="utf-8",
    )
    bench = Workbench(MechanismFile(path), lw.loads)
    told = bench.handle(ask.SetNumber(name="A B", value=7.0))
    assert next(type(event).__name__ for event in told) == "FileState"
    assert '"A B" = 7' in bench.text


def test_a_formula_of_a_draft_without_value_is_told_and_can_be_undone(tmp_path: Path) -> None:
    path = tmp_path / "draft.toml"
    begun = "format = 1\n[points]\nA = [0, 0]\nB = [5, 0]\n"
    path.write_text(begun, encoding="utf-8")
    bench = Workbench(MechanismFile(path), lw.loads)
    told = bench.handle(ask.SetText(text=begun + 'rod = ["A", "B"]\n'))
    state = told[0]
    assert isinstance(state, FileState)
    assert state.text == bench.text
    assert {number.name for number in state.numbers} >= {"A.x", "B.y"}
    assert state.lacks
