"""Files that their formats allow and few programs write."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

import linkwork as lw
from linkwork.readers.importing import read_foreign
from tests.readers.samples import GEOGEBRA, SAMPLES, dxf_text

_ARM = """\
<robot name="arm">
  <link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
  <joint name="one" type="revolute">{one}
    <parent link="base"/><child link="a"/><axis xyz="0 0 1"/><limit lower="0" upper="1"/></joint>
  <joint name="two" type="revolute"><mimic joint="one" multiplier="2" offset="0.5"/>
    <parent link="a"/><child link="b"/><axis xyz="0 0 1"/><origin xyz="1 0 0"/></joint>
  <joint name="three" type="revolute"><mimic joint="two" multiplier="-1" offset="0.25"/>
    <parent link="b"/><child link="c"/><axis xyz="0 0 1"/><origin xyz="1 0 0"/></joint>
  <joint name="end" type="revolute">
    <parent link="c"/><child link="d"/><axis xyz="0 0 1"/><origin xyz="1 0 0"/></joint>
</robot>
"""
#: A link with two points in common with each of two others, which have further ones.
_CHAIN = (
    "M["
    + ", ".join(
        f"J[R, P[{k}, {k * k % 7}], L[{names}]]"
        for k, names in enumerate(
            ("ground, g", "ground, h", "u, g", "u, h", "u, v", "u, v", "u, w", "u, w", "v, x",
             "v, x", "w, y", "w, y")
        )
    )
    + "]"
)  # fmt: skip


def _notes(data: bytes, name: str) -> list[str]:
    return [str(note) for note in read_foreign(data, name).left_out]


def test_sections_of_mujoco_are_merged_and_inactive_equalities_are_left_out() -> None:
    text = SAMPLES["bar.mjcf"].decode()
    whole = read_foreign(text.encode(), "bar.mjcf").description
    # all bodies in a second section, the angles after a first compiler
    parts = text.replace("<worldbody>", "<compiler/><worldbody/><worldbody>")
    assert read_foreign(parts.encode(), "bar.mjcf").description == whole
    weld = '<weld body1="crank" body2="world" active="false"/>'
    added = text.replace("</equality>", f"{weld}</equality>")
    assert read_foreign(added.encode(), "bar.mjcf").description == whole
    assert any("inactive <weld>" in note for note in _notes(added.encode(), "bar.mjcf"))


@pytest.mark.parametrize("flags", [1, 129, 9])
def test_polylines_are_closed_by_a_bit_of_their_flags(flags: int) -> None:
    # a pin on the closing piece belongs to the link
    pin = "  0\nCIRCLE\n  8\n0\n 10\n47\n 20\n61\n 40\n3\n  0\nLINE\n"
    text = dxf_text().replace("  0\nLINE\n", pin, 1)
    linkage = read_foreign(
        text.replace(" 70\n1\n", f" 70\n{flags}\n").encode(), "b.dxf"
    ).description
    assert [name for name, own in linkage.links.items() if "P6" in own] == ["L2"]


def test_what_a_drawing_shows_from_behind_or_on_its_sheet_is_left_out() -> None:
    text = dxf_text()
    assert "polyline seen from behind" in " ".join(
        _notes(text.replace(" 90\n3\n", "230\n-1.0\n").encode(), "bar.dxf")
    )
    arcs = text.replace(" 90\n3\n", " 42\n0.5\n")
    assert "arc of a polyline: read as straight" in " ".join(_notes(arcs.encode(), "bar.dxf"))
    # a title block: a circle at a pin, and lines
    sheet = "  0\nCIRCLE\n 67\n1\n  8\n0\n 10\n24\n 20\n32\n 40\n50\n  0\nLINE\n"
    added = text.replace("  0\nLINE\n", sheet, 1)
    assert read_foreign(added.encode(), "bar.dxf").description == (
        read_foreign(text.encode(), "bar.dxf").description
    )


def test_joints_that_follow_a_follower_have_its_range() -> None:
    linkage = read_foreign(_ARM.format(one="").encode(), "arm.urdf").description
    turns = [(which.from_, which.to) for which in linkage.inputs]
    spans = [float(b) - float(a) for a, b in turns]  # type: ignore[arg-type]  # numbers
    assert spans[1] == pytest.approx(2 * spans[0])
    assert spans[2] == pytest.approx(-spans[1])
    circle = _ARM.format(one='<mimic joint="three"/>')
    with pytest.raises(lw.MechanismFileError, match="follow each other in a circle"):
        read_foreign(circle.encode(), "arm.urdf")


def test_a_command_of_eleven_objects_keeps_their_order() -> None:
    corners = ["A", *(f"p{k}" for k in range(9)), "B"]
    points = "".join(
        f'<element type="point" label="p{k}"><coords x="{k}" y="{k * k}" z="1"/></element>'
        for k in range(9)
    )
    given = " ".join(f'a{k}="{name}"' for k, name in enumerate(corners))
    sides = " ".join(f'a{k}="side{k}"' for k in range(12))
    added = (
        f'{points}<command name="Polygon"><input {given}/><output {sides}/></command>'
        '<command name="Midpoint"><input a0="side11"/><output a0="half"/></command>'
        '<element type="point" label="half"><coords x="81" y="50" z="1"/></element></construction>'
    )
    text = GEOGEBRA.replace("</construction>", added)
    linkage = read_foreign(text.encode(), "bar.xml").description
    # the last side joins B and A, which are on one link
    assert [name for name, own in linkage.links.items() if "half" in own] == ["AB"]


def test_an_import_does_not_depend_on_the_order_of_sets() -> None:
    script = (
        "import sys; from linkwork.readers.importing import read_foreign as read\n"
        "found = read(sys.argv[1].encode(), 'chain.pyslvs'); "
        "print(found.description, found.left_out)"
    )
    seen = {
        subprocess.run(
            [sys.executable, "-c", script, _CHAIN],
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": str(seed)},
        ).stdout
        for seed in (1, 2)
    }
    assert len(seen) == 1
    assert "it moves with" in seen.pop()
