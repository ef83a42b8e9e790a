"""Families of mechanisms with the shapes of their paths, and the nearest ones to a curve."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from linkwork.design.atlas.path_shape import WAYS, coefficients, distances, in_ways
from linkwork.design.tasks.curve_file import out_of_bounds
from linkwork.foundation.arrays import AnyArray, Array, ComplexArray, IndexArray
from linkwork.foundation.errors import InputError
from linkwork.foundation.written_file import save_bytes

__all__ = ["SHIPPED", "AtlasFamily", "Nearest", "PathAtlas", "read_atlas"]

SHIPPED = Path(__file__).with_name("paths.npz")
_SINGLE = 1e-5  # of sums of sixteen products in single precision
_BLOCK = 8192  # shapes that fit the processor's cache
_BEGIN, _MORE = 2048, 3  # shapes compared exactly at first, and how many times more each time
_KEPT = ("title", "mechanism", "point", "names", "numbers", "shapes")


@dataclass(frozen=True, kw_only=True, eq=False)
class AtlasFamily:
    """D designs of one mechanism.

    Parameters
    ----------
    title, mechanism : str
        Its name, and the text of its file.
    point : str
        The point that draws the paths.
    names : tuple of str
        Its varied numbers.
    numbers : (D, P) float32
        Their values [file units].
    shapes : (D, 32) float16
        Real and imaginary parts of the shapes.
    """

    title: str
    mechanism: str
    point: str
    names: tuple[str, ...]
    numbers: AnyArray
    shapes: AnyArray

    def __len__(self) -> int:
        return len(self.numbers)

    @cached_property
    def lengths(self) -> AnyArray:
        """Lengths of the coefficients of shapes, (D, 16) float32, of norm 1."""
        found = np.empty((len(self.shapes), self.shapes.shape[1] // 2), dtype=np.float32)
        for first in range(0, len(found), _BLOCK):
            part = slice(first, first + _BLOCK)
            pairs = self.shapes[part].astype(np.float32)
            pairs *= pairs
            squares = pairs[:, 0::2] + pairs[:, 1::2]
            found[part] = np.sqrt(squares / squares.sum(axis=1, keepdims=True))
        return found

    def bounds(self, wanted: ComplexArray) -> AnyArray:
        """Lower bounds of the distances (D,) from a shape in all WAYS (4, 16)."""
        # a mirror image with the opposite sense has the same lengths as the curve
        agreement = (self.lengths @ np.abs(wanted[:2]).T.astype(np.float32)).max(axis=1)
        bound: AnyArray = np.sqrt(np.maximum(2.0 - 2.0 * agreement - _SINGLE, 0.0))
        return bound

    def shapes_of(self, index: IndexArray) -> ComplexArray:
        """Some of the shapes, (K, 16) complex; half precision takes them off the norm 1."""
        found = np.ascontiguousarray(self.shapes[index], dtype=float).view(complex)
        return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


@dataclass(frozen=True, kw_only=True, eq=False)
class Nearest:
    """A design of an atlas whose path is near a curve.

    ``distance``: the root of the mean square of the gaps, relative to the size of the curve;
    ``way``: the place among the WAYS in which the curve is compared.
    """

    family: AtlasFamily
    index: int
    distance: float
    way: int

    @property
    def numbers(self) -> dict[str, float]:
        """Its varied numbers [file units of the family]."""
        values = self.family.numbers[self.index].tolist()
        return dict(zip(self.family.names, values, strict=True))

    @property
    def is_mirrored(self) -> bool:
        """Whether the mirror image of the mechanism draws the curve."""
        return WAYS[self.way][1]


@dataclass(frozen=True, kw_only=True, eq=False)
class PathAtlas:
    """Several families; ``unfinished``: sentences about stores that lack some of their designs."""

    families: tuple[AtlasFamily, ...]
    unfinished: tuple[str, ...] = ()

    def __len__(self) -> int:
        return sum(map(len, self.families))

    def nearest(self, curve: ComplexArray, count: int) -> list[Nearest]:
        """The designs whose paths are nearest to a closed curve (N,), nearest first.

        Lengths of coefficients differ by no more than the coefficients: this lower bound of the
        distance chooses what is compared exactly, until no other design can be nearer.
        """
        if told := out_of_bounds(curve):
            raise InputError(f"the curve {told}")
        shape = coefficients(curve[None])[0][0]
        if not np.isfinite(shape).all():
            raise InputError("the curve is one point: draw a curve that encloses an area")
        wanted = in_ways(shape)
        bound = np.concatenate([family.bounds(wanted) for family in self.families])
        first = np.cumsum([0, *map(len, self.families)])
        best: list[tuple[float, int, int]] = []
        done, many = 0, _BEGIN
        while True:
            order = _smallest(bound, many)
            index = np.sort(order[done:])
            parts = np.split(index, np.searchsorted(index, first[1:-1]))
            shapes = np.concatenate(
                [
                    family.shapes_of(own - start)
                    for family, own, start in zip(self.families, parts, first[:-1], strict=True)
                ]
            )
            ways = np.stack([distances(shapes, own)[0] for own in wanted])
            way = ways.argmin(axis=0)
            best += zip(ways.min(axis=0).tolist(), index.tolist(), way.tolist(), strict=True)
            best = sorted(best)[:count]
            enough = len(best) == count and best[-1][0] <= bound[order[-1]]
            if enough or len(order) == len(bound):
                break
            done, many = many, _MORE * many
        found = []
        for far, k, way in best:
            place = int(np.searchsorted(first, k, side="right")) - 1
            family, own = self.families[place], k - int(first[place])
            found.append(Nearest(family=family, index=own, distance=far, way=way))
        return found

    def write(self, path: Path) -> None:
        """Write the atlas to a file (.npz), completely or not at all."""
        arrays = {
            f"{k}.{name}": np.asarray(getattr(family, name))
            for k, family in enumerate(self.families)
            for name in _KEPT
        }
        file = BytesIO()
        # half precision hardly compresses, and is read in a tenth of the time
        np.savez(file, **arrays)  # type: ignore[arg-type]  # arrays alone
        save_bytes(file.getvalue(), path)


def _smallest(bound: Array, count: int) -> IndexArray:
    """The places of the smallest bounds, in order."""
    if count >= len(bound):
        return np.argsort(bound, kind="stable")
    some = np.argpartition(bound, count)[:count]
    return np.asarray(some[np.argsort(bound[some], kind="stable")])


def read_atlas(path: Path = SHIPPED) -> PathAtlas:
    """The atlas in a file.

    Raises
    ------
    InputError
        If it is no atlas.
    """
    try:
        with np.load(BytesIO(path.read_bytes())) as stored:
            count = 1 + max(int(name.partition(".")[0]) for name in stored.files)
            parts = [{name: stored[f"{k}.{name}"] for name in _KEPT} for k in range(count)]
    except FileNotFoundError:
        raise InputError(f'there is no atlas "{path}"') from None
    except (OSError, KeyError, ValueError, BadZipFile):
        told = (
            f'"{path}" is no atlas of paths: make one with "linkwork atlas --index STORE -o FILE"'
        )
        raise InputError(told) from None
    return PathAtlas(
        families=tuple(
            AtlasFamily(
                title=str(part["title"]),
                mechanism=str(part["mechanism"]),
                point=str(part["point"]),
                names=tuple(map(str, part["names"])),
                numbers=part["numbers"],
                shapes=part["shapes"],
            )
            for part in parts
        )
    )
