"""What an offline page needs to solve its mechanism again."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwork.app.pages.moving_scene import MovingScene, moving_scene
from linkwork.app.pages.packing import (
    anchors_of,
    frames_of,
    tracks_of,
    turn_source,
    unlike_parts,
    unpressed,
    used_turns,
)
from linkwork.app.pages.page_building import usual_columns
from linkwork.app.pages.page_data import (
    PackedColumn,
    SliderData,
    SolverData,
    SolvingPage,
    StepRules,
)
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.rounding import UNIT_ROUNDOFF
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.following import turns_freely
from linkwork.core.numerics.marching import FAR, GROWTH, HALF, NEARLY_FULL, SAME
from linkwork.core.record.printing import JAVASCRIPT
from linkwork.core.results.motion import Motion
from linkwork.families.march.march_programs import NODES, START_STEPS, STEPS, Steps
from linkwork.families.printed_solver import PrintedSolver, print_solver
from linkwork.families.recorded_design import RecordedDesign

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
