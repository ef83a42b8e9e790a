"""Arrows of inputs stand beside what they drive and lie over nothing else."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest

import linkwork as lw
from linkwork.core.drawing import Arc, Disc, Hatch, Polygon, Polyline, Role, Scene, scene_of
from linkwork.core.drawing.scene import Primitive
from tests.core.drawing.conftest import Sample


def pushed_slide(foot: complex, which: lw.Input) -> lw.Mechanism:
    """A crank and rod move a block on a rail; a cylinder reaches from ``foot`` to the block."""
    return lw.linkage(
        name="pushed slide",
        points={"O": (0, 0), "A": (60, 80), "B": (340, 0), "S": (-10, 0), "T": (500, 0)}
        | {"K": (foot.real, foot.imag)},
        links={"ground": ("O", "S", "T", "K"), "crank": ("O", "A"), "rod": ("A", "B")}
        | {"block": ("B",)},
        lengths={"O A": 100, "A B": 300},
        sliders=(lw.Slider(name="s", link="block", points=("B",), on="ground", line=("S", "T")),),
        cylinders=(lw.Cylinder(name="ram", between=("K", "B")),),
        inputs=(which,),
    )


def swung_boom() -> lw.Mechanism:
    """A boom driven at a pivot that also carries the foot of a cylinder."""
    return lw.linkage(
        name="swung boom",
        points={"O": (0, 0), "A": (100, 0), "M": (80, 70), "C": (180, 0)},
        links={"ground": ("O", "C"), "boom": ("O", "A"), "arm": ("C", "M"), "stick": ("A", "M")},
        cylinders=(lw.Cylinder(name="ram", between=("O", "M")),),
        inputs=(lw.Input(link="boom", from_=-20, to=40, step=2),),
    )


SLIDE = lw.Input(slider="s", from_=220, to=390, step=2)
RAM = lw.Input(cylinder="ram", from_=90, to=250, step=2)
MECHANISMS = {
    "slide under a cylinder": lambda: pushed_slide(355 + 160j, SLIDE),
    "slide beside a slanting cylinder": lambda: pushed_slide(150 + 130j, SLIDE),
    "slide above a cylinder": lambda: pushed_slide(350 - 160j, SLIDE),
    "cylinder over a rail": lambda: pushed_slide(480 + 0j, RAM),
    "boom over a cylinder's foot": swung_boom,
}


def segments(part: Primitive) -> list[tuple[complex, complex]]:
    """The line pieces of a primitive, its arrow head included."""
    if isinstance(part, Hatch):
        return [(complex(*a), complex(*b)) for a, b in part.strokes]
    no_head: tuple[tuple[float, float], ...] = ()
    if isinstance(part, Polygon):
        line, head = (*part.points, part.points[0]), no_head
    else:
        assert isinstance(part, Polyline | Arc)
        line, head = part.shaft, part.arrow_head
    pieces = [*pairwise(line), *pairwise((*head, *head[:1]))]
    return [(complex(*a), complex(*b)) for a, b in pieces]


def apart(one: tuple[complex, complex], other: tuple[complex, complex]) -> float:
    """The distance of two line pieces."""

    def to(z: complex, piece: tuple[complex, complex]) -> float:
        start, step = piece[0], piece[1] - piece[0]
        along = ((z - start) * step.conjugate()).real / (abs(step) ** 2 or 1.0)
        return abs(z - start - min(max(along, 0.0), 1.0) * step)

    def side(z: complex, piece: tuple[complex, complex]) -> float:
        return ((piece[1] - piece[0]).conjugate() * (z - piece[0])).imag

    crossing = (
        side(one[0], other) * side(one[1], other) < 0 > side(other[0], one) * side(other[1], one)
    )
    if crossing:
        return 0.0
    return min(to(one[0], other), to(one[1], other), to(other[0], one), to(other[1], one))


def least_gap(scene: Scene) -> tuple[float, str]:
    """How near an input arrow comes to anything else, in radii of a pin, and to what."""
    arrows = [p for p in scene.primitives if p.role is Role.INPUT]
    assert arrows
    gaps = []
    for part in scene.primitives:
        if part.role in (Role.INPUT, Role.LABEL):
            continue
        for arrow in arrows:
            if isinstance(part, Disc):
                near = (complex(*part.centre),) * 2
                gap = min(apart(near, piece) for piece in segments(arrow)) - part.radius
            else:
                gap = min(apart(a, b) for a in segments(arrow) for b in segments(part))
            gaps.append((gap / scene.measures.pin, f"{part.role.name.lower()}:{part.of}"))
    return min(gaps)


@pytest.mark.parametrize("name", MECHANISMS)
def test_an_input_arrow_lies_over_nothing(name: str) -> None:
    mechanism = MECHANISMS[name]()
    motion = mechanism.sweep(certify=False)
    values = next(iter(motion.inputs.values()))[motion.found]
    for value in values[:: len(values) // 6].tolist():
        gap, part = least_gap(scene_of(mechanism.solve(value, certify=False), motion))
        assert gap > 0.3, (value, part)


def test_a_slide_keeps_its_usual_arrow_where_nothing_is_in_the_way(
    slope: Callable[[float], Sample],
) -> None:
    for degrees in (0, 75, -40):
        mechanism = slope(degrees)
        scene = scene_of(mechanism.position(120), mechanism.motion())
        [arrow] = scene.select(Polyline, Role.INPUT)
        [block] = scene.select(Polygon, Role.SLIDER)
        middle = sum(complex(*p) for p in arrow.points) / 2
        height = 1.9 * scene.measures.pin + 1.7 * scene.measures.pin
        assert abs(middle - sum(complex(*p) for p in block.points) / 4) == pytest.approx(height)


def test_arrows_of_two_inputs_keep_clear_of_each_other() -> None:
    both = lw.linkage(
        name="two cylinders on one pin",
        points={"O": (0, 0), "M": (80, 6), "K": (0, 18), "C": (120, -40), "A": (60, -50)},
        links={"ground": ("O", "C", "K"), "arm": ("A", "M"), "boom": ("C", "A")},
        cylinders=(
            lw.Cylinder(name="one", between=("O", "M")),
            lw.Cylinder(name="two", between=("M", "K")),
        ),
        inputs=(
            lw.Input(cylinder="one", from_=78, to=80, step=1),
            lw.Input(cylinder="two", from_=80, to=82, step=1),
        ),
    )
    scene = scene_of(both.solve())
    one, two = scene.select(Polyline, Role.INPUT)
    between = min(apart(a, b) for a in segments(one) for b in segments(two))
    assert between > 0.3 * scene.measures.pin
    assert least_gap(scene)[0] > 0.3


def test_an_arrow_ends_in_a_sharp_tip(four_bar: Sample) -> None:
    scene = scene_of(four_bar.position(50))
    [arrow] = scene.select(Arc, Role.INPUT)
    tip, end = complex(*arrow.arrow_head[0]), complex(*arrow.shaft[-1])
    assert complex(*arrow.points[-1]) == tip
    # The line is thick: it ends inside the head, where the head is wider than the line.
    assert 0.5 * arrow.head < abs(tip - end) < 0.9 * arrow.head
    assert complex(*arrow.shaft[0]) == complex(*arrow.points[0])
    assert math.dist(arrow.shaft[-1], arrow.centre) == pytest.approx(arrow.radius)
    straight = Polyline(role=Role.INPUT, points=((0, 0), (10, 0)), head=2.0)
    wanted: Any = ((0, 0), (pytest.approx(8.6), 0))
    assert straight.shaft == wanted
    assert replace(straight, head=0.0).shaft == straight.points


def test_an_arrow_goes_around_a_plate_that_fills_its_usual_place() -> None:
    scene = scene_of(lw.example("double-butterfly").solve())
    [arrow] = scene.select(Arc, Role.INPUT)
    [crank] = scene.select(Polygon, Role.PLATE, of="crank")
    far = max(abs(complex(*z) - complex(*arrow.centre)) for z in crank.points)
    assert arrow.radius > far
