"""Products of tall matrices, some rows at a time."""

from __future__ import annotations

import numpy as np
import pytest

from linkwork.core.foundation.arrays import tall_product


@pytest.mark.parametrize("rows", [0, 1, 255, 256, 257, 1000])
@pytest.mark.parametrize(("inner", "columns"), [(4, 1), (12, 36), (0, 3), (3, 0), (300, 200)])
def test_all_rows_are_multiplied(rows: int, inner: int, columns: int) -> None:
    rng = np.random.default_rng(rows + inner)
    a, b = rng.standard_normal((rows, inner)), rng.standard_normal((inner, columns))
    np.testing.assert_allclose(tall_product(a, b), np.dot(a, b), rtol=0, atol=1e-12)


def test_complex_numbers_and_slices_of_arrays() -> None:
    rng = np.random.default_rng(5)
    a = (rng.standard_normal((700, 9)) + 1j * rng.standard_normal((700, 9)))[::2, 1:6]
    b = np.asarray(rng.standard_normal((5, 3)), dtype=complex)
    np.testing.assert_allclose(tall_product(a, b), np.dot(a, b), rtol=0, atol=1e-12)
