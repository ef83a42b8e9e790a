"""Colours are told apart by everybody, on light pages and on dark ones.

Colour blindness is simulated with the matrices of Machado, Oliveira and Fernandes for complete
dichromacy, in linear light; distances are those of CIE 1976 L*a*b*.

References
----------
G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, A physiologically-based model for simulation of
color vision deficiency, IEEE Transactions on Visualization and Computer Graphics 15 (2009)
1291-1298, doi:10.1109/TVCG.2009.113.
"""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest

from linkwork.core.drawing import DARK, LIGHT, THEMES, Polyline, Role, theme_named
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import UnknownNameError

SIGHT = {
    "usual": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
JUST_SEEN = 2.3  # the smallest difference of colours side by side (Mahy et al. 1994)


def linear(colour: str) -> Array:
    part = np.array([int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)])
    return np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)


def seen(colour: str, sight: str) -> Array:
    """L*, a*, b* of a colour as somebody sees it."""
    light = np.clip(np.array(SIGHT[sight]) @ linear(colour), 0.0, 1.0)
    to_xyz = [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
              [0.0193339, 0.1191920, 0.9503041]]  # fmt: skip
    x, y, z = (
        np.cbrt(t) if t > (6 / 29) ** 3 else t / (3 * (6 / 29) ** 2) + 4 / 29
        for t in np.array(to_xyz) @ light / [0.95047, 1.0, 1.08883]
    )
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def contrast(one: str, other: str) -> float:
    """The ratio of luminances that the guidelines for web content count."""
    low, high = sorted(float(np.array([0.2126, 0.7152, 0.0722]) @ linear(c)) for c in (one, other))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("sight", SIGHT)
@pytest.mark.parametrize("theme", THEMES)
def test_links_are_told_apart(theme: str, sight: str) -> None:
    colours = (THEMES[theme].driven, *THEMES[theme].tones)
    for one, other in combinations(colours, 2):
        distance = np.linalg.norm(seen(one, sight) - seen(other, sight))
        assert distance > 6 * JUST_SEEN, (one, other)


@pytest.mark.parametrize("sight", SIGHT)
@pytest.mark.parametrize("theme", THEMES)
def test_velocities_and_accelerations_are_told_apart(theme: str, sight: str) -> None:
    styles = THEMES[theme].styles
    one, other = (styles[role].line for role in (Role.VELOCITY, Role.ACCELERATION))
    assert np.linalg.norm(seen(one, sight) - seen(other, sight)) > 6 * JUST_SEEN


@pytest.mark.parametrize("sight", SIGHT)
@pytest.mark.parametrize("theme", THEMES)
def test_the_lightness_of_the_colour_scale_goes_one_way(theme: str, sight: str) -> None:
    scale = THEMES[theme]
    levels = [seen(scale.at_level(k / 10), sight)[0] for k in range(11)]
    steps = [after - before for before, after in pairwise(levels)]
    assert min(steps) > JUST_SEEN


@pytest.mark.parametrize("theme", THEMES)
def test_what_is_written_in_ink_is_read_easily(theme: str) -> None:
    chosen = THEMES[theme]
    for role in (Role.LABEL, Role.DIMENSION_NAME, Role.VELOCITY_NAME, Role.CENTRE_NAME,
                 Role.LIMIT_NAME, Role.SCALE_NAME):  # fmt: skip
        assert contrast(chosen.styles[role].fill, chosen.background) >= 4.5, role
    for tone in (chosen.driven, *chosen.tones):
        assert contrast(tone, chosen.background) >= 2.2, tone


@pytest.mark.parametrize("theme", THEMES)
def test_every_role_has_a_style_that_is_seen(theme: str) -> None:
    chosen = THEMES[theme]
    for role in Role:
        style = chosen.styles[role]
        assert style.line or style.fill
        for colour in (style.line, style.fill):
            assert colour in ("", "tone", "level") or (len(colour) == 7 and colour[0] == "#")


def test_both_themes_draw_the_same_lines() -> None:
    for role in Role:
        one, other = LIGHT.styles[role], DARK.styles[role]
        assert (one.width, one.dashes, one.opacity) == (other.width, other.dashes, other.opacity)


def test_a_place_on_the_scale_is_between_its_neighbours() -> None:
    assert LIGHT.at_level(0.0) == LIGHT.scale[0]
    assert LIGHT.at_level(1.0) == LIGHT.scale[-1]
    assert LIGHT.at_level(7.0) == LIGHT.scale[-1]
    piece = Polyline(role=Role.SPEED_TRACE, points=((0, 0), (1, 0)), level=0.25)
    assert LIGHT.line(piece) == LIGHT.scale[1]


def test_an_unknown_theme_is_refused_with_what_exists() -> None:
    with pytest.raises(UnknownNameError) as raised:
        theme_named("dusk", THEMES)
    assert str(raised.value) == 'there is no theme "dusk" (themes: light, dark)'
