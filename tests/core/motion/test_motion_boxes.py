"""Boxes hold the whole motion between rows; points stay near their tangents in them."""

from __future__ import annotations

import numpy as np
import pytest

from linkwork.core.motion.extremes import Boxes, boxes_of, motions_of_points, refined, variables_of
from tests.library_mechanisms import read_example

# turning and sliding pairs, slides on turning links, a spline, gears
_MECHANISMS = ("jansen-leg", "rapier-drive-links", "crank-shaper", "whitworth", "geared-five-bar")
_FINER = 16


def _boxes(name: str, step: float) -> Boxes:
    mechanism = read_example(name)
    motion = mechanism.sweep(step=step)
    return boxes_of(mechanism.model, motion, variables_of(mechanism.model, motion))


@pytest.mark.parametrize("name", _MECHANISMS)
def test_points_stay_near_their_tangents_in_boxes(name: str) -> None:
    mechanism, step = read_example(name), 2.0
    model, boxes = mechanism.model, _boxes(name, step)
    fine = mechanism.sweep(step=step / _FINER, certify=False)
    places = np.stack([fine.trace(p) for p in model.compiled.points.names], axis=1)
    lead = np.asarray(next(iter(fine.inputs.values())))
    motions, size = motions_of_points(model, boxes), model.equations.length_scale
    assert boxes.holds[1:-1].all()
    for k in range(1, len(boxes) - 1):
        near = slice(_FINER * k - _FINER // 2, _FINER * k + _FINER // 2 + 1)
        s = np.radians(lead[near]) - boxes.leading[k]
        away = np.abs(places[near] - motions.place[k])
        bent = np.abs(places[near] - motions.place[k] - s[:, None] * motions.rate[k])
        # rows of the finer table are rounded, too
        assert (away <= motions.moved[k] + 1e-12 * size).all()
        assert (bent <= motions.bend[k] + 1e-12 * size).all()
        # no more than some times what bends, of second order in the step
        assert motions.bend[k].max() <= 40.0 * bent.max() + 1e-5 * size


def test_half_the_box_has_a_quarter_of_the_bend() -> None:
    model = read_example("klann-leg").model
    one, other = (motions_of_points(model, _boxes("klann-leg", step)) for step in (1.0, 0.5))
    assert other.bend[4:-4:2].max() == pytest.approx(0.25 * one.bend[2:-2].max(), rel=0.1)


@pytest.mark.parametrize(("start", "stop", "step"), [(10, 70, 60), (70, 10, -60), (10, 70, 30)])
def test_boxes_cover_the_interval_between_few_rows(start: float, stop: float, step: float) -> None:
    mechanism = read_example("four-bar")
    motion = mechanism.sweep(from_=start, to=stop, step=step)
    boxes = boxes_of(mechanism.model, motion, variables_of(mechanism.model, motion))
    ends = np.degrees(np.stack(boxes.ends, axis=1))
    ends = ends[np.argsort(ends[:, 0])]
    reached = ends[0, 1]
    for low, high in ends[1:]:
        assert low <= reached + 1e-9
        reached = max(reached, high)
    assert [ends[0, 0], reached] == pytest.approx([10.0, 70.0])
    assert boxes.known.all()


def test_boxes_are_halved_until_they_are_decided_and_no_longer() -> None:
    model, boxes = read_example("four-bar").model, _boxes("four-bar", 10.0)
    asked: list[int] = []

    def narrow(some: Boxes) -> np.ndarray:
        asked.append(len(some))
        return np.asarray(some.half[:, 0] < np.radians(2.0))

    # the first and the last box are rows only, those next to them twice as wide
    assert not len(refined(model, boxes, narrow, most=1000))
    assert asked == [37, 70, 140, 16]
    left = refined(model, boxes, lambda some: np.zeros(len(some), dtype=bool), most=300)
    assert left.known.all()
    assert left.half.max() == pytest.approx(np.radians(2.5))
    assert len(refined(model, boxes, lambda some: None, most=1000)) == len(boxes)
