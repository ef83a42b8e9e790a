"""Plates, pins and spacers of a stack of layers, and its bill of materials."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.export.plates.options import Sizes
from linkwork.export.plates.outline import Outline
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.internal import internal
from linkwork.foundation.names import GROUND
from linkwork.results.table import Table

__all__ = ["BASE", "BRIDGE", "Opening", "Pin", "Plate", "PlateStack", "Spacer"]

#: The plates of the ground: below all others, and above them where they need it.
BASE, BRIDGE = GROUND, f"{GROUND} bridge"
#: Columns of a bill of materials, and their units.
_UNITS = {
    "kind": "", "name": "", "lowest layer": "", "highest layer": "", "length": "mm",
    "diameter": "mm", "area": "mm²", "holes": "",
}  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class Opening:
    """A hole or slot; ``name`` is that of its point or guide."""

    name: str
    outline: Outline


@dataclass(frozen=True, kw_only=True, eq=False)
class Plate:
    """A plate of a body, in the body's frame [mm].

    ``core`` and ``radius``: the plate lies within this distance of the convex hulls of the pieces
    of its core, and farther than ``inner`` from the middle of a ring.
    """

    name: str
    body: str
    outline: Outline
    openings: tuple[Opening, ...]
    core: tuple[ComplexArray, ...]
    radius: float
    inner: float = 0.0

    @property
    def area(self) -> float:
        """Area of the material [mm²]."""
        return self.outline.area - sum(own.outline.area for own in self.openings)

    def cut(self, kerf: float) -> tuple[Outline, ...]:
        """The outline and the openings along which a tool of a width moves [mm]."""
        inner = (own.outline.grown(-kerf / 2.0) for own in self.openings)
        return (self.outline.grown(kerf / 2.0), *inner)


@dataclass(frozen=True, kw_only=True)
class Pin:
    """A pin through some plates, at a place in the frame of a body [mm].

    ``fixed``: it fastens plates of one body to each other.
    """

    name: str
    body: str
    place: complex
    plates: frozenset[str]
    fixed: bool = False


@dataclass(frozen=True, kw_only=True)
class Spacer:
    """A ring on a pin between two of its plates; ``layers`` thick, above the layer ``above``."""

    pin: str
    above: int
    layers: int


@internal("plates", "pins", "sizes", "poses", "span", "length", "spacers")
@dataclass(frozen=True, kw_only=True, eq=False)
class PlateStack:
    """Plates in layers, with the pins and spacers between them.

    Parameters
    ----------
    mechanism : str
        The name of the mechanism.
    plates : tuple of Plate
        The base plate is the first.
    pins : tuple of Pin
    layer : Mapping[str, int]
        The layer of every plate, 0 for the base plate.
    sizes : Sizes
        Widths, diameters and thickness [mm].
    poses : Mapping[str, (complex, complex)]
        Origin [mm] and direction of every body in the first position.
    checked : int
        In how many positions no two parts touch.
    proved : bool
        Whether that is proved for all positions between them too.
    contacts : tuple of (str, str)
        Cams with their rollers, which touch as they should.
    open : tuple of str
        Intervals of the input for which it is not.
    notes : tuple of str
        What the plates lack.

    Examples
    --------
    >>> import linkwork as lw, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     stack = lw.example("four-bar").to_plates(f"{folder}/plates.svg")
    >>> sorted(stack.layer.items())
    [('coupler', 2), ('crank', 1), ('ground', 0), ('rocker', 1)]
    >>> stack.proved
    True
    """

    mechanism: str
    plates: tuple[Plate, ...]
    pins: tuple[Pin, ...]
    layer: Mapping[str, int]
    sizes: Sizes
    poses: Mapping[str, tuple[complex, complex]]
    checked: int
    proved: bool
    contacts: tuple[tuple[str, str], ...] = ()
    open: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def layers(self) -> int:
        """The number of layers."""
        return 1 + max(self.layer.values())

    def span(self, pin: Pin) -> tuple[int, int]:
        """The lowest and the highest layer of a pin."""
        own = [self.layer[name] for name in pin.plates]
        return min(own), max(own)

    def length(self, pin: Pin) -> float:
        """Length of a pin that ends flush with its outer plates [mm]."""
        low, high = self.span(pin)
        return (high - low + 1) * self.sizes.thickness

    @cached_property
    def spacers(self) -> tuple[Spacer, ...]:
        """Rings that fill the layers between the plates of a pin."""
        found = []
        for pin in self.pins:
            taken = sorted({self.layer[name] for name in pin.plates})
            for low, high in itertools.pairwise(taken):
                if high - low > 1:
                    found.append(Spacer(pin=pin.name, above=low, layers=high - low - 1))
        return tuple(found)

    @property
    def verdict(self) -> str:
        """What is known of collisions, as a sentence."""
        pairs = (" and ".join(pair) for pair in self.contacts)
        but = f" but {'; '.join(pairs)}" if self.contacts else ""
        if self.proved:
            where = "proved for every position of the table, for pins without play"
            return f"no two parts touch{but}: {where}"
        what = f"no two parts touch{but} in {self.checked} positions of the table"
        return f"{what}: checked for pins without play, not proved" + (
            f" for {', '.join(self.open)}" if self.open else ""
        )

    def bill(self) -> Table:
        """The bill of materials: a row for every plate, pin, fastener and spacer [mm], [mm²].

        ``length`` is the thickness of a plate, and the length of a pin that ends flush.
        """
        nothing, rows = math.nan, []
        for plate in self.plates:
            layer, thickness = self.layer[plate.name], self.sizes.thickness
            count = float(len(plate.openings))
            rows.append(("plate", plate.name, layer, layer, thickness, nothing, plate.area, count))
        for pin in self.pins:
            kind, ends = "fastener" if pin.fixed else "pin", self.span(pin)
            rows.append((kind, pin.name, *ends, self.length(pin), self.sizes.pin, nothing, nothing))
        for own in self.spacers:
            length = own.layers * self.sizes.thickness
            ends = own.above + 1, own.above + own.layers
            rows.append(("spacer", own.pin, *ends, length, self.sizes.spacer, nothing, 1.0))
        columns = zip(*rows, strict=True)
        return Table(
            columns={name: np.array(cells) for name, cells in zip(_UNITS, columns, strict=True)},
            units=_UNITS,
            index="name",
        )

    def to_dict(self) -> dict[str, Any]:
        """The stack as JSON-ready data [mm]."""
        bill = self.bill()
        return {
            "mechanism": self.mechanism,
            "layers": self.layers,
            "proved": self.proved,
            "checked": self.checked,
            "open": list(self.open),
            "notes": list(self.notes),
            "bill": [dict(zip(bill.columns, row, strict=True)) for row in bill.rows()],
        }
