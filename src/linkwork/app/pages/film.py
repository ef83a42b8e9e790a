"""A moving scene as a sequence of pictures with equal size and view."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from linkwork.app.pages.moving_scene import MovingScene
from linkwork.core.drawing.matplotlib_writer import Brush, house_settings
from linkwork.core.drawing.pose import lines_within
from linkwork.core.drawing.scene import LIGHT, Box, Theme
from linkwork.core.foundation.arrays import AnyArray

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text


_LONG_SIDE, _SHORT_SIDE = 6.0, 2.0  # longer side of the drawing [inches]
_MARGIN, _LINE = 0.2, 0.24  # margin of the drawing, and height of a text line [inches]
_TITLE, _SMALL = 12.0, 10.5  # font sizes in points
_ROOM = 0.04  # margin as a fraction of the drawn size


def film(
    moving: MovingScene,
    rows: Sequence[int],
    captions: Sequence[str],
    turned: Sequence[bool],
    *,
    dpi: float = 110.0,
    theme: Theme = LIGHT,
) -> Iterator[AnyArray]:
    """The pictures of some rows.

    Parameters
    ----------
    moving : MovingScene
    rows : sequence of int
        Rows with a position.
    captions : sequence of str
        The text under the title in each picture.
    turned : sequence of bool
        Whether the arrows of inputs are reversed in each picture.
    dpi : float
        Pixels per inch; the longer side of the drawing is six inches.
    theme : Theme

    Yields
    ------
    array (height, width, 3), uint8
        Red, green, blue; width and height are even, as film formats require.
    """
    with house_settings():
        page, ax, caption = _page(moving, theme, dpi)
        canvas = page.canvas
        drawn: list[Artist] = []
        for row, text, back in zip(rows, captions, turned, strict=True):
            for artist in drawn:
                artist.remove()
            known = set(ax.get_children())
            brush = Brush(ax, moving.scene, theme)
            for primitive in moving.at(row, turned=back).primitives:
                brush.draw(primitive)
            drawn = [artist for artist in ax.get_children() if artist not in known]
            caption.set_text(text)
            canvas.draw()
            pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[attr-defined]
            yield np.array(pixels[:, :, :3])


def _page(moving: MovingScene, theme: Theme, dpi: float) -> tuple[Figure, Axes, Text]:
    """A page without axes: the title, the caption, and the drawing under them."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    view = moving.view.grown(_ROOM * moving.scene.measures.size)
    scale = _LONG_SIDE / max(view.width, view.height)
    width, height = (max(_SHORT_SIDE, scale * side) for side in (view.width, view.height))
    total = width + 2 * _MARGIN
    lines = lines_within(moving.scene.title, (total - 2 * _MARGIN) * 72 / _TITLE)
    above = _MARGIN + _LINE * (len(lines) + 1)
    pixels = [2 * round(side * dpi / 2) for side in (total, above + height + _MARGIN)]
    wide, tall = (side / dpi for side in pixels)
    page = Figure(figsize=(wide, tall), dpi=dpi, facecolor=theme.background)
    FigureCanvasAgg(page)
    ax = page.add_axes((0.0, 0.0, 1.0, 1.0 - above / tall))
    ax.set_axis_off()
    _fit(ax, view, wide, tall - above)
    left = _MARGIN / wide
    for k, line in enumerate(lines):
        place = 1 - (0.1 + (k + 1) * _LINE - 0.05) / tall
        page.text(left, place, line, fontsize=_TITLE, color=theme.ink, parse_math=False)
    place = 1 - (0.1 + (len(lines) + 1) * _LINE - 0.05) / tall
    caption = page.text(left, place, "", fontsize=_SMALL, color=theme.faint, parse_math=False)
    return page, ax, caption


def _fit(ax: Axes, view: Box, width: float, height: float) -> None:
    """Centre a view in axes of a size in inches."""
    scale = max(view.width / (width - 2 * _MARGIN), view.height / (height - _MARGIN))
    (x, y), half, rise = view.centre, 0.5 * scale * width, 0.5 * scale * height
    ax.set_xlim(x - half, x + half)
    ax.set_ylim(y - rise, y + rise)
    ax.set_aspect("equal", adjustable="datalim")
    ax.apply_aspect()
