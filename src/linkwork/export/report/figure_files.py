"""The pictures of a report as bytes, with their printed size, and progress."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from linkwork.drawing import render
from linkwork.export.report.document import Document, Figure

__all__ = ["FigureFile", "figure_files"]

_DPI = 200.0  # twice that of a screen
_INCH, _POINTS = 25.4, 72.0  # [mm], [pt/in]
_WIDEST, _TALLEST = 150.0, 104.0  # printed [mm]: a heading and two figures fit a page
_SIDES = [re.compile(rb'<svg [^>]*\b%s="([\d.]+)pt"' % side) for side in (b"width", b"height")]


@dataclass(frozen=True, kw_only=True)
class FigureFile:
    """The content of a picture and its printed width [mm]."""

    number: int
    content: bytes
    width: float


def figure_files(
    document: Document, kind: str, progress: Callable[[float], None]
) -> Iterator[FigureFile]:
    """Every figure as ``svg`` or ``png``."""
    figures = [b for section in document.sections for b in section.blocks if isinstance(b, Figure)]
    for k, figure in enumerate(figures, 1):
        content = render(figure.picture, kind, dpi=_DPI)
        wide, high = _size(content)
        width = wide * min(1.0, _WIDEST / wide, _TALLEST / high)
        yield FigureFile(number=figure.number, content=content, width=width)
        progress(k / len(figures))


def _size(content: bytes) -> tuple[float, float]:
    """Width and height [mm]."""
    if content.startswith(b"\x89PNG"):
        wide, high = struct.unpack(">II", content[16:24])
        return wide * _INCH / _DPI, high * _INCH / _DPI
    wide, high = (float(side.findall(content)[0]) for side in _SIDES)
    return wide * _INCH / _POINTS, high * _INCH / _POINTS
