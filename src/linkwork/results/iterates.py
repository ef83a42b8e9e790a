"""Newton-Raphson step by step: every iterate with its equations, Jacobian and picture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from linkwork.foundation.internal import internal
from linkwork.results.nearest_assembly import LinkEnd
from linkwork.results.position import Position

__all__ = ["Iterate", "Iterates"]


@internal("apart")
@dataclass(frozen=True, kw_only=True)
class Iterate:
    """One iterate of Newton-Raphson on one block of equations.

    Parameters
    ----------
    equations : tuple of str
        Labels of the block's equations.
    k : int
        Number of the iterate; 0 is the guess.
    unknowns : Mapping[str, float]
        The block's unknowns, in file units.
    residuals : tuple of float, shape (n,)
        F: the real parts of the loops, their imaginary parts, then the other equations, each in
        its own unit.
    norm : float
        The 2-norm of ``residuals``.
    jacobian : tuple of tuple of float, shape (n, n)
        dF/dx with respect to the block's unknowns; angles in radians.
    step : float, optional
        Largest weighted change to the next iterate (radians, or relative to the longest link);
        ``None`` at the last one.
    points : Mapping[str, (x, y)]
        Positions at this iterate: earlier blocks are solved, later blocks are at their guess.
    apart : tuple of LinkEnd
        Ends of links that do not meet their joint there.

    Examples
    --------
    >>> import linkwork as lw
    >>> run = lw.example("four-bar").iterates(at=60)
    >>> [f"{iterate.norm:.0e}" for iterate in run.iterates[:4]]
    ['2e+01', '1e+00', '8e-03', '4e-07']
    """

    equations: tuple[str, ...]
    k: int
    unknowns: Mapping[str, float]
    residuals: tuple[float, ...]
    norm: float
    jacobian: tuple[tuple[float, ...], ...]
    step: float | None
    points: Mapping[str, tuple[float, float]]
    apart: tuple[LinkEnd, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Iterates:
    """The iterates from a guess, block after block, and where they ended: ``position``.

    Examples
    --------
    >>> import linkwork as lw
    >>> run = lw.example("four-bar").iterates(at=60)
    >>> len(run.iterates), run.position.status.name
    (5, 'CONVERGED')
    """

    position: Position
    iterates: tuple[Iterate, ...]
