"""Quantities of stated positions and their derivatives by numbers, to twenty digits."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from flint import acb, arb, ctx

from linkwork.core.expression.grammar import parse
from linkwork.core.foundation.names import canonical
from linkwork.core.mechanism.bodies import CamOutline, Follower
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.varied_numbers import VariedNumber
from linkwork.core.motion.model import Model
from linkwork.core.results.quantities.definition import Asked, Group
from linkwork.core.results.quantity import Kind
from tests.oracles.stated_equations import DIGITS, NotStated, StatedEquations, evaluate, stated

__all__ = ["StatedRow"]

_STEP = arb(2) ** -40  # of the input and of numbers; exact: functions of wide balls lose digits
Ball = Any


@dataclass(frozen=True)
class _Jet:
    """A value with two derivatives by the leading input."""

    v: Ball
    d1: Ball
    d2: Ball


class _Design:
    """Quantities of one design at one value of the inputs, internal units."""

    def __init__(
        self, model: Model, equations: StatedEquations, inputs: Sequence[Ball], rate: Sequence[Ball]
    ) -> None:
        self.model, self.equations = model, equations
        self.names = model.quantities.names
        near = None
        self.states, self.inputs = [], []
        for k in (0, -1, 1):
            at = [u + r * k * _STEP for u, r in zip(inputs, rate, strict=True)]
            state = equations.solve(at, near)
            near = [state[name] for name in equations.names]
            self.states.append(state)
            self.inputs.append(at)
        self.jet = cache(self._jet)
        self.place = cache(self._place)

    def _differences(self, of: Callable[[int], Ball]) -> _Jet:
        here, before, after = (of(k) for k in range(3))
        first = (after - before) / (2 * _STEP)
        return _Jet(here, first, (after - 2 * here + before) / _STEP**2)

    def _place(self, point: str) -> _Jet:
        """A point x + iy."""
        return self._differences(lambda k: self.equations.point(self.states[k], point))

    def _jet(self, name: str) -> _Jet:
        """A quantity that is not a rate."""
        asked = self.model.quantities.find(name)
        if asked.group is not Group.DERIVED:
            return self._differences(lambda k: self.plain(asked, k))
        word, part = asked.row.word if asked.row else "", asked.part
        if word == "transmission":
            return self._differences(lambda k: self._transmission(part, k))
        if word == "mechanical_advantage":
            own = self.jet(part)
            return _Jet(1 / own.d1, -own.d2 / own.d1**2, None)
        if word == "pressure_angle":
            return self._pressure(part)
        if word not in ("curvature", "centre.x", "centre.y"):
            raise NotStated(name)
        p = self.place(part)
        cross = (p.d1.conjugate() * p.d2).imag
        if word == "curvature":
            return _Jet(cross / abs(p.d1) ** 3, None, None)
        centre = p.v + acb(0, 1) * p.d1 * abs(p.d1) ** 2 / cross
        return _Jet(centre.real if word.endswith("x") else centre.imag, None, None)

    def plain(self, asked: Asked, k: int) -> Ball:
        """A quantity of the mechanism's own in one of the states."""
        name, state = asked.own.name, self.states[k]
        if asked.group is Group.INPUT:
            which = [x.name for x in self.model.equations.inputs].index(name)
            return self.inputs[k][which]
        if asked.group is Group.COORDINATE:
            point, _, axis = name.rpartition(".")
            z = self.equations.point(state, point)
            return z.real if axis == "x" else z.imag
        if asked.group is Group.OUTPUT:
            return self._output(name, k)
        return self.equations.own(state, name)

    def _output(self, name: str, k: int) -> Ball:
        """A formula in file units."""
        radians = self.equations.numbers.radians

        def named(used: str) -> Ball:
            if used in self.equations.numbers.given:
                return self.equations.numbers.dimension(used)
            asked = self.model.quantities.find(used)
            if asked.group is Group.DERIVED or asked.rate is not None:
                raise NotStated(name)
            value = self.plain(asked, k)
            return value / radians if asked.own.kind is Kind.ANGLE else value

        written = {canonical(n): text for n, text in self.model.description.outputs.items()}
        value = evaluate(parse(written[canonical(name)]), named, radians)
        asked = self.model.quantities.find(name)
        return value * radians if asked.own.kind is Kind.ANGLE else value

    def _transmission(self, pin: str, k: int) -> Ball:
        state, equations = self.states[k], self.equations
        dyad = next(dyad for dyad in self.names.dyads if dyad.pin == pin)
        place = equations.point(state, pin)
        one = equations.point(state, dyad.arms[0]) - place
        if dyad.guide is None:
            other = equations.point(state, dyad.arms[1]) - place
        else:
            start, end = (equations.point(state, p) for p in dyad.guide.line)
            other = (end - start) * acb(0, 1)
        return abs((one * other.conjugate()).arg())

    def _pressure(self, part: str) -> _Jet:
        skeleton = self.names.skeleton
        followers = {f.name: f for f in skeleton.of(Follower) if f.contact != "flat"}
        guides = {g.name: g for g in skeleton.guides}
        if part not in followers:
            dyad = next(d for d in self.names.dyads if d.guide is not None and d.guide.name == part)

            def of(k: int) -> Ball:
                names = (dyad.pin, dyad.arms[0], *guides[part].line)
                pin, arm, start, end = (self.equations.point(self.states[k], p) for p in names)
                return _between(pin - arm, end - start)

            return self._differences(of)
        return self._pressed(followers[part], guides)

    def _pressed(self, follower: Any, guides: Mapping[str, Any]) -> _Jet:
        """The pressure angle of a cam on its follower."""
        cams = self.names.skeleton.of(CamOutline)
        cam = next(one for one in cams if one.name == follower.name)
        turn, tip, centre = self.jet(cam.link), self.place(follower.point), self.place(cam.center)
        i = acb(0, 1)
        arm, rate = tip.v - centre.v, tip.d1 - centre.d1
        # the follower's point moves on the cam across the force
        slides = rate - i * turn.d1 * arm
        turned = tip.d2 - centre.d2 - i * (turn.d2 * arm + turn.d1 * rate)
        force, force_turn = i * slides, (turned / slides).imag
        if follower.pivot is None:
            start, end = (self.place(p) for p in guides[follower.slider].line)
            way, way_turn = end.v - start.v, ((end.d1 - start.d1) / (end.v - start.v)).imag
        else:
            pivot = self.place(follower.pivot)
            way, way_turn = i * (tip.v - pivot.v), ((tip.d1 - pivot.d1) / (tip.v - pivot.v)).imag
        between = (force * way.conjugate()).arg()
        grows = (-1 if between < 0 else 1) * (-1 if abs(between) > arb.pi() / 2 else 1)
        return _Jet(_between(force, way), grows * (force_turn - way_turn), None)

    def value(self, asked: Asked) -> Ball:
        """A quantity or a rate of one, in its unit."""
        jet = self.jet(asked.own.name)
        speed = arb(float(self.model.speed or 0.0))
        rate = asked.rate
        angle = asked.own.kind is Kind.ANGLE
        if rate is None:
            return jet.v / self.equations.numbers.radians if angle else jet.v
        part = jet.d1 if rate.order == 1 else jet.d2
        if part is None:
            raise NotStated(asked.name)
        return part * speed**rate.order if rate.by_time else part


def _between(a: Ball, b: Ball) -> Ball:
    """The angle between two lines, 0 to a quarter turn."""
    angle = abs((a * b.conjugate()).arg())
    return arb.pi() - angle if angle > arb.pi() / 2 else angle


class StatedRow:
    """A solved row, and derivatives of its quantities by numbers.

    Parameters
    ----------
    model : Model
    guess : Mapping[str, float]
        As of :class:`~tests.oracles.stated_equations.StatedEquations`.
    inputs, rate : (p,)
        Values of the inputs, internal units, and their rates by the leading one.
    """

    def __init__(
        self, model: Model, guess: Mapping[str, float], inputs: np.ndarray, rate: np.ndarray
    ) -> None:
        ctx.dps = DIGITS
        self.model, self.guess = model, guess
        self.inputs = [arb(float(u)) for u in inputs]
        self.rate = [arb(float(r)) for r in rate]

    def _design(self, changed: Mapping[VariedNumber, Ball]) -> _Design:
        description: Description = self.model.description
        return _Design(self.model, stated(description, changed, self.guess), self.inputs, self.rate)

    def values(self, wanted: Sequence[str]) -> list[float]:
        """The quantities themselves; NaN where they are not stated."""
        return [_float(value) for value in self._all(wanted, {})]

    def slopes(self, wanted: Sequence[str], number: VariedNumber) -> list[float]:
        """Their derivatives by a number; NaN where they are not stated."""
        at = arb(float(number.of(self.model.description)))
        up, down = (self._all(wanted, {number: at + side * _STEP}) for side in (1, -1))
        return [
            _float(None if a is None or b is None else (a - b) / (2 * _STEP))
            for a, b in zip(up, down, strict=True)
        ]

    def _all(self, wanted: Sequence[str], changed: Mapping[VariedNumber, Ball]) -> list[Ball]:
        """The quantities of a design, ``None`` for those that are not stated."""
        design, found = self._design(changed), []
        for name in wanted:
            try:
                found.append(design.value(self.model.quantities.find(name)))
            except (NotStated, ZeroDivisionError):
                found.append(None)
        return found


def _float(value: Ball | None) -> float:
    if value is None:
        return float("nan")
    return float(value.mid() if isinstance(value, arb) else value.real.mid())
