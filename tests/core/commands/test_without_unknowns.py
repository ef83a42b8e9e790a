"""Mechanisms whose positions follow from their inputs directly: every command answers."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from linkwork.core.commands.main import linkwork

BAR = """\
format = 1
[points]
O = [0, 0]
A = [3, 4]
[links]
ground = ["O"]
bar = ["O", "A"]
[masses]
bar = { mass = 2, shape = "rod" }
[input]
link = "bar"
from = 0
to = 90
step = 10
"""
BLOCK = """\
format = 1
[points]
O = [0, 0]
C = [60, 0]
A = [30, 0]
[links]
ground = ["O", "C"]
block = ["A"]
[[sliders]]
name = "s"
link = "block"
points = ["A"]
on = "ground"
line = ["O", "C"]
[input]
slider = "s"
from = 10
to = 50
step = 4
"""
COMMANDS = [
    "check", "equations", "equations --latex", "equations --derivation", "solve", "quantities",
    "sweep", "sweep --limits-of A.x", "sweep --csv - --xlsx a.xlsx --draw a.svg --plot b.svg",
    "configurations", "circuits", "circuits --draw a.svg", "sensitivity --of A.x",
    "draw -o a.svg", "plot -o a.svg", "plot -o a.svg --kind branches",
    "plot -o a.svg --kind circuits",
    "animate -o a.html", "export -o a.c", "export pmks", "export -o a.urdf",
    "export report -o a.html", "export -o a.md", "export plates -o a.svg", "link",
]  # fmt: skip


def _run(text: str, command: str) -> str:
    Path("bar.toml").write_text(text, encoding="utf-8")
    name, dash, rest = command.partition(" -")
    options = f"{dash}{rest}".split()
    ended = CliRunner().invoke(linkwork, [*name.split(), "bar.toml", *options])
    assert ended.exit_code == 0, ended.output
    return ended.output


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("text", [BAR, BLOCK], ids=["bar", "block"])
def test_every_command_answers_without_unknowns(
    text: str, command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    _run(text, command)


def test_what_moves_is_shown_where_nothing_else_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shown = _run(BAR, "sweep").split("range", 1)[1].split("For the table")[0]
    assert shown == (
        " of rows  minimum  at  maximum  at  unit\n"
        "  A.x            0.00000  90  5.00000   0  mm\n"
        "  A.y            0.00000   0  5.00000  90  mm\n\n"
    )
    assert _run(BAR, "equations").endswith(
        "unknowns  none: all positions follow from the inputs\n"
        "inputs    θ_bar (angle)\nwith      OA = 5\n"
    )
