"""The cycle in the form that the front end draws, updated quickly during a drag."""

from __future__ import annotations

from collections.abc import Sequence

from linkwork.drawing.moving_scene import MovingScene, moving_scene
from linkwork.foundation.errors import InputError
from linkwork.results.motion import Motion
from linkwork.viewer.packing import shortened, unpressed
from linkwork.viewer.page_building import Loops, drawn_page
from linkwork.viewer.page_data import PageData

__all__ = ["MotionPicture"]


class MotionPicture:
    """One motion after the other, each drawn like the one before as long as the shapes are the
    same: names stay where they are.
    """

    def __init__(self) -> None:
        self._scene: MovingScene | None = None

    def page(
        self,
        motion: Motion,
        equations: Sequence[tuple[str, str]] = (),
        loops: Loops | None = None,
        *,
        brief: bool = False,
    ) -> PageData | None:
        """The data of a page; ``None`` where no position was found, or nothing has a place.

        ``brief``: numbers to seven digits and no vectors, for a picture that is soon renewed;
        vectors between points stay with them.
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
        )
