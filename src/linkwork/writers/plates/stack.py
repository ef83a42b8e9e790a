"""The order of layers in which no plate and no pin is in the way of another, by backtracking."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.units import LENGTHS
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.part import KinematicPairs
from linkwork.core.motion.extremes import Boxes, boxes_of, refined
from linkwork.core.motion.higher_rates import check_own_motion
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.writers.plates.construction import Construction, check_webs
from linkwork.writers.plates.outlines import BodyPoses, shapely, shapes_of, variables_of_all
from linkwork.writers.plates.plate import BASE, BRIDGE, Pin, Plate, PlateOptions, PlateStack

_MOST = 200_000  # assignments tried for one number of layers
_FEW = 2_000  # the same, to find the conflicts

#: Two plates by number; a pin (as -1 - its number) and a plate; or two pins.
Conflict = tuple[int, int]


@dataclass(frozen=True, kw_only=True)
class LayerOrder:
    """``layers`` by plate; ``None`` if there is no order, or if an incomplete search gave none.

    ``tried``: the number of assignments that took.
    """

    layers: tuple[int, ...] | None
    complete: bool = True
    tried: int = 0


def find_layers(
    plates: int,
    pins: Sequence[frozenset[int]],
    conflicts: Iterable[Conflict],
    together: Sequence[frozenset[int]] = (),
    most: int = _MOST,
    top: int | None = None,
) -> LayerOrder:
    """An order with as few layers as possible; plate 0 is alone in layer 0.

    Parameters
    ----------
    plates : int
        The number of plates.
    pins : sequence of frozenset of int
        The plates of every pin, which goes through all layers between them.
    conflicts : iterable of Conflict
        Parts that would collide in one layer.
    together : sequence of frozenset of int
        Plates that have to be in one layer: gears in mesh.
    most : int
        Assignments tried for one number of layers, at most.
    top : int, optional
        A plate that is alone in the last layer.

    Notes
    -----
    More layers than plates are never needed: a layer without a plate can be left out.
    """
    known, complete, tried = tuple(conflicts), True, 0
    for count in range(2, plates + 1):
        search = _Search(plates, pins, known, together, top, count, most)
        result = search.place(0)
        tried += most - search.left
        if result:
            return LayerOrder(layers=tuple(search.layer), tried=tried)
        complete = complete and search.left > 0
    return LayerOrder(layers=None, complete=complete, tried=tried)


def obstacles(
    plates: int,
    pins: Sequence[frozenset[int]],
    conflicts: Iterable[Conflict],
    together: Sequence[frozenset[int]] = (),
) -> list[Conflict]:
    """A minimal set of conflicts that allow no order together, as far as short searches show."""
    needed = list(conflicts)
    for conflict in tuple(needed):
        fewer = [other for other in needed if other != conflict]
        result = find_layers(plates, pins, fewer, together, _FEW)
        if result.layers is None and result.complete:
            needed = fewer
    return needed


@dataclass
class _Search:
    """Depth-first search with ``count`` layers; ``left``: assignments that may still be tried."""

    plates: int
    pins: Sequence[frozenset[int]]
    conflicts: Sequence[Conflict]
    together: Sequence[frozenset[int]]
    top: int | None
    count: int
    left: int
    layer: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.layer = [0] + [-1] * (self.plates - 1)
        placed, last = {0}, self.count
        if self.top is not None:
            placed, last = {0, self.top}, self.count - 1
            self.layer[self.top] = last
        self.free = range(1, last)
        #: The conflicts of every plate, and those of the pins through it too.
        named = [[c for c in self.conflicts if k in c] for k in range(self.plates)]
        self.concerned = [
            [c for c in self.conflicts if any(k in _plates_of(part, self.pins) for part in c)]
            for k in range(self.plates)
        ]
        # plates next to those placed already, the most constrained first
        self.order = []
        while len(placed) < self.plates:
            joined = {k for held in self.pins if held & placed for k in held} - placed
            rest = joined or set(range(self.plates)) - placed
            chosen = max(rest, key=lambda k: (len(named[k]), -k))
            self.order.append(chosen)
            placed.add(chosen)

    def place(self, depth: int) -> bool:
        """Assign layers to the plates from ``depth`` on."""
        if depth == len(self.order):
            return True
        plate = self.order[depth]
        for layer in self.free:
            if self.left <= 0:
                return False
            self.left -= 1
            self.layer[plate] = layer
            if self._fits(plate) and self.place(depth + 1):
                return True
        self.layer[plate] = -1
        return False

    def _fits(self, plate: int) -> bool:
        for group in self.together:
            if plate in group and any(self.layer[k] not in (self.layer[plate], -1) for k in group):
                return False
        return not any(meet(c, self.layer, self.pins) for c in self.concerned[plate])


def _plates_of(part: int, pins: Sequence[frozenset[int]]) -> frozenset[int]:
    """A plate itself, or the plates of a pin."""
    return frozenset((part,)) if part >= 0 else pins[-1 - part]


def meet(conflict: Conflict, layers: Sequence[int], pins: Sequence[frozenset[int]]) -> bool:
    """Whether two parts share a layer; plates without one have the layer -1."""
    (low, high), (below, above) = (_occupied(part, layers, pins) for part in conflict)
    return max(low, below) <= min(high, above)


def _occupied(part: int, layers: Sequence[int], pins: Sequence[frozenset[int]]) -> tuple[int, int]:
    """The first and the last layer of a part; a pin has those between its outer plates."""
    if part >= 0:
        return layers[part], layers[part]
    held = [layers[k] for k in pins[-1 - part] if layers[k] >= 0]
    return (min(held) + 1, max(held) - 1) if held else (1, 0)


# ----------------------------------------------------------------------
# Which plates and pins collide, and the proof that those of one layer do not.


_MOST_BOXES = 60_000  # that a proof may take in all


@dataclass(frozen=True, kw_only=True)
class Proved:
    """``open``: intervals of the leading input [internal unit] without a proof; ``hit``: parts
    that touch in a position between the rows.
    """

    open: tuple[tuple[float, float], ...]
    hit: frozenset[Conflict]


class Collisions:
    """Distances of the parts of a stack in positions.

    Parameters
    ----------
    plates : sequence of Plate
    pins : sequence of Pin
    meshes : sequence of frozenset of str
        Plates of gears in mesh, whose teeth are proved by themselves.
    spacer : float
        Outer radius of spacers on pins [mm].
    """

    def __init__(
        self,
        plates: Sequence[Plate],
        pins: Sequence[Pin],
        meshes: Sequence[frozenset[str]],
        spacer: float,
    ) -> None:
        self.plates, self.pins, self.meshes, self.spacer = plates, pins, meshes, spacer

    @cached_property
    def joined(self) -> list[frozenset[int]]:
        """The numbers of the plates of every pin."""
        return self._numbers(pin.plates for pin in self.pins)

    @cached_property
    def together(self) -> list[frozenset[int]]:
        """The numbers of plates in contact, which share a layer."""
        return self._numbers(self.meshes)

    def _numbers(self, groups: Iterable[frozenset[str]]) -> list[frozenset[int]]:
        number = {plate.name: k for k, plate in enumerate(self.plates)}
        return [frozenset(number[name] for name in names) for names in groups]

    def pairs(self) -> Iterator[Conflict]:
        """All pairs of parts that may collide: plates, pins and plates without their hole, pins.

        The base plate and a bridge are alone in their layers.
        """
        moving = [k for k, plate in enumerate(self.plates) if k and plate.name != BRIDGE]
        for a, b in itertools.combinations(moving, 2):
            if frozenset((self.plates[a].name, self.plates[b].name)) not in self.meshes:
                yield a, b
        for p, pin in enumerate(self.pins):
            others = (k for k in moving if self.plates[k].name not in pin.plates)
            yield from ((-1 - p, k) for k in others)
        yield from ((-1 - p, -1 - q) for p, q in itertools.combinations(range(len(self.pins)), 2))

    def name(self, part: int) -> str:
        """The name of a part in messages."""
        return self.plates[part].name if part >= 0 else f"pin {self.pins[-1 - part].name}"

    @cached_property
    def _shapes(self) -> dict[int, tuple[str, tuple[ComplexArray, ...], float]]:
        """Body, core and radius of every part."""
        shapes = {k: (x.body, x.core, x.radius) for k, x in enumerate(self.plates)}
        for p, pin in enumerate(self.pins):
            shapes[-1 - p] = (pin.body, (np.array([pin.place]),), self.spacer)
        return shapes

    @cached_property
    def _reach(self) -> dict[int, float]:
        """How far parts extend from the origin of their body [mm]."""
        return {
            k: float(np.abs(np.concatenate(core)).max()) + radius
            for k, (_, core, radius) in self._shapes.items()
        }

    def distances(
        self, pairs: Iterable[Conflict], poses: Mapping[str, tuple[ComplexArray, ComplexArray]]
    ) -> Iterator[tuple[Conflict, Array]]:
        """The distance of each pair in all positions [mm], (B,); negative where they overlap."""
        made: dict[int, Any] = {}
        for a, b in pairs:
            for part in (a, b):
                if part not in made:
                    body, core, _ = self._shapes[part]
                    origin, turn = poses[body]
                    made[part] = _geometries(origin, turn, core)
            radii = self._shapes[a][2] + self._shapes[b][2]
            distance = shapely().distance(made[a], made[b]) - radii
            for ring, other in ((a, b), (b, a)):
                if ring >= 0 and self.plates[ring].inner:
                    distance = np.maximum(distance, self._inside(ring, other, poses))
            yield (a, b), distance

    def _inside(
        self, ring: int, other: int, poses: Mapping[str, tuple[ComplexArray, ComplexArray]]
    ) -> Array:
        """How far a part is from the inner edge of a ring around it [mm], (B,)."""
        (origin, turn), plate = poses[self.plates[ring].body], self.plates[ring]
        body, core, radius = self._shapes[other]
        there, by = poses[body]
        center = origin + turn * plate.core[0][0]
        places = there[:, None] + by[:, None] * np.concatenate(core)
        away = np.abs(places - center[:, None]).max(axis=1)
        gap: Array = plate.inner - away - radius
        return gap

    def conflicts(
        self,
        poses: Mapping[str, tuple[ComplexArray, ComplexArray]],
        gap: float,
        progress: Callable[[float], None] | None = None,
    ) -> frozenset[Conflict]:
        """Pairs nearer than the gap in one of the positions."""
        conflicts, every = set(), list(self.pairs())
        for k, (pair, distance) in enumerate(self.distances(every, poses), start=1):
            if distance.min() < gap:
                conflicts.add(pair)
            if progress is not None:
                progress(k / len(every))
        return frozenset(conflicts)

    def meeting(self, layers: Sequence[int]) -> list[Conflict]:
        """The pairs that share a layer."""
        return [pair for pair in self.pairs() if meet(pair, layers, self.joined)]

    def moves(self, spread: Mapping[str, tuple[Array, Array]], part: int) -> Array:
        """How far any point of a part moves at most in boxes [mm], (B,)."""
        moved, turned = spread[self._shapes[part][0]]
        return moved + self._reach[part] * turned


def _geometries(origin: ComplexArray, turn: ComplexArray, core: Sequence[ComplexArray]) -> Any:
    """A core in positions (B,): a geometry, or a collection of those of its pieces."""
    pieces = [shapes_of(origin[:, None] + turn[:, None] * piece) for piece in core]
    if len(pieces) == 1:
        return pieces[0]
    return shapely().geometrycollections(np.stack(pieces, axis=-1))


def prove_clear(
    model: Model,
    poses: BodyPoses,
    collisions: Collisions,
    layers: Sequence[int],
    boxes: Boxes,
    slots: Callable[[Boxes], BoolArray],
    progress: Callable[[float], None] | None = None,
) -> Proved:
    """Prove that parts that share a layer touch in no position of the boxes.

    Parameters
    ----------
    model : Model
    layers : sequence of int
        By plate.
    boxes : Boxes
        Of all positions.
    slots : callable
        Whether the pins of slots stay inside them in boxes, (B,).

    Notes
    -----
    Parts stay apart in a box if their distance in its middle exceeds the motion of both. Other
    boxes are divided, and their halves likewise.
    """
    pairs, hit = collisions.meeting(layers), set[Conflict]()

    def decide(boxes: Boxes) -> BoolArray | None:
        clear = boxes.holds & slots(boxes)
        spread = poses.spread(boxes)
        moves = {part: collisions.moves(spread, part) for pair in pairs for part in pair}
        for pair, distance in collisions.distances(pairs, poses.of(boxes.v)):
            if (distance[boxes.known] <= 0.0).any():
                hit.add(pair)
            clear &= distance > moves[pair[0]] + moves[pair[1]]
        return None if hit else clear

    low, high = refined(model, boxes, decide, most=_MOST_BOXES, progress=progress).ends
    return Proved(open=tuple(zip(low.tolist(), high.tolist(), strict=True)), hit=frozenset(hit))


# ----------------------------------------------------------------------
# A bridge: a second plate of the ground on columns above all plates, for some of its pins.


def columns_around(
    made: Construction, poses: dict[str, tuple[ComplexArray, ComplexArray]]
) -> tuple[complex, ...]:
    """Places of columns at the corners of the box in which all moving plates stay [mm]."""
    lows, highs = [], []
    for plate in made.plates:
        if plate.body != GROUND:
            origin, turn = poses[plate.body]
            z = origin[:, None] + turn[:, None] * np.concatenate(plate.core)
            lows.append((z.real.min() - plate.radius, z.imag.min() - plate.radius))
            highs.append((z.real.max() + plate.radius, z.imag.max() + plate.radius))
    room = made.sizes.spacer / 2.0 + 2.0 * made.sizes.gap
    low, high = np.min(lows, axis=0) - room, np.max(highs, axis=0) + room
    return tuple(complex(x, y) for x, y in itertools.product(*zip(low, high, strict=True)))


def bridged(
    made: Construction, corners: Sequence[complex]
) -> Iterator[tuple[list[Plate], list[Pin]]]:
    """The plates and pins with a bridge, for every choice of pins that it holds, few first.

    The bridge is the last plate; columns are the last pins.
    """
    main_pins = [
        pin.name
        for pin in made.pins
        if BASE in pin.plates and pin.name in made.holes[GROUND] and not pin.fixed
    ]
    columns = {f"column {k}": place for k, place in enumerate(corners, start=1)}
    both = frozenset((BASE, BRIDGE))
    held = [
        Pin(name=name, body=GROUND, place=place, plates=both, fixed=True)
        for name, place in columns.items()
    ]
    for count in range(1, len(main_pins) + 1):
        for chosen in itertools.combinations(main_pins, count):
            holes = {name: made.holes[GROUND][name] for name in chosen}
            below = {name: z for name, z in made.holes[GROUND].items() if name not in chosen}
            base = made.ground_plate(BASE, below | columns)
            bridge = made.ground_plate(BRIDGE, holes | columns)
            pins = [
                replace(pin, plates=(pin.plates - {BASE}) | {BRIDGE}) if pin.name in chosen else pin
                for pin in made.pins
            ]
            yield [base, *made.plates[1:], bridge], [*pins, *held]


# ----------------------------------------------------------------------
# A mechanism as a stack of plates: constructed, layered, and proved to be free of collisions.


_SAMPLED = 0.3  # finished fraction once the rows are compared
_MOST_WITH_BRIDGES = 500_000  # assignments of layers tried, with all choices of pins together
_OUTWARDS = 1.25  # of their distance from the middle: columns hit between the rows, once more


def stack_of(
    model: Model,
    motion: Motion,
    options: PlateOptions,
    progress: Callable[[float], None] | None = None,
) -> PlateStack:
    """Plates of a mechanism in layers in which nothing collides during a motion.

    Parameters
    ----------
    model : Model
    motion : Motion
        The positions that must be free of collisions.
    options : PlateOptions
    progress : callable, optional
        Called with the finished fraction.

    Raises
    ------
    InputError
        If the mechanism cannot be made of plates, or there is no order of layers.
    """
    check_own_motion(model, motion)
    linkage = _checked(model, motion)
    millimetres = 1000.0 * float(LENGTHS[linkage.length])
    made = Construction.of(model, motion, options, millimetres)
    notes = _notes(linkage, motion, made, millimetres * model.equations.length_scale)
    tell = progress or (lambda fraction: None)
    bodies = [plate.body for plate in made.plates]
    poses = BodyPoses(model, list(dict.fromkeys(bodies)), millimetres)
    boxes = boxes_of(model, motion, variables_of_all(model, motion))
    placed = poses.of(boxes.v)
    collisions = Collisions(made.plates, made.pins, made.meshes, made.sizes.spacer / 2.0)
    conflicts = collisions.conflicts(placed, made.sizes.gap, lambda x: tell(_SAMPLED * x))
    corners = columns_around(made, placed)
    while True:
        layered, layers = _layers(collisions, conflicts, made, corners)
        proof = prove_clear(
            model, poses, layered, layers, boxes, _in_slots(model, made, millimetres),
            lambda x: tell(_SAMPLED + (1.0 - _SAMPLED) * x),
        )  # fmt: skip
        if not proof.hit:
            break
        of_columns = {pair for pair in proof.hit if -1 - min(pair) >= len(made.pins)}
        if of_columns:
            middle = sum(corners) / len(corners)
            corners = tuple(middle + _OUTWARDS * (z - middle) for z in corners)
        conflicts |= proof.hit - of_columns
    return PlateStack(
        mechanism=linkage.name,
        plates=tuple(layered.plates),
        pins=tuple(layered.pins),
        layer={plate.name: layers[k] for k, plate in enumerate(layered.plates)},
        sizes=made.sizes,
        poses={name: (complex(z[0]), complex(turn[0])) for name, (z, turn) in placed.items()},
        checked=len(boxes.v),
        proved=not proof.open,
        contacts=tuple(made.contacts),
        open=_intervals(model, boxes.lead, proof),
        notes=tuple(notes),
    )


def _checked(model: Model, motion: Motion) -> Linkage:
    """The linkage; refuse mechanisms without plates."""
    linkage = model.description
    if not isinstance(linkage, Linkage):
        raise InputError(
            f'mechanism "{linkage.name}" is given by equations: plates need points and links'
        )
    if linkage.length not in LENGTHS:
        known = ", ".join(LENGTHS)
        raise InputError(
            f'"{linkage.length}" cannot be converted to millimetres: write length = one of {known}'
        )
    if not motion.found.any():
        raise InputError(f"there is no position to make plates for: {motion.message}")
    return linkage


def _notes(linkage: Linkage, motion: Motion, made: Construction, longest: float) -> list[str]:
    """What the plates lack; refuse redundant links that are too far from fitting."""
    notes = list(made.notes)
    lost = int(np.count_nonzero(~motion.found))
    if lost:
        notes.append(f"{lost} of {len(motion)} rows of the table have no position: left out")
    nothing = KinematicPairs()
    left = [part.label for part in linkage.parts if part.pairs(linkage) == nothing]
    if left:
        notes.append(f"not made: {', '.join(left)}")
    for link, error in motion.redundant.items():
        missing = error * longest
        if missing > made.sizes.clearance / 2.0:
            raise InputError(
                f'the redundant link "{link}" misses its length by {missing:.3g} mm, more than '
                f"half the clearance of the pins, {made.sizes.clearance / 2.0:.3g} mm"
            )
        notes.append(f"{link} is redundant: it jams unless it is made to the clearance of the pins")
    return notes


def _layers(
    collisions: Collisions,
    conflicts: frozenset[Conflict],
    made: Construction,
    corners: tuple[complex, ...],
) -> tuple[Collisions, tuple[int, ...]]:
    """The parts, with a bridge only if they need one, and the layer of every plate."""
    order, ordered = _order(collisions, conflicts), sorted(conflicts)
    if order.layers is not None:
        return collisions, order.layers
    complete, left = order.complete, _MOST_WITH_BRIDGES
    for plates, pins in bridged(made, corners):
        if left <= 0:
            complete = False
            break
        with_bridge = Collisions(plates, pins, made.meshes, collisions.spacer)
        order = _order(with_bridge, conflicts, top=len(plates) - 1)
        if order.layers is not None:
            for plate in (plates[0], plates[-1]):
                check_webs(plate, made.sizes)
            return with_bridge, order.layers
        complete, left = complete and order.complete, left - order.tried
    if not complete:
        raise InputError(
            f"no order of layers was found for {len(made.plates)} plates: the search was given "
            "up; narrower bars collide less, see --width"
        )
    pairs = (
        f"{collisions.name(a)} and {collisions.name(b)}"
        for a, b in obstacles(len(made.plates), collisions.joined, ordered, collisions.together)
    )
    raise InputError(
        "no order of layers lets this mechanism move, nor with a bridge over it: these meet and "
        f"cannot all be in different layers: {'; '.join(pairs)}. Narrower bars, see --width, or a "
        "part of the table, see --from, collide less"
    )


def _order(
    collisions: Collisions, conflicts: frozenset[Conflict], top: int | None = None
) -> LayerOrder:
    count = len(collisions.plates)
    return find_layers(count, collisions.joined, sorted(conflicts), collisions.together, top=top)


def _in_slots(model: Model, made: Construction, millimetres: float) -> Callable[[Boxes], BoolArray]:
    """Whether all displacements of guides stay within their slots in boxes."""
    names = [variable.name for variable in (model.untimed or model).equations.variables]
    columns = [(names.index(way.name), *made.travel[way.name]) for way in made.ways]

    def inside(boxes: Boxes) -> BoolArray:
        held = np.ones(len(boxes.v), dtype=bool)
        for k, low, high in columns:
            value, bound = millimetres * boxes.v[:, k], millimetres * boxes.bound[:, k]
            held &= value - bound >= low - made.sizes.play
            held &= value + bound <= high + made.sizes.play
        return held

    return inside


def _intervals(model: Model, lead: int, proof: Proved) -> tuple[str, ...]:
    """Intervals of the leading input without a proof, joined, in file units."""
    timeless = model.untimed or model
    variable = timeless.equations.inputs[lead]
    scale = float(timeless.input_scale[lead])
    unit = timeless.input_units[variable.name]
    joined: list[list[float]] = []
    for low, high in sorted(proof.open):
        if not np.isfinite([low, high]).all():
            return ()
        if joined and low <= joined[-1][1] + 1e-9 * max(1.0, abs(low)):
            joined[-1][1] = max(joined[-1][1], high)
        else:
            joined.append([low, high])
    ends = ((f"{a / scale:.6g}", f"{b / scale:.6g}") for a, b in joined)
    return tuple(f"{a} {unit}" if a == b else f"{a} to {b} {unit}" for a, b in ends)
