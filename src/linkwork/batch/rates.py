"""Rates of the unknowns of many designs at their solved positions, with condition and residual."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from linkwork.batch.coefficients import loop_coefficients, zero_coefficients
from linkwork.batch.designs import Designs
from linkwork.batch.rows import DesignRows
from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.errors import InputError, LinkworkError
from linkwork.foundation.lanes import LaneArithmetic, is_batched
from linkwork.foundation.operand import NotElementwise
from linkwork.foundation.status import Status
from linkwork.kernels.march.closure import BlockPart
from linkwork.kernels.march.position_programs import at_places
from linkwork.kernels.march.rate_programs import PlaceProgram, evidence_program, rate_program
from linkwork.mechanism.description import Description
from linkwork.mechanism.varied_number import with_numbers
from linkwork.motion.by_kernels import block_parts, lines_of_lengths
from linkwork.motion.drive import Drive
from linkwork.motion.leading_input import leading_input
from linkwork.motion.speeds import leading_speeds

__all__ = [
    "DesignEvidence",
    "DesignRates",
    "PlaceReading",
    "design_evidence",
    "design_rates",
    "design_speeds",
]

_MOST_BYTES = 8 << 30  # limit for the rates of one family


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignRates:
    """Derivatives of the unknowns with respect to the leading input, (n, R, D) each, internal
    units.

    NaN without a position and at dead points. ``driven`` (2, R, D): whether the inputs have first
    and second derivatives.
    """

    first: Array
    second: Array
    driven: BoolArray

    def take(self, part: slice) -> DesignRates:
        """The rates of some designs."""
        return DesignRates(
            first=self.first[:, :, part],
            second=self.second[:, :, part],
            driven=self.driven[:, :, part],
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignEvidence:
    """``condition``, ``residual`` (R, D), as for a motion; NaN without a position."""

    condition: Array
    residual: Array


def design_rates(designs: Designs, rows: DesignRows, threads: int = 1) -> DesignRates:
    """The rates of all unknowns, computed for all designs together by a compiled program.

    For designs swept alone, the rates of that sweep are used.

    Raises
    ------
    InputError
        If they do not fit into memory.
    """
    n, count, width = rows.v.shape
    if 2 * rows.v.nbytes > _MOST_BYTES:
        raise InputError(
            f"the rates of {width} designs × {count} rows take {2 * rows.v.nbytes / 2**30:.0f} "
            "GiB: use family.parts() or family.reduced({...})"
        )
    both = np.full((2, n, count, width), np.nan)
    if _together(designs, rows):
        reading = PlaceReading.of(designs)
        program = rate_program(designs.base.compiled.table, reading.parts, reading.zeros)
        both = reading.run(program, rows, threads).reshape(both.shape)
        # at dead points J is singular: rates are infinite or noise
        both[~np.isfinite(both)] = np.nan
    driven = np.ones((2, count, width), dtype=bool)
    for k, own in rows.own.items():
        both[0, :, :, k], both[1, :, :, k] = own.first[:, :n].T, own.second[:, :n].T
        driven[:, :, k] = ~np.isnan([own.first[:, -1], own.second[:, -1]])
    return DesignRates(first=both[0], second=both[1], driven=driven)


def design_evidence(designs: Designs, rows: DesignRows, threads: int = 1) -> DesignEvidence:
    """Condition number and residual of every position."""
    condition, residual = np.full((2, *rows.v.shape[1:]), np.nan)
    if _together(designs, rows):
        reading, base = PlaceReading.of(designs), designs.base
        lengths = lines_of_lengths(base)
        program = evidence_program(base.compiled.table, reading.parts, lengths, reading.zeros)
        condition, residual = reading.run(program, rows, threads)
        found = rows.status == Status.CONVERGED.code
        # of existing positions; NaN for the others
        condition[found & ~np.isfinite(condition)] = np.inf
        condition[~found] = residual[~found] = np.nan
    for k, own in rows.own.items():
        condition[:, k], residual[:, k] = own.condition, own.residual
    return DesignEvidence(condition=condition, residual=residual)


def _together(designs: Designs, rows: DesignRows) -> bool:
    """Whether any design was not swept alone."""
    return bool((~rows.alone & (designs.problem == 0)).any())


@dataclass(frozen=True, kw_only=True, eq=False)
class PlaceReading:
    """The arguments of programs run at the positions of a family."""

    designs: Designs
    coefficients: dict[str, Array]
    parts: list[BlockPart]
    zeros: set[str]

    @classmethod
    def of(cls, designs: Designs) -> PlaceReading:
        coefficients = loop_coefficients(designs)
        zeros = zero_coefficients(designs, coefficients)
        coefficients["length"] = designs.length_scale
        for j, rate in enumerate(leading_input(designs.base.rows)[1]):
            coefficients[f"u{j}.rate"] = np.full(len(designs), rate)
        return cls(
            designs=designs,
            coefficients=coefficients,
            parts=block_parts(designs.base),
            zeros=zeros,
        )

    def run(self, program: PlaceProgram, rows: DesignRows, threads: int) -> Array:
        """Run at the inputs of the solved positions, on the straight line of the table."""
        model = self.designs.base
        if rows.inputs is not None:
            v = np.concatenate([rows.v, rows.inputs.swapaxes(0, 1)])
            none = np.zeros((v.shape[1], 0))
            return at_places(program, self.coefficients, v, none, rows.turns, threads)
        lead, rate = leading_input(model.rows)
        inputs = Drive.through(model, model.rows[0], rate, lead).path.at(model.rows[:, lead])
        return at_places(program, self.coefficients, rows.v, inputs, rows.turns, threads)


def design_speeds(designs: Designs) -> Array | None:
    """The rate of every design's leading input, (D,) [rad/s] or [length/s]; ``None`` without a
    speed, NaN for designs with a problem.
    """
    if designs.base.speed is None:
        return None
    found = np.full(len(designs), np.nan)
    fine = np.flatnonzero(designs.problem == 0)
    if designs.base.untimed is not None:
        found[fine] = 1.0  # time leads
        return found
    # all together if the formula of the speed is elementwise
    left = fine[_speeds_together(designs, fine, found)] if len(fine) else fine
    for k in left:
        with suppress(LinkworkError):  # a formula without a value for this design
            found[k] = _speed_of(designs, designs.description(int(k)))
    return found


def _speed_of(designs: Designs, description: Description) -> float:
    base = designs.base
    return next(iter(leading_speeds(description, base.equations.inputs, base.rows).values()))


def _speeds_together(designs: Designs, fine: IndexArray, found: Array) -> BoolArray:
    """Fill in the speeds of valid designs; returns those to compute one by one."""
    consensus = LaneArithmetic(len(fine))
    columns = zip(designs.quantities, designs.dimensions.values(), strict=True)
    numbers = {quantity: consensus.lanes(values[fine]) for quantity, values in columns}
    try:
        speed = _speed_of(designs, with_numbers(designs.base.description, numbers))
    except (NotElementwise, LinkworkError):
        return np.ones(len(fine), dtype=bool)
    found[fine] = speed.values if is_batched(speed) else speed
    return ~consensus.agreeing
