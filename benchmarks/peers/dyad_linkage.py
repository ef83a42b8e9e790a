"""A crank and dyads: what closed forms can solve, and how it reads for every peer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

__all__ = ["Array", "ComplexArray", "Dyad", "DyadLinkage", "intersection", "stacked"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True, eq=False)
class Dyad:
    """A point at known distances from two points that are placed before it.

    Parameters
    ----------
    first_length, second_length : float or array (members, 1)
        Distances from ``first`` and ``second``.
    left : bool
        Whether the point lies to the left of the line from ``first`` to ``second``.
    rigid : bool
        The three points are corners of one link; a point that is not rigid joins two links.
    """

    point: str
    first: str
    first_length: float | Array
    second: str
    second_length: float | Array
    left: bool
    rigid: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class DyadLinkage:
    """A crank that turns about ``pivot`` with ``pin`` at its end, and dyads placed one by one.

    Parameters
    ----------
    ground : Mapping[str, complex or array (members, 1)]
        The fixed points, the crank's pivot among them.
    traced : str
        The point whose positions are compared.
    """

    ground: Mapping[str, complex | ComplexArray]
    pivot: str
    pin: str
    radius: float | Array
    dyads: Sequence[Dyad]
    traced: str

    def positions(self, inputs: Array, mirrored: Sequence[str] = ()) -> dict[str, ComplexArray]:
        """All points at these crank angles, by intersecting circles; NaN out of reach.

        Parameters
        ----------
        inputs : array (rows,)
            Crank angles [rad].
        mirrored : sequence of str
            Points placed on the other side: another configuration.
        """
        at: dict[str, ComplexArray] = {
            name: np.asarray(point, complex) for name, point in self.ground.items()
        }
        at[self.pin] = at[self.pivot] + self.radius * np.exp(1j * inputs)
        for dyad in self.dyads:
            left = dyad.left is not (dyad.point in mirrored)
            at[dyad.point] = intersection(
                at[dyad.first], dyad.first_length, at[dyad.second], dyad.second_length, left
            )
        return at


def intersection(
    first: ComplexArray,
    first_length: float | Array,
    second: ComplexArray,
    second_length: float | Array,
    left: bool,
) -> ComplexArray:
    """The point at given distances from two points, on one side of the line that joins them.

    With the distance s between the points, the angle α at the first follows from the law of
    cosines, first² + s² - second² = 2 first s cos α; its sine is taken from Heron's product,
    which keeps its digits where the three points are nearly in line.
    """
    between = second - first
    s = np.abs(between)
    p, q = first_length, second_length
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = (p * p + s * s - q * q) / (2.0 * p * s)
        heron = (p + q + s) * (q + s - p) * (p + s - q) * (p + q - s)
        sine = np.sqrt(heron) / (2.0 * p * s)
        turn = cosine + 1j * (sine if left else -sine)
        return first + p * turn * between / s


def stacked(members: Sequence[DyadLinkage]) -> DyadLinkage:
    """One linkage whose lengths are arrays (members, 1): a family of the same structure."""
    sample = members[0]
    dyads = [
        replace(
            dyad,
            first_length=_column([member.dyads[k].first_length for member in members]),
            second_length=_column([member.dyads[k].second_length for member in members]),
        )
        for k, dyad in enumerate(sample.dyads)
    ]
    ground = {
        name: np.array([member.ground[name] for member in members], complex).reshape(-1, 1)
        for name in sample.ground
    }
    radius = _column([member.radius for member in members])
    return replace(sample, ground=ground, radius=radius, dyads=dyads)


def _column(values: Sequence[float | Array]) -> Array:
    return np.array(values, float).reshape(-1, 1)
