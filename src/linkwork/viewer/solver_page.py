"""What an offline page needs to solve its mechanism again; this module solves nothing."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.batch.printed_solver import PrintedSolver, print_solver
from linkwork.batch.recorded_design import RecordedDesign
from linkwork.drawing.attachment import STILL, Frame
from linkwork.drawing.moving_scene import MovingScene, moving_scene
from linkwork.drawing.moving_shape import Moving
from linkwork.drawing.scene import Role
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.kernels.march.march_programs import NODES
from linkwork.kernels.march.step_control import START_STEPS, STEPS
from linkwork.kernels.march.sweep_kernel import Steps
from linkwork.kernels.program.languages import JAVASCRIPT
from linkwork.marching.prediction import FAR, SAME
from linkwork.marching.step_size import GROWTH, HALF, NEARLY_FULL
from linkwork.mechanism.varied_number import VariedNumber
from linkwork.motion.model import Model
from linkwork.motion.tracking import turns_freely
from linkwork.results.motion import Motion
from linkwork.viewer.packing import unpressed
from linkwork.viewer.page_columns import usual_columns
from linkwork.viewer.page_data import (
    FrameData,
    PackedColumn,
    SliderData,
    SolverData,
    SolvingPage,
    StepRules,
    TrackData,
    TurnSource,
)
from linkwork.viewer.page_shapes import places_of

__all__ = ["solving_page"]

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


def solving_page(
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
    turns = _used_turns(scene)
    links = [name for name in turns if name in motion.links]
    columns = [name for name, _ in usual_columns(motion)]
    printed = print_solver(
        design, JAVASCRIPT, points=list(motion.points), columns=columns, turns=links
    )
    anchors = [_anchors(motion, scene, part) for part in scene.parts]
    hidden = [_unlike(scene, motion, anchors, other) for other in changed]
    sliders = tuple(
        SliderData(
            name=quantity.name,
            unit=_unit(design.base, quantity),
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


def _unit(model: Model, quantity: VariedNumber) -> str:
    """The unit of a number; unknown for a named dimension."""
    if quantity.table in ("lengths", "points", "sliders"):
        return model.description.length
    return model.description.angle.value if quantity.table == "angles" else ""


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
    carriers = _carriers(scene)
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
        turns=tuple(_source(name, motion, links) for name in turns),
        tracks=tuple(
            TrackData(
                point=track.point,
                frame=carriers.index(track.frame) if track.frame != STILL else -1,
                x=track.along.real,
                y=track.along.imag,
            )
            for track in _tracks(motion, scene)
        ),
        frames=tuple(_frames(motion, scene)),
        anchors=tuple(anchors),
    )


def _plain(values: Array) -> PackedColumn:
    return unpressed(values, np.ones(len(values), dtype=bool))


def _carriers(scene: MovingScene) -> list[Frame]:
    """The frames in use, as in :func:`~linkwork.viewer.page_shapes.shapes_of`."""
    used = dict.fromkeys(part.frame for part in scene.parts)
    return [frame for frame in used if frame is not None and frame != STILL]


def _used_turns(scene: MovingScene) -> list[str]:
    return list(dict.fromkeys(frame.turn for frame in _carriers(scene) if frame.turn))


def _source(turn: str, motion: Motion, links: Sequence[str]) -> TurnSource:
    if turn in links:
        return TurnSource(angle=links.index(turn), start=-1, end=-1)
    bars = {bar.name: list(dict.fromkeys(bar.points)) for bar in motion.skeleton.bars}
    start, end = bars[turn][:2] if turn in bars else turn.split(">")
    points = list(motion.points)
    return TurnSource(angle=-1, start=points.index(start), end=points.index(end))


def _frames(motion: Motion, scene: MovingScene) -> Iterator[FrameData]:
    """The frames; one that turns about the origin of the plane turns about the point there."""
    points, turns = list(motion.points), _used_turns(scene)
    for frame in _carriers(scene):
        origin = points.index(frame.origin) if frame.origin else -1
        if frame.turn and not frame.origin:
            rigid = _rigid_points(motion, scene, frame)
            origin = next((k for k, z in rigid.items() if abs(z) == 0.0), -1)
        yield FrameData(origin=origin, turn=turns.index(frame.turn) if frame.turn else -1)


@dataclass(frozen=True)
class _Track:
    """The track of a guided point in a frame; ``ends``: of the point's path there."""

    name: str
    frame: Frame
    point: int
    along: complex
    ends: tuple[complex, complex]


def _tracks(motion: Motion, scene: MovingScene) -> Iterator[_Track]:
    """The tracks of guides, in every frame in use that has their line."""
    points, rows = list(motion.points), np.flatnonzero(scene.found)
    frames = [STILL, *_carriers(scene)]
    rigid = [_rigid_points(motion, scene, frame) for frame in frames] if points else []
    for guide in motion.skeleton.guides:
        start, end = (points.index(name) for name in guide.line)
        for frame, places in zip(frames, rigid, strict=True):
            if start in places and end in places:
                along = places[end] - places[start]
                along /= abs(along)
                own = scene.frames.points[guide.point]
                path = np.broadcast_to(own, (len(motion),))[rows, None]
                local = scene.frames.local(frame, path, rows)[:, 0]
                order = np.argsort((local * along.conjugate()).real)
                ends = complex(local[order[0]]), complex(local[order[-1]])
                yield _Track(guide.name, frame, points.index(guide.point), along, ends)


def _rigid_points(motion: Motion, scene: MovingScene, frame: Frame) -> dict[int, complex]:
    """Points that are constant in a frame, by index, and where they are in it."""
    rows = np.flatnonzero(scene.found)
    size, found = scene.scene.measures.size, {}
    for k, name in enumerate(motion.points):
        own = np.broadcast_to(scene.frames.points[name], (len(motion),))[rows, None]
        local = scene.frames.local(frame, own, rows)[:, 0]
        if np.abs(local - local[0]).max() <= 1e-9 * size:
            found[k] = complex(local[0])
    return found


def _holding(motion: Motion, scene: MovingScene, part: Moving) -> dict[int, complex]:
    """The points that corners of a part can move with: those of its frame, and ends of tracks."""
    assert part.frame is not None
    first, ends, own = len(motion.points), dict[int, complex](), False
    for k, track in enumerate(_tracks(motion, scene)):
        if track.frame == part.frame and (
            part.shape.of == track.name or part.shape.role is Role.LINK
        ):
            ends |= {first + 2 * k: track.ends[0], first + 2 * k + 1: track.ends[1]}
            own |= part.shape.of == track.name
    return ends if own else _rigid_points(motion, scene, part.frame) | ends


def _local(scene: MovingScene, part: Moving) -> ComplexArray:
    """The corners of a part in its frame."""
    assert part.frame is not None
    own = np.array([complex(*place) for place in places_of(part.shape)])
    local: ComplexArray = scene.frames.local(part.frame, own[None], np.array([scene.row]))[0]
    return local


def _anchors(motion: Motion, scene: MovingScene, part: Moving) -> tuple[int, ...]:
    """The points of its frame that the corners of a part move with; none of an arrow or a path."""
    if part.frame is None or part.shape.role in (Role.TRACE, Role.INPUT):
        return ()
    rigid = _holding(motion, scene, part)
    if not rigid:
        return ()
    return tuple(min(rigid, key=lambda k: abs(rigid[k] - z)) for z in _local(scene, part))


def _unlike(
    scene: MovingScene, motion: Motion, anchors: Sequence[tuple[int, ...]], changed: Motion | None
) -> tuple[int, ...]:
    """Parts that another motion draws otherwise than by moving their corners with points."""
    if changed is None:
        return tuple(k for k, part in enumerate(scene.parts) if not _is_plain(part))
    other = moving_scene(changed, like=scene, within=scene.scene.within)
    if [p.frame for p in other.parts] != [p.frame for p in scene.parts]:
        return tuple(k for k, part in enumerate(scene.parts) if not _is_plain(part))
    return tuple(
        k
        for k, (part, now) in enumerate(zip(scene.parts, other.parts, strict=True))
        if part.shape.role is not Role.TRACE
        and not _is_moved(scene, part, other, now, anchors[k], motion, changed)
    )


def _is_plain(part: Moving) -> bool:
    """Whether a part is a link between points, a pin or a name."""
    plain = (Role.LINK, Role.PLATE, Role.PIN, Role.POINT, Role.TRACED, Role.LABEL, Role.TRACE)
    return part.frame is not None and part.shape.role in plain


def _is_moved(
    scene: MovingScene,
    part: Moving,
    other: MovingScene,
    now: Moving,
    anchors: tuple[int, ...],
    motion: Motion,
    changed: Motion,
) -> bool:
    on_track = any(k >= len(motion.points) for k in anchors)
    if part.frame is None or (on_track and part.shape.role is Role.HATCH):
        return False  # as many strokes as its length has
    before, after = _local(scene, part), _local(other, now)
    if len(before) != len(after) or getattr(part.shape, "radius", 0.0) != getattr(
        now.shape, "radius", 0.0
    ):
        return False
    moved = np.zeros(len(before), dtype=complex)
    if anchors:
        old, new = _holding(motion, scene, part), _holding(changed, other, now)
        if not new.keys() >= set(anchors):
            return False
        moved = np.array([new[k] - old[k] for k in anchors])
    gap = float(np.abs(after - before - moved).max(initial=0.0))
    return gap <= 1e-6 * scene.scene.measures.size and math.isfinite(gap)
