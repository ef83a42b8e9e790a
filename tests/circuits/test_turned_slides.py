"""Which slides only direct themselves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import linkwork as lw
from linkwork.circuits.assembling import turned_slides
from linkwork.core.table.rows import LinearRows


def _shaper() -> lw.Mechanism:
    return lw.loops(
        name="shaper",
        loops={"l": "2*e^(i*q) + 5*i = s*e^(i*t)"},
        guess={"q": 60, "t": 60, "s": 3},
        inputs=(lw.Input(variable="q"),),
    )


def test_a_length_along_a_direction_of_its_own_is_found_by_number() -> None:
    (slide,) = turned_slides(_shaper().model)
    names = [v.name for v in _shaper().loop_equations.unknowns]
    assert (names[slide.angle], [names[k] for k in slide.lengths]) == ("t", ["s"])


def test_an_angle_in_a_linear_relation_is_not_free_to_turn_around() -> None:
    model = _shaper().model
    relation = LinearRows(
        constant=np.zeros(1), row=np.array([0]), variable=np.array([0]), weight=np.ones(1)
    )
    angle = turned_slides(model)[0].angle
    tied = replace(relation, variable=np.array([angle]))
    table = replace(model.compiled.table, linear=tied)
    assert turned_slides(replace(model, compiled=replace(model.compiled, table=table))) == ()
