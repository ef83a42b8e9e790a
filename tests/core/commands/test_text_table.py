"""Tables: aligned, as wide as the terminal, digits that make sense."""

from __future__ import annotations

import math

import pytest

from linkwork.core.commands.terminal import fields, table_lines
from linkwork.core.results.listing import Column, fixed, lengths, short, significant


def test_decimal_points_stand_below_each_other_and_units_behind() -> None:
    columns = [
        Column(header="name", cells=["θ", "s16"]),
        Column(header="value", cells=["-1.25", "300"], align="point", units=["deg", ""]),
        Column(header="k", cells=["1", "10"], align="right"),
    ]
    assert table_lines(columns) == [
        "  name   value       k",
        "  θ      -1.25 deg   1",
        "  s16   300         10",
    ]


def test_columns_that_do_not_fit_follow_below_with_the_first_repeated() -> None:
    columns = [Column(header=h, cells=[c]) for h, c in (("k", "0"), ("first", "1"), ("last", "2"))]
    assert table_lines(columns, 12) == ["  k  first", "  0  1", "", "  k  last", "  0  2"]


def test_the_first_column_is_cut_where_nothing_else_would_fit_beside_it() -> None:
    columns = [
        Column(header="name", cells=["a_name_of_a_link", "b"]),
        Column(header="value", cells=["12.5", "3"], align="right"),
    ]
    assert table_lines(columns, 20) == [
        "  name         value",
        "  a_nam…_link   12.5",
        "  b                3",
    ]


def test_wide_letters_take_two_cells() -> None:
    columns = [Column(header="x", cells=["角", "ab"]), Column(header="y", cells=["1", "2"])]
    assert table_lines(columns) == ["  x   y", "  角  1", "  ab  2"]


@pytest.mark.parametrize(
    ("value", "text"),
    [(1.5, "1.500000"), (-1e-9, "0.000000"), (math.nan, "-"), (-720.0, "-720.000000")],
)
def test_angles_have_six_decimals_and_no_negative_zero(value: float, text: str) -> None:
    assert fixed(value) == text


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ([1225.0, -0.5], ["1225.00", "-0.50"]),
        ([0.25, 0.001], ["0.250000", "0.001000"]),
        ([99.9999999], ["100.000"]),
        ([1e12, 1.0], ["1.00000e+12", "1.00000"]),
        ([0.0], ["0.00000"]),
        ([], []),
    ],
)
def test_lengths_share_decimals_and_the_largest_has_six_digits(
    values: list[float], texts: list[str]
) -> None:
    assert lengths(values) == texts


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0123456789, "0.0123457"),
        (-168.5810001, "-168.581"),
        (1e-7, "1.00000e-07"),
        (1e-17, "0"),
        (25684.7261, "25684.7"),
        (1.5e9, "1.50000e+09"),
        (math.inf, "-"),
    ],
)
def test_rates_have_six_significant_digits(value: float, text: str) -> None:
    assert significant(value, 6, noise=1e-15) == text


def test_input_values_look_as_they_were_typed() -> None:
    assert [short(v) for v in (60.0, 0.1 + 0.2, 117.62032123456)] == ["60", "0.3", "117.6203212"]


def test_nothing_to_list_has_no_lines() -> None:
    assert table_lines([]) == []
    assert fields([]) == []
