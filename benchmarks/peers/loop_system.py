"""Loop-closure equations as plain arrays: what general solvers are given."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from benchmarks.peers.dyad_linkage import Array, ComplexArray, DyadLinkage

__all__ = ["LoopSystem", "PhasorSum", "loops_of", "newton"]

#: Coefficients of phasors by the number of their angle; ``CRANK`` turns with the input.
PhasorSum = Mapping[int, complex]
CRANK, FIXED = -1, -2


@dataclass(frozen=True, kw_only=True, eq=False)
class LoopSystem:
    """m loops, Σ_k turning_jk e^{iθ_k} + Σ_l sliding_jl s_l + crank_j e^{iu} + fixed_j = 0.

    Parameters
    ----------
    turning : array (m, angles), complex
    sliding : array (m, slides), complex
        Together as many unknowns as real equations, angles before slides.
    crank, fixed : array (m,), complex
    traced : array (angles + 2,), complex
        The point that is compared: coefficients of the phasors, the crank's, and a constant.
    start : array (unknowns,)
        An estimate at the first input; angles in radians.
    """

    turning: ComplexArray
    sliding: ComplexArray
    crank: ComplexArray
    fixed: ComplexArray
    traced: ComplexArray
    start: Array

    @property
    def angles(self) -> int:
        """How many unknowns are angles; they come first."""
        return int(self.turning.shape[1])

    @property
    def unknowns(self) -> int:
        """How many unknowns there are, and real equations."""
        return len(self.start)

    @property
    def scale(self) -> float:
        """The largest length of the equations."""
        return float(max(np.abs(self.turning).max(), np.abs(self.crank).max()))

    def driven(self, u: float) -> ComplexArray:
        """The part of the loops that an input fixes, shape (m,)."""
        driven: ComplexArray = self.crank * np.exp(1j * u) + self.fixed
        return driven

    def residual(self, q: Array, driven: ComplexArray) -> Array:
        """Real and imaginary parts of all loops, shape (2m,)."""
        n = self.angles
        gap = self.turning @ np.exp(1j * q[:n]) + self.sliding @ q[n:] + driven
        parts: Array = gap.view(np.float64)
        return parts

    def jacobian(self, q: Array) -> Array:
        """Derivatives of the residual, shape (2m, unknowns)."""
        columns = np.empty((len(self.crank), 2, self.unknowns))
        spin = self.turning * (1j * np.exp(1j * q[: self.angles]))
        columns[:, 0] = np.hstack((spin.real, self.sliding.real))
        columns[:, 1] = np.hstack((spin.imag, self.sliding.imag))
        return columns.reshape(-1, self.unknowns)

    def trace(self, q: Array, inputs: Array) -> ComplexArray:
        """The compared point, shape (rows,), of solutions q (rows, unknowns)."""
        phasors = np.exp(1j * q[..., : self.angles]) @ self.traced[: self.angles]
        place: ComplexArray = phasors + self.traced[-2] * np.exp(1j * inputs) + self.traced[-1]
        return place


def newton(system: LoopSystem, inputs: Array, largest_step: float = 0.01) -> Array:
    """Solutions at all inputs, followed in small steps to 1e-13 of the largest length.

    Parameters
    ----------
    inputs : array (rows,)
        Input angles [rad].
    largest_step : float
        Between rows further apart than this, positions in between are solved too.

    Returns
    -------
    array (rows, unknowns)

    Raises
    ------
    RuntimeError
        If a step does not converge.
    """
    q, before = system.start.copy(), inputs[0]
    rows = np.empty((len(inputs), system.unknowns))
    for row, u in enumerate(inputs):
        steps = max(1, int(np.ceil(abs(u - before) / largest_step)))
        for between in np.linspace(before, u, steps + 1)[1:]:
            q = _newton(system, q, between)
        rows[row], before = q, u
    return rows


def _newton(system: LoopSystem, q: Array, u: float) -> Array:
    driven = system.driven(u)
    for _ in range(20):
        residual = system.residual(q, driven)
        q = q - np.linalg.solve(system.jacobian(q), residual)
        if np.abs(residual).max() <= 1e-13 * system.scale:
            return q
    raise RuntimeError(f"the reference did not converge at the input {u} rad")


def loops_of(linkage: DyadLinkage, first_input: float) -> LoopSystem:
    """The loop equations of a crank and dyads, with the start its closed form gives.

    A dyad that joins two links closes one loop with two unknown angles; a corner of a link hangs
    on the phasor of that link.
    """
    at = linkage.positions(np.array([first_input]))
    places: dict[str, PhasorSum] = {
        name: {FIXED: complex(point)} for name, point in linkage.ground.items()
    }
    places[linkage.pin] = _sum(places[linkage.pivot], {CRANK: complex(linkage.radius)})
    loops: list[PhasorSum] = []
    start: list[float] = []
    for dyad in linkage.dyads:
        first, second, point = (
            complex(at[name].reshape(-1)[0]) for name in (dyad.first, dyad.second, dyad.point)
        )
        if dyad.rigid:
            corner = (point - first) / (second - first)
            base = _sum(places[dyad.second], places[dyad.first], -1.0)
            places[dyad.point] = _sum(places[dyad.first], base, corner)
            continue
        one, other = len(start), len(start) + 1
        start += [float(np.angle(point - first)), float(np.angle(point - second))]
        there = _sum(places[dyad.first], {one: complex(abs(point - first))})
        places[dyad.point] = _sum(places[dyad.second], {other: complex(abs(point - second))})
        loops.append(_sum(there, places[dyad.point], -1.0))
    return _arrays(loops, places[linkage.traced], start)


def _sum(first: PhasorSum, second: PhasorSum, factor: complex = 1.0) -> PhasorSum:
    total = dict(first)
    for key, coefficient in second.items():
        total[key] = total.get(key, 0.0) + factor * coefficient
    return {key: coefficient for key, coefficient in total.items() if coefficient != 0.0}


def _arrays(loops: list[PhasorSum], traced: PhasorSum, start: list[float]) -> LoopSystem:
    def row(terms: PhasorSum) -> list[complex]:
        return [terms.get(k, 0.0) for k in (*range(len(start)), CRANK, FIXED)]

    table = np.array([row(loop) for loop in loops], complex)
    return LoopSystem(
        turning=table[:, :-2].copy(),
        sliding=np.zeros((len(loops), 0), complex),
        crank=table[:, -2].copy(),
        fixed=table[:, -1].copy(),
        traced=np.array(row(traced), complex),
        start=np.array(start),
    )
