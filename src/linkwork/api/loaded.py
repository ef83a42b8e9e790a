"""A mechanism whose masses, loads and springs give forces."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from linkwork import forces
from linkwork.api.solvable import SolvableMechanism

if TYPE_CHECKING:
    from linkwork.results.motion import Motion
    from linkwork.results.reactions import Reactions
    from linkwork.results.stall import Stall

__all__ = ["LoadedMechanism"]


class LoadedMechanism(SolvableMechanism):
    """The part of :class:`~linkwork.api.mechanism.Mechanism` that computes forces."""

    def forces(
        self,
        at: float | Mapping[str, float] | None = None,
        *,
        configuration: str | None = None,
        motion: Motion | None = None,
    ) -> Reactions:
        """Efforts of the inputs and reactions of the joints, from masses, loads and springs.

        Without ``at`` over the input's table. With a speed of the input, masses have inertia;
        without one the mechanism is at rest. See :mod:`linkwork.forces`.

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
        if at is not None:
            return forces.forces_of_position(
                self.model, self.solve(at, configuration=configuration)
            )
        rows = self.sweep(configuration=configuration) if motion is None else motion
        return forces.forces_of_motion(self.model, rows)

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
