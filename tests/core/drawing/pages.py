"""What stands on a page, measured as it is printed."""

from __future__ import annotations

import re
from itertools import combinations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from linkwork.core.drawing.scene import LIGHT
from linkwork.core.foundation.arrays import Array
from linkwork.writers.charts.chart import Chart

__all__ = [
    "assert_drawn", "assert_page_is_clear", "axes_of", "curves_of", "left_title", "legend_of",
    "marks_of", "pieces", "printed_texts", "rules_of", "size_in_inches", "svg_texts",
]  # fmt: skip


def axes_of(chart: Chart) -> list[Axes]:
    """The axes of a chart's panels, drawn."""
    return chart.figure(LIGHT).axes


def curves_of(ax: Axes) -> list[Line2D]:
    return [line for line in ax.lines if str(line.get_gid()).startswith("curve:")]


def _points(line: Line2D) -> Array:
    return np.asarray(line.get_xydata(), dtype=float)


def marks_of(ax: Axes, kind: str) -> list[tuple[float, float]]:
    """The marks of a kind that are inside the axes, to nine decimals."""
    lines = [line for line in ax.lines if line.get_gid() == kind.replace(" ", "-")]
    every = np.concatenate([np.empty((0, 2)), *map(_points, lines)])
    low, high = np.transpose([ax.get_xlim(), ax.get_ylim()])
    inside = (every >= low).all(axis=1) & (every <= high).all(axis=1)
    return [(x + 0.0, y + 0.0) for x, y in np.round(every[inside], 9).tolist()]


def rules_of(ax: Axes, kind: str) -> list[float]:
    """The inputs at which a line across the panel shows a limit."""
    lines = [line for line in ax.lines if line.get_gid() == f"rule:{kind.replace(' ', '-')}"]
    return [float(_points(line)[0, 0]) for line in lines]


def pieces(line: Line2D) -> list[Array]:
    """The drawn pieces of a curve, each (K, 2)."""
    points = _points(line)
    found = np.isfinite(points).all(axis=1)
    cuts = np.flatnonzero(np.diff(found.astype(int))) + 1
    return [part for part in np.split(points, cuts) if np.isfinite(part).all()]


def assert_drawn(line: Line2D, x: Array, y: Array) -> None:
    """A curve passes through all rows, and nothing is drawn where there are none."""
    rows = np.stack([x, y], axis=1)
    rows = rows[np.isfinite(rows).all(axis=1)]
    drawn = {tuple(point) for point in _points(line).tolist()}
    assert {tuple(row) for row in rows.tolist()} <= drawn
    within = np.concatenate(pieces(line))
    assert (within.min(axis=0) >= rows.min(axis=0) - 1e-2 * np.ptp(rows, axis=0)).all()
    assert (within.max(axis=0) <= rows.max(axis=0) + 1e-2 * np.ptp(rows, axis=0)).all()


def legend_of(page: Figure) -> list[str]:
    return [text.get_text() for legend in page.legends for text in legend.get_texts()]


def printed_texts(page: Figure) -> list[tuple[str, Bbox]]:
    """Every text of a figure but those inside drawings, with its box in pixels."""
    page.draw_without_rendering()
    assert isinstance(page.canvas, FigureCanvasAgg)
    renderer = page.canvas.get_renderer()
    artists = [*page.texts, *(text for legend in page.legends for text in legend.get_texts())]
    for ax in page.axes:
        artists += [ax.xaxis.label, ax.yaxis.label, ax.title, left_title(ax)]
        for axis, limits in ((ax.xaxis, ax.get_xlim()), (ax.yaxis, ax.get_ylim())):
            low, high = sorted(limits)
            slack = 1e-9 * (high - low)
            artists += [
                tick.label1
                for tick in axis.get_major_ticks()
                if low - slack <= tick.get_loc() <= high + slack
            ]
    return [
        (text.get_text(), text.get_window_extent(renderer))
        for text in artists
        if text.get_visible() and text.get_text().strip()
    ]


def left_title(ax: Axes) -> Text:
    """The title at the left, which Matplotlib gives as text only."""
    found: Text = getattr(ax, "_left_title")  # noqa: B009 - unknown to its types
    return found


def assert_page_is_clear(page: Figure) -> None:
    """Every text is on the page, none covers another one or a panel's inside."""
    texts = printed_texts(page)
    assert texts
    for text, box in texts:
        assert page.bbox.x0 <= box.x0 < box.x1 <= page.bbox.x1, text
        assert page.bbox.y0 <= box.y0 < box.y1 <= page.bbox.y1, text
    for (one, box), (other, beside) in combinations(texts, 2):
        assert not _overlap(box, beside), (one, other)
    for ax in page.axes:
        inside = ax.get_window_extent()
        for text, box in texts:
            assert not _overlap(box, inside), text
    for ax, below in combinations(page.axes, 2):
        assert not _overlap(ax.get_window_extent(), below.get_window_extent())


def _overlap(one: Bbox, other: Bbox) -> bool:
    width = min(one.x1, other.x1) - max(one.x0, other.x0)
    height = min(one.y1, other.y1) - max(one.y0, other.y0)
    return bool(width > 0 and height > 0)


def svg_texts(svg: bytes) -> list[str]:
    """The texts of an SVG file, which draws letters as outlines and names each text before it."""
    found = re.findall(r"<!-- (.*?) -->", svg.decode(), flags=re.DOTALL)
    return [text.replace("&#45;", "-") for text in found]


def size_in_inches(png: bytes, dpi: float) -> tuple[float, float]:
    """Width and height of a PNG file."""
    return int.from_bytes(png[16:20], "big") / dpi, int.from_bytes(png[20:24], "big") / dpi
