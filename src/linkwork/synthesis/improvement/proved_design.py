"""The least transmission angle of a whole motion, and whether links keep clear of circles in it.

Both are proved in boxes around the rows, :mod:`linkwork.core.motion.extremes`, which are halved
where they do not decide.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import (
    PROOF_SLACK,
    Array,
    BoolArray,
    ComplexArray,
    FrozenDict,
    IndexArray,
)
from linkwork.core.foundation.errors import LinkworkError, internal
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.values import told_beside
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.skeleton import Dyad
from linkwork.core.mechanism.varied_numbers import VariedNumber, with_numbers
from linkwork.core.motion.extremes import (
    Boxes,
    PointMotions,
    boxes_of,
    motions_of_points,
    refined,
    variables_of,
)
from linkwork.core.motion.model import Model, model_of
from linkwork.core.motion.sweeping import sweep
from linkwork.core.results.motion import Motion, branch_end
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.synthesis.improvement.fit_problem import FittedNumbers, Fitting, path_misses
from linkwork.synthesis.improvement.goals import PathGoal
from linkwork.synthesis.lane_least_squares import Box

_MOST_BOXES = 20_000  # that a proof may take, besides those of the rows
_MOST_OF_ANGLES = 60_000  # the same, for dyads that stay near a dead point
_CLOSE = 1e-6  # rad: between the bounds of the least angle, unless the required one is between them
_WHOLE_MOTION_ROUNDING = 1e-12  # rad: of angles in proved positions
#: Below this least transmission angle a design is at a dead point, for all that play allows.
_DEAD = math.radians(0.1)
_LOOKED_AT = math.radians(5.0)  # least angles of rows, between which a smaller one may be


@dataclass(frozen=True, kw_only=True)
class LeastAngle:
    """The least angle is between ``low`` and ``high`` [rad], the angle at the input ``at``."""

    low: float
    high: float
    at: float


@dataclass(frozen=True, kw_only=True)
class Contact:
    """``met``: a side that meets a circle, and the input there, if any; ``open``: the interval
    of the input in which contact is not excluded.
    """

    met: tuple[int, float] | None
    open: tuple[float, float] | None


class WholeMotion:
    """The motion between all rows, which are proved to be on one branch; inputs in file units.

    Parameters
    ----------
    model : Model
        Driven by its inputs, not by a law of time.
    motion : Motion
    """

    def __init__(self, model: Model, motion: Motion) -> None:
        self.model, self.motion = model, motion
        self._number = {name: k for k, name in enumerate(model.compiled.points.names)}
        self._least: dict[float, LeastAngle] = {}
        self._contacts: dict[bytes, Contact] = {}

    @classmethod
    def of(cls, model: Model, motion: Motion) -> WholeMotion | None:
        """That of a motion, if all its rows and the steps between them are proved.

        A law of time says nothing about inputs between rows.
        """
        proved = (
            model.untimed is None and branch_end(motion) is None and bool(motion.certified.all())
        )
        return cls(model, motion) if proved else None

    @cached_property
    def boxes(self) -> Boxes:
        """One around every row."""
        return boxes_of(self.model, self.motion, variables_of(self.model, self.motion))

    @property
    def _unit(self) -> float:
        return float(self.model.input_scale[self.boxes.lead])

    @cached_property
    def dyads(self) -> tuple[Dyad, ...]:
        """The dyads with a transmission angle, one for each pin."""
        dyads: dict[str, Dyad] = {}
        for dyad in self.model.motion_quantities.names.dyads:
            dyads.setdefault(dyad.pin, dyad)
        return tuple(dyads.values())

    def least_transmission(self, least_wanted: float) -> LeastAngle:
        """The least transmission angle of all dyads, of which there is at least one, folded to 0 to
        a quarter of a turn; ``least_wanted``: decide whether it is smaller than this [rad].
        """
        if least_wanted not in self._least:
            self._least[least_wanted] = self._least_transmission(least_wanted)
        return self._least[least_wanted]

    def _least_transmission(self, least_wanted: float) -> LeastAngle:
        best, place, lowest = np.inf, np.nan, np.inf

        def decide(boxes: Boxes) -> BoolArray:
            nonlocal best, place, lowest
            middle, low = self._angles(boxes)
            seen = np.where(boxes.known, middle, np.inf)
            k = int(seen.argmin())
            if seen[k] < best:
                best, place = float(seen[k]), float(boxes.leading[k])
            decided = low >= best - _CLOSE
            if best >= least_wanted - _WHOLE_MOTION_ROUNDING:
                decided &= low >= least_wanted
            lowest = min(lowest, float(low[decided].min(initial=np.inf)))
            return np.asarray(decided)

        most = len(self.boxes) + _MOST_OF_ANGLES
        left = refined(self.model, self.boxes, decide, most=most)
        lowest = min(lowest, float(self._angles(left)[1].min(initial=np.inf)))
        return LeastAngle(low=lowest, high=best, at=place / self._unit)

    def _angles(self, boxes: Boxes) -> tuple[Array, Array]:
        """The least transmission angle in the middle of boxes, and a lower bound of it in them."""
        motions = motions_of_points(self.model, boxes)
        middles, lows = [], []
        with np.errstate(all="ignore"):  # bounds of boxes without a proof are infinite
            for dyad in self.dyads:
                one, rate, error = self._direction(motions, boxes.span, dyad.pin, dyad.arms[0])
                if dyad.guide is None:
                    ends, turned = (dyad.pin, dyad.arms[1]), 0.0
                else:
                    # the block passes its force on across its line
                    ends, turned = dyad.guide.line, 0.5 * np.pi
                two, rate_of_two, error_of_two = self._direction(motions, boxes.span, *ends)
                angle = one - two - turned
                reach = np.abs(rate - rate_of_two) * boxes.span + error + error_of_two
                reach = np.where(boxes.holds, reach * PROOF_SLACK, np.inf)
                middles.append(_folded(angle))
                lows.append(_least_folded(angle, reach))
        return np.min(middles, axis=0), np.min(lows, axis=0)

    def _direction(
        self, motions: PointMotions, span: Array, start: str, end: str
    ) -> tuple[Array, Array, Array]:
        """The angle and the rate of the line between two points in the middle of boxes, and how far
        it is from turning evenly [rad], (B,) each.
        """
        a, b = self._number[start], self._number[end]
        line = motions.place[:, b] - motions.place[:, a]
        rate = (motions.rate[:, b] - motions.rate[:, a]) / line
        turned = np.abs(rate) * span
        rest = 1.0 - turned
        lost = (motions.bend[:, a] + motions.bend[:, b]) / np.abs(line)
        # eq. (192)
        error = 0.5 * turned**2 / rest + np.arcsin(np.minimum(lost / rest, 1.0))
        error = np.where((rest > 0.0) & (lost < rest), error, np.inf)
        return np.angle(line), rate.imag, error

    def contact(self, sides: Sequence[tuple[str, str]], circles: Array) -> Contact:
        """Whether sides between two points of a link come into circles.

        Parameters
        ----------
        sides : sequence of (str, str)
        circles : (M, 3)
            x, y, radius [length].
        """
        key = circles.tobytes()
        if key not in self._contacts:
            self._contacts[key] = self._contact(sides, circles)
        return self._contacts[key]

    def _contact(self, sides: Sequence[tuple[str, str]], circles: Array) -> Contact:
        ends = np.array([[self._number[p] for p in side] for side in sides], dtype=np.intp)
        met: list[tuple[float, int, float]] = []

        def decide(boxes: Boxes) -> BoolArray | None:
            motions = motions_of_points(self.model, boxes)
            clear = boxes.holds.copy()
            with np.errstate(all="ignore"):
                for x, y, radius in circles:
                    middle, low = _gaps(motions, boxes.span, ends, complex(x, y))
                    inside = np.where(boxes.known[:, None], middle - radius, np.inf)
                    k, side = np.unravel_index(inside.argmin(), inside.shape)
                    if inside[k, side] <= 0.0:
                        met.append((float(inside[k, side]), int(side), float(boxes.leading[k])))
                    clear &= (low > radius).all(axis=1)
            return None if met else clear

        left = refined(self.model, self.boxes, decide, most=len(self.boxes) + _MOST_BOXES)
        if met:
            _, side, place = min(met)
            return Contact(met=(side, place / self._unit), open=None)
        if not len(left):
            return Contact(met=None, open=None)
        low, high = (end / self._unit for end in left.ends)
        return Contact(met=None, open=(float(low.min()), float(high.max())))


def _folded(angle: Array) -> Array:
    """Angles between lines without a direction, 0 to a quarter of a turn: 40° and 140° transmit
    equally well.
    """
    return np.asarray(np.abs(angle - np.pi * np.round(angle / np.pi)))


def _least_folded(angle: Array, reach: Array) -> Array:
    """The least folded angle within ``reach`` of these angles; 0 where it is unknown."""
    first, last = angle - reach, angle + reach
    passed = ~(np.floor(first / np.pi) == np.floor(last / np.pi))
    return np.where(passed, 0.0, np.minimum(_folded(first), _folded(last)))


def _gaps(
    motions: PointMotions, span: Array, ends: IndexArray, centre: complex
) -> tuple[Array, Array]:
    """The distances of S sides from a point in the middle of boxes, and lower bounds, (B, S)."""
    span = span[:, None]
    (a, b), (da, db) = ((z[:, ends[:, 0]] - c, z[:, ends[:, 1]] - c) for z, c in (
        (motions.place, centre), (motions.rate, 0.0)
    ))  # fmt: skip
    lost_a, lost_b = motions.bend[:, ends[:, 0]], motions.bend[:, ends[:, 1]]
    line, turning = b - a, db - da
    square = line.real**2 + line.imag**2
    share = np.where(square > 0.0, np.clip(-_dot(line, a) / square, 0.0, 1.0), 0.0)
    nearest = a + share * line
    away = np.abs(nearest)
    # across a fixed line between the point and the side, eq. (193)
    across = nearest / away
    across_a = _dot(across, a) - np.abs(_dot(across, da)) * span - lost_a
    across_b = _dot(across, b) - np.abs(_dot(across, db)) * span - lost_b
    low = np.minimum(across_a, across_b)
    # from the line of the side, eq. (194)
    longest = np.sqrt(
        square + 2.0 * np.abs(_dot(line, turning)) * span + np.abs(turning) ** 2 * span**2
    )
    lost = lost_a + lost_b
    error = longest * lost_a + (np.abs(a) + np.abs(da) * span + lost_a) * lost
    moved = np.abs(_cross(turning, a) + _cross(line, da)) * span
    bent = np.abs(_cross(turning, da)) * span**2
    from_line = (np.abs(_cross(line, a)) - moved - bent - error) / (longest + lost)
    return away, np.fmax(low, from_line) / PROOF_SLACK


def _dot(z: ComplexArray, w: ComplexArray) -> Array:
    return np.asarray(z.real * w.real + z.imag * w.imag)


def _cross(z: ComplexArray, w: ComplexArray) -> Array:
    return np.asarray(z.real * w.imag - z.imag * w.real)


def least_in_rows(motion: Motion) -> float:
    """The least transmission angle of all dyads in the rows that have a position, NaN without one
    [file's angle unit].
    """
    half = motion.units.angle.turn / 2.0
    names = [n for n, a in motion.quantities.derived.items() if a.row is TRANSMISSION_ANGLE]
    # 40° and 140° transmit equally well
    rows = [np.minimum(angle, half - angle) for angle in (motion[n][motion.found] for n in names)]
    return min((float(angle.min()) for angle in rows if len(angle)), default=float("nan"))


def nearly_dead(motion: Motion, whole: WholeMotion | None) -> str:
    """That a motion all but reaches a dead point, in words; "" if its transmission angles are not
    that small.
    """
    unit = motion.units.angle
    least, place = least_in_rows(motion) * unit.radians, ""
    if whole is not None and whole.dyads and least < _LOOKED_AT:
        angle = whole.least_transmission(_DEAD)
        lead = motion.quantities.names.lead
        # where smaller angles are not excluded, they count
        least, place = angle.low, f" near {lead} = {angle.at:.6g} {motion.input_units[lead]}"
        least = angle.high if angle.high < _DEAD else least
    if not least < _DEAD:
        return ""
    shown = f"{unit.from_radians(least):.2g}{unit.sign}"
    bound = (
        f"{shown} or less is not excluded" if place and angle.high >= _DEAD else f"down to {shown}"
    )
    return f"nearly a dead point: transmission angle {bound}{place}"


# ----------------------------------------------------------------------
# How far a point can be from the fixed pivots of a mechanism, whatever its numbers.
#
# A point is joined to a pivot by sides of links, each no longer than the upper bound of its length:
# it is never farther away than the shortest such chain.


_REACH_ROUNDING = 1e-9  # relative


class Reach:
    """The reach of points from fixed pivots, for numbers in a box."""

    def __init__(self, description: Description, numbers: Sequence[VariedNumber], box: Box) -> None:
        self.pivots: dict[str, tuple[complex, float]] = {}
        self.sides: dict[frozenset[str], float] = {}
        if not isinstance(description, Draft):
            return
        most = dict(zip(numbers, box.most, strict=True))
        for key, length in description.lengths.items():
            high = most.get(VariedNumber(key, "lengths", key), description.numbers(length))
            self.sides[frozenset(key.split())] = float(high)
        fixed = {(q.key, q.axis): k for k, q in enumerate(numbers) if q.table == "points"}
        for name in description.links.get(GROUND, ()):
            place = [description.numbers(x) for x in description.points[name]]
            away = np.zeros(2)
            for axis in (0, 1):
                if (name, axis) in fixed:
                    k = fixed[name, axis]
                    away[axis] = np.abs(np.array([box.least[k], box.most[k]]) - place[axis]).max()
            self.pivots[name] = complex(*place), float(np.hypot(*away))

    def missing(self, name: str, place: complex) -> tuple[str, float, float]:
        """A pivot from which a place is out of reach, its distance, and the reach; or ""."""
        for pivot, (centre, moves) in self.pivots.items():
            most = self._chain(pivot, name) + moves
            away = abs(place - centre)
            if away > most * (1.0 + _REACH_ROUNDING):
                return pivot, away, most
        return "", 0.0, math.inf

    def _chain(self, start: str, end: str) -> float:
        """The length of the shortest chain of sides (Bellman and Ford)."""
        far = {start: 0.0}
        for _ in range(len(self.sides)):
            for side, length in self.sides.items():
                for one, other in (tuple(side), tuple(side)[::-1]) if len(side) == 2 else ():
                    if one in far and far[one] + length < far.get(other, math.inf):
                        far[other] = far[one] + length
        return far.get(end, math.inf)


# ----------------------------------------------------------------------
# A mechanism with improved numbers, and the evidence for it.


@internal("description", "motion", "whole_motion", "unproved")
@dataclass(frozen=True, kw_only=True, eq=False)
class ImprovedDesign:
    """A mechanism with improved numbers.

    Parameters
    ----------
    description : Description
        With its new numbers.
    numbers : Mapping[str, float]
        Those that varied [file units].
    total : float
        The weighted sum of squares of all misses.
    largest : float
        The largest weighted miss, broken bounds aside.
    rms : float
        The root mean square of the distances from the points; 0 without points [length].
    sound : bool
        Whether all rows of its table are proved to be on one branch, which does not end between
        them, and goals are within their bounds.
    message : str
        Why it is not sound, and how the search ended.
    inputs : tuple of float
        The leading inputs at the points; none without points [file units].
    misses : tuple of float
        The distances from the points, on the branch of the table; NaN where this has no position.
    goals : Mapping[str, float]
        The root mean square of the misses of each goal that is no bound, by quantity or point,
        without its weight [file units].
    broken : tuple of str
        The bounds of goals that it breaks, in words.
    near_dead : str
        That it all but reaches a dead point, in words; else empty.
    unmoved : str
        Why it is the mechanism as it was, whose goals are missed; else empty.
    motion : Motion, optional
        Its table with the proofs; ``None`` if it has no position.
    whole_motion : WholeMotion, optional
        The motion between the rows too; ``None`` if that is not proved.

    Examples
    --------
    >>> import linkwork as lw
    >>> goal = {"of": "rocker", "at": [0, 90, 180], "values": [60, 80, 100]}
    >>> best = lw.synthesis.improve(lw.example("four-bar"), goal, vary=["A B", "O4 B"], starts=4)[0]
    >>> sorted(best.numbers), best.sound
    (['A B', 'O4 B'], True)
    """

    description: Description
    numbers: Mapping[str, float]
    total: float
    largest: float
    rms: float
    sound: bool
    message: str
    inputs: tuple[float, ...] = ()
    misses: tuple[float, ...] = ()
    goals: Mapping[str, float] = field(default_factory=dict)
    broken: tuple[str, ...] = ()
    near_dead: str = ""
    unmoved: str = ""
    motion: Motion | None = None
    whole_motion: WholeMotion | None = None

    @classmethod
    def unproved(cls, description: Description, message: str) -> ImprovedDesign:
        """A mechanism as it is, without a sweep."""
        return cls(
            description=description,
            numbers={},
            total=np.nan,
            largest=np.nan,
            rms=0.0,
            sound=False,
            message=message,
        )

    def __repr__(self) -> str:
        return f"<ImprovedDesign: total {self.total:.4g}, {self.message}>"


# ----------------------------------------------------------------------
# Designs of a fit with their proofs: certified sweeps, and misses on the branches they prove.


_INTERRUPTED = "interrupted: the best so far; "


def fitted_design(fit: FittedNumbers, k: int) -> ImprovedDesign:
    """The design of one lane of a fit."""
    message, path = _INTERRUPTED if fit.interrupted else "", fit.fitting.path
    new = dict(zip(fit.fitting.numbers, map(float, fit.x[k]), strict=True))
    description = with_numbers(fit.fitting.model.description, new)
    design = replace(
        proved_design(description, {q.name: x for q, x in new.items()}, message),
        total=float(fit.total[k]),
        largest=float(fit.largest[k]),
        goals=dict(zip(fit.names, map(float, fit.objectives[k]), strict=True)),
    )
    broken = [*_broken(fit, k)]
    if broken:
        message = "; ".join([design.message, *broken])
        design = replace(design, broken=tuple(broken), sound=False, message=message)
    if path is None:
        return design
    rms = float(np.sqrt(fit.path[k] / len(path.places)))
    return _on_path(replace(design, rms=rms), fit.fitting, path, fit.t[k])


def _broken(fit: FittedNumbers, k: int) -> Iterator[str]:
    """The bounds that a design breaks, in words."""
    for goal, (below, above) in zip(fit.bounds, fit.beyond[k], strict=True):
        least, most = goal.least, goal.most
        if least is not None and below > 0.0:
            down = told_beside(least - below, least)
            yield f"goal {goal.of} comes down to {down}, wanted at least {least:g}"
        if most is not None and above > 0.0:
            up = told_beside(most + above, most)
            yield f"goal {goal.of} comes up to {up}, wanted at most {most:g}"


def interrupted_design(design: ImprovedDesign) -> ImprovedDesign:
    """A design that says that it is the best so far."""
    message = design.message.removeprefix(_INTERRUPTED)
    return replace(design, message=f"{_INTERRUPTED}{message}")


def proved_design(
    description: Description, numbers: Mapping[str, float] = FrozenDict(), text: str = ""
) -> ImprovedDesign:
    """A mechanism with its proof: a certified sweep of its whole table.

    ``numbers``: the result of the fit; ``text``: the beginning of the message.
    """
    motion, whole, near_dead = None, None, ""
    try:
        model = model_of(description)
        motion = sweep(model)
        whole = WholeMotion.of(model, motion)
        lost = int(np.count_nonzero(~motion.certified))
        end = branch_end(motion)
        near_dead = "" if lost or end is not None else nearly_dead(motion, whole)
        sound = not (lost or end is not None or near_dead)
        text += f"{lost} of {len(motion)} rows are not proved" if lost else "all rows are proved"
        if end is not None:
            lead = next(iter(motion.inputs))
            text += f"; the branch ends at the {end.kind.word} "
            text += end.told(lead, motion.input_units[lead])
        text += f"; {near_dead}" if near_dead else ""
    except LinkworkError as error:
        sound, text = False, f"{text}{error}"
    return replace(
        ImprovedDesign.unproved(description, text),
        numbers=numbers,
        sound=sound,
        near_dead=near_dead,
        motion=motion,
        whole_motion=whole,
    )


def _on_path(design: ImprovedDesign, fitting: Fitting, path: PathGoal, t: Array) -> ImprovedDesign:
    """The design with its distances from the points, measured on its proved branch."""
    order = slice(None, None, -1 if path.falling else 1)
    places = tuple(map(float, t[order] / fitting.model.input_scale[0]))
    misses = np.full(len(places), np.nan)
    if design.motion is not None and design.motion.found.any():
        x = np.array(list(design.numbers.values()))
        at = replace(path, inputs=t, timed=True)
        model = model_of(design.description)
        misses = path_misses(model, design.motion, fitting.numbers, at, x)[order]
    text, sound = design.message, design.sound
    if not np.isfinite(misses).all():
        text, sound = f"{text}; not all points lie on the branch of its table", False
    return replace(
        design, inputs=places, misses=tuple(map(float, misses)), sound=sound, message=text
    )
