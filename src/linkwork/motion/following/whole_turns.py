"""Distant input values of a freely turning mechanism, reduced by whole periods."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from linkwork.equations.parametrized_table import ParametrizedTable
from linkwork.foundation.arrays import Array
from linkwork.motion.model import Model
from linkwork.numerics.continuation.branch_tracking import BOLD, InputPath
from linkwork.numerics.continuation.curve_proof import prove_curve
from linkwork.numerics.continuation.curve_tracing import CurveOptions, trace
from linkwork.numerics.continuation.local_parametrization import whole_turns

__all__ = ["Laps", "laps_to"]

_TURN = 2.0 * np.pi
_FAR = 3.0  # turns up to which the motion is simply followed
_OPTIONS = CurveOptions(most_turns=60, most_legs=200, track=replace(BOLD, most_steps=10_000))


@dataclass(frozen=True, kw_only=True, eq=False)
class Laps:
    """``inputs`` (p,), in file units: values so many laps nearer to the start; ``gain`` (N,): the
    change of the variables over all laps left out; ``proved``: that a lap leads back to its start.
    """

    inputs: Array
    gain: Array
    proved: bool


def laps_to(model: Model, v: Array, target: Array) -> Laps | None:
    """The laps between a position and a far value of a single input angle.

    Parameters
    ----------
    v : (N,)
        The position at the start.
    target : (1,)
        The value asked, in file units.

    Returns
    -------
    Laps or None
        ``None`` if the value is near, or if the motion does not come back to its start while the
        input turns on (one lap may take several turns).
    """
    inputs = model.equations.inputs
    if len(inputs) != 1 or inputs[0].kind != "angle":
        return None
    n, unit = model.compiled.solver.unknowns, model.units.angle.turn
    begin = float(model.start_in_file_units[0])
    span = float(target[0]) - begin
    if not abs(span) > _FAR * unit:
        return None
    leads = ParametrizedTable(
        model.compiled.table, InputPath(origin=np.zeros(1), rate=np.ones(1)), 0
    )
    curve = trace(leads, v, math.copysign(1.0, span), _OPTIONS)
    if not curve.end.closed or any(_turns_back(leg.v[:, n]) for leg in curve.legs):
        return None
    gain = curve.legs[-1].v[-1] - v
    turns = round(float(gain[n]) / _TURN)
    whole = whole_turns(leads, v, curve.legs[-1].v[-1])
    # a lap that adds nothing to the input, or other fractions of turns, cannot be left out
    if turns == 0 or not leads.repeats_after(whole):
        return None
    # exactly whole turns, without the rounding of the traced curve
    gain = _TURN * whole
    laps = math.floor(abs(span) / (abs(turns) * unit))
    if laps * abs(turns) * unit == abs(span):
        laps -= 1  # the last one is followed
    nearer = float(target[0]) - math.copysign(laps * abs(turns) * unit, span)
    proof = prove_curve(leads, curve)
    return Laps(inputs=np.array([nearer]), gain=laps * gain, proved=proof.whole and proof.closed)


def _turns_back(values: Array) -> bool:
    steps = np.diff(values)
    return bool((steps > 0).any() and (steps < 0).any())
