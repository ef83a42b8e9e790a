"""Which plates and pins collide, and the proof that those of one layer do not."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.export.plates.body_poses import BodyPoses
from linkwork.export.plates.layer_order import Conflict
from linkwork.export.plates.packages import shapely
from linkwork.export.plates.plate import BRIDGE, Pin, Plate
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.motion.model import Model
from linkwork.motion.motion_boxes import Boxes, refined

__all__ = ["Collisions", "Proved", "prove_clear"]

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
        number = {plate.name: k for k, plate in enumerate(self.plates)}
        return [frozenset(number[name] for name in pin.plates) for pin in self.pins]

    @cached_property
    def together(self) -> list[frozenset[int]]:
        """The numbers of plates in contact, which share a layer."""
        number = {plate.name: k for k, plate in enumerate(self.plates)}
        return [frozenset(number[name] for name in mesh) for mesh in self.meshes]

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
        own = {k: (x.body, x.core, x.radius) for k, x in enumerate(self.plates)}
        for p, pin in enumerate(self.pins):
            own[-1 - p] = (pin.body, (np.array([pin.place]),), self.spacer)
        return own

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
        found: Array = plate.inner - away - radius
        return found

    def conflicts(
        self,
        poses: Mapping[str, tuple[ComplexArray, ComplexArray]],
        gap: float,
        progress: Callable[[float], None] | None = None,
    ) -> frozenset[Conflict]:
        """Pairs nearer than the gap in one of the positions."""
        found, every = set(), list(self.pairs())
        for k, (pair, distance) in enumerate(self.distances(every, poses), start=1):
            if distance.min() < gap:
                found.add(pair)
            if progress is not None:
                progress(k / len(every))
        return frozenset(found)

    def meeting(self, layers: Sequence[int]) -> list[Conflict]:
        """The pairs that share a layer."""
        spans = [
            sorted(layers[k] for k, plate in enumerate(self.plates) if plate.name in pin.plates)
            for pin in self.pins
        ]

        def meet(a: int, b: int) -> bool:
            if a >= 0:
                return layers[a] == layers[b]
            low, high = spans[-1 - a][0], spans[-1 - a][-1]
            if b >= 0:
                return low < layers[b] < high
            return max(low, spans[-1 - b][0]) + 1 < min(high, spans[-1 - b][-1])

        return [(a, b) for a, b in self.pairs() if meet(a, b)]

    def moves(self, spread: Mapping[str, tuple[Array, Array]], part: int) -> Array:
        """How far any point of a part moves at most in boxes [mm], (B,)."""
        moved, turned = spread[self._shapes[part][0]]
        return moved + self._reach[part] * turned


def _geometries(origin: ComplexArray, turn: ComplexArray, core: Sequence[ComplexArray]) -> Any:
    """A core in positions (B,): a geometry, or a collection of those of its pieces."""
    pieces = [_convex(origin[:, None] + turn[:, None] * piece) for piece in core]
    if len(pieces) == 1:
        return pieces[0]
    return shapely().geometrycollections(np.stack(pieces, axis=-1))


def _convex(z: ComplexArray) -> Any:
    """Points, lines or polygons with corners (B, n)."""
    coordinates = np.stack([z.real, z.imag], axis=-1)
    if z.shape[1] == 1:
        return shapely().points(coordinates[:, 0])
    make = shapely().linestrings if z.shape[1] == 2 else shapely().polygons
    return make(coordinates)


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
    Parts stay apart in a box if their distance in its middle exceeds what both can move. A box
    in which they may not is divided, and those are that come of it.
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
