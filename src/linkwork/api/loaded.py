"""A mechanism whose masses, loads and springs give forces."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from linkwork.api.solvable import SolvableMechanism
from linkwork.core.foundation.errors import key_text
from linkwork.core.mechanism.dimensions import Number
from linkwork.forces import dynamics, reactions as forces

if TYPE_CHECKING:
    from linkwork.core.results.motion import Motion
    from linkwork.forces.results import Equilibrium, Reactions
    from linkwork.forces.stall import Stall

__all__ = ["LoadedMechanism"]


class LoadedMechanism(SolvableMechanism):
    """The part of :class:`~linkwork.api.mechanism.Mechanism` that computes forces."""

    def _place(self, key: Sequence[str | int]) -> str:
        """Where a key of the description is found: file and line, if it was read."""
        if self._read is None:
            return key_text(key)
        return f"{self._read.name} line {self._read.lines.line(tuple(key))}, {key_text(key)}"

    def forces(
        self,
        at: float | Mapping[str, float] | None = None,
        *,
        configuration: str | None = None,
        motion: Motion | None = None,
    ) -> Reactions:
        """Efforts of the inputs and reactions of the joints, from masses, loads and springs.

        Without ``at`` over the input's table; of a structure in its position. With a speed of
        the input, masses have inertia; without one the mechanism is at rest. See
        :mod:`linkwork.forces.reactions`.

        Parameters
        ----------
        at : number or Mapping[str, number], optional
            Input value(s) in file units.
        configuration : str, optional
            As in :meth:`solve`.
        motion : Motion, optional
            Instead of the table: a motion of this mechanism, solved already.

        Returns
        -------
        Reactions
            ``["crank.effort"]``, ``["A.force.x"]``, …; its ``status`` says whether they exist.

        Raises
        ------
        InputError
            If nothing loads the mechanism.

        Examples
        --------
        >>> import linkwork as lw
        >>> press = lw.example("crank-press")
        >>> round(press.forces(at=60)["crank.effort"])
        3644
        """
        if at is not None or not self.model.equations.inputs:
            return forces.forces_of_position(
                self.model, self.solve(at, configuration=configuration), self._place
            )
        rows = self.sweep(configuration=configuration) if motion is None else motion
        return forces.forces_of_motion(self.model, rows, self._place)

    def stalls(
        self, *, configuration: str | None = None, motion: Motion | None = None
    ) -> tuple[Stall, ...]:
        """Input values between motion and self-locking by friction, over the input's table.

        Parameters
        ----------
        configuration : str, optional
            As in :meth:`solve`.
        motion : Motion, optional
            Instead of the table: a motion of this mechanism, solved already.

        Returns
        -------
        tuple of Stall
            In the order of the rows; empty without self-locking.

        Raises
        ------
        InputError
            If nothing loads the mechanism.

        Examples
        --------
        >>> import linkwork as lw
        >>> lw.example("crank-press").stalls()
        ()
        """
        rows = self.sweep(configuration=configuration) if motion is None else motion
        return forces.locate_stalls(self.model, rows, configuration=configuration)

    def simulate(
        self,
        until: float,
        *,
        step: float | None = None,
        at: float | Mapping[str, float] | None = None,
        start_speed: Number | Mapping[str, Number] = 0,
        change_points: str = "stop",
        certify: bool = True,
        progress: Callable[[float], None] | None = None,
    ) -> Motion:
        """The motion in time under masses, loads, springs, a motor and stops; see
        :mod:`linkwork.forces.dynamics`.

        Inputs with a law follow it, the others are free: they start at ``at`` with
        ``start_speed``. Friction of joints takes the energy ``friction_work`` of the motion, and
        can hold the mechanism at rest; with several inputs it is refused.

        Parameters
        ----------
        until : float
            The last time [s].
        step : float, optional
            Between rows [s]; by default 400 rows. Events add rows: stops, switched loads.
        at : number or Mapping[str, number], optional
            The input value at the start, in file units; by default that of the guess.
        start_speed : str, number or Mapping[str, str or number]
            Of the input: ``"60 rad/s"``; a number is in file units per second. Of several inputs
            by name; those that are not named begin at rest.
        change_points : str
            ``stop`` at a change point, or go ``straight`` on.
        certify : bool
            Prove the positions of all rows.
        progress : callable, optional
            Called with the finished fraction, 0 to 1.

        Returns
        -------
        Motion
            Rows over the time ``t``, with all quantities and rates; ``message`` says how it ended.

        Raises
        ------
        InputError
            If nothing has mass, there is no input, or laws drive all of them; for friction in
            joints whose forces redundant links leave undetermined.

        Examples
        --------
        >>> import linkwork as lw
        >>> pendulum = lw.linkage(
        ...     length="m", points={"O": (0, 0), "A": (-1, 0)},
        ...     links={"ground": ["O"], "bar": ["O", "A"]}, inputs=lw.Input(link="bar"),
        ...     masses={"bar": lw.Mass(mass=1, center=(1, 0))}, gravity=lw.Gravity(),
        ... )
        >>> motion = pendulum.simulate(until=10, step=1)
        >>> round(float(motion["A.x"][-1]), 12)
        -0.275087462576
        """
        return dynamics.simulate(
            self.model,
            until=until,
            step=step,
            at=at,
            start_speed=start_speed,
            change_points=change_points,
            certify=certify,
            place=self._place,
            progress=progress,
        )

    def equilibria(
        self, at: float | Mapping[str, float] | None = None, *, change_points: str = "stop"
    ) -> tuple[Equilibrium, ...]:
        """The positions at which the mechanism can rest, on the circuit of its start.

        Parameters
        ----------
        at, change_points
            As in :meth:`simulate`.

        Returns
        -------
        tuple of Equilibrium
            Each with its stability and natural frequency.

        Raises
        ------
        InputError
            As :meth:`simulate`.

        Examples
        --------
        >>> import linkwork as lw
        >>> [each.stable for each in lw.example("crank-press").equilibria()]
        [False, True]
        """
        return dynamics.equilibria(self.model, at, change_points=change_points)
