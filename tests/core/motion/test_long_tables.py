"""Long tables: rows do not depend on how many others there are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import linkwork as lw
from tests.library_mechanisms import read_example
from tests.thinned import thinned

MOVED = [name for name in lw.examples() if len(read_example(name).description.inputs) == 1]
EVERY = 8


@pytest.mark.parametrize("certify", [True, False])
@pytest.mark.parametrize("name", thinned(MOVED, 6))
def test_rows_of_a_long_table_are_those_of_a_short_one(name: str, certify: bool) -> None:
    mechanism = read_example(name)
    (own,) = mechanism.description.inputs
    asked = mechanism.model.rows_in_file_units[:, 0]
    step = float(asked[1] - asked[0]) / EVERY
    longer = replace(own, from_=float(asked[0]), to=float(asked[-1]), step=step)
    short = mechanism.sweep(certify=certify)
    long = mechanism.changed(inputs=(longer,)).sweep(certify=certify)
    (values,), (others,) = short.inputs.values(), long.inputs.values()
    there = [int(np.abs(others - x).argmin()) for x in values]
    np.testing.assert_allclose(others[there], values, rtol=1e-13, atol=1e-12)
    scales = [max(1.0, float(np.nanmax(np.abs(short[x]), initial=0.0))) for x in short.unknowns]
    fair = short.condition < 1e5
    assert fair.any()
    for k in np.flatnonzero(fair):
        assert long.status[there[k]] == short.status[k]
        assert long.certification[there[k]] == short.certification[k]
    for column, scale in zip(short.unknowns, scales, strict=True):
        near = long[column][there][fair], short[column][fair]
        np.testing.assert_allclose(*near, rtol=0, atol=1e-10 * scale, err_msg=column)
