"""Light and dark colours of charts, based on those of drawings.

Curves have the colours of Okabe and Ito, ordered so that neighbours differ most; the dark theme
uses lighter colours of the same hues. They are distinguishable with every kind of colour blindness.
Texts have a contrast of at least 4.5 with the page (WCAG 2.2, success criterion 1.4.3).
"""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.drawing.theme import LIGHT, Theme

__all__ = ["DARK_CHART", "LIGHT_CHART", "THEMES", "ChartTheme"]


@dataclass(frozen=True, kw_only=True)
class ChartTheme:
    """Colours #RRGGBB of a chart.

    Parameters
    ----------
    background : str
    ink, faint : str
        Colour of the title; of labels, ticks and captions.
    rule : str
        Sides of panels, grid and background curves.
    band : str
        Recommended ranges.
    tones : tuple of str
        Curves, by tone.
    """

    background: str
    ink: str
    faint: str
    rule: str
    band: str
    tones: tuple[str, ...]

    def tone(self, number: int) -> str:
        """The colour of a tone; 0 is the ink."""
        return self.tones[(number - 1) % len(self.tones)] if number else self.ink

    @classmethod
    def of(cls, theme: Theme | ChartTheme) -> ChartTheme:
        """The chart colours that match a theme of drawings."""
        if isinstance(theme, ChartTheme):
            return theme
        return LIGHT_CHART if _luminous(theme.background) else DARK_CHART


def _luminous(colour: str) -> bool:
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return 0.299 * red + 0.587 * green + 0.114 * blue > 127


LIGHT_CHART = ChartTheme(
    background=LIGHT.background,
    ink=LIGHT.ink,
    faint="#5F6368",
    rule="#C4C7CC",
    band="#DDF1EA",
    tones=("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"),
)

DARK_CHART = ChartTheme(
    background="#15191E",
    ink="#F2F3F5",
    faint="#A9AFB8",
    rule="#474C55",
    band="#173A31",
    tones=("#4FB0F2", "#FF8B42", "#2CCB9B", "#E79AC6", "#F5C043", "#A5DBFF"),
)

#: Themes by name.
THEMES = {"light": LIGHT_CHART, "dark": DARK_CHART}
