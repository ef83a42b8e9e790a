"""Rates, condition and residual over lanes against the scalar solver of blocks."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import linkwork as lw
from linkwork.core.motion.model import Model, leading_input
from linkwork.core.record.closure import BlockPart
from linkwork.core.table.loop_table import LoopTable
from linkwork.families.march.march_programs import PlaceProgram, PlaceWriter
from linkwork.families.march.sweep_kernel import at_places

Array = npt.NDArray[np.float64]
ROWS = 5
DESIGNS = 70  # more than one set of lanes, the last one not full
#: A dyad, coupled loops, lines, lengths that vary, two inputs in lock-step.
MECHANISMS = [
    "four-bar",
    "klann-leg",
    "double-butterfly",
    "geared-five-bar",
    "rack-steering",
    "crank-shaper",
    "five-bar-robot",
]


def places(model: Model, seed: int) -> tuple[Array, Array]:
    """Unknowns (n, ROWS, DESIGNS) of no position in particular, and inputs (ROWS, p)."""
    rng = np.random.default_rng(seed)
    weights = model.compiled.table.variable_scale
    n = model.compiled.solver.unknowns
    start = model.equations.start
    v = start[:n, None, None] + 0.3 * weights[:n, None, None] * rng.normal(size=(n, ROWS, DESIGNS))
    return v, start[n:] + 0.3 * weights[n:] * rng.normal(size=(ROWS, len(start) - n))


def coefficients(model: Model) -> dict[str, Array]:
    table, given = model.compiled.table, {}
    for term, c in enumerate(table.loops.coefficient.tolist()):
        given[f"c{term}.re"], given[f"c{term}.im"] = np.full((2, DESIGNS), [[c.real], [c.imag]])
    for row, constant in enumerate(table.linear.constant.tolist()):
        given[f"k{row}"] = np.full(DESIGNS, constant)
    for k in np.flatnonzero(~table.is_angle):
        given[f"scale{k}"] = np.full(DESIGNS, table.variable_scale[k])
    for j, rate in enumerate(leading_input(model.rows)[1]):
        given[f"u{j}.rate"] = np.full(DESIGNS, rate)
    return given | {"length": np.full(DESIGNS, model.equations.length_scale)}


def parts_of(model: Model) -> list[BlockPart]:
    return [
        BlockPart(equations=block.equations, unknowns=tuple(block.unknowns.tolist()))
        for block in model.compiled.solver.blocks
    ]


def rate_program(table: LoopTable, parts: list[BlockPart]) -> PlaceProgram:
    writer = PlaceWriter(table, parts)
    return writer.finish(writer.rates())


@pytest.mark.parametrize("name", MECHANISMS)
@pytest.mark.parametrize("threads", [1, 2])
def test_rates_and_evidence_are_those_of_the_solver(name: str, threads: int) -> None:
    model = lw.example(name).model
    solver, table, n = model.compiled.solver, model.compiled.table, model.compiled.solver.unknowns
    v, inputs = places(model, 3)
    turns = np.zeros((ROWS, DESIGNS), dtype=np.int32)
    lengths = {k for k, line in enumerate(model.equations.linear) if line.kind == "length"}
    writer = PlaceWriter(table, parts_of(model))
    rates, evidence = (
        at_places(program, coefficients(model), v, inputs, turns, threads)
        for program in (
            rate_program(table, parts_of(model)),
            writer.finish([*writer.condition(lengths), *writer.residual(lengths)]),
        )
    )
    whole = np.concatenate(
        [v, np.broadcast_to(inputs.T[:, :, None], (inputs.shape[1], ROWS, DESIGNS))]
    )
    flat = whole.reshape(len(whole), -1).T
    scalar = solver.rates(flat, leading_input(model.rows)[1])
    weights = solver.variable_scale[:n]
    for order, own, other in ((1, rates[:n], scalar.first), (2, rates[n:], scalar.second)):
        size = np.maximum(np.abs(other[:, :n] / weights).max(axis=1), 1.0)[:, None]
        off = np.abs(own.reshape(n, -1).T - other[:, :n]) / weights / size
        assert (off.max(axis=1) <= 1e-13 * scalar.condition**order).all()
    np.testing.assert_allclose(
        evidence[0].ravel() / scalar.condition - 1.0, 0.0, atol=1e-13 * scalar.condition.max()
    )
    np.testing.assert_allclose(evidence[1].ravel(), solver.residual(flat), rtol=1e-10, atol=1e-14)


def test_derivatives_are_those_of_the_motion_itself() -> None:
    # an oracle beside the solver: central differences of positions along the input
    mechanism = lw.example("four-bar")
    step = 1e-3  # deg
    at = [60.0, 60.0 - step, 60.0 + step]
    here, below, above = (mechanism.solve(at=x).q for x in at)
    model = mechanism.model
    v = np.repeat(here[:, None, None], DESIGNS, axis=2)
    rates = at_places(
        rate_program(model.compiled.table, parts_of(model)),
        coefficients(model),
        v,
        np.radians([[at[0]]]),
        np.zeros((1, DESIGNS), dtype=np.int32),
    )
    h = np.radians(step)
    np.testing.assert_allclose(rates[:2, 0, -1], (above - below) / (2 * h), rtol=1e-7)
    np.testing.assert_allclose(rates[2:, 0, -1], (above - 2 * here + below) / h**2, rtol=1e-4)


def test_whole_turns_of_the_input_count_where_they_are_told() -> None:
    # a phase that an input turns by half: one turn further it points the other way
    half = lw.loops(
        loops={"1": "x + i*y = r*e^(i*0.5*t)"},
        dimensions={"r": 2.0},
        guess={"t": 0, "x": 2.0, "y": 0.0},
        inputs=lw.Input(variable="t", from_=0, to=90, step=30),
    ).model
    turns = np.zeros((1, DESIGNS), dtype=np.int32)
    turns[0, 1::2] = 1
    v = np.zeros((2, 1, DESIGNS))
    program = rate_program(half.compiled.table, parts_of(half))
    x, y, _, _ = at_places(program, coefficients(half), v, np.array([[0.4]]), turns)[:, 0]
    np.testing.assert_allclose(x[::2], -np.sin(0.2), rtol=1e-14)
    np.testing.assert_allclose(x[1::2], np.sin(0.2), rtol=1e-13)
    np.testing.assert_allclose(y[::2], np.cos(0.2), rtol=1e-14)


def test_no_position_has_no_rates_and_a_singular_one_has_none_that_is_finite() -> None:
    model = lw.example("four-bar").model
    v, inputs = places(model, 1)
    v[:, 0, 3] = np.nan
    v[:, 1, 4] = v[0, 1, 4]  # coupler and rocker in line: angles are equal
    given = coefficients(model)
    rates = at_places(
        rate_program(model.compiled.table, parts_of(model)),
        given,
        v,
        inputs,
        np.zeros((ROWS, DESIGNS), dtype=np.int32),
    )
    assert np.isnan(rates[:, 0, 3]).all()
    bad = np.asarray(~np.isfinite(rates).all(axis=0))
    assert bad[0, 3]
    assert np.abs(rates[:2, 1, 4]).max() > 1e12 or bad[1, 4]
    assert np.count_nonzero(bad) <= 2
