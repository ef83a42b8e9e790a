"""Colours and line widths of roles, shared by all writers.

Colours are those of Okabe and Ito, told apart with every kind of colour blindness.

References
----------
M. Okabe, K. Ito, Color universal design: how to make figures and presentations that are friendly
to colorblind people, 2002.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from linkwork.drawing.scene import Primitive, Role
from linkwork.foundation.frozen import FrozenDict

__all__ = ["DARK", "LIGHT", "Style", "Theme"]

_BLUE, _GREEN, _ORANGE = "#0072B2", "#009E73", "#E69F00"
_VERMILLION, _PURPLE, _SKY = "#D55E00", "#CC79A7", "#56B4E9"


@dataclass(frozen=True, kw_only=True)
class Style:
    """How a role is drawn.

    ``line`` and ``fill`` are a colour, ``tone`` (the colour of the link) or nothing; ``width``
    counts strokes (:attr:`linkwork.drawing.measures.Measures.stroke`), as do the lengths of
    ``dashes`` and of the gaps between them, in widths of the line.
    """

    line: str = ""
    width: float = 1.0
    fill: str = ""
    opacity: float = 1.0
    dashes: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Theme:
    """Colours of a page: background, ink of text, faint ink of axes, tones of links, styles."""

    background: str
    ink: str
    faint: str
    driven: str
    tones: tuple[str, ...]
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
        return self._mixed(colour, primitive.fade) if colour and primitive.fade else colour

    def _mixed(self, colour: str, fade: float) -> str:
        """A colour #RRGGBB with the page shining through: opaque, so that crossings stay faint."""
        ink, page = ([int(c[k : k + 2], 16) for k in (1, 3, 5)] for c in (colour, self.background))
        mixed = (round((1.0 - fade) * i + fade * p) for i, p in zip(ink, page, strict=True))
        return "#" + "".join(f"{part:02X}" for part in mixed)


_INK, _GREY, _PAPER = "#1A1A1A", "#5A5A5A", "#FFFFFF"

LIGHT = Theme(
    background=_PAPER,
    ink=_INK,
    faint="#8A8A8A",
    driven=_VERMILLION,
    tones=(_BLUE, _GREEN, _PURPLE, _ORANGE, _SKY),
    styles=FrozenDict.of(
        {
            Role.FRAME: Style(line=_GREY, width=1.3, fill="#EDEDED"),
            Role.FRAME_BAND: Style(fill="#EDEDED"),
            Role.BAND: Style(fill="tone", opacity=0.16),
            Role.WHEEL: Style(line="tone", width=1.5, fill="tone", opacity=0.16),
            Role.PITCH: Style(line=_GREY, width=0.7, dashes=(14.0, 4.0, 2.0, 4.0)),
            Role.MARK: Style(line="tone", width=1.5, fill="tone"),
            Role.BELT: Style(line=_INK, width=1.8),
            Role.PLATE: Style(line="tone", width=1.9, fill="tone", opacity=0.2),
            Role.HATCH: Style(line=_GREY, width=0.8),
            Role.GROUND: Style(line=_GREY, width=1.3, fill="#E6E6E6"),
            Role.TRACE: Style(line=_INK, width=1.3, fill=_INK, dashes=(0.01, 2.2)),
            Role.SLOT: Style(line="tone", width=1.7, fill=_PAPER),
            Role.SLIDER: Style(line=_INK, width=1.3, fill="#EDEDED"),
            Role.LINK: Style(line="tone", width=2.8),
            Role.CYLINDER: Style(line="tone", width=1.4, fill=_PAPER),
            Role.PIN: Style(line=_INK, width=1.4, fill=_PAPER),
            Role.POINT: Style(fill=_INK),
            Role.TRACED: Style(fill=_INK),
            Role.LIMIT: Style(line=_INK, width=2.2, fill=_PAPER),
            Role.INPUT: Style(line=_VERMILLION, width=1.7, fill=_VERMILLION),
            Role.LINK_NAME: Style(fill="tone"),
            Role.LABEL: Style(fill=_INK),
            Role.LIMIT_NAME: Style(fill=_GREY),
        }
    ),
)


def _inverted(styles: Mapping[Role, Style], colours: Mapping[str, str]) -> Mapping[Role, Style]:
    """The same styles with other colours for ink, greys and paper."""
    return FrozenDict.of(
        {
            role: replace(
                style,
                line=colours.get(style.line, style.line),
                fill=colours.get(style.fill, style.fill),
            )
            for role, style in styles.items()
        }
    )


#: The same colours on dark paper, the dark ones of Okabe and Ito lightened.
DARK = Theme(
    background="#14171A",
    ink="#ECEFF1",
    faint="#8D979E",
    driven="#FF8A4C",
    tones=("#5BA8E0", "#35C295", "#E29CC3", "#F0B93A", "#8BCDF2"),
    styles=_inverted(
        LIGHT.styles,
        {
            _INK: "#ECEFF1",
            _GREY: "#A7B0B6",
            _PAPER: "#14171A",
            _VERMILLION: "#FF8A4C",
            "#EDEDED": "#2A3036",
            "#E6E6E6": "#2F363C",
        },
    ),
)
