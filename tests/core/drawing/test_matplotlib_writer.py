"""Files show the scene: coordinates, completeness, identical bytes, errors."""

from __future__ import annotations

import re
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from linkwork.core.drawing import Disc, Polyline, Role, Scene, Text, figure, render, scene_of, write
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, MissingPackageError
from tests.core.drawing.conftest import Sample

MECHANISMS = [
    "four_bar", "slider_crank", "inverted_slider_crank", "six_link", "boom", "jansen", "flat",
    "tall", "ternary",
]  # fmt: skip
SVG = "{http://www.w3.org/2000/svg}"
NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"


@pytest.fixture
def scene(four_bar: Sample) -> Scene:
    return scene_of(four_bar.position(50), four_bar.motion())


def centres(svg: bytes) -> dict[str, list[Array]]:
    """The middle of the drawn outline of every group ``role:name`` in an SVG, in its pixels."""
    found: dict[str, list[Array]] = {}
    for group in ElementTree.fromstring(svg).iter(f"{SVG}g"):
        name = group.get("id", "")
        for path in group.iter(f"{SVG}path") if ":" in name else ():
            numbers = np.array(re.findall(NUMBER, path.get("d", "")), dtype=float).reshape(-1, 2)
            middle = (numbers.min(axis=0) + numbers.max(axis=0)) / 2
            found.setdefault(name, []).append(middle)
    return found


@pytest.mark.parametrize("name", MECHANISMS)
def test_svg_coordinates_are_scene_coordinates_in_one_equal_scale(
    name: str, request: pytest.FixtureRequest
) -> None:
    mechanism = request.getfixturevalue(name)
    scene = scene_of(mechanism.position(95 if name == "boom" else 50), mechanism.motion())
    drawn = centres(render(scene, "svg"))
    pins = scene.select(Disc, Role.PIN)
    pixels = np.array([drawn[f"pin:{pin.of}"][0] for pin in pins])
    places = np.array([pin.centre for pin in pins])
    # One scale for x and y, y upwards, is what is left to determine: 3 numbers.
    rows = [[x, 1, 0] for x, _ in places] + [[-y, 0, 1] for _, y in places]
    wanted = np.concatenate((pixels[:, 0], pixels[:, 1]))
    (scale, *_), *_ = np.linalg.lstsq(np.array(rows, dtype=float), wanted, rcond=None)
    fitted = np.array(rows) @ np.linalg.lstsq(np.array(rows), wanted, rcond=None)[0]
    assert scale > 0
    # SVG paths carry six decimals, circles are Bézier curves: a thousandth of a point.
    np.testing.assert_allclose(fitted, wanted, atol=1e-3)


def test_every_bar_in_the_svg_runs_between_its_pins(scene: Scene) -> None:
    drawn = centres(render(scene, "svg"))
    for bar in scene.select(Polyline, Role.LINK):
        ends = [d.of for d in scene.select(Disc, Role.PIN) if d.centre in bar.points]
        middle = (drawn[f"pin:{ends[0]}"][0] + drawn[f"pin:{ends[1]}"][0]) / 2
        np.testing.assert_allclose(drawn[f"link:{bar.of}"][0], middle, atol=1e-3)


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_the_same_scene_gives_the_same_bytes(scene: Scene, kind: str, tmp_path: Path) -> None:
    one = write(scene, tmp_path / f"one.{kind}").read_bytes()
    other = write(scene, tmp_path / f"other.{kind.upper()}").read_bytes()
    assert one == other
    start = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[kind]
    assert one.startswith(start)
    assert b"Date>" not in one
    assert b"/CreationDate" not in one


def test_pictures_do_not_depend_on_the_users_settings(scene: Scene) -> None:
    import matplotlib

    before = render(scene, "svg")
    with matplotlib.rc_context({"font.size": 30, "axes.facecolor": "red", "axes.grid": True}):
        assert render(scene, "svg") == before
        assert matplotlib.rcParams["font.size"] == 30


def test_resolution_is_a_choice(scene: Scene) -> None:
    def width(page: bytes) -> int:
        return int.from_bytes(page[16:20], "big")

    assert width(render(scene, "png", dpi=200)) == 2 * width(render(scene, "png", dpi=100))


@pytest.mark.parametrize("name", MECHANISMS)
def test_nothing_is_cut_off_and_names_fit_the_boxes_they_were_placed_with(
    name: str, request: pytest.FixtureRequest
) -> None:
    mechanism = request.getfixturevalue(name)
    scene = scene_of(mechanism.position(95 if name == "boom" else 50), mechanism.motion())
    drawing = figure(scene)
    drawing.canvas.draw()
    assert isinstance(drawing.canvas, FigureCanvasAgg)
    renderer = drawing.canvas.get_renderer()
    page = drawing.bbox
    [ax] = drawing.axes
    artists = [*drawing.texts, *ax.texts, *ax.artists, *ax.patches]
    artists += [ax.xaxis.label, ax.yaxis.label]
    for axis, limits in ((ax.xaxis, ax.get_xlim()), (ax.yaxis, ax.get_ylim())):
        shown = [t.label1 for t in axis.get_major_ticks() if limits[0] <= t.get_loc() <= limits[1]]
        assert shown
        artists += shown
    extents = [artist.get_window_extent(renderer) for artist in artists]
    lines = [path for collection in ax.collections for path in collection.get_paths()]
    assert lines
    extents += [path.get_extents(ax.transData) for path in lines]
    for extent in extents:
        assert page.x0 <= extent.x0 <= extent.x1 <= page.x1
        assert page.y0 <= extent.y0 <= extent.y1 <= page.y1
    boxes = {f"{t.role.name.lower()}:{t.of}": t.box for t in scene.select(Text)}
    for text in ax.texts:
        extent = text.get_window_extent(renderer).transformed(ax.transData.inverted())
        box = boxes[text.get_gid() or ""]
        slack = 0.05 * scene.measures.text
        assert box.left - slack <= extent.x0 < extent.x1 <= box.right + slack, text


def test_axes_carry_the_length_unit_and_equal_scales(scene: Scene) -> None:
    [ax] = figure(scene).axes
    assert ax.get_xlabel() == "x [mm]"
    assert ax.get_ylabel() == "y [mm]"
    assert ax.get_aspect() == 1.0
    assert np.diff(ax.get_xticks())[0] == np.diff(ax.get_yticks())[0]


def test_a_scene_can_be_drawn_into_axes_of_the_caller(scene: Scene) -> None:
    from matplotlib.figure import Figure

    own = Figure(figsize=(4, 4))
    ax = own.add_subplot()
    assert figure(scene, ax) is own
    assert len(ax.texts) == len(scene.select(Text))
    assert ax.get_title() == f"{scene.title}\n{scene.caption}"


def test_dollar_signs_in_names_are_printed_as_they_are(four_bar: Sample) -> None:
    odd = replace(four_bar, name="costs $5 and $6_{x}")
    page = figure(scene_of(odd.position(50)))
    page.canvas.draw()
    assert page.texts[0].get_text() == "costs $5 and $6_{x}"
    assert not page.texts[0].get_parse_math()


def test_an_unknown_suffix_is_refused_with_those_that_exist(scene: Scene, tmp_path: Path) -> None:
    with pytest.raises(InputError) as raised:
        write(scene, tmp_path / "picture.bmp")
    assert str(raised.value) == (
        f'cannot write "{tmp_path / "picture.bmp"}": the suffix of a picture is one of .png, .svg, '
        ".pdf, .tikz"
    )
    with pytest.raises(InputError):
        write(scene, tmp_path / "picture")
    assert list(tmp_path.iterdir()) == []


def test_a_missing_folder_is_wrong_input(scene: Scene, tmp_path: Path) -> None:
    target = tmp_path / "nowhere" / "picture.svg"
    with pytest.raises(InputError) as raised:
        write(scene, target)
    assert str(raised.value) == f'cannot write "{target}": No such file or directory'


def test_a_failed_write_leaves_the_old_file_and_nothing_else(
    scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "picture.svg"
    target.write_text("old")

    def refuse(*_: object) -> NoReturn:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", refuse)
    with pytest.raises(InputError):
        write(scene, target)
    assert [path.name for path in tmp_path.iterdir()] == ["picture.svg"]
    assert target.read_text() == "old"


def test_without_matplotlib_the_message_names_the_command(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(MissingPackageError) as raised:
        render(scene, "svg")
    assert str(raised.value) == "drawing needs Matplotlib: pip install matplotlib"


def test_a_pdf_has_fonts_that_journals_accept(scene: Scene) -> None:
    page = render(scene, "pdf")
    assert b"/Subtype /Type3" not in page
    assert b"/FontFile2" in page or b"/TrueType" in page
