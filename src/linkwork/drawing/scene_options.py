"""Optional contents of a picture."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.drawing.box import Box
from linkwork.drawing.position_marks import PositionMark
from linkwork.foundation.internal import internal
from linkwork.results.force import Force
from linkwork.results.vector_loop import VectorLoop

__all__ = ["SceneOptions"]


@internal("vectors", "positions", "within")
@dataclass(frozen=True, kw_only=True)
class SceneOptions:
    """Optional contents of a picture.

    Parameters
    ----------
    link_names : bool
        Write the names of links.
    arrows : bool
        Draw arrows of the inputs.
    further : int
        Approximate number of faint further positions of the motion; if positive, dead points and
        change points are marked.
    title : str, optional
        Replaces the mechanism's name; an empty title omits it.
    larger : float
        Enlargement of names, for small pictures; symbols grow by its square root.
    vectors : tuple of VectorLoop
        The loop equations as vectors, head to tail over the faded mechanism, from
        :func:`linkwork.motion.vector_loops` for this position. Also for mechanisms without points.
    velocities, accelerations : bool
        Arrows at moving points.
    forces : tuple of Force
        Arrows of these forces at their points.
    speed : bool
        Colour the paths of points by their speed, with a scale.
    centres : bool
        Mark the instant centres of all pairs of links.
    centrodes : tuple of str
        The links whose centrodes are shown, over the motion.
    dimensions : bool
        Lengths of links, radii of wheels and the input as dimension lines.
    positions : tuple of PositionMark
        Positions of a task that the mechanism should pass, numbered in order of travel.
    within : Box, optional
        The minimum extent of the picture, and the reference for sizes of symbols: use the same for
        all pictures of an animation, from
        :func:`~linkwork.drawing.drawn_box.reach_of`.

    Examples
    --------
    >>> import linkwork as lw
    >>> options = lw.SceneOptions(dimensions=True, velocities=True)
    >>> lw.example("four-bar").scene(at=60, options=options).title
    'Four-bar linkage, open'
    """

    link_names: bool = False
    arrows: bool = True
    further: int = 0
    larger: float = 1.0
    title: str | None = None
    vectors: tuple[VectorLoop, ...] = ()
    velocities: bool = False
    accelerations: bool = False
    forces: tuple[Force, ...] = ()
    speed: bool = False
    centres: bool = False
    centrodes: tuple[str, ...] = ()
    dimensions: bool = False
    positions: tuple[PositionMark, ...] = ()
    within: Box | None = None
