"""Lines on ground that points run along, found in loop equations."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.pages.moving_scene import Frame, moving_scene
from linkwork.core.drawing import Disc, Hatch, Polygon, Role, scene_of
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.mechanism.skeleton import Rail

Where = complex | tuple[str, tuple[str, str]]
FOUND: dict[str, list[tuple[str, tuple[str, ...], Where]]] = {
    "rapier-drive": [("s16", ("D", "E"), -1)],
    "coupled-six-link": [("s6", ("D",), 1), ("s4", ("A",), ("rod", ("C", "D")))],
    "crank-slider": [("d", ("B",), 1)],
    "slider-input": [("d", ("B",), 1)],
    "double-four-bar": [],
}


@pytest.mark.parametrize("name", FOUND)
def test_rails_of_the_library(name: str) -> None:
    rails = lw.example(name).model.skeleton.rails
    assert rails == tuple(_rail(*expected) for expected in FOUND[name])


def _rail(variable: str, points: tuple[str, ...], where: Where) -> Rail:
    if isinstance(where, tuple):
        return Rail(name=variable, points=points, on=where[0], line=where[1])
    return Rail(name=variable, points=points, along=where)


@pytest.mark.parametrize("name", [name for name, rails in FOUND.items() if rails])
def test_points_stay_on_their_rail_as_far_as_the_variable_says(name: str) -> None:
    mechanism = lw.example(name)
    motion = mechanism.sweep()
    for rail in mechanism.model.skeleton.rails:
        for point in rail.points:
            way = motion.trace(point)[motion.found]
            along: complex | ComplexArray = rail.along
            from_ = way[0]
            if rail.line is not None:
                foot, tip = (motion.trace(end)[motion.found] for end in rail.line)
                along, from_ = (tip - foot) / abs(tip - foot), foot
            far = (way - from_) * np.conj(along)
            np.testing.assert_allclose(far.imag, 0.0, atol=1e-9 * abs(way).max())
            value = motion[rail.name][motion.found]
            start = value[0] - far.real[0]
            np.testing.assert_allclose(far.real, value - start, atol=1e-9 * abs(way).max())


INCLINED = """
format = 1
length = "mm"
[dimensions]
r = 40
l = 120
alpha = 30
[loops]
"1" = "r*e^(i*φ) + l*e^(i*ψ) = s*e^(i*alpha) - 10*i"
[guess]
"φ" = 60
"ψ" = -10
s = 140
[input]
variable = "φ"
[points]
O = "0"
A = "r*e^(i*φ)"
B = "A + l*e^(i*ψ)"
C = "B + 30*e^(i*ψ)"
[links]
ground = ["O"]
crank = ["O", "A"]
rod = ["A", "B", "C"]
"""


def test_an_inclined_rail_carries_a_block_with_a_pin() -> None:
    mechanism = lw.loads(INCLINED)
    (rail,) = mechanism.model.skeleton.rails
    assert (rail.name, rail.points) == ("s", ("B",))
    assert rail.along == pytest.approx(np.exp(1j * np.pi / 6))
    assert mechanism.model.skeleton.pins == ("O", "A", "B")
    position = mechanism.solve()
    scene = scene_of(position, mechanism.sweep())
    (block,) = scene.select(Polygon, Role.SLIDER)
    middle = np.mean([complex(*corner) for corner in block.points])
    assert middle == pytest.approx(complex(*position.points["B"]))
    assert {pin.of for pin in scene.select(Disc, Role.PIN)} == {"O", "A", "B"}
    assert "s" in {hatch.of for hatch in scene.select(Hatch)}


def test_a_block_on_a_link_turns_with_it() -> None:
    mechanism = lw.example("coupled-six-link")
    position = mechanism.solve(200)
    blocks = scene_of(position, mechanism.sweep()).select(Polygon, Role.SLIDER)
    (block,) = [block for block in blocks if block.of == "s4"]
    corners = [complex(*corner) for corner in block.points]
    rod = complex(*position.points["D"]) - complex(*position.points["C"])
    assert ((corners[1] - corners[0]) / rod).imag == pytest.approx(0, abs=1e-9)
    assert np.mean(corners) == pytest.approx(complex(*position.points["A"]))
    assert "A" in mechanism.model.skeleton.pins


def test_the_arrow_of_a_driven_block_goes_with_it() -> None:
    motion = lw.example("slider-input").sweep()
    moving = moving_scene(motion)
    (arrow,) = [part for part in moving.parts if part.shape.role is Role.INPUT]
    assert arrow.frame == Frame("B", "")


def test_a_length_that_turns_makes_no_rail() -> None:
    turning = INCLINED.replace("s*e^(i*alpha)", "s*e^(i*(φ + 90))").replace("s = 140", "s = 90")
    assert lw.loads(turning).model.skeleton.rails == ()
