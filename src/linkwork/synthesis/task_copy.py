"""The task of a folder of designs, with copies of the files that it names."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from linkwork.core.textfile.text_edits import TextEdits
from linkwork.synthesis.tasks.task import Task

REFUSED = "refused"
# names of files of a synthesis
_OWN = re.compile(
    r".+-\d+\.(toml|svg)|task\.toml|designs\.csv|front\.svg|index\.html|refused|\.linkwork.*",
    re.IGNORECASE,  # on file systems that ignore case both names are one file
)


@dataclass(frozen=True, kw_only=True)
class TaskCopy:
    """A task that is at home in the folder of its designs.

    ``files``: the texts of the task's file and of those that it names, by their places in the
    folder; ``sources``: the files that it names themselves.
    """

    files: Mapping[str, str]
    sources: Collection[Path]


def task_copy(task: Task) -> TaskCopy:
    """The copy of a task for a folder of its designs.

    Files that lie in the folder of the task keep their places. Others, and those with names of
    designs, lie in a folder named like the key that names them: ``curve/foot.csv``.
    """
    files = {"task.toml": task.text}
    sources: list[Path] = []
    edits = TextEdits(task.text)
    for key, name, text in _named_files(task):
        place = Path(name)
        sources.append(((task.folder or Path()) / place).resolve())
        if place.is_absolute() or ".." in place.parts or _OWN.fullmatch(place.parts[0]):
            place = Path(key[0], place.name)
            if place.as_posix() in files:
                place = Path(key[0], *place.parts)
            edits.put(key, place.as_posix())
            files["task.toml"] = edits.text
        files[place.as_posix()] = text
    return TaskCopy(files=files, sources=sources)


def _named_files(task: Task) -> Iterator[tuple[tuple[str, ...], str, str]]:
    """The files that a task names: their keys, names and texts."""
    if task.curve is not None:
        yield ("curve", "file"), task.curve.file, task.curve.text
    if task.mechanism_text is not None:
        yield ("mechanism",), task.mechanisms[0], task.mechanism_text
