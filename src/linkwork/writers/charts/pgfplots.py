"""Charts as pgfplots pictures for LaTeX documents, with their data."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from linkwork.core.drawing.scene import LIGHT, Theme
from linkwork.core.drawing.tikz import comment_lines
from linkwork.core.foundation.names import as_latex
from linkwork.writers.charts.chart import (
    Axis,
    Band,
    Chart,
    ChartTheme,
    Curve,
    Mark,
    Panel,
    Pen,
    Rule,
    Scale,
    Shape,
)

__all__ = ["pgfplots_picture"]

_WIDTH = 120.0  # of a panel [mm]
_HEIGHTS = {Shape.GRAPH: 50.0, Shape.PLANE: 120.0, Shape.POLAR: 90.0}
_GAP = 20.0  # below a panel, for its ticks and label [mm]
_ROUNDING = 1e-17  # what is drawn for residuals of zero, on a logarithmic scale
_MARKS = {"dead point": "*", "change point": "diamond*", "maximum": "triangle*", "station": "*"}
_DASHES = ("solid", "dashed", "dotted", "dashdotted")


def pgfplots_picture(chart: Chart, theme: Theme | ChartTheme = LIGHT) -> str:
    """A chart as a ``tikzpicture`` with an axis for each panel and the numbers of its curves.

    Parameters
    ----------
    chart : Chart
    theme : Theme or ChartTheme
        Its colours.
    """
    colours = ChartTheme.of(theme)
    polar = any(panel.shape is Shape.POLAR for panel in chart.panels)
    needed = "\\usepackage{pgfplots} \\pgfplotsset{compat=1.18}"
    head = comment_lines(
        ": ".join(filter(None, (chart.title, chart.caption))),
        f"Written by Linkwork: needs {needed}" + (" \\usepgfplotslibrary{polar}" if polar else ""),
    )
    tones = {curve.tone for panel in chart.panels for curve in panel.curves}
    tones |= {mark.tone for panel in chart.panels for mark in panel.marks}
    lines = [*head, "\\begin{tikzpicture}"]
    names = {f"tone{tone}": colours.tone(tone) for tone in sorted(tones)}
    names |= {"rule": colours.rule, "faint": colours.faint, "band": colours.band}
    lines += [f"  \\definecolor{{lw{n}}}{{HTML}}{{{colour[1:]}}}" for n, colour in names.items()]
    below = 0.0
    for panel in chart.panels:
        lines += [f"  {line}" for line in _panel(panel, chart.axis, colours, below)]
        below += _HEIGHTS[panel.shape] + _GAP
    return "\n".join([*lines, "\\end{tikzpicture}"]) + "\n"


def _panel(panel: Panel, shared: Axis, theme: ChartTheme, below: float) -> Iterator[str]:
    """The axis of one panel."""
    across = panel.across or shared
    kind = "polaraxis" if panel.shape is Shape.POLAR else "axis"
    tall = _HEIGHTS[panel.shape]
    wide = tall if panel.shape is Shape.POLAR else _WIDTH
    options = [
        f"at={{(0mm,{-below:g}mm)}}", "anchor=north west", "scale only axis",
        f"width={wide:g}mm", f"height={tall:g}mm", "unbounded coords=jump",
        "legend cell align=left", "legend pos=outer north east", "grid=major",
        "grid style={lwrule}", "axis on top=false", f"title={{{as_latex(panel.title)}}}",
    ]  # fmt: skip
    if panel.shape is Shape.PLANE:
        options.append("axis equal image")
    if panel.shape is not Shape.POLAR:
        options += [*_axis("x", across), *_axis("y", panel.axis)]
    yield f"\\begin{{{kind}}}["
    yield from (f"  {option}," for option in options)
    yield "]"
    yield from (_band(band) for band in panel.bands)
    for rule in panel.rules:
        yield _rule(rule)
    turn = 360.0 / across.turn if panel.shape is Shape.POLAR and across.turn else 1.0
    for curve in panel.curves:
        yield from _curve(curve, theme, turn, panel.axis.scale is Scale.ROUNDING)
    for mark in panel.marks:
        yield _mark(mark, turn)
    yield f"\\end{{{kind}}}"


def _band(band: Band) -> str:
    """A range of y across the panel."""
    low, high = "\\pgfkeysvalueof{/pgfplots/xmin}", "\\pgfkeysvalueof{/pgfplots/xmax}"
    corners = f"(axis cs:{low},{band.low:.9g}) rectangle (axis cs:{high},{band.high:.9g})"
    return f"\\fill[lwband] {corners};  % {band.name}"


def _axis(letter: str, axis: Axis) -> Iterator[str]:
    """Label, ends and ticks of a coordinate."""
    yield f"{letter}label={{{as_latex(axis.label)}}}"
    if axis.ends:
        yield f"{letter}min={axis.ends[0]:.9g}, {letter}max={axis.ends[1]:.9g}"
    if axis.scale in (Scale.LOG, Scale.ROUNDING):
        yield f"{letter}mode=log"
    elif axis.ticks:
        yield f"{letter}tick={{{','.join(f'{tick:.9g}' for tick in axis.ticks)}}}"
    elif axis.step and axis.ends:
        low, high = axis.ends
        yield f"{letter}tick={{{low:.9g},{low + axis.step:.9g},...,{high:.9g}}}"


def _curve(curve: Curve, theme: ChartTheme, turn: float, rounding: bool) -> Iterator[str]:
    """A curve with its numbers; what is not finite breaks it."""
    colour = "lwrule" if curve.quiet else f"lwtone{curve.tone}"
    style = [colour, "thick"]
    if curve.pen is Pen.DOTS:
        style += ["only marks", "mark size=0.8pt"]
    else:
        dash = (curve.tone - 1) // len(theme.tones) % len(_DASHES)
        style += [_DASHES[dash], "no marks"]
    if curve.quiet or not curve.name:
        style.append("forget plot")
    y = np.maximum(curve.y, _ROUNDING) if rounding else curve.y
    yield f"\\addplot[{', '.join(style)}] table {{"
    for a, b in zip((curve.x * turn).tolist(), y.tolist(), strict=True):
        yield f"  {a:.12g} {b:.12g}"
    yield "};"
    if not curve.quiet and curve.name:
        yield f"\\addlegendentry{{{as_latex(curve.name)}}}"


def _rule(rule: Rule) -> str:
    """A line across the panel."""
    style = "lwrule" if not rule.kind else "lwfaint, dotted"
    sides = ("ymin", "ymax") if rule.along == "x" else ("xmin", "xmax")
    ends = [f"\\pgfkeysvalueof{{/pgfplots/{side}}}" for side in sides]
    at = f"{rule.at:.9g}"
    places = (f"{at},{end}" if rule.along == "x" else f"{end},{at}" for end in ends)
    path = " -- ".join(f"(axis cs:{place})" for place in places)
    return f"\\draw[{style}] {path};"


def _mark(mark: Mark, turn: float) -> str:
    """A point with its text."""
    symbol = _MARKS.get(mark.kind, "square*")
    style = f"only marks, mark={symbol}, mark size=2pt, lwtone{mark.tone}, forget plot"
    node = f" node[above right, font=\\scriptsize, lwfaint] {{{as_latex(mark.text)}}}"
    place = f"({mark.x * turn:.12g},{mark.y:.12g})"
    return f"\\addplot[{style}] coordinates {{{place}}}{node if mark.text else ''};"
