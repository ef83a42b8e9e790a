"""What cannot be meant is refused in words, wherever it is given."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.families import random

BAR: Any = lw.example("four-bar")  # asked for what its types refuse
draw: Any = random
NO_NAME = "a name must be a text, got 3"


def family() -> Any:
    return BAR.family({"O2 A": [40, 41]})


@pytest.mark.parametrize(
    ("ask", "told"),
    [
        (lambda: BAR.family(None), "a family needs a mapping of names and their values, as in "),
        (lambda: BAR.family([1, 2]), '{"a2": [40, 50]}, got [1, 2]'),
        (lambda: BAR.family({3: [1]}), NO_NAME),
        (lambda: BAR.family({"O2 A": [np.float64(40), "x"]}), "numbers, got [40.0, 'x']"),
        (
            lambda: BAR.family({"O2 A": np.ma.masked_array([40, 121.0], [False, True])}),
            '"O2 A" holds masked values: fill them (with NaN those designs are not found), '
            "or leave these designs out",
        ),
        (lambda: draw(5, [1], seed=1), "a plan needs a mapping of names and values, got [1]"),
        (lambda: draw(5, {"a": (1, 2)}, seed=True), "seed must be a whole number, 0 or more"),
        (lambda: BAR.sweep(configuration=3), NO_NAME),
        (lambda: BAR.solve(configuration=3), NO_NAME),
        (lambda: BAR.sweep(limits_of=3), "the quantities must be a list of names, got 3"),
        (lambda: BAR.sweep(limits_of=[3]), NO_NAME),
        (lambda: BAR.sweep(change_points=3), '"3" is not a policy at a change point'),
        (lambda: BAR.sweep(change_points=np.array([])), '"[]" is not a policy at a change point'),
        (lambda: BAR.sweep(step=90)[3], NO_NAME),
        (lambda: BAR.sweep(step=90).trace(3), NO_NAME),
        (lambda: BAR.solve()[3], NO_NAME),
        (lambda: BAR.configurations()[2.5], 'there is no configuration "2.5"'),
        (lambda: family().reduced({3: "min"}), NO_NAME),
        (lambda: family().sweep(threads=1)[3], NO_NAME),
    ],
)
def test_it_is_refused(ask: Callable[[], object], told: str) -> None:
    with pytest.raises(lw.InputError) as refused:
        ask()
    assert told in str(refused.value)


@pytest.mark.parametrize("threads", [0, -1, True, "2", 1.5, 2.0, float("nan"), np.float64(1)])
def test_threads_are_counted_in_whole_numbers(threads: object) -> None:
    for ask in (family().sweep, family().parts):
        with pytest.raises(
            lw.InputError, match=r"^threads must be a whole number, 1 or more, got "
        ):
            ask(threads=threads)
    assert family().sweep(threads=np.int64(2)).found.all()


def test_an_array_that_masks_nothing_is_an_array() -> None:
    whole = BAR.family({"O2 A": np.ma.masked_array([40, 41], [False, False])})
    np.testing.assert_array_equal(whole.sweep()["rocker"], family().sweep()["rocker"])


def test_one_quantity_needs_no_list() -> None:
    one, several = BAR.sweep(limits_of="rocker"), BAR.sweep(limits_of=["rocker"])
    assert one.output_limits == several.output_limits
    assert len(one.output_limits) == 2
