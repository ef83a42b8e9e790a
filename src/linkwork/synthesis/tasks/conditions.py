"""The curve of a task: points in a CSV file."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import (
    EPSILON,
    EQUAL_ROWS,
    UNIT_ROUNDOFF,
    Array,
    BoolArray,
    ComplexArray,
    CountArray,
)
from linkwork.core.foundation.errors import MechanismError, Problem
from linkwork.core.foundation.values import as_told
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.core.textfile.toml_text import bytes_of, text_of
from linkwork.synthesis.improvement.settings import Problems
from linkwork.synthesis.loops.driven_loop import Range

_COLUMNS = ("x", "y", "input")
FEWEST = 5  # points of a curve
#: Powers of larger numbers are beyond floating point, and those of the inverse of smaller ones.
LARGEST = 1e12
_MOST = 2000  # points: beyond, a fit takes minutes and gains nothing


@dataclass(frozen=True, kw_only=True)
class Curve:
    """A curve in file units.

    Parameters
    ----------
    points : tuple of (float, float)
        In order of travel [length].
    inputs : tuple of float
        Inputs at the points; none: free timing [file's angle unit].
    closed : str
        closed, open or partial; "": by the distance of the ends.
    file, text : str
        The file, as the task names it, and its text.
    lines : tuple of int
        The lines of the points in the file.
    note : str
        What a summary adds: which line repeats the first point of a closed curve, and is left out.
    """

    points: tuple[tuple[float, float], ...]
    inputs: tuple[float, ...] = ()
    closed: str = ""
    file: str = ""
    text: str = ""
    lines: tuple[int, ...] = ()
    note: str = ""


def read_curve(table: Mapping[str, Any], folder: Path | None, turn: float = 360.0) -> Curve:
    """The curve of a table of a task; a last point that repeats the first one of a closed curve
    counts once.

    ``turn``: in the unit of the inputs.

    Raises
    ------
    MechanismError
        With the line of the file that is no point.
    """
    name = table["file"]
    path = Path(name) if folder is None else folder / name
    text = text_of(bytes_of(path, str(path)), str(path))
    rows = _number_rows(text, str(path))
    timed = table.get("timing", "free") == "as given"
    if timed and any(len(row) < len(_COLUMNS) for _, row in rows):
        line = next(line for line, row in rows if len(row) < len(_COLUMNS))
        raise _problem(("curve", "timing"), f"needs a third column, input: line {line} has none")
    closed, note = table.get("closed", ""), ""
    if closed in ("", "closed") and _is_repeated([row for _, row in rows], timed, turn):
        line, _ = rows.pop()
        note = f'; line {line} of "{name}" repeats the first point, which counts once'
    if not FEWEST <= len(rows) <= _MOST:
        count = f"{len(rows)} point{'' if len(rows) == 1 else 's'}"
        message = f'"{name}" has {count}: a curve needs {FEWEST} to {_MOST}'
        raise _problem(("curve", "file"), message)
    if message := out_of_bounds(np.array([complex(row[0], row[1]) for _, row in rows])):
        raise _problem(("curve", "file"), f'"{name}" {message}')
    return Curve(
        points=tuple((row[0], row[1]) for _, row in rows),
        inputs=tuple(row[2] for _, row in rows) if timed else (),
        closed=closed,
        file=name,
        text=text,
        lines=tuple(line for line, _ in rows),
        note=note,
    )


def out_of_bounds(points: ComplexArray) -> str:
    """Why points (N,) are too large or too close to compute with, in words; "" if they are not.

    Points all at one place have another problem.
    """
    largest = np.abs([points.real, points.imag]).max(initial=0.0)
    if largest > LARGEST:
        return f"goes to {largest:g}, beyond ±{LARGEST:g}: choose a larger unit"
    size = max(np.ptp(points.real), np.ptp(points.imag))
    if 0.0 < size < 1.0 / LARGEST:
        return f"is {size:g} in size, less than {1.0 / LARGEST:g}: choose a smaller unit"
    return ""


def _is_repeated(rows: list[list[float]], timed: bool, turn: float) -> bool:
    """Whether the last row is the first one again, of timed ones a turn later."""
    if len(rows) < 2 or rows[-1][:2] != rows[0][:2]:
        return False
    return not timed or abs(abs(rows[-1][2] - rows[0][2]) - turn) <= EQUAL_ROWS * turn


def _number_rows(text: str, name: str) -> list[tuple[int, list[float]]]:
    """Rows of numbers with their lines; the first row may be a header, # begins a comment."""
    rows: list[tuple[int, list[float]]] = []
    for line, cells in enumerate(csv.reader(io.StringIO(text)), start=1):
        if not any(cell.strip() for cell in cells) or cells[0].lstrip().startswith("#"):
            continue
        try:
            row = [float(cell) for cell in cells]
        except ValueError:
            if not rows and [cell.strip().lower() for cell in cells] in (
                list(_COLUMNS[:2]),
                list(_COLUMNS),
            ):
                continue
            shown, parted = as_told(",".join(cells)), ";" in cells[0] or "\t" in cells[0]
            message = f'line {line} of "{name}" holds {shown}: write numbers'
            message += ", with commas between them and points for decimals" * parted
            raise _problem(("curve", "file"), message) from None
        if not 2 <= len(row) <= len(_COLUMNS) or not all(map(math.isfinite, row)):
            message = f'line {line} of "{name}" is no point: give x, y and, if timed, input'
            raise _problem(("curve", "file"), message)
        rows.append((line, row))
    return rows


def _problem(key: tuple[str, ...], message: str) -> MechanismError:
    return MechanismError([Problem(key=key, message=message)], "the task")


# ----------------------------------------------------------------------
# Tables of a task: positions, given pivots and lengths, requirements, ranking; in file units.


#: Lengths that a task of points may give.
LENGTHS = ("A0 A", "A B", "B0 B", "A0 B0", "A P", "B P")
_COUPLER = ("A B", "A P", "B P")
#: Lengths, and pivots by the task's size, that differ by less are equal.
EQUAL_LENGTHS = 1e-6

Point = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class PrecisionPosition:
    """A position through which the guided body, or its point, passes.

    Parameters
    ----------
    point : (float, float)
        Where the guided point is [length].
    angle : float, optional
        The angle of the body: with it, a pose [file's angle unit].
    input : float, optional
        The crank's angle at this position, of which differences count [file's angle unit].
    tolerance, angle_tolerance : float
        How far point and angle may miss.
    """

    point: Point
    angle: float | None = None
    input: float | None = None
    tolerance: float = 0.0
    angle_tolerance: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Given:
    """What the author fixes [length]: pivots, moving ones as they are at the first position, and
    distances of A0, B0, A, B and P.
    """

    fixed_pivots: tuple[Point, ...] = ()
    moving_pivots: tuple[Point, ...] = ()
    lengths: Mapping[str, float] = field(default_factory=dict)

    @property
    def ground(self) -> float:
        """The distance of the first two fixed pivots; without them 1."""
        first, second, *_ = *self.fixed_pivots, (1.0, 0.0), (0.0, 0.0)
        return math.dist(first, second)

    @property
    def coupler_trouble(self) -> str:
        """Why the given sides of the coupler, if all three are, make no triangle; or ""."""
        one, other, longest = sorted(self.lengths.get(name, 0.0) for name in _COUPLER)
        slack = one + other - longest
        if one <= 0.0 or slack > EQUAL_LENGTHS * longest:
            return ""
        if slack < -EQUAL_LENGTHS * longest:
            return "A B, A P and B P are no triangle: leave one out"
        return (
            "A B, A P and B P put P on the line of A and B, where all solutions are double: change "
            "one of them by a thousandth, or leave it out"
        )


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """Wishes, each proved over the whole driven range.

    Parameters
    ----------
    turns_fully : bool
        Whether the driven link makes whole turns.
    range : (float, float), optional
        The driven range [file's angle unit, or length].
    transmission : float
        The smallest transmission angle allowed [file's angle unit].
    ordered : bool
        Whether the positions are passed in their order.
    region : tuple of points
        Corners of the polygon that contains all fixed pivots [length].
    shortest, longest, ratio : float
        Bounds of lengths, and of the longest over the shortest.
    obstacles : tuple of (x, y, radius)
        Circles that no link may meet [length].
    """

    turns_fully: bool = False
    range: tuple[float, float] | None = None
    transmission: float = 0.0
    ordered: bool = True
    region: tuple[Point, ...] = ()
    shortest: float = 0.0
    longest: float = math.inf
    ratio: float = math.inf
    obstacles: tuple[tuple[float, float, float], ...] = ()


@dataclass(frozen=True, kw_only=True)
class Ranking:
    """Weights of the ranking, and the largest number of designs that are delivered."""

    transmission: float = 1.0
    size: float = 1.0
    error: float = 5.0
    deliver: int = 20

    def problems(self) -> Iterator[tuple[tuple[str | int, ...], str]]:
        """Weights that rank nothing, with their keys."""
        weights = {
            TRANSMISSION_ANGLE.word: self.transmission, "size": self.size, "error": self.error,
        }  # fmt: skip
        for name, weight in weights.items():
            if weight < 0.0:
                yield ("rank", "by", name), f"must not be negative, got {weight:g}"
        if not any(weights.values()):
            yield ("rank", "by"), "has no weight above 0: give one, or leave it out"


# ----------------------------------------------------------------------
# The requirements of a task in numbers: radians, lengths, and complex points.


_LEAST = 1e-300  # in place of 0, of which no multiple is large


@dataclass(frozen=True, kw_only=True, eq=False)
class Wishes:
    """What a design must satisfy over its whole motion.

    Parameters
    ----------
    ordered : bool
        Whether the positions are passed in their order.
    range : Range, optional
        The driven range; by default from the first position to the last.
    beyond : float
        How far the range by default reaches before the first and behind the last position [rad].
    transmission : float
        The smallest transmission angle allowed [rad].
    region : (K,) complex
        The corners of the polygon that contains the fixed pivots; none: anywhere [length].
    shortest, longest, ratio : float
        Bounds of all lengths, and of the longest over the shortest.
    obstacles : (M, 3)
        Circles x, y, radius, which no link may meet [length].
    points, reach : (N,) complex, (N,)
        The points of the task, and how far each may be missed; empty if not checked [length].
    """

    ordered: bool = True
    range: Range | None = None
    beyond: float = 0.0
    transmission: float = 0.0
    region: ComplexArray = field(default_factory=lambda: np.zeros(0, dtype=complex))
    shortest: float = 0.0
    longest: float = np.inf
    ratio: float = np.inf
    obstacles: Array = field(default_factory=lambda: np.zeros((0, 3)))
    points: ComplexArray = field(default_factory=lambda: np.zeros(0, dtype=complex))
    reach: Array = field(default_factory=lambda: np.zeros(0))

    def allows(self, shortest: Array, longest: Array) -> BoolArray:
        """Whether lengths (D,) are within the bounds."""
        return np.asarray(
            (shortest >= self.shortest)
            & (longest <= self.longest)
            # a ratio of infinity allows a length of zero
            & (longest <= self.ratio * np.maximum(shortest, _LEAST))
        )

    def exceeds(self, guided: ComplexArray, error: Array) -> BoolArray:
        """Which positions of guided points (D, N) miss theirs by more than allowed, beyond errors
        (D,).
        """
        if not self.reach.size:
            return np.zeros(guided.shape, dtype=bool)
        away = np.abs(guided - self.points)
        rounding = 8.0 * UNIT_ROUNDOFF * np.abs(guided)
        return np.asarray(~(away <= self.reach + rounding + error[:, None]))

    def within_region(self, points: ComplexArray, error: Array) -> BoolArray:
        """Whether points (D,) are inside the region, or on its border to their errors."""
        if not self.region.size:
            return np.ones(len(points), dtype=bool)
        start, end = self.region, np.roll(self.region, -1)
        z = points[:, None]
        # a ray to the right crosses the border an odd number of times from inside
        spans = (start.imag > z.imag) != (end.imag > z.imag)
        with np.errstate(all="ignore"):
            along = (z.imag - start.imag) / (end.imag - start.imag)
            crosses = spans & (z.real < start.real + along * (end.real - start.real))
        inside = crosses.sum(axis=1) % 2 == 1
        return np.asarray(inside | (distances_to_segments(z, start, end).min(axis=1) <= error))


def distances_to_segments(z: ComplexArray, start: ComplexArray, end: ComplexArray) -> Array:
    """The distances of points from segments; all broadcast."""
    along = end - start
    square = along.real**2 + along.imag**2
    part = (z - start) * along.conj()
    with np.errstate(all="ignore"):
        share = np.where(square > 0, part.real / square, 0.0)
    return np.asarray(np.abs(z - start - np.clip(share, 0.0, 1.0) * along))


# ----------------------------------------------------------------------
# Requirements and given numbers of a task that contradict each other.


_LENGTHS = ("wanted", "lengths")
_REGION = ("wanted", "fixed_pivots", "inside")


def length_contradictions(wanted: Wanted, ground: float | None) -> Problems:
    """Bounds that exclude each other, or the ground, if its length is known."""
    least, most = wanted.shortest, wanted.longest
    if least < 0:
        yield (*_LENGTHS, "least"), f"must not be negative, got {least:g}"
    elif not least <= most or most <= 0:
        yield _LENGTHS, f"least = {least:g} and most = {most:g} contradict each other"
    if wanted.ratio < 1:
        yield (*_LENGTHS, "ratio"), f"must be 1 or more, got {wanted.ratio:g}"
    if ground is not None and not least <= ground <= most:
        text = f"exclude the ground of length {ground:g}: change them, or [given] fixed_pivots"
        yield _LENGTHS, text


def place_contradictions(
    wanted: Wanted, given: Given, positions: Sequence[PrecisionPosition]
) -> Problems:
    """Positions that are to be met in obstacles, pivots outside their region, and equal ones."""
    if len(given.fixed_pivots) == 2 and given.fixed_pivots[0] == given.fixed_pivots[1]:
        yield ("given", "fixed_pivots", 1), "is the same place as the first: a link needs two"
    region = np.array([complex(*corner) for corner in wanted.region], dtype=complex)
    if len(region) and _is_flat(wanted.region):
        yield _REGION, "encloses no area"
        return
    for j, k in _crossings(region)[:1]:
        message = f"crosses itself between corners {j + 1}, {j + 2} and {k + 1}, "
        yield _REGION, f"{message}{(k + 1) % len(region) + 1}: list them around the region"
        return
    pivots = np.array([complex(*pivot) for pivot in given.fixed_pivots], dtype=complex)
    inside = Wishes(region=region).within_region(pivots, np.zeros(len(pivots)))
    for k in np.flatnonzero(~inside):
        yield ("given", "fixed_pivots", int(k)), "is outside [wanted] fixed_pivots inside"
    for k, (x, y, radius) in enumerate(wanted.obstacles):
        if radius < 0:
            yield ("wanted", "clear_of", k), f"has the negative radius {radius:g}"
        for j, position in enumerate(positions):
            if math.dist(position.point, (x, y)) + position.tolerance <= radius:
                message = f"contains the point of position {j + 1}, so no design can be clear of it"
                yield ("wanted", "clear_of", k), message


def outside_range(
    inputs: Sequence[float], table: Array, turn: float
) -> Iterator[tuple[int, float, str]]:
    """Inputs outside a table, to the accuracy of rows, modulo whole turns: their numbers, their
    values in the turn of the table, and the problem. ``turn``: infinite for lengths.
    """
    low, high = float(table.min()), float(table.max())
    slack, at = EQUAL_ROWS * (high - low), np.array(inputs, dtype=float)
    if math.isfinite(turn):
        at = at + np.round((0.5 * (low + high) - at) / turn) * turn
    for k in np.flatnonzero((at < low - slack) | (at > high + slack)):
        yield int(k), float(at[k]), f"outside the driven range from {low:g} to {high:g}"


def repeated_points(
    positions: Sequence[PrecisionPosition], curve: Curve | None, turn: float, *, once: bool
) -> Problems:
    """Equal positions, and without ``once`` equal neighbours."""
    listed = list(enumerate(positions))
    for (j, one), (k, other) in combinations(listed, 2) if once else pairwise(listed):
        same = one.point == other.point
        if one.angle is not None and other.angle is not None:
            same &= math.remainder(one.angle - other.angle, turn) == 0
        if same:
            key, message = _in_file(curve, k, "is the same as", j)
            yield key, f"{message}: leave one out"


def repeated_inputs(
    positions: Sequence[PrecisionPosition], curve: Curve | None, turn: float
) -> Problems:
    """Equal inputs, whole turns aside; the last one of a whole turn may be the first."""
    known: dict[float, tuple[int, float]] = {}
    for k, position in enumerate(positions):
        if position.input is None:
            continue
        at = math.remainder(position.input, turn)
        j, first = known.setdefault(at, (k, position.input))
        around = (j, k) == (0, len(positions) - 1) and first != position.input
        if j != k and not around:
            key, message = _in_file(curve, k, "has the input of", j, "input")
            yield key, f"{message}: move one of them"


def _in_file(
    curve: Curve | None, k: int, relation: str, j: int, *entry: str
) -> tuple[tuple[str | int, ...], str]:
    """The key and the words of a position that has a relation to another one."""
    if curve is None:
        return ("positions", k, *entry), f"{relation} position {j + 1}"
    return ("curve", "file"), f"line {curve.lines[k]} {relation} line {curve.lines[j]}"


def _crossings(z: ComplexArray) -> CountArray:
    """The sides of a polygon (K,) that cross another one: the first corners of both, (C, 2)."""
    side = np.roll(z, -1) - z
    area = (side.conj()[:, None] * (z - z[:, None])).imag
    # a corner on a side to rounding does not cross it
    rounding = 8.0 * EPSILON * np.abs(side)[:, None] * np.abs(z).max(initial=0.0)
    left = np.where(np.abs(area) > rounding, np.sign(area), 0.0)
    parted = left * np.roll(left, -1, axis=1) < 0  # the ends of each side by each other one
    return np.argwhere(parted & parted.T)


def _is_flat(corners: Sequence[Point]) -> bool:
    """Whether all corners lie on one line."""
    (x, y), *others = corners
    ways = [(u - x, v - y) for u, v in others]
    return all(a * d - c * b == 0 for (a, b), (c, d) in combinations(ways, 2))
