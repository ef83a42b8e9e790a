"""Pictures as files: PNG, SVG and PDF by Matplotlib, TikZ for LaTeX documents."""

from __future__ import annotations

from pathlib import Path

from linkwork.core.drawing import matplotlib_writer
from linkwork.core.drawing.matplotlib_writer import Chart
from linkwork.core.drawing.mechanism_scene import Sheet
from linkwork.core.drawing.scene import LIGHT, Scene, Theme
from linkwork.core.drawing.tikz import tikz_picture
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import as_path, save_bytes, suffix_of

_TIKZ = "tikz"
#: File formats by suffix.
FORMATS = (*matplotlib_writer.FORMATS, _TIKZ)


def check_picture(path: str | Path) -> str:
    """The format of a picture file by its suffix.

    Raises
    ------
    InputError
        If there is no such format.
    """
    return suffix_of(as_path(path), "a picture", [f".{name}" for name in FORMATS])[1:]


def write(
    scene: Scene | Chart | Sheet,
    path: str | Path,
    *,
    dpi: float = 200.0,
    theme: Theme = LIGHT,
) -> Path:
    """Write a scene, a chart or a sheet to a file; the suffix of ``path`` chooses the format.

    The file is written completely or not at all; the same scene gives the same bytes.

    Raises
    ------
    InputError
        If the suffix is not a known format, or the file cannot be written.
    MissingPackageError
        If Matplotlib is not installed.
    """
    target = as_path(path)
    kind = check_picture(target)
    save_bytes(render(scene, kind, dpi=dpi, theme=theme), target)
    return target


def render(
    scene: Scene | Chart | Sheet,
    kind: str,
    *,
    dpi: float = 200.0,
    theme: Theme = LIGHT,
) -> bytes:
    """A scene, chart or sheet as the content of a file of one of :data:`FORMATS`.

    Raises
    ------
    InputError
        If the format is unknown, or several drawings are to be one TikZ picture.
    """
    if kind not in FORMATS:
        raise InputError(f'there is no format "{kind}" (formats: {", ".join(FORMATS)})')
    if kind != _TIKZ:
        return matplotlib_writer.image(scene, kind, dpi=dpi, theme=theme)
    if isinstance(scene, Sheet):
        raise InputError("a TikZ picture shows one position or a chart: draw each position alone")
    if isinstance(scene, Scene):
        return tikz_picture(scene, theme).encode()
    return scene.tikz(theme).encode()
