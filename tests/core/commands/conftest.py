"""Mechanism files to type commands at, and two ways to run a command."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from linkwork.core.commands.main import linkwork

FOUR_BAR = """\
format = 1
name = "Four-bar"
[points]
O2 = [0, 0]
A = [35, 20]
B = [146, 66]
O4 = [100, 0]
P = [90, 90]
[links]
ground = ["O2", "O4"]
crank = ["O2", "A"]
coupler = ["A", "B", "P"]
rocker = ["O4", "B"]
[dimensions]
a = 40
[lengths]
"O2 A" = "a"
"A B" = 120
"O4 B" = 80
"O2 O4" = 100
[input]
link = "crank"
speed = "300 rpm"
[trace]
points = ["P"]
[outputs]
mu = "rocker - coupler"
"""

SLIDER_CRANK = """\
format = 1
name = "Slider-crank"
[points]
O = [0, 0]
X = [100, 0]
A = [0, 40]
B = [110, 0]
[links]
ground = ["O", "X"]
crank = ["O", "A"]
rod = ["A", "B"]
piston = ["B"]
[lengths]
"O A" = 40
"A B" = 120
[[sliders]]
name = "stroke"
link = "piston"
points = ["B"]
angle = 0
on = "ground"
line = ["O", "X"]
[input]
link = "crank"
"""

PARALLELOGRAM = """\
format = 1
name = "Parallelogram"
[points]
O2 = [0, 0]
A = [10, 17.32]
B = [40, 17.32]
O4 = [30, 0]
[links]
ground = ["O2", "O4"]
crank = ["O2", "A"]
coupler = ["A", "B"]
rocker = ["O4", "B"]
[lengths]
"O2 A" = 20
"A B" = 30
"O4 B" = 20
"O2 O4" = 30
[input]
link = "crank"
step = 30
"""

FIVE_BAR = """\
format = 1
name = "Five-bar"
[points]
O = [0, 0]
Q = [100, 0]
A = [0, 60]
B = [100, 60]
C = [50, 120]
[links]
ground = ["O", "Q"]
left = ["O", "A"]
right = ["Q", "B"]
a = ["A", "C"]
b = ["B", "C"]
[[input]]
link = "left"
from = 90
to = 100
step = 1
[[input]]
link = "right"
from = 90
to = 80
step = -1
"""

CUBIC = """\
format = 1
name = "A cubic"
[equations]
f = "x^3 - 2*x + 2 = 0"
[guess]
x = -2
"""

FILES = {
    "four-bar": FOUR_BAR,
    "double-rocker": FOUR_BAR.replace("a = 40", "a = 70"),  # 70 + 120 > 80 + 100: no full turn
    "open": FOUR_BAR.replace("a = 40", "a = 400"),
    "slider-crank": SLIDER_CRANK,
    "five-bar": FIVE_BAR,
    "parallelogram": PARALLELOGRAM,
    "cubic": CUBIC,
    "wrong": FOUR_BAR.replace('"O4 B" = 80', '"O4 B" = -80').replace('"B", "P"]', '"B", "Q"]'),
}

Run = Callable[..., Result]
Start = Callable[..., "subprocess.CompletedProcess[bytes]"]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to work in, with the files above."""
    for name, text in FILES.items():
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def run() -> Run:
    """Run a command in this process: ``run("solve", "cubic.toml")``."""

    def invoke(*words: str, stdin: str | None = None) -> Result:
        return CliRunner().invoke(linkwork, words, input=stdin, prog_name="linkwork")

    return invoke


@pytest.fixture
def environment() -> dict[str, str]:
    """The environment of a real process that finds this tree's package, with buffered output."""
    source = Path(__file__).parents[3] / "src"
    inherited = {k: v for k, v in os.environ.items() if k != "PYTHONUNBUFFERED"}
    return {**inherited, "PYTHONPATH": str(source)}


@pytest.fixture
def start(environment: dict[str, str]) -> Start:
    """Run a command as a real process."""

    def call(*words: str, stdin: bytes = b"", **changes: str) -> subprocess.CompletedProcess[bytes]:
        return subprocess.run(
            [sys.executable, "-m", "linkwork", *words],
            input=stdin,
            capture_output=True,
            env={**environment, **changes},
            timeout=60,
            check=False,
        )

    return call
