"""Coordinates of derived links and pins at one position."""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from linkwork.equations.model import LoopEquations, Term
from linkwork.equations.reading.joints import Joints
from linkwork.equations.reading.walk import Phase
from linkwork.foundation.arrays import Array

__all__ = ["Poses"]

_NEAR = 1e-6  # relative: closing errors are much smaller, distances of pins much larger


@dataclass(frozen=True)
class Poses:
    """A position: values of variables by symbol, and coordinates of the file's points."""

    values: Mapping[str, float]
    points: Mapping[str, complex]
    tolerance: float

    @classmethod
    def at(cls, equations: LoopEquations, v: Array) -> Poses:
        """The position with unknowns and inputs v (N,)."""
        names = (variable.symbol for variable in equations.variables)
        values = dict(zip(names, map(float, v), strict=True))
        poses = cls(values, {}, _NEAR * equations.length_scale)
        points = {name: poses.sum(path.terms) for name, path in equations.points.items()}
        return cls(values, points, poses.tolerance)

    def sum(self, terms: Sequence[Term]) -> complex:
        """The sum of vectors."""
        return sum(
            (
                term.value
                * (1.0 if term.length is None else self.values[term.length])
                * self.turn(term.phase)
                for term in terms
            ),
            0j,
        )

    def turn(self, phase: Phase) -> complex:
        """The unit vector of a direction."""
        return cmath.exp(1j * sum(weight * self.values[name] for name, weight in phase))

    def links(self, joints: Joints) -> dict[int, complex]:
        """The origin of every link, relative to the start of the equations."""
        turn = {link: self.turn(phase) for link, phase in joints.phases.items()}
        found = {joints.ground: -joints.origin}
        last = 0
        while last < len(found) < len(turn):
            last = len(found)
            for corner in joints.corners:
                known = next((link for link in corner.places if link in found), None)
                if known is None:
                    continue
                pin = found[known] + corner.places[known] * turn[known]
                for link, place in corner.places.items():
                    found.setdefault(link, pin - place * turn[link])
            for slide in joints.slides:
                way = slide.foot + slide.along * self.values[slide.variable]
                way *= turn[slide.before]
                if slide.before in found:
                    found.setdefault(slide.after, found[slide.before] + way)
                elif slide.after in found:
                    found[slide.before] = found[slide.after] - way
        return found

    def named(self, joints: Joints) -> tuple[complex, tuple[str | None, ...]]:
        """The start of the equations, and the file's point at every pin.

        The start is the origin unless another start makes more pins points of the file.
        """
        origins = self.links(joints)
        pins = []
        for corner in joints.corners:
            link, place = next(iter(corner.places.items()))
            pins.append(origins[link] + place * self.turn(joints.phases[link]))
        begins = [0j, *(point - pin for point in self.points.values() for pin in pins)]
        found = [tuple(self._point_at(pin + begin) for pin in pins) for begin in begins]
        best = max(range(len(begins)), key=lambda k: _distinct(found[k]))
        if _distinct(found[best]) < 2:  # a single point could be at any pin
            best = 0
        return begins[best], found[best]

    def _point_at(self, place: complex) -> str | None:
        """The file's point at a position."""
        for name, there in self.points.items():
            if abs(there - place) <= self.tolerance:
                return name
        return None

    def fit(self, joints: Joints) -> int:
        """The number of pins that are points of the file; a pin of k links counts as k - 1."""
        _, names = self.named(joints)
        pins = zip(names, joints.corners, strict=True)
        return sum({name: len(c.places) - 1 for name, c in pins if name is not None}.values())


def _distinct(names: Sequence[str | None]) -> int:
    return len({name for name in names if name is not None})
