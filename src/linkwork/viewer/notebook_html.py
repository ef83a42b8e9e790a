"""Results as HTML for notebooks: a picture and a short table, no script, light and dark.

This module solves nothing. A result that cannot be drawn (a mechanism without points, a position
that was not found) is shown as a table only.
"""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from linkwork.drawing.box import Box
from linkwork.drawing.captions import reached_caption
from linkwork.drawing.drawn_box import reach_of
from linkwork.drawing.further_positions import faint_symbols, further_positions
from linkwork.drawing.inline_svg import Inks, inline_svg
from linkwork.drawing.mechanism_scene import scene_of
from linkwork.drawing.moving_scene import moving_scene
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Scene
from linkwork.drawing.scene_options import SceneOptions
from linkwork.drawing.sheet import configuration_sheet
from linkwork.drawing.theme import DARK, LIGHT
from linkwork.results.circuits import Circuits, circuits_summary
from linkwork.results.configurations import Configurations, configurations_summary
from linkwork.results.motion import Motion
from linkwork.results.motion_summary import motion_summary
from linkwork.results.position import Position, position_summary
from linkwork.results.sensitivity import Sensitivity, sensitivity_summary
from linkwork.results.summary import Summary
from linkwork.results.tolerance import Tolerance, tolerance_summary

__all__ = [
    "circuits_html",
    "configurations_html",
    "mechanism_html",
    "motion_html",
    "position_html",
    "sensitivity_html",
    "tolerance_html",
]

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
        If it was not found, the table gives the reason.
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


def configurations_html(found: Configurations) -> str:
    """Every configuration as a picture, all of one scale, and as a row."""
    inks, pictures = Inks(), []
    if len(found) and found[0].points:
        sheet = configuration_sheet(found)
        pictures = [
            _figure(scene, inks, _IN_ROW, sheet.view, scene.title) for scene in sheet.scenes[:_MOST]
        ]
    return _element(configurations_summary(found), pictures, inks)


def circuits_html(circuits: Circuits) -> str:
    """Every circuit as a picture, all of one scale, and its branches as rows."""
    inks, pictures = Inks(), []
    drawn = [c for c in circuits if c.motion.points and c.motion.found.any()][:_MOST]
    if drawn:
        within = Box.around(corner for c in drawn for corner in reach_of(c.motion).corners)
        scenes = [_motion_picture(circuit.motion, within) for circuit in drawn]
        view = Box.around(corner for _, own in scenes for corner in own.corners)
        pictures = [
            _figure(replace(scene, title=circuit.name), inks, _OF_CIRCUIT, view, circuit.name)
            for circuit, (scene, _) in zip(drawn, scenes, strict=True)
        ]
    return _element(circuits_summary(circuits), pictures, inks)


def sensitivity_html(found: Sensitivity) -> str:
    """The derivatives of a quantity, the largest first."""
    return _element(sensitivity_summary(found), [], Inks())


def tolerance_html(found: Tolerance) -> str:
    """A tolerance: worst case, root sum square, shares."""
    return _element(tolerance_summary(found), [], Inks())


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
