"""A linkage at one position, as the joints that formats of other programs list."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from linkwork.exchange.joint_rows import JointRow
from linkwork.exchange.source import LeftOut
from linkwork.foundation.elementwise import phase
from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.mechanism.driven_input import Input
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.pairs import KinematicPairs

__all__ = ["Drawn", "Exported"]


@dataclass(frozen=True, kw_only=True)
class Exported:
    """A mechanism as a text of another program.

    Parameters
    ----------
    text : str
        The content of a file, or a link.
    left_out : tuple of LeftOut
        What the format cannot carry.

    Examples
    --------
    >>> import linkwork as lw
    >>> made = lw.example("four-bar").exported("pyslvs", at=0)
    >>> made.text[:41]
    'M[J[R, P[0.0, 0.0], L[ground, crank]], J['
    >>> print(made.left_out[0])
    "crank": range or law of the input
    """

    text: str
    left_out: tuple[LeftOut, ...]


class Drawn:
    """A linkage and the places of its points in an assembled position; notes on what is left out.

    Raises
    ------
    InputError
        If the linkage has parts that these formats do not know.
    """

    def __init__(self, linkage: Linkage, places: Mapping[str, complex]) -> None:
        self.linkage, self.places = linkage, places
        self._notes: dict[str, dict[str, None]] = {}
        for key, part in linkage.keyed_parts:
            if part.pairs(linkage) == KinematicPairs():  # it constrains nothing
                self.leave_out(part.label, part.title.lower())
            elif key[0] not in ("slots", "sliders"):
                raise InputError(
                    f'"{part.label}" ({part.title.lower()}) has no equivalent in this format: it '
                    "has pins, slots and sliders only"
                )
        for name in linkage.masses:
            self.leave_out(name, "mass")
        for which in linkage.inputs:
            # the driven pin itself can be written
            given = (which.start, which.stop, which.step)
            if given != (None, None, None) or which.law is not None:
                self.leave_out(which.column, "range or law of the input")

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """What was left out."""
        return tuple(LeftOut(what=w, places=tuple(p)) for w, p in self._notes.items())

    def leave_out(self, place: str, what: str) -> None:
        """Note what is not carried over."""
        self._notes.setdefault(what, {})[f'"{place}"'] = None

    def joints(self) -> Iterator[JointRow]:
        """Pins of points, slots, and sliders, which lie at a point with a pin of its own."""
        slotted = {slot.point for slot in self.linkage.slots}
        for point, at in self.places.items():
            if point not in slotted:
                own = self._carriers(point)
                yield JointRow(place=point, kind="R", at=at, links=own, name=point)
        for slot in self.linkage.slots:
            moving = self._carriers(slot.point)
            yield self._slide("RP", slot.name, slot.point, (slot.on, *moving), slot.line)
        for slider in self.linkage.sliders:
            links = (slider.on, slider.link)
            yield self._slide("P", slider.name, slider.points[0], links, slider.line)

    def _slide(
        self, kind: str, name: str, point: str, links: tuple[str, ...], line: tuple[str, str]
    ) -> JointRow:
        a, b = (self.places[end] for end in line)
        angle = phase(b - a)
        return JointRow(
            place=name, kind=kind, at=self.places[point], links=links, angle=angle, name=point
        )

    def _carriers(self, point: str) -> tuple[str, ...]:
        return tuple(name for name, points in self.linkage.links.items() if point in points)

    def driven_pins(self) -> dict[str, Input]:
        """The inputs by the points whose pins they drive; others are left out."""
        found = {}
        for which in self.linkage.inputs:
            kind, name = which.drives
            pair = {name, which.relative_to or GROUND}
            pins = [name] if kind == "joint" else []
            if kind == "link":
                pins = [p for p in self.places if pair == set(self._carriers(p))]
            if pins:
                found[pins[0]] = which
            else:
                self.leave_out(which.column, "the input: it is no pin of two links")
        return found
