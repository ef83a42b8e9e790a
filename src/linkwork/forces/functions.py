"""Functions of a loaded mechanism: where it can rest, and where friction locks it."""

from __future__ import annotations

from collections.abc import Mapping

from linkwork import wings
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.results.motion import Motion
from linkwork.forces.results import Equilibrium, Stall


def stalls(
    mechanism: Mechanism, *, configuration: str | None = None, motion: Motion | None = None
) -> tuple[Stall, ...]:
    """Input values between motion and self-locking by friction, over the input's table.

    Parameters
    ----------
    configuration : str, optional
        As in :meth:`~linkwork.Mechanism.solve`.
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
    >>> lw.forces.stalls(lw.example("crank-press"))
    ()
    """
    rows = mechanism.sweep(configuration=configuration) if motion is None else motion
    return wings.use("forces.reactions.solving").locate_stalls(
        mechanism.model, rows, configuration=configuration
    )


def equilibria(
    mechanism: Mechanism,
    at: float | Mapping[str, float] | None = None,
    *,
    change_points: str = "stop",
) -> tuple[Equilibrium, ...]:
    """The positions at which the mechanism can rest, on the circuit of its start.

    Parameters
    ----------
    at, change_points
        As in :meth:`~linkwork.Mechanism.simulate`.

    Returns
    -------
    tuple of Equilibrium
        Each with its stability and natural frequency.

    Raises
    ------
    InputError
        As :meth:`~linkwork.Mechanism.simulate`.

    Examples
    --------
    >>> import linkwork as lw
    >>> [each.stable for each in lw.forces.equilibria(lw.example("crank-press"))]
    [False, True]
    """
    return wings.use("forces.dynamics.equilibria").equilibria(
        mechanism.model, at, change_points=change_points
    )
