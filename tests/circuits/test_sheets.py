"""Sheets of configurations: one picture each, of one scale, with its name."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest
from matplotlib.figure import Figure

import linkwork as lw
from linkwork.core.drawing import LIGHT, Scene, Sheet, Text, configuration_sheet, render
from linkwork.core.drawing.matplotlib_writer import _sheet_figure
from linkwork.core.foundation.errors import InputError
from tests.core.drawing.conftest import Sample
from tests.core.drawing.mechanisms import five_bar_of
from tests.core.drawing.pages import assert_page_is_clear, printed_texts, size_in_inches, svg_texts

#: From one configuration to eight, with every kind of joint that lists have.
DRAWN = (
    "andrews-squeezer", "belt-drive", "cam-swinging-follower", "crank-slider", "double-four-bar",
    "elliptic-trammel", "four-bar", "inverted-slider-crank", "jansen-leg",
    "planetary-gear", "rapier-drive", "slider-input", "stephenson-far-crank",
)  # fmt: skip

_FOUND: dict[str, lw.circuits.Configurations] = {}


def found_of(name: str) -> lw.circuits.Configurations:
    """Configurations of a library mechanism at its guess's input, found once."""
    if name not in _FOUND:
        _FOUND[name] = lw.example(name).configurations()
    return _FOUND[name]


def page_of(sheet: Sheet) -> Figure:
    return _sheet_figure(sheet, LIGHT)


@cache
def drawn(name: str) -> tuple[Sheet, Figure]:
    """The sheet of a library mechanism, and its page: drawn once."""
    sheet = configuration_sheet(found_of(name))
    page = page_of(sheet)
    page.draw_without_rendering()
    return sheet, page


@pytest.mark.parametrize("name", DRAWN)
def test_every_configuration_is_a_picture_with_its_name_in_the_order_of_the_list(name: str) -> None:
    found = found_of(name)
    sheet, _ = drawn(name)
    assert [scene.title for scene in sheet.scenes] == list(found.names)
    assert {scene.caption for scene in sheet.scenes} == {""}
    assert sheet.title == found.mechanism
    for scene, position in zip(sheet.scenes, found, strict=True):
        names = {text.of: text.anchor for text in scene.select(Text)}
        assert names
        assert all(position.points[point] == place for point, place in names.items())


def test_the_caption_counts_them_and_says_where() -> None:
    assert configuration_sheet(found_of("rapier-drive")).caption == "4 configurations at θ₁₂ = 60°"
    at = lw.example("slider-input").configurations(at=120)
    assert configuration_sheet(at).caption == "2 configurations at d = 120 mm"
    squeezer = configuration_sheet(found_of("andrews-squeezer"))
    assert squeezer.caption == "4 configurations at β = −0.0617139 rad"
    five_bar = five_bar_of(left_stop=100)
    both = configuration_sheet(five_bar.configurations())
    assert both.caption == "2 configurations at left = 90°, right = 90°"


def test_one_configuration_is_not_many() -> None:
    found = found_of("four-bar")
    sheet = configuration_sheet(replace(found, positions=found.positions[:1]))
    assert sheet.caption == "1 configuration at crank = 30.0294°"
    assert (len(sheet.scenes), sheet.columns) == (1, 1)
    assert_page_is_clear(page_of(sheet))


def test_nothing_to_draw_is_said() -> None:
    found = found_of("four-bar")
    with pytest.raises(InputError) as raised:
        configuration_sheet(replace(found, positions=(), message="it cannot be put together"))
    assert str(raised.value) == (
        f'"{found.mechanism}" has no configuration to draw: it cannot be put together'
    )
    equations = lw.example("coupled-six-link").changed(points={}, links={}, trace=())
    without = equations.configurations()
    with pytest.raises(InputError) as raised:
        configuration_sheet(without)
    assert str(raised.value) == (
        '"Six-link mechanism with two coupled loops" has no points to draw: '
        "add [points] with the coordinates of its pins"
    )


@pytest.mark.parametrize(
    ("count", "columns", "cell"),
    [(1, 1, 7.5), (2, 2, 3.75), (4, 2, 3.75), (5, 3, 2.5), (40, 4, 2.2)],
)
def test_pictures_stand_in_rows_of_at_most_four(
    four_bar: Sample, count: int, columns: int, cell: float
) -> None:
    sheet = configuration_sheet(found_of("four-bar"))
    many = replace(sheet, scenes=(sheet.scenes * count)[:count])
    assert (many.columns, many.cell) == (columns, cell)


@pytest.mark.parametrize("name", DRAWN)
def test_all_pictures_show_the_same_part_of_the_plane_and_nothing_is_cut_off(name: str) -> None:
    sheet, page = drawn(name)
    views = {(ax.get_xlim(), ax.get_ylim()) for ax in page.axes}
    assert len(views) == 1
    [((left, right), (bottom, top))] = views
    for ax, scene in zip(page.axes, sheet.scenes, strict=True):
        assert ax.get_aspect() == 1.0
        box = scene.box
        assert left <= box.left <= box.right <= right
        assert bottom <= box.bottom <= box.top <= top
    frames = [ax.get_window_extent() for ax in page.axes]
    assert len({(round(frame.width), round(frame.height)) for frame in frames}) == 1
    for frame in frames:
        assert page.bbox.x0 < frame.x0 < frame.x1 < page.bbox.x1
        assert page.bbox.y0 < frame.y0 < frame.y1 < page.bbox.y1


@pytest.mark.parametrize("name", DRAWN)
def test_texts_keep_clear_of_each_other_and_of_the_pictures(name: str) -> None:
    sheet, page = drawn(name)
    assert_page_is_clear(page)
    texts = [text for text, _ in printed_texts(page)]
    assert texts == [sheet.title, sheet.caption, *(scene.title for scene in sheet.scenes)]


@pytest.mark.parametrize("name", DRAWN)
def test_names_of_points_are_large_enough_to_read(name: str) -> None:
    _, page = drawn(name)
    sizes = [float(text.get_fontsize()) for ax in page.axes for text in ax.texts]
    assert 5.5 < min(sizes) <= max(sizes) < 12  # points


def test_long_names_are_broken_at_their_hyphens() -> None:
    sheet = configuration_sheet(found_of("jansen-leg"))
    long = "-".join(["crossed", "open"] * 4)
    renamed = [replace(scene, title=long) for scene in sheet.scenes]
    page = page_of(replace(sheet, title="One more " * 20, scenes=tuple(renamed)))
    assert_page_is_clear(page)
    names = [text for text, _ in printed_texts(page) if "crossed" in text]
    assert len(names) == 8
    for name in names:
        assert name.replace("\n", "") == long
        assert "\n" in name
        assert all(line.endswith("-") for line in name.split("\n")[:-1])


def test_a_png_is_as_wide_as_a_page() -> None:
    page = render(configuration_sheet(found_of("rapier-drive")), "png", dpi=100)
    width, height = size_in_inches(page, 100)
    assert width == pytest.approx(7.65, abs=0.011)
    assert 3 < height < 8


def test_an_svg_names_its_texts_and_parts() -> None:
    svg = render(configuration_sheet(found_of("four-bar")), "svg")
    texts = svg_texts(svg)
    for text in (
        "Four-bar linkage, open",
        "2 configurations at crank = 30.0294°",
        "open",
        "crossed",
    ):
        assert texts.count(text) == 1
    assert svg.decode().count('id="link:coupler"') == 2
    assert svg.decode().count('id="pin:A"') == 2


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_the_same_sheet_gives_the_same_bytes(kind: str) -> None:
    sheet = configuration_sheet(found_of("four-bar"))
    assert render(sheet, kind) == render(configuration_sheet(found_of("four-bar")), kind)


def test_symbols_of_small_pictures_are_larger_but_never_than_their_links_allow() -> None:
    small: Scene = configuration_sheet(found_of("jansen-leg")).scenes[0]
    usual = lw.example("jansen-leg").scene()
    assert usual.measures.larger == 1.0
    assert 1.2 < small.measures.larger <= 2.0
    for measure in ("pin", "text"):
        one, other = (getattr(s.measures, measure) / s.measures.size for s in (usual, small))
        assert other > 1.1 * one
    crank = 15.0
    assert small.measures.pin < 0.23 * crank
