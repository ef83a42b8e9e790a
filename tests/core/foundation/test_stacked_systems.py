"""Stacked systems: a singular matrix spoils its own row only."""

from __future__ import annotations

import numpy as np

from linkwork.core.foundation.arrays import inverses, solutions


def test_a_singular_matrix_leaves_the_other_rows_as_they_are_alone() -> None:
    rng = np.random.default_rng(3)
    matrices, right = rng.normal(size=(4, 3, 3)), rng.normal(size=(4, 3, 2))
    whole, inverted = solutions(matrices, right), inverses(matrices)
    matrices[1, 2] = matrices[1, 0] = 0.0
    for found, alone in ((solutions(matrices, right), whole), (inverses(matrices), inverted)):
        assert np.isnan(found[1]).all()
        assert np.array_equal(found[[0, 2, 3]], alone[[0, 2, 3]])
