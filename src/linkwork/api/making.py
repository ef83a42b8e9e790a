"""Mechanisms from files, texts, the library, and from Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from linkwork import textfile
from linkwork.api.mechanism import Mechanism
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.loops import Loops, PlainEquations
from linkwork.textfile.library import example_text

__all__ = ["example", "linkage", "load", "loads", "loops", "plain_equations"]


def load(path: str | Path) -> Mechanism:
    """Read a mechanism file.

    Raises
    ------
    MechanismFileError
        With every problem found: file, line, key.
    """
    read = textfile.read_file(Path(path))
    return Mechanism(read.description, read)


def loads(text: str, name: str = "text") -> Mechanism:
    """Read a mechanism from the text of a file."""
    read = textfile.read_text(text, name)
    return Mechanism(read.description, read)


def example(name: str) -> Mechanism:
    """A mechanism of the library by name."""
    return loads(example_text(name), f"{name}.toml")


def linkage(**parts: Any) -> Mechanism:
    """A mechanism from points and links; arguments as
    :class:`~linkwork.mechanism.linkage.Linkage`.
    """
    return Mechanism(Linkage(**parts))


def loops(**parts: Any) -> Mechanism:
    """A mechanism from loop equations; arguments as :class:`~linkwork.mechanism.loops.Loops`."""
    return Mechanism(Loops(**parts))


def plain_equations(**parts: Any) -> Mechanism:
    """A system of plain equations; arguments as
    :class:`~linkwork.mechanism.loops.PlainEquations`.
    """
    return Mechanism(PlainEquations(**parts))
