"""Colours and line widths of roles, shared by all writers.

Colours are those of Okabe and Ito on a light page, and similarly chosen on a dark page; they are
distinguishable with every kind of colour blindness.

References
----------
M. Okabe, K. Ito, Color universal design: how to make figures and presentations that are friendly
to colorblind people, 2002.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

from linkwork.drawing.scene import Primitive, Role
from linkwork.foundation.errors import UnknownNameError, choices
from linkwork.foundation.frozen import FrozenDict

__all__ = ["DARK", "LIGHT", "THEMES", "Style", "Theme", "theme_named"]

T = TypeVar("T")

_BLUE, _GREEN, _ORANGE = "#0072B2", "#009E73", "#E69F00"
_VERMILLION, _PURPLE, _SKY = "#D55E00", "#CC79A7", "#56B4E9"


@dataclass(frozen=True, kw_only=True)
class Style:
    """The style of a role.

    ``line`` and ``fill`` are a colour, ``tone`` (the colour of the link), ``level`` (from the
    theme's colour scale) or empty; ``width`` is in strokes
    (:attr:`linkwork.drawing.measures.Measures.stroke`), the lengths of ``dashes`` and their gaps
    are in line widths.
    """

    line: str = ""
    width: float = 1.0
    fill: str = ""
    opacity: float = 1.0
    dashes: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Theme:
    """Colours of a page: background, ink of text, faint ink of axes, tones of links, styles.

    ``scale`` are colours at equal steps from 0 to 1 of a quantity such as speed; their lightness is
    monotonic.
    """

    background: str
    ink: str
    faint: str
    driven: str
    tones: tuple[str, ...]
    scale: tuple[str, ...]
    styles: Mapping[Role, Style]

    def line(self, primitive: Primitive) -> str:
        """The line colour of a primitive; empty for none."""
        return self._colour(self.styles[primitive.role].line, primitive)

    def fill(self, primitive: Primitive) -> str:
        """The fill colour of a primitive; empty for none."""
        return self._colour(self.styles[primitive.role].fill, primitive)

    def _colour(self, colour: str, primitive: Primitive) -> str:
        if colour == "tone":
            tone = primitive.tone
            colour = self.tones[(tone - 1) % len(self.tones)] if tone else self.driven
        elif colour == "level":
            colour = self.at_level(primitive.level)
        return self._mixed(colour, primitive.fade) if colour and primitive.fade else colour

    def at_level(self, level: float) -> str:
        """The colour of the scale at a level from 0 to 1."""
        place = min(max(level, 0.0), 1.0) * (len(self.scale) - 1)
        k = min(int(place), len(self.scale) - 2)
        return _between(self.scale[k], self.scale[k + 1], place - k)

    def _mixed(self, colour: str, fade: float) -> str:
        """A colour mixed with the page; opaque, so that crossings stay faint."""
        return _between(colour, self.background, fade)


def _between(colour: str, other: str, share: float) -> str:
    """A colour #RRGGBB interpolated to another one."""
    one, two = ([int(c[k : k + 2], 16) for k in (1, 3, 5)] for c in (colour, other))
    mixed = (round((1.0 - share) * a + share * b) for a, b in zip(one, two, strict=True))
    return "#" + "".join(f"{part:02X}" for part in mixed)


@dataclass(frozen=True, kw_only=True)
class _Inks:
    """The base colours of styles; ``page`` also hides lower parts."""

    ink: str
    grey: str
    page: str
    still: str
    block: str
    driven: str
    velocity: str
    acceleration: str
    force: str


def _styles(c: _Inks) -> FrozenDict[Role, Style]:
    """The styles of all roles: equal lines in every theme, with its colours."""
    centrode = Style(line=c.velocity, width=1.6)
    return FrozenDict.of(
        {
            Role.FRAME: Style(line=c.grey, width=1.3, fill=c.block),
            Role.FRAME_BAND: Style(fill=c.block),
            Role.BAND: Style(fill="tone", opacity=0.16),
            Role.WHEEL: Style(line="tone", width=1.5, fill="tone", opacity=0.16),
            Role.PITCH: Style(line=c.grey, width=0.7, dashes=(14.0, 4.0, 2.0, 4.0)),
            Role.MARK: Style(line="tone", width=1.5, fill="tone"),
            Role.BELT: Style(line=c.ink, width=1.8),
            Role.PLATE: Style(line="tone", width=1.9, fill="tone", opacity=0.2),
            Role.SCALE: Style(fill="level"),
            Role.HATCH: Style(line=c.grey, width=0.8),
            Role.GROUND: Style(line=c.grey, width=1.3, fill=c.still),
            Role.TRACE: Style(line=c.ink, width=1.3, fill=c.ink, dashes=(0.01, 2.2)),
            Role.SPEED_TRACE: Style(line="level", width=2.6),
            Role.FIXED_CENTRODE: centrode,
            Role.MOVING_CENTRODE: replace(centrode, line=c.acceleration, dashes=(5.0, 2.5)),
            Role.EXTENSION: Style(line=c.grey, width=0.6),
            Role.DIMENSION: Style(line=c.ink, width=0.7, fill=c.ink),
            Role.SLOT: Style(line="tone", width=1.7, fill=c.page),
            Role.SLIDER: Style(line=c.ink, width=1.3, fill=c.block),
            Role.LINK: Style(line="tone", width=2.8),
            Role.SPRING: Style(line=c.ink, width=1.2),
            Role.CYLINDER: Style(line="tone", width=1.4, fill=c.page),
            Role.WELD: Style(line=c.ink, width=1.0, fill=c.ink),
            Role.PIN: Style(line=c.ink, width=1.4, fill=c.page),
            Role.POINT: Style(fill=c.ink),
            Role.TRACED: Style(fill=c.ink),
            Role.POSITION: Style(line=c.acceleration, width=1.6),
            Role.LIMIT: Style(line=c.ink, width=2.2, fill=c.page),
            Role.INPUT: Style(line=c.driven, width=1.7, fill=c.driven),
            Role.VECTOR: Style(line="tone", width=2.0, fill="tone"),
            Role.VELOCITY: Style(line=c.velocity, width=2.0, fill=c.velocity),
            Role.ACCELERATION: Style(line=c.acceleration, width=2.0, fill=c.acceleration),
            Role.FORCE: Style(line=c.force, width=2.4, fill=c.force),
            Role.CENTRE: Style(line=c.acceleration, width=1.8),
            Role.LINK_NAME: Style(fill="tone"),
            Role.LABEL: Style(fill=c.ink),
            Role.POSITION_NAME: Style(fill=c.acceleration),
            Role.LIMIT_NAME: Style(fill=c.grey),
            Role.VECTOR_NAME: Style(fill="tone"),
            Role.LOOP_NAME: Style(fill="tone"),
            Role.VELOCITY_NAME: Style(fill=c.velocity),
            Role.ACCELERATION_NAME: Style(fill=c.acceleration),
            Role.FORCE_NAME: Style(fill=c.force),
            Role.CENTRE_NAME: Style(fill=c.acceleration),
            Role.DIMENSION_NAME: Style(fill=c.ink),
            Role.SCALE_NAME: Style(fill=c.grey),
        }
    )


LIGHT = Theme(
    background="#FFFFFF",
    ink="#1A1A1A",
    faint="#8A8A8A",
    driven=_VERMILLION,
    tones=(_BLUE, _GREEN, _PURPLE, _ORANGE, _SKY),
    scale=("#0D0660", "#5B1A8C", "#A63A86", "#E3685F", "#FBA63A"),
    styles=_styles(
        _Inks(
            ink="#1A1A1A",
            grey="#5A5A5A",
            page="#FFFFFF",
            still="#E6E6E6",
            block="#EDEDED",
            driven=_VERMILLION,
            velocity="#1F3A93",
            acceleration="#8E1B5B",
            force="#6B4E00",
        )
    ),
)

#: For dark pages: lighter hues, equally distinguishable with colour blindness.
DARK = Theme(
    background="#15191E",
    ink="#ECEFF3",
    faint="#8B95A1",
    driven="#FF803D",
    tones=("#607AEA", "#1FCB8E", "#BE6BA0", "#E4F02D", "#B2AEF9"),
    scale=("#5A3FB5", "#3F76C0", "#2FA0A0", "#6CC96A", "#F2E63C"),
    styles=_styles(
        _Inks(
            ink="#ECEFF3",
            grey="#A7B0BA",
            page="#15191E",
            still="#333B44",
            block="#2A3139",
            driven="#FF803D",
            velocity="#A9C4FF",
            acceleration="#FFA9D2",
            force="#FFD27F",
        )
    ),
)

#: Themes by name.
THEMES: Mapping[str, Theme] = FrozenDict.of({"light": LIGHT, "dark": DARK})


def theme_named(name: str, themes: Mapping[str, T]) -> T:
    """The theme with a given name, of drawings or of charts.

    Raises
    ------
    UnknownNameError
        Lists the existing names.
    """
    if name not in themes:
        raise UnknownNameError(f'there is no theme "{name}" {choices("themes", themes, name)}')
    return themes[name]
