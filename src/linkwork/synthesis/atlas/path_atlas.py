"""The shape of a closed curve: Fourier coefficients of points at equal steps of arc length.

Steps of arc length leave out the timing. Place and size go with the mean and the norm of the
coefficients c_k; a turn multiplies all of them by one number of length 1, another first point
multiplies c_k by e^{iks}; the opposite sense of travel exchanges c_k and c_-k, a mirror image also
conjugates them. The distance of two shapes is the least over all of these, eq. (157).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from io import BytesIO
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array, ComplexArray, IndexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import save_bytes
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.guides import Slider
from linkwork.core.mechanism.varied_numbers import number_named, with_numbers
from linkwork.core.motion.model import model_of
from linkwork.core.motion.sweeping import sweep
from linkwork.core.textfile.reader import read_text
from linkwork.synthesis.tasks.curve_file import out_of_bounds

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
        if problem := out_of_bounds(curve):
            raise InputError(f"the curve {problem}")
        shape = coefficients(curve[None])[0][0]
        if not np.isfinite(shape).all():
            raise InputError("the curve is one point: draw a curve that encloses an area")
        goals = in_ways(shape)
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
        for far, k, way in best:
            place = int(np.searchsorted(first, k, side="right")) - 1
            family, number = self.families[place], k - int(first[place])
            nearest.append(Nearest(family=family, index=number, distance=far, way=way))
        return nearest

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
        message = (
            f'"{path}" is no atlas of paths: make one with "linkwork atlas --index STORE -o FILE"'
        )
        raise InputError(message) from None
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


# ----------------------------------------------------------------------
# A design of an atlas, moved, turned, enlarged and if need be mirrored onto a curve.


def placed_on_curve(near: Nearest, curve: ComplexArray, name: str) -> tuple[Linkage, float]:
    """The mechanism whose path lies on a closed curve (N,) as well as possible, and the root of the
    mean square of the gaps [length].

    Raises
    ------
    InputError
        If its file has other things than points, links, lengths, angles, sliders and one crank.
    """
    described = read_text(near.family.mechanism, name).description
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
    path = motion.trace(near.family.point)[:-1]
    shape, centre, size = coefficients((path.conj() if mirrored else path)[None])
    goals, goal, extent = coefficients(curve[None])
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
