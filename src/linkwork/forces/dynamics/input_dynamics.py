"""Inputs that laws drive while others are free."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.core.equations.input_motion import law_motions
from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray, solutions
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import CONVERGED, Certification, Status
from linkwork.core.motion.model import Model
from linkwork.core.numerics.newton import SolvedRows
from linkwork.core.numerics.position_proof import prove
from linkwork.core.table.rows import Piecewise
from linkwork.forces.dynamics.curve import with_proofs
from linkwork.forces.dynamics.reduction import Reduction
from linkwork.forces.reactions.drives import efforts
from linkwork.forces.reactions.geometry import AppliedLoads, Geometry

_ROUNDING = 1e-12  # of the whole time: a law that ends there does not end before


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenInputs:
    """The inputs of a mechanism, of which laws drive some.

    ``laws``: of every input its origin and the displacement over time; ``None`` of a free one.
    ``size`` (p,): the unit in which each is measured [rad] or [length].
    """

    laws: tuple[tuple[float, Piecewise] | None, ...]
    size: Array

    @classmethod
    def of(cls, model: Model, size: Array) -> DrivenInputs:
        """Those of a mechanism with its own inputs."""
        laws: list[tuple[float, Piecewise] | None] = [None] * len(size)
        if model.description.timed:
            laws = law_motions(model.equations, model.description)
        return cls(laws=tuple(laws), size=size)

    @cached_property
    def free(self) -> IndexArray:
        """The numbers of the free inputs, (f,)."""
        return np.array([k for k, law in enumerate(self.laws) if law is None], dtype=np.intp)

    @cached_property
    def driven(self) -> IndexArray:
        """The numbers of the driven inputs."""
        return np.array([k for k, law in enumerate(self.laws) if law is not None], dtype=np.intp)

    @cached_property
    def breaks(self) -> Array:
        """The times at which the acceleration of a law may jump, rising."""
        own = [law[1].breaks for law in self.laws if law is not None]
        return np.unique(np.concatenate(own)) if own else np.zeros(0)

    def next_break(self, t: float) -> float:
        """The first of these times after ``t``."""
        later = self.breaks[self.breaks > t]
        return float(later[0]) if len(later) else np.inf

    def check(self, model: Model, until: float) -> None:
        """Refuse laws that end before, or whose speed jumps.

        Raises
        ------
        InputError
            With the input and the time.
        """
        for variable, law in zip(model.equations.inputs, self.laws, strict=True):
            if law is None:
                continue
            displacement = law[1]
            if displacement.breaks[0] > 0.0:
                raise InputError(
                    f"the law of {variable.name} begins at {displacement.breaks[0]:g} s, after the "
                    "simulation: let its formula begin at 0"
                )
            end = float(displacement.breaks[-1])
            if end < until * (1.0 - _ROUNDING):
                raise InputError(
                    f"the law of {variable.name} ends at {end:g} s, before {until:g} s: add a "
                    'segment, for example { law = "dwell", … }, or simulate to its end'
                )
            jumps = displacement.breaks[1:-1][list(displacement.corners)]
            inside = jumps[(jumps > 0.0) & (jumps < until)]
            if len(inside):
                raise InputError(
                    f"the law of {variable.name} changes its speed at once at {inside[0]:g} s, a "
                    "shock for the free inputs: use a law with a continuous speed"
                )

    def complete(self, free: Array, t: Array, order: int) -> Array:
        """The values (B, p) of all inputs at times (B,) from those of the free ones (B, f), or
        their first or second derivatives.
        """
        if not len(self.driven):
            return free
        found = np.empty((len(t), len(self.laws)))
        found[:, self.free] = free
        for k in self.driven:
            law = self.laws[k]
            assert law is not None
            origin, displacement = law
            own = displacement.jet(t)[order] + (origin if order == 0 else 0.0)
            found[:, k] = own / self.size[k]
        return found


# ----------------------------------------------------------------------
# The accelerations of several inputs: M(q) q̈ + c(q, q̇) = Q(q, q̇, t).
#
# Laws may drive some of them; the others are free, and have the equations that are left.
# Positions are solved from the last proved one, along its tangents. Inputs are measured in radians
# and longest links, so that units change nothing.


_IN_LINE = 1e-12  # of the longest link: how far a spring in line may be off it
_SHORT = 1e-6  # of the longest link: a shorter spring has no direction
_FAR = 0.3  # weighted: a position that Newton-Raphson finds farther from its tangent is another


class InputDynamics:
    """A mechanism with p inputs, f of them free.

    Parameters
    ----------
    reduction : Reduction
        The loads.
    start : (N,)
        The first position, internal units.
    """

    def __init__(self, reduction: Reduction, start: Array) -> None:
        self.reduction = reduction
        model = reduction.model
        self.solver = model.compiled.solver
        kinds = [variable.kind for variable in model.equations.inputs]
        length = model.equations.length_scale
        #: The unit in which every input is measured here, (p,).
        self.size = np.array([1.0 if kind == "angle" else length for kind in kinds])
        self.inputs = DrivenInputs.of(model, self.size)
        self._start = start
        self._lines: ComplexArray = np.zeros(0, dtype=complex)
        self.restart()

    @property
    def here(self) -> Array:
        """The free inputs at the last proved position, (f,)."""
        found: Array = self._at[self.solver.unknowns :] / self.size
        return found[self.inputs.free]

    @property
    def nearness(self) -> float:
        """How near the last proved position is to a singular one."""
        return float(self.solver.rates(self._at[None], np.ones(len(self.size))).nearness[0])

    @property
    def variables(self) -> Array:
        """The last proved position, (N,)."""
        return self._at

    def restart(self) -> None:
        """Go on from the first position."""
        self._at, self._slopes, self._signs = self._anchor(self._start)

    def _anchor(self, v: Array) -> tuple[Array, Array, Array]:
        """A position with its derivatives by all inputs, (N, p), and the signs of its blocks."""
        units = [self.solver.rates(v[None], each) for each in np.eye(len(self.size))]
        slopes = np.stack([each.first[0] for each in units], axis=1)
        return v, slopes, self.solver.rates(v[None], np.ones(len(self.size))).orientation[0]

    def settle(self, q: Array, t: float) -> bool:
        """Go on from the position at the free inputs ``q`` (f,), if it is proved."""
        v, found = self.positions(q[None], np.array([t]))
        if not found[0]:
            return False
        still = np.zeros((1, len(self.size)))
        if self.solver.is_provable and not prove(self.solver, v, still).holds[0]:
            return False
        self._at, self._slopes, self._signs = self._anchor(v[0])
        return True

    def positions(self, q: Array, t: Array) -> tuple[Array, BoolArray]:
        """Positions (B, N) at free inputs (B, f) and times (B,), and which of them were found on
        the same branch.
        """
        own = self.inputs.complete(q, t, 0) * self.size
        guess = self._at + (own - self._at[self.solver.unknowns :]) @ self._slopes.T
        guess[:, self.solver.unknowns :] = own
        finite = np.isfinite(guess).all(axis=1)
        guess = np.where(finite[:, None], guess, self._at)
        solved = self.solver.solve(guess)
        off = np.abs(solved.v - guess) / self.solver.variable_scale
        found = finite & (solved.status == CONVERGED) & (off.max(axis=1, initial=0.0) < _FAR)
        v = np.where(found[:, None], solved.v, self._at)
        signs = self.solver.rates(v, np.ones(len(self.size))).orientation
        return v, found & (signs == self._signs).all(axis=1)

    def acceleration(self, q: Array, speed: Array, t: Array) -> Array:
        """q̈ (B, f) of states (B, f) at times (B,); NaN where there is no position."""
        _, mass, force = self.balance(q, speed, t)
        good = np.isfinite(force).all(axis=1)
        result = np.full_like(q, np.nan)
        result[good] = solutions(mass[good], force[good, :, None])[:, :, 0]
        return result

    def balance(self, q: Array, speed: Array, t: Array) -> tuple[Array, Array, Array]:
        """Positions (B, N), and the masses (B, f, f) and forces (B, f) of the free inputs in states
        (B, f) at times (B,); forces are NaN where there is no position, or no mass.
        """
        v, found = self.positions(q, t)
        free, driven = self.inputs.free, self.inputs.driven
        whole = self.inputs.complete(speed, t, 1)
        rates = self.solver.rates(v, whole * self.size)
        reduction = self.reduction
        moving = reduction.geometry(v, rates.first, rates.second, t)
        with np.errstate(all="ignore"):
            applied = reduction.loaded(moving, self.spring_margins(moving))
            applied.weigh(reduction.description)
            # eq. (96): what the inputs would have to give at constant speeds
            force = -efforts(applied)[0].T + self._motor_torques(whole)
            mass = self._masses(applied)
            force = (force * self.size)[:, free]
            if len(driven):  # eq. (170)
                given = self.inputs.complete(0.0 * q, t, 2)[:, driven]
                force = force - np.einsum("bij,bj->bi", mass[:, free][:, :, driven], given)
            mass = mass[:, free][:, :, free]
        good = found & np.isfinite(mass).all(axis=(1, 2))
        return v, mass, np.where(good[:, None], force, np.nan)

    def spring_margins(self, moving: Geometry) -> Array:
        """The lengths of springs whose tension jumps at zero length, (B, S): negative beyond it in
        the line of :meth:`aim`, 1 where they are in no line with it.
        """
        spans = self._spans(moving)
        if not len(self._lines):
            return np.ones(spans.shape)
        along = spans * self._lines.conj()
        in_line = np.abs(along.imag) <= _IN_LINE * moving.length
        return np.where(in_line, along.real, 1.0)

    def _spans(self, moving: Geometry) -> ComplexArray:
        found = np.zeros((moving.rows, len(self.reduction.springs)), dtype=complex)
        for k, spring in enumerate(self.reduction.springs):
            assert spring.between is not None
            start, end = map(moving.place, spring.between)
            found[:, k] = end.v - start.v
        return found

    def aim(self, moving: Geometry, turn: bool) -> None:
        """Take the lines of the springs from a row; of those that are too short to have one they
        stay, or ``turn`` if the spring is beyond zero length.
        """
        spans = self._spans(moving)[0]
        sizes = np.abs(spans)
        with np.errstate(all="ignore"):
            lines = spans / sizes
        short = sizes < _SHORT * moving.length
        if len(self._lines):
            beyond = ((spans * self._lines.conj()).real <= 0.0) & turn
            lines = np.where(short, np.where(beyond, -self._lines, self._lines), lines)
        self._lines = np.nan_to_num(lines)

    def masses(self) -> Array:
        """The matrix of masses of the free inputs at the last proved position, (f, f)."""
        v, zero = self._at[None], np.zeros((1, len(self._at)))
        applied = AppliedLoads(self.reduction.geometry(v, zero, zero, np.zeros(1)), 1.0)
        applied.weigh(self.reduction.description)
        found: Array = self._masses(applied)[0]
        return found[np.ix_(self.inputs.free, self.inputs.free)]

    def _masses(self, applied: AppliedLoads) -> Array:
        """The matrices of masses, (B, p, p)."""
        geometry, p = applied.geometry, len(self.size)
        total = np.zeros((geometry.rows, p, p)) + np.diag(self.reduction.inertias)
        for body in applied.masses:  # eq. (95)
            moved = geometry.partial_local(body.link, body.centre)
            turned = geometry.turning(body.link)
            total = total + body.mass * np.einsum("jb,kb->bjk", moved.conj(), moved).real
            own = np.asarray(body.inertia) * np.ones(geometry.rows)
            total = total + np.einsum("b,jb,kb->bjk", own, turned, turned)
        scaled: Array = total * np.outer(self.size, self.size)
        return scaled

    def _motor_torques(self, speed: Array) -> Array:
        torques = np.zeros_like(speed)
        for k, motor in enumerate(self.reduction.motors):
            if motor is not None:
                torques[:, k] = motor.torque(speed[:, k] * self.size[k])
        return torques

    def rows(self, q: Array, speed: Array, bend: Array, t: Array, certify: bool) -> SolvedRows:
        """Positions with their rates in time, the time behind the variables; found ones only."""
        v, found = self.positions(q, t)
        count = int(np.argmin(found)) if not found.all() else len(v)
        v, q, speed, bend, t = (x[:count] for x in (v, q, speed, bend, t))
        whole, bent = self.inputs.complete(speed, t, 1), self.inputs.complete(bend, t, 2)
        rates = self.solver.rates(v, whole * self.size, bent * self.size)
        why = Certification.NOT_ASKED
        if certify and not self.solver.is_provable:
            why = Certification.NO_BOUND
        rows = SolvedRows.blank(t[:, None], v.shape[1], Status.CONVERGED, why)
        rows = rows.with_columns(
            v=v,
            residual=self.solver.residual(v),
            condition=rates.condition,
            branch=np.full(count, self.reduction.model.circuit, dtype=object),
        )
        if certify and count and self.solver.is_provable:
            # the motion between rows is followed by small steps, without proof; an open chain has
            # one position only
            closed = self.solver.unknowns > 0
            standing = Certification.MOTION_NOT_PROVED if closed else Certification.CERTIFIED
            rows = with_proofs(self.solver, rows, np.zeros((count, len(self.size))), standing)
        one = np.ones((count, 1))
        return rows.with_columns(
            v=np.column_stack([v, t]),
            first=np.column_stack([rates.first, one]),
            second=np.column_stack([rates.second, 0.0 * one]),
        )
