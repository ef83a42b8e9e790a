"""New mechanism files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import linkwork as lw
from linkwork.core.textfile.reader import read_draft
from tests.core.commands.conftest import Run


def test_a_blank_sheet_is_written(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "press.toml"
    assert run("new", str(path.with_suffix(""))).stdout.startswith(str(path))
    assert read_draft(path.read_text("utf-8")).draft.name == "press"


def test_a_copy_has_its_own_name(run: Run, tmp_path: Path) -> None:
    path = tmp_path / 'a "b".toml'
    run("new", str(path), "--from", "four-bar")
    copy, own = lw.load(path), lw.example("four-bar")
    assert copy.name == 'a "b"'
    assert copy.changed(name=own.name).description == own.description


def test_a_task_to_begin_with_is_listed_copied_and_solvable(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "tipper.toml"
    assert run("new", str(path), "--from", "three-poses").exit_code == 0
    assert lw.Task.load(path).name == "tipper"
    other = tmp_path / "other.toml"
    shown = run("examples", "three-poses", "-o", str(other)).stdout
    assert " ".join(shown.split()).endswith(f"Next: linkwork synthesize {other}")
    assert lw.Task.load(other).described.positions == lw.Task.load(path).described.positions
    listed = run("examples").stdout
    assert "Tasks, for linkwork synthesize" in listed
    named = json.loads(run("examples", "--json").stdout)
    assert {"name": "three-poses", "title": "Three poses", "family": "other"} in named["tasks"]
    assert not {entry["name"] for entry in named["tasks"]} & {
        entry["name"] for entry in named["examples"]
    }


@pytest.mark.parametrize("name", ["", ".", "..", "/"])
def test_a_folder_is_not_the_name_of_a_new_file(name: str, run: Run) -> None:
    done = run("new", name)
    assert done.exit_code == 2
    assert (
        done.stderr.split()
        == (
            f'Error: "{name}" is not the name of a file: write one, as in "linkwork new press"'
        ).split()
    )


def test_nothing_is_overwritten(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "press.toml"
    path.write_text("mine", "utf-8")
    done = run("new", str(path))
    assert done.exit_code == 2
    assert "exists already: choose another name, or open it" in done.stderr
    assert path.read_text("utf-8") == "mine"
    other = run("new", str(tmp_path / "x"), "--from", "nine-bar")
    assert other.exit_code == 2
    assert "nine-bar" in other.stderr
    assert not (tmp_path / "x.toml").exists()
