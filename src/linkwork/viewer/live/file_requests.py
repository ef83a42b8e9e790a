"""Requests of the page about the file: another one, its history, saving, and its link."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["MakeLink", "OpenExample", "OpenFile", "Redo", "Reload", "Save", "Undo"]


@dataclass(frozen=True, kw_only=True)
class Undo:
    """Undo the last change."""


@dataclass(frozen=True, kw_only=True)
class Redo:
    """Redo the last undone change."""


@dataclass(frozen=True, kw_only=True)
class OpenExample:
    """Open a mechanism of the library as a new file, or a blank sheet with an empty name.

    ``discard``: even if changes of the present file are not saved.
    """

    name: str
    discard: bool = False


@dataclass(frozen=True, kw_only=True)
class OpenFile:
    """Open a file of the visitor as a new one: of Linkwork, or of another program, which is
    imported.

    ``content``: its bytes in base64; ``discard``: even if changes of the present file are not
    saved.
    """

    name: str
    content: str
    discard: bool = False


@dataclass(frozen=True, kw_only=True)
class Save:
    """Write the file; with ``overwrite`` even if another program has changed it."""

    overwrite: bool = False


@dataclass(frozen=True, kw_only=True)
class Reload:
    """Read the file again; unsaved changes stay in the history."""


@dataclass(frozen=True, kw_only=True)
class MakeLink:
    """Pack the text of the file into a link to the address of an app, or into a fragment only."""

    app: str = ""
