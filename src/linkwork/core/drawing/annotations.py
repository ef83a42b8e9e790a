"""Annotations drawn over a mechanism: arrows, centres and dimensions, with their names."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from linkwork.core.drawing.labels import Choice, places_beside
from linkwork.core.drawing.pose import Pose, printed_name
from linkwork.core.drawing.scene import (
    Box,
    Measures,
    Primitive,
    Role,
    drawn_disc,
    drawn_line,
    round_up,
)
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices, internal
from linkwork.core.foundation.values import check_values
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position, VectorLoop
from linkwork.core.results.quantity import Kind, Rate

SCALES = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)


@dataclass(frozen=True, kw_only=True)
class Annotation:
    """One kind of annotation.

    Parameters
    ----------
    drawn : list of Primitive
    names : list of Choice
        Texts whose positions are chosen when everything else is drawn.
    caption : str
        Explanation such as the scale of arrows; "" if none.
    """

    drawn: list[Primitive] = field(default_factory=list)
    names: list[Choice] = field(default_factory=list)
    caption: str = ""

    @classmethod
    def joined(cls, parts: Iterable[Annotation]) -> Annotation:
        """Combine several annotations."""
        every = list(parts)
        return cls(
            drawn=[primitive for part in every for primitive in part.drawn],
            names=[name for part in every for name in part.names],
            caption="; ".join(part.caption for part in every if part.caption),
        )


# ----------------------------------------------------------------------
# The positions of a task: rings with their numbers, and the directions of the body in poses.


_RING = 1.9  # radius of a ring [pins]
_SMALL_RING = 0.8  # where positions are many
_ARM = 7.0  # length of the line along the body's x axis [pins]
_FEW = 12  # positions; the numbers of more cover each other: the first one shows the start


@dataclass(frozen=True, kw_only=True)
class PositionMark:
    """A position that a design should pass.

    ``place``: the wanted point [length]; ``direction``: a unit vector along the x axis of the body,
    none if its angle is free.
    """

    place: complex
    direction: complex | None = None


def position_marks(marks: Sequence[PositionMark], measures: Measures) -> Annotation:
    """A ring at every position, a line along the body in poses, and numbers in order of travel."""
    drawn: list[Primitive] = []
    few = len(marks) <= _FEW
    ring = (_RING if few else _SMALL_RING) * measures.pin
    for number, mark in enumerate(marks, start=1):
        of = str(number)
        drawn.append(drawn_disc(Role.POSITION, of, mark.place, ring))
        if mark.direction is not None:
            ends = (mark.place + far * mark.direction for far in (ring, _ARM * measures.pin))
            drawn.append(drawn_line(Role.POSITION, of, ends))
    numbered = marks if few else marks[:1]
    names = [
        places_beside(Role.POSITION_NAME, str(k), str(k), mark.place, 0.8 * measures.text, measures)
        for k, mark in enumerate(numbered, start=1)
    ]
    return Annotation(drawn=drawn, names=names)


# ----------------------------------------------------------------------
# Optional contents of a picture.


@internal("vectors", "positions", "within")
@dataclass(frozen=True, kw_only=True)
class SceneOptions:
    """Optional contents of a picture.

    Parameters
    ----------
    link_names : bool
        Write the names of links.
    arrows : bool
        Draw arrows of the inputs.
    further : int
        Approximate number of faint further positions of the motion; if positive, dead points and
        change points are marked.
    title : str, optional
        Replaces the mechanism's name; an empty title omits it.
    larger : float
        Enlargement of names, for small pictures; symbols grow by its square root.
    vectors : tuple of VectorLoop
        The loop equations as vectors, head to tail over the faded mechanism, from
        :func:`linkwork.core.motion.iterating` for this position. Also for mechanisms without
        points.
    velocities, accelerations : bool
        Arrows at moving points.
    forces : tuple of Force
        Arrows of these forces at their points.
    speed : bool
        Colour the paths of points by their speed, with a scale.
    centres : bool
        Mark the instant centres of all pairs of links.
    centrodes : tuple of str
        The links whose centrodes are shown, over the motion.
    dimensions : bool
        Lengths of links, radii of wheels and the input as dimension lines.
    positions : tuple of PositionMark
        Positions of a task that the mechanism should pass, numbered in order of travel.
    within : Box, optional
        The minimum extent of the picture, and the reference for sizes of symbols: use the same for
        all pictures of an animation, from
        :func:`~linkwork.core.drawing.mechanism_scene.reach_of`.

    Examples
    --------
    >>> import linkwork as lw
    >>> options = lw.SceneOptions(dimensions=True, velocities=True)
    >>> lw.example("four-bar").scene(at=60, options=options).title
    'Four-bar linkage, open'
    """

    link_names: bool = False
    arrows: bool = True
    further: int = 0
    larger: float = 1.0
    title: str | None = None
    vectors: tuple[VectorLoop, ...] = ()
    velocities: bool = False
    accelerations: bool = False
    forces: tuple[Force, ...] = ()
    speed: bool = False
    centres: bool = False
    centrodes: tuple[str, ...] = ()
    dimensions: bool = False
    positions: tuple[PositionMark, ...] = ()
    within: Box | None = None


# ----------------------------------------------------------------------
# Arrows at points with equal scale, and their names.


#: Length of the longest arrow of a motion over the drawn size.
LONGEST = 0.3

_SHORTEST = 1.5  # in pin radii: shorter arrows would be hidden by the pin


#: Letters of the names of arrows.
_LETTERS = {Role.VELOCITY: "v", Role.ACCELERATION: "a", Role.FORCE: "F"}


def point_arrows(
    vectors: Mapping[str, complex],
    points: Mapping[str, complex],
    scale: float,
    role: Role,
    measures: Measures,
) -> tuple[Annotation, list[str]]:
    """Arrows from points, and the points whose arrows are too short to draw.

    Parameters
    ----------
    vectors : Mapping[str, complex]
        By point, x + iy.
    scale : float
        Drawn length per magnitude.
    """
    drawn: list[Primitive] = []
    names: list[Choice] = []
    short: list[str] = []
    for name, vector in vectors.items():
        tail = points[name]
        tip = tail + scale * vector
        if abs(tip - tail) < _SHORTEST * measures.pin:
            short.append(printed_name(name))
            continue
        # the head of a short arrow would hide its line
        head = min(measures.head, 0.5 * abs(tip - tail))
        drawn.append(drawn_line(role, name, (tail, tip), head=head))
        text, name_role = f"{_LETTERS[role]}({printed_name(name)})", Role[f"{role.name}_NAME"]
        names.append(places_beside(name_role, name, text, tip, 0.8 * measures.text, measures))
    return Annotation(drawn=drawn, names=names), short


def scale_caption(word: str, scale: float, length_unit: str, unit: str, size: float) -> str:
    """The scale of arrows: ``velocity scale: 20 mm = 500 mm/s``.

    Parameters
    ----------
    word : str
        The quantity shown by the arrows.
    scale : float
        Drawn length per magnitude of the quantity.
    size : float
        Size of the drawing.
    """
    # Both numbers have few digits: the scale is a round number, the length a power of ten.
    length = 10.0 ** math.floor(math.log10(0.3 * size))
    shown = f"{length:g} {length_unit}".rstrip()
    return f"{word} scale: {shown} = {length / scale:.4g} {unit}".rstrip()


# ----------------------------------------------------------------------
# Velocities and accelerations as arrows at points.
#
# All arrows of all pictures of a motion have the same scale, a round number of length units per
# unit of the rate; the longest arrow of the motion is at most
# :data:`LONGEST` of the drawn size. If rates are unbounded, as near
# a dead point, the fastest rows are ignored, unless the drawn position is one of these.


_WORD = {1: "velocity", 2: "acceleration"}
_RATE_ROLES = {1: Role.VELOCITY, 2: Role.ACCELERATION}
_FAST = 0.95  # share of the rows that are not counted as fastest
_BEYOND = 3.0  # speed ratio to the others for rows near a dead point


def rate_arrows(
    position: Position, motion: Motion | None, pose: Pose, measures: Measures, order: int
) -> Annotation:
    """Arrows of the velocity (order 1) or acceleration (2) of every moving point.

    Derivatives are with respect to time if the input has a speed, otherwise to the input.

    Raises
    ------
    InputError
        If these rates do not exist, as at a dead point.
    """
    rates = _rates(position, pose, order)
    by_time = bool(position.velocity)
    most = max(abs(rate) for rate in rates.values())
    if motion is not None:
        rows = [
            np.abs(motion.trace(f"{name}.{rate_of(order, by_time).value}"))[motion.found]
            for name in rates
        ]
        most = max(usual_most(np.concatenate(rows)), most)
    if not most:
        return Annotation(caption=f"{_WORD[order]}: none, no point moves")
    scale = 1.0 / round_up(most / (LONGEST * measures.size), SCALES)
    arrows, short = point_arrows(rates, pose.points, scale, _RATE_ROLES[order], measures)
    rate = rate_of(order, by_time)
    unit = rate.unit(Kind.LENGTH, position.units, position.derivative_unit).replace("^2", "²")
    caption = scale_caption(_WORD[order], scale, position.units.length, unit, measures.size)
    if short:
        caption += f" (too short to draw: {', '.join(short)})"
    return replace(arrows, caption=caption)


def rate_of(order: int, by_time: bool) -> Rate:
    """The rate of this order with respect to time or the input."""
    if by_time:
        return Rate.VELOCITY if order == 1 else Rate.ACCELERATION
    return Rate.FIRST if order == 1 else Rate.SECOND


def usual_most(sizes: np.ndarray) -> float:
    """The largest of sizes (N,), ignoring rows near a dead point; 0 if empty."""
    finite = sizes[np.isfinite(sizes)]
    if not len(finite):
        return 0.0
    usual = float(np.quantile(finite, _FAST))
    most = float(finite.max())
    return usual if usual and most > _BEYOND * usual else most


def _rates(position: Position, pose: Pose, order: int) -> dict[str, complex]:
    """The rates of all drawn moving points."""
    by_time, by_input = (
        (position.velocity, position.first) if order == 1
        else (position.acceleration, position.second)
    )  # fmt: skip
    table = by_time or by_input
    found = {
        name: complex(table[f"{name}.x"], table[f"{name}.y"])
        for name in pose.points
        if name not in pose.construction and name not in pose.skeleton.fixed
        and f"{name}.x" in table
    }  # fmt: skip
    bad = [name for name, rate in found.items() if not np.isfinite(rate)]
    if bad or not found:
        why = (
            f"not that of {', '.join(bad)}: the input is at a dead point" if bad else "of no point"
        )
        raise InputError(
            f'"{position.mechanism}" has no {_WORD[order]} to draw at this input value ({why})'
        )
    return found


# ----------------------------------------------------------------------
# Forces as arrows at their points of application.
#
# All arrows have the same scale, a round number of length units per unit of force; the longest is
# at most :data:`LONGEST` of the drawn size. Several forces at one
# point are drawn separately.


def force_arrows(
    forces: Sequence[Force], pose: Pose, length_unit: str, measures: Measures
) -> Annotation:
    """Arrows of forces, their tails at the points.

    Raises
    ------
    UnknownNameError
        If a point does not exist.
    InputError
        If forces have different units.
    """
    check_forces(forces, pose.points)
    most = max(abs(complex(force.x, force.y)) for force in forces)
    if not most:
        return Annotation(caption="force: all are zero")
    scale = 1.0 / round_up(most / (LONGEST * measures.size), SCALES)
    parts = []
    for force in forces:
        vector = {force.at: complex(force.x, force.y)}
        parts.append(point_arrows(vector, pose.points, scale, Role.FORCE, measures)[0])
    caption = scale_caption("force", scale, length_unit, force_unit(forces), measures.size)
    drawn = {primitive.of for part in parts for primitive in part.drawn}
    hidden_at = [force.at for force in forces if force.at not in drawn]
    if hidden_at:
        listed = ", ".join(map(printed_name, dict.fromkeys(hidden_at)))
        caption += f" (too short to draw: {listed})"
    return Annotation.joined([*parts, Annotation(caption=caption)])


@dataclass(frozen=True, kw_only=True)
class Force:
    """A force at a point, for drawings and pages; it is given, not computed.

    Parameters
    ----------
    at : str
        The name of the point.
    x, y : float
        Components along the axes of the ground, in ``unit``.
    unit : str
        For example ``N``; all forces of a picture have the same unit.

    Raises
    ------
    InputError
        If a component is not finite.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.forces.Force(at="B", x=0, y=-981, unit="N")
    Force(at='B', x=0, y=-981, unit='N')
    """

    at: str
    x: float
    y: float
    unit: str = ""

    def __post_init__(self) -> None:
        check_values(self)
        if not (math.isfinite(self.x) and math.isfinite(self.y)):
            raise InputError(f"the force at {self.at} is not finite: {self.x:g}, {self.y:g}")


def force_unit(forces: Iterable[Force]) -> str:
    """The unit that all forces have.

    Raises
    ------
    InputError
        If they have different ones.
    """
    units = dict.fromkeys(force.unit for force in forces)
    if len(units) > 1:
        listed = ", ".join(unit or "none" for unit in units)
        raise InputError(f"forces of one picture need one unit, these have several: {listed}")
    return next(iter(units), "")


def check_forces(forces: Iterable[Force], points: Iterable[str]) -> None:
    """Refuse forces at points that are not there, and units that differ.

    Raises
    ------
    UnknownNameError, InputError
    """
    known, every = tuple(points), tuple(forces)
    for force in every:
        if force.at not in known:
            raise UnknownNameError(
                f'there is no point "{force.at}" for a force {choices("points", known, force.at)}'
            )
    force_unit(every)
