"""The position nearest to closure, with the gap and the ends of links that do not meet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from linkwork.core.foundation.containers import FrozenDict
from linkwork.core.foundation.errors import internal
from linkwork.core.mechanism.skeleton import Skeleton
from linkwork.core.results.quantity import Units


@dataclass(frozen=True, kw_only=True)
class LinkEnd:
    """An end of a link that does not reach its joint.

    Parameters
    ----------
    link, point : str
        The link, and the joint.
    joint, end : (x, y)
        The positions of the joint and of the link's end [length].
    """

    link: str
    point: str
    joint: tuple[float, float]
    end: tuple[float, float]


@internal("skeleton", "units", "apart")
@dataclass(frozen=True, kw_only=True)
class NearestAssembly:
    """The least-squares position: the smallest closure error found near the guess.

    Parameters
    ----------
    input, unknowns : Mapping[str, float]
        File units.
    points : Mapping[str, (x, y)]
        Coordinates of every point, each reached from ground by one way around its loop.
    gaps : Mapping[str, (x, y)]
        The closure error of every loop as a vector [length]; zero where it closes.
    gap : float
        Root of the sum of their squares [length].
    apart : tuple of LinkEnd
        Ends of links that do not reach their joint (points-and-links mechanisms).

    Examples
    --------
    >>> import linkwork as lw
    >>> short = lw.example("four-bar").with_dimensions({"A B": 20})
    >>> round(lw.circuits.nearest_assembly(short, at=180).gap, 1)  # mm
    40.0
    """

    mechanism: str
    units: Units
    skeleton: Skeleton
    input: Mapping[str, float]
    unknowns: Mapping[str, float]
    points: Mapping[str, tuple[float, float]]
    gaps: Mapping[str, tuple[float, float]] = FrozenDict()
    gap: float
    apart: tuple[LinkEnd, ...] = ()
