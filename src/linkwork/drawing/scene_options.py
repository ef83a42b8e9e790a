"""What a picture shows besides the mechanism."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.drawing.box import Box
from linkwork.results.force import Force
from linkwork.results.vector_loop import VectorLoop

__all__ = ["SceneOptions"]


@dataclass(frozen=True, kw_only=True)
class SceneOptions:
    """What else a picture shows.

    Parameters
    ----------
    link_names : bool
        Write the names of links beside them.
    arrows : bool
        Show by arrows what is driven.
    further : int
        About how many more positions of the motion to show, faintly; if any, its dead points and
        change points are marked.
    title : str, optional
        Instead of the mechanism's name; an empty one leaves it out.
    larger : float
        How much larger than usual names are, for small pictures; symbols grow by its root.
    vectors : tuple of VectorLoop
        The loop equations as vectors, head to tail over the mechanism, which is drawn faintly: from
        :func:`linkwork.motion.vector_loops`, for this position. Draws mechanisms without points
        too.
    velocities, accelerations : bool
        Arrows at the points that move.
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
    within : Box, optional
        What the picture shows at least, and what the sizes of symbols are measured by: give all
        pictures of one animation the same, from
        :func:`~linkwork.drawing.drawn_box.reach_of`.
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
    within: Box | None = None
