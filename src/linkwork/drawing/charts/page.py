"""Layout of the parts of a chart on a page [inches], without overlap."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from linkwork.drawing.captions import lines_within
from linkwork.drawing.charts.chart import Chart, Shape
from linkwork.drawing.scene import text_width

__all__ = ["KEY", "SMALL", "TITLE", "Page", "page_of"]

#: Font sizes in points: title; captions, labels and panel names; legend.
TITLE, SMALL, KEY = 11.0, 9.0, 8.5

_WIDTH = 6.95
_LEFT, _RIGHT, _ABOVE, _BELOW = 0.85, 0.25, 0.17, 0.6
_GAP, _BESIDE = 0.22, 0.3  # between panels with a common axis
_LINE, _NAME = 0.19, 0.15  # heights of a title and of a panel name
_LEGEND_LINE, _HANDLE = 0.2, 0.4
_HEIGHTS = (3.4, 2.4, 1.9)  # height of a full-width graph: alone, of two, of more
_CELL = 0.75  # height-to-width ratio of graphs side by side
_PLANE = 4.6  # the longer side of a single plane or polar panel
_FLATTEST, _TALLEST = 0.4, 1.15  # height-to-width ratio of a plane
_LOWEST = 1.7  # minimum height of a plane, for its label
_RIM = 0.3  # margin of a polar panel, for angle labels


@dataclass(frozen=True, kw_only=True)
class Page:
    """The layout of a page.

    Parameters
    ----------
    heading : tuple of (str, float)
        Lines of the title and of the caption with the height of their middles; the first
        ``titles`` belong to the title.
    legend : tuple of (float, float)
        Left end and upper edge of every legend entry.
    panels : tuple of (float, float, float, float)
        Left, bottom, width, height of every panel.
    left : float
        Left end of the headings.
    """

    width: float
    height: float
    heading: tuple[tuple[str, float], ...]
    titles: int
    legend: tuple[tuple[float, float], ...]
    panels: tuple[tuple[float, float, float, float], ...]
    left: float = _LEFT


def page_of(chart: Chart, legend: Sequence[str], ratio: float = 1.0) -> Page:
    """The layout of a chart.

    Parameters
    ----------
    legend : sequence of str
        The texts of the legend's entries.
    ratio : float
        Height-to-width ratio of the area shown by planes.
    """
    room = _WIDTH - _LEFT - _RIGHT
    titles = lines_within(chart.title, room * 72 / TITLE)
    lines = [*titles, *lines_within(chart.caption, room * 72 / SMALL)]
    entries = _legend(legend)
    rows = 1 + max((row for _, row in entries), default=-1)
    top = _ABOVE + _LINE * len(lines)
    above = top + _LEGEND_LINE * rows + _GAP / 2
    cells, below = _cells(chart, ratio)
    height = above + below + _BELOW
    return Page(
        width=_WIDTH,
        height=height,
        heading=tuple((line, height - _ABOVE - (k + 0.5) * _LINE) for k, line in enumerate(lines)),
        titles=len(titles),
        legend=tuple((left, height - top - row * _LEGEND_LINE) for left, row in entries),
        panels=tuple((x, height - above - y - tall, wide, tall) for x, y, wide, tall in cells),
    )


def _legend(texts: Sequence[str]) -> list[tuple[float, int]]:
    """Left end and row of every entry, with as many entries in a row as fit."""
    found: list[tuple[float, int]] = []
    left, row = math.inf, -1
    for text in texts:
        width = _HANDLE + text_width(text, KEY) / 72
        if left + width > _WIDTH:
            left, row = _LEFT, row + 1
        found.append((left, row))
        left += width
    return found


def _cells(chart: Chart, ratio: float) -> tuple[list[tuple[float, float, float, float]], float]:
    """Left, distance from the top, width and height of every panel; and the total height."""
    count, columns = len(chart.panels), chart.columns
    room = _WIDTH - _LEFT - _RIGHT
    shape = chart.panels[0].shape
    between = {Shape.GRAPH: _BESIDE, Shape.PLANE: _LEFT, Shape.POLAR: 3 * _RIM}[shape]
    wide = (room - (columns - 1) * between) / columns
    if shape is Shape.GRAPH:
        tall = _CELL * wide if columns > 1 else _HEIGHTS[min(count, len(_HEIGHTS)) - 1]
    else:
        wide = min(wide, _PLANE)
        flattest = max(_FLATTEST, _LOWEST / wide)
        ratio = min(max(ratio, flattest), _TALLEST) if shape is Shape.PLANE else 1.0
        tall = wide * ratio
    rows = math.ceil(count / columns)
    names = max(len(panel.title.split("\n")) if panel.title else 0 for panel in chart.panels)
    first = (_NAME * names + 0.09 if names else 0.0) + (_RIM if shape is Shape.POLAR else 0.0)
    step = tall + (_GAP if shape is Shape.GRAPH else _BELOW) + first
    inset = (room - wide) / 2 if shape is Shape.POLAR and columns == 1 else 0.0
    cells = [
        (
            _LEFT + inset + (k % columns) * (wide + between),
            first + (k // columns) * step,
            wide,
            tall,
        )
        for k in range(count)
    ]
    return cells, rows * step - (step - first - tall)
