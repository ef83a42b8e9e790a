"""The objective that optimisers of other packages get, against a printed design."""

from __future__ import annotations

import cmath
import math

import pytest

from benchmarks.peers.pylinkage_path import PathFit
from tests.campaigns.printed_curves import KRILL_EIGHTEEN


def test_the_objective_of_pylinkage_has_the_sum_of_squares_of_a_known_design() -> None:
    pytest.importorskip("pylinkage", reason="a peer of the benchmarks")
    fit = PathFit(KRILL_EIGHTEEN, math.radians(20.0))
    arm = complex(0.37059736, 0.399346668)
    pivots = [0.267655509, 0.154649551, 1.27913659, 0.450796154]
    lengths = [0.423874992, 0.914249839, 0.598916883, abs(arm)]
    design = [*pivots, *lengths, cmath.phase(arm), 1.17638041]
    # nine printed digits of the design
    assert fit.score(None, [*design, 1.0], None) == pytest.approx(0.00902888, rel=1e-6)
    assert fit.score(None, [*design, -1.0], None) > 1.0
    open_loop = [*design[:4], 9.0, *design[5:], 1.0]
    assert fit.score(None, open_loop, None) == math.inf
