"""Rack and pinion: a pinion rolls along a slider."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from linkwork.foundation.errors import choices
from linkwork.foundation.file_keys import Key, Number as NumberKey, Text
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.figures import Disc, Figure, Outlines
from linkwork.mechanism.joint import JointKind
from linkwork.mechanism.part.pairs import Coupling, KinematicPairs
from linkwork.mechanism.part.part import LINK, POINT, SLIDER, PartChecks
from linkwork.mechanism.part.slider import Slider
from linkwork.mechanism.part.toothed import PRESSURE_KEY, ToothedPart

__all__ = ["Rack", "RackBar"]


@dataclass(frozen=True, kw_only=True)
class RackBar(Figure):
    """A slider as a rack, and the pinion that meshes with it."""

    slider: str
    link: str
    center: str
    radius: float


@dataclass(frozen=True, kw_only=True)
class Rack(ToothedPart):
    """A rack and pinion: the displacement of a slider equals the arc rolled by the pinion.

    The sketch selects the side of the rack on which the pinion is.

    Parameters
    ----------
    name : str
        The name of the rack and pinion.
    pinion : str
        The rotating link.
    center : str
        Its centre of rotation, on the link along which the rack slides.
    slider : str
        The slider that is the rack.
    radius : number
        Pitch radius of the pinion [length].
    pressure_angle : number, optional
        Pressure angle of the teeth [file's angle unit], for forces; 20 degrees unless given.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Rack(name="mesh", pinion="pinion", center="G", slider="s", radius=20).slider
    's'
    >>> motion = lw.example("rack-and-pinion").sweep(start=90, stop=180, step=90)
    >>> turn = motion["pinion"][0] - motion["pinion"][1]
    >>> stroke = motion["s"][0] - motion["s"][1]
    >>> round(float(abs(stroke / turn)) * 180 / 3.141592653589793, 6)
    20.0
    """

    title = "Rack and pinion"
    doc = "A rack that slides and the pinion that drives it"
    keys = (
        Key("name", Text(), "Name of the rack and pinion", required=True),
        Key("pinion", LINK, "The rotating link", required=True),
        Key("center", POINT, "Its centre of rotation", required=True),
        Key("slider", SLIDER, "The slider of the rack", required=True),
        Key("radius", NumberKey("length"), "Pitch radius of the pinion", required=True),
        PRESSURE_KEY,
    )
    kind = JointKind("G", 2, "rack and pinion")

    pinion: str
    center: str
    slider: str
    radius: Number

    @property
    def turning(self) -> tuple[str, ...]:
        return (self.pinion,)

    def guide(self, linkage: Bodies) -> Slider | None:
        """The slider of the rack."""
        return next((s for s in linkage.of(Slider) if s.name == self.slider), None)

    def joined(self, linkage: Bodies) -> tuple[str, ...]:
        slider = self.guide(linkage)
        assert slider is not None
        return self.pinion, slider.link

    def pairs(self, linkage: Bodies) -> KinematicPairs:
        slider = self.guide(linkage)
        assert slider is not None
        radius = linkage.numbers(self.radius)
        turns = ((self.pinion, radius), (slider.on, -radius))
        slide = (self.slider, -linkage.side_of(slider.line, self.center))
        return KinematicPairs(couplings=(Coupling(name=self.name, turns=turns, slide=slide),))

    def check(self, checks: PartChecks) -> None:
        """Check that the pinion is on the link along which the rack slides."""
        linkage = checks.linkage
        known = checks.link(self.pinion, "pinion")
        slider = self.guide(linkage)
        if slider is None:
            names = [s.name for s in linkage.of(Slider)]
            checks.add(
                f'slider "{self.slider}" is not defined {choices("sliders", names)}', "slider"
            )
        checks.positive(self.radius, "radius", "radius")
        self.check_pressure(checks)
        if not known or slider is None:
            return
        checks.on(self.center, self.pinion, "center")
        if self.pinion in (slider.on, slider.link):
            checks.add(f'"{self.pinion}" cannot be a part of the rack itself', "pinion")
        elif self.center in linkage.points and self.center not in linkage.links.get(slider.on, ()):
            checks.add(
                f'"{slider.on}", along which the rack slides, does not carry {self.center}: a '
                "pinion on another link is written as [[rolling]]",
                "center",
            )

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        slider, radius = self.guide(linkage), linkage.numbers(self.radius)
        assert slider is not None
        yield Disc(name=self.name, link=self.pinion, center=self.center, radius=radius, kind="gear")
        yield RackBar(
            name=self.name,
            slider=self.slider,
            link=slider.link,
            center=self.center,
            radius=radius,
        )
