"""One registry of the kinds of files that a mechanism is written to."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Any

from linkwork import wings
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.files import as_path


def writers() -> dict[str, wings.Writer]:
    """All kinds of files: those of Linkwork, then those of other packages."""
    return {kind: writer for wing in wings.wings() for kind, writer in wing.writers.items()}


def kind_of(path: str | Path) -> str:
    """The kind of file that a suffix selects.

    Raises
    ------
    InputError
        If none has it.
    """
    known, suffix = writers(), as_path(path).suffix.lower()
    for name, writer in known.items():
        if suffix in writer.suffixes:
            return name
    suffixes = sorted(s for writer in known.values() for s in writer.suffixes)
    raise InputError(
        f'cannot write "{path}": no kind of file has the suffix "{suffix}" '
        f"{choices('suffixes', suffixes)}; or name the kind {choices('kinds', known)}"
    )


def write(mechanism: Mechanism, path: str | Path, kind: str | None = None, **options: Any) -> Any:
    """Write a mechanism to a file; see :meth:`~linkwork.Mechanism.write`."""
    known, kind = writers(), kind_of(path) if kind is None else kind
    if kind not in known:
        raise UnknownNameError(f'there is no kind of file "{kind}" {choices("kinds", known, kind)}')
    chosen = wings.load(known[kind].place)
    takes = list(inspect.signature(chosen).parameters)[2:]
    for name in options:
        if name not in takes:
            raise InputError(f'a {kind} has no option "{name}" {choices("options", takes, name)}')
    return chosen(mechanism, path, **options)
