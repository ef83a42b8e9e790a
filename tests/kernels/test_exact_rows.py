"""Residuals that are rounded once, against ball arithmetic."""

from __future__ import annotations

import numpy as np
from flint import acb, arb, ctx

from linkwork.kernels.exact_rows import exact_line, exact_rows
from tests.kernels.random_tables import random_example


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


def test_lines_are_rounded_once() -> None:
    assert exact_line(1e16, [1.0, -1.0], [1.0, 1e16]) == 1.0
    assert exact_line(0.1, [0.1], [3.0]) == 0.1 * 4.0
