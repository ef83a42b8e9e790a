"""Coordinates of the points of a drawing, and their travel over a motion."""

from __future__ import annotations

import cmath
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from linkwork.core.drawing.scene import text_width
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.errors import InputError, choices
from linkwork.core.foundation.lanes import phase
from linkwork.core.foundation.names import GROUND, pretty
from linkwork.core.mechanism.bodies import Contour, DiscFigure, Guide
from linkwork.core.mechanism.part.guides import Strut
from linkwork.core.mechanism.skeleton import Skeleton
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from linkwork.core.results.quantity import Units

Path = ComplexArray
Real = Array

_UNSEEN = 1e-9  # of the size of a drawing
_STILL = 1e-6  # of the largest travel: points that move less are fixed


@dataclass(frozen=True)
class Travel:
    """A length at this pose, and its minimum and maximum over the motion."""

    now: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class Pose:
    """Coordinates x + iy of all points in one position, and over the motion if given.

    ``paths`` have one entry per row of the motion, NaN without a position; ``rates`` are their
    first and second derivatives. ``angles`` are the current angles of the links [rad].
    """

    skeleton: Skeleton
    points: dict[str, complex]
    paths: dict[str, Path]
    angles: dict[str, float] = field(default_factory=dict)
    rates: dict[str, tuple[Path, Path]] = field(default_factory=dict)

    @classmethod
    def of(cls, position: Position, motion: Motion | None, *, bare: bool = False) -> Pose:
        """The pose of a found position; a ``bare`` one may have no points.

        Raises
        ------
        InputError
            If the position was not found, has no points, or the motion is of another mechanism.
        """
        _check(position, motion, bare)
        points = {name: complex(*place) for name, place in position.points.items()}
        paths = {} if motion is None else {name: _path(motion, name) for name in points}
        radians = position.units.angle.radians
        angles = {name: value * radians for name, value in position.links.items()}
        rates = {} if motion is None else _rates(motion)
        return cls(
            skeleton=position.skeleton, points=points, paths=paths, angles=angles, rates=rates
        )

    @classmethod
    def still(cls, skeleton: Skeleton, points: Mapping[str, complex]) -> Pose:
        """The pose of points that need not be a position; every link points to its second point.

        Points at one place are drawn apart by less than can be seen, for lines need a direction.
        """
        points = _apart(points)
        angles = {
            bar.name: phase(points[bar.points[1]] - points[bar.points[0]])
            if len(bar.points) > 1
            else 0.0
            for bar in skeleton.bars
        }
        return cls(skeleton=skeleton, points=points, paths={}, angles=angles)

    @classmethod
    def at_row(cls, motion: Motion, row: int) -> Pose:
        """The pose of a found row of a motion."""
        paths = {name: _path(motion, name) for name in motion.points}
        still = cls(skeleton=motion.skeleton, points={}, paths=paths, rates=_rates(motion))
        return still.moved_to(motion, row)

    def moved_to(self, motion: Motion, row: int) -> Pose:
        """The pose of another row of the motion."""
        points = {name: complex(path[row]) for name, path in self.paths.items()}
        radians = motion.units.angle.radians
        angles = {name: float(series.value[row]) * radians for name, series in motion.links.items()}
        return replace(self, points=points, angles=angles)

    def angle(self, link: str) -> float:
        """The angle of a link [rad]; not for ground."""
        return 0.0 if link == GROUND else self.angles[link]

    def placed(self, contour: Contour) -> ComplexArray:
        """The points of a cam's outline or of a curve at the current position."""
        turned = cmath.exp(1j * self.angle(contour.link))
        points: ComplexArray = self.points[contour.center] + turned * np.array(contour.points)
        return points

    def moves(self, point: str) -> bool:
        """Whether a point moves over the motion; false without a motion."""
        return point in self.moving

    def direction(self, guide: Guide) -> complex:
        """The unit vector of a guide's line."""
        along = self.points[guide.line[1]] - self.points[guide.line[0]]
        return along / abs(along)

    def displacement(self, guide: Guide) -> Travel:
        """The displacement of a guide's point from the first point of the line."""
        return travel_along(self, guide.point, guide.line)

    def length(self, strut: Strut) -> Travel:
        """The length of a cylinder."""
        start, end = strut.between
        now = abs(self.points[end] - self.points[start])
        if not self.paths:
            return Travel(now, now, now)
        return _travel(now, np.abs(self.paths[end] - self.paths[start]))

    def on_ground(self, guide: Guide) -> bool:
        """Whether the line of a guide is fixed."""
        return guide.on == GROUND or set(guide.line) <= set(self.skeleton.fixed)

    @property
    def gaps(self) -> Iterator[float]:
        """Constant distances between pins: within links and within ground."""
        skeleton = self.skeleton
        joined = {*skeleton.pins, *skeleton.fixed, *(p for s in skeleton.struts for p in s.between)}
        joined -= self.construction
        for names in (skeleton.fixed, *(bar.points for bar in skeleton.bars)):
            places = [self.points[name] for name in names if name in joined]
            yield from (abs(a - b) for k, a in enumerate(places) for b in places[:k])

    @cached_property
    def construction(self) -> set[str]:
        """Points that only define a fixed line and are not drawn."""
        skeleton = self.skeleton
        used = {point for bar in skeleton.bars for point in bar.points}
        used |= {point for strut in skeleton.struts for point in strut.between}
        used |= {point for figure in skeleton.figures for point in figure.ends}
        used |= {guide.point for guide in skeleton.guides} | set(skeleton.traced)
        used |= {disc.center for disc in skeleton.of(DiscFigure)}
        lines = {p for g in skeleton.guides if self.on_ground(g) for p in g.line}
        lines |= {point for figure in skeleton.figures for point in figure.laid_by}
        return lines - used

    @cached_property
    def moving(self) -> set[str]:
        """The points that move over the motion."""
        travel = {
            name: float(np.nanmax(np.abs(path - self.points[name]), initial=0.0))
            for name, path in self.paths.items()
        }
        most = max(travel.values(), default=0.0)
        return {name for name, far in travel.items() if far > _STILL * most}


def travel_along(pose: Pose, point: str, line: tuple[str, str]) -> Travel:
    """The displacement of a point along a line, from its first point."""
    start, end = line
    p, a, b = (pose.points[name] for name in (point, start, end))
    now = float(_along(*(np.array([z]) for z in (p, a, b)))[0])
    if not pose.paths:
        return Travel(now, now, now)
    return _travel(now, _along(pose.paths[point], pose.paths[start], pose.paths[end]))


def no_points(mechanism: str) -> InputError:
    """The message for a mechanism without points."""
    return InputError(
        f'"{mechanism}" has no points to draw: add [points] with the coordinates of its pins'
    )


def _check(position: Position, motion: Motion | None, bare: bool) -> None:
    if not position.status.ok:
        raise InputError(
            f'"{position.mechanism}" has no position to draw at this input value: '
            f"{position.message or position.status.value}"
        )
    if not position.points and not bare:
        raise no_points(position.mechanism)
    bad = [name for name, place in position.points.items() if not np.isfinite(place).all()]
    if bad:
        raise InputError(f"points without coordinates cannot be drawn: {', '.join(bad)}")
    lost = [name for name in _named(position.skeleton) if name not in position.points]
    if lost:
        raise InputError(
            f"links and joints name points without coordinates: {', '.join(lost)} "
            + choices("points", position.points)
        )
    for guide in position.skeleton.guides:
        start, end = guide.line
        if position.points[start] == position.points[end]:
            raise InputError(
                f'the line of "{guide.name}" has no direction: points {start} and {end} coincide'
            )
    if motion is not None and set(motion.points) != set(position.points):
        raise InputError(
            f'position and motion are of different mechanisms: "{position.mechanism}" with points '
            f'{", ".join(position.points)}; "{motion.mechanism}" with {", ".join(motion.points)}'
        )


def _named(skeleton: Skeleton) -> dict[str, None]:
    names = [*skeleton.fixed, *skeleton.pins, *skeleton.traced]
    names += [point for bar in skeleton.bars for point in bar.points]
    names += [point for strut in skeleton.struts for point in strut.between]
    names += [point for figure in skeleton.figures for point in figure.ends]
    names += [point for guide in skeleton.guides for point in (guide.point, *guide.line)]
    return dict.fromkeys(names)


def _apart(points: Mapping[str, complex]) -> dict[str, complex]:
    size = max((abs(place) for place in points.values()), default=0.0) or 1.0
    found: dict[complex, str] = {}
    for name, place in points.items():
        own = place
        while own in found:
            own += _UNSEEN * size
        found[own] = name
    return {name: place for place, name in found.items()}


def _path(motion: Motion, name: str) -> Path:
    path: Path = np.where(motion.found, motion.trace(name), complex(np.nan, np.nan))
    return path


def _rates(motion: Motion) -> dict[str, tuple[Path, Path]]:
    """First and second derivatives of the paths of all points."""
    jets = {name: motion.place(name) for name in motion.points}
    return {name: (jet.d1, jet.d2) for name, jet in jets.items()}


def _along(p: Path, a: Path, b: Path) -> Real:
    """The displacement of p from a in the direction of b, all (N,)."""
    line = b - a
    far: Real = ((p - a) * np.conj(line)).real / np.abs(line)
    return far


def _travel(now: float, rows: Real) -> Travel:
    found = rows[np.isfinite(rows)]
    return Travel(now, float(np.min(found, initial=now)), float(np.max(found, initial=now)))


# ----------------------------------------------------------------------
# Names and values as printed in figures.


_INDEX = re.compile(r"(?<=[^\W\d_])\d+(?![.\d])")  # after a letter
_SUBSCRIPT = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


@lru_cache(maxsize=4096)  # asked for again and again while a dimension is dragged
def printed_name(name: str) -> str:
    """A name as printed in a figure: ``theta12`` → ``θ₁₂``, ``O2.x`` → ``O₂.x``."""
    point, _, axis = name.rpartition(".")
    if point and axis[:1].isalpha():
        return f"{printed_name(point)}.{axis.replace('_', ' ')}"
    shown = pretty(name)
    stem = shown.rstrip("0123456789'")
    return stem + shown[len(stem) :].translate(_SUBSCRIPT) if stem else shown


def printed_formula(text: str) -> str:
    """A formula as printed in a figure: ``(a4 - b4)∠θ14`` → ``(a₄ − b₄)∠θ₁₄``."""
    return _INDEX.sub(lambda found: found[0].translate(_SUBSCRIPT), text).replace("-", "\u2212")


def printed_value(value: float, unit: str, units: Units) -> str:
    """A number with its unit, to six digits: ``60°``, ``100 mm``."""
    sign = units.angle.sign if unit == units.angle.value else f" {unit}"
    shown = value + 0.0  # no negative zero
    return f"{shown:.6g}{sign}".rstrip().replace("-", "\u2212")


def inputs_caption(
    values: Mapping[str, float], input_units: Mapping[str, str], units: Units
) -> str:
    """Input values with units: ``θ₂ = 60°, s = 100 mm``."""
    return ", ".join(
        f"{printed_name(name)} = {printed_value(value, input_units.get(name, ''), units)}"
        for name, value in values.items()
    )


def lines_within(text: str, width: float) -> list[str]:
    """Break a text into lines of at most ``width`` [em]; longer words are broken."""
    lines: list[str] = []
    for word in text.split():
        if lines and text_width(f"{lines[-1]} {word}", 1.0) <= width:
            lines[-1] += f" {word}"
            continue
        lines.append("")
        for letter in word:
            if lines[-1] and text_width(lines[-1] + letter, 1.0) > width:
                lines.append("")
            lines[-1] += letter
    return lines


def lead_text(motion: Motion, row: int) -> str:
    """The leading input at a row: ``148.131°``; with its name if there are several."""
    name, values = _lead(motion)
    text = printed_value(float(values[row]), motion.input_units[name], motion.units)
    return f"{printed_name(name)} = {text}" if len(motion.inputs) > 1 else text


def reached_caption(motion: Motion) -> str:
    """The ranges of the leading input in which positions were found: ``0° to 149.6°, 201.3° to
    360°``.

    Rows that were not found leave a gap; branches reached only around the circuit are omitted.
    """
    name, values = _lead(motion)
    home = {branch for branch, asked in zip(motion.branch, motion.asked, strict=True) if asked}
    rows = np.flatnonzero(motion.found & np.array([branch in home for branch in motion.branch]))
    runs = np.split(values[rows], np.flatnonzero(np.diff(rows) > 1) + 1)
    stretches: list[tuple[float, float]] = []
    for low, high in sorted((float(run.min()), float(run.max())) for run in runs):
        if stretches and low <= stretches[-1][1]:
            low, before = stretches.pop()
            high = max(high, before)
        stretches.append((low, high))
    shown = [
        [printed_value(end, motion.input_units[name], motion.units) for end in stretch]
        for stretch in stretches
    ]
    text = ", ".join(low if low == high else f"{low} to {high}" for low, high in shown)
    return f"{printed_name(name)} {text}" if len(motion.inputs) > 1 else text


def _lead(motion: Motion) -> tuple[str, Array]:
    """The first input that varies."""
    return next(
        ((name, values) for name, values in motion.inputs.items() if np.ptp(values[motion.asked])),
        next(iter(motion.inputs.items())),
    )
