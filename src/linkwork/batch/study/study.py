"""A study: mechanism, designs, kept quantities and storage."""

from __future__ import annotations

from collections.abc import Mapping, Set as AbstractSet
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.batch.sampling import Plan
from linkwork.batch.study.choosing import values_between
from linkwork.batch.study.job import Job, passes_name
from linkwork.foundation.arrays import Array
from linkwork.foundation.status import Status
from linkwork.mechanism.varied_number import number_named
from linkwork.motion import Model

__all__ = ["DESIGN", "Study", "Variable", "usual_chunk"]

#: The axis of designs.
DESIGN = "design"

_LARGEST_CHUNK = 16_384
_SMALLEST_CHUNK = 2048
_CHUNK_BYTES = 64 << 20  # target size of the arrays of one chunk
_CHUNKS_WANTED = 16  # chunks of a small study, for several workers


@dataclass(frozen=True, kw_only=True)
class Variable:
    """An array of the store: over designs, over designs and inputs, or over inputs alone.

    ``fill`` marks values not computed; ``values`` are known in advance.
    """

    name: str
    axes: tuple[str, ...]
    dtype: str
    fill: Any
    attributes: Mapping[str, Any]
    values: Array | None = None


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Study:
    """A study as planned; made by :func:`~linkwork.batch.study.read_plan`.

    Parameters
    ----------
    name : str
    text : str
        The text of the plan.
    mechanism_text : str
        The text of the mechanism's file.
    model : Model
        The mechanism with the study's range of its input.
    plan : Plan
        The plan of the varied numbers.
    constants : Mapping[str, float]
        Changed numbers that are the same for all designs.
    job : Job
        The computation for every design.
    units : Mapping[str, str]
        Units of stored quantities and numbers of motions, by array name.
    chunk_size : int
        Number of designs computed and stored together.
    identity : Mapping[str, object]
        All data on which results depend, with the keys of the plan, in JSON types.
    """

    name: str
    text: str
    mechanism_text: str
    model: Model
    plan: Plan
    constants: Mapping[str, float]
    job: Job
    units: Mapping[str, str]
    chunk_size: int
    identity: Mapping[str, Any]

    def __repr__(self) -> str:
        return (
            f'<Study "{self.name}" of "{self.job.description.name}": {self.plan.count} designs × '
            f"{len(self.model.rows_in_file_units)} inputs in {self.chunks} chunks>"
        )

    @property
    def chunks(self) -> int:
        """The number of chunks; the last one may be smaller."""
        # rounded up
        return -(-self.plan.count // self.chunk_size)

    def designs_of(self, k: int) -> range:
        """The designs of a chunk."""
        start = k * self.chunk_size
        return range(start, min(start + self.chunk_size, self.plan.count))

    def count_in(self, chunks: AbstractSet[int]) -> int:
        """The number of designs in some chunks."""
        count = len(chunks) * self.chunk_size
        if self.chunks - 1 in chunks:  # the last one may be smaller
            count -= self.chunks * self.chunk_size - self.plan.count
        return count

    def varied(self, k: int) -> dict[str, Array]:
        """The varied numbers of a chunk, in file units, (designs,) each."""
        designs = self.designs_of(k)
        return values_between(self.plan, designs.start, designs.stop)

    def values(self, k: int) -> Mapping[str, Array | float]:
        """All changed numbers of a chunk: the varied ones and the constants."""
        return {**self.varied(k), **self.constants}

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs; the first one is the axis of rows."""
        return tuple(variable.name for variable in self.model.equations.inputs)

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """Every array of the store."""
        of_input = [
            self._variable(
                name, (self.inputs[0],), "float64", np.nan, self.model.input_units[name], values
            )
            for name, values in zip(self.inputs, self.model.rows_in_file_units.T, strict=True)
        ]
        varied = [
            self._variable(name, (DESIGN,), "float64", np.nan, self._unit_of_number(name))
            for name in self.plan
        ]
        return (*of_input, *varied, *self._of_design(), *self._of_rows())

    def _of_design(self) -> list[Variable]:
        """One number for each design."""
        one = (DESIGN,)
        found = [
            self._variable("built", one, "bool", False, about="whether the design can be built"),
            self._variable("found", one, "int32", -1, about="rows with a position"),
            self._variable("certified", one, "int32", -1, about="rows that are proved"),
            self._variable("passed", one, "bool", False, about="built, and passed every filter"),
        ]
        found += [
            self._variable(passes_name(name), one, "bool", False, about=str(condition))
            for name, condition in self.job.filters.items()
        ]
        return found + [
            self._variable(name, one, "float64", np.nan, self.units[name], about=str(reduced))
            for name, reduced in self.job.reductions.items()
        ]

    def _of_rows(self) -> list[Variable]:
        """One number for each design and input."""
        if not self.job.keep:
            return []
        axes = (DESIGN, self.inputs[0])
        note = "missing where there is no position or the design did not pass"
        found = [
            self._variable(name, axes, "float64", np.nan, self.units[name], about=note)
            for name in self.job.keep
        ]
        flags = {
            "flag_values": [status.code for status in Status],
            "flag_meanings": " ".join(status.name for status in Status),
        }
        return [
            *found,
            Variable(name="status", axes=axes, dtype="int8", fill=-1, attributes=flags),
        ]

    def _variable(
        self,
        name: str,
        axes: tuple[str, ...],
        dtype: str,
        fill: Any,
        unit: str = "",
        values: Array | None = None,
        about: str = "",
    ) -> Variable:
        attributes = ({"units": unit} if unit else {}) | ({"description": about} if about else {})
        return Variable(
            name=name, axes=axes, dtype=dtype, fill=fill, attributes=attributes, values=values
        )

    def _unit_of_number(self, name: str) -> str:
        table = number_named(self.job.description, name).table
        if table in ("lengths", "points", "sliders"):
            return self.job.description.length
        return self.job.description.angle.value if table == "angles" else ""


def usual_chunk(count: int, rows: int, columns: int) -> int:
    """The default number of designs computed together.

    Parameters
    ----------
    count : int
        Number of designs of the study.
    rows, columns : int
        Size of the arrays of one design: numbers of rows and of quantities.
    """
    # 8 bytes for each float64
    fitting = max(_CHUNK_BYTES // (8 * rows * columns), 1)
    shared = max(-(-count // _CHUNKS_WANTED), _SMALLEST_CHUNK)
    # a power of two: chunks fill the lanes of the kernels exactly
    return 1 << (min(fitting, shared, _LARGEST_CHUNK).bit_length() - 1)
