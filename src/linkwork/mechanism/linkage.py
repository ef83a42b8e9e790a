"""Form A: a mechanism described by its points and links."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.foundation.names import GROUND
from linkwork.mechanism.draft import Draft

__all__ = ["GROUND", "Linkage"]


@dataclass(frozen=True, kw_only=True)
class Linkage(Draft):
    """Points, links and inputs.

    Links that share a point are pinned there. The link ``ground`` is fixed.

    Parameters
    ----------
    points : Mapping[str, (x, y)]
        One assembled position: exact on ground, elsewhere exact or a sketch that selects sides.
    links : Mapping[str, sequence of str]
        The points of each link; its angle is the direction from the first to the second.
    lengths : Mapping[str, number]
        Exact distances, ``"A B"``, between two points of one link.
    angles : Mapping[str, number]
        Exact angles in a link: ``"B A P"`` at A, from AB to AP, counter-clockwise.
    sketch : bool
        If true, dimensions are never measured from ``points``.
    clearances : Mapping[str, number]
        How far pins can move in their holes, by point: the difference of the radii.
    mass, force, gravity, masses
        Units of masses and forces, gravity, and the masses of links; see
        :class:`~linkwork.mechanism.loaded.LoadedBodies`.
    slots, sliders, … : tuples of parts
        One field for each table of parts, see :mod:`linkwork.mechanism.part.index`.
    """

    def _examine(self) -> None:
        super()._examine()
        self.problems.raise_any(f'mechanism "{self.name}"')
