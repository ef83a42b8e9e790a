"""Files for the visitor: the mechanism as text, picture, table, workbook, page or film."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from linkwork import viewer  # loads films and pages when they are written
from linkwork.drawing.inline_svg import FixedInks, inline_svg
from linkwork.drawing.mechanism_scene import scene_of
from linkwork.drawing.moving_scene import moving_scene
from linkwork.drawing.scene import Scene
from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.results.csv_text import csv_text
from linkwork.results.motion import Motion
from linkwork.viewer.live.solvable import Solvable
from linkwork.viewer.live.subject import Subject

__all__ = ["ExportedFile", "exported_file"]

_MEDIA_TYPES = {
    "toml": "application/toml",
    "svg": "image/svg+xml",
    "csv": "text/csv",
    "xlsx": "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    "html": "text/html",
    "gif": "image/gif",
    "webp": "image/webp",
    "mp4": "video/mp4",
}
_LONGEST = 1200.0  # the longer side of a picture [CSS pixels]


@dataclass(frozen=True, kw_only=True)
class ExportedFile:
    """A file: its suffix, media type and content; ``notices`` are remarks on it."""

    suffix: str
    media_type: str
    content: bytes
    notices: tuple[str, ...] = ()


def exported_file(
    suffix: str,
    subject: Subject,
    motion: Motion | None,
    text: str,
    *,
    row: int | None = None,
    dark: bool = False,
    progress: Callable[[float], None] | None = None,
) -> ExportedFile:
    """A mechanism, or the text of a draft, in one of several formats.

    Parameters
    ----------
    suffix : str
        ``toml``, ``svg``, ``csv``, ``xlsx``, ``html``, ``gif``, ``webp`` or ``mp4``.
    motion : Motion, optional
        Its cycle; without one there are text and picture only.
    text : str
        Its text as edited.
    row : int, optional
        The row of a picture; by default the first with a position.
    dark : bool
        Pictures and films for dark pages.
    progress : callable, optional
        Receives the finished fraction of a film; may raise an error to cancel it.

    Raises
    ------
    UnknownNameError
        If the format is not known.
    InputError
        If there is nothing to write.
    MissingPackageError
        If this installation cannot write the format.
    """
    if suffix not in _MEDIA_TYPES:
        known = choices("formats", _MEDIA_TYPES, suffix)
        raise UnknownNameError(f'cannot write the format "{suffix}" {known}')
    notices: tuple[str, ...] = ()
    if suffix == "toml":
        content = text.encode()
    elif suffix == "svg":
        scene = _scene(subject.mechanism, motion, row)
        content = inline_svg(scene, FixedInks(dark=dark), longest=_LONGEST).encode()
    else:
        if motion is None or not motion.found.any():
            raise InputError(f"a .{suffix} file needs a motion: the mechanism has none")
        mechanism = subject.mechanism
        if suffix == "csv":
            content = csv_text(motion.table()).encode()
        elif suffix == "html":
            equations = mechanism.equations().mathml()
            loops = mechanism.moving_loops
            page = viewer.motion_page({"motion": motion}, equations=equations, loops=loops)
            content = viewer.offline_page(page).encode()
        elif suffix == "xlsx":
            content, notices = _workbook(mechanism, motion)
        else:
            options = viewer.FilmOptions(theme="dark" if dark else "light")
            viewer.check_animation(f"film.{suffix}", options)
            content = viewer.animation({"": motion}, suffix, options=options, progress=progress)
    return ExportedFile(
        suffix=suffix, media_type=_MEDIA_TYPES[suffix], content=content, notices=notices
    )


def _scene(mechanism: Solvable, motion: Motion | None, row: int | None) -> Scene:
    """The picture of a row, or without a motion of the only position."""
    if motion is None:
        position = mechanism.solve()
        if not position.status.ok:
            raise InputError(f"there is no position to draw: {position.message}")
        return scene_of(position)
    if not motion.found.any():
        raise InputError("there is no position to draw: no row of the motion has one")
    shown = int(np.flatnonzero(motion.found)[0]) if row is None else row
    if not 0 <= shown < len(motion):
        raise InputError(f"there is no row {row}: the motion has {len(motion)}")
    return moving_scene(motion).at(shown)


def _workbook(mechanism: Solvable, motion: Motion) -> tuple[bytes, tuple[str, ...]]:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "motion.xlsx"
        notices = mechanism.to_excel(path, motion)
        return path.read_bytes(), notices
