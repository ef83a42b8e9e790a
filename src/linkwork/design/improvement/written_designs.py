"""The equations of many designs of one mechanism: coefficients, and their derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.batch.building import write_equations
from linkwork.design.derivatives.differentiated_rows import taped_speed
from linkwork.design.derivatives.recorded_tape import RecordedTape
from linkwork.design.derivatives.tape import TapedNumber
from linkwork.equations.compiling import phasor_rows
from linkwork.foundation.arrays import AnyArray, Array, BoolArray
from linkwork.mechanism.varied_number import VariedNumber, with_numbers
from linkwork.motion.model import Model

__all__ = ["DesignWriter", "WrittenDesigns"]


class DesignWriter:
    """The equations of a mechanism on a record, which designs with other numbers follow.

    Parameters
    ----------
    model : Model
    numbers : sequence of VariedNumber
        Those that designs have of their own, P.

    Raises
    ------
    NotElementwise
        If the form of the equations depends on a number.
    """

    def __init__(self, model: Model, numbers: Sequence[VariedNumber]) -> None:
        self.model, self._record = model, RecordedTape()
        taped = {q: self._record.number(float(q.of(model.description))) for q in numbers}
        with np.errstate(all="ignore"):
            description = with_numbers(model.description, taped)
            self.equations = write_equations(description)
            self.speed = taped_speed(model, description, self.equations)
        rows = [loop.terms for loop in self.equations.loops]
        self.loops = phasor_rows(
            rows, {x.symbol: k for k, x in enumerate(self.equations.variables)}
        )
        #: Of the terms of loops; plain numbers, too.
        self.coefficients: list[Any] = [term.value for row in rows for term in row]
        found = [self.speed, *self.coefficients]
        self.equations.mapped(found.append)
        self._numbers = {x.node: x for x in found if isinstance(x, TapedNumber)}
        self._record.keep(list(self._numbers.values()))

    def written(self, x: Array) -> WrittenDesigns:
        """The equations of designs (D, P), file units."""
        fine, found = self._record.follow(x.T)
        return WrittenDesigns(
            writer=self, x=x, fine=fine, known=dict(zip(self._numbers, found, strict=True))
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class WrittenDesigns:
    """The equations of D designs with P numbers of their own.

    Parameters
    ----------
    writer : DesignWriter
    x : (D, P)
        File units.
    fine : (D,) bool
        Designs whose equations have the form of the mechanism's own.
    known : dict
        The writer's numbers by node: values (D,), and derivatives by x, (P, D).
    """

    writer: DesignWriter
    x: Array
    fine: BoolArray
    known: dict[int, tuple[AnyArray, AnyArray]]
