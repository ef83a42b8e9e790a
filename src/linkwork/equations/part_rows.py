"""The rows that parts add to the equations of a linkage."""

from __future__ import annotations

import cmath
from dataclasses import dataclass, field

from linkwork.equations.frames import Frames, Place
from linkwork.equations.model import LawEquation, LinearEquation, LoopEquation, MeasuredInPart
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.elementwise import copysign, largest, uniform_value
from linkwork.foundation.names import canonical
from linkwork.foundation.precise import Precise
from linkwork.mechanism.description import Key, Problems

__all__ = ["PartRows"]


@dataclass
class PartRows:
    """Collects the rows of parts; their positions and rods are added to the frames.

    ``variables`` are unknowns other than body angles and slide lengths, (name, kind);
    ``outlines`` are for pictures: name → (body, centre, points about it in the body's frame).
    """

    frames: Frames
    problems: Problems
    loops: list[LoopEquation] = field(default_factory=list)
    linear: list[LinearEquation] = field(default_factory=list)
    laws: list[LawEquation] = field(default_factory=list)
    variables: list[tuple[str, str]] = field(default_factory=list)
    outlines: dict[str, tuple[str, str, ComplexArray]] = field(default_factory=dict)
    measured: list[MeasuredInPart] = field(default_factory=list)

    def held(self, link: str, frame: str, key: Key) -> None:
        """Report a fixed angle."""
        self.problems.add(
            key, f'"{link}" cannot turn relative to "{frame}": a slider or a weld holds its angle'
        )

    def put(self, body: str, point: str, place: Place, key: Key) -> None:
        """Add the position of a point in a body that does not guide it yet."""
        if point in self.frames.places[body]:
            self.problems.add(key, f'point "{point}" is already guided by "{body}"')
            return
        self.frames.places[body][point] = place

    def sketched_in(self, body: str, origin: str, point: str) -> complex:
        """The sketched position of a point in a body's frame, relative to a point of the body."""
        frames = self.frames
        turned = frames.angle[body].constant + frames.now(frames.angle[body])
        linkage = frames.linkage
        return (linkage.sketched(point) - linkage.sketched(origin)) * cmath.exp(-1j * turned)

    def unknown(self, name: str, kind: str, start: float) -> str:
        """Add an unknown; returns its symbol."""
        self.variables.append((name, kind))
        self.frames.start[name] = start
        return canonical(name)

    def tie(
        self,
        label: str,
        turns: list[tuple[str, float]],
        length: tuple[str, float] | None = None,
        total: Precise | None = None,
        measured: tuple[str, float] = ("", 1.0),
    ) -> None:
        """Add Σ weight · angle of body (+ weight · length) = total, by default as sketched.

        ``measured``: the name of what the sketch then gives, and its weight in the total.
        """
        frames = self.frames
        weights, constant = frames.angles_of(
            (body, uniform_value(weight)) for body, weight in turns
        )
        if length is not None:
            weights[length[0]] = length[1]
        # by default the total of the sketch: gears can mesh at any tooth
        kind = "angle" if length is None else "length"
        if total is None:
            quantity, weight = measured
            value = frames.sketched_sum(weights) + constant
            self.measured.append(MeasuredInPart(label, quantity, value.high / weight, kind))
        rounded = (-frames.sketched_sum(weights) if total is None else constant - total).high
        self.linear.append(
            LinearEquation(
                label=label,
                terms=tuple((canonical(name), weight) for name, weight in weights.items()),
                constant=rounded,
                kind=kind,
            )
        )

    def side(self, body: str, line: tuple[str, str], point: str, key: Key) -> float:
        """The side of a body's line on which a point is sketched: 1 for left, -1 for right."""
        linkage = self.frames.linkage
        a, b, p = (linkage.sketched(q) for q in (*line, point))
        away = ((p - a) * (b - a).conjugate()).imag / abs(b - a)
        if abs(away) <= 1e-9 * largest((abs(b - a), abs(p - a))):
            self.problems.add(
                key,
                f"{point} lies on the line {' '.join(line)} of {body}: sketch it on the side on "
                "which it is",
            )
            return 1.0
        return copysign(1.0, away)
