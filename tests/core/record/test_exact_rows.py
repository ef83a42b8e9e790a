"""Residuals that are rounded once, against ball arithmetic."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from flint import acb, arb, ctx

from linkwork.core.table.rows import exact_line, exact_rows
from tests.core.record.random_tables import random_example


def test_rows_are_rounded_once() -> None:
    rng = np.random.default_rng(5)
    before, ctx.prec = ctx.prec, 300
    try:
        for number in range(40):
            table = random_example(number).table
            rows = table.loops
            v = rng.uniform(-1.0, 1.0, table.variables) * 10.0 ** rng.uniform(-6, 6)
            sums = [acb(0)] * rows.rows
            for t in range(len(rows.row)):
                mine = np.flatnonzero(rows.phase_term == t)
                angle = arb(0)
                for p in mine:
                    angle += arb(float(rows.phase_weight[p])) * arb(v[rows.phase_variable[p]])
                factor = acb(*map(float, (rows.coefficient[t].real, rows.coefficient[t].imag)))
                length = arb(v[rows.length[t]]) if rows.length[t] >= 0 else arb(1)
                sums[rows.row[t]] += factor * length * acb(angle.cos(), angle.sin())
            found = exact_rows(rows, v)
            for value, exact in zip(found, sums, strict=True):
                assert value.real == float(exact.real.mid())
                assert value.imag == float(exact.imag.mid())
    finally:
        ctx.prec = before


@pytest.mark.parametrize("exponent", [-300, -200, 200, 300])
def test_rows_of_any_length_are_rounded_once(exponent: int) -> None:
    """All lengths times a power of two: so is the residual, in every bit."""
    rng = np.random.default_rng(6)
    for number in range(40):
        rows = random_example(number).table.loops
        v = rng.uniform(-1.0, 1.0, rows.variables)
        scale = 2.0**exponent
        larger = replace(rows, coefficient=rows.coefficient * np.where(rows.length < 0, scale, 1.0))
        w = v.copy()
        w[rows.length[rows.length >= 0]] *= scale
        if set(rows.length) & set(rows.phase_variable):
            continue  # a variable that is a length and an angle
        found = exact_rows(larger, w)
        assert np.abs(found).max() > 0.0
        assert (found == exact_rows(rows, v) * scale).all()


def test_lines_are_rounded_once() -> None:
    assert exact_line(1e16, [1.0, -1.0], [1.0, 1e16]) == 1.0
    assert exact_line(0.1, [0.1], [3.0]) == 0.1 * 4.0
