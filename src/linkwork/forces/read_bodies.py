"""Free bodies of a mechanism given by loops, where these read as links and joints."""

from __future__ import annotations

import numpy as np

from linkwork.forces.geometry import Geometry
from linkwork.foundation.arrays import Array
from linkwork.motion.classifying.as_linkage import Seen, as_linkage
from linkwork.motion.named_quantities import RowValues

__all__ = ["read_geometry"]

_APART = 1e-9  # of the longest link: distance of the points of both descriptions


def read_geometry(geometry: Geometry) -> Geometry | None:
    """The rows of a mechanism's loops as those of a linkage.

    ``None`` if the loops do not read as one, or its points move otherwise.
    """
    seen = as_linkage(geometry.driven)
    if not isinstance(seen, Seen) or seen.loose:
        return None
    v = _rows(geometry, seen)
    solver, rate = seen.model.compiled.solver, geometry.input_rates
    bend = np.zeros(len(rate))
    if geometry.model is not geometry.driven:
        rate, bend = rate.T, geometry.input_bends.T
    rates = solver.rates(v, rate, input_bend=bend)
    found = np.asarray(np.isfinite(v).all(axis=1), dtype=bool)
    own = Geometry(seen.model, RowValues(seen.model, v, rates.first, rates.second, found))
    shared = [point for point in geometry.points if point in own.points]
    for point in shared:
        place = geometry.place(point)
        # at dead points, which have no forces, Newton-Raphson is less precise
        apart = np.where(np.isfinite(place.d1), np.abs(place.v - own.place(point).v), 0.0)
        if np.nanmax(apart, initial=0.0) > _APART * geometry.length:
            return None
    return own


def _rows(geometry: Geometry, seen: Seen) -> Array:
    """The variables of the linkage in all rows: angles turn as those of the loops."""
    model, other = geometry.driven, seen.model.equations
    names = [variable.name for variable in model.equations.variables]
    here = geometry.variables
    solver = model.compiled.solver
    start = solver.solve(model.equations.start[None, :]).v[0]
    v = np.tile(other.start, (geometry.rows, 1))
    # directions are sums of the loops' angles; lengths follow by Newton-Raphson
    for k, variable in enumerate(other.unknowns):
        for own in seen.turning.get(variable.name, ()):
            v[:, k] += here[:, names.index(own)] - start[names.index(own)]
    count = len(other.unknowns)
    for k in range(len(other.inputs)):
        own_input = len(model.equations.unknowns) + k
        v[:, count + k] += here[:, own_input] - start[own_input]
    lost = ~np.isfinite(here).all(axis=1)
    solved = seen.model.compiled.solver.solve(v[~lost])
    v[lost] = np.nan
    v[~lost] = np.where((solved.failed_block < 0)[:, None], solved.v, np.nan)
    return v
