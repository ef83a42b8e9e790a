"""A mechanism whose positions are named over time, however they follow each other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwork.equations.compiling import Compiled, PointTable
from linkwork.equations.input_motion import time_variable
from linkwork.motion.model import Model

__all__ = ["model_in_time"]


def model_in_time(model: Model) -> Model:
    """The mechanism with the time as the input of its motions, behind its own variables.

    It names rows and their rates; its equations do not say how time drives it.
    """
    own = model.equations
    equations = replace(
        own,
        unknowns=own.variables,
        inputs=(time_variable(),),
        start=np.append(own.start, 0.0),
    )
    index = {variable.symbol: k for k, variable in enumerate(equations.variables)}
    compiled = Compiled(
        equations=equations,
        table=model.compiled.table,
        form=model.compiled.form,
        solver=model.compiled.solver,
        points=PointTable.of(equations, index),
    )
    return Model(
        model.description, equations, compiled, model.skeleton, model.branch, untimed=model
    )
