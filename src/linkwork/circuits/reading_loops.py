"""Coordinates of derived links and pins at one position."""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice, product
from typing import Any

import numpy as np

from linkwork.circuits.reading_joints import (
    FRAME,
    Joints,
    NotRead,
    Phase,
    Slide,
    joints_of,
    phase_of,
    walks,
)
from linkwork.core.equations.model import LoopEquations, Term, Variable
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import MechanismError
from linkwork.core.foundation.lanes import phase as direction_of
from linkwork.core.foundation.names import GROUND, canonical, free_name
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops
from linkwork.core.mechanism.part.guides import Slider
from linkwork.core.motion.model import Model, model_of

_NEAR = 1e-6  # relative: closing errors are much smaller, distances of pins much larger


@dataclass(frozen=True)
class Poses:
    """A position: values of variables by symbol, and coordinates of the file's points."""

    values: Mapping[str, float]
    points: Mapping[str, complex]
    tolerance: float

    @classmethod
    def at(cls, equations: LoopEquations, v: Array) -> Poses:
        """The position with unknowns and inputs v (N,)."""
        names = (variable.symbol for variable in equations.variables)
        values = dict(zip(names, map(float, v), strict=True))
        poses = cls(values, {}, _NEAR * equations.length_scale)
        points = {name: poses.sum(path.terms) for name, path in equations.points.items()}
        return cls(values, points, poses.tolerance)

    def sum(self, terms: Sequence[Term]) -> complex:
        """The sum of vectors."""
        return sum(
            (
                term.value
                * (1.0 if term.length is None else self.values[term.length])
                * self.turn(term.phase)
                for term in terms
            ),
            0j,
        )

    def turn(self, phase: Phase) -> complex:
        """The unit vector of a direction."""
        return cmath.exp(1j * sum(weight * self.values[name] for name, weight in phase))

    def links(self, joints: Joints) -> dict[int, complex]:
        """The origin of every link, relative to the start of the equations."""
        turn = {link: self.turn(phase) for link, phase in joints.phases.items()}
        found = {joints.ground: -joints.origin}
        last = 0
        while last < len(found) < len(turn):
            last = len(found)
            for corner in joints.corners:
                known = next((link for link in corner.places if link in found), None)
                if known is None:
                    continue
                pin = found[known] + corner.places[known] * turn[known]
                for link, place in corner.places.items():
                    found.setdefault(link, pin - place * turn[link])
            for slide in joints.slides:
                way = slide.foot + slide.along * self.values[slide.variable]
                way *= turn[slide.before]
                if slide.before in found:
                    found.setdefault(slide.after, found[slide.before] + way)
                elif slide.after in found:
                    found[slide.before] = found[slide.after] - way
        return found

    def named(self, joints: Joints) -> tuple[complex, tuple[str | None, ...]]:
        """The start of the equations, and the file's point at every pin.

        The start is the origin unless another start makes more pins points of the file.
        """
        origins = self.links(joints)
        pins = []
        for corner in joints.corners:
            link, place = next(iter(corner.places.items()))
            pins.append(origins[link] + place * self.turn(joints.phases[link]))
        begins = [0j, *(point - pin for point in self.points.values() for pin in pins)]
        found = [tuple(self._point_at(pin + begin) for pin in pins) for begin in begins]
        best = max(range(len(begins)), key=lambda k: _distinct(found[k]))
        if _distinct(found[best]) < 2:  # a single point could be at any pin
            best = 0
        return begins[best], found[best]

    def _point_at(self, place: complex) -> str | None:
        """The file's point at a position."""
        for name, there in self.points.items():
            if abs(there - place) <= self.tolerance:
                return name
        return None

    def fit(self, joints: Joints) -> int:
        """The number of pins that are points of the file; a pin of k links counts as k - 1."""
        _, names = self.named(joints)
        pins = zip(names, joints.corners, strict=True)
        return sum({name: len(c.places) - 1 for name, c in pins if name is not None}.values())


def _distinct(names: Sequence[str | None]) -> int:
    return len({name for name in names if name is not None})


# ----------------------------------------------------------------------
# Names of links and pins derived from loops: those of the file where they exist.


_CANCELLED = 1e-12  # relative to the largest vector: rounding of vectors with sum zero


@dataclass(frozen=True, kw_only=True)
class PartNames:
    """The name of every pin, in order, and of every link, ground first.

    ``begin`` is the point of the file at which the equations begin; ``taken`` are all names.
    """

    pins: tuple[str, ...]
    links: dict[int, str]
    begin: complex
    taken: set[str]

    @classmethod
    def of(cls, loops: Loops, equations: LoopEquations, joints: Joints, poses: Poses) -> PartNames:
        """Pins named by the file's points, links by its links, otherwise by their angles."""
        drawn = [*loops.points, *(name for name in loops.links if name != GROUND)]
        named = [*drawn, *loops.dimensions, *loops.outputs, GROUND]
        named += [variable.name for variable in equations.variables]
        taken = set(map(canonical, named))
        pins: list[str] = []
        begin, points = poses.named(joints)
        for name in points:
            pins.append(free_name("P1", taken) if name is None or name in pins else name)
        links = _drawn_links(loops, equations, joints, pins)
        shown = {variable.symbol: variable.name for variable in equations.variables}
        for link, phase in joints.phases.items():
            if link not in links:
                links[link] = free_name(_called(joints, link, phase, shown), taken)
        return cls(pins=tuple(pins), links=links, begin=begin, taken=taken)


def _drawn_links(
    loops: Loops, equations: LoopEquations, joints: Joints, pins: Sequence[str]
) -> dict[int, str]:
    """Links drawn by the file, in its order; most of their points are pins of the link."""
    found = {joints.ground: GROUND}
    for name, points in loops.links.items():
        if name == GROUND:
            continue
        at_pins = [
            link
            for pin, corner in zip(pins, joints.corners, strict=True)
            for link in corner.places
            if pin in points and link not in found
        ]
        along = [
            link for link in at_pins if joints.phases[link] == _names_direction(equations, points)
        ]
        carrying = [link for link in at_pins if at_pins.count(link) > 1] or along
        if carrying:
            found[max(carrying, key=carrying.count)] = name
    return found


def _names_direction(equations: LoopEquations, points: Sequence[str]) -> Phase | None:
    """The direction from the first to the second point, if it is unique along the path."""
    total: dict[tuple[Phase, str | None], complex] = {}
    for sign, point in zip((-1, 1), points[:2], strict=False):
        for term in equations.points[point].terms:
            key = (phase_of(term), term.length)
            total[key] = total.get(key, 0j) + sign * term.value
    size = max(map(abs, total.values()), default=0.0)
    left = {phase for (phase, _), value in total.items() if abs(value) > _CANCELLED * size}
    return left.pop() if len(left) == 1 and len(points) > 1 else None


def _called(joints: Joints, link: int, phase: Phase, shown: dict[str, str]) -> str:
    """The name of a block from its slide, of another link from the angles of its direction."""
    pins = sum(link in corner.places for corner in joints.corners)
    slides = [s.variable for s in joints.slides if link in (s.before, s.after)]
    if slides and pins < 2:
        alone = len(joints.slides) == 1
        return "block" if alone else f"block_{shown[slides[0]]}"
    return "_".join(["link", *(shown[name] for name, _ in phase)])


# ----------------------------------------------------------------------
# The joints driven by the inputs of loop equations, in the derived linkage.


def driven_pair(joints: Joints, variable: Variable) -> tuple[int, int, float]:
    """The two links whose relative angle is a multiple of an input angle, and the factor.

    Pairs of links with a common pin are preferred.

    Raises
    ------
    NotRead
        If it is not the angle between two links.
    """
    pairs = list(_pairs(joints, variable))
    if not pairs:
        raise NotRead(f'the input "{variable.name}" is not the angle between two links')
    return max(pairs, key=lambda pair: _pinned(joints, pair[0], pair[1]))


def _pairs(joints: Joints, variable: Variable) -> Iterator[tuple[int, int, float]]:
    others = sorted(joints.phases, key=lambda link: link != joints.ground)
    for other in others:
        if joints.phases[other] == FRAME and other != joints.ground:
            continue
        for link, phase in joints.phases.items():
            between = _difference(phase, joints.phases[other])
            if list(between) == [variable.symbol] and (
                between[variable.symbol] > 0 or other == joints.ground
            ):
                yield link, other, between[variable.symbol]


def _difference(phase: Phase, other: Phase) -> dict[str, float]:
    found = dict(phase)
    for name, weight in other:
        found[name] = found.get(name, 0.0) - weight
    return {name: weight for name, weight in found.items() if weight}


def _pinned(joints: Joints, link: int, other: int) -> bool:
    return any(link in corner.places and other in corner.places for corner in joints.corners)


def inputs_at_joints(equations: LoopEquations, joints: Joints) -> int:
    """The number of inputs that drive a joint."""
    count = 0
    for variable in equations.inputs:
        if variable.kind == "angle":
            link, other, _ = driven_pair(joints, variable)
            count += _pinned(joints, link, other)
        else:
            count += 1
    return count


# ----------------------------------------------------------------------
# The linkage described by loop equations, with the names of the file.


_MOST_WAYS = 64  # combinations of walks that are tried


@dataclass(frozen=True, kw_only=True)
class Seen:
    """The points and links of a mechanism.

    Parameters
    ----------
    model : Model
        Of the linkage: the mechanism's own, unless it is given by loops.
    turning : Mapping[str, tuple of str]
        The variables of the mechanism's own equations that give the direction of every link.
    loose : tuple of str
        Links on which loops do not determine the distance between the pins of different loops. The
        chain does not depend on it; an arbitrary distance is used.
    """

    model: Model
    linkage: Linkage
    turning: Mapping[str, tuple[str, ...]]
    loose: tuple[str, ...] = ()


def read_linkage(loops: Loops, equations: LoopEquations, v: Array) -> Seen:
    """Derive the points and links of a mechanism given by its loops.

    Parameters
    ----------
    v : (N,)
        Unknowns and inputs of the position used for the sketch.

    Raises
    ------
    NotRead
        If the equations cannot be read as links with pins and sliding joints.
    """
    _check_directions(equations)
    poses = Poses.at(equations, v)
    joints = _best(equations, poses)
    names = PartNames.of(loops, equations, joints, poses)
    drawing = _Drawing(loops, equations, joints, poses, names)
    try:
        linkage = drawing.linkage()
        model = model_of(linkage)
    except MechanismError as error:  # the derived linkage contradicts itself
        raise NotRead(str(error.problems[0].message)) from None
    shown = {variable.symbol: variable.name for variable in equations.variables}
    turning = {
        names.links[link]: tuple(shown[name] for name, _ in phase)
        for link, phase in joints.phases.items()
    }
    loose = tuple(name for link, name in names.links.items() if link in joints.loose)
    return Seen(model=model, linkage=linkage, turning=turning, loose=loose)


def _check_directions(equations: LoopEquations) -> None:
    """Check that directions are independent, as for links joined by pins and slides only."""
    phases = {phase_of(term) for loop in equations.loops for term in loop.terms} - {()}
    angles = [variable.symbol for variable in equations.variables if variable.kind == "angle"]
    weights = [[dict(phase).get(angle, 0.0) for angle in angles] for phase in sorted(phases)]
    if phases and np.linalg.matrix_rank(np.array(weights)) < len(phases):
        raise NotRead("the angles of its vectors depend on each other, as for gears")


def _best(equations: LoopEquations, poses: Poses) -> Joints:
    """The links and joints with vectors in the written order, or in another order that fits better.

    Another order fits better if more pins are points of the file, or if more inputs drive a joint,
    unless the fixed link would then depend on the order of vectors.
    """
    freedom = len(equations.variables) - 2 * len(equations.loops)
    best: tuple[int, int, Joints] | None = None
    why: list[NotRead] = []
    for ways in islice(product(*map(walks, equations.loops)), _MOST_WAYS):
        try:
            joints = joints_of(ways, equations.length_scale)
            if joints.mobility != freedom:
                raise NotRead("the equations do not determine which pins of its loops are the same")
            driven = inputs_at_joints(equations, joints)
        except NotRead as error:
            why.append(error)
            continue
        fit = poses.fit(joints)
        if (
            best is None
            or fit > best[0]
            or ((fit, joints.still) == (best[0], 1) and driven > best[1])
        ):
            best = fit, driven, joints
        if (fit, driven) == (joints.pins if poses.points else 0, len(equations.inputs)):
            break
    if best is None:
        raise why[0]
    return best[2]


@dataclass
class _Drawing:
    """The parts of the linkage found so far; ``places``: coordinates of every link's points."""

    loops: Loops
    equations: LoopEquations
    joints: Joints
    poses: Poses
    names: PartNames
    places: dict[int, dict[str, complex]] = field(default_factory=dict)

    def linkage(self) -> Linkage:
        """The whole linkage."""
        self.places = {link: dict(self._pins_of(link)) for link in self.names.links}
        rails = [self._rail(*slide) for slide in self._outwards()]
        if not self.places[self.joints.ground]:  # only a slide's line is fixed
            raise NotRead("no vector begins at a fixed link")
        own = self.places[self.joints.ground]
        for name in own:  # in the file's coordinates
            own[name] += self.names.begin - self.joints.origin
        names, shapes = self.names.links, self.places
        return Linkage(
            name=self.loops.name,
            length=self.loops.length,
            angle=self.loops.angle,
            points=self._sketch(),
            links={name: tuple(shapes[link]) for link, name in names.items()},
            lengths=dict(self._lengths()),
            angles=dict(self._angles()),
            sliders=tuple(self._slider(rail) for rail in rails),
            inputs=tuple(map(self._input, self.equations.inputs, self.loops.inputs)),
        )

    def _pins_of(self, link: int) -> list[tuple[str, complex]]:
        """The pins of a link with coordinates, in the file's order if the file draws the link."""
        pins = zip(self.names.pins, self.joints.corners, strict=True)
        found = [(name, corner.places[link]) for name, corner in pins if link in corner.places]
        drawn = self.loops.links.get(self.names.links[link], ())
        return sorted(found, key=lambda pin: drawn.index(pin[0]) if pin[0] in drawn else len(drawn))

    def _outwards(self) -> Iterator[tuple[Slide, int, int]]:
        """Every slide with its guide and its sliding link.

        The order is from ground outwards; otherwise from a link pinned to ground or with most pins.
        """
        left = list(self.joints.slides)
        reached = {self.joints.ground}
        while left:
            for slide in left:
                ends = {slide.before, slide.after}
                if ends & reached:
                    (guide,) = ends & reached
                    (sliding,) = ends - reached
                    break
            else:
                free = {link for slide in left for link in (slide.before, slide.after)}
                reached.add(max(sorted(free), key=self._standing))
                continue
            left.remove(slide)
            reached.add(sliding)
            yield slide, guide, sliding

    def _standing(self, link: int) -> tuple[int, int]:
        """The rank of a link as a guide."""
        pins = [corner.places for corner in self.joints.corners if link in corner.places]
        return sum(self.joints.ground in links for links in pins), len(pins)

    def _rail(self, slide: Slide, guide: int, sliding: int) -> Slider:
        """The line on the guide along which a point of the other link slides."""
        foot, along = slide.foot, slide.along / abs(slide.along)
        if sliding == slide.before:
            foot, along = -foot, -along
        own, rail = self.places[sliding], self.places[guide]
        name = self._shown(slide.variable)
        if not own:
            own[free_name(f"{name}_point", self.names.taken)] = 0j
        point, place = next(iter(own.items()))
        size = self.equations.length_scale
        start = self._point_at(rail, foot + place, f"{name}_foot")
        end = self._point_at(rail, foot + place + along * size, f"{name}_line")
        return Slider(
            name=name,
            link=self.names.links[sliding],
            points=(point,),
            on=self.names.links[guide],
            line=(start, end),
        )

    def _point_at(self, own: dict[str, complex], place: complex, wanted: str) -> str:
        """The point of a link at a position; a new point if none exists."""
        near = self.poses.tolerance
        for name, there in own.items():
            if abs(there - place) <= near:
                return name
        name = free_name(wanted, self.names.taken)
        own[name] = place
        return name

    def _slider(self, rail: Slider) -> Slider:
        """The slider with the angle from the line to the link, whose points are complete."""
        number = {name: link for link, name in self.names.links.items()}
        own, guide = (self.places[number[name]] for name in (rail.link, rail.on))
        if len(own) < 2:
            return rail
        start, end = (guide[name] for name in rail.line)
        return replace(
            rail,
            angle=self._in_file_units(_linkage_of_loops_direction(own) - direction_of(end - start)),
        )

    def _sketch(self) -> dict[str, tuple[Number, Number]]:
        found: dict[str, tuple[Number, Number]] = {}
        begin = self.names.begin
        origins = {link: begin + zero for link, zero in self.poses.links(self.joints).items()}
        origins[self.joints.ground] = 0j  # positions on ground are coordinates already
        for link in (self.joints.ground, *self.places):
            turn = self.poses.turn(self.joints.phases[link])
            for name, place in self.places[link].items():
                at = origins[link] + place * turn
                found.setdefault(name, (at.real, at.imag))
        return found

    def _lengths(self) -> Iterator[tuple[str, Number]]:
        for _, first, others in self._moving():
            for name, vector in others.items():
                yield f"{first} {name}", abs(vector)

    def _angles(self) -> Iterator[tuple[str, Number]]:
        for second, first, others in self._moving():
            for name, vector in others.items():
                if name != second:
                    angle = direction_of(vector / others[second])
                    yield f"{second} {first} {name}", self._in_file_units(angle)

    def _moving(self) -> Iterator[tuple[str, str, dict[str, complex]]]:
        """Second and first point of moving links, and vectors from the first to the others."""
        for link, own in self.places.items():
            if link != self.joints.ground and len(own) > 1:
                (first, start), *others = own.items()
                yield others[0][0], first, {name: place - start for name, place in others}

    def _input(self, variable: Variable, which: Input) -> Input:
        """The input as a quantity of the linkage."""
        part: dict[str, Any]
        if variable.kind == "angle":
            link, other, scale = driven_pair(self.joints, variable)
            begin = _linkage_of_loops_direction(self.places[link])
            part = {"link": self.names.links[link]}
            if other != self.joints.ground:
                begin -= _linkage_of_loops_direction(self.places[other])
                part["relative_to"] = self.names.links[other]
            begin = self._in_file_units(begin)
        else:
            slide = next(s for s in self.joints.slides if s.variable == variable.symbol)
            scale, begin, part = abs(slide.along), 0.0, {"slider": self._shown(slide.variable)}
        rows = scale * self.loops.rows(which) + begin
        step = float(rows[1] - rows[0]) if len(rows) > 1 else None
        stop = float(rows[-1])
        return Input(**part, from_=float(rows[0]), to=stop, step=step)

    def _shown(self, symbol: str) -> str:
        return next(v.name for v in self.equations.variables if v.symbol == symbol)

    def _in_file_units(self, angle: float) -> float:
        return self.loops.angle.from_radians(angle)


def _linkage_of_loops_direction(own: Mapping[str, complex]) -> float:
    """The direction from the first to the second point of a link [rad]."""
    if len(own) < 2:
        raise NotRead("the input turns a block, which has one point and no direction")
    first, second, *_ = own.values()
    return direction_of(second - first)
