"""Derivatives of any order of a mechanism's own quantities, from Taylor series."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import factorial

import numpy as np

from linkwork.core.equations.compiling import Compiled, PointTable
from linkwork.core.equations.input_motion import time_variable
from linkwork.core.expression.derivatives import Jet, derivative, evaluate
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import Node
from linkwork.core.foundation.arrays import AnyArray, Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.values import check_class
from linkwork.core.motion.model import Model, leading_input
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Asked, Group, Solved
from linkwork.core.table.taylor import law_series, phasor_series, variable_series


def derivatives_of(model: Model, solved: Solved, asked: Asked, order: int) -> Array:
    """What :meth:`Model.derivatives` describes."""
    if model.untimed is not None and not model.description.timed:
        raise InputError(f'"{asked.own.name}": a simulated motion has two derivatives')
    return _SeriesOf(model).derivatives(solved, asked, order)


@dataclass(frozen=True, eq=False)
class _SeriesOf:
    """The derivatives of a mechanism's quantities with respect to its leading input."""

    model: Model

    def derivatives(self, solved: Solved, asked: Asked, order: int) -> Array:
        """From the first to the one asked for, (order, B)."""
        equations = self.model.equations
        columns = []
        for variable in equations.variables:
            value = np.asarray(solved.own(variable.name).v)
            scale = self.model.units.scale(self.model.motion_quantities.own[variable.name].own.kind)
            columns.append(np.atleast_1d(value) * scale)
        v = np.stack(columns, axis=-1)
        if v.ndim != 2:
            raise InputError(f'"{asked.own.name}": families have two derivatives')
        found = np.isfinite(v).all(axis=1)
        series = np.full((order + 1, *v.shape), np.nan)
        with np.errstate(all="ignore"):
            series[:, found] = self._series(v[found], order)
        own = self._quantity(asked, series)[1:]
        return np.stack([part * factorial(k) for k, part in enumerate(own, start=1)])

    def _series(self, v: Array, order: int) -> Array:
        """The coefficients of all variables at positions (B, N), (K + 1, B, N)."""
        untimed = self.model.untimed
        if untimed is None:
            inputs = np.zeros((order + 1, len(self.model.equations.inputs)))
            inputs[1] = leading_input(self.model.rows)[1]
            return variable_series(self.model.compiled.table, v, inputs)
        t = v[:, -1]
        driven = np.zeros((order + 1, len(t), len(untimed.equations.inputs)))
        for k in range(len(untimed.equations.inputs)):
            driven[1:, :, k] = self._law_series(k, t, order)
        series = np.zeros((order + 1, *v.shape))
        series[:, :, :-1] = variable_series(untimed.compiled.table, v[:, :-1], driven)
        series[0, :, -1], series[1, :, -1] = t, 1.0
        return series

    def _law_series(self, k: int, t: Array, order: int) -> Array:
        """The coefficients of an input over time from the first one on, (K, B)."""
        description, untimed = self.model.description, self.model.untimed
        assert untimed is not None
        formula, count = description.inputs[k].law, len(description.inputs)
        if not isinstance(formula, str):
            return law_series(self.model.equations.laws[k - count].law, t, order)
        # between its knots a formula is interpolated, but only with two derivatives
        known = {name: Jet.constant(value) for name, value in description.numbers.known.items()}
        known["t"] = Jet(t, np.zeros_like(t), np.zeros_like(t))
        tree, found = parse(formula, comparing=True), []
        for m in range(1, order + 1):
            tree = _derivative(tree, description.angle.radians)
            value = evaluate(tree, known, description.angle).v * untimed.input_scale[k]
            found.append(np.broadcast_to(value, t.shape) / factorial(m))
        return np.array(found)

    def _quantity(self, asked: Asked, series: Array) -> Array:
        """The coefficients of one quantity, (K + 1, B)."""
        equations, name = self.model.equations, asked.own.name
        numbers = {variable.name: k for k, variable in enumerate(equations.variables)}
        symbols = {variable.symbol: k for k, variable in enumerate(equations.variables)}
        if asked.group is Group.COORDINATE:
            point, _, axis = name.rpartition(".")
            place = self._places(series, point)
            return np.asarray(place.real if axis == "x" else place.imag)
        if name in numbers:
            return np.asarray(series[:, :, numbers[name]])
        if asked.group is Group.LINK:
            variable = equations.links[name].variable
            if variable is None:
                return np.zeros(series.shape[:2])
            return np.asarray(series[:, :, symbols[canonical(variable)]])
        if asked.group is Group.SLIDER:
            return np.asarray(series[:, :, symbols[canonical(equations.sliders[name])]])
        raise InputError(
            f'"{name}" has two derivatives: jerk and beyond are known of links, sliders, unknowns '
            "and coordinates"
        )

    def _places(self, series: Array, point: str) -> AnyArray:
        """The coefficients of a point x + iy, (K + 1, B)."""
        table = self.model.compiled.points
        places = phasor_series(table.rows, series)
        for child, parent in table.levels:
            places[:, :, child] += places[:, :, parent]
        found: AnyArray = places[:, :, table.names.index(point)]
        return found


def _derivative(tree: Node, radians: float) -> Node:
    try:
        return derivative(tree, "t", radians)
    except ValueError:
        raise InputError(
            "a law with min or max has two derivatives: write it with comparisons, as in (t < 1)*…"
        ) from None


# ----------------------------------------------------------------------
# A mechanism whose positions are named over time, however they follow each other.


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


# ----------------------------------------------------------------------
# Whether a motion that a caller gives is one of the mechanism.


def check_own_motion(model: Model, motion: Motion) -> None:
    """Check that a motion belongs to the mechanism, by its name and inputs.

    Raises
    ------
    InputError
        With the mechanism that it belongs to.
    """
    check_class("the motion", motion, Motion)
    names = [v.name for v in model.equations.inputs]
    if motion.mechanism != model.description.name or list(motion.inputs) != names:
        raise InputError(
            f'the motion belongs to "{motion.mechanism}", not to "{model.description.name}": '
            "give a sweep of this mechanism"
        )
