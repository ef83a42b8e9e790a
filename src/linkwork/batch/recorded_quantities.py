"""Quantities of a position as a program of its variables: what :mod:`design_values` computes with
arrays, recorded.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from linkwork.batch.recorded_number import Part, RecordedNumber, Recording
from linkwork.expression.jets import Jet
from linkwork.foundation.arrays import AnyArray, Array
from linkwork.foundation.operand import NotElementwise
from linkwork.kernels.program.recorder import Recorder, Value
from linkwork.motion.model import Model
from linkwork.motion.quantity_values import LastAxis, QuantityValues, term_jet

__all__ = ["HasParts", "RecordedQuantities"]

_UNKNOWN = np.array([np.nan])


class _RowNumber(RecordedNumber):
    """A recorded number where NumPy's functions expect an array of no axes."""

    __slots__ = ()
    conj = RecordedNumber.conjugate

    def __array_function__(
        self, function: Callable[..., Any], types: object, given: Sequence[Any], named: object
    ) -> Any:
        if function is np.shape:
            return ()
        if function in (np.broadcast_to, np.atleast_1d):
            return self
        return self.arithmetic.apply(function, *given)


class _RowRecording(Recording):
    """Computes with rows: what holds in one of them decides nothing."""

    def make(self, values: Any, re: Part, im: Part = 0.0) -> RecordedNumber:
        """A number; its value is unknown if it differs from row to row."""
        x, y = self.plainly(re), self.plainly(im)
        known = _UNKNOWN
        if not isinstance(x, Value) and not isinstance(y, Value):
            known = np.array([complex(x, y) if y else x])
        return _RowNumber(known, self, x, y)

    def of_numpy(self, function: Any, inputs: Sequence[Any]) -> Any:
        """Any function that can be recorded, of arrays of no axes too."""
        return self.apply(function, *inputs)

    def operand(self, number: object) -> RecordedNumber:
        """The second operand, which may be an array of one number."""
        plain = number.item() if isinstance(number, np.ndarray) and number.size == 1 else number
        found: RecordedNumber = super().operand(plain)
        return found

    def divide(self, x: RecordedNumber, y: RecordedNumber) -> RecordedNumber:
        """x / y; of 0 too it is no number where y is none."""
        found, rec = super().divide(x, y), self.recorder
        if y.im != 0.0 or not isinstance(y.re, Value):
            return found
        zero = rec.where(rec.at_most(y.re, y.re), 0.0, math.nan)
        parts = ((x.re, found.re), (x.im, found.im))
        return self.make(None, *(quotient if own else zero for own, quotient in parts))

    def decide(self, truths: Any) -> bool:
        """Refused: rows differ."""
        raise NotElementwise

    def apply(self, function: Callable[..., Any], *numbers: object) -> RecordedNumber:
        """A function or an operator of NumPy."""
        if function is np.where and isinstance(numbers[0], np.ndarray):
            chosen: RecordedNumber = self.operand(numbers[1 if numbers[0].item() else 2])
            return chosen
        method = _OPERATORS.get(function)
        if method is None:
            return super().apply(function, *numbers)
        found: RecordedNumber = method(self, *map(self.operand, numbers))
        return found


_OPERATORS: Mapping[Any, Callable[..., Any]] = {
    np.add: Recording.add, np.subtract: Recording.subtract, np.multiply: Recording.multiply,
    np.true_divide: Recording.divide, np.power: Recording.power, np.negative: Recording.negate,
}  # fmt: skip


class HasParts(Protocol):
    """A structure, its path of inputs, and its coefficients: numbers, or values that vary."""

    @property
    def base(self) -> Model:
        """The structure."""

    @property
    def parts(self) -> Mapping[str, Part]:
        """Coefficients by register."""

    @property
    def rates(self) -> Array:
        """The rate of every input by the leading one."""


class RecordedQuantities(QuantityValues):
    """Records quantities of a mechanism's position from ``v<k>``, ``first<k>`` and ``second<k>``.

    Parameters
    ----------
    design : HasParts
        A recorded design, or a family.
    recorder : Recorder, optional
        Records into a program that has begun.
    """

    def __init__(self, design: HasParts, recorder: Recorder | None = None) -> None:
        self.design, self.recording = design, _RowRecording()
        if recorder is not None:
            self.recording.recorder = recorder
        self.recorder: Recorder = self.recording.recorder
        base, zero = design.base, np.zeros(())
        links = [self._part(f"link{k}") for k in range(len(base.equations.links))]
        named = [self._part(f"dimension{k}") for k in range(len(base.equations.dimensions))]
        columns: list[Any] = [LastAxis(links), LastAxis(named)]
        super().__init__(base, np.zeros((), dtype=bool), zero, *columns)
        self.number = {x.symbol: k for k, x in enumerate(self.equations.variables)}
        self.places: dict[str, Jet] = {}

    def write(self, name: str, number: AnyArray | RecordedNumber) -> None:
        """Leave a real number in a named register."""
        part = self.recording.operand(number).re
        self.recorder.write(name, part)

    def column(self, name: str) -> Jet | None:
        """A quantity by name; ``None`` if it cannot be recorded."""
        try:
            with np.errstate(all="ignore"):
                jet = self.model.quantities.find(name).jet(self)
                for part in (jet.v, jet.d1):
                    self.recording.operand(part)
        except TypeError:
            return None
        return jet

    def _part(self, *names: str) -> Any:
        """A coefficient: a number, or what is computed from those that vary."""
        parts = [
            self.recorder.input(name) if isinstance(self.design.parts[name], Value)
            else self.design.parts[name]
            for name in names
        ]  # fmt: skip
        return self.recording.make(None, *parts)

    def variable(self, symbol: str) -> Jet:
        """A variable by its symbol, internal units."""
        k, n = self.number[symbol], len(self.equations.unknowns)
        rec, make = self.recorder, self.recording.make
        value: Any = make(None, rec.input(f"v{k}"))
        if k >= n:
            return Jet(value, np.asarray(float(self.design.rates[k - n])), np.zeros(()))
        first: Any = make(None, rec.input(f"first{k}"))
        second: Any = make(None, rec.input(f"second{k}"))
        return Jet(value, first, second)

    def place(self, point: str) -> Jet:
        """A point by its exact name: its parent's position plus its own terms."""
        if point not in self.places:
            table = self.model.compiled.points
            parent = self.equations.points[point].parent
            place = Jet.constant(0.0) if parent is None else self.place(parent)
            for term in np.flatnonzero(table.rows.row == table.names.index(point)).tolist():
                place = place + self._term(term)
            self.places[point] = place
        return self.places[point]

    def _term(self, term: int) -> Jet:
        """c s e^{iψ} with both derivatives."""
        rows = self.model.compiled.points.rows
        symbols = [x.symbol for x in self.equations.variables]
        c, turn = self._part(f"point{term}.re", f"point{term}.im"), Jet.constant(0.0)
        mine = rows.phase_term == term
        for k, weight in zip(rows.phase_variable[mine], rows.phase_weight[mine], strict=True):
            turn = turn + self.variable(symbols[k]) * float(weight)
        length = int(rows.length[term])
        s = Jet.constant(1.0) if length < 0 else self.variable(symbols[length])
        return term_jet(c, s, turn if mine.any() else None)
