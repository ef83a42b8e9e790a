from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.values import as_told, finite_number, plain_number

NO_NUMBERS = [
    ("90", "'90'"),
    (None, "None"),
    (True, "True"),
    (1j, "1j"),
    (b"1", "b'1'"),
    ([1, 2], "[1, 2]"),
    (np.array([40.0]), "[40.0]"),
    (np.array("2"), "'2'"),
    ((np.float64(1.5), [np.int64(2)]), "(1.5, [2])"),
    ("x" * 60, "'" + "x" * 39 + "…"),
]


@pytest.mark.parametrize(
    "given",
    [40, 40.0, np.float32(40), np.int8(40), np.array(40.0), Decimal(40), Fraction(80, 2)],
    ids=repr,
)
def test_a_number_is_one_whatever_its_type(given: object) -> None:
    number = plain_number(given)
    assert type(number) is float
    assert number == 40.0


@pytest.mark.parametrize(("number", "infinite"), [(10**400, np.inf), (-(10**400), -np.inf)])
def test_a_whole_number_beyond_every_float_is_infinite(number: int, infinite: float) -> None:
    assert plain_number(number) == infinite
    with pytest.raises(lw.InputError, match=f"^r must be a finite number, got {infinite}$"):
        finite_number("r", number)


@pytest.mark.parametrize(("given", "told"), NO_NUMBERS)
def test_what_is_no_number_is_told_as_it_was_given(given: object, told: str) -> None:
    assert plain_number(given) is None
    assert as_told(given) == told


@pytest.mark.parametrize(("given", "told"), NO_NUMBERS)
def test_every_place_that_takes_a_number_refuses_it(given: object, told: str) -> None:
    engine: Any = lw.example("slider-crank-engine")

    def refusal(of: str, ask: Callable[[], object]) -> None:
        with pytest.raises(lw.LinkworkError) as refused:
            ask()
        assert str(refused.value).endswith(f"{of} must be a finite number, got {told}")

    refusal("crank", lambda: engine.solve({"crank": given}))
    refusal("the guess of s", lambda: engine.iterates({"s": given}))
    if given is not None:
        refusal("crank", lambda: engine.solve(given))
    if not isinstance(given, str):  # a text is a formula
        refusal("dimensions.r ", lambda: engine.with_dimensions(r=given).model)
        if given is not None:
            refusal("input.from ", lambda: engine.sweep(from_=given))
