"""The accelerations of several inputs: M(q) q̈ + c(q, q̇) = Q(q, q̇, t).

Laws may drive some of them; the others are free, and have the equations that are left.
Positions are solved from the last proved one, along its tangents. Inputs are measured in radians
and longest links, so that units change nothing.
"""

from __future__ import annotations

import numpy as np

from linkwork.dynamics.driven_inputs import DrivenInputs
from linkwork.dynamics.reduction import Reduction
from linkwork.forces.applied import AppliedLoads
from linkwork.forces.geometry import Geometry
from linkwork.forces.virtual_work import efforts
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.stacked_systems import solutions
from linkwork.foundation.status import CONVERGED
from linkwork.numerics.proof.position_proof import prove
from linkwork.numerics.rows import SolvedRows

__all__ = ["InputDynamics"]

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
        if self._has_bound and not prove(self.solver, v, np.zeros((1, len(self.size)))).holds[0]:
            return False
        self._at, self._slopes, self._signs = self._anchor(v[0])
        return True

    @property
    def _has_bound(self) -> bool:
        return all(block.system.has_curvature_bound for block in self.solver.blocks)

    def positions(self, q: Array, t: Array) -> tuple[Array, BoolArray]:
        """Positions (B, N) at free inputs (B, f) and times (B,), and which of them were found on
        the same branch.
        """
        return self.positions_of(self.inputs.complete(q, t, 0))

    def positions_of(self, inputs: Array) -> tuple[Array, BoolArray]:
        """The same at all inputs (B, p)."""
        own = inputs * self.size
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
        rates = self.solver.rates(v, whole * self.size, None, bent * self.size)
        code = np.full(count, Certification.NOT_ASKED.code, dtype=np.int8)
        radius = unique = np.full(count, np.nan)
        if certify and not self._has_bound:
            code[:] = Certification.NO_BOUND.code
        elif certify and count:
            proof = prove(self.solver, v, np.zeros((count, len(self.size))))
            # the motion between rows is followed by small steps, without proof; an open chain has
            # one position only
            closed = self.solver.unknowns > 0
            proof_of = Certification.MOTION_NOT_PROVED if closed else Certification.CERTIFIED
            proved = proof_of.code
            code = np.where(proof.holds, proved, Certification.POSITION_NOT_PROVED.code)
            radius = np.where(proof.holds, proof.radius, np.nan)
            unique = np.where(proof.holds, proof.least_uniqueness_radius, np.nan)
        one = np.ones((count, 1))
        return SolvedRows(
            inputs=t[:, None].copy(),
            v=np.column_stack([v, t]),
            first=np.column_stack([rates.first, one]),
            second=np.column_stack([rates.second, 0.0 * one]),
            status=np.full(count, CONVERGED, dtype=np.int8),
            iterations=np.zeros(count, dtype=np.int64),
            residual=self.solver.residual(v),
            condition=rates.condition.copy(),
            certification=code.astype(np.int8),
            radius=radius,
            uniqueness_radius=unique,
            branch=np.full(count, self.reduction.model.circuit, dtype=object),
        )
