"""The position nearest to closure of a mechanism whose loops do not close."""

from __future__ import annotations

import cmath
from collections.abc import Mapping

import numpy as np

from linkwork.foundation.names import GROUND
from linkwork.mechanism.linkage import Linkage
from linkwork.motion.model import Model
from linkwork.motion.named_quantities import Named, name_series
from linkwork.motion.positions import target_values
from linkwork.numerics.least_squares import nearest_miss
from linkwork.results.nearest_assembly import LinkEnd, NearestAssembly

__all__ = ["nearest_assembly", "open_ends"]

_MEETS = 1e-9  # of the longest link: ends this near to their joint meet it


def nearest_assembly(
    model: Model, at: float | Mapping[str, float] | None = None
) -> NearestAssembly:
    """The position near the guess at which the loops stay open by least.

    Every block of equations in turn is brought as near to zero as a damped iteration gets it,
    min ‖F(q, u)‖², with the blocks before it as they came out.

    Parameters
    ----------
    at : number or Mapping[str, number], optional
        Input value(s) in file units; the guess's own if left out.

    Raises
    ------
    UnknownNameError, InputError
        For input values that do not fit the mechanism.

    Notes
    -----
    A local minimum; where the mechanism can be closed, usually a position of it with gap 0.
    """
    solver, equations = model.compiled.solver, model.equations
    target = target_values(model, at)
    v = equations.start.copy()
    v[solver.unknowns :] = target * model.input_scale
    with np.errstate(all="ignore"):
        for block in solver.blocks:
            nearest, _ = nearest_miss(block.system, v[block.variables])
            # later blocks start from this position, though it may not close
            v[block.unknowns] = nearest[: len(block.unknowns)]
        f = model.compiled.table.residual(v[None, :])[0]
    none = np.zeros((1, len(v)))
    named = name_series(model, v[None, :], none, none, target[None, :], np.ones(1, dtype=bool))
    count = len(equations.loops)
    vectors = f[:count] + 1j * f[count : 2 * count]
    points = {p: (float(x.value[0]), float(y.value[0])) for p, (x, y) in named.points.items()}
    return NearestAssembly(
        mechanism=model.description.name,
        units=model.units,
        skeleton=model.skeleton,
        input={name: float(values[0]) for name, values in named.inputs.items()},
        unknowns={name: float(series.value[0]) for name, series in named.unknowns.items()},
        points=points,
        gaps={
            loop.label: (float(gap.real), float(gap.imag))
            for loop, gap in zip(equations.loops, vectors, strict=True)
        },
        gap=float(np.linalg.norm(vectors)),
        apart=open_ends(model, named, points),
    )


def open_ends(
    model: Model, named: Named, points: Mapping[str, tuple[float, float]], row: int = 0
) -> tuple[LinkEnd, ...]:
    """The ends of rigid links that lie elsewhere than the joints they belong to, in a row."""
    linkage = model.description
    if not isinstance(linkage, Linkage):
        return ()
    found = []
    for link, local in linkage.shapes.local.items():
        if link == GROUND or link not in named.links or len(local) < 2:
            continue
        angle = float(named.links[link].value[row]) * linkage.angle.radians
        first = next(iter(linkage.links[link]))
        for point, place in local.items():
            end = complex(*points[first]) + (place - local[first]) * cmath.exp(1j * angle)
            if abs(end - complex(*points[point])) > _MEETS * model.equations.length_scale:
                here = (float(end.real), float(end.imag))
                found.append(LinkEnd(link=link, point=point, joint=points[point], end=here))
    return tuple(found)
