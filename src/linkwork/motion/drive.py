"""The inputs of a mechanism, which move in lock-step along the leading one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from linkwork.equations.parametrized_table import ParametrizedTable
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError
from linkwork.motion.leading_input import leading_input
from linkwork.motion.model import Model
from linkwork.motion.tracking import leading_scale, turns_freely
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.continuation.branch_tracking import InputPath

__all__ = ["Drive"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Drive:
    """``lead``: the number of the input whose value is the path's parameter t."""

    model: Model
    path: InputPath
    lead: int

    @classmethod
    def through(cls, model: Model, inputs: Array, rate: Array, lead: int) -> Drive:
        """The straight line through input values (p,); ``rate`` (p,) is 1 for the leading input."""
        path = InputPath(
            origin=inputs - rate * inputs[lead], rate=rate, size=leading_scale(model, lead)
        )
        return cls(model=model, path=path, lead=lead)

    @classmethod
    def along_table(cls, model: Model) -> Drive:
        """From the guess in the direction of the table's inputs."""
        lead, rate = leading_input(model.rows)
        return cls.through(model, model.start_inputs, rate, lead)

    @classmethod
    def of_circuits(cls, model: Model) -> Drive:
        """That of the mechanism's own input, whatever law of time drives it.

        Raises
        ------
        InputError
            If the mechanism has no input, or several that time drives.
        """
        if model.untimed is not None and len(model.untimed.equations.inputs) > 1:
            raise InputError("several inputs with laws have no common circuit: leave out the laws")
        return cls.along_table(model.untimed or model)

    @property
    def solver(self) -> BlockSolver:
        """Of the mechanism's equations."""
        return self.model.compiled.solver

    @cached_property
    def leads(self) -> ParametrizedTable:
        """The equations along the path, solvable with any variable in the lead."""
        compiled = self.model.compiled
        return ParametrizedTable(compiled.table, self.path, self.lead, compiled.leaders)

    @cached_property
    def free(self) -> bool:
        """Whether adding a whole turn to the input changes nothing."""
        return turns_freely(self.model)

    @property
    def unit(self) -> float:
        """Internal units per file unit of t."""
        return float(self.model.input_scale[self.lead])
