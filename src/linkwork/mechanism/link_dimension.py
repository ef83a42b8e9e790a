"""Distances and angles between the points of one link."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from linkwork.foundation.elementwise import cis, degrees, detached, is_steady, phase
from linkwork.foundation.lanes import Rest
from linkwork.foundation.precise import Precise, sin_cos

__all__ = ["AGREE", "Distance", "Given", "ShapeError", "VertexAngle", "compared", "fits"]

AGREE = 1e-9  # relative, or [rad]: nearer to its dimensions a shape may be placed by them
_ROUNDED = 1e-13  # the same of numbers without their rests


class ShapeError(Exception):
    """Dimensions of one link that contradict each other."""

    def __init__(self, message: str, table: str = "", key: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.table = table
        self.key = key


@dataclass(frozen=True)
class Distance:
    """|ab| = length + rest: the part that is lost where the length is rounded to a float."""

    a: str
    b: str
    length: float
    rest: float = 0.0
    table = "lengths"

    @property
    def key(self) -> str:
        return f"{self.a} {self.b}"

    @property
    def points(self) -> tuple[str, ...]:
        return (self.a, self.b)

    @property
    def amount_text(self) -> str:
        return f"{self.length:.12g}"

    def error(self, z: Mapping[str, complex]) -> float:
        """Relative disagreement with placed points."""
        return (abs(z[self.b] - z[self.a]) - self.length) / self.length

    def precise_error(self, z: Mapping[str, Precise]) -> Precise:
        """The error near a shape that has none."""
        span, length = z[self.b] - z[self.a], Precise(self.length, self.rest)
        square = span.real * span.real + span.imag * span.imag
        return (square / (length * length) - 1.0) * 0.5

    def agrees(self, z: Mapping[str, complex], tolerance: float) -> bool:
        error = self.error(z)
        # one that agrees by chance would no longer if a number changed
        return abs(error) <= tolerance and is_steady(error)

    def shown(self, z: Mapping[str, complex]) -> str:
        return f"|{self.a}{self.b}| = {abs(z[self.b] - z[self.a]):.12g}"

    def gradients(self, z: Mapping[str, complex]) -> dict[str, complex]:
        """The derivatives of the error by every point's x and, times i, by its y."""
        span = z[self.b] - z[self.a]
        size = abs(span)
        slope = span / (size * self.length) if size else 0j
        return {self.a: -slope, self.b: slope}

    def bend(self, z: Mapping[str, complex], point: str, move: complex) -> dict[str, complex]:
        """The change of the gradients per move of a point."""
        span = z[self.b] - z[self.a]
        change = move if point == self.b else -move
        # i u Im(u* δ) / (|span| · length), u = span / |span|
        slope = 1j * span * (span.conjugate() * change).imag / (abs(span) ** 3 * self.length)
        return {self.a: -slope, self.b: slope}

    def narrow(self, rest: Rest) -> Distance:
        return replace(self, length=rest.narrow(self.length), rest=rest.narrow(self.rest))

    def detached(self) -> Distance:
        length = detached(self.length)
        return self if length is self.length else replace(self, length=length)


@dataclass(frozen=True)
class VertexAngle:
    """The angle [rad] at ``vertex``, counter-clockwise from the ray to ``a`` to that to ``b``.

    It is ``angle`` + ``rest``.
    """

    a: str
    vertex: str
    b: str
    angle: float
    rest: float = 0.0
    table = "angles"

    @property
    def key(self) -> str:
        return f"{self.a} {self.vertex} {self.b}"

    @property
    def points(self) -> tuple[str, ...]:
        return (self.a, self.vertex, self.b)

    @property
    def amount_text(self) -> str:
        return f"{degrees(self.angle):.12g}°"

    def error(self, z: Mapping[str, complex]) -> float:
        """Disagreement with placed points [rad], within half a turn."""
        rays = (z[self.b] - z[self.vertex]) * (z[self.a] - z[self.vertex]).conjugate()
        # the difference as a rotation has no jump at half a turn
        return phase(rays * cis(-self.angle)) if rays else math.inf

    def precise_error(self, z: Mapping[str, Precise]) -> Precise:
        """The error near a shape that has none [rad]."""
        rays = (z[self.b] - z[self.vertex]) * (z[self.a] - z[self.vertex]).conjugate()
        sine, cosine = sin_cos(Precise(self.angle, self.rest))
        return (rays.imag * cosine - rays.real * sine) / abs(rays)

    def agrees(self, z: Mapping[str, complex], tolerance: float) -> bool:
        error = self.error(z)
        # one that agrees by chance would no longer if a number changed
        return abs(error) <= tolerance and is_steady(error)

    def shown(self, z: Mapping[str, complex]) -> str:
        rays = (z[self.b] - z[self.vertex]) * (z[self.a] - z[self.vertex]).conjugate()
        return f"an angle of {degrees(phase(rays)):.12g}° at {self.vertex}"

    def gradients(self, z: Mapping[str, complex]) -> dict[str, complex]:
        """The derivatives of the error by every point's x and, times i, by its y."""
        first, second = z[self.a] - z[self.vertex], z[self.b] - z[self.vertex]
        if not (first and second):
            return {point: complex(math.nan) for point in self.points}
        # d arg r = Im(dr / r)
        to_a, to_b = -1j / first.conjugate(), 1j / second.conjugate()
        return {self.a: to_a, self.vertex: -(to_a + to_b), self.b: to_b}

    def bend(self, z: Mapping[str, complex], point: str, move: complex) -> dict[str, complex]:
        """The change of the gradients per move of a point."""
        first, second = z[self.a] - z[self.vertex], z[self.b] - z[self.vertex]
        turns = [
            -move if point == self.vertex else move * (point == end) for end in (self.a, self.b)
        ]
        to_a = 1j * turns[0].conjugate() / first.conjugate() ** 2
        to_b = -1j * turns[1].conjugate() / second.conjugate() ** 2
        return {self.a: to_a, self.vertex: -(to_a + to_b), self.b: to_b}

    def narrow(self, rest: Rest) -> VertexAngle:
        return replace(self, angle=rest.narrow(self.angle), rest=rest.narrow(self.rest))

    def detached(self) -> VertexAngle:
        angle = detached(self.angle)
        return self if angle is self.angle else replace(self, angle=angle)


Given = Distance | VertexAngle


def fits(row: Given, z: Mapping[str, Precise], tolerance: float) -> bool:
    """Whether placed points have a dimension, in numbers as exact as they are."""
    rounded = {p: place.high for p, place in z.items()}
    if not all(place.has_rest for place in z.values()):
        return row.agrees(rounded, max(tolerance, _ROUNDED))
    return row.agrees(rounded, AGREE) and abs(row.precise_error(z).high) <= tolerance


def compared(row: Given, z: Mapping[str, Precise]) -> str:
    """What placed points have instead of a dimension, and how far it is off if digits hide it."""
    rounded = {p: place.high for p, place in z.items()}
    text = f"{row.shown(rounded)}, not {row.amount_text}"
    if abs(row.error(rounded)) > AGREE:
        return text
    off = abs(row.precise_error(z).high)
    told = f"relative difference {off:.1e}" if isinstance(row, Distance) else f"{off:.1e} rad apart"
    return f"{text} ({told})"
