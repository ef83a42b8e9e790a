"""Stops on which a mechanism with several inputs rests: they push, and stay closed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwork.dynamics.events import Bound
from linkwork.dynamics.input_dynamics import InputDynamics
from linkwork.expression.jets import Jet
from linkwork.foundation.arrays import Array
from linkwork.foundation.rounding import EPSILON
from linkwork.foundation.stacked_systems import solutions

__all__ = ["Contacts"]

_NOISE = 16.0 * EPSILON  # of what stops give


class Contacts:
    """The stops of a mechanism, of which it touches those with the numbers ``active``."""

    def __init__(self, dynamics: InputDynamics, bounds: Sequence[Bound]) -> None:
        self.dynamics, self.bounds = dynamics, bounds
        self.active: list[int] = []

    def _jets(self, numbers: Sequence[int], v: Array, whole: Array, t: Array) -> list[Jet]:
        """The margins [rad] or [length] at positions (B, N) and speeds of all inputs (B, p), with
        derivatives by time at constant speeds.
        """
        own = self.dynamics
        rates = own.solver.rates(v, whole * own.size)
        solved = own.reduction.geometry(v, rates.first, rates.second, t).solved
        found = []
        for number in numbers:
            bound = self.bounds[number]
            jet = bound.asked.jet(solved)
            scale = bound.asked.names.units.scale(bound.asked.own.kind)
            found.append(
                Jet(
                    bound.side * scale * (jet.v - bound.value), bound.side * jet.d1,
                    bound.side * jet.d2,
                )
            )  # fmt: skip
        return found

    def normals(self, numbers: Sequence[int], v: Array, t: Array) -> Array:
        """The derivatives of margins by all inputs, (B, c, p)."""
        units = np.eye(len(self.dynamics.size))
        parts = [self._jets(numbers, v, np.tile(unit, (len(v), 1)), t) for unit in units]
        return np.stack([np.stack([jet.d1 for jet in part], axis=1) for part in parts], axis=2)

    def solve(self, q: Array, speed: Array, t: Array) -> tuple[Array, Array]:
        """Accelerations of the free inputs (B, f) and the pushes of the active stops, (B, c)."""
        own, active = self.dynamics, self.active
        if not active:
            return own.acceleration(q, speed, t), np.zeros((len(q), 0))
        v, mass, force = own.balance(q, speed, t)
        good = np.isfinite(force).all(axis=1) & np.isfinite(mass).all(axis=(1, 2))
        bend, pushes = np.full_like(force, np.nan), np.full((len(q), len(active)), np.nan)
        # eq. (173)
        normal = self.normals(active, v, t)
        jets = self._jets(active, v, own.inputs.complete(speed, t, 1), t)
        curve = np.stack([jet.d2 for jet in jets], axis=1)
        curve += np.einsum("bcp,bp->bc", normal, own.inputs.complete(0.0 * q, t, 2))
        free = normal[:, :, own.inputs.free]
        columns = np.concatenate([force[:, :, None], np.swapaxes(free, 1, 2)], axis=2)
        moved = solutions(mass[good], columns[good])
        stiff = free[good] @ moved[:, :, 1:]
        gap = -curve[good] - np.einsum("bcf,bf->bc", free[good], moved[:, :, 0])
        pushes[good] = solutions(stiff, gap[:, :, None])[:, :, 0]
        pushed = np.einsum("bfc,bc->bf", moved[:, :, 1:], pushes[good])
        rest = moved[:, :, 0] + pushed
        # where stops take all forces, what is left is their rounding
        bend[good] = np.where(np.abs(rest) <= _NOISE * np.abs(pushed), 0.0, rest)
        return bend, pushes

    def acceleration(self, q: Array, speed: Array, t: Array) -> Array:
        """q̈ (B, f) of states (B, f) at times (B,); NaN where there is no position."""
        return self.solve(q, speed, t)[0]

    def pull(self, number: int, q: Array, speed: Array, t: float) -> float:
        """The second derivative of a margin by time."""
        own, now = self.dynamics, np.array([t])
        bend = self.acceleration(q[None], speed[None], now)
        v = own.variables[None]
        whole = own.inputs.complete(speed[None], now, 1)
        (jet,) = self._jets([number], v, whole, now)
        return float(
            jet.d2[0] + self.normals([number], v, now)[0, 0] @ own.inputs.complete(bend, now, 2)[0]
        )

    def strike(
        self, number: int, speed: Array, t: float, restitution: float
    ) -> tuple[Array, Array]:
        """The speeds of the free inputs after a shock at a stop, and the impulses at it and at the
        active stops, which stay closed as long as they push.
        """
        own, now = self.dynamics, np.array([t])
        closed = [number, *(each for each in self.active if each != number)]
        while True:
            normal = self.normals(closed, own.variables[None], now)[0]
            closing = normal @ own.inputs.complete(speed[None], now, 1)[0]
            goal = np.zeros(len(closed))
            goal[0] = -restitution * closing[0]  # eq. (172)
            free = normal[:, own.inputs.free]
            moved = np.linalg.solve(own.masses(), free.T)
            impulses = np.linalg.solve(free @ moved, goal - closing)
            if impulses[1:].min(initial=0.0) >= 0.0:
                break
            closed.pop(1 + int(np.argmin(impulses[1:])))
        self.active = [each for each in self.active if each in closed]
        found = np.zeros(len(self.bounds))
        found[closed] = impulses
        return speed + moved @ impulses, found

    def close(self, q: Array, speed: Array, t: float) -> tuple[Array, Array]:
        """The nearest state at which the active stops are exactly closed and at rest."""
        if not self.active:
            return q, speed
        own, now = self.dynamics, np.array([t])
        v = own.variables[None]
        normal = self.normals(self.active, v, now)[0]
        inverse = np.linalg.pinv(normal[:, own.inputs.free])
        whole = own.inputs.complete(speed[None], now, 1)[0]
        jets = self._jets(self.active, v, whole[None], now)
        return q - inverse @ [float(jet.v[0]) for jet in jets], speed - inverse @ (normal @ whole)

    def release(self, q: Array, speed: Array, t: float) -> list[int]:
        """Let go of stops that would have to pull, the strongest first; returns their numbers."""
        gone = []
        while self.active:
            pushes = self.solve(q[None], speed[None], np.array([t]))[1][0]
            if not pushes.min() < 0.0:
                break
            gone.append(self.active.pop(int(np.argmin(pushes))))
        return gone
