"""Charts: panels that draw themselves on Matplotlib's axes, and the page around them."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from linkwork.core.drawing.matplotlib_settings import house_settings
from linkwork.core.drawing.pose import lines_within
from linkwork.core.drawing.scene import Theme, text_width
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import as_latex
from linkwork.writers.charts.axes import (
    KEY,
    LINE,
    SMALL,
    TITLE,
    ChartAxes,
    ChartTheme,
    chart_theme,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.legend import Legend

_WIDTH = 6.95  # inches
_HEIGHTS = (3.6, 2.4, 2.1)  # of a graph over the whole width: alone, of two, of more
_LOWEST, _HIGHEST = 1.5, 4.6  # of other panels
_NAME = 0.35  # of the name of a panel
_LEFT = 0.08  # of titles and legend
_BELOW = 0.35  # below the last panel, for labels
_LINES = {TITLE: 0.2, SMALL: 0.17}  # height of a line
_ENTRY = 0.2  # height of a row of the legend
_HANDLE = 4.0  # em: an entry of the legend without its text
_COLUMNS = 4  # of a legend in existing axes
_ROW = 1.7  # height of a row of the legend in existing axes, in font sizes

_PGF = r"""% Written by Linkwork: needs \usepackage{{pgf}}
\begingroup\makeatletter
\begin{{pgfpicture}}%
\pgfpathrectangle{{\pgfpointorigin}}{{\pgfqpoint{{{width:.6f}in}}{{{height:.6f}in}}}}%
\pgfusepath{{use as bounding box, clip}}%
{drawn}\end{{pgfpicture}}%
\makeatother\endgroup
"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """What one set of axes shows.

    Parameters
    ----------
    label : str
        The label of its vertical axis.
    draw : callable
        Draws it.
    ratio : float
        Its height by its width; a graph that is alone in its row is flatter.
    """

    label: str
    draw: Callable[[ChartAxes], None]
    ratio: float = 0.75


@dataclass(frozen=True, kw_only=True, eq=False)
class Chart:
    """Panels in rows of ``columns``.

    Parameters
    ----------
    projection : str
        ``graph``: the panels share their abscissa; ``plane`` or ``polar``: each has both of its
        coordinates.
    """

    title: str
    caption: str
    panels: tuple[Panel, ...]
    columns: int = 1
    projection: str = "graph"

    def figure(self, theme: Theme) -> Figure:
        """The chart as a new figure."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        page = Figure()
        FigureCanvasAgg(page)
        self.draw_on(page, chart_theme(theme))
        return page

    def tikz(self, theme: Theme) -> str:
        """The chart as a picture of PGF for LaTeX documents, in their fonts.

        Matplotlib's writer runs LaTeX to measure texts. Here they are measured in Matplotlib's
        font, so that no LaTeX is needed.
        """
        with house_settings():
            from matplotlib.backends.backend_pgf import RendererPgf

            class Renderer(RendererPgf):
                def draw_text(  # type: ignore[no-untyped-def]  # as in Matplotlib
                    self, gc, x, y, s, prop, angle, ismath=False, mtext=None
                ) -> None:
                    text = as_latex(s)
                    super().draw_text(  # type: ignore[no-untyped-call]
                        gc, x, y, text, prop, angle, ismath, mtext
                    )

                def get_text_width_height_descent(  # type: ignore[no-untyped-def]
                    self, s, prop, ismath
                ) -> Any:
                    return measuring.get_text_width_height_descent(s, prop, ismath)

            page = self.figure(theme)
            measuring = page.canvas.get_renderer()  # type: ignore[attr-defined]  # of Agg
            width, height = page.get_size_inches()
            buffer = io.StringIO()
            page.draw(Renderer(page, buffer))  # type: ignore[no-untyped-call]
        return _PGF.format(width=width, height=height, drawn=buffer.getvalue())

    def draw_on(self, page: Figure, theme: ChartTheme) -> list[Axes]:
        """Draw on an empty figure and set its size; returns the axes of the panels."""
        rows = math.ceil(len(self.panels) / self.columns)
        graph = self.projection == "graph"
        height = rows * self._height() + _BELOW
        page.set_size_inches(_WIDTH, height)
        page.set_layout_engine("constrained", h_pad=0.06, w_pad=_LEFT, hspace=0.0, wspace=0.02)
        cells = page.subplots(
            rows,
            self.columns,
            sharex=graph,
            sharey="row" if graph else False,
            squeeze=False,
            subplot_kw={"projection": "polar" if self.projection == "polar" else None},
        ).flat
        drawn = [cells[k] for k in range(len(self.panels))]
        for empty in list(cells)[len(drawn) :]:
            empty.remove()
        for k, (ax, panel) in enumerate(zip(drawn, self.panels, strict=True)):
            ax.set_gid(f"panel:{k + 1}")
            panel.draw(ChartAxes(ax=ax, theme=theme))
            last = k + self.columns >= len(drawn)
            if graph:
                ax.tick_params(labelbottom=last)
                ax.set_xlabel(ax.get_xlabel() if last else "")
                ax.set_ylabel("" if k % self.columns else ax.get_ylabel())
        page.align_ylabels(drawn)
        self._head(page, _legend_entries(drawn), height, theme)
        return drawn

    def _height(self) -> float:
        """The height of a row of panels."""
        if self.projection == "graph" and self.columns == 1:
            return _HEIGHTS[min(len(self.panels), len(_HEIGHTS)) - 1]
        wide = _WIDTH / self.columns - 0.7
        ratio = max(panel.ratio for panel in self.panels)
        return min(max(ratio * wide, _LOWEST), _HIGHEST) + _NAME

    def _head(
        self, page: Figure, entries: dict[str, Any], height: float, theme: ChartTheme
    ) -> None:
        """Title, caption and legend above the panels, which have the height ``height``."""
        room = (_WIDTH - 2 * _LEFT) * 72
        texts = [(self.title, TITLE, theme.ink), (self.caption, SMALL, theme.faint)]
        blocks = [(lines_within(t, room / size), size, colour) for t, size, colour in texts]
        widest = max((text_width(name, 1.0) for name in entries), default=0.0) + _HANDLE
        columns = max(1, min(len(entries), int(room / KEY / widest)))
        head = _LEFT + sum(len(lines) * _LINES[size] for lines, size, _ in blocks)
        head += _ENTRY * math.ceil(len(entries) / columns)
        height += head
        page.set_size_inches(_WIDTH, height)
        page.set_facecolor(theme.background)
        top = _LEFT
        for lines, size, colour in blocks:
            if lines:
                place = (_LEFT / _WIDTH, 1.0 - top / height)
                style: dict[str, Any] = {"fontsize": size, "color": colour, "va": "top"}
                page.text(*place, "\n".join(lines), parse_math=False, in_layout=False, **style)
            top += len(lines) * _LINES[size]
        left = _LEFT / _WIDTH
        if entries:
            place = (left, 1.0 - top / height)
            options = {"ncols": columns, "borderaxespad": 0.0, "borderpad": 0.0}
            legend = _write_legend(
                page, entries, theme, loc="upper left", bbox_to_anchor=place, **options
            )
            legend.set_in_layout(False)
        engine: Any = page.get_layout_engine()
        engine.set(rect=(0.0, 0.0, 1.0, 1.0 - head / height))

    def draw_in(self, axes: Sequence[Axes], theme: ChartTheme) -> None:
        """Draw into existing axes, title and legend above the first ones.

        Raises
        ------
        InputError
            If the number of axes differs from that of panels, or a polar panel needs polar axes.
        """
        if len(axes) != len(self.panels):
            labels = ", ".join(panel.label for panel in self.panels)
            raise InputError(
                f"the plot has {len(self.panels)} panels ({labels}), but there are {len(axes)} "
                "axes: give one for each, or fewer columns"
            )
        polar = self.projection == "polar"
        if any((ax.name == "polar") != polar for ax in axes):
            raise InputError(
                'this plot needs polar axes: plt.subplot(projection="polar")'
                if polar
                else "this plot needs axes that are not polar: plt.subplot()"
            )
        for ax, panel in zip(axes, self.panels, strict=True):
            panel.draw(ChartAxes(ax=ax, theme=theme))
        first, entries = axes[0], _legend_entries(axes)
        if entries:
            place = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.1 if polar else 1.0)}
            _write_legend(first, entries, theme, ncols=_COLUMNS, borderaxespad=0.2, **place)
        pad = 6.0 + math.ceil(len(entries) / _COLUMNS) * _ROW * KEY + (16.0 if polar else 0.0)
        lines = "\n".join(filter(None, (self.title, first.get_title(loc="left"))))
        style: dict[str, Any] = {"fontsize": TITLE, "color": theme.ink, "parse_math": False}
        first.set_title(lines, loc="left", pad=pad, **style)


def _legend_entries(drawn: Sequence[Axes]) -> dict[str, Any]:
    """The artists that the legend explains by their names: curves, then marks, then bands."""
    artists: dict[str, Any] = {}
    for ax in drawn:
        for artist, name in zip(*ax.get_legend_handles_labels(), strict=True):
            artists.setdefault(name, artist)
    curves = [name for name, artist in artists.items() if artist.get_gid() == f"curve:{name}"]
    return {name: artists[name] for name in dict.fromkeys([*curves, *artists])}


def _write_legend(
    where: Axes | Figure, entries: dict[str, Any], theme: ChartTheme, **options: Any
) -> Legend:
    legend = where.legend(
        list(entries.values()),
        list(entries),
        frameon=False,
        fontsize=KEY,
        labelcolor=theme.faint,
        handlelength=1.6,
        **options,
    )
    for line in legend.get_lines():
        if line.get_linestyle() != "None":  # a curve, wider where covered
            line.set(linewidth=LINE, marker="")
    return legend
