"""Places and directions of bodies in positions, and how far they may be from them in boxes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from linkwork.forces.geometry import Geometry
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.names import GROUND
from linkwork.motion.model import Model
from linkwork.motion.motion_boxes import Boxes, motions_of_points, variables_of
from linkwork.results.motion import Motion

__all__ = ["BodyPoses", "variables_of_all"]


_SLACK = 1.0 + 1e-9  # covers the rounding of a few products


def variables_of_all(model: Model, motion: Motion) -> Array:
    """All variables of the mechanism with its own inputs, also where time drives it, (B, N)."""
    if model.untimed is not None:
        return Geometry(model, motion).variables[motion.found]
    return variables_of(model, motion)


class BodyPoses:
    """Places and directions of bodies in positions, and how far they may be in boxes.

    Parameters
    ----------
    model : Model
    first : Mapping[str, str]
        The link in whose frame a body is described, by body.
    millimetres : float
        Per length unit of the file.
    """

    def __init__(self, model: Model, first: Sequence[str], millimetres: float) -> None:
        self.model, self.millimetres = model.untimed or model, millimetres
        self.bodies = [body for body in first if body != GROUND]
        equations = self.model.equations
        numbered = tuple(enumerate(equations.variables))
        index = {v.symbol: k for k, v in numbered} | {v.name: k for k, v in numbered}
        angles = {body: equations.links[body] for body in self.bodies}
        self._angle = {
            body: (None if own.variable is None else index[own.variable], own.constant)
            for body, own in angles.items()
        }

    @cached_property
    def _origin(self) -> Mapping[str, int]:
        """The number of the first point of every body."""
        links = self.model.description.links  # type: ignore[attr-defined]
        names = self.model.compiled.points.names
        return {body: names.index(links[body][0]) for body in self.bodies}

    def of(self, v: Array) -> dict[str, tuple[ComplexArray, ComplexArray]]:
        """Origin [mm] and direction of every body in positions (B, N)."""
        places = self.millimetres * self.model.compiled.points.places(v)
        one = np.ones(len(v), dtype=complex)
        found: dict[str, tuple[ComplexArray, ComplexArray]] = {GROUND: (one - one, one)}
        for body in self.bodies:
            k, constant = self._angle[body]
            turn = np.full(len(v), constant) if k is None else constant + v[:, k]
            found[body] = (places[:, self._origin[body]], np.cos(turn) + 1j * np.sin(turn))
        return found

    def spread(self, boxes: Boxes) -> dict[str, tuple[Array, Array]]:
        """How far every body's origin moves [mm] and turns [rad] at most in boxes, (B,) each."""
        with np.errstate(all="ignore"):  # bounds of boxes without a proof are infinite
            return self._spread(boxes)

    def _spread(self, boxes: Boxes) -> dict[str, tuple[Array, Array]]:
        points = self.millimetres * motions_of_points(self.model, boxes).moved
        nothing = np.zeros(len(boxes))
        found = {GROUND: (nothing, nothing)}
        for body in self.bodies:
            k, _ = self._angle[body]
            turn = nothing if k is None else boxes.bound[:, k] * _SLACK
            found[body] = (points[:, self._origin[body]], np.minimum(turn, math.pi))
        return found
