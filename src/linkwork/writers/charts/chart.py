"""Columns of a motion for charts: labels, units and scales."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwork.core.drawing.matplotlib_writer import house_settings
from linkwork.core.drawing.pose import lines_within, printed_name
from linkwork.core.drawing.scene import Theme, text_width
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import as_latex, find_spelling, pretty
from linkwork.core.results.listing import coordinates_off_ground
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Asked, Group
from linkwork.core.results.quantity import Kind, Rate
from linkwork.writers.charts.axes import KEY, LINE, SMALL, TITLE, ChartAxes, ChartTheme, chart_theme

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.legend import Legend

#: Name of the time in ``against``.
TIME = "time"

#: Text columns of a table.
_TEXTS = ("status", "certified", "branch", "limit")

#: Scales of evidence that is scattered; other evidence is drawn as lines over a logarithmic axis.
_SCATTERED = {"residual": "rounding", "iterations": "count"}

# ----------------------------------------------------------------------
# Labels of columns in figures: ``θ₁₃ [deg]``, ``ds₁₆/dθ₁₂ [mm/rad]``.


def with_unit(text: str, unit: str) -> str:
    """``ds₁₆/dθ₁₂ [mm/rad]``; without brackets if there is no unit."""
    printed = unit.replace("^2", "²").replace("^3", "³").replace("^4", "⁴")
    return f"{text} [{printed}]" if unit.replace("^2", "") not in ("", "1/1") else text


def rate_label(name: str, rate: Rate, driver: str) -> str:
    """A rate of a quantity: ``ds₁₆/dθ₁₂``, ``velocity of s₁₆``; ``driver`` is the input."""
    if rate.by_time:
        return f"{rate.value} of {printed_name(name)}"
    power = "" if rate.order == 1 else "²"
    return f"d{power}{_term(name)}/d{_term(driver)}{power}"


def size_label(point: str, rate: Rate, driver: str) -> str:
    """The magnitude of a point's rate: ``|velocity of B|``."""
    return f"|{rate_label(point, rate, driver)}|"


def _term(name: str) -> str:
    """A name after the d of a derivative; words are separated by a space."""
    stem = pretty(name).partition(".")[0].rstrip("0123456789'")
    return printed_name(name) if len(stem) == 1 else f" {printed_name(name)}"


# ----------------------------------------------------------------------
# Columns.


@dataclass(frozen=True, kw_only=True, eq=False)
class Column:
    """One column of a motion.

    Parameters
    ----------
    name : str
        As in the motion, ``theta13.d1``.
    label, unit : str
        The printed label without unit, and the unit as in tables.
    measure : str
        Kind of quantity: ``angle``, ``length``, ``velocity``; columns with equal measure and unit
        share a panel. "" for numbers with a separate panel.
    values : array (N,)
        File units, NaN where there is no position.
    turn : float
        A full turn in that unit, 0 unless it is an angle.
    slope : array (N,), optional
        For an angle that may jump: its derivative with respect to the input, in these units.
    size : float
        Typical size: differences below 1e-9 of it are rounding.
    scale : str
        Scale of its axis, as in :func:`linkwork.writers.charts.axes.set_scale`.
    dots : bool
        Whether neighbouring rows have nothing to do with each other: no line joins them.
    """

    name: str
    label: str
    unit: str
    measure: str
    values: Array
    turn: float = 0.0
    slope: Array | None = None
    size: float = 1.0
    scale: str = "linear"
    dots: bool = False

    @property
    def rate(self) -> bool:
        """Whether it is a derivative, which is unbounded at dead points."""
        return Rate.split(self.name)[1] is not None


def lead_of(motion: Motion) -> str:
    """The leading input: the first one that changes from row to row."""
    rows = motion.asked
    moving = (name for name, values in motion.inputs.items() if np.ptp(values[rows]))
    return next(moving, next(iter(motion.inputs)))


def usual_columns(motion: Motion) -> tuple[str, ...]:
    """The unknowns; without unknowns the outputs, or else the coordinates of the traced points, or
    of all moving ones.

    Raises
    ------
    InputError
        If the motion has none of these.
    """
    traced = [f"{point}.{axis}" for point in motion.skeleton.traced for axis in "xy"]
    names = tuple(motion.unknowns) or tuple(motion.outputs) or tuple(traced)
    names = names or coordinates_off_ground(motion)
    if not names:
        raise InputError(f'"{motion.mechanism}" has no unknowns: name the columns to plot')
    return names


def column_of(motion: Motion, name: str) -> Column:
    """A column by name: quantity, input, coordinate, rate, or evidence such as ``residual``.

    ``B.velocity`` of a point B is the magnitude of the vector.

    Raises
    ------
    UnknownNameError
        Lists the existing names; for rates with respect to time, states the missing speed.
    InputError
        If the column is text, or a point without coordinate.
    """
    if name in _TEXTS:
        raise InputError(f'"{name}" is text and cannot be plotted')
    point = find_spelling(name, motion.points)
    known = motion.quantities.own
    if point in motion.points and find_spelling(name, known) not in known:
        raise InputError(
            f'"{point}" is a point: plot a coordinate, "{point}.x" or "{point}.y", or its '
            'path, kind="path" (--kind path)'
        )
    quantity = motion.quantity(name)
    if quantity.group is Group.EVIDENCE:
        return _evidence(motion, quantity)
    if quantity.rate is not None:
        return _rate(motion, quantity, quantity.rate)
    units, kind, lead = motion.units, quantity.own.kind, lead_of(motion)
    turn = units.angle.turn if kind is Kind.ANGLE else 0.0
    slope = None
    if quantity.group is not Group.INPUT and kind is Kind.ANGLE:
        by_input = 1.0 if motion.input_units[lead] != units.angle.value else units.angle.radians
        slope = quantity.jet(motion).d1 * by_input / units.scale(kind)
    return Column(
        name=quantity.name,
        label=printed_name(quantity.name),
        unit=quantity.unit,
        measure=quantity.measure,
        values=motion[quantity.name],
        turn=turn,
        slope=slope,
        size=turn or (_reach(motion) if kind is Kind.LENGTH else 1.0),
    )


def _evidence(motion: Motion, quantity: Asked) -> Column:
    """A number of the evidence of positions."""
    shown = motion.found
    if quantity.name == "condition":  # infinite at dead points, up to rounding
        shown = shown & ~np.isin(motion.limit, ("dead point", "change point"))
    values = np.where(shown, motion[quantity.name].astype(float), np.nan)
    label = quantity.name.replace("_", " ")
    return Column(
        name=quantity.name,
        label=label,
        unit="",
        measure="",
        values=values,
        scale=_SCATTERED.get(quantity.name, "log"),
        dots=quantity.name in _SCATTERED,
    )


def _rate(motion: Motion, quantity: Asked, rate: Rate) -> Column:
    """A rate of a quantity, or its magnitude for a point."""
    base, of_point = quantity.own, quantity.group is Group.POINT
    size = _reach(motion) if base.kind is Kind.LENGTH else 1.0
    return Column(
        name=quantity.name,
        label=(size_label if of_point else rate_label)(base.name, rate, lead_of(motion)),
        unit=quantity.unit,
        measure=quantity.measure,
        values=motion[quantity.name],
        size=size * abs(motion.speed or 1.0) ** (rate.order if rate.by_time else 0),
    )


def _reach(motion: Motion) -> float:
    """The typical length: the extent of the mechanism's points."""
    places = [series.value for pair in motion.points.values() for series in pair]
    finite = [p[np.isfinite(p)] for p in places]
    return max((float(np.ptp(p)) for p in finite if len(p)), default=0.0) or 1.0


def abscissa_of(motion: Motion, against: str = "") -> Column:
    """The abscissa of a motion: the leading input, ``time``, or any column.

    Raises
    ------
    InputError
        If there is no input speed, or as :func:`column_of`.
    """
    if not against:
        return column_of(motion, lead_of(motion))
    if against == TIME and TIME not in motion.quantities.own:
        return _time(motion)
    return column_of(motion, against)


def _time(motion: Motion) -> Column:
    """Time since the first row, at constant speed of the leading input."""
    lead = lead_of(motion)
    if motion.speed is None:
        raise InputError(
            f"a plot over time needs the speed of {lead}: set it in [input], or plot against {lead}"
        )
    if len(set(motion.branch) - {""}) > 1:
        raise InputError(
            f"several branches have no common time: {lead} reverses between them, so its speed "
            f"is not constant; plot against {lead}, or sweep one branch"
        )
    values = motion.inputs[lead]
    angle = motion.input_units[lead] == motion.units.angle.value
    unit = motion.units.angle.radians if angle else 1.0
    passed = (values - values[0]) * unit / motion.speed
    return Column(name=TIME, label=TIME, unit="s", measure=TIME, values=passed)


# ----------------------------------------------------------------------
# Charts: panels that draw themselves on Matplotlib's axes, and the page around them.


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
