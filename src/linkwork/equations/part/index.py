"""The index of part equations: each part has a module of the same name."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from linkwork.equations.frames import Frames
from linkwork.equations.part_rows import PartRows
from linkwork.mechanism.description import Key, Problems
from linkwork.mechanism.part.index import part_module
from linkwork.mechanism.part.part import Part

__all__ = ["rows_of_parts"]


def rows_of_parts(frames: Frames, problems: Problems) -> PartRows:
    """The rows of all parts of a linkage; their positions and rods are added to ``frames``."""
    rows = PartRows(frames, problems)
    for key, part in frames.linkage.keyed_parts:
        module = import_module(f"linkwork.equations.part.{part_module(type(part))}")
        write: Callable[[Part, Key, PartRows], None] = module.write
        write(part, key, rows)
    return rows
