"""Mechanisms from and for other programs, in the terminal."""

from __future__ import annotations

import json
from pathlib import Path

import linkwork as lw
from tests.core.commands.conftest import Run
from tests.readers.samples import SAMPLES


def test_an_import_says_what_is_carried_and_what_is_not(run: Run, tmp_path: Path) -> None:
    Path("bar.dxf").write_bytes(SAMPLES["bar.dxf"])
    done = run("import", "bar.dxf", "-o", "bar.toml")
    assert done.exit_code == 0
    assert done.stdout.splitlines() == [
        "bar",
        "DXF sketch: 5 points, 4 links, 1 input",
        "  left out: line 109: line with an end at no circle",
        "  left out: line 121: entity TEXT",
        "Wrote bar.toml.",
    ]
    assert lw.load("bar.toml").sweep(step=90).found.all()


def test_an_import_without_input_says_what_is_missing(run: Run) -> None:
    Path("bar.txt").write_bytes(SAMPLES["bar.pyslvs"])
    done = run("import", "bar.txt", "--json")
    found = json.loads(done.stdout)
    assert found["format"] == "pyslvs"
    assert found["carried"] == {"points": 5, "links": 4, "inputs": 0}
    assert found["missing"].startswith("one degree of freedom has no input: add an input")
    assert found["written"] == []
    assert "still missing: one degree" in run("import", "bar.txt").stdout


def test_a_wrong_file_is_refused_with_its_line(run: Run) -> None:
    Path("bar.linkage2").write_text("<linkage2>\n<connector id='0' x='a' y='0'/></linkage2>")
    done = run("import", "bar.linkage2")
    assert done.exit_code == 2
    assert 'line 2  x must be a number, got "a"' in done.stderr
    assert run("import", "bar.linkage2", "-o", "bar.linkage2").exit_code == 2


def test_an_export_can_be_imported(run: Run) -> None:
    done = run("export", "pmks", "four-bar")
    assert done.stdout.startswith("https://app.pmksplus.com/?")
    assert "left out:" in done.stderr
    again = run("import", done.stdout.strip(), "-o", "again.toml")
    assert again.exit_code == 0
    assert lw.load("again.toml").sweep(step=90).found.all()
    run("export", "pylinkage", "four-bar", "-o", "bar.json", "--at", "60")
    assert json.loads(Path("bar.json").read_text("utf-8"))["ground"] == "ground"
