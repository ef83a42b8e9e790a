"""Packed columns come back as they went in, to ten digits."""

from __future__ import annotations

import base64

import numpy as np
import pytest
from hypothesis import given, strategies as st

from linkwork.app.pages.packing import packed, shortened, unpressed
from tests.app.unpacking import unpacked

_FULL = 2.0**-988  # smaller numbers have not ten digits left
_NUMBERS = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=60)


@given(_NUMBERS)
def test_columns_come_back(numbers: list[float]) -> None:
    values = np.array(numbers)
    found = np.ones(len(values), dtype=bool)
    back = unpacked(packed(values, found), found)
    assert np.abs(back - values).max() <= 2.0**-33 * max(np.abs(values).max(), _FULL)


def test_what_is_not_finite_is_no_number() -> None:
    values, found = np.array([3.0, np.inf, 5.0, np.nan]), np.array([True, True, True, False])
    for pack in (packed, unpressed, shortened):
        for rate in (False, True):
            back = unpacked(pack(values, found, rate=rate), found)
            assert np.isnan(back).tolist() == [False, True, False, True]
            assert back[[0, 2]] == pytest.approx(values[[0, 2]])


@given(_NUMBERS, st.data())
def test_rows_without_a_position_stay_empty(numbers: list[float], data: st.DataObject) -> None:
    values = np.array(numbers)
    found = np.array(data.draw(st.lists(st.booleans(), min_size=len(values), max_size=len(values))))
    back = unpacked(packed(np.where(found, values, np.nan), found), found)
    assert np.isnan(back).tolist() == (~found).tolist()


def test_smooth_columns_need_little_more_than_a_byte_a_row() -> None:
    turn = np.radians(np.arange(361.0))
    column = packed(40 * np.cos(turn) + 3 * np.sin(3 * turn), np.ones(361, dtype=bool))
    assert len(base64.b64decode(column.content)) < 1.6 * 361


def test_whole_numbers_are_kept_exactly() -> None:
    values = np.array([0.0, 360.0, -7.0, 2.0**40])
    column = packed(values, np.ones(4, dtype=bool), step=1.0)
    assert unpacked(column, np.ones(4, dtype=bool)).tolist() == values.tolist()


def test_a_step_that_is_too_fine_is_refused() -> None:
    with pytest.raises(ValueError, match=r"step 1e-12 is too fine for values up to 1e\+06"):
        packed(np.array([1e6]), np.ones(1, dtype=bool), step=1e-12)


@given(_NUMBERS)
def test_plain_columns_come_back_exactly(numbers: list[float]) -> None:
    values = np.array(numbers)
    found = np.ones(len(values), dtype=bool)
    assert unpacked(unpressed(values, found), found).tolist() == values.tolist()


def test_short_columns_have_seven_digits_and_half_the_size() -> None:
    values, found = np.array([0.1, -2e5, np.inf, 3e-8]), np.array([True, True, True, False])
    short = unpacked(shortened(values, found), found)
    assert short[:2] == pytest.approx([0.1, -2e5], rel=1e-7)
    assert np.isnan(short[2:]).all()
    assert len(shortened(values, found).content) == len(unpressed(values, found).content) / 2


def test_values_beyond_short_floats_are_gaps() -> None:
    back = unpacked(shortened(np.array([1e300, 2.5, -3.5e38]), np.ones(3, bool)), np.ones(3, bool))
    np.testing.assert_array_equal(back, [np.nan, 2.5, np.nan])
