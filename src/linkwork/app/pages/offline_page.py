"""An HTML file that shows a motion without a network, a server or Linkwork."""

from __future__ import annotations

import base64
import html
import io
import json
import zlib
from collections.abc import Mapping, Sequence
from html import escape
from importlib import metadata, resources
from typing import TYPE_CHECKING

import numpy as np

from linkwork.app.pages.moving_scene import MovingScene, moving_scene
from linkwork.app.pages.packing import (
    anchors_of,
    frames_of,
    still_shape,
    tracks_of,
    turn_source,
    unlike_parts,
    unpressed,
    used_turns,
)
from linkwork.app.pages.page_building import FORMAT, MARGIN, themes, usual_columns
from linkwork.app.pages.page_data import (
    MotionData,
    PackedColumn,
    PageData,
    PointData,
    RowEvidence,
    SliderData,
    SolverData,
    SolvingPage,
    StepRules,
)
from linkwork.core.drawing.labels import Kept
from linkwork.core.drawing.mechanism_scene import scene_of_pose
from linkwork.core.drawing.pose import Pose, printed_name
from linkwork.core.drawing.scene import Scene
from linkwork.core.foundation.arrays import UNIT_ROUNDOFF, Array, BoolArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.loading import installed_with
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.mechanism.skeleton import Skeleton
from linkwork.core.motion.following import turns_freely
from linkwork.core.numerics.marching import FAR, GROWTH, HALF, NEARLY_FULL, SAME
from linkwork.core.record.printing import JAVASCRIPT
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Units
from linkwork.families.march.march_programs import NODES, START_STEPS, STEPS, Steps
from linkwork.families.printed_solver import PrintedSolver, print_solver
from linkwork.families.recorded_design import RecordedDesign

if TYPE_CHECKING:
    from segno import QRCode

_POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:"


def offline_page(page: PageData, solver: SolvingPage | None = None) -> str:
    """The HTML file; with a ``solver`` numbers of the mechanism can be changed in it.

    It contains its data as JSON, deflated if that is shorter, and the scripts and styles of
    ``static/``, which ``scripts/frontend build`` writes. It loads no other file.
    """
    static = resources.files("linkwork.app") / "static"
    script = (static / ("solving.js" if solver else "offline.js")).read_text(encoding="utf-8")
    style = (static / "linkwork.css").read_text(encoding="utf-8")
    data = _holder("linkwork-data", page_json(page))
    if solver is not None:
        style += (static / "solving.css").read_text(encoding="utf-8")
        data += _holder("linkwork-solver", page_json(solver.data))
        data += f"<script>{solver.script}</script>\n"
    title = html.escape(page.title)
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{_POLICY}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="generator" content="Linkwork {html.escape(metadata.version("linkwork"))}">
<title>{title}</title>
<link rel="icon" href="data:,">
<style>{style}</style>
</head>
<body>
<main id="linkwork"><noscript>This page needs JavaScript to move.</noscript></main>
{data}<script>{script}</script>
</body>
</html>
"""


def _holder(name: str, text: str) -> str:
    """Data as an element of the page."""
    encoding, content = _shortest(text)
    return f'<script id="{name}" type="text/plain" data-encoding="{encoding}">{content}</script>\n'


def page_json(page: PageData | SolverData) -> str:
    """The data as JSON, including fields with empty default values."""
    return json.dumps(
        page, default=vars, ensure_ascii=False, separators=(",", ":"), allow_nan=False
    )


def _shortest(text: str) -> tuple[str, str]:
    """Deflated base64, or the JSON with ``<`` escaped, whichever is shorter."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    raw = text.encode()
    deflated = base64.b64encode(packer.compress(raw) + packer.flush()).decode()
    plain = text.replace("<", "\\u003c")
    return ("deflate-raw", deflated) if len(deflated) < len(plain.encode()) else ("json", plain)


# ----------------------------------------------------------------------
# HTML that shows a linked mechanism inside another page.


def embed_snippet(link: str, title: str) -> str:
    """A frame for the source of a course page, as the editors of learning platforms accept it.

    The frame may run the app's scripts and save files; it can neither reach the page around it nor
    cookies, and reads only the link.

    Examples
    --------
    >>> print(embed_snippet("https://example.org/#lw1=A1k-BYOldgA", "Four-bar"))
    <iframe src="https://example.org/#lw1=A1k-BYOldgA" title="Four-bar" width="100%" height="640"
    loading="lazy" sandbox="allow-scripts allow-downloads"></iframe>
    """
    return (
        f'<iframe src="{escape(link)}" title="{escape(title)}" width="100%" height="640"\n'
        'loading="lazy" sandbox="allow-scripts allow-downloads"></iframe>'
    )


# ----------------------------------------------------------------------
# QR codes of links as SVG and PNG, encoded by segno.


_MOST = 2_953  # bytes of the largest QR code, of the lowest error correction
_SVG_SCALE, _PNG_SCALE = 4, 8  # pixels of a module


def qr_svg(link: str) -> str:
    """The QR code of a link as an SVG document, dark on white with its quiet zone.

    Raises
    ------
    InputError
        If the link is longer than the largest QR code.
    MissingPackageError
        If segno is not installed.
    """
    return _saved(link, "svg", _SVG_SCALE, xmldecl=False, nl=False).decode()


def qr_png(link: str) -> bytes:
    """The QR code of a link as a PNG file; raises like :func:`qr_svg`."""
    return _saved(link, "png", _PNG_SCALE)


def _saved(link: str, kind: str, scale: int, **options: bool) -> bytes:
    buffer = io.BytesIO()
    _code(link).save(buffer, kind=kind, scale=scale, dark="#000", light="#fff", **options)
    return buffer.getvalue()


def _code(link: str) -> QRCode:
    with installed_with("qr", "QR codes need segno"):
        import segno
    size = len(link.encode())
    if size > _MOST:
        raise InputError(
            f"a QR code holds at most {_MOST:,} characters, this link has {size:,}: hand on the "
            "link itself, or shorten the comments and names of the mechanism"
        )
    # the lowest correction gives the fewest modules; segno raises it as far as the size stays
    return segno.make_qr(link, error="l")


# ----------------------------------------------------------------------
# Build the data of a page that shows one pose, such as a draft that is not a mechanism yet.


_ROW: BoolArray = np.ones(1, dtype=bool)


def still_page(
    skeleton: Skeleton,
    points: Mapping[str, tuple[float, float]],
    *,
    units: Units,
    title: str = "",
    size: float = 0.0,
    kept: Kept | None = None,
) -> PageData:
    """The data of a page with one row and no columns.

    Parameters
    ----------
    skeleton : Skeleton
        Links, joints and other parts between the points.
    points : Mapping[str, (x, y)]
        The coordinates of all points [length].
    units : Units
        The units of lengths and angles.
    title : str
        The title of the page.
    size : float
        The least length by which symbols are sized [length].
    kept : dict, optional
        Places of names and arrows, see
        :func:`~linkwork.core.drawing.mechanism_scene.scene_of_pose`.
    """
    pose = Pose.still(skeleton, {name: complex(*place) for name, place in points.items()})
    scene = scene_of_pose(pose, size=size or 1.0, unit=units.length, title=title, kept=kept)
    view = scene.box.grown(MARGIN * scene.measures.size)
    light, dark = themes()
    return PageData(
        format=FORMAT,
        title=title,
        length_unit=units.length,
        derivative_unit="",
        input_unit="",
        view=view.edges,
        stroke=scene.measures.stroke,
        pin=scene.measures.pin,
        text=scene.measures.text,
        motions=(_still_motion(title, pose, scene),),
        light=light,
        dark=dark,
        forces=(),
        force_unit="",
        equations=(),
    )


def _still_motion(title: str, pose: Pose, scene: Scene) -> MotionData:
    fixed, none = set(pose.skeleton.fixed), _number(np.nan)
    return MotionData(
        name=title,
        summary="",
        rows=1,
        order=_number(0.0),
        closed=False,
        speed=0.0,
        backwards=False,
        columns=(),
        points=tuple(
            PointData(
                name=name,
                shown=printed_name(name),
                drawn=name not in fixed,
                x=_number(place.real),
                y=_number(place.imag),
                dx=none,
                dy=none,
                ddx=none,
                ddy=none,
            )
            for name, place in pose.points.items()
        ),
        turns=(),
        frames=(),
        parts=tuple(still_shape(shape, scene.measures.size) for shape in scene.primitives),
        vectors=(),
        driven=tuple(part.name for part in pose.skeleton.driven),
        evidence=_no_evidence(),
        limits=(),
    )


def _no_evidence() -> RowEvidence:
    zero, one, none = _number(0.0), _number(1.0), _number(np.nan)
    return RowEvidence(
        found=one,
        status=zero,
        status_texts=("",),
        certification=zero,
        certification_texts=("",),
        certified=zero,
        residual_log10=none,
        radius_log10=none,
        iterations=zero,
        branch=zero,
        branch_names=("",),
    )


def _number(value: float) -> PackedColumn:
    return unpressed(np.array([value]), _ROW)


# ----------------------------------------------------------------------
# What an offline page needs to solve its mechanism again.


_FINEST = 1e-8  # relative step to the end of a branch
_RULES = StepRules(
    nodes=NODES,
    growth=GROWTH,
    half=HALF,
    nearly_full=NEARLY_FULL,
    far=FAR,
    same=SAME,
    newton_steps=STEPS,
    start_steps=START_STEPS,
)


def page_solver(
    design: RecordedDesign, motion: Motion, changed: Sequence[Motion | None]
) -> SolvingPage:
    """Print the solver of a motion's mechanism for its page.

    Parameters
    ----------
    design : RecordedDesign
    motion : Motion
        The motion that the page shows.
    changed : sequence of Motion or None
        A motion with another value of each number that varies, in their order: parts that the
        page would draw otherwise than those are hidden where that number differs. ``None`` where
        there is no such motion: only parts that move as points do are drawn then.
    """
    scene = moving_scene(motion)
    turns = used_turns(scene)
    links = [name for name in turns if name in motion.links]
    columns = [name for name, _ in usual_columns(motion)]
    printed = print_solver(
        design, JAVASCRIPT, points=list(motion.points), columns=columns, turns=links
    )
    anchors = [anchors_of(motion, scene, part) for part in scene.parts]
    hidden = [unlike_parts(scene, motion, anchors, other) for other in changed]
    sliders = tuple(
        SliderData(
            name=quantity.name,
            unit=quantity.unit(design.base.description),
            value=float(quantity.of(design.base.description)),
            hidden=hidden[k],
        )
        for k, quantity in enumerate(design.quantities)
    )
    return SolvingPage(
        data=_data(design, motion, scene, printed, sliders, turns, links, anchors),
        script=_script(printed),
    )


def _script(printed: PrintedSolver) -> str:
    """A function that makes the program, as ``march.ts`` expects it."""
    blocks = {
        kind: ",".join(f"{kind}{b}" for b in range(printed.blocks))
        for kind in ("begin", "damped", "iterate", "prove")
    }
    several = ",".join(f"{kind}:[{names}]" for kind, names in blocks.items())
    return (
        "linkworkProgram=(abs,sqrt,atan2,sinCos,turn)=>{"
        f"{printed.source}return {{design,reach,given,agree,rates,drawn,{several}}}}}"
    )


def _data(
    design: RecordedDesign,
    motion: Motion,
    scene: MovingScene,
    printed: PrintedSolver,
    sliders: tuple[SliderData, ...],
    turns: Sequence[str],
    links: Sequence[str],
    anchors: Sequence[tuple[int, ...]],
) -> SolverData:
    model, path = design.base, design.path
    t = model.rows[:, path.lead]
    steps = Steps(smallest=_FINEST).times(path.size)
    return SolverData(
        title=motion.mechanism,
        sliders=sliders,
        unknowns=printed.unknowns,
        size=printed.size,
        blocks=printed.blocks,
        coefficients=printed.coefficients,
        spread=printed.spread,
        state=printed.state,
        design=printed.design,
        drawn=printed.drawn,
        options=printed.options,
        rules=_RULES,
        steps=(steps.first, steps.largest, steps.smallest),
        turn=FULL_TURN if turns_freely(model) else 0.0,
        apart=4.0 * UNIT_ROUNDOFF * (float(np.abs(t).max()) + FULL_TURN),
        path=_plain(t),
        origins=tuple(map(float, path.origin)),
        rates=tuple(map(float, path.rate)),
        inputs=tuple(map(_plain, model.rows_in_file_units.T)),
        input_unit=float(model.input_scale[path.lead]),
        columns=printed.columns,
        turns=tuple(turn_source(name, motion, links) for name in turns),
        tracks=tuple(tracks_of(motion, scene)),
        frames=tuple(frames_of(motion, scene)),
        anchors=tuple(anchors),
    )


def _plain(values: Array) -> PackedColumn:
    return unpressed(values, np.ones(len(values), dtype=bool))
