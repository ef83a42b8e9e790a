"""Lengths typed for a draft that is not a mechanism yet."""

from __future__ import annotations

from pathlib import Path

import pytest

import linkwork as lw
from linkwork.viewer.live import requests as ask
from linkwork.viewer.live.mechanism_file import MechanismFile
from linkwork.viewer.live.workbench import Workbench


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
