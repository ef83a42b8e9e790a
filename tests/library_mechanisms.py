"""The mechanisms of the library, each read once in a process; no test changes one."""

from __future__ import annotations

from functools import cache

import linkwork as lw

__all__ = ["driven_examples", "read_example"]

read_example = cache(lw.example)


def driven_examples() -> list[str]:
    """The names of library mechanisms that have an input."""
    return [name for name in lw.examples() if read_example(name).description.inputs]
