"""Plain real equations as rows of a loop table, differentiated by jets."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from linkwork.expression.enclosures import ENCLOSURES, Enclosure, Interval
from linkwork.expression.jets import Jet, evaluate, evaluate_by
from linkwork.expression.tree import Node
from linkwork.foundation.angles import AngleUnit
from linkwork.foundation.arrays import Array

__all__ = ["FormulaRow"]


@dataclass(frozen=True, kw_only=True)
class FormulaRow:
    """left - right = 0 over a few variables given by name and index."""

    left: Node
    right: Node
    names: tuple[str, ...]
    variables: tuple[int, ...]
    constants: tuple[tuple[str, float], ...]
    unit: AngleUnit

    def moved(self, new_index: dict[int, int]) -> FormulaRow:
        """The same row over renumbered variables."""
        return replace(self, variables=tuple(new_index[k] for k in self.variables))

    def _jet(self, v: Array, d: Array) -> Jet:
        zero = np.zeros(len(v))
        names = {
            name: Jet(v[:, k], d[:, k], zero)
            for name, k in zip(self.names, self.variables, strict=True)
        }
        names |= {name: Jet.constant(value) for name, value in self.constants}
        with np.errstate(all="ignore"):
            jet = evaluate(self.left, names, self.unit) - evaluate(self.right, names, self.unit)
        return Jet(*(np.broadcast_to(part, len(v)) for part in (jet.v, jet.d1, jet.d2)))

    def value_and_gradient(self, v: Array) -> tuple[Array, Array]:
        """Value (B,) and derivatives with respect to ``variables`` (B, k)."""
        gradient = np.zeros((len(v), len(self.variables)))
        value = np.zeros(len(v))
        for column, k in enumerate(self.variables):
            direction = np.zeros_like(v)
            # one jet along each variable gives its column of the gradient
            direction[:, k] = 1.0
            jet = self._jet(v, direction)
            value, gradient[:, column] = jet.v, jet.d1
        return value, gradient

    def second_directional_derivative(self, v: Array, d: Array) -> Array:
        """Second derivative along d, (B,)."""
        return self._jet(v, d).d2

    def repeats_after(self, turns: Array) -> bool:
        """Whether the formula is unaffected by whole turns (k,), as far as known."""
        return not turns.any()

    def enclosure(self, v: Array, box: Array) -> tuple[Array, Array]:
        """Lowest and highest value (2, L), and derivatives (2, L, k), over boxes around v (L, N)
        with half widths ``box`` (L, N).
        """
        names: dict[str, Enclosure] = {}
        for place, (name, k) in enumerate(zip(self.names, self.variables, strict=True)):
            way = np.eye(len(self.variables))[:, place, None]
            own = Interval(v[:, k], v[:, k]) + Interval(-box[:, k], box[:, k])
            # without a width a variable has its value exactly
            exact = box[:, k] == 0.0
            own = Interval(np.where(exact, v[:, k], own.low), np.where(exact, v[:, k], own.high))
            names[name] = Enclosure(own, Interval(way, way))
        for name, number in self.constants:
            # dimensions may be results of formulas
            whole = float(number).is_integer()
            names[name] = (ENCLOSURES.literal if whole else ENCLOSURES.rounded)(number)
        with np.errstate(all="ignore"):
            left, right = (
                evaluate_by(ENCLOSURES, side, names, self.unit) for side in (self.left, self.right)
            )
            found = left - right
        shape = len(self.variables), len(v)
        value = [np.broadcast_to(end, len(v)) for end in (found.v.low, found.v.high)]
        slopes = [np.broadcast_to(end, shape).T for end in (found.d.low, found.d.high)]
        return np.stack(value), np.stack(slopes)
