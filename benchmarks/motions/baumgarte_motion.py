"""Cartesian coordinates of rigid bodies, index 1 with Baumgarte's stabilisation, DOP853."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.motions.bodies import Bodies

__all__ = ["by_baumgarte"]


def by_baumgarte(machine: Bodies, until: float, tolerance: float, gain: float) -> float:
    """Angle by which the first body turns until a time [rad].

    ``gain``: of the stabilisation [1/s].
    """
    solve_ivp = import_module("scipy.integrate").solve_ivp
    bodies, size = machine.bodies, 3 * len(machine.bodies)
    inverse = np.repeat([1.0 / body.mass for body in bodies], 3)
    inverse[2::3] = [1.0 / body.inertia for body in bodies]
    centers = np.array([body.center for body in bodies])
    rows = _Rows(machine, centers)
    weights = np.zeros(size)
    weights[1::3] = [-machine.weight * body.mass for body in bodies]
    weights[2] += machine.torque

    def rate(_: float, state: Any) -> Any:
        q, v = state[:size], state[size:]
        gap, slope, bend = rows.at(q, v)
        force = weights + _springs(machine, centers, q)
        right = -bend - 2.0 * gain * (slope @ v) - gain**2 * gap - slope @ (inverse * force)
        matrix = (slope * inverse) @ slope.T
        # where constraints are redundant: the shortest multipliers
        multipliers = np.linalg.lstsq(matrix, right, rcond=1e-10)[0]
        return np.concatenate([v, inverse * (force + slope.T @ multipliers)])

    start = np.zeros(2 * size)
    start[0:size:3], start[1:size:3] = centers.real, centers.imag
    start[size::3] = [body.velocity.real for body in bodies]
    start[size + 1 :: 3] = [body.velocity.imag for body in bodies]
    start[size + 2 :: 3] = [body.rate for body in bodies]
    found = solve_ivp(rate, (0.0, until), start, method="DOP853", rtol=tolerance, atol=tolerance)
    if not found.success:
        raise RuntimeError(found.message)
    return float(found.y[2, -1])


class _Rows:
    """The conditions of all pins."""

    def __init__(self, machine: Bodies, centers: Any) -> None:
        self.pins = machine.pins
        self.size = 3 * len(machine.bodies)
        self.sides = [
            (row, body, sign, 0.0 if body is None else pin.at - centers[body], pin.at)
            for row, pin in enumerate(machine.pins)
            for body, sign in ((pin.first, -1.0), (pin.second, 1.0))
        ]
        moved = [side for side in self.sides if side[1] is not None]
        self.row = np.array([side[0] for side in moved])
        self.body = np.array([side[1] for side in moved])
        self.sign = np.array([side[2] for side in moved])
        self.arm = np.array([side[3] for side in moved])
        self.fixed = np.zeros(len(machine.pins), dtype=complex)
        for row, body, sign, _, at in self.sides:
            if body is None:
                self.fixed[row] += sign * at

    def at(self, q: Any, v: Any) -> tuple[Any, Any, Any]:
        """Gaps (2P,), their derivatives by q (2P, 3B), and the part of their second derivatives by
        time without accelerations (2P,).
        """
        body, sign, row, count = self.body, self.sign, self.row, len(self.pins)
        arm = self.arm * np.exp(1j * q[2::3])[body]
        place = (q[0::3] + 1j * q[1::3])[body] + arm
        gap, bend = self.fixed.copy(), np.zeros(count, dtype=complex)
        np.add.at(gap, row, sign * place)
        np.add.at(bend, row, -sign * v[2::3][body] ** 2 * arm)
        slope = np.zeros((2 * count, self.size))
        slope[2 * row, 3 * body] = slope[2 * row + 1, 3 * body + 1] = sign
        turned = sign * 1j * arm
        slope[2 * row, 3 * body + 2], slope[2 * row + 1, 3 * body + 2] = turned.real, turned.imag
        return gap.view(float), slope, bend.view(float)


def _springs(machine: Bodies, centers: Any, q: Any) -> Any:
    force = np.zeros(len(q))
    for spring in machine.springs:
        k = spring.body
        arm = (spring.at - centers[k]) * np.exp(1j * q[3 * k + 2])
        span = complex(q[3 * k], q[3 * k + 1]) + arm - spring.fixed
        pull = -spring.stiffness * (abs(span) - spring.free) * span / abs(span)
        force[3 * k : 3 * k + 3] += pull.real, pull.imag, (np.conj(arm) * pull).imag
    return force
