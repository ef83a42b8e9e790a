"""Matplotlib's default settings while a picture is drawn, independent of the user's."""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from linkwork.core.drawing.mechanism_scene import TALLEST, Sheet
from linkwork.core.drawing.pose import lines_within
from linkwork.core.drawing.scene import (
    LIGHT,
    XY,
    Arc,
    Box,
    Disc,
    Hatch,
    Polygon,
    Polyline,
    Primitive,
    Scene,
    Text,
    Theme,
    round_down,
)
from linkwork.core.drawing.vector_files import tikz_picture
from linkwork.core.foundation.errors import InputError, MissingPackageError
from linkwork.core.foundation.files import as_path, save_bytes, suffix_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@contextmanager
def house_settings() -> Iterator[None]:
    """Use Matplotlib's defaults instead of the user's settings."""
    try:
        import matplotlib
    except ImportError as error:
        raise MissingPackageError("drawing needs Matplotlib: pip install matplotlib") from error
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams["svg.hashsalt"] = "linkwork"
        matplotlib.rcParams["path.simplify"] = False  # files show the coordinates of the scene
        matplotlib.rcParams["pdf.fonttype"] = 42  # journals reject PDF files with Type 3 fonts
        matplotlib.rcParams["pgf.rcfonts"] = False  # LaTeX files use the fonts of the document
        yield


# ----------------------------------------------------------------------
# Scenes as PNG, SVG and PDF, and as Matplotlib figures for notebooks.
#
# Matplotlib is needed only here and for charts, and is imported only for drawing. The
# object-oriented interface is used throughout: no window, no global figure.


#: Formats of image files.
IMAGE_FORMATS = ("png", "svg", "pdf")

_LONG_SIDE = 6.0  # longer side of the drawing [inches]
_SHORT_SIDE = 2.2  # minimum, so that a flat mechanism has room, ticks and a title
_LEFT, _RIGHT, _BELOW, _LINE = 0.75, 0.2, 0.6, 0.19  # margins and title line [inches]
_TITLE, _SMALL = 11.0, 9.0  # font sizes in points
_TICK_EVERY = 1.0  # approximate distance [inches]
_MARGIN, _BETWEEN = 0.15, 0.15  # margins of pictures side by side [inches]
_DATELESS: dict[str, dict[str, str | None]] = {
    "png": {"Software": "Linkwork"},
    "svg": {"Date": None, "Creator": "Linkwork"},
    "pdf": {"CreationDate": None, "Creator": "Linkwork"},
}


class Chart(Protocol):
    """What draws itself in the colours of a theme, on a figure or as text for LaTeX."""

    def figure(self, theme: Theme) -> Figure: ...

    def tikz(self, theme: Theme) -> str: ...


def image(scene: Scene | Chart | Sheet, kind: str, *, dpi: float, theme: Theme) -> bytes:
    """A scene, chart or sheet as the content of a PNG, SVG or PDF file."""
    buffer = io.BytesIO()
    with house_settings():
        if isinstance(scene, Scene):
            page = figure(scene, theme=theme)
        else:
            page = _sheet_figure(scene, theme) if isinstance(scene, Sheet) else scene.figure(theme)
        page.savefig(buffer, format=kind, dpi=dpi, metadata=_DATELESS[kind])
    return buffer.getvalue()


def figure(scene: Scene, ax: Axes | None = None, *, theme: Theme = LIGHT) -> Figure:
    """A scene as a new Matplotlib figure, or drawn into existing axes.

    Returns
    -------
    Figure
        The figure with the drawing. In existing axes, line widths and fonts fit their current
        size.
    """
    with house_settings():
        if ax is None:
            ax = _page(scene, theme)
        else:
            _dress(ax, scene, theme, scene.box.grown(0.03 * scene.measures.size))
            ax.set_title("\n".join(filter(None, (scene.title, scene.caption))), fontsize=_TITLE)
        Brush(ax, scene, theme).draw_all(scene)
        found = ax.get_figure(root=True)
    assert found is not None
    return found


def _sheet_figure(sheet: Sheet, theme: Theme) -> Figure:
    """Scenes side by side in frames without ticks, with equal scale."""
    columns, cell = sheet.columns, sheet.cell
    rows = math.ceil(len(sheet.scenes) / columns)
    wide = cell - _BETWEEN
    names = [_name_lines(scene.title, wide * 72 / _SMALL) for scene in sheet.scenes]
    size = max(scene.measures.size for scene in sheet.scenes)
    view = sheet.view.grown(0.03 * size)
    tall = min(max(wide * view.height / view.width, 0.35 * wide), TALLEST * wide)
    scale = max(view.width / wide, view.height / tall)
    view = view.sized(scale * wide, scale * tall)
    width = columns * cell + 2 * _MARGIN - _BETWEEN
    heading = _heading(sheet.title, sheet.caption, width - 2 * _MARGIN, theme)
    above = _MARGIN + _LINE * len(heading)
    step = tall + _BETWEEN + _LINE * max(map(len, names))
    height = above + rows * step + _MARGIN
    page = _blank(width, height, theme)
    _write_heading(page, heading, _MARGIN)
    for k, (scene, name) in enumerate(zip(sheet.scenes, names, strict=True)):
        row, column = divmod(k, columns)
        corner = (_MARGIN + column * cell, height - above - (row + 1) * step)
        ax = page.add_axes((corner[0] / width, corner[1] / height, wide / width, tall / height))
        _dress(ax, scene, theme, view)
        ax.tick_params(bottom=False, left=False, labelbottom=False, labelleft=False)
        ax.set(xlabel="", ylabel="")
        for spine in ax.spines.values():
            spine.set_visible(True)
        text = "\n".join(name)
        ax.set_title(text, fontsize=_SMALL, color=theme.ink, loc="left", pad=4.0, parse_math=False)
        Brush(ax, scene, theme).draw_all(scene)
    return page


def _blank(width: float, height: float, theme: Theme) -> Figure:
    """An empty page [inches]."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    page = Figure(figsize=(width, height), facecolor=theme.background)
    FigureCanvasAgg(page)
    return page


def _name_lines(name: str, width: float) -> list[str]:
    """The name of a configuration in lines of at most ``width`` [em], broken at its hyphens."""
    lines = lines_within(name.replace("-", "- "), width)
    return [line.replace("- ", "-") for line in lines] or [""]


def _heading(title: str, caption: str, width: float, theme: Theme) -> list[tuple[str, float, str]]:
    """Lines of title and caption with their font sizes and colours; ``width`` in inches."""
    heading = [(line, _TITLE, theme.ink) for line in lines_within(title, width * 72 / _TITLE)]
    small = lines_within(caption, width * 72 / _SMALL)
    return heading + [(line, _SMALL, theme.faint) for line in small]


def _write_heading(page: Figure, heading: list[tuple[str, float, str]], left: float) -> None:
    """Write the lines of a heading, ``left`` inches from the edge."""
    width, height = page.get_size_inches()
    for k, (line, size, colour) in enumerate(heading):
        place = (left / width, 1 - (0.26 + k * _LINE) / height)
        page.text(*place, line, fontsize=size, color=colour, parse_math=False)


def _page(scene: Scene, theme: Theme) -> Axes:
    """Create axes on a page sized for the drawing, its margins and its title."""
    view = scene.box.grown(0.03 * scene.measures.size)
    scale = _LONG_SIDE / max(view.width, view.height)
    width, height = (max(_SHORT_SIDE, scale * side) for side in (view.width, view.height))
    view = view.sized(width / scale, height / scale)
    page = width + _LEFT + _RIGHT
    left = _LEFT if page > 4 else 0.2
    heading = _heading(scene.title, scene.caption, page - left - 0.2, theme)
    above = 0.2 + _LINE * len(heading)
    total = height + _BELOW + above
    drawing = _blank(page, total, theme)
    ax = drawing.add_axes((_LEFT / page, _BELOW / total, width / page, height / total))
    _dress(ax, scene, theme, view)
    _write_heading(drawing, heading, left)
    return ax


def _dress(ax: Axes, scene: Scene, theme: Theme, view: Box) -> None:
    """Style the axes: equal scales, two thin lines with few ticks and the length unit."""
    from matplotlib.ticker import MultipleLocator

    ax.set_facecolor(theme.background)
    ax.set_xlim(view.left, view.right)
    ax.set_ylim(view.bottom, view.top)
    ax.set_aspect("equal", adjustable="datalim")
    ax.apply_aspect()
    scale = _points_per_unit(ax)
    short = min(view.width, view.height) * scale / 72
    spacing = round_down(1.4 * min(_TICK_EVERY, max(0.5 * short, 0.5)) * 72 / scale, (1, 2, 5))
    for axis, name in ((ax.xaxis, "x"), (ax.yaxis, "y")):
        axis.set_major_formatter(lambda value, _: f"{value:.6g}".replace("-", "\u2212"))
        axis.set_major_locator(MultipleLocator(spacing))
        axis.set_label_text(
            f"{name} [{scene.unit}]" if scene.unit else name,
            fontsize=_SMALL,
            color=theme.faint,
            parse_math=False,
        )
    ax.tick_params(length=3, width=0.6, colors=theme.faint, labelsize=0.9 * _SMALL)
    for side, spine in ax.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(theme.faint)
        spine.set_linewidth(0.6)


def _points_per_unit(ax: Axes) -> float:
    """Points (1/72 inch) per length unit of the mechanism."""
    (left, _), (right, _) = ax.transData.transform([(0.0, 0.0), (1.0, 0.0)])
    root = ax.get_figure(root=True)
    assert root is not None
    return float(right - left) * 72 / root.dpi


class Brush:
    """Translates primitives into artists of axes."""

    def __init__(self, ax: Axes, scene: Scene, theme: Theme) -> None:
        self.ax = ax
        self.theme = theme
        self.points = _points_per_unit(ax)
        self.stroke = scene.measures.stroke * self.points

    def draw_all(self, scene: Scene) -> None:
        for primitive in scene.primitives:
            self.draw(primitive)

    def draw(self, primitive: Primitive) -> None:
        match primitive:
            case Polyline() | Arc():
                self._line([primitive.shaft], primitive)
                if primitive.arrow_head:
                    self._area(primitive.arrow_head, primitive, width=0.3)
            case Hatch():
                self._line(primitive.strokes, primitive)
            case Polygon():
                self._area(primitive.points, primitive)
            case Disc():
                self._disc(primitive)
            case Text():
                self._text(primitive)

    def _common(self, primitive: Primitive) -> dict[str, Any]:
        # The group id contains role and part, for editors and tests of SVG files.
        gid = f"{'faint-' if primitive.fade else ''}{primitive.role.name.lower()}:{primitive.of}"
        return {"zorder": 100 + primitive.layer, "gid": gid, "clip_on": False}

    def _line(self, lines: tuple[tuple[XY, ...], ...] | list[Any], primitive: Primitive) -> None:
        from matplotlib.collections import LineCollection

        style = self.theme.styles[primitive.role]
        self.ax.add_collection(
            LineCollection(
                list(lines),
                colors=self.theme.line(primitive),
                linewidths=style.width * self.stroke * (1 - 0.5 * primitive.fade),
                linestyles=[(0, style.dashes)] if style.dashes else "solid",
                capstyle="round",
                joinstyle="round",
                **self._common(primitive),
            ),
            autolim=False,
        )

    def _area(self, corners: tuple[XY, ...], primitive: Primitive, width: float = 1.0) -> None:
        from matplotlib.patches import Polygon as PolygonPatch

        self.ax.add_artist(
            PolygonPatch(list(corners), **self._faces(primitive, width), joinstyle="round")
        )

    def _disc(self, primitive: Disc) -> None:
        from matplotlib.patches import Circle

        self.ax.add_artist(Circle(primitive.centre, primitive.radius, **self._faces(primitive)))

    def _faces(self, primitive: Primitive, width: float = 1.0) -> dict[str, Any]:
        from matplotlib.colors import to_rgba

        style = self.theme.styles[primitive.role]
        line, fill = self.theme.line(primitive), self.theme.fill(primitive)
        return {
            "facecolor": to_rgba(fill, style.opacity ** (1 + primitive.fade)) if fill else "none",
            "edgecolor": line or "none",
            "linewidth": style.width * width * self.stroke if line else 0.0,
            "linestyle": (0, style.dashes) if style.dashes else "solid",
            **self._common(primitive),
        }

    def _text(self, primitive: Text) -> None:
        self.ax.text(
            *primitive.start,
            primitive.text,
            fontsize=primitive.height * self.points,
            color=self.theme.fill(primitive),
            ha=("left", "center", "right")[primitive.align + 1],
            va="baseline",
            parse_math=False,
            **self._common(primitive),
        )


# ----------------------------------------------------------------------
# Pictures as files: PNG, SVG and PDF by Matplotlib, TikZ for LaTeX documents.


_TIKZ = "tikz"
#: File formats by suffix.
FORMATS = (*IMAGE_FORMATS, _TIKZ)


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
        return image(scene, kind, dpi=dpi, theme=theme)
    if isinstance(scene, Sheet):
        raise InputError("a TikZ picture shows one position or a chart: draw each position alone")
    if isinstance(scene, Scene):
        return tikz_picture(scene, theme).encode()
    return scene.tikz(theme).encode()
