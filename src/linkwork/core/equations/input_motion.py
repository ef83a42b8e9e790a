"""Inputs that time drives: every law becomes an equation, and the time t the only input."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from linkwork.core.equations.model import LawEquation, LoopEquations, Variable
from linkwork.core.expression.derivatives import Jet, evaluate
from linkwork.core.expression.grammar import parse
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import MechanismError, Problem
from linkwork.core.foundation.names import canonical
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.inputs import THROUGH, Input, LawSegment, Piece, pieces_of
from linkwork.core.table.rows import Piecewise

#: The name of the time.
TIME = "t"
_DEGREE = 7  # of the polynomials of all laws
_CORNER = 1e-9  # of the largest slope: a change that is no rounding
_REACHED = 1e-12  # a value that the input has already
_EXACT = 1e-13  # of a formula's size: error of its interpolation
_FINEST = 2.0**-16  # of the table: a formula that is not smooth over less has a corner or jumps
_MOST_KNOTS = 20_000
_GRID = 64  # knots of a formula at first


def time_variable() -> Variable:
    """The time as an input."""
    return Variable(name=TIME, kind="time", symbol=TIME)


def driven_by_time(equations: LoopEquations, description: Description) -> LoopEquations:
    """The equations with the time as input and a law for each input that had none.

    The variables keep their order: the former inputs are the last unknowns.

    Raises
    ------
    MechanismError
        For a formula that has no value, or jumps.
    """
    laws = _laws(equations, description, led_in=False)
    # one time for all: if one input is not where its law begins, all are led in
    if any(law.is_apart for law in laws):
        laws = _laws(equations, description, led_in=True)
    rows = zip(equations.inputs, laws, strict=True)
    return replace(
        equations,
        unknowns=equations.variables,
        inputs=(time_variable(),),
        laws=(*equations.laws, *(_equation(variable, law) for variable, law in rows)),
        start=np.append(equations.start, laws[0].breaks[0]),
    )


def law_motions(
    equations: LoopEquations, description: Description
) -> list[tuple[float, Piecewise] | None]:
    """The law of every input as an origin and the displacement from it over time [rad] or [length];
    ``None`` without a law.

    Raises
    ------
    MechanismError
        For a formula that has no value, or jumps.
    """
    laws = _laws(equations, description, led_in=False)
    return [None if law.which.law is None else (law.origin, law.piecewise()) for law in laws]


def _laws(equations: LoopEquations, description: Description, *, led_in: bool) -> list[_Law]:
    found = []
    for k, which in enumerate(description.inputs):
        scale = description.angle.radians if equations.inputs[k].kind == "angle" else 1.0
        here = float(equations.start[len(equations.unknowns) + k])
        law = _Law(description, which, scale, here, led_in)
        try:
            law.write()
        except _NoLaw as error:
            problem = Problem(key=(*description.input_key(k), "law"), message=str(error))
            raise MechanismError([problem], f'mechanism "{description.name}"') from None
        found.append(law)
    return found


def _equation(variable: Variable, found: _Law) -> LawEquation:
    return LawEquation(
        label=f"{variable.name} over time",
        terms=((variable.symbol, 1.0),),
        constant=-found.origin,
        law=found.piecewise(),
        shown=f"{variable.shown}_law",
        inner=((canonical(TIME), 1.0),),
        offset=0.0,
        meaning=_meaning(variable, found.which),
        kind=variable.kind,
    )


def _meaning(variable: Variable, which: Input) -> str:
    if isinstance(which.law, str):
        return f"{variable.shown}_law is {which.law} over time"
    parts = [
        f"{part.law} over {part.over}" + (f" by {part.by}" if part.by else "")
        for part in which.law or ()
    ]
    return f"{variable.shown}_law is the input's motion over time: {', '.join(parts) or 'none'}"


class _NoLaw(Exception):
    """A formula that is no law of motion."""


@dataclass
class _Law:
    """An input's displacement from ``origin`` over time, piece by piece.

    ``here``: its value in the sketch [rad] or [length]; ``led_in``: whether it moves from there to
    the law's first value before the table begins; ``is_apart``: whether it must.
    """

    description: Description
    which: Input
    scale: float
    here: float
    led_in: bool
    is_apart: bool = False
    origin: float = 0.0
    breaks: list[float] = field(default_factory=list)
    powers: list[Array] = field(default_factory=list)
    sines: list[tuple[float, float, float]] = field(default_factory=list)

    def write(self) -> None:
        """All pieces, led in from the sketch's own value."""
        numbers, law = self.description.numbers, self.which.law
        if isinstance(law, str):
            self._interpolate(law)
            return
        if law is None:  # held
            value = self.description.rows(self.which)[0] * self.scale
        elif self.which.begin is None:
            value = self.here
        else:
            value = numbers(self.which.begin) * self.scale
        self.origin = value
        times = self.description.times
        first = min(0.0, float(times[0]))
        self.breaks = [first]
        for segment in law or ():
            self._append(segment)
        if law is None:
            self._add(float(np.ptp(times)) or 1.0, np.zeros(1))
        self._lead_in(float(np.ptp(times)))

    def piecewise(self) -> Piecewise:
        """The displacement as a function of t."""
        found = Piecewise(
            breaks=np.array(self.breaks),
            powers=np.array(self.powers),
            sines=np.array(self.sines),
            periodic=False,
        )
        inside = found.breaks[1:-1]
        before = found.slope_before_joints()
        after = found.jet(inside)[1]
        middle = 0.5 * (found.breaks[1:] + found.breaks[:-1])
        size = np.abs(found.jet(np.concatenate([inside, middle]))[1]).max()
        corners = np.flatnonzero(np.abs(after - before) > _CORNER * size)
        return replace(found, corners=tuple(corners.tolist()))

    def _lead_in(self, span: float) -> None:
        """From the sketch's value at rest into the first piece, before the table begins."""
        first = self.powers[0]
        a, w, p = self.sines[0]
        value = float(first[0]) + a * math.sin(p)
        slope, bend = (
            float(first[1]) + a * w * math.cos(p),
            float(2 * first[2]) - w**2 * a * math.sin(p),
        )
        gap = self.here - self.origin
        self.is_apart = abs(gap - value) > _REACHED * max(1.0, abs(self.here))
        if not self.led_in:
            return
        over = 0.5 * span or 1.0
        row = np.zeros(_DEGREE + 1)
        row[:6] = _quintic(over, (gap, 0.0, 0.0), (value, slope, bend))
        self.breaks.insert(0, self.breaks[0] - over)
        self.powers.insert(0, row)
        self.sines.insert(0, (0.0, 1.0, 0.0))

    def _add(
        self, over: float, powers: Array, sine: tuple[float, float, float] = (0.0, 1.0, 0.0)
    ) -> None:
        row = np.zeros(_DEGREE + 1)
        row[: len(powers)] = powers
        self.breaks.append(self.breaks[-1] + over)
        self.powers.append(row)
        self.sines.append(sine)

    def _state(self) -> tuple[float, float]:
        """Displacement and speed at the end of the last piece."""
        if not self.powers:
            return 0.0, 0.0
        t = self.breaks[-1] - self.breaks[-2]
        powers, (a, w, p) = self.powers[-1], self.sines[-1]
        value = np.polynomial.polynomial.polyval(t, powers) + a * math.sin(w * t + p)
        slope = np.polynomial.polynomial.polyval(t, powers[1:] * np.arange(1, len(powers)))
        return float(value), float(slope + a * w * math.cos(w * t + p))

    def _append(self, segment: LawSegment) -> None:
        numbers = self.description.numbers
        height, speed = self._state()
        begin = self.breaks[-1]
        over = segment.duration(numbers)
        if segment.law in THROUGH:
            t, rise = np.array(segment.through(numbers)).T
            write = self._spline if segment.law == "spline" else self._lines
            write(t, height + self.scale * rise)
            return
        by = segment.displacement(numbers) * self.scale
        if segment.law == "ramp":
            self._add(over, np.array([height, speed, (by - speed * over) / over**2]))
            return
        done = 0.0
        for piece in pieces_of(segment.law):
            done += piece.over
            end = begin + over * min(done, 1.0)
            self._add(end - self.breaks[-1], *_scaled(piece, height, over, by))

    def _lines(self, t: Array, values: Array) -> None:
        for over, low, high in zip(np.diff(t), values[:-1], values[1:], strict=True):
            self._add(float(over), np.array([low, (high - low) / over]))

    def _spline(self, t: Array, values: Array) -> None:
        """Two continuous derivatives inside, at rest at both ends."""
        for over, *ends in _clamped_spline(t, values):
            self._add(over, _cubic(over, *ends))

    def _interpolate(self, formula: str) -> None:
        """Quintics between knots, the table's rows among them, where a formula has these values
        and derivatives.
        """
        times = self.description.times
        knots, jets = self._knots(formula, times)
        self.breaks = [float(knots[0])]
        finest = _FINEST * max(float(np.ptp(times)), np.finfo(float).tiny)
        for k, over in enumerate(np.diff(knots)):
            ends = [tuple(float(part[j]) for part in jets) for j in (k, k + 1)]
            if over > finest:
                self._add(float(over), _quintic(float(over), ends[0], ends[1]))
            else:  # a corner is in it
                self._add(float(over), np.array([ends[0][0], (ends[1][0] - ends[0][0]) / over]))
        self._lead_in(float(np.ptp(times)))

    def _knots(self, formula: str, times: Array) -> tuple[Array, tuple[Array, ...]]:
        low, high = float(times.min()), float(times.max())
        own = times if len(times) <= _MOST_KNOTS else np.zeros(0)
        grid = np.linspace(low, high, _GRID + 1)
        # a knot that differs from a row's time by rounding would make a corner between them
        apart = np.abs(grid[:, None] - own).min(axis=1, initial=np.inf) > _FINEST * (high - low)
        knots = np.unique(np.concatenate([own, grid[apart]]))
        if low == high:
            knots = np.array([low, low + 1.0])
        jets = self._values(formula, knots)
        size = max(float(np.abs(jets[0]).max()), _REACHED)
        finest = _FINEST * (knots[-1] - knots[0])
        while True:
            middle = 0.5 * (knots[1:] + knots[:-1])
            over = np.diff(knots)
            wrong = over > finest
            found = self._values(formula, middle)
            left = [part[:-1] for part in jets]
            right = [part[1:] for part in jets]
            error = np.abs(_quintic_middle(over, left, right) - found[0])
            wrong &= error > _EXACT * size
            if not wrong.any() or len(knots) > _MOST_KNOTS:
                break
            order = np.argsort(np.concatenate([knots, middle[wrong]]), kind="stable")
            knots = np.concatenate([knots, middle[wrong]])[order]
            v, d1, d2 = (
                np.concatenate([a, b[wrong]])[order] for a, b in zip(jets, found, strict=True)
            )
            jets = (v, d1, d2)
        jump = (error > 1e-3 * size) & (over <= finest)
        jump |= (np.abs(np.diff(jets[0])) > 0.01 * size) & (over <= finest)
        if jump.any():
            where = knots[int(np.flatnonzero(jump)[0])]
            raise _NoLaw(f"jumps at t = {where:.6g} s: an input has a finite speed")
        return knots, jets

    def _values(self, formula: str, t: Array) -> tuple[Array, Array, Array]:
        numbers = self.description.numbers
        known = {name: Jet.constant(value) for name, value in numbers.known.items()}
        known[TIME] = Jet(t, np.ones_like(t), np.zeros_like(t))
        with np.errstate(all="ignore"):
            jet = evaluate(parse(formula, comparing=True), known, self.description.angle)
        v, d1, d2 = (
            np.array(np.broadcast_to(part, t.shape), dtype=float) * self.scale
            for part in (jet.v, jet.d1, jet.d2)
        )
        lost = ~(np.isfinite(v) & np.isfinite(d1) & np.isfinite(d2))
        if lost.any():
            where = float(t[int(np.flatnonzero(lost)[0])])
            raise _NoLaw(f"has no finite value or rate at t = {where:.6g} s")
        return v, d1, d2


def _scaled(
    piece: Piece, height: float, over: float, by: float
) -> tuple[Array, tuple[float, float, float]]:
    """A piece of a law from 0 to 1, stretched; the law's own time begins with the piece."""
    powers = np.array([by * c / over**k for k, c in enumerate(piece.powers)])
    powers[0] += height
    a, w, p = piece.sine
    return powers, (by * a, w / over, p)


def _quintic(over: float, begin: tuple[float, ...], end: tuple[float, ...]) -> Array:
    """Powers of the polynomial with these values and two derivatives at both ends, (6,)."""
    (v0, a1, a2), (v1, b1, b2) = begin, end
    a1, b1, a2, b2 = a1 * over, b1 * over, a2 * over**2, b2 * over**2
    rise = v1 - v0
    # eq. (20)
    c3 = 10 * rise - 6 * a1 - 4 * b1 - 1.5 * a2 + 0.5 * b2
    c4 = -15 * rise + 8 * a1 + 7 * b1 + 1.5 * a2 - b2
    c5 = 6 * rise - 3 * a1 - 3 * b1 - 0.5 * a2 + 0.5 * b2
    return np.array([v0, a1, 0.5 * a2, c3, c4, c5]) / over ** np.arange(6.0)


def _quintic_middle(over: Array, left: list[Array], right: list[Array]) -> Array:
    """The values of such polynomials half way."""
    (v0, a1, a2), (v1, b1, b2) = left, right
    # eq. (21)
    middle: Array = 0.5 * (v0 + v1) + 5.0 / 32.0 * over * (a1 - b1) + over**2 / 64.0 * (a2 + b2)
    return middle


def _cubic(over: float, v0: float, v1: float, s0: float, s1: float) -> Array:
    """Powers of the cubic with these values and slopes at its ends, (4,)."""
    rise = (v1 - v0) / over
    return np.array([v0, s0, (3 * rise - 2 * s0 - s1) / over, (s0 + s1 - 2 * rise) / over**2])


def _clamped_spline(t: Array, values: Array) -> Iterator[tuple[float, float, float, float, float]]:
    """Duration, values and slopes of every piece of the cubic spline that is level at its ends."""
    h = np.diff(t)
    rise = np.diff(values) / h
    count = len(t)
    matrix, right = np.eye(count), np.zeros(count)
    for k in range(1, count - 1):
        # the second derivatives of both neighbours agree
        matrix[k, k - 1 : k + 2] = h[k], 2.0 * (h[k - 1] + h[k]), h[k - 1]
        right[k] = 3.0 * (h[k] * rise[k - 1] + h[k - 1] * rise[k])
    slopes = np.linalg.solve(matrix, right)
    for k, over in enumerate(h):
        yield tuple(map(float, (over, values[k], values[k + 1], slopes[k], slopes[k + 1])))  # type: ignore[misc]
