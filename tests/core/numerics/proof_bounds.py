"""The constants of a proof in the system's own weights."""

from __future__ import annotations

from linkwork.core.foundation.arrays import Array
from linkwork.core.numerics.kantorovich import Bounds, Majorant, expansion
from linkwork.core.numerics.newton import System

__all__ = ["bounds"]


def bounds(system: System, v: Array, jacobian: Array, matrix: Array, known: Array) -> Bounds:
    """See :func:`expansion` and :class:`Majorant` for the parameters."""
    majorant = Majorant(expansion(system, v, jacobian, matrix), known)
    return majorant.bounds(system.variable_scale[: system.unknowns])
