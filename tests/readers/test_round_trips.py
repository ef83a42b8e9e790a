"""What is written for another program and read back moves as before."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.mechanism.linkage import Linkage
from linkwork.readers.importing import WRITERS, read_foreign
from tests.readers.round_trips import RoundTrip, robot_round_trip, round_trip

#: Roundings of the sweep, larger close to a change point.
_ROUNDING = 1e-9
#: A slide's direction in a link of PMKS+ is in thousandths of a radian, rounded, over its travel.
_MILLIRADIANS = 5e-4
_SOME = ("four-bar", "ross-yoke", "whitworth", "hoeken")


def _agrees(name: str, form: str) -> bool:
    """Whether the motion is the same; false where the format does not carry the mechanism."""
    found = robot_round_trip(name) if form == "mjcf" else round_trip(name, form)
    if isinstance(found, str):
        assert found.startswith(("refused", "given", "not compared")), found
        return False
    slides = lw.example(name).description
    rounded = (
        form == "pmks" and isinstance(slides, Linkage) and bool(slides.sliders or slides.slots)
    )
    assert found.difference <= (_MILLIRADIANS if rounded else _ROUNDING)
    assert found.rows > 1
    assert found.points >= 2
    return True


@pytest.mark.parametrize("form", [*WRITERS, "mjcf"])
def test_some_mechanisms_come_back(form: str) -> None:
    assert sum(_agrees(name, form) for name in _SOME) >= 2


@pytest.mark.extended
@pytest.mark.parametrize("form", [*WRITERS, "mjcf"])
def test_a_sample_of_the_library_comes_back(form: str) -> None:
    assert sum(_agrees(name, form) for name in list(lw.examples())[::9]) >= 4


def test_a_wrong_coordinate_would_be_seen() -> None:
    right = lw.readers.exported(lw.example("four-bar"), "pyslvs", at=60).text
    wrong = right.replace("P[100.0, 0.0]", "P[100.1, 0.0]")
    assert wrong != right
    at = [
        read_foreign(text.encode(), "x.pyslvs").description.points["P3"] for text in (right, wrong)
    ]
    assert at[0] != at[1]


def test_an_open_chain_comes_back_from_urdf(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    pendulum = lw.example("pendulum")
    pendulum.write(path)
    found = lw.readers.imported(path)
    motion, ours = found.mechanism.sweep(), pendulum.sweep()
    end = next(p for p in found.description.points if p not in found.description.links["ground"])
    size = np.abs(motion.place(end).v)
    assert size == pytest.approx(size[0], rel=1e-12)
    assert motion.found.all()
    assert ours.found.all()


def test_formats_that_cannot_carry_a_part_refuse_it() -> None:
    with pytest.raises(lw.InputError, match=r'"mesh" \(gear pair\) has no equivalent'):
        lw.readers.exported(lw.example("geared-five-bar"), "pyslvs")
    with pytest.raises(lw.InputError, match="slides on a moving link"):
        lw.readers.exported(lw.example("whitworth"), "pylinkage")
    with pytest.raises(lw.InputError, match="is given by equations"):
        lw.readers.exported(lw.example("rapier-drive"), "pmks")
    with pytest.raises(lw.InputError, match=r'"dxf" is not written \(formats: '):
        lw.readers.exported(lw.example("four-bar"), "dxf")


def test_what_a_format_leaves_out_is_listed() -> None:
    made = lw.readers.exported(lw.example("four-bar"), "pyslvs")
    assert [str(left) for left in made.left_out] == [
        '"crank": range or law of the input',
        '"crank": the input: an expression does not state it',
    ]
    assert isinstance(round_trip("four-bar", "pyslvs"), RoundTrip)
