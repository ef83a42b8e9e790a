"""Time ratios of quick returns against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw


@pytest.mark.parametrize("step", [1, 4])
def test_of_an_offset_slider_crank_it_follows_from_both_stretched_positions(step: float) -> None:
    motion = lw.example("slider-crank").sweep(step=step)
    far, near = (np.degrees(np.arcsin(20 / reach)) for reach in (160, 80))
    expected = (180 + near - far) / (180 - near + far)
    assert motion.value("time_ratio(d)") == pytest.approx(expected, rel=1e-9 * step**4)
    assert motion.quantities.find_of_motion("time_ratio(d)").unit == ""


def test_it_is_1_for_strokes_that_take_as_long() -> None:
    motion = lw.example("scotch-yoke").sweep()
    name = next(iter(motion.sliders))
    assert motion.value(f"time_ratio({name})") == pytest.approx(1.0, abs=1e-9)


def test_designs_have_it_as_they_have_it_alone() -> None:
    mechanism = lw.example("slider-crank")
    cranks = np.array([30.0, 40.0, 45.0])
    found = mechanism.family({"O2 A": cranks}).reduced("time_ratio(d)")["time_ratio(d)"]
    far, near = (np.degrees(np.arcsin(20 / (120 + s * cranks))) for s in (1, -1))
    np.testing.assert_allclose(found, (180 + near - far) / (180 - near + far), rtol=1e-8)


def test_without_a_whole_turn_or_a_return_there_is_none() -> None:
    slider = lw.example("slider-crank").sweep(to=300)
    assert np.isnan(slider.value("time_ratio(d)"))
    drag = lw.example("drag-link").sweep()
    turning = next(name for name, s in drag.unknowns.items() if abs(s.value[-1] - s.value[0]) > 300)
    assert np.isnan(drag.value(f"time_ratio({turning})"))
    with pytest.raises(lw.UnknownNameError, match="a quantity that is no rate"):
        slider.value("time_ratio(d.d1)")


def test_of_what_does_not_change_there_is_none() -> None:
    # a slider on a level line: its y is constant but for rounding
    motion = lw.example("rapier-drive").sweep()
    assert np.ptp(motion["E.y"]) < 1e-9
    assert np.isnan(motion.value("time_ratio(E.y)"))


@pytest.mark.parametrize("law", ["cycloidal", "3-4-5", "4-5-6-7", "harmonic"])
@pytest.mark.parametrize("start", [0.0, 7.5])
def test_rests_are_part_of_no_stroke(law: str, start: float) -> None:
    """A rise over 20 deg and a return over 30 deg, whatever rests between them."""
    segments = (
        lw.Segment(law=law, over=20, lift=10),
        lw.Segment(law="dwell", over=60),
        lw.Segment(law=law, over=30, lift=-10),
        lw.Segment(law="dwell", over=250),
    )
    cam = lw.linkage(
        points={"O": (0, 0), "S": (0, -50), "T": (0, 100), "P": (0, 40)},
        links={"ground": ["O", "S", "T"], "disc": ["O"], "f": ["P"]},
        sliders=[
            lw.Slider(name="s", link="f", points=("P",), angle=90, on="ground", line=("S", "T"))
        ],
        cams=[
            lw.Cam(
                name="cam", cam="disc", center="O", slider="s", base=40, start=start,
                segments=segments,
            )
        ],
        inputs=lw.Input(link="disc", from_=0, to=360, step=1),
    )  # fmt: skip
    found = [cam.sweep(step=step).value("time_ratio(s)") for step in (1, 5, 10, 20)]
    # 4-5-6-7 leaves a rest with the fourth power of the angle
    assert found == pytest.approx([1.5] * 4, rel=2e-6)
