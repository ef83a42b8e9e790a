"""Vectorised dyads in plain NumPy, as data sets of linkages are made: all rows at once."""

from __future__ import annotations

import numpy as np

from benchmarks.peers.dyad_linkage import Array, ComplexArray, DyadLinkage, stacked
from benchmarks.peers.peer import DyadPeer, Prepared
from benchmarks.peers.work import Work

__all__ = ["NumpyDyads"]

Points = dict[str, tuple[Array, Array]]


class NumpyDyads(DyadPeer):
    """Circles intersected by their radical line, x and y apart; the side is given, not followed."""

    name = "NumPy dyads"
    distribution = "numpy"
    module = "numpy"

    def prepare(self, work: Work) -> Prepared:
        family = stacked(work.dyads)
        ground = {name: np.asarray(point, complex) for name, point in family.ground.items()}
        fixed: Points = {name: (point.real, point.imag) for name, point in ground.items()}

        def run() -> tuple[Array, Array]:
            return _placed(family, fixed, work.inputs)[family.traced]

        def read(point: tuple[Array, Array]) -> ComplexArray:
            positions: ComplexArray = point[0] + 1j * point[1]
            return positions

        return Prepared(run=run, read=read)


def _placed(family: DyadLinkage, fixed: Points, inputs: Array) -> Points:
    at = dict(fixed)
    x, y = at[family.pivot]
    at[family.pin] = (x + family.radius * np.cos(inputs), y + family.radius * np.sin(inputs))
    for dyad in family.dyads:
        (x1, y1), (x2, y2) = at[dyad.first], at[dyad.second]
        dx, dy = x2 - x1, y2 - y1
        square = dx * dx + dy * dy
        reach = dyad.first_length**2
        along = 0.5 + 0.5 * (reach - dyad.second_length**2) / square
        aside = np.sqrt(reach / square - along * along)
        if not dyad.left:
            aside = -aside
        at[dyad.point] = (x1 + along * dx - aside * dy, y1 + along * dy + aside * dx)
    return at
