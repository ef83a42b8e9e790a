"""Small mechanisms with every kind of guide and input, given by points and links."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from typing import Any

import linkwork as lw

__all__ = ["LINKAGES", "five_bar"]


def _xy(**places: complex) -> dict[str, tuple[float, float]]:
    return {name: (z.real, z.imag) for name, z in places.items()}


def _turn(link: str) -> tuple[lw.Input]:
    return (lw.Input(link=link, from_=0, to=360, step=3),)


def _slider_crank(**slider: Any) -> lw.Mechanism:
    """The block's own line B Q stands anywhere in the sketch; the slider says where it is."""
    return lw.linkage(
        points=_xy(O=0j, A=0.8 + 0.6j, B=3.6 + 0.9j, Q=4.4 + 1.4j, S=0.5 + 0.2j, T=5 + 0.7j),
        links={
            "ground": ("O", "S", "T"),
            "crank": ("O", "A"),
            "rod": ("A", "B"),
            "block": ("B", "Q"),
        },
        lengths={"O A": 1, "A B": 3, "B Q": 0.9},
        sliders=(lw.Slider(name="s", link="block", on="ground", line=("S", "T"), **slider),),
        inputs=_turn("crank"),
    )


def slider_of_one_point() -> lw.Mechanism:
    return _slider_crank(points=("B",), offset=0.4, angle=30)


def slider_of_one_point_as_sketched() -> lw.Mechanism:
    return _slider_crank(points=("B",), offset=-0.25)


def slider_of_two_points() -> lw.Mechanism:
    return _slider_crank(points=("B", "Q"), offset=0.4)


def slider_of_two_points_backwards() -> lw.Mechanism:
    return _slider_crank(points=("Q", "B"), offset=0.4)


def slider_on_a_moving_link() -> lw.Mechanism:
    """A block on a lever that turns about C; the crank's end A is on the block."""
    return lw.linkage(
        points=_xy(O=0j, C=-2.5j, A=1 + 0j, R=1.4 + 0.5j, Q=1.2 + 1.5j),
        links={
            "ground": ("O", "C"),
            "crank": ("O", "A"),
            "lever": ("C", "Q"),
            "block": ("A", "R"),
        },
        lengths={"O A": 1, "C Q": 4.3, "A R": 0.6},
        sliders=(
            lw.Slider(name="s", link="block", points=("A",), on="lever", line=("C", "Q"),
                      offset=-0.3, angle=50),
        ),
        inputs=_turn("crank"),
    )  # fmt: skip


def slot_on_ground() -> lw.Mechanism:
    """The far end of the rod is guided by a slot beside the crank."""
    return lw.linkage(
        points=_xy(O=0j, A=1 + 0j, P=-1.8 + 1.5j, S=-3 + 0j, T=-1 + 2.5j),
        links={"ground": ("O", "S", "T"), "crank": ("O", "A"), "rod": ("A", "P")},
        lengths={"O A": 0.6, "A P": 2.9},
        slots=(lw.Slot(name="s", point="P", on="ground", line=("S", "T")),),
        inputs=_turn("crank"),
    )


def slot_on_a_moving_link() -> lw.Mechanism:
    """Whitworth's quick return: the slot's line does not pass through the lever's pivot."""
    return lw.linkage(
        points=_xy(O=0j, C=0.4j, A=1 + 0j, D=-0.5 + 0.3j, Q=2 + 0.1j),
        links={"ground": ("O", "C"), "crank": ("O", "A"), "lever": ("C", "D", "Q")},
        lengths={"O A": 1},
        slots=(lw.Slot(name="s", point="A", on="lever", line=("D", "Q")),),
        inputs=_turn("crank"),
    )


def _boom(which: lw.Input) -> lw.Mechanism:
    return lw.linkage(
        points=_xy(O=0j, M=1.5 - 0.5j, N=1.8 + 1.2j, H=4 + 2.5j),
        links={"ground": ("O", "M"), "boom": ("O", "N", "H")},
        lengths={"O N": 2.2, "N H": 2.6, "O H": 4.7},
        cylinders=(lw.Cylinder(name="ram", between=("M", "N")),),
        inputs=(which,),
    )


def cylinder_as_input() -> lw.Mechanism:
    return _boom(lw.Input(cylinder="ram", from_=1.2, to=3.2, step=0.02))


def cylinder_that_follows() -> lw.Mechanism:
    return _boom(lw.Input(link="boom", from_=0, to=150, step=1))


def slider_as_input() -> lw.Mechanism:
    return lw.linkage(
        points=_xy(O=0j, A=0.6 + 0.8j, B=3.4 + 0.3j, S=0.3j, T=5 + 0.3j),
        links={
            "ground": ("O", "S", "T"),
            "crank": ("O", "A"),
            "rod": ("A", "B"),
            "block": ("B",),
        },
        lengths={"O A": 1, "A B": 3},
        sliders=(lw.Slider(name="s", link="block", points=("B",), on="ground", line=("S", "T")),),
        inputs=(lw.Input(slider="s", from_=2.1, to=3.9, step=0.02),),
    )


def _four_bar(which: lw.Input) -> lw.Mechanism:
    return lw.linkage(
        points=_xy(O=0j, A=0.3 + 1j, B=3 + 2j, C=2.6 + 0j, P=1.5 + 2.5j),
        links={
            "ground": ("O", "C"),
            "crank": ("O", "A"),
            "coupler": ("A", "B", "P"),
            "rocker": ("C", "B"),
        },
        lengths={"O A": 1, "A B": 2.9, "C B": 2.1},
        inputs=(which,),
    )


def link_against_link() -> lw.Mechanism:
    return _four_bar(lw.Input(link="coupler", relative_to="crank", from_=-90, to=10, step=1))


def joint_as_input() -> lw.Mechanism:
    return _four_bar(lw.Input(joint="B", from_=30, to=100, step=1))


def pin_of_three_links() -> lw.Mechanism:
    """Coupler, rocker and a rod meet at one pin."""
    return lw.linkage(
        points=_xy(O=0j, A=0.3 + 1j, B=3 + 2j, C=2.6 + 0j, F=5.5 + 2.2j, G=5.4 + 0j),
        links={
            "ground": ("O", "C", "G"),
            "crank": ("O", "A"),
            "coupler": ("A", "B"),
            "rocker": ("C", "B"),
            "rod": ("B", "F"),
            "out": ("G", "F"),
        },
        lengths={"O A": 1, "A B": 2.9, "C B": 2.1, "B F": 2.7, "G F": 2.4},
        inputs=_turn("crank"),
    )


LINKAGES: dict[str, Callable[[], lw.Mechanism]] = {
    build.__name__.replace("_", " "): build
    for build in (
        slider_of_one_point,
        slider_of_one_point_as_sketched,
        slider_of_two_points,
        slider_of_two_points_backwards,
        slider_on_a_moving_link,
        slot_on_ground,
        slot_on_a_moving_link,
        cylinder_as_input,
        cylinder_that_follows,
        slider_as_input,
        link_against_link,
        joint_as_input,
        pin_of_three_links,
    )
}


def five_bar() -> lw.Mechanism:
    """Two cranks in lock-step, the right one backwards and half as fast."""
    left, right = cmath.rect(1, math.radians(20)), 3 + cmath.rect(1, math.radians(160))
    return lw.linkage(
        points=_xy(O=0j, A=left, P=1.5 + 2.4j, B=right, C=3 + 0j),
        links={
            "ground": ("O", "C"),
            "left": ("O", "A"),
            "long": ("A", "P"),
            "short": ("B", "P"),
            "right": ("C", "B"),
        },
        lengths={"O A": 1, "C B": 1, "A P": 2.5, "B P": 2.2},
        inputs=(
            lw.Input(link="left", from_=20, to=120, step=1, speed="2 rad/s"),
            lw.Input(link="right", from_=160, to=110, step=-0.5),
        ),
    )
