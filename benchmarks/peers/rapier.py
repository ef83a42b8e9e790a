"""The rapier drive of a loom: a six-link mechanism that no chain of dyads can solve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from benchmarks.peers.dyad_linkage import Array, ComplexArray
from benchmarks.peers.loop_system import LoopSystem, newton

__all__ = ["RapierDrive"]


@dataclass(frozen=True, kw_only=True)
class RapierDrive:
    """Crank A0 A drives the lever C B D by the rod A B; C turns about C0, D runs on a line.

    Parameters
    ----------
    crank, rod, rocker : float
        A0 A, A B and C0 C.
    to_rod, to_slide : float
        From C to B, and from C to D on the opposite side; C lies between B and D.
    pivot : complex
        C0; A0 is the origin.
    slide : float
        The height of the line of D.
    """

    crank: float = 250.0
    rod: float = 1225.0
    rocker: float = 600.0
    to_rod: float = 350.0
    to_slide: float = 250.0
    pivot: complex = -623.0 - 340.0j
    slide: float = -520.0

    def loops(self, first_input: float) -> LoopSystem:
        """A0 A B C C0 and C0 C D closed, for the angles of rod, lever, rocker, and the slide.

        The start is the configuration whose rod, lever, rocker and D are at 200, 80, 180 degrees
        and -1,317 when the crank is at 60 degrees, followed from there to the first input.
        """
        system = self._loops(np.array([*np.radians([190.0, 72.0, 174.0]), -1317.0]))
        way = np.linspace(np.radians(60.0), first_input, 361)
        return self._loops(newton(system, way)[-1])

    def _loops(self, start: Array) -> LoopSystem:
        return LoopSystem(
            turning=np.array(
                [[self.rod, -self.to_rod, -self.rocker], [0.0, -self.to_slide, self.rocker]],
                complex,
            ),
            sliding=np.array([[0.0], [-1.0]], complex),
            crank=np.array([self.crank, 0.0], complex),
            fixed=np.array([-self.pivot, self.pivot - 1j * self.slide]),
            traced=np.array([0.0, -self.to_slide, self.rocker, 0.0, self.pivot], complex),
            start=start,
        )

    def configurations(self, inputs: Array, samples: int = 1440) -> ComplexArray:
        """D in every way to put it together, shape (configurations, rows), padded with NaN.

        The lever's angle gives the height of C, on either side of C0; the rod's length is then
        one equation for that angle: its changes of sign on a grid are bisected.
        """
        grid = np.linspace(0.0, 2.0 * np.pi, samples + 1)
        found = [self._roots(inputs, grid, side) for side in (1.0, -1.0)]
        rows = np.concatenate([rows for rows, _ in found])
        places = np.concatenate([places for _, places in found])
        order = np.argsort(rows, kind="stable")
        rows, places = rows[order], places[order]
        rank = np.arange(len(rows)) - np.searchsorted(rows, rows)
        table = np.full((1 + rank.max(), len(inputs)), np.nan, complex)
        table[rank, rows] = places
        return table

    def _roots(
        self, inputs: Array, grid: Array, side: float
    ) -> tuple[npt.NDArray[np.intp], ComplexArray]:
        """Row and D of every root, C on one side of C0."""
        pins = self.crank * np.exp(1j * inputs)
        low_side = self._gap(pins[:, None], grid, side) < 0.0
        rows, cells = np.nonzero(low_side[:, :-1] != low_side[:, 1:])
        low, high, below = grid[cells], grid[cells + 1], low_side[rows, cells]
        for _ in range(50):
            middle = 0.5 * (low + high)
            same = (self._gap(pins[rows], middle, side) < 0.0) == below
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        return rows, self._lever(low, side)[1]

    def _gap(self, pins: ComplexArray, lever: Array, side: float) -> Array:
        gap: Array = np.abs(self._lever(lever, side)[0] - pins) - self.rod
        return gap

    def _lever(self, lever: Array, side: float) -> tuple[ComplexArray, ComplexArray]:
        """B and D for angles of the lever; ``side`` tells whether C is right or left of C0."""
        arm = np.exp(1j * lever)  # from C to B
        rise = self.slide + self.to_slide * arm.imag - self.pivot.imag
        c = self.pivot + side * np.sqrt(self.rocker**2 - rise * rise) + 1j * rise
        return c + self.to_rod * arm, c - self.to_slide * arm
