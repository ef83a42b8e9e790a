"""Equations of wheels: gears, belts, racks and rolling.

Wheels in mesh tie angles linearly; racks and rolling on a line tie an angle to a length.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction

from linkwork.equations.frames import Frames
from linkwork.equations.model import LinearEquation
from linkwork.foundation.lanes import choose, copysign, largest, led, many, settled
from linkwork.foundation.names import canonical
from linkwork.mechanism.description import Problems
from linkwork.mechanism.part.belt import Belt
from linkwork.mechanism.part.gear import Gear
from linkwork.mechanism.part.guide import guide_named
from linkwork.mechanism.part.rack import Rack
from linkwork.mechanism.part.rolling import Rolling
from linkwork.mechanism.part.slider import Slider

__all__ = ["wheels_in_mesh"]

Key = tuple[str | int, ...]
_RATIO = 1e-13  # relative: two sizes this near to a ratio of small whole numbers have that ratio
_LARGEST = 10_000  # of those whole numbers


def wheels_in_mesh(frames: Frames, problems: Problems) -> list[LinearEquation]:
    """The equations of all wheels; ``frames`` gets the places and rods that they add."""
    wheels, linkage = _Wheels(frames, problems), frames.linkage
    for gear in linkage.gears:
        wheels.gear(gear)
    for belt in linkage.belts:
        wheels.gear(belt)
    for k, rack in enumerate(linkage.racks):
        wheels.rack(rack, ("racks", k))
    for k, rolling in enumerate(linkage.rolling):
        if rolling.line is not None:
            wheels.roll_on_line(rolling, ("rolling", k))
        else:
            wheels.roll_on_circle(rolling)
    return wheels.linear


@dataclass
class _Wheels:
    frames: Frames
    problems: Problems
    linear: list[LinearEquation] = field(default_factory=list)

    def gear(self, pair: Gear | Belt) -> None:
        """q (θ2 - θa) ± p (θ1 - θa) = constant, p : q = r1 : r2."""
        numbers = self.frames.linkage.numbers
        sizes = pair.radii if pair.radii is not None else pair.teeth
        assert sizes is not None
        p, q = _ratio(*map(numbers, sizes), whole=pair.teeth is not None)
        together = pair.internal if isinstance(pair, Gear) else not pair.crossed
        p = -p if together else p
        phase = None
        if pair.phase is not None:
            phase = q * numbers(pair.phase) * self.frames.linkage.angle.radians
        first, second = pair.wheels
        self._tie(pair.name, [(second, q), (first, p), (pair.arm, -p - q)], total=phase)

    def _tie(
        self,
        label: str,
        turns: list[tuple[str, float]],
        length: tuple[str, float] | None = None,
        total: float | None = None,
    ) -> None:
        """Σ weight · angle of body (+ weight · length) = total, as it is in the sketch if open."""
        frames = self.frames
        weights, constant = frames.angles_of((body, settled(weight)) for body, weight in turns)
        now = sum(weight * frames.start[name] for name, weight in weights.items())
        if length is not None:
            weights[length[0]] = length[1]
            now += length[1] * frames.start[length[0]]
        constant = -now if total is None else constant - total
        self.linear.append(
            LinearEquation(
                label=label,
                terms=tuple((canonical(name), weight) for name, weight in weights.items()),
                constant=constant,
                kind="angle" if length is None else "length",
            )
        )

    def rack(self, rack: Rack, key: Key) -> None:
        """The rack's pitch line moves with the pinion's circumference."""
        linkage = self.frames.linkage
        slider = guide_named(linkage, rack.slider)
        assert isinstance(slider, Slider)
        side = self._side(slider.on, slider.line, rack.center, (*key, "center"))
        r = side * linkage.numbers(rack.radius)
        turns = [(rack.pinion, -r), (slider.on, r)]
        self._tie(rack.name, turns, length=(rack.slider, 1.0))

    def _side(self, body: str, line: tuple[str, str], point: str, key: Key) -> float:
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

    def roll_on_line(self, rolling: Rolling, key: Key) -> None:
        assert rolling.line is not None
        frames, linkage = self.frames, self.frames.linkage
        side = self._side(rolling.on, rolling.line, rolling.center, (*key, "center"))
        radius = linkage.numbers(rolling.radius)
        name = f"{rolling.name}_radius"
        frames.add_guide(
            (rolling.name, rolling.on, rolling.line), rolling.center, side * radius, name
        )
        turns = [(rolling.wheel, side * radius), (rolling.on, -side * radius)]
        self._tie(rolling.name, turns, length=(rolling.name, 1.0))

    def roll_on_circle(self, rolling: Rolling) -> None:
        """A rod joins the centres; wheel and circle mesh as gears on it."""
        assert rolling.circle is not None
        assert rolling.circle_radius is not None
        frames, numbers = self.frames, self.frames.linkage.numbers
        small, large = numbers(rolling.radius), numbers(rolling.circle_radius)
        length = abs(large - small) if rolling.inside else large + small
        a, b = rolling.circle, rolling.center
        frames.add_rod(rolling.name, (a, b), length)
        p, q = _ratio(large, small)
        p = -p if rolling.inside else p
        self._tie(rolling.name, [(rolling.wheel, q), (rolling.on, p), (rolling.name, -p - q)])


def _ratio(first: float, second: float, *, whole: bool = False) -> tuple[float, float]:
    """Two sizes as the smallest whole numbers in their ratio, if there are such; else as they are.

    With whole numbers a whole number of turns of one wheel is exactly one of the other.
    """
    if many(first) or many(second):
        p, q = _ratio(led(first), led(second), whole=whole)
        if q == 1.0 and not whole:
            return settled(first / second), q
        same = abs(q * first - p * second) <= _RATIO * abs(q * first)
        return settled(choose(same, p, math.nan)), q
    if whole:
        fraction = Fraction(int(first), int(second))
    else:
        fraction = Fraction(first / second).limit_denominator(_LARGEST)
    if fraction > 0 and abs(float(fraction) * second - first) <= _RATIO * first:
        return float(fraction.numerator), float(fraction.denominator)
    return first / second, 1.0
