"""Files of other programs are read as the linkages that they describe, or refused."""

from __future__ import annotations

import builtins
import json
import socket
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.readers.importing import FORMATS, read_foreign
from tests.readers.samples import GEOGEBRA, SAMPLES, dxf_text, packed

_ROWS: dict[str, Any] = {"from_": 53.13010235415598, "to": 413.13010235415598, "step": 45.0}
#: The four-bar of the samples, whose crank begins at (24, 32).
_BAR: dict[str, Any] = {
    "points": {"O": (0, 0), "A": (24, 32), "B": (120, 64), "Q": (100, 0)},
    "links": {
        "ground": ["O", "Q"], "crank": ["O", "A"], "coupler": ["A", "B"], "rocker": ["Q", "B"],
    },
}  # fmt: skip


def _read(name: str) -> Linkage:
    return read_foreign(SAMPLES[name], name).description


@pytest.mark.parametrize(
    ("name", "link", "point", "unit"),
    [
        ("lines.pmks", "input", "P3", 1.0),
        ("mechanism.json", "crank", "B", 1.0),
        ("bar.pyslvs", "crank", "P2", 1.0),
        ("bar.dxf", "L1", "P3", 1.0),
        ("bar.mjcf", "crank", "tip", 1e-3),
    ],
)
def test_the_four_bar_of_every_format_moves_like_ours(
    name: str, link: str, point: str, unit: float
) -> None:
    ours = lw.linkage(**_BAR, inputs=Input(link="crank", **_ROWS)).sweep()
    read = _read(name)
    if read.inputs:
        assert read.inputs[0].link == link
    theirs = lw.linkage(
        points=read.points, links=read.links, inputs=Input(link=link, **_ROWS)
    ).sweep()
    # coordinates of millimetres in metres and back: a few roundings
    assert np.abs(theirs.place(point).v / unit - ours.place("B").v).max() < 1e-11


def test_given_lengths_and_angles_count_and_not_the_sketch() -> None:
    found = lw.Mechanism(_read("parents.json")).solve()
    at = {name: complex(*place) for name, place in found.points.items()}
    assert abs(at["A"] - at["A0"]) == pytest.approx(40, rel=1e-12)
    assert abs(at["B"] - at["A"]) == pytest.approx(120, rel=1e-12)
    assert abs(at["B"] - at["B0"]) == pytest.approx(80, rel=1e-12)
    # the angle from joint0-joint1 to joint0-P is 0.5 rad, the distance 50
    turned = (at["P"] - at["A"]) / (at["B"] - at["A"])
    assert abs(turned) == pytest.approx(50 / 120, rel=1e-12)
    assert np.angle(turned) == pytest.approx(0.5, rel=1e-12)
    assert abs(at["S"] - at["B"]) == pytest.approx(110, rel=1e-12)
    assert at["S"].imag == pytest.approx(0, abs=1e-9)


def test_gears_slots_speeds_and_traces_of_linkage_files() -> None:
    read = _read("bar.linkage2")
    assert read.gears[0].arm == "ground"
    radii = tuple(map(read.numbers, read.gears[0].radii or ()))
    assert radii == pytest.approx((200 / 3 * 25.4 / 96, 100 / 3 * 25.4 / 96), rel=1e-15)
    assert read.welds[0].links == ("link0", "link4")
    assert (read.slots[0].point, read.slots[0].on) == ("P5", "link2")
    assert read.inputs == (Input(link="link0", speed="15.0 rpm"),)
    assert read.trace == ("P4",)
    assert "P7" not in read.points  # of the drawing layer


@pytest.mark.parametrize(
    ("shown", "unit", "size"),
    [("Millimeters", "mm", 10.0), ("Inches", "in", 10 / 25.4), ("Leagues", "mm", 10.0)],
)
def test_lengths_of_linkage_files_are_in_96ths_of_an_inch(
    shown: str, unit: str, size: float
) -> None:
    text = (
        f'<linkage2><program units="{shown}"/><connector id="0" x="0" y="0" anchor="true"/>'
        '<connector id="1" x="37.7952755905512" y="0"/>'
        '<connector id="2" x="-37.7952755905512" y="0" anchor="true"/>'
        '<Link id="0"><connector id="0"/><connector id="1"/></Link>'
        '<Link id="1" actuator="true" throw="377.952755905512"><connector id="2"/>'
        '<connector id="1"/></Link></linkage2>'
    )
    found = read_foreign(text.encode(), "ten.linkage2")
    assert found.description.length == unit
    assert found.description.points["P1"] == pytest.approx((size, 0.0), rel=1e-14)
    assert found.description.inputs[0].to == pytest.approx(12 * size, rel=1e-14)
    unknown = 'unknown "Leagues", mm is assumed'
    assert (unknown in {own.what for own in found.left_out}) == (shown == "Leagues")


def test_a_construction_of_circles_is_bars_of_their_radii() -> None:
    read = _read("bar.ggb")
    assert read == _read("bar.xml")
    found = lw.Mechanism(read).solve()
    at = {name: complex(*place) for name, place in found.points.items()}
    assert abs(at["B"] - at["A"]) == pytest.approx(abs(139.5225 + 69.55j - 24 - 32j), rel=1e-12)
    assert at["M"] == pytest.approx((at["A"] + at["B"]) / 2, rel=1e-12)
    assert read.inputs[0].link == "A0A"
    notes = [str(left) for left in read_foreign(SAMPLES["bar.ggb"], "bar.ggb").left_out]
    assert "line 19: script: nothing is executed" in notes


def test_joints_that_mimic_move_in_step() -> None:
    motion = lw.Mechanism(_read("arm.urdf")).sweep()
    upper, lower = motion["upper"], motion["lower"] - motion["upper"]
    assert (upper[0], upper[-1]) == pytest.approx((0, np.rad2deg(1)), abs=1e-12)
    assert lower == pytest.approx(-2 * upper + np.rad2deg(0.5), abs=1e-9)


def test_a_slide_follows_its_line_without_turning() -> None:
    motion = lw.Mechanism(_read("slide.pmks")).sweep(step=30)
    assert np.abs(motion.place("P4").v.imag).max() < 1e-12
    gap = motion.place("P3").v - motion.place("P4").v
    assert np.abs(gap - 2j).max() < 1e-12


def test_a_pin_slides_on_the_first_link_of_its_row() -> None:
    motion = lw.Mechanism(_read("quick-return.txt")).sweep(step=30)
    lever, pin = motion.place("P2_to").v - motion.place("P3").v, motion.place("P2").v
    # the line through the pivot of the lever leads through the pin
    across = ((pin - motion.place("P3").v) * lever.conjugate()).imag
    assert np.abs(across).max() < 1e-11


def test_links_of_pmks_have_inputs_speeds_and_slides() -> None:
    made = lw.readers.exported(lw.example("slider-crank-engine"), "pmks")
    found = lw.readers.imported(made.text.strip())
    assert found.carried["slots"] == 1
    assert found.description.inputs[0].speed == "10 rpm"
    with pytest.raises(lw.MechanismFileError, match="its check sum is wrong"):
        lw.readers.imported(made.text.strip()[:-1] + "!")
    code = made.text.strip().partition("?")[2]
    assert lw.readers.imported(f"https://app.pmksplus.com/?{code}*abc123").carried == found.carried


def test_names_are_kept_where_formulas_can_use_them() -> None:
    bar = b"ground,2,R,0,0,0,ffft\n2,e,R,30,0\ne,my link,R,9,9"
    with pytest.raises(lw.MechanismFileError, match="line 3"):
        read_foreign(bar.replace(b"R,9,9", b"R,9"), "bar.pmks")
    rows = b"ground,2,R,0,0,0,ffft\n2,e,R,30,0\ne,pi,R,90,50\npi,ground,R,80,0"
    read = read_foreign(rows, "bar.pmks")
    assert read.renamed == {'link "2"': "link2", 'link "e"': "linke", 'link "pi"': "linkpi"}
    assert lw.Mechanism(read.description).sweep(step=30).found.any()


def test_links_with_two_common_points_are_one() -> None:
    rows = b"ground,a,R,0,0,0,ffft\na,b,R,30,0\na,b,R,40,10\nb,c,R,90,50\nc,ground,R,80,0"
    read = read_foreign(rows, "bar.pmks")
    assert set(read.description.links) == {"ground", "a", "c"}
    assert str(read.left_out[0]) == 'link "b": as a separate link: by P2 and P3 it moves with "a"'


@pytest.mark.parametrize("name", SAMPLES)
def test_no_file_is_opened_and_no_address_is_called(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    read_foreign(SAMPLES[name], name)  # what is imported on first use is imported now

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("reads something else")

    monkeypatch.setattr(builtins, "open", refuse)
    monkeypatch.setattr(socket, "socket", refuse)
    assert read_foreign(SAMPLES[name], name).description.points


_XML = '<?xml version="1.0"?>'
_WRONG = {
    "empty.urdf": (b"<robot/>", "has no root: it has no link"),
    "doctype.linkage2": (
        b'<!DOCTYPE a [<!ENTITY x "y">]><linkage2/>',
        "line 1  has a document type (DOCTYPE): entities are not read, remove it",
    ),
    "external.mjcf": (
        b'<!DOCTYPE a SYSTEM "file:///etc/passwd"><mujoco>&a;</mujoco>',
        "has a document type (DOCTYPE)",
    ),
    "entity.mjcf": (b"<mujoco>&a;</mujoco>", "is not XML: undefined entity (column 9)"),
    "deep.urdf": (b"<robot>" + b"<a>" * 200, "has elements nested deeper than 100 levels"),
    "other.ggb": (packed(GEOGEBRA, "other.xml"), "is a ZIP file without geogebra.xml"),
    "bomb.ggb": (packed(" " * 5_000_000), "unpacks to more than 4 MB: more is not read"),
    "cut.ggb": (SAMPLES["bar.ggb"][:200], "is a damaged ZIP file"),
    "nan.json": (b'{"joints": [NaN]}', "contains NaN: numbers must be finite"),
    "twice.json": (b'{"joints": [], "joints": []}', "gives a key twice in one object"),
    "deep.json": (b'{"joints":' + b"[" * 100_000, "is nested too deeply"),
    "broken.json": (b'{"joints": [}', "is not JSON: expecting value (column 13)"),
    "type.json": (b'{"joints": [{"name": "A", "type": "Ball"}]}', "has an unknown type 'Ball'"),
    "typed.json": (b'{"joints": [{"name": "A", "type": {}}]}', "has an unknown type '{}'"),
    "huge.dxf": (dxf_text().replace("500\n", "1e999\n").encode(), 'is "1e999": at most 1e+100'),
    "binary.dxf": (b"AutoCAD Binary DXF\r\n\x1a\0", "is a binary DXF file: save it as ASCII DXF"),
    "spatial.mjcf": (
        b'<mujoco><worldbody><body><joint/><body><joint axis="1 0 0"/></body></body></worldbody>'
        b"</mujoco>",
        "does not move in one plane with the others: only planar mechanisms are read",
    ),
    "bracket.pyslvs": (b"M[J[R, P[0, 0], L[a]]", 'expected ",", got the end'),
    "loose.pmks": (b"a,b,R,0,0\nb,c,R,1,1\nc,a,R,2,0", "has no fixed point: nothing is joined"),
    "other.sam": (b"\0\1", "files of SAM (ARTAS) have no published format: export a DXF drawing"),
    "photo.png": (
        b"\x89PNG",
        "is in no known format: give it the right suffix, or name the format (formats: ",
    ),
    "large.pmks": (b"x" * 4_000_001, "has more than 4 MB: more is not read"),
    "words.pmks": (b"\xff", "byte 0 (0xff) is not UTF-8"),
}


@pytest.mark.parametrize("name", _WRONG)
def test_wrong_files_are_refused_with_reason_and_place(name: str) -> None:
    data, message = _WRONG[name]
    with pytest.raises(lw.MechanismFileError) as refused:
        read_foreign(data, name)
    assert message in str(refused.value)


def test_a_missing_file_names_the_files_of_its_kind(tmp_path: Path) -> None:
    (tmp_path / "sketch.dxf").write_text("0")
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.readers.imported(tmp_path / "sketsh.dxf")
    assert "there is no such file (DXF files there: sketch.dxf)" in str(caught.value)


def test_every_format_has_a_sample() -> None:
    assert {read_foreign(data, name).format for name, data in SAMPLES.items()} == set(FORMATS)


def test_a_saved_import_reads_back(tmp_path: Path) -> None:
    file = tmp_path / "bar.linkage2"
    file.write_bytes(SAMPLES["bar.linkage2"])
    found = lw.readers.imported(file)
    found.save(tmp_path / "bar.toml")
    assert lw.load(tmp_path / "bar.toml").description == found.description
    assert json.dumps(found.carried)
    with pytest.raises(lw.UnknownNameError, match='there is no format "linkage" \\(formats: '):
        lw.readers.imported(file, "linkage")
