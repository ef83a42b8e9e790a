"""The joints of a linkage as a graph: pins and slides between bodies, couplings of wheels."""

from __future__ import annotations

import cmath
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.polynomial import Chebyshev

from linkwork.core.foundation.arrays import EPSILON, Array, BoolArray, CountArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.units import LENGTHS, MASSES
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.part import Coupling, Pair, PairKind, Part
from linkwork.core.motion.model import Model
from linkwork.core.results.failure import LimitKind
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from linkwork.forces.reactions.geometry import Geometry


@dataclass
class JointGraph:
    """Bodies with their points, the joints between them, and the couplings.

    ``turning``: the variable that is the angle of a body that is no link; ``blocks``: bodies that
    turn with another one, on which they slide; ``unpinned``: bodies that only their part joins.
    """

    linkage: Linkage
    bodies: dict[str, tuple[str, ...]] = field(default_factory=dict)
    edges: list[Pair] = field(default_factory=list)
    couplings: list[Coupling] = field(default_factory=list)
    turning: dict[str, str] = field(default_factory=dict)
    blocks: dict[str, str] = field(default_factory=dict)
    unpinned: set[str] = field(default_factory=set)

    @classmethod
    def of(cls, linkage: Linkage) -> JointGraph:
        """The graph of a linkage.

        Raises
        ------
        InputError
            If a part has no equivalent in the formats of robots.
        """
        graph = cls(linkage, {GROUND: (), **linkage.links})
        for part in linkage.parts:
            graph._add(part)
        graph._pins()
        return graph

    def _add(self, part: Part) -> None:
        pairs = part.pairs(self.linkage)
        if pairs is None:
            raise InputError(
                f'"{part.label}" ({part.title.lower()}) has no equivalent in files for '
                "robots: they have pins, slides and constant ratios only"
            )
        for body in pairs.bodies:
            self.bodies[body.name] = body.points
            if body.angle:
                self.turning[body.name] = body.angle
            if body.on:
                self.blocks[body.name] = body.on
            if not body.pinned:
                self.unpinned.add(body.name)
        self.edges += pairs.pairs
        self.couplings += pairs.couplings

    def _pins(self) -> None:
        """A pin from the first body at every point to each further body."""
        welded = {edge.bodies for edge in self.edges if edge.kind is PairKind.FIXED}
        for point in self.linkage.points:
            here = [b for b, on in self.bodies.items() if point in on and b not in self.unpinned]
            for k, body in enumerate(here[1:], 1):
                known = here[:k]
                # welded bodies need no pin between them
                if not any({(body, other), (other, body)} & welded for other in known):
                    ends = (here[0], body)
                    pin = Pair(kind=PairKind.PIN, name=point, bodies=ends, point=point)
                    self.edges.append(pin)

    def driven(self) -> Mapping[frozenset[str], int]:
        """Pairs of bodies whose relative angle is driven."""
        pairs = {}
        for k, which in enumerate(self.linkage.inputs):
            kind, name = which.drives
            if kind == "link":
                pairs[frozenset({name, which.relative_to or GROUND})] = k
            elif kind == "joint":
                pairs[frozenset(list(self.linkage.bodies_at(name))[:2])] = k
        return pairs


# ----------------------------------------------------------------------
# A tree of joints from ground to every body, and the joints that close its loops.
#
# All joint values are zero in the start position. The frame of a body has its origin at the joint
# that carries it, and its x axis along the body.


@dataclass(frozen=True, kw_only=True)
class TreeJoint:
    """The joint that carries a body; ``sign``: -1 if the displacement counts the other way."""

    edge: Pair
    parent: str
    child: str
    sign: float

    @property
    def name(self) -> str:
        """A name that no other joint has: every body has one joint."""
        return f"{self.edge.name}:{self.child}".replace(" ", "_")


@dataclass
class JointTree:
    """The tree of a mechanism.

    ``joints`` are in an order in which parents come first; ``closing`` are the joints left out.
    """

    graph: JointGraph
    joints: list[TreeJoint] = field(default_factory=list)
    closing: list[Pair] = field(default_factory=list)

    @classmethod
    def of(cls, graph: JointGraph) -> JointTree:
        """A tree that prefers welds, driven joints, slides, and pins at ground, in this order.

        Raises
        ------
        InputError
            If a body is not joined to ground.
        """
        tree, driven = cls(graph), graph.driven()
        group = {body: body for body in graph.bodies}
        taken: list[Pair] = []

        def order(edge: Pair) -> tuple[int, int, bool]:
            pair = frozenset(edge.bodies)
            later = edge.kind is not PairKind.FIXED and pair not in driven
            return int(later), edge.kind.value, GROUND not in pair

        for edge in sorted(graph.edges, key=order):
            first, second = (group[body] for body in edge.bodies)
            if first == second:
                tree.closing.append(edge)
                continue
            taken.append(edge)
            group = {body: first if g == second else g for body, g in group.items()}
        loose = [body for body, g in group.items() if g != group[GROUND]]
        if loose:
            raise InputError(
                f'"{loose[0]}" is not joined to ground by pins and slides: a robot is one tree'
            )
        tree.closing = [tree._closed(edge, taken) for edge in tree.closing]
        tree._grow(taken)
        return tree

    def _closed(self, edge: Pair, taken: list[Pair]) -> Pair:
        """The joint that closes a loop: a slide becomes a sliding block and a weld to it."""
        if edge.kind is not PairKind.SLIDE:
            return edge
        on, link = edge.bodies
        block = f"{edge.name} block"
        self.graph.bodies[block] = (edge.point,)
        self.graph.blocks[block] = on
        taken.append(replace(edge, bodies=(on, block)))
        return replace(edge, kind=PairKind.FIXED, bodies=(block, link), line=None)

    def _grow(self, taken: list[Pair]) -> None:
        reached, left = [GROUND], list(taken)
        for parent in reached:  # grows meanwhile
            for edge in [edge for edge in left if parent in edge.bodies]:
                child = edge.bodies[1] if edge.bodies[0] == parent else edge.bodies[0]
                sign = 1.0 if edge.bodies[0] == parent else -1.0
                self.joints.append(TreeJoint(edge=edge, parent=parent, child=child, sign=sign))
                reached.append(child)
                left.remove(edge)

    @cached_property
    def by_child(self) -> dict[str, TreeJoint]:
        """The joint of every body."""
        return {joint.child: joint for joint in self.joints}

    def origin(self, body: str) -> str:
        """The point at the origin of a body's frame."""
        edge = self.by_child[body].edge
        points = self.graph.bodies[body]
        return edge.point if edge.point in points else points[0]

    def path(self, body: str) -> list[TreeJoint]:
        """The joints from a body back to ground."""
        path = []
        while body != GROUND:
            path.append(self.by_child[body])
            body = path[-1].parent
        return path

    def ratios(self, coupling: Coupling) -> dict[str, float]:
        """The factors of joint values whose sum is zero, by joint.

        Raises
        ------
        InputError
            If the displacement of a coupling is no joint of the tree.
        """
        factors: dict[str, float] = {}
        for body, factor in coupling.turns:
            for joint in self.path(body):
                if joint.edge.kind is PairKind.PIN:
                    factors[joint.name] = factors.get(joint.name, 0.0) + factor
        for name, factor in coupling.slides:
            joint = next(
                j for j in self.joints if j.edge.kind is PairKind.SLIDE and j.edge.name == name
            )
            factors[joint.name] = factors.get(joint.name, 0.0) + factor * joint.sign
        size = max(map(abs, factors.values()), default=0.0)
        # multiples that cancel leave their rounding
        return {name: f for name, f in factors.items() if abs(f) > 1e-12 * size}

    def angle(self, geometry: Geometry, body: str) -> tuple[Array, Array]:
        """The angle of a body and its derivative, (B,)."""
        body = self.graph.blocks.get(body, body)
        variable = self.graph.turning.get(body)
        jet = geometry.angle(body) if variable is None else geometry.own(variable)
        return jet.v, jet.d1

    def value(self, geometry: Geometry, joint: TreeJoint) -> tuple[Array, Array]:
        """The value of a joint, not yet from zero, and its derivative, [rad] or [length], (B,)."""
        if joint.edge.kind is PairKind.SLIDE:
            jet, rate = geometry.own(joint.edge.name), None
            inputs = [each.name for each in geometry.driven.equations.inputs]
            if joint.edge.name in inputs:  # of inputs a motion knows the rate of the leading one
                rate = geometry.input_rates[inputs.index(joint.edge.name)]
            d1 = jet.d1 if rate is None else rate + np.zeros_like(jet.v)
            return joint.sign * jet.v, joint.sign * d1
        child, parent = (self.angle(geometry, body) for body in (joint.child, joint.parent))
        turn = np.array(child[0] - parent[0])
        # a row without a position must not affect other rows
        known = np.isfinite(turn)
        turn[known] = np.unwrap(turn[known])
        return turn, child[1] - parent[1]


# ----------------------------------------------------------------------
# A mechanism as bodies with frames and masses, joined by a tree, in metres and kilograms.


_DENSITY = 1.0  # kg/m of bodies without a mass in the file
_SMALL = 0.01  # of the longest link: the least size of a body, for its inertia
_TRACE = 1e-3  # of a bar of this size: stands in for a mass of 0
_LEAST = 1e-14  # kg, and kg m²: MuJoCo refuses bodies below 1e-15


@dataclass(frozen=True, kw_only=True)
class Inertia:
    """Mass [kg], centre of mass in the body's frame [m], moment of inertia about it [kg m²]."""

    mass: float
    center: complex
    inertia: float


class Robot:
    """A mechanism at its start position.

    Parameters
    ----------
    model : Model
    start : Position
        Where all joint values are zero.

    Raises
    ------
    InputError
        If the mechanism has no links and joints, an unknown unit of length, no start position, or
        a part that files for robots cannot describe.
    """

    def __init__(self, model: Model, start: Position) -> None:
        description = model.description
        if not isinstance(description, Linkage):
            raise InputError(
                f'mechanism "{description.name}" is given by equations: files for robots need '
                "points and links"
            )
        if description.length not in LENGTHS:
            known = ", ".join(LENGTHS)
            raise InputError(
                f'"{description.length}" cannot be converted to metres: write length = one of '
                f"{known}"
            )
        if not start.status.ok:
            raise InputError(f"no start position: {start.status.value}")
        self.linkage, self.model = description, model
        self.metre = float(LENGTHS[description.length])
        self.tree = JointTree.of(JointGraph.of(description))
        self.start = Geometry(model, start)

    @property
    def name(self) -> str:
        """The mechanism's name."""
        return self.linkage.name

    def place(self, point: str) -> complex:
        """A point in the start position [m]."""
        return complex(self.start.place(point).v[0]) * self.metre

    def frame(self, body: str) -> tuple[complex, float]:
        """The origin [m] and the angle of a body's frame in the start position."""
        if body == GROUND:
            return 0j, 0.0
        return self.place(self.tree.origin(body)), float(self.tree.angle(self.start, body)[0][0])

    def local(self, body: str, place: complex) -> complex:
        """A place of the start position in the frame of a body [m]."""
        origin, angle = self.frame(body)
        return (place - origin) * cmath.rect(1.0, -angle)

    def mounted(self, joint: TreeJoint) -> tuple[complex, float]:
        """The frame of a joint's child in that of its parent, in the start position."""
        origin, angle = self.frame(joint.child)
        return self.local(joint.parent, origin), angle - self.frame(joint.parent)[1]

    def axis(self, joint: TreeJoint) -> complex:
        """The direction of a slide in the frame of its child, a unit vector."""
        assert joint.edge.line is not None
        a, b = map(self.place, joint.edge.line)
        if joint.edge.bodies[0] in self.tree.graph.turning:  # a cylinder: its points may coincide
            angle = self.tree.angle(self.start, joint.child)[0][0]
            along = cmath.rect(1.0, float(angle))
        else:
            along = (b - a) / abs(b - a)
        return along * cmath.rect(1.0, -self.frame(joint.child)[1])

    def points(self, body: str) -> dict[str, complex]:
        """The points of a body in its frame [m]."""
        return {p: self.local(body, self.place(p)) for p in self.tree.graph.bodies[body]}

    def inertia(self, body: str) -> Inertia:
        """What the file gives, or a slender bar with a stated mass per length."""
        places = list(self.points(body).values())
        least = _SMALL * self.start.length * self.metre
        extent = max([abs(a - b) for a in places for b in places] + [least])
        stated = self.linkage.spelled_masses().get(body)
        if stated is None:
            mass = max(_DENSITY * extent, _LEAST)
            middle = sum(places) / len(places)
            inertia = max(mass * extent**2 / 12.0, _LEAST)
            return Inertia(mass=mass, center=middle, inertia=inertia)
        numbers = self.linkage.numbers
        mass = numbers(stated.mass) * float(MASSES[self.linkage.mass])
        mass = max(mass or _TRACE * _DENSITY * least, _LEAST)
        inertia = numbers(stated.inertia) * float(MASSES[self.linkage.mass]) * self.metre**2
        first = self.place(self.linkage.links[body][0])
        x, y = map(numbers, stated.center or (0, 0))
        center = complex(x, y) * self.metre
        if stated.shape == "rod":
            span = abs(self.place(self.linkage.links[body][1]) - first)
            center, inertia = span / 2.0 + 0j, mass * span**2 / 12.0
        turned = center * cmath.rect(1.0, self.frame(body)[1])
        # simulators refuse bodies without inertia
        inertia = max(inertia, mass * least**2 / 12.0, _LEAST)
        return Inertia(mass=mass, center=self.local(body, first + turned), inertia=inertia)

    def gravity(self) -> complex:
        """The acceleration of free fall [m/s²]; zero without gravity in the file."""
        stated = self.linkage.gravity
        if stated is None:
            return 0j
        size = stated.acceleration(self.linkage.numbers, self.linkage.length) * self.metre
        if stated.angle is None:
            return -1j * size
        return cmath.rect(size, self.linkage.numbers(stated.angle) * self.linkage.angle.radians)

    def values(self, motion: Motion) -> dict[str, tuple[Array, Array]]:
        """Joint values in the rows of a motion and their derivatives by the leading input.

        In rad and m, from the start position, (B,) each; NaN in rows without a position.
        """
        geometry, values = Geometry(self.model, motion), {}
        for joint in self.tree.joints:
            if joint.edge.kind is PairKind.FIXED:
                continue
            value, rate = self.tree.value(geometry, joint)
            scale = self.metre if joint.edge.kind is PairKind.SLIDE else 1.0
            zero = self.tree.value(self.start, joint)[0][0]
            values[joint.name] = (scale * (value - zero), scale * np.asarray(rate))
        return values

    def per_metre(self, name: str) -> float:
        """Length units of the file per unit of a joint value."""
        slides = {j.name for j in self.tree.joints if j.edge.kind is PairKind.SLIDE}
        return 1.0 / self.metre if name in slides else 1.0

    def driven(self) -> dict[str, TreeJoint | None]:
        """The joint of the tree that each input drives, by the input's quantity, the leading first.

        ``None`` for an angle between bodies that no joint of the tree connects.
        """
        names = self.model.motion_quantities.names
        pairs = self.tree.graph.driven()
        driven: dict[str, TreeJoint | None] = {}
        for k, (quantity, which) in enumerate(zip(names.inputs, self.linkage.inputs, strict=True)):
            kind, name = which.drives
            if kind in ("slider", "cylinder"):
                candidates = (j for j in self.tree.joints if j.edge.name == name)
            else:
                pins = (j for j in self.tree.joints if j.edge.kind is PairKind.PIN)
                candidates = (j for j in pins if pairs.get(frozenset((j.parent, j.child))) == k)
            driven[quantity] = next(candidates, None)
        return dict(sorted(driven.items(), key=lambda item: item[0] != names.lead))

    def leading(self) -> TreeJoint | None:
        """The joint of the tree that the leading input drives."""
        return next(iter(self.driven().values()))

    def notes(self) -> list[str]:
        """What a reader of the file has to know."""
        bodies = [b for b in self.tree.graph.bodies if b != GROUND]
        assumed = [b for b in bodies if b not in self.linkage.spelled_masses()]
        lines = ["Metres, kilograms, radians; the mechanism moves in the plane x-y."]
        lines.append("All joint values are zero in the start position.")
        if assumed:
            lines.append(
                f"Assumed masses, slender bars of {_DENSITY:g} kg/m: {', '.join(assumed)}."
            )
        numbers = self.linkage.numbers
        none = [b for b, mass in self.linkage.spelled_masses().items() if numbers(mass.mass) == 0.0]
        if none:
            lines.append(
                f"A small mass instead of none, which simulators refuse: {', '.join(none)}."
            )
        if self.linkage.gravity is None:
            lines.append("No gravity.")
        free = [quantity for quantity, joint in self.driven().items() if joint is None]
        if free:
            lines.append(f"Not driven, between bodies without a common joint: {', '.join(free)}.")
        left = {type(part).title.lower() for part in self.linkage.parts if part.acts}
        if left:
            lines.append(f"Not written: {', '.join(sorted(left))}.")
        return lines


# ----------------------------------------------------------------------
# The value of a joint as a polynomial of the driven joint's value, with its error.


_HIGHEST = 40
_NEAR = 1e-9  # rad or m
_ENOUGH = 1e-10  # rad or m: no higher degree is tried


@dataclass(frozen=True, kw_only=True)
class JointPolynomial:
    """Chebyshev series on a domain of the driven joint, and the best straight line.

    ``error`` and ``line_error`` are the largest differences in the rows, enlarged by what their
    derivatives allow between rows; they are no proofs. ``range`` is that of the joint's values.
    """

    series: Chebyshev
    error: float
    line: tuple[float, float]
    line_error: float
    range: tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Couplings:
    """All joints by the driven one; ``limits`` are dead points, or the ends of the table."""

    leading: TreeJoint
    limits: tuple[float, float]
    stopped: tuple[bool, bool]
    joints: dict[str, JointPolynomial]


def couplings_of(robot: Robot, motion: Motion) -> Couplings:
    """Fit the joints of a motion, on the rows without a gap around the start.

    Raises
    ------
    InputError
        If the input is no joint of the tree, or the table has too few positions.
    """
    leading = robot.leading() if robot.linkage.inputs else None
    if leading is None:
        raise InputError(
            "URDF has no loops: all joints follow the driven one, but the input is no angle or "
            "displacement of one joint; write MJCF or SDF"
        )
    values = robot.values(motion)
    x, rate = values.pop(leading.name)
    with np.errstate(all="ignore"):
        slopes = {name: joint_rate / rate for name, (_, joint_rate) in values.items()}
    # at a dead point slopes are infinite, at rest they are unknown
    known = np.logical_and.reduce(np.isfinite([x, *slopes.values()]))
    rows = _fitted_rows(x, motion, known)
    if len(rows) < 5:
        raise InputError(
            f"{len(rows)} positions around the start are too few for the polynomials of a URDF "
            "file: give a table with more rows"
        )
    joints, condition = {}, float(np.max(motion.condition[rows]))
    limits, stopped = _limits(robot, motion, leading, x[rows], int(rows[0]))
    # dead points too, where slopes are unknown
    inside = motion.found & (x >= limits[0] - _NEAR) & (x <= limits[1] + _NEAR)
    for name, (y, _) in values.items():
        joints[name] = _fit(x[rows], y[rows], slopes[name][rows], condition, y[inside])
    return Couplings(leading=leading, limits=limits, stopped=stopped, joints=joints)


def _fitted_rows(x: Array, motion: Motion, known: BoolArray) -> CountArray:
    """The rows around the start position without a gap, by increasing value of the joint."""
    requested = np.flatnonzero(motion.asked)
    good = motion.found[requested] & known[requested]
    if not good.any():
        return requested[:0]
    here = int(np.argmin(np.where(good, np.abs(x[requested]), np.inf)))
    gaps = np.flatnonzero(~good)
    low = max(gaps[gaps < here], default=-1) + 1
    high = min(gaps[gaps > here], default=len(requested))
    part = requested[low:high]
    return part[np.argsort(x[part])]


def _fit(x: Array, y: Array, slope: Array, condition: float, every: Array) -> JointPolynomial:
    """The series of the lowest degree that is accurate enough, or the most accurate one."""
    best: tuple[float, Chebyshev] | None = None
    for degree in range(1, min(_HIGHEST, len(x) // 4) + 1):
        series = Chebyshev.fit(x, y, degree)
        error = _error(series, x, y, slope, condition)
        if best is None or error < best[0]:
            best = error, series
        if error < _ENOUGH:
            break
    assert best is not None
    line = Chebyshev.fit(x, y, 1)
    # of a joint at rest the factor is left out
    offset, factor, *_ = (*line.convert(kind=np.polynomial.Polynomial).coef.tolist(), 0.0)
    return JointPolynomial(
        series=best[1],
        error=best[0],
        line=(factor, offset),
        line_error=_error(line, x, y, slope, condition),
        range=(float(every.min()), float(every.max())),
    )


def _error(series: Chebyshev, x: Array, y: Array, slope: Array, condition: float) -> float:
    """The largest difference in the rows and half a row away from them."""
    wrong, steep = np.abs(series(x) - y), np.abs(series.deriv()(x) - slope)
    half = 0.5 * np.diff(x)
    # Newton-Raphson stops within some roundings of a position, times its condition
    rounding = 16.0 * condition * EPSILON * (1.0 + np.abs(y).max())
    ends = np.maximum(wrong[1:] + half * steep[1:], wrong[:-1] + half * steep[:-1])
    return float(ends.max() + rounding)


def _limits(
    robot: Robot, motion: Motion, leading: TreeJoint, x: Array, row: int
) -> tuple[tuple[float, float], tuple[bool, bool]]:
    """The ends of the driven joint's range, and whether dead points are there."""
    names = robot.model.motion_quantities.names
    kind = names.inputs[names.lead]
    lead_values = motion.inputs[names.lead]
    scale = robot.model.units.scale(kind) / robot.per_metre(leading.name)
    values, rates = robot.values(motion)[leading.name]
    slope = float(np.sign(rates[row])) * scale
    ends, stopped = [float(x[0]), float(x[-1])], [False, False]
    if robot.model.untimed is not None:  # limits are at times
        return (ends[0], ends[1]), (False, False)
    step = 1.001 * float(np.diff(x).max())
    for limit in motion.limits:
        at = values[row] + slope * (limit.input - lead_values[row])
        for k, beyond in ((0, ends[0] - at), (1, at - ends[1])):
            if limit.kind is LimitKind.DEAD_POINT and 0.0 <= beyond <= step:
                ends[k], stopped[k] = float(at), True
    return (ends[0], ends[1]), (stopped[0], stopped[1])
