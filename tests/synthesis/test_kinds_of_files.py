"""A task where a mechanism is wanted, and the other way round: one sentence says so."""

from __future__ import annotations

from pathlib import Path

import pytest

import linkwork as lw
from linkwork.synthesis.tasks.templates import template_names, template_text

_OF_TASK = (
    "this is a task: linkwork synthesize FILE or linkwork view FILE, in Python linkwork.Task.load"
)
_OF_MECHANISM = (
    "this is a mechanism: linkwork sweep FILE or linkwork view FILE, in Python linkwork.load"
)


def _problem(error: lw.MechanismError) -> tuple[tuple[str | int, ...], str, int | None]:
    (problem,) = error.problems
    return problem.key, problem.message, problem.line


@pytest.mark.parametrize("name", template_names())
def test_a_task_is_no_mechanism(name: str, tmp_path: Path) -> None:
    path = tmp_path / "task.toml"
    path.write_text(template_text(name), "utf-8")
    with pytest.raises(lw.MechanismFileError) as found:
        lw.load(path)
    assert _problem(found.value) == (("task",), _OF_TASK, 3)
    with pytest.raises(lw.MechanismFileError, match="this is a task"):
        lw.loads(template_text(name))


@pytest.mark.parametrize(
    ("name", "key"),
    [("four-bar", "points"), ("rapier-drive", "loops"), ("newton-another-root", "equations")],
)
def test_a_mechanism_is_no_task(name: str, key: str, tmp_path: Path) -> None:
    path = tmp_path / "bar.toml"
    path.write_text(lw.example_text(name), "utf-8")
    with pytest.raises(lw.MechanismFileError) as found:
        lw.Task.load(path)
    assert _problem(found.value)[:2] == ((key,), _OF_MECHANISM)


def test_a_file_of_both_kinds_has_its_problems_one_by_one() -> None:
    mixed = 'format = 1\ntask = "path"\n' + lw.example_text("four-bar").removeprefix("format = 1\n")
    with pytest.raises(lw.MechanismFileError, match=r"task +is not a key of the file"):
        lw.loads(mixed)
    with pytest.raises(lw.MechanismFileError, match=r"points +is not a key of the file"):
        lw.Task.loads(mixed)
    with pytest.raises(lw.MechanismFileError, match=r"task +is missing: the kind"):
        lw.Task.loads("format = 1\n")
