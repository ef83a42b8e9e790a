"""Where friction stops a mechanism."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.core.results.position import Position


@dataclass(frozen=True, kw_only=True)
class Stall:
    """An input value between motion and self-locking.

    Parameters
    ----------
    input : str
        The name of the input.
    value : float
        The last value found at which an effort moves the mechanism [file units].
    unit : str
    bracket : (float, float)
        A value at which it moves and one at which it locks, both as near as can be found.
    proved : bool
        Whether the equilibrium at one, and that there is none at the other, are proved.
    position : Position
        The mechanism at ``value``: ``stall.position["crank"]``.

    Examples
    --------
    >>> import linkwork as lw
    >>> [stall.proved for stall in lw.forces.stalls(lw.example("crank-press"))]
    []
    """

    input: str
    value: float
    unit: str
    bracket: tuple[float, float]
    proved: bool
    position: Position
