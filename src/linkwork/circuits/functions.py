"""Functions of a mechanism's kinematic chain."""

from __future__ import annotations

from linkwork.circuits import inverting
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.results.check import Inversion


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
