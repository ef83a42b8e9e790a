"""Tasks to begin with."""

from __future__ import annotations

from importlib import resources

from linkwork.core.foundation.errors import InputError, choices

__all__ = ["template_names", "template_text"]


def template_names() -> tuple[str, ...]:
    """The names of the tasks, sorted."""
    files = resources.files(__name__).iterdir()
    return tuple(sorted(f.name.removesuffix(".toml") for f in files if f.name.endswith(".toml")))


def template_text(name: str) -> str:
    """The text of a task to begin with.

    Raises
    ------
    InputError
        If no template has this name.
    """
    known = template_names()
    if name not in known:
        raise InputError(f'there is no task "{name}" to begin with {choices("tasks", known, name)}')
    return (resources.files(__name__) / f"{name}.toml").read_text(encoding="utf-8")
