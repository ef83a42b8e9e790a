"""The rows that parts add to the equations of a linkage, while they are written."""

from __future__ import annotations

import cmath
from dataclasses import dataclass, field

from linkwork.equations.frames import Frames, Place
from linkwork.equations.model import LawEquation, LinearEquation, LoopEquation
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.elementwise import copysign, largest, uniform_value
from linkwork.foundation.names import canonical
from linkwork.mechanism.description import Key, Problems

__all__ = ["PartRows"]


@dataclass
class PartRows:
    """What parts add to a linkage whose frames are known; frames get their places and rods.

    ``variables`` are unknowns besides angles of bodies and lengths of slides, (name, kind);
    ``outlines`` are for pictures: name → (body, centre, points about it in the body's frame).
    """

    frames: Frames
    problems: Problems
    loops: list[LoopEquation] = field(default_factory=list)
    linear: list[LinearEquation] = field(default_factory=list)
    laws: list[LawEquation] = field(default_factory=list)
    variables: list[tuple[str, str]] = field(default_factory=list)
    outlines: dict[str, tuple[str, str, ComplexArray]] = field(default_factory=dict)

    def held(self, link: str, frame: str, key: Key) -> None:
        """Report an angle that cannot change."""
        self.problems.add(
            key, f'"{link}" cannot turn relative to "{frame}": a slider or a weld holds its angle'
        )

    def put(self, body: str, point: str, place: Place, key: Key) -> None:
        """Lead a point in a body that does not lead it yet."""
        if point in self.frames.places[body]:
            self.problems.add(key, f'point "{point}" is already guided by "{body}"')
            return
        self.frames.places[body][point] = place

    def sketched_in(self, body: str, origin: str, point: str) -> complex:
        """Where the sketch has a point in a body's frame, about a point of it."""
        frames = self.frames
        turned = frames.angle[body].constant + frames.now(frames.angle[body])
        linkage = frames.linkage
        return (linkage.sketched(point) - linkage.sketched(origin)) * cmath.exp(-1j * turned)

    def unknown(self, name: str, kind: str, start: float) -> str:
        """Another unknown; its symbol."""
        self.variables.append((name, kind))
        self.frames.start[name] = start
        return canonical(name)

    def tie(
        self,
        label: str,
        turns: list[tuple[str, float]],
        length: tuple[str, float] | None = None,
        total: float | None = None,
    ) -> None:
        """Σ weight · angle of body (+ weight · length) = total, as it is in the sketch if open."""
        frames = self.frames
        weights, constant = frames.angles_of(
            (body, uniform_value(weight)) for body, weight in turns
        )
        now = sum(weight * frames.start[name] for name, weight in weights.items())
        if length is not None:
            weights[length[0]] = length[1]
            now += length[1] * frames.start[length[0]]
        # an open total is that of the sketch: gears can be meshed at any tooth
        constant = -now if total is None else constant - total
        self.linear.append(
            LinearEquation(
                label=label,
                terms=tuple((canonical(name), weight) for name, weight in weights.items()),
                constant=constant,
                kind="angle" if length is None else "length",
            )
        )

    def side(self, body: str, line: tuple[str, str], point: str, key: Key) -> float:
        """On which side of a body's line the sketch has a point: 1 for left, -1 for right."""
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
