"""The order of layers in which no plate and no pin is in the way of another, by backtracking."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

__all__ = ["Conflict", "LayerOrder", "find_layers", "obstacles"]

_MOST = 200_000  # assignments tried for one number of layers
_FEW = 2_000  # the same, to find what is in the way

#: Two plates by number; a pin (as -1 - its number) and a plate; or two pins.
Conflict = tuple[int, int]


@dataclass(frozen=True, kw_only=True)
class LayerOrder:
    """``layers`` by plate; ``None`` if there is no order, or, not ``complete``, none was found.

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
        found = search.place(0)
        tried += most - search.left
        if found:
            return LayerOrder(layers=tuple(search.layer), tried=tried)
        complete = complete and search.left > 0
    return LayerOrder(layers=None, complete=complete, tried=tried)


def obstacles(
    plates: int,
    pins: Sequence[frozenset[int]],
    conflicts: Iterable[Conflict],
    together: Sequence[frozenset[int]] = (),
) -> list[Conflict]:
    """Conflicts that allow no order together; in short searches none of them can be left out."""
    needed = list(conflicts)
    for conflict in tuple(needed):
        fewer = [own for own in needed if own != conflict]
        found = find_layers(plates, pins, fewer, together, _FEW)
        if found.layers is None and found.complete:
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
        self.apart: list[set[int]] = [set() for _ in range(self.plates)]
        self.blocked: list[set[int]] = [set() for _ in self.pins]  # plates in the way of a pin
        self.crossed: list[set[int]] = [set() for _ in self.pins]  # pins in the way of a pin
        for a, b in self.conflicts:
            if a >= 0 and b >= 0:
                self.apart[a].add(b)
                self.apart[b].add(a)
            elif a < 0 and b < 0:
                self.crossed[-1 - a].add(-1 - b)
                self.crossed[-1 - b].add(-1 - a)
            else:
                self.blocked[-1 - min(a, b)].add(max(a, b))
        self.on: list[list[int]] = [
            [p for p, own in enumerate(self.pins) if k in own] for k in range(self.plates)
        ]
        self.near: list[list[int]] = [
            [p for p, own in enumerate(self.blocked) if k in own] for k in range(self.plates)
        ]
        # plates next to those placed already, the most constrained first
        self.order = []
        while len(placed) < self.plates:
            joined = {k for own in self.pins if own & placed for k in own} - placed
            rest = joined or set(range(self.plates)) - placed
            chosen = max(rest, key=lambda k: (len(self.apart[k]) + len(self.near[k]), -k))
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
        own = self.layer[plate]
        if any(self.layer[k] == own for k in self.apart[plate]):
            return False
        for group in self.together:
            if plate in group and any(self.layer[k] not in (own, -1) for k in group):
                return False
        for pin in self.near[plate]:
            low, high = self._span(pin)
            if low < own < high:
                return False
        for pin in self.on[plate]:
            low, high = self._span(pin)
            if high - low < 2:
                continue
            if any(low < self.layer[k] < high for k in self.blocked[pin]):
                return False
            for other in self.crossed[pin]:
                below, above = self._span(other)
                if max(low, below) + 1 < min(high, above):
                    return False
        return True

    def _span(self, pin: int) -> tuple[int, int]:
        """The layers between which a pin runs so far."""
        own = [self.layer[k] for k in self.pins[pin] if self.layer[k] >= 0]
        return (min(own), max(own)) if own else (0, 0)
