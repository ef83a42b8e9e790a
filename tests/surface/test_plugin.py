"""A package outside adds a wing: a command, a quantity and a writer."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

PLUGIN = Path(__file__).parents[2] / "examples" / "plugin"


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which the example is installed."""
    folder = tmp_path_factory.mktemp("plugin")
    command = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--target", str(folder)]
    subprocess.run([*command, str(PLUGIN)], check=True, capture_output=True)
    return folder


def run(installed: Path, *words: str) -> str:
    paths = os.pathsep.join([str(installed), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, *words],
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


def test_its_command_is_listed_and_runs(installed: Path) -> None:
    assert "Speeds of points:\n  fastest  Show where" in run(installed, "-m", "linkwork", "--help")
    told = run(installed, "-m", "linkwork", "fastest", "four-bar", "A")
    assert told.startswith("A moves 40 per radian")


def test_its_quantity_and_its_writer_are_those_of_every_mechanism(
    installed: Path, tmp_path: Path
) -> None:
    path = tmp_path / "speeds.csv"
    code = (
        "import linkwork as lw\n"
        "bar = lw.example('four-bar')\n"
        "print(round(bar.sweep(step=90).value('max(A.speed)'), 9))\n"
        f"bar.write({str(path)!r}, 'speeds')"
    )
    assert run(installed, "-c", code) == "40.0\n"
    head, first = path.read_text().splitlines()[:2]
    assert head == "crank,A.speed,B.speed,status"
    assert float(first.split(",")[1]) == pytest.approx(40.0)
