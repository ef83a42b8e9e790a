"""The cycle in the form that the front end draws, updated quickly during a drag."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwork.drawing.box import Box
from linkwork.drawing.measures import Measures
from linkwork.drawing.mechanism_scene import traced
from linkwork.drawing.moving_scene import MovingScene, moving_scene
from linkwork.drawing.pose import Pose
from linkwork.drawing.trace_path import trace_symbols
from linkwork.foundation.errors import InputError
from linkwork.results.motion import Motion
from linkwork.viewer.packing import shortened, unpressed
from linkwork.viewer.page_building import Loops, drawn_page
from linkwork.viewer.page_data import PageData
from linkwork.viewer.page_shapes import still_shape

__all__ = ["MotionPicture", "paths_on"]


class MotionPicture:
    """Draws successive motions with the layout of the preceding one as long as the shapes are
    equal, so that names keep their positions.
    """

    def __init__(self) -> None:
        self._scene: MovingScene | None = None

    def page(
        self,
        motion: Motion,
        equations: Sequence[tuple[str, str]] = (),
        loops: Loops | None = None,
        *,
        asked: Sequence[str] = (),
        brief: bool = False,
        rates: bool = True,
    ) -> PageData | None:
        """The data of a page; ``None`` without positions or points.

        ``asked``: further quantities by name. ``brief``: seven digits, no vectors and no numbers of
        the motion, for a picture that is replaced soon; vectors between points are kept. ``rates``:
        with rates of points.
        """
        if not motion.found.any() or not motion.points:
            return None
        try:
            self._scene = moving_scene(motion, like=self._scene, sampled=True)
        except InputError:
            return None
        name = next((branch for branch in motion.branch if branch), motion.mechanism)
        return drawn_page(
            {name: motion},
            [self._scene],
            equations,
            loops=None if brief else loops,
            pack=shortened if brief else unpressed,
            asked=asked,
            brief=brief,
            rates=rates,
        )


def paths_on(sketch: PageData, motion: Motion) -> PageData:
    """The page of a sketch with nothing but the paths of a motion, which has positions."""
    pose = Pose.at_row(motion, int(np.flatnonzero(motion.found)[0]))
    measures = Measures.of(Box(*sketch.view), pose.gaps)
    paths = trace_symbols(pose, traced(pose, None), measures)
    parts = tuple(still_shape(path, measures.size) for path in paths)
    return replace(sketch, motions=(replace(sketch.motions[0], parts=parts),))
