"""The mechanism files of the README."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import linkwork as lw

_README = Path(__file__).resolve().parents[2] / "README.md"


def test_both_mechanism_files_of_the_readme_are_the_same_four_bar() -> None:
    blocks = re.findall(r"```toml\n(.*?)```", _README.read_text(encoding="utf-8"), re.DOTALL)
    drawn, written = (lw.loads(block).sweep(start=0, stop=360, step=30) for block in blocks)
    assert drawn.certified.all()
    assert written.certified.all()
    assert drawn["rocker"] == pytest.approx(written["θ4"], abs=1e-9)
