"""The motion of a mechanism with one input as that of one number: A s̈ + ½A' ṡ² = Q.

A and ½A' follow from the masses and Q from the loads, all as functions of the leader's place s on
a leg of the curve of positions; they are tabulated, so that no mechanism is solved afterwards.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.mechanism.part.springs import Spring
from linkwork.core.numerics.newton import SolvedRows
from linkwork.forces.dynamics.collocation import Panels, fit_panels
from linkwork.forces.dynamics.curve import Leg
from linkwork.forces.dynamics.joint_friction import JointFriction, Rubbing
from linkwork.forces.dynamics.reduction import FAR, NEAR, Reduction, State
from linkwork.forces.reactions.geometry import AppliedLoads, Geometry, virtual_work

_LOOKS, _POLE = 257, 1e6  # places at which formulas are tried; times their usual value
_ZOOMS, _ZOOM = 13, 17  # rounds down to rounding, and the places of each
_MEETS = 1e-10  # of the longest link: ends of a spring that are nearer meet
_LAPS = (1, -1, 2, -3, 10, -30, 100, -1000)  # in which loads are compared with those of lap 0
_UNCHANGED = 1e-9  # of the largest load: sines of many turns are rounded so
_BEYOND = 0.03  # of a panel: how far a step may look beyond the end of its leg


class ReducedLeg:
    """A leg with its tables.

    ``gain`` (N,): what the variables of its curve gain in a lap.
    """

    def __init__(self, reduction: Reduction, leg: Leg, gain: Array) -> None:
        self.reduction, self.leg = reduction, leg
        low, high = sorted((leg.begin, leg.end))
        #: Whether the loads are tabulated, too.
        self.passes = [self._passes(spring, low, high) for spring in reduction.springs]
        steady = reduction.of_position and not any(map(len, self.passes))
        #: Whether loads of position are the same in every lap: those of a torsion spring are not.
        self.repeats = reduction.of_position and self._repeats(low, high, gain)
        self.tabulates = steady and self.repeats and self._is_smooth(low, high)
        self.variables = reduction.model.compiled.solver.variables
        scale = reduction.model.compiled.table.variable_scale
        groups = np.concatenate([[0, 1, 1], 2 + np.arange(self.variables)])
        groups = np.concatenate([groups, np.full(self.variables, groups[-1] + 1)])
        least = np.concatenate([np.zeros(3), scale, np.zeros(self.variables)])
        whole = fit_panels(self._tabulated, (low, high), groups, least)
        #: A, Q of weights, Q of loads of position, A'.
        self.numbers: Panels = whole.part(slice(0, 3)).with_slope()
        #: Variables and their first derivatives.
        self.table: Panels = whole.part(slice(3, None))

    def _is_smooth(self, low: float, high: float) -> bool:
        """Whether no formula of a load has a gap or a pole between two places."""
        if not self.reduction.formulas:
            return True
        s = np.linspace(low, high, _LOOKS)
        rows = self._solved(s)
        still = self.reduction.geometry(rows.v, 0.0 * rows.v, 0.0 * rows.v, np.zeros(len(s)))
        applied = AppliedLoads(still, 1.0)
        sizes = [np.abs(applied.formula(formula)) for formula in self.reduction.formulas]
        return all(
            np.isfinite(own).all() and own.max() <= _POLE * (1.0 + np.median(own)) for own in sizes
        )

    def _repeats(self, low: float, high: float, gain: Array) -> bool:
        if not gain.any() or not self.reduction.acting:
            return True
        rows = self._solved(np.linspace(low, high, _LOOKS))
        displaced = self.reduction.geometry(rows.v, rows.first, rows.second, np.zeros(_LOOKS))
        still, zero = 0.0 * rows.v, np.zeros(_LOOKS)
        works = [
            self._work(
                self.reduction.loaded(
                    self.reduction.geometry(rows.v + lap * gain, still, still, zero)
                ),
                displaced,
            )
            for lap in (0, *_LAPS)
        ]
        changes = np.abs(np.array(works[1:]) - works[0])
        return bool((changes <= _UNCHANGED * (1.0 + np.abs(works[0]).max())).all())

    def _passes(self, spring: Spring, low: float, high: float) -> Array:
        """The places at which a spring passes zero length, rising."""
        assert spring.between is not None
        start, end = spring.between

        def span(s: Array) -> tuple[Array, Array]:
            rows = self._solved(s)
            there = self.reduction.displaced(rows.v, rows.first, rows.second)
            jet = there.place(end) - there.place(start)
            return np.abs(jet.v), (jet.v.conj() * jet.d1).real

        looks = np.linspace(low, high, _LOOKS)
        lengths, rates = span(looks)
        meets = _MEETS * self.reduction.model.equations.length_scale
        found = [float(looks[k]) for k in (0, -1) if lengths[k] < meets]
        grows = rates > 0.0
        for k in np.flatnonzero(~grows[:-1] & grows[1:]):
            near = looks[k : k + 2]
            for _ in range(_ZOOMS):
                near = np.linspace(near[0], near[-1], _ZOOM)
                first = int(np.argmax(span(near)[1] > 0.0))
                near = near[max(first, 1) - 1 :][:2]
            if span(near)[0].min() < meets:
                found.append(float(near[1]))
        return np.unique(found)

    def _solved(self, s: Array) -> SolvedRows:
        """Positions at values of the leader in any order."""
        order = np.argsort(s, kind="stable")
        return self.leg.rows(s[order], False).take(np.argsort(order, kind="stable"))

    def _tabulated(self, s: Array) -> Array:
        """A, Q of weights, Q of loads of position, variables, first derivatives."""
        rows = self._solved(s)
        displaced = self.reduction.geometry(rows.v, rows.first, rows.second, np.zeros(len(s)))
        applied = AppliedLoads(displaced, 1.0)
        zero = np.zeros(len(s))
        with np.errstate(all="ignore"):
            applied.weigh(self.reduction.description)
            mass = 2.0 * sum(applied.kinetic, zero)
            weight = sum((body.weight_rate for body in applied.masses), zero)
        lead = self.reduction.model.compiled.solver.unknowns
        q1 = rows.first[:, lead]
        mass = mass + self.reduction.inertia * q1**2
        load = zero
        if self.tabulates:
            still = self.reduction.geometry(rows.v, 0.0 * rows.v, 0.0 * rows.v, zero)
            load = self._work(self.reduction.loaded(still), displaced)
            if self.reduction.motor is not None:
                load = load + self.reduction.motor.torque(zero) * q1
        return np.column_stack([mass, weight, load, rows.v, rows.first])

    @cached_property
    def friction(self) -> JointFriction | None:
        """The friction of joints; ``None`` if they have none."""
        if not self.reduction.rubs:
            return None
        low, high = sorted((self.leg.begin, self.leg.end))
        return JointFriction(self.reduction, low, high, self._solved, self.tabulates)

    @cached_property
    def reach(self) -> tuple[float, float]:
        """The places between which the tables may be used."""
        tables = [self.table] if self.friction is None else [self.table, self.friction.table]
        first, last = (min(np.diff(table.edges)[k] for table in tables) for k in (0, -1))
        edges = self.table.edges
        return float(edges[0] - _BEYOND * first), float(edges[-1] + _BEYOND * last)

    def acceleration(
        self, s: Array, speed: Array, t: Array, gain: Array, rubbing: Rubbing | None = None
    ) -> Array:
        """s̈ at B states, without friction unless its signs are given; NaN where it locks.

        ``gain`` (N,): what variables have gained in laps.
        """
        mass, weight, load, slope = self.numbers(s).T
        force = weight + load
        varying, known = self._varying(s, speed, t, gain)
        force = force + varying
        if rubbing is not None and self.friction is not None:
            force = force + self.friction.force(s, speed, known, rubbing)
        with np.errstate(all="ignore"):
            # eq. (92): A' is the derivative of the polynomial for A, so that energy is kept
            found: Array = (force - 0.5 * slope * speed**2) / mass
        return found

    def friction_power(
        self, s: Array, speed: Array, t: Array, gain: Array, rubbing: Rubbing
    ) -> Array:
        """The power that friction takes, (B,)."""
        assert self.friction is not None
        known = self._varying(s, speed, t, gain)[1]
        found: Array = -self.friction.force(s, speed, known, rubbing) * speed
        return found

    def hold(self, s: float, speed: float, t: float, gain: Array, direction: float) -> Rubbing:
        """The signs of friction for a motion from a state."""
        assert self.friction is not None
        place, pace, time = (np.array([x]) for x in (s, speed, t))
        known = self._varying(place, pace, time, gain)[1][0]
        return self.friction.hold(s, speed, known, direction)

    def friction_margins(
        self, s: Array, speed: Array, t: Array, gain: Array, rubbing: Rubbing
    ) -> Array:
        """How far the signs of friction are from their change, (B, M)."""
        assert self.friction is not None
        known = self._varying(s, speed, t, gain)[1]
        return self.friction.margins(s, speed, known, rubbing)

    def state(self, s: Array, speed: Array, t: Array, gain: Array) -> State:
        """The rows of B states."""
        row = self.table(s)
        v, first = row[:, : self.variables] + gain, row[:, self.variables :]
        unknown = np.full_like(v, np.nan)
        moving = self.reduction.geometry(v, first * speed[:, None], unknown, t)
        displaced = self.reduction.geometry(v, first, unknown, t)
        return State(moving=moving, displaced=displaced)

    def _varying(self, s: Array, speed: Array, t: Array, gain: Array) -> tuple[Array, Array]:
        """Q (B,) of all loads that are not tabulated, and their amounts: that of the motor, and
        x and y of forces, then torques, (B, 1 + L).
        """
        total, torque = np.zeros(len(s)), np.zeros(len(s))
        if self.tabulates:
            return total, torque[:, None]
        amounts: list[Array] = []
        if self.reduction.acting:
            state = self.state(s, speed, t, gain)
            applied = self.reduction.loaded(state.moving, self.spring_margins(s))
            total = self._work(applied, state.displaced)
            for _, force, _ in applied.forces:
                amounts += [force.real, force.imag]
            amounts += [own for _, own in applied.torques]
        if self.reduction.motor is not None:
            slope = self.input_slope(s)
            torque = self.reduction.motor.torque(slope * speed)
            total = total + torque * slope
        return total, np.column_stack([torque, *amounts])

    def failing_load(self, s: float, speed: float, t: float, gain: Array, until: float) -> str:
        """Why a load stops a motion up to ``until`` in a state; "" if none does."""
        near, far = (
            self.state(s + speed * ahead, np.full_like(ahead, speed), t + ahead, gain).moving
            for ahead in (NEAR * until, FAR * until)
        )
        return self.reduction.failing_load(near, far)

    def input_slope(self, s: Array) -> Array:
        """The derivative of the input by the leader, (B,)."""
        return self.slopes(s)[:, self.reduction.model.compiled.solver.unknowns]

    def slopes(self, s: Array) -> Array:
        """The derivatives of all variables by the leader, (B, N)."""
        return self.table(s)[:, self.variables :]

    def _work(self, applied: AppliedLoads, displaced: Geometry) -> Array:
        """Q of loads and springs, (B,)."""
        works = (virtual_work(*pair) for pair in applied.moving(displaced))
        return sum(works, np.zeros(displaced.rows))

    def margins(self, s: Array, speed: Array, t: Array, gain: Array) -> Array:
        """The margins of all comparisons, (B, comparisons)."""
        moving = self.state(s, speed, t, gain).moving
        applied = AppliedLoads(moving, 1.0, switches=self.reduction.switches)
        rates = (self.input_slope(s) * speed)[:, None]
        return np.stack(self.reduction.margins(applied, rates, self.spring_margins(s)), axis=1)

    def spring_margins(self, s: Array) -> Array:
        """Distances to the next place where a spring passes zero length, with a sign that changes
        there, (B, S).
        """
        found = np.ones((len(s), len(self.passes)))
        for k, places in enumerate(self.passes):
            if len(places):
                away = s[:, None] - places
                found[:, k] = np.abs(away).min(axis=1) * np.prod(np.sign(away), axis=1)
        return found
