"""Results as HTML for notebooks: a picture and a short table, no script, light and dark.

This module solves nothing. A result that cannot be drawn (a mechanism without points, a position
that was not solved) is shown as a table only.
"""

from __future__ import annotations

import html
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from importlib import resources
from typing import Any

import numpy as np

from linkwork.app.pages.animation import shown_motions
from linkwork.app.pages.moving_scene import moving_scene
from linkwork.app.pages.offline_page import page_json
from linkwork.app.pages.page_building import Loops, motion_page
from linkwork.circuits.results import (
    Circuits,
    Configurations,
    circuits_summary,
    configurations_summary,
)
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.drawing.annotations import Force, SceneOptions
from linkwork.core.drawing.mechanism_scene import configuration_sheet, reach_of, scene_of
from linkwork.core.drawing.paths import faint_symbols, further_positions
from linkwork.core.drawing.pose import Pose, reached_caption
from linkwork.core.drawing.scene import DARK, LIGHT, Box, Scene
from linkwork.core.drawing.vector_files import Inks, inline_svg
from linkwork.core.foundation.errors import InputError, choices
from linkwork.core.foundation.loading import installed_with
from linkwork.core.motion.iterating import moving_loops
from linkwork.core.results.motion import Motion, motion_summary
from linkwork.core.results.position import Position, position_summary
from linkwork.core.results.tables import Summary

_CLASS = "linkwork-shown"
_LONGEST, _IN_ROW, _OF_CIRCUIT = 380.0, 230.0, 310.0  # longer sides of pictures [CSS px]
_LARGER = 1.3  # enlargement of names, for legibility at that size
_FAINT = 3  # further positions of a motion
_MOST = 12  # pictures side by side

# These rules take precedence over the style sheets of notebooks, especially for tables.
_LAYOUT = """
.linkwork-shown{display:inline-block;box-sizing:border-box;max-width:100%;padding:12px 16px;
border-radius:10px;border:1px solid color-mix(in srgb,COLOUR-FAINT 35%,COLOUR-PAGE);
background:COLOUR-PAGE;color:COLOUR-INK;
font:14px/1.45 system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans","DejaVu Sans",sans-serif}
.linkwork-shown .what{font-weight:600;margin-bottom:8px}
.linkwork-shown .both{display:flex;flex-wrap:wrap;gap:8px 24px;align-items:flex-start}
.linkwork-shown .pictures{display:flex;flex-wrap:wrap;gap:8px 16px}
.linkwork-shown figure{margin:0!important;max-width:100%}
.linkwork-shown figcaption{font-size:13px;text-align:center}
.linkwork-shown table{border-collapse:collapse!important;border:0!important;margin:0!important;
font-size:13px!important;font-variant-numeric:tabular-nums;color:inherit!important}
.linkwork-shown tr{background:none!important}
.linkwork-shown th,.linkwork-shown td{padding:2px 14px 2px 0!important;border:0!important;
text-align:left!important;vertical-align:top;max-width:44em;white-space:pre-wrap;color:inherit!important}
.linkwork-shown th{font-weight:400!important;white-space:nowrap;opacity:.72}
.linkwork-shown math{font-size:15px;display:math}
""".replace("\n", "")


def position_html(position: Position) -> str:
    """A position: picture, unknowns, certificate."""
    return _position(position_summary(position), position)


def mechanism_html(what: str, start: Position, equations: Sequence[tuple[str, str]] = ()) -> str:
    """A mechanism at its start: the input and the unknowns there, the loop equations.

    Parameters
    ----------
    what : str
        Its name and a short description.
    start : Position
        If it was not solved, the table gives the reason.
    equations : sequence of (str, str)
        Labels and MathML of the loop equations.
    """
    driven = [
        (name, f"{value:.10g} {start.input_units[name]}") for name, value in start.input.items()
    ]
    return _position(Summary(what, (*driven, *position_summary(start).rows)), start, equations)


def motion_html(motion: Motion) -> str:
    """A motion: its first position, faint further positions, ranges, limits, certificates."""
    inks, pictures = Inks(), []
    if motion.points and motion.found.any():
        scene, view = _motion_picture(motion, reach_of(motion))
        pictures = [_figure(replace(scene, title=motion.mechanism), inks, _LONGEST, view)]
    return _element(motion_summary(motion), pictures, inks)


def configurations_html(configurations: Configurations) -> str:
    """Every configuration as a picture, all of one scale, and as a row."""
    inks, pictures = Inks(), []
    if len(configurations) and configurations[0].points:
        sheet = configuration_sheet(configurations)
        pictures = [
            _figure(scene, inks, _IN_ROW, sheet.view, scene.title) for scene in sheet.scenes[:_MOST]
        ]
    return _element(configurations_summary(configurations), pictures, inks)


def circuits_html(circuits: Circuits) -> str:
    """Every circuit as a picture, all of one scale, and its branches as rows."""
    inks, pictures = Inks(), []
    drawn = [c for c in circuits if c.motion.points and c.motion.found.any()][:_MOST]
    if drawn:
        within = Box.around(corner for c in drawn for corner in reach_of(c.motion).corners)
        scenes = [_motion_picture(circuit.motion, within) for circuit in drawn]
        view = Box.around(corner for _, picture in scenes for corner in picture.corners)
        pictures = [
            _figure(replace(scene, title=circuit.name), inks, _OF_CIRCUIT, view, circuit.name)
            for circuit, (scene, _) in zip(drawn, scenes, strict=True)
        ]
    return _element(circuits_summary(circuits), pictures, inks)


def summary_html(summary: Summary) -> str:
    """A result without pictures."""
    return _element(summary, [], Inks())


def _position(
    summary: Summary, position: Position, equations: Sequence[tuple[str, str]] = ()
) -> str:
    inks, pictures = Inks(), []
    if position.status.ok and position.points:
        scene = scene_of(position, options=SceneOptions(larger=_LARGER))
        pictures = [_figure(scene, inks, _LONGEST)]
    return _element(summary, pictures, inks, equations)


def _motion_picture(motion: Motion, within: Box) -> tuple[Scene, Box]:
    """The picture of a motion: its first position, faint further positions, and the box of all."""
    moving = moving_scene(motion, within=within)
    pose = Pose.at_row(motion, int(np.flatnonzero(motion.found)[0]))
    faint = faint_symbols(further_positions(pose, motion, _FAINT), moving.scene.measures)
    scene = replace(
        moving.scene,
        primitives=(*moving.scene.primitives, *faint),
        caption=reached_caption(motion),
    )
    return scene, moving.view


def _figure(
    scene: Scene, inks: Inks, longest: float, view: Box | None = None, name: str = ""
) -> str:
    below = f"<figcaption>{html.escape(name)}</figcaption>" if name else ""
    return f"<figure>{inline_svg(scene, inks, longest=longest, view=view)}{below}</figure>"


def _element(
    summary: Summary,
    pictures: Sequence[str],
    inks: Inks,
    equations: Sequence[tuple[str, str]] = (),
) -> str:
    """The complete block: heading, pictures, table; valid XML, so that any page can contain it."""
    layout = _LAYOUT
    for word, light, dark in (
        ("COLOUR-FAINT", LIGHT.faint, DARK.faint),
        ("COLOUR-PAGE", LIGHT.background, DARK.background),
        ("COLOUR-INK", LIGHT.ink, DARK.ink),
    ):
        layout = layout.replace(word, inks.of(light, dark))
    cells = [(html.escape(name), html.escape(text)) for name, text in summary.rows]
    cells += [(html.escape(label), mathml) for label, mathml in equations]
    shown = f'<div class="pictures">{"".join(pictures)}</div>' if pictures else ""
    return (
        f'<div class="{_CLASS}"><style>{inks.rules(_CLASS)}{layout}</style>'
        f'<div class="what">{html.escape(summary.head)}</div>'
        f'<div class="both">{shown}<table>{_rows(cells)}</table></div></div>'
    )


def _rows(cells: Iterable[tuple[str, str]]) -> str:
    body = "".join(f'<tr><th scope="row">{name}</th><td>{text}</td></tr>' for name, text in cells)
    return f"<tbody>{body}</tbody>"


# ----------------------------------------------------------------------
# A motion as a notebook widget: the front end of pages, synchronised with Python.
#
# Only this module uses anywidget, and imports it on first use.


def motion_widget(motion: Motion) -> Any:
    """One motion; see :meth:`linkwork.core.results.motion.Motion.widget`."""
    return motions_widget({"motion": motion})


def motions_widget(
    motions: Mapping[str, Motion],
    *,
    equations: Sequence[tuple[str, str]] = (),
    loops: Loops | None = None,
    forces: Sequence[Force] = (),
) -> Any:
    """A widget that plays motions of one mechanism; its user selects, plays and drags them.

    Parameters
    ----------
    motions : Mapping[str, Motion]
        By the name of the circuit or configuration, in the order of the widget. Motions without
        any position are left out.
    equations : sequence of (str, str)
        Labels and MathML of the loop equations.
    loops : callable, optional
        See :func:`~linkwork.app.pages.page_building.motion_page`.
    forces : sequence of Force
        Drawn as arrows.

    Returns
    -------
    anywidget.AnyWidget
        Its traits ``configuration`` (a name) and ``row`` (the number of a row of that motion, from
        0) follow the actions of the user and can be set.

    Raises
    ------
    InputError
        If there is nothing to draw.
    MissingPackageError
        If anywidget is not installed.
    """
    kind = _widget_class()
    data = motion_page(motions, equations=equations, loops=loops, forces=forces)
    page = json.loads(page_json(data))
    rows = {name: np.flatnonzero(m.found) for name, m in motions.items() if m.found.any()}
    shown = motions[next(iter(rows))]
    solved_rows = {name: frozenset(solved_rows.tolist()) for name, solved_rows in rows.items()}
    return kind(page, solved_rows, motion_html(shown))


@lru_cache
def _widget_class() -> Any:
    """The class of the widget, created at its first use, when anywidget is imported."""
    with installed_with("notebook", "widgets need anywidget"):
        import anywidget
        import traitlets
    script = resources.files("linkwork.app") / "static" / "widget.js"

    # No types from here on: the type checker may run without anywidget and traitlets.
    class MotionWidget(anywidget.AnyWidget):  # type: ignore[misc]
        """The displayed row and motion; rejects rows and names that do not exist."""

        _esm = script.read_text(encoding="utf-8")
        page = traitlets.Dict().tag(sync=True)
        configuration = traitlets.Unicode().tag(sync=True)
        row = traitlets.Int().tag(sync=True)

        def __init__(
            self, page: dict[str, Any], rows: Mapping[str, frozenset[int]], picture: str
        ) -> None:
            self._rows, self._picture = rows, picture
            first = next(iter(rows))
            super().__init__(page=page, configuration=first, row=min(rows[first]))

        def _repr_mimebundle_(self, **kwargs: Any) -> Any:
            """The widget, and a picture for exported notebooks, which have no widgets."""
            data, *rest = super()._repr_mimebundle_(**kwargs)
            return ({**data, "text/html": self._picture}, *rest)

        @traitlets.validate("configuration")  # type: ignore[untyped-decorator]
        def _known(self, proposal: Any) -> str:
            name: str = proposal["value"]
            if name not in self._rows:
                raise traitlets.TraitError(
                    f'there is no configuration "{name}" '
                    f"{choices('configurations', self._rows, name)}"
                )
            return name

        @traitlets.validate("row")  # type: ignore[untyped-decorator]  # noqa: V105
        def _known_row(self, proposal: Any) -> int:
            row: int = proposal["value"]
            if row not in self._rows[self.configuration]:
                rows = self._rows[self.configuration]
                raise traitlets.TraitError(
                    f'row {row} of "{self.configuration}" has no position to show: '
                    f"{len(rows)} rows from {min(rows)} to {max(rows)} have one"
                )
            return row

        @traitlets.observe("configuration")  # type: ignore[untyped-decorator]
        def _moved(self, change: Any) -> None:
            """The same row if it has a position, otherwise the nearest row with a position."""
            there = self._rows[change["new"]]
            if self.row not in there:
                self.row = min(there, key=lambda row: (abs(row - self.row), row))

    return MotionWidget


def widget(
    mechanism: Mechanism,
    motion: Motion | None = None,
    *,
    all_circuits: bool = False,
    forces: Sequence[Force] = (),
) -> Any:
    """The motion as a notebook widget; see :meth:`~linkwork.Mechanism.widget`."""
    if all_circuits and motion is not None:
        raise InputError("a widget shows either the given motion or all circuits, not both")
    motions = shown_motions(mechanism, motion, all_circuits)
    equations = mechanism.equations().mathml()
    return motions_widget(
        motions, equations=equations, loops=partial(moving_loops, mechanism.model), forces=forces
    )
