"""The atlas of paths for everyday use: curves in, mechanisms out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Self

import numpy as np

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.errors import InputError, internal
from linkwork.core.foundation.files import as_path
from linkwork.core.foundation.values import as_told, whole_number
from linkwork.families.study.packages import check_packages
from linkwork.synthesis.atlas.path_atlas import (
    Nearest,
    PathAtlas as path_atlas_PathAtlas,
    placed_on_curve,
    read_atlas,
)

_FEWEST = 5  # points of a curve


@internal("near", "curve")
@dataclass(frozen=True, kw_only=True, eq=False)
class NearPath:
    """A mechanism whose path resembles a curve.

    Parameters
    ----------
    number : int
        Its rank, from 1.
    distance : float
        The root of the mean square of the gaps, relative to the size of the curve, which is the
        root of the mean square distance from its centre.
    numbers : Mapping[str, float]
        Its varied numbers in the atlas.
    is_mirrored : bool
        Whether it is the mirror image of the mechanism in the atlas.

    Examples
    --------
    >>> import linkwork as lw
    >>> path = lw.example("hoeken").sweep(step=5).trace("P")
    >>> near = lw.synthesis.PathAtlas.shipped().nearest(path, 3)[0]
    >>> near.distance < 0.1, bool(near.mechanism.sweep().certified.all())
    (True, True)
    """

    number: int
    near: Nearest
    curve: ComplexArray

    @property
    def distance(self) -> float:
        """The distance of both shapes."""
        return self.near.distance

    @property
    def numbers(self) -> dict[str, float]:
        """Its varied numbers in the atlas [file units of the family]."""
        return self.near.numbers

    @property
    def is_mirrored(self) -> bool:
        """Whether it is the mirror image of the mechanism in the atlas."""
        return self.near.is_mirrored

    @property
    def family(self) -> str:
        """The name of the mechanism in the atlas."""
        return self.near.family.title

    @cached_property
    def mechanism(self) -> Mechanism:
        """The mechanism, placed on the curve as well as possible."""
        name = f"Near path {self.number}"
        return Mechanism(placed_on_curve(self.near, self.curve, name)[0])

    def __repr__(self) -> str:
        return f"<NearPath {self.number}: distance {self.distance:.3g}>"


class PathAtlas:
    """Closed paths of many mechanisms, searched by shape.

    Place, size, direction, timing and first point of a path do not count.

    Examples
    --------
    >>> import linkwork as lw
    >>> atlas = lw.synthesis.PathAtlas.shipped()
    >>> square = [(0, 0), (50, 0), (100, 0), (100, 100), (0, 100), (0, 50)]
    >>> len(atlas.nearest(square, 5))
    5
    """

    def __init__(self, atlas: path_atlas_PathAtlas) -> None:
        self._atlas = atlas

    @classmethod
    def shipped(cls) -> Self:
        """The small atlas that is part of Linkwork."""
        return cls(read_atlas())

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """The atlas in a file of :meth:`save`.

        Raises
        ------
        InputError
            If it is no atlas.
        """
        return cls(read_atlas(as_path(path)))

    @classmethod
    def of_stores(
        cls, stores: Sequence[str | Path], progress: Callable[[float], None] | None = None
    ) -> Self:
        """The atlas of studies that keep the path of a point over a whole turn.

        Parameters
        ----------
        stores : sequence of paths
        progress : callable, optional
            Called with the finished fraction; may raise an error to end the work.

        Raises
        ------
        InputError
            If a store is damaged, keeps no path, or has no closed path.
        """
        check_packages()
        # curves are compared without studies, which load Numba: a second
        from linkwork.synthesis.atlas.stored_paths import atlas_of_stores

        return cls(atlas_of_stores([as_path(store) for store in stores], progress))

    @property
    def unfinished(self) -> tuple[str, ...]:
        """Sentences about stores that lacked some of their designs when it was made."""
        return self._atlas.unfinished

    def save(self, path: str | Path) -> None:
        """Write the atlas to a file (.npz)."""
        self._atlas.write(as_path(path))

    def nearest(
        self, curve: Sequence[Sequence[float]] | ComplexArray, count: int = 100
    ) -> tuple[NearPath, ...]:
        """The mechanisms whose paths are nearest to a closed curve, nearest first.

        Parameters
        ----------
        curve : sequence of (x, y), or complex array
            Its corners in their order [length].
        count : int

        Raises
        ------
        InputError
            For fewer than five points, all at one place, or numbers beyond 1e12 or below 1e-12.
        """
        z = _points(curve)
        if len(z) > 1 and z[0] == z[-1]:
            z = z[:-1]
        if len(z) < _FEWEST or not np.isfinite(z).all():
            raise InputError(f"a curve needs {_FEWEST} points or more, all finite: got {len(z)}")
        paths = self._atlas.nearest(z, whole_number("count", count, least=1))
        return tuple(
            NearPath(number=k, near=near, curve=z) for k, near in enumerate(paths, start=1)
        )

    def __len__(self) -> int:
        return len(self._atlas)

    def __repr__(self) -> str:
        return f"<PathAtlas of {len(self)} paths>"


def _points(curve: object) -> ComplexArray:
    """The corners (N,) of a curve."""
    try:
        array = np.asarray(curve)
    except ValueError:  # rows of different lengths
        array = np.empty(0, dtype=object)
    if array.dtype.kind == "c" and array.ndim == 1:
        return np.asarray(array, dtype=complex)
    if array.dtype.kind in "iuf" and array.ndim == 2 and array.shape[1] == 2:
        return np.asarray(array[:, 0] + 1j * array[:, 1])
    raise InputError(f"a curve is a list of points (x, y) or complex numbers, got {as_told(curve)}")
