"""Tasks to begin with."""

from __future__ import annotations

from importlib import resources

from linkwork.app.live.mechanism_file import MechanismFile, new_file
from linkwork.core.foundation.errors import InputError, choices

__all__ = ["task_template", "template_names", "template_text"]


def template_names() -> tuple[str, ...]:
    """The names of the tasks, sorted."""
    files = resources.files(__name__).iterdir()
    return tuple(sorted(f.name.removesuffix(".toml") for f in files if f.name.endswith(".toml")))


def template_text(name: str) -> str:
    """The text of a task to begin with.

    Raises
    ------
    InputError
        If there is none of this name.
    """
    known = template_names()
    if name not in known:
        raise InputError(f'there is no task "{name}" to begin with {choices("tasks", known, name)}')
    return (resources.files(__name__) / f"{name}.toml").read_text(encoding="utf-8")


def task_template(name: str) -> MechanismFile:
    """A task to begin with, under a name that no file has; raises like `template_text`."""
    return new_file(name, template_text(name))
