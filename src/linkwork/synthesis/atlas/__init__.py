"""Known curves, their linkages, and the nearest of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import Any, Self
from zipfile import BadZipFile

import numpy as np

from linkwork import wings
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.arrays import AnyArray, Array, BoolArray, ComplexArray, IndexArray
from linkwork.core.foundation.errors import InputError, internal
from linkwork.core.foundation.files import as_path, save_bytes
from linkwork.core.foundation.values import as_told, whole_number
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.guides import Slider
from linkwork.core.mechanism.varied_numbers import number_named, with_numbers
from linkwork.core.motion.model import model_of
from linkwork.core.motion.sweeping import sweep
from linkwork.core.textfile.reader import read_text
from linkwork.synthesis.tasks.conditions import FEWEST, out_of_bounds

# ----------------------------------------------------------------------
# The shape of a closed curve: Fourier coefficients of points at equal steps of arc length.
#
# Steps of arc length leave out the timing. Place and size go with the mean and the norm of the
# coefficients c_k; a turn multiplies all of them by one number of length 1, another first point
# multiplies c_k by e^{iks}; the opposite sense of travel exchanges c_k and c_-k, a mirror image
# also conjugates them. The distance of two shapes is the least over all of these, eq. (157).


_POINTS = 64
_MOST = 8
#: k of the coefficients of a shape.
HARMONICS = np.concatenate([np.arange(1, _MOST + 1), np.arange(-_MOST, 0)])
#: Whether a curve is travelled in the opposite sense, and mirrored.
WAYS = ((False, False), (True, False), (False, True), (True, True))
_SHIFTS = 64  # first points that are tried before the best one is refined
_REFINEMENTS = 4


def points_by_arc_length(z: ComplexArray) -> ComplexArray:
    """Points (D, 64) at equal steps of arc length along closed polygons z (D, N)."""
    closed = np.concatenate([z, z[:, :1]], axis=1)
    length = np.cumsum(np.abs(np.diff(closed, axis=1)), axis=1)
    length = np.concatenate([np.zeros((len(z), 1)), length], axis=1)
    share = np.arange(_POINTS) / _POINTS
    resampled = np.empty((len(z), _POINTS), dtype=complex)
    for k, (along, points) in enumerate(zip(length, closed, strict=True)):
        resampled[k] = np.interp(share * along[-1], along, points)
    return resampled


def coefficients(z: ComplexArray) -> tuple[ComplexArray, ComplexArray, Array]:
    """The shapes (D, 16) of closed polygons (D, N), their centres (D,) and sizes (D,).

    The size is the root of the mean square distance from the centre, as far as the harmonics make
    it; shapes have the norm 1, NaN for curves that are one point.
    """
    c = np.fft.fft(points_by_arc_length(z), axis=1) / _POINTS
    harmonics = c[:, HARMONICS]
    size = np.sqrt((np.abs(harmonics) ** 2).sum(axis=1))
    with np.errstate(all="ignore"):
        return harmonics / size[:, None], c[:, 0], size


def in_ways(shape: ComplexArray) -> ComplexArray:
    """A shape (16,) in each of the WAYS, (4, 16)."""
    back = shape[::-1]  # c_-k, by the order of the harmonics
    return np.stack([shape, back, back.conj(), shape.conj()])


def distances(shapes: ComplexArray, goals: ComplexArray) -> tuple[Array, Array, Array]:
    """The distances (D,) of shapes (D, 16) from a goal (16,), with the best turn and first point.

    Returns
    -------
    distance, shift, turn : (D,)
        The root of the mean square of the gaps, relative to the size; e^{i(ks + turn)} times the
        shape's c_k is nearest to the goal, for the shift s [rad].
    """
    products = shapes.conj() * goals
    grid = np.arange(_SHIFTS) * (2.0 * np.pi / _SHIFTS)
    # f(s) = Σ c̄_k w_k e^{-iks}: its largest length is the best agreement
    s = grid[np.abs(products @ np.exp(-1j * np.outer(HARMONICS, grid))).argmax(axis=1)]
    for _ in range(_REFINEMENTS):
        terms = products * np.exp(-1j * s[:, None] * HARMONICS)
        f, d = terms.sum(axis=1), (terms * (-1j * HARMONICS)).sum(axis=1)
        dd = (terms * -(HARMONICS**2)).sum(axis=1)
        # Newton's method for the maximum of |f|²
        slope = (f.conj() * d).real
        bend = np.abs(d) ** 2 + (f.conj() * dd).real
        with np.errstate(all="ignore"):
            step = np.where(bend < 0, -slope / bend, 0.0)
        s = s + np.clip(step, -grid[1], grid[1])
    f = (products * np.exp(-1j * s[:, None] * HARMONICS)).sum(axis=1)
    # eq. (157)
    square = 2.0 - 2.0 * np.abs(f)
    return np.sqrt(np.maximum(square, 0.0)), s, np.angle(f)


# ----------------------------------------------------------------------
# Families of mechanisms with the shapes of their paths, and the nearest ones to a curve.


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
        lengths = np.empty((len(self.shapes), self.shapes.shape[1] // 2), dtype=np.float32)
        for first in range(0, len(lengths), _BLOCK):
            part = slice(first, first + _BLOCK)
            pairs = self.shapes[part].astype(np.float32)
            pairs *= pairs
            squares = pairs[:, 0::2] + pairs[:, 1::2]
            lengths[part] = np.sqrt(squares / squares.sum(axis=1, keepdims=True))
        return lengths

    def bounds(self, goals: ComplexArray) -> AnyArray:
        """Lower bounds of the distances (D,) from a shape in all WAYS (4, 16)."""
        # a mirror image with the opposite sense has the same lengths as the curve
        agreement = (self.lengths @ np.abs(goals[:2]).T.astype(np.float32)).max(axis=1)
        bound: AnyArray = np.sqrt(np.maximum(2.0 - 2.0 * agreement - _SINGLE, 0.0))
        return bound

    def shapes_of(self, index: IndexArray) -> ComplexArray:
        """Some of the shapes, (K, 16) complex; half precision takes them off the norm 1."""
        shapes = np.ascontiguousarray(self.shapes[index], dtype=float).view(complex)
        return np.asarray(shapes / np.linalg.norm(shapes, axis=1, keepdims=True))


@internal("designs", "index", "way", "curve")
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class NearPath:
    """A mechanism whose path resembles a curve.

    Parameters
    ----------
    number : int
        Its rank, from 1.
    distance : float
        The root of the mean square of the gaps, relative to the size of the curve, which is the
        root of the mean square distance from its centre.
    designs : AtlasFamily
        The family in the atlas.
    index : int
        Its place there.
    way : int
        The place among the WAYS in which the curve is compared.
    curve : (N,) complex
        [length]

    Examples
    --------
    >>> import linkwork as lw
    >>> path = lw.example("hoeken").sweep(step=5).trace("P")
    >>> near = lw.synthesis.PathAtlas.shipped().nearest(path, 3)[0]
    >>> near.distance < 0.1, bool(near.mechanism.sweep().certified.all())
    (True, True)
    """

    number: int
    distance: float
    designs: AtlasFamily
    index: int
    way: int
    curve: ComplexArray

    @property
    def numbers(self) -> dict[str, float]:
        """Its varied numbers in the atlas [file units of the family]."""
        values = self.designs.numbers[self.index].tolist()
        return dict(zip(self.designs.names, values, strict=True))

    @property
    def is_mirrored(self) -> bool:
        """Whether it is the mirror image of the mechanism in the atlas."""
        return WAYS[self.way][1]

    @property
    def family(self) -> str:
        """The name of the mechanism in the atlas."""
        return self.designs.title

    @cached_property
    def mechanism(self) -> Mechanism:
        """The mechanism, placed on the curve as well as possible."""
        return Mechanism(placed_on_curve(self, f"Near path {self.number}")[0])

    def __repr__(self) -> str:
        return f"<NearPath {self.number}: distance {self.distance:.3g}>"


@internal("families")
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class PathAtlas:
    """Closed paths of many mechanisms, searched by shape.

    Place, size, direction, timing and first point of a path do not count.

    Parameters
    ----------
    families : tuple of AtlasFamily
    unfinished : tuple of str
        Sentences about stores that lacked some of their designs when it was made.

    Examples
    --------
    >>> import linkwork as lw
    >>> atlas = lw.synthesis.PathAtlas.shipped()
    >>> square = [(0, 0), (50, 0), (100, 0), (100, 100), (0, 100), (0, 50)]
    >>> len(atlas.nearest(square, 5))
    5
    """

    families: tuple[AtlasFamily, ...]
    unfinished: tuple[str, ...] = ()

    @classmethod
    def shipped(cls) -> Self:
        """The small atlas that is part of Linkwork."""
        return cls.load(SHIPPED)

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """The atlas in a file of :meth:`save`.

        Raises
        ------
        InputError
            If it is no atlas.
        """
        try:
            with np.load(BytesIO(as_path(path).read_bytes())) as stored:
                count = 1 + max(int(name.partition(".")[0]) for name in stored.files)
                parts = [{name: stored[f"{k}.{name}"] for name in _KEPT} for k in range(count)]
        except FileNotFoundError:
            raise InputError(f'there is no atlas "{path}"') from None
        except (OSError, KeyError, ValueError, BadZipFile):
            message = f'"{path}" is no atlas of paths: make one with "linkwork atlas --index'
            raise InputError(f'{message} STORE -o FILE"') from None
        return cls(
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

    @classmethod
    def of_stores(
        cls, stores: Sequence[str | Path], progress: Callable[[float], None] | None = None
    ) -> PathAtlas:
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
        _stores().check_packages()
        return atlas_of_stores([as_path(store) for store in stores], progress)

    def save(self, path: str | Path) -> None:
        """Write the atlas to a file (.npz), completely or not at all."""
        arrays = {
            f"{k}.{name}": np.asarray(getattr(family, name))
            for k, family in enumerate(self.families)
            for name in _KEPT
        }
        file = BytesIO()
        # half precision hardly compresses, and is read in a tenth of the time
        np.savez(file, **arrays)  # type: ignore[arg-type]  # arrays alone
        save_bytes(file.getvalue(), as_path(path))

    def nearest(
        self, curve: Sequence[Sequence[float]] | ComplexArray, count: int = 100
    ) -> tuple[NearPath, ...]:
        """The mechanisms whose paths are nearest to a closed curve, nearest first.

        Lengths of coefficients differ by no more than the coefficients: this lower bound of the
        distance chooses what is compared exactly, until no other design can be nearer.

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
        z, count = _closed_curve(curve), whole_number("count", count, least=1)
        goals = in_ways(coefficients(z[None])[0][0])
        bound = np.concatenate([family.bounds(goals) for family in self.families])
        first = np.cumsum([0, *map(len, self.families)])
        best: list[tuple[float, int, int]] = []
        done, many = 0, _BEGIN
        while True:
            order = _smallest(bound, many)
            index = np.sort(order[done:])
            parts = np.split(index, np.searchsorted(index, first[1:-1]))
            shapes = np.concatenate(
                [
                    family.shapes_of(index - start)
                    for family, index, start in zip(self.families, parts, first[:-1], strict=True)
                ]
            )
            ways = np.stack([distances(shapes, goal)[0] for goal in goals])
            way = ways.argmin(axis=0)
            best += zip(ways.min(axis=0).tolist(), index.tolist(), way.tolist(), strict=True)
            best = sorted(best)[:count]
            enough = len(best) == count and best[-1][0] <= bound[order[-1]]
            if enough or len(order) == len(bound):
                break
            done, many = many, _MORE * many
        nearest = []
        for number, (distance, k, way_of) in enumerate(best, start=1):
            place = int(np.searchsorted(first, k, side="right")) - 1
            nearest.append(
                NearPath(
                    number=number,
                    distance=distance,
                    designs=self.families[place],
                    index=k - int(first[place]),
                    way=way_of,
                    curve=z,
                )
            )
        return tuple(nearest)

    def __len__(self) -> int:
        return sum(map(len, self.families))

    def __repr__(self) -> str:
        return f"<PathAtlas of {len(self)} paths>"


def _closed_curve(curve: object) -> ComplexArray:
    """The corners (N,) of a closed curve, the first one once."""
    try:
        array = np.asarray(curve)
    except ValueError:  # rows of different lengths
        array = np.empty(0, dtype=object)
    if array.dtype.kind == "c" and array.ndim == 1:
        z = np.asarray(array, dtype=complex)
    elif array.dtype.kind in "iuf" and array.ndim == 2 and array.shape[1] == 2:
        z = np.asarray(array[:, 0] + 1j * array[:, 1])
    else:
        told = as_told(curve)
        raise InputError(f"a curve is a list of points (x, y) or complex numbers, got {told}")
    if len(z) > 1 and z[0] == z[-1]:
        z = z[:-1]
    if len(z) < FEWEST or not np.isfinite(z).all():
        raise InputError(f"a curve needs {FEWEST} points or more, all finite: got {len(z)}")
    if problem := out_of_bounds(z):
        raise InputError(f"the curve {problem}")
    if np.ptp(z.real) == np.ptp(z.imag) == 0.0:
        raise InputError("the curve is one point: draw a curve that encloses an area")
    return z


def _smallest(bound: Array, count: int) -> IndexArray:
    """The places of the smallest bounds, in order."""
    if count >= len(bound):
        return np.argsort(bound, kind="stable")
    some = np.argpartition(bound, count)[:count]
    return np.asarray(some[np.argsort(bound[some], kind="stable")])


# ----------------------------------------------------------------------
# A design of an atlas, moved, turned, enlarged and if need be mirrored onto a curve.


def placed_on_curve(near: NearPath, name: str) -> tuple[Linkage, float]:
    """The mechanism whose path lies on its curve as well as possible, and the root of the mean
    square of the gaps [length].

    Raises
    ------
    InputError
        If its file has other things than points, links, lengths, angles, sliders and one crank.
    """
    described = read_text(near.designs.mechanism, name).description
    if not isinstance(described, Linkage) or len(described.inputs) != 1:
        raise InputError("an atlas can place mechanisms of points and links with one input only")
    others = sorted({type(part).title for part in described.parts if not isinstance(part, Slider)})
    if others:
        text = "an atlas can place mechanisms of links and sliders only, not with parts of the kind"
        raise InputError(f"{text} {', '.join(others)}")
    numbers = {number_named(described, key): value for key, value in near.numbers.items()}
    design = with_numbers(described, numbers)
    assert isinstance(design, Linkage)
    motion = sweep(model_of(design), certify=False)
    mirrored = near.is_mirrored
    path = motion.trace(near.designs.point)[:-1]
    shape, centre, size = coefficients((path.conj() if mirrored else path)[None])
    goals, goal, extent = coefficients(near.curve[None])
    back = WAYS[near.way][0]
    travelled = in_ways(goals[0])[1 if back else 0]
    _, shift_along, turn = distances(shape, travelled)
    # a distance from the agreement of shapes would be exact to the root of rounding only
    fitted = shape[0] * np.exp(1j * (HARMONICS * shift_along[0] + turn[0]))
    gap = float(np.linalg.norm(fitted - travelled) * extent[0])
    factor = complex(extent[0] / size[0] * np.exp(1j * turn[0]))
    shift = complex(goal[0] - factor * centre[0])
    places = {point: motion.trace(point)[0] for point in design.points}
    if mirrored:
        places = {point: z.conjugate() for point, z in places.items()}
    moved = {point: shift + factor * z for point, z in places.items()}
    value, sense = design.numbers, -1.0 if mirrored else 1.0
    (drive,) = design.inputs
    begin = design.angle.from_radians(float(np.angle(factor)))
    start, stop, step = (float(value(x or 0.0)) for x in (drive.from_, drive.to, drive.step))
    crank = replace(drive, from_=begin + sense * start, to=begin + sense * stop, step=sense * step)
    placed = replace(
        design,
        name=name,
        points={point: (z.real, z.imag) for point, z in moved.items()},
        lengths={key: float(value(x)) * abs(factor) for key, x in design.lengths.items()},
        angles={key: sense * float(value(x)) for key, x in design.angles.items()},
        sliders=tuple(
            replace(
                slider,
                offset=sense * float(value(slider.offset)) * abs(factor),
                angle=None if slider.angle is None else sense * float(value(slider.angle)),
            )
            for slider in design.sliders
        ),
        inputs=(crank,),
    )
    return placed, gap


# ----------------------------------------------------------------------
# An atlas of the paths that studies have stored.


_CLOSED = 1e-6  # of the path's size: the first and last row are one position


def _stores() -> Any:
    """The module of stores: curves are compared without it, as on a page in a browser."""
    return wings.use("families.study.store")


def atlas_of_stores(
    stores: Sequence[Path], progress: Callable[[float], None] | None = None
) -> PathAtlas:
    """The atlas of studies that keep the path of a point over a whole turn.

    A store that is named twice counts once. ``progress``: called with the finished fraction; may
    raise an error to end the work.

    Raises
    ------
    InputError
        If a store is damaged, keeps no path, or has no closed path.
    """
    stores = [*{path.resolve(): path for path in stores}.values()]  # each of them once
    # wrong stores are refused before the first one is read
    known = [_checked(path) for path in stores]
    whole, done = sum(len(_stores().chunks_with_record(path)) for path in stores), 0

    def tell() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done / whole)

    unfinished = []
    families = []
    for path, attributes in zip(stores, known, strict=True):
        family, stored = _family_of_store(path, attributes, tell)
        families.append(family)
        count = attributes["linkwork_identity"]["count"]
        if stored < count:
            unfinished.append(f'"{path}" has {stored} of {count} designs: its study is unfinished')
    return PathAtlas(families=tuple(families), unfinished=tuple(unfinished))


def _checked(path: Path) -> Mapping[str, Any]:
    """The attributes of a store with the path of one point."""
    attributes: Mapping[str, Any] = _stores().attributes_of(path)
    kept = attributes["linkwork_identity"]["keep"]
    count = len(_points(kept))
    if count != 1:
        raise InputError(
            f'"{path}" keeps the paths of {count} points: an atlas needs one, e.g. '
            'keep = ["P.x", "P.y"] in the plan'
        )
    return attributes


def _points(kept: Sequence[str]) -> list[str]:
    return [name[:-2] for name in kept if name.endswith(".x") and f"{name[:-2]}.y" in kept]


def _family_of_store(
    path: Path, attributes: Mapping[str, Any], tell: Callable[[], None]
) -> tuple[AtlasFamily, int]:
    """The paths of a store, and the number of its designs."""
    known = attributes["linkwork_identity"]
    (point,) = _points(known["keep"])
    varied = known["varied"]
    constants = {name: x for name, x in known["dimensions"].items() if name not in varied}
    names = (*varied, *constants)
    numbers = [np.zeros((0, len(names)), dtype=np.float32)]
    shapes = [np.zeros((0, 32), dtype=np.float16)]
    stored = damaged = 0
    for chunk in _stores().read_chunks(path):
        tell()
        damaged += bool(chunk.changed)
        if damaged:
            continue
        stored += len(chunk.designs)
        arrays = chunk.arrays
        z = arrays[f"{point}.x"] + 1j * arrays[f"{point}.y"]
        good = arrays["passed"] & _are_closed(z)
        shape = coefficients(z[good][:, :-1])[0]
        columns = {name: arrays[name][good] for name in varied} | constants
        values = np.stack(np.broadcast_arrays(*columns.values()), axis=1)
        there = np.isfinite(shape).all(axis=1)
        # chunk by chunk in the precision that is kept: a million designs fit in little memory
        numbers.append(values[there].astype(np.float32))
        shapes.append(np.ascontiguousarray(shape[there]).view(float).astype(np.float16))
    if damaged:
        raise InputError(
            f'damaged chunks of "{path}": {damaged}; repeat the command of its study, '
            "which computes them again"
        )
    lengths = np.concatenate(numbers)
    if not len(lengths):
        raise InputError(f'"{path}" has no closed path: keep it over a whole turn of the crank')
    family = AtlasFamily(
        title=attributes["mechanism_name"],
        mechanism=known["mechanism"],
        point=point,
        names=names,
        numbers=lengths,
        shapes=np.concatenate(shapes),
    )
    return family, stored


def _are_closed(z: ComplexArray) -> BoolArray:
    """Whether paths (D, N) end where they begin; false where rows are missing."""
    size = np.abs(z - z[:, :1]).max(axis=1)
    return np.asarray(np.abs(z[:, -1] - z[:, 0]) <= _CLOSED * size)
