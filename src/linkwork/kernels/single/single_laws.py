"""The equations of a loop table with laws at one position, in plain numbers.

The formulas are those of :mod:`law_row` and :mod:`piecewise`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.kernels.curvature import Curvature
from linkwork.kernels.law_row import LawRow
from linkwork.kernels.single.single_position import SingleCurvature, SinglePosition

__all__ = ["SingleWithLaws"]

Row = list[float]
_Bounds = Callable[[Array, Array], Curvature]
_WORK = 12  # products of one law


class SingleWithLaws:
    """Loops and linear rows, and the laws after them; see :class:`SinglePosition`.

    ``curvature``: bounds as of arrays.
    """

    #: Compiled code knows no laws.
    packed = None

    def __init__(self, rest: SinglePosition, laws: Sequence[LawRow], curvature: _Bounds) -> None:
        self.rest, self.laws, self._curvature = rest, laws, curvature
        self.unknowns, self.variables = rest.unknowns, rest.variables
        self.loop_rows, self.loop_phases, self.pairs = rest.loop_rows, rest.loop_phases, rest.pairs
        #: Every law turns along one sum of variables, as a phase does.
        self.phases = [*rest.phases, *([(k, w) for k, _, w in law.terms] for law in laws)]
        self.work = rest.work + len(laws) * (_WORK + rest.variables)

    def residual(self, v: Sequence[float]) -> Row:
        """F, (m,)."""
        return self.rest.residual(v) + [law.jet_at(v)[0] for law in self.laws]

    def residual_and_jacobian(self, v: Sequence[float]) -> tuple[Row, list[Row]]:
        """F, (m,), and dF/dv, (m, N), rows of which are not to be changed."""
        value, slopes = self.rest.residual_and_jacobian(v)
        jets = [law.jet_at(v) for law in self.laws]
        own = [self._gradient(law, jet[1]) for law, jet in zip(self.laws, jets, strict=True)]
        return value + [jet[0] for jet in jets], slopes + own

    def _gradient(self, law: LawRow, slope: float) -> Row:
        found = [0.0] * self.variables
        for k, a, w in law.terms:
            found[k] += a - slope * w  # eq. (4)
        return found

    def second_directional_derivative(self, v: Sequence[float], d: Sequence[float]) -> Row:
        """D²F[d, d], (m,)."""
        turned = [sum([w * d[k] for k, _, w in law.terms]) for law in self.laws]
        bends = [-law.jet_at(v)[2] * x * x for law, x in zip(self.laws, turned, strict=True)]
        return self.rest.second_directional_derivative(v, d) + bends

    def curvature(self, v: Sequence[float], matrix: Sequence[Row]) -> SingleCurvature:
        """Bounds of the second derivatives multiplied by a matrix, (n, m) or wider."""
        found = self._curvature(np.array([v]), np.array([matrix]))
        parts = (found.phase, found.slide, found.rounding, found.jacobian_rounding, found.printing)
        return SingleCurvature(*(part[0].tolist() for part in parts))
