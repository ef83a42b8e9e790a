"""Read task files; report all problems with their lines."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.core.foundation.errors import MechanismError, MechanismFileError, Problem
from linkwork.core.foundation.files import as_path
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.foundation.values import as_told
from linkwork.core.mechanism.description import Description
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.core.textfile.keys import FORMAT
from linkwork.core.textfile.reader import (
    Structure,
    check_format,
    check_kind,
    example_text,
    examples,
    located_error,
)
from linkwork.core.textfile.toml_text import Lines, bytes_of, data_of, text_of
from linkwork.core.textfile.writer import write_tables
from linkwork.synthesis.improvement.settings import Goal, Improvement
from linkwork.synthesis.tasks.conditions import (
    LARGEST,
    Curve,
    Given,
    PrecisionPosition,
    Ranking,
    Wanted,
    read_curve,
)
from linkwork.synthesis.tasks.function_goal import LOOP_PAIRS, FunctionGoal
from linkwork.synthesis.tasks.task import MECHANISMS, WATT_II, WATT_PAIRS, Task
from linkwork.synthesis.tasks.task_keys import TASK, TURNS_FULLY


def read_task(path: Path | str) -> Task:
    """Read the task in a file.

    Raises
    ------
    MechanismFileError
        Lists all problems with file, line, key and remedy.
    """
    name = str(path)
    return read_task_text(text_of(bytes_of(as_path(path), name), name), name, as_path(path).parent)


def read_task_text(text: str, name: str = "the task", folder: Path | None = None) -> Task:
    """Read the task in a text; raises like :func:`read_task`.

    ``folder``: that of the files it names; by default the current one.
    """
    data = data_of(text, name)
    lines = Lines.of(text)
    check_format(data, lines, name)
    check_kind(data, lines, name, task=True)
    structure = Structure(data, TASK)
    if structure.problems:
        raise located_error(structure.problems, lines, name)
    try:
        return _task(structure.content, text, Path(name).stem, folder)
    except MechanismError as error:
        raise located_error(error.problems, lines, name) from None


def located_task_error(error: MechanismError, task: Task, name: str) -> MechanismError:
    """Problems from a solver, with the lines of the task's file."""
    if not task.text or isinstance(error, MechanismFileError):  # of the mechanism's file
        return error
    return located_error(error.problems, Lines.of(task.text), name)


def task_of_tables(tables: Mapping[str, Any]) -> Task:
    """The task of tables that have the keys of a file.

    Raises
    ------
    MechanismError
        Lists all problems with their keys.
    """
    data = {"format": FORMAT, **_plain_data(tables)}
    structure = Structure(data, TASK)
    if structure.problems:
        raise MechanismError(structure.problems, "the task")
    return _task(structure.content, write_tables(data), data.get("name", Task.name))


def _plain_data(value: Any) -> Any:
    """Tuples as lists, as a file has them, and numbers of other packages as Python's."""
    match value:
        case Mapping():
            return {key: _plain_data(entry) for key, entry in value.items()}
        case list() | tuple() | np.ndarray():
            return [_plain_data(entry) for entry in value]
        case np.generic():
            return value.item()
        case _:
            return value


def _curve(table: Mapping[str, Any], folder: Path | None, turn: float) -> Curve:
    try:
        return read_curve(table, folder, turn)
    except MechanismError as error:
        if error.problems[0].key:
            raise
        # a file that cannot be read has no key: that of the task which names it
        message = f'"{table["file"]}": {error.problems[0].message}'
        problem = Problem(key=("curve", "file"), message=message)
        raise MechanismError([problem], "the task") from None


def _mechanism_in_folder(name: str, folder: Path | None) -> str | None:
    """The text of the user's mechanism that a task improves, if there is its file."""
    if name in examples():
        return None
    path = (folder or Path()) / name
    return text_of(bytes_of(path, str(path)), str(path)) if path.is_file() else None


def _units(content: Mapping[str, Any], mechanism: str, text: str | None) -> tuple[str, AngleUnit]:
    """The units of a task; one that improves a mechanism has those of its file.

    ``text``: of this mechanism; ``None`` if there is none.

    Raises
    ------
    MechanismError
        If the task has different units.
    """
    length, angle = Description.length, Description.angle
    if text is None:
        return content.get("length", length), AngleUnit(content.get("angle", angle.value))
    # problems of the mechanism's file are reported when it is read
    with suppress(MechanismFileError, ValueError):
        data = data_of(text, mechanism)
        length, angle = str(data.get("length", length)), AngleUnit(data.get("angle", angle.value))
    message = f"is not the unit of {mechanism}: leave it out, and write all numbers in"
    problems = [
        Problem(key=(key,), message=f"{message} {unit}")
        for key, unit in (("length", length), ("angle", angle.value))
        if content.get(key, unit) != unit
    ]
    if problems:
        raise MechanismError(problems, "the task")
    return length, angle


def _task(content: Mapping[str, Any], text: str, stem: str, folder: Path | None = None) -> Task:
    _check(content)
    mechanism = content.get("mechanism", MECHANISMS)
    mechanisms = (mechanism,) if isinstance(mechanism, str) else tuple(mechanism)
    improves = content["task"] == "improve" and len(mechanisms) == 1
    local = _mechanism_in_folder(mechanisms[0], folder) if improves else None
    known = example_text(mechanisms[0]) if improves and mechanisms[0] in examples() else local
    length, angle = _units(content, mechanisms[0], known)
    curve = _curve(content["curve"], folder, angle.turn) if "curve" in content else None
    return Task(
        kind=content["task"],
        name=content.get("name", stem),
        length=length,
        angle=angle,
        mechanisms=mechanisms,
        positions=tuple(PrecisionPosition(**_tuples(row)) for row in content.get("positions", ())),
        given=Given(**_tuples(content.get("given", {}))),
        function=_function(content["function"], mechanism) if "function" in content else None,
        wanted=_wanted_table(content.get("wanted", {})),
        rank=_ranking(content.get("rank", {})),
        curve=curve,
        improvement=_improvement(content["improve"]) if "improve" in content else None,
        folder=folder,
        mechanism_text=local,
        text=text,
    )


#: The tables that each kind of task uses, besides those of all kinds.
_USED = {
    "motion": {"positions", "given"},
    "path": {"positions", "given", "curve", "improve"},
    "mixed": {"positions", "given"},
    "function": {"function", "given"},
    "improve": {"positions", "curve", "improve"},
}

#: Keys of a function that have no effect if another one is given.
_IDLE = {
    "fit": ("a fit", ("positions", "spacing")),
    "pairs": ("pairs", ("x", "positions", "spacing")),
}


def _check(content: Mapping[str, Any]) -> None:
    """Refuse tables and keys of functions without effect, and numbers beyond floating point."""
    every = set().union(*_USED.values())
    kind = content["task"]
    problems = [
        Problem(key=(table,), message=f'has no effect on task = "{kind}": leave it out')
        for table in content
        if table in every - _USED[kind]
    ]
    function = content.get("function", {})
    problems += [
        Problem(key=("function", key), message=f"has no effect on {task_kind}: leave it out")
        for name, (task_kind, idle) in _IDLE.items()
        for key in idle
        if name in function and key in function
    ]
    problems += [
        Problem(key=key, message=f"{as_told(number)} is beyond ±1e12: choose a larger unit")
        for key, number in _numbers(content)
        if abs(number) > LARGEST
    ]
    if problems:
        raise MechanismError(problems, "the task")


def _numbers(
    entry: Any, key: tuple[str | int, ...] = ()
) -> Iterator[tuple[tuple[str | int, ...], float]]:
    match entry:
        case Mapping():
            for name, below in entry.items():
                yield from _numbers(below, (*key, name))
        case list():
            for k, below in enumerate(entry):
                yield from _numbers(below, (*key, k))
        case int() | float():
            yield key, entry


def _tuples(content: Any) -> Any:
    """Lists as tuples, in tables and lists too."""
    match content:
        case dict():
            return {key: _tuples(entry) for key, entry in content.items()}
        case list():
            return tuple(map(_tuples, content))
        case _:
            return content


def _function(table: dict[str, Any], mechanism: Any) -> FunctionGoal:
    exact = WATT_PAIRS if WATT_II in mechanism else LOOP_PAIRS
    free = [key for key in ("input", "output") if isinstance(table.get(key), int | float)]
    begun = {key: (0.0, float(table[key])) for key in free}
    return FunctionGoal(**{**_tuples(table), **begun}, free=tuple(free), exact=exact)


def _improvement(table: dict[str, Any]) -> Improvement:
    settings = _tuples(table)
    fit = settings.pop("goal", Improvement.fit)
    goals = tuple(Goal(**goal) for goal in settings.pop("goals", ()))
    return Improvement(**settings, fit=fit, goals=goals)


def _wanted_table(table: dict[str, Any]) -> Wanted:
    driven = table.get("input")
    lengths = table.get("lengths", {})
    return Wanted(
        turns_fully=driven == TURNS_FULLY,
        range=(driven["from"], driven["to"]) if isinstance(driven, dict) else None,
        transmission=table.get(TRANSMISSION_ANGLE.word, {}).get("least", 0.0),
        ordered=table.get("order", "as given") == "as given",
        region=_tuples(table.get("fixed_pivots", {}).get("inside", [])),
        shortest=lengths.get("least", 0.0),
        longest=lengths.get("most", math.inf),
        ratio=lengths.get("ratio", math.inf),
        obstacles=_tuples(table.get("clear_of", [])),
    )


def _ranking(table: dict[str, Any]) -> Ranking:
    usual = Ranking()
    # weights that are left out are 0 once any is given
    weights = table.get("by")
    settings = {
        key: getattr(usual, key) if weights is None else weights.get(key, 0.0)
        for key in (TRANSMISSION_ANGLE.word, "size", "error")
    }
    return Ranking(**settings, deliver=table.get("deliver", usual.deliver))
