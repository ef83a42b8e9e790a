"""The interface of the mechanism used by the live page; the caller supplies the mechanism."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Protocol

from linkwork.circuits.results import Circuits, Configurations
from linkwork.core.equations.writing import EquationSheet
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.results.motion import Motion
from linkwork.core.results.nearest_assembly import NearestAssembly
from linkwork.core.results.position import Iterates, Position
from linkwork.core.results.vector_loop import MovingLoop

__all__ = ["Read", "Solvable"]

At = float | Mapping[str, float] | None


class Solvable(Protocol):
    """A mechanism that can be solved, as :class:`linkwork.Mechanism` is."""

    @property
    def description(self) -> Description:
        """The description in the file."""

    def equations(self) -> EquationSheet:
        """The closure equations."""

    def solve(
        self, at: At = None, *, configuration: str | None = None, certify: bool = True
    ) -> Position:
        """One position."""

    def sweep(
        self, *, step: float | None = None, progress: Callable[[float], None] | None = None
    ) -> Motion:
        """The whole cycle with proofs; ``progress`` may raise an error to cancel it."""

    def approximate_sweep(self, neighbour: Motion | None = None) -> Motion:
        """The cycle near that of a neighbouring design, fast and without proofs."""

    def simulate(
        self,
        until: float,
        *,
        step: float | None = None,
        at: At = None,
        start_speed: Number | Mapping[str, Number] = 0,
        change_points: str = "stop",
        progress: Callable[[float], None] | None = None,
    ) -> Motion:
        """The motion in time; ``progress`` may raise an error to cancel it."""

    def configurations(self, at: At = None) -> Configurations:
        """All assembly configurations."""

    def circuits(self, *, progress: Callable[[float], None] | None = None) -> Circuits:
        """All circuits; ``progress`` may raise an error to cancel the search."""

    def to_excel(self, path: str | Path, motion: Motion | None = None) -> tuple[str, ...]:
        """Write a sweep as an Excel workbook; returns the parts with values only."""

    def iterates(
        self,
        guess: Mapping[str, float] | None = None,
        at: At = None,
        *,
        options: NewtonOptions | None = None,
    ) -> Iterates:
        """Newton-Raphson from a guess, step by step."""

    def moving_loops(self, cycle: Motion) -> Sequence[MovingLoop]:
        """The loop equations over a motion."""

    def guessed_points(self) -> tuple[str, ...]:
        """The points at a guess."""

    def pulled_guess(
        self,
        point: str,
        place: tuple[float, float],
        guess: Mapping[str, float] | None = None,
        at: At = None,
    ) -> dict[str, float]:
        """A guess that moves a point towards given coordinates."""

    def nearest_assembly(self, at: At = None) -> NearestAssembly:
        """The position nearest to closure."""


#: Builds a mechanism from a text and its name for messages; raises ``MechanismFileError``.
Read = Callable[[str, str], Solvable]
