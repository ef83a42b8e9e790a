"""The curvature of the path of a point, and its centre of curvature.

κ = (x' y'' - y' x'') / |F'|³, positive where the path bends to the left of its direction for a
growing input; the centre lies at F + n/κ. Where the path is straight to rounding, κ is 0 and the
centre lies at infinity and is NaN. Where the point does not move (a cusp, a dwell) the path has
no direction, and all of them are NaN.

References
----------
O. Bottema, B. Roth, Theoretical Kinematics, North-Holland 1979, chapter 8.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwork.expression.jets import Jet
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.foundation.elementwise import replaced
from linkwork.foundation.rounding import REST
from linkwork.results.quantities.definition import UNKNOWN, MechanismNames, RowQuantity, Solved
from linkwork.results.quantity import Kind

__all__ = ["PATH_CURVATURE"]

_STRAIGHT = 1e-12  # relative: a normal acceleration below this part of the whole is rounding


def _moving(names: MechanismNames) -> dict[str, Kind]:
    points = names.points if names.lead else ()
    return dict.fromkeys((p for p in points if p not in names.skeleton.fixed), Kind.LENGTH)


def _curved(names: MechanismNames) -> Mapping[str, Kind]:
    return dict.fromkeys(_moving(names), Kind.PER_LENGTH)


def _bend(
    names: MechanismNames, solved: Solved, point: str
) -> tuple[ComplexArray, ComplexArray, Array, BoolArray]:
    """Place, first derivative, cross product of both derivatives; where there is a direction."""
    place = solved.place(point)
    cross = (place.d1.conj() * place.d2).imag
    still, bent = np.abs(place.d1), np.abs(place.d2)
    # of a straight path only rounding is left of the cross product
    cross = replaced(np.where(np.abs(cross) <= _STRAIGHT * still * bent, 0.0, cross), cross)
    reach = 1.0 if names.by == "rad" else np.nanmax(np.abs(place.v), initial=0.0)
    return place.v, place.d1, cross, still > REST * reach * bent


def _curvature(names: MechanismNames, solved: Solved, point: str) -> Jet:
    _, rate, cross, moves = _bend(names, solved, point)
    return Jet(np.where(moves, cross / np.abs(rate) ** 3, np.nan), UNKNOWN, UNKNOWN)  # eq. (59)


def _centre(names: MechanismNames, solved: Solved, point: str) -> ComplexArray:
    place, rate, cross, moves = _bend(names, solved, point)
    # eq. (60)
    away = 1j * rate * np.abs(rate) ** 2 / np.where(moves & (cross != 0.0), cross, np.nan)
    found: ComplexArray = place + away
    return found


def _centre_x(names: MechanismNames, solved: Solved, point: str) -> Jet:
    return Jet(_centre(names, solved, point).real, UNKNOWN, UNKNOWN)


def _centre_y(names: MechanismNames, solved: Solved, point: str) -> Jet:
    return Jet(_centre(names, solved, point).imag, UNKNOWN, UNKNOWN)


PATH_CURVATURE = (
    RowQuantity(
        word="curvature",
        about="curvature of the point's path, positive to the left",
        needs=2,
        of=_curved,
        evaluate=_curvature,
        of_path=True,
    ),
    RowQuantity(
        word="centre.x",
        about="centre of curvature of the point's path",
        kind=Kind.LENGTH,
        needs=2,
        of=_moving,
        evaluate=_centre_x,
        of_path=True,
    ),
    RowQuantity(
        word="centre.y",
        about="centre of curvature of the point's path",
        kind=Kind.LENGTH,
        needs=2,
        of=_moving,
        evaluate=_centre_y,
        of_path=True,
    ),
)
