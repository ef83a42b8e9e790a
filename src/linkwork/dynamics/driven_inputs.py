"""Inputs that laws drive while others are free."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.equations.input_motion import law_motions
from linkwork.foundation.arrays import Array, IndexArray
from linkwork.foundation.errors import InputError
from linkwork.kernels.piecewise import Piecewise
from linkwork.motion.model import Model

__all__ = ["DrivenInputs"]

_ROUNDING = 1e-12  # of the whole time: a law that ends there does not end before


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenInputs:
    """The inputs of a mechanism, of which laws drive some.

    ``laws``: of every input its origin and the displacement over time; ``None`` of a free one.
    ``size`` (p,): the unit in which each is measured [rad] or [length].
    """

    laws: tuple[tuple[float, Piecewise] | None, ...]
    size: Array

    @classmethod
    def of(cls, model: Model, size: Array) -> DrivenInputs:
        """Those of a mechanism with its own inputs."""
        laws: list[tuple[float, Piecewise] | None] = [None] * len(size)
        if model.description.timed:
            laws = law_motions(model.equations, model.description)
        return cls(laws=tuple(laws), size=size)

    @cached_property
    def free(self) -> IndexArray:
        """The numbers of the free inputs, (f,)."""
        return np.array([k for k, law in enumerate(self.laws) if law is None], dtype=np.intp)

    @cached_property
    def driven(self) -> IndexArray:
        """The numbers of the driven inputs."""
        return np.array([k for k, law in enumerate(self.laws) if law is not None], dtype=np.intp)

    @cached_property
    def breaks(self) -> Array:
        """The times at which the acceleration of a law may jump, rising."""
        own = [law[1].breaks for law in self.laws if law is not None]
        return np.unique(np.concatenate(own)) if own else np.zeros(0)

    def next_break(self, t: float) -> float:
        """The first of these times after ``t``."""
        later = self.breaks[self.breaks > t]
        return float(later[0]) if len(later) else np.inf

    def check(self, model: Model, until: float) -> None:
        """Refuse laws that end before, or whose speed jumps.

        Raises
        ------
        InputError
            With the input and the time.
        """
        for variable, law in zip(model.equations.inputs, self.laws, strict=True):
            if law is None:
                continue
            displacement = law[1]
            if displacement.breaks[0] > 0.0:
                raise InputError(
                    f"the law of {variable.name} begins at {displacement.breaks[0]:g} s, after the "
                    "simulation: let its formula begin at 0"
                )
            end = float(displacement.breaks[-1])
            if end < until * (1.0 - _ROUNDING):
                raise InputError(
                    f"the law of {variable.name} ends at {end:g} s, before {until:g} s: add a "
                    'segment, for example { law = "dwell", … }, or simulate to its end'
                )
            jumps = displacement.breaks[1:-1][list(displacement.corners)]
            inside = jumps[(jumps > 0.0) & (jumps < until)]
            if len(inside):
                raise InputError(
                    f"the law of {variable.name} changes its speed at once at {inside[0]:g} s, a "
                    "shock for the free inputs: use a law with a continuous speed"
                )

    def complete(self, free: Array, t: Array, order: int) -> Array:
        """The values (B, p) of all inputs at times (B,) from those of the free ones (B, f), or
        their first or second derivatives.
        """
        if not len(self.driven):
            return free
        found = np.empty((len(t), len(self.laws)))
        found[:, self.free] = free
        for k in self.driven:
            law = self.laws[k]
            assert law is not None
            origin, displacement = law
            own = displacement.jet(t)[order] + (origin if order == 0 else 0.0)
            found[:, k] = own / self.size[k]
        return found
