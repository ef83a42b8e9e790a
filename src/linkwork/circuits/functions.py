"""Functions of a mechanism's kinematic chain."""

from __future__ import annotations

from collections.abc import Mapping

from linkwork.circuits import inverting
from linkwork.circuits.failure import remedies
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.results.check import Inversion
from linkwork.core.results.nearest_assembly import NearestAssembly


def inversions(mechanism: Mechanism) -> tuple[Inversion, ...]:
    """All inversions of the chain, each with its type.

    Examples
    --------
    >>> import linkwork as lw
    >>> found = lw.circuits.inversions(lw.example("four-bar"))
    >>> [inversion.type.split(":")[0] for inversion in found][:2]
    ['crank-rocker (GCRR)', 'double-crank (GCCC)']
    """
    return inverting.inversions(mechanism.model)


def nearest_assembly(
    mechanism: Mechanism, at: float | Mapping[str, float] | None = None
) -> NearestAssembly:
    """The position nearest to closure, for a mechanism that does not close.

    Parameters
    ----------
    at : number or Mapping[str, number], optional
        Input value(s) in file units; by default those of the guess.

    Examples
    --------
    >>> import linkwork as lw
    >>> short = lw.example("four-bar").with_dimensions({"A B": 50})
    >>> round(lw.circuits.nearest_assembly(short, at=180).gap, 1)  # mm
    10.0
    """
    return remedies.nearest_assembly(mechanism.model, at)
