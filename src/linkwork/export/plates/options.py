"""What a workshop chooses: widths, pins, clearance, kerf and thickness of plates."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from linkwork.foundation.errors import InputError
from linkwork.foundation.plain_numbers import finite_number

__all__ = ["PlateOptions", "Sizes", "sizes_of"]

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
    >>> lw.PlateOptions(width=14, kerf=0.15).kerf
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
            given = getattr(self, field.name)
            if field.name == "labels" or given is None:
                continue
            number = finite_number(field.name, given)
            may_vanish = field.name in ("clearance", "kerf", "gap", "backlash")
            if number < 0.0 or (number == 0.0 and not may_vanish):
                what = "zero or more" if may_vanish else "positive"
                raise InputError(f"{field.name} must be {what}, got {number:g}")


@dataclass(frozen=True, kw_only=True)
class Sizes:
    """All sizes in millimetres; ``web`` is the least material between two openings."""

    width: float
    fillet: float
    pin: float
    clearance: float
    kerf: float
    thickness: float
    gap: float
    module: float | None
    backlash: float | None
    sheet: float | None
    labels: bool

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
    own = {
        field.name: None if getattr(options, field.name) is None
        else millimetres * getattr(options, field.name)
        for field in fields(options) if field.name != "labels"
    }  # fmt: skip
    width = own["width"] or _preferred(min(_WIDTH * longest, nearest))
    pin = own["pin"] or _preferred(_PIN * width)
    sizes = Sizes(
        width=width,
        fillet=own["fillet"] or width,
        pin=pin,
        clearance=_CLEARANCE * pin if own["clearance"] is None else own["clearance"],
        kerf=own["kerf"] or 0.0,
        thickness=own["thickness"] or _preferred(_THICKNESS * width),
        gap=_GAP * width if own["gap"] is None else own["gap"],
        module=own["module"],
        backlash=own["backlash"],
        sheet=own["sheet"],
        labels=options.labels,
    )
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
