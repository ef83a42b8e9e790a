"""What a workshop chooses: widths, pins, clearance, kerf and thickness of plates."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.errors import InputError, internal
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.values import finite_number
from linkwork.core.results.tables import Table
from linkwork.writers.plates.outlines import Outline, circle

_STEPS = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)
_WIDTH, _PIN, _THICKNESS, _GAP = 0.12, 0.4, 0.25, 0.05  # of the longest link; of the width
_CLEARANCE, _BACKLASH = 0.025, 0.05  # of the pin; of the module of gears
_SPACER, _WEB = 0.75, 0.25  # of the width; of the wall beside a hole


@dataclass(frozen=True, kw_only=True)
class PlateOptions:
    """Sizes of plates, in the mechanism's length unit; by default in proportion to it.

    Parameters
    ----------
    width : number, optional
        Width of bars, and of the arms of plates with three or more holes.
    fillet : number, optional
        Radius of inner corners between arms; plates whose arms have no room for it are filled.
    pin : number, optional
        Diameter of pins.
    clearance : number, optional
        Diameter of holes minus that of their pins.
    kerf : number
        Width of the cut: outlines are moved outwards, holes inwards by half of it.
    thickness : number, optional
        Thickness of plates.
    gap : number, optional
        Least distance of moving plates in one layer.
    module : number, optional
        Module of gears given by radii, as near as whole numbers of teeth allow.
    backlash : number, optional
        Backlash of gears on the pitch circle.
    sheet : number, optional
        Width of the sheet on which plates are laid out.
    labels : bool
        Whether every plate has its name as text to engrave.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.writers.PlateOptions(width=14, kerf=0.15).kerf
    0.15
    """

    width: float | None = None
    fillet: float | None = None
    pin: float | None = None
    clearance: float | None = None
    kerf: float = 0.0
    thickness: float | None = None
    gap: float | None = None
    module: float | None = None
    backlash: float | None = None
    sheet: float | None = None
    labels: bool = False

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name == "labels" or value is None:
                continue
            number = finite_number(field.name, value)
            may_vanish = field.name in ("clearance", "kerf", "gap", "backlash")
            if number < 0.0 or (number == 0.0 and not may_vanish):
                what = "zero or more" if may_vanish else "positive"
                raise InputError(f"{field.name} must be {what}, got {number:g}")


@dataclass(frozen=True, kw_only=True)
class Sizes(PlateOptions):
    """All sizes in millimetres; ``web`` is the least material between two openings."""

    width: float
    fillet: float
    pin: float
    clearance: float
    thickness: float
    gap: float

    @property
    def hole(self) -> float:
        """Diameter of holes."""
        return self.pin + self.clearance

    @property
    def wall(self) -> float:
        """Material beside a hole in a bar."""
        return (self.width - self.hole) / 2.0

    @property
    def web(self) -> float:
        """Least material between two openings, or between an opening and the outline."""
        return _WEB * self.wall

    @property
    def spacer(self) -> float:
        """Outer diameter of spacers."""
        return max(_SPACER * self.width, self.pin)

    @property
    def play(self) -> float:
        """How much longer slots are at each end than the motion needs."""
        return self.hole / 4.0

    def backlash_of(self, module: float) -> float:
        """Backlash of gears of a module."""
        return _BACKLASH * module if self.backlash is None else self.backlash


def sizes_of(options: PlateOptions, millimetres: float, longest: float, nearest: float) -> Sizes:
    """All sizes [mm].

    Parameters
    ----------
    options : PlateOptions
    millimetres : float
        Per length unit of the file.
    longest, nearest : float
        The longest link, and the least distance of two holes in one plate [mm].

    Raises
    ------
    InputError
        If a hole is wider than its bar, or the cut than a hole or an inner corner.
    """
    stated = {
        name: value if value is None or name == "labels" else millimetres * value
        for name, value in vars(options).items()
    }
    width = stated["width"] or _preferred(min(_WIDTH * longest, nearest))
    pin = stated["pin"] or _preferred(_PIN * width)
    usual = {
        "width": width,
        "fillet": width,
        "pin": pin,
        "clearance": _CLEARANCE * pin,
        "thickness": _preferred(_THICKNESS * width),
        "gap": _GAP * width,
    }
    sizes = Sizes(**stated | {k: size for k, size in usual.items() if stated[k] is None})
    if sizes.wall <= 0.0:
        raise InputError(
            f"holes of {sizes.hole:g} mm do not fit into bars of {width:g} mm: "
            "choose a larger width or smaller pins"
        )
    if sizes.kerf >= sizes.hole:
        raise InputError(
            f"a kerf of {sizes.kerf:g} mm leaves nothing of holes of {sizes.hole:g} mm"
        )
    if sizes.kerf >= 2.0 * sizes.fillet:
        raise InputError(
            f"a cut of {sizes.kerf:g} mm is too wide for inner corners with a radius of "
            f"{sizes.fillet:g} mm: choose a larger fillet"
        )
    return sizes


def _preferred(size: float) -> float:
    """The largest of the usual numbers 1, 1.2, 1.5, … that is not above a size."""
    power = 10.0 ** math.floor(math.log10(size))
    return max(step for step in _STEPS if step * power <= size * (1.0 + 1e-9)) * power


# ----------------------------------------------------------------------
# Plates, pins and spacers of a stack of layers, and its bill of materials.


#: The plates of the ground: below all other plates, and above them where necessary.
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


def round_holes(places: Mapping[str, complex], sizes: Sizes) -> tuple[Opening, ...]:
    """Holes for pins at places by their names."""
    return tuple(
        Opening(name=name, outline=circle(place, sizes.hole / 2.0))
        for name, place in places.items()
    )


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
        return self.outline.area - sum(opening.outline.area for opening in self.openings)

    def cut(self, kerf: float) -> tuple[Outline, ...]:
        """The outline and the openings along which a tool of a width moves [mm]."""
        inner = (opening.outline.grown(-kerf / 2.0) for opening in self.openings)
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
    ...     stack = lw.example("four-bar").write(f"{folder}/plates.svg", kind="plates")
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
        layers = [self.layer[name] for name in pin.plates]
        return min(layers), max(layers)

    def length(self, pin: Pin) -> float:
        """Length of a pin that ends flush with its outer plates [mm]."""
        low, high = self.span(pin)
        return (high - low + 1) * self.sizes.thickness

    @cached_property
    def spacers(self) -> tuple[Spacer, ...]:
        """Rings that fill the layers between the plates of a pin."""
        spacers = []
        for pin in self.pins:
            taken = sorted({self.layer[name] for name in pin.plates})
            for low, high in itertools.pairwise(taken):
                if high - low > 1:
                    spacers.append(Spacer(pin=pin.name, above=low, layers=high - low - 1))
        return tuple(spacers)

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
        for spacer in self.spacers:
            length = spacer.layers * self.sizes.thickness
            ends = spacer.above + 1, spacer.above + spacer.layers
            rows.append(("spacer", spacer.pin, *ends, length, self.sizes.spacer, nothing, 1.0))
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
