"""Curves along which the input turns fully, followed and proved by the compiled march of sweeps."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.foundation.rounding import EPSILON
from linkwork.motion import by_kernels
from linkwork.motion.curve_branches import TracedCurve
from linkwork.motion.drive import Drive
from linkwork.numerics.continuation.branch_tracking import Node, node_at
from linkwork.numerics.continuation.curve_proof import ProvenCurve
from linkwork.numerics.continuation.curve_tracing import Curve, Leg
from linkwork.numerics.continuation.local_parametrization import Parametrization, whole_turns
from linkwork.numerics.rows import SolvedRows

__all__ = ["full_turn"]

_STEPS = 24  # of a turn, besides those that the march takes in between
_AS_LONG = 150  # rows of a sweep: as long does it take to follow and prove a turn in plain numbers


def full_turn(drive: Drive, start: Array) -> TracedCurve | None:
    """The curve through a position (N,) that closes after one turn of the input, with its proof.

    ``None`` where compiled code does not pay, and where the march does not prove the whole turn:
    at dead points, near change points, and where the curve closes after several turns only.
    """
    leads, p = drive.leads, drive.leads.parameter
    own = leads.with_parameter(p)
    if not leads.is_angle[p] or own is None or not own.provable:
        return None
    if not by_kernels.kernels_pay(drive.model, _AS_LONG):
        return None
    here = own.node(start)
    t = here.t + np.linspace(0.0, FULL_TURN, _STEPS + 1)
    # whole turns are no floats: proofs hold for the exact value, too
    slip = 4.0 * EPSILON * (abs(here.t) + FULL_TURN)
    anchor = node_at(drive.solver, drive.path, here.t, start)
    rows = by_kernels.kernel_rows(drive, anchor, t, slip * np.abs(drive.path.rate))
    if rows is None or not _closes(drive, rows):
        return None
    leg = Leg(led=own, nodes=(here, *_nodes_behind(own, here, t, rows)))
    return TracedCurve(
        curve=Curve(legs=(leg,), end=CircuitEnd.CLOSED, passes=((0, rows.v[-1]),)),
        proof=ProvenCurve(
            legs=np.ones(1, dtype=bool),
            junctions=np.zeros(0, dtype=bool),
            closed=True,
            steps=_STEPS,
        ),
        turns=(),
    )


def _closes(drive: Drive, rows: SolvedRows) -> bool:
    """Whether the last of proved rows is proved to be the first, modulo whole turns.

    The last position is at most its radius away from the last row's numbers. If these are so near
    to the first row's that it lies within the first uniqueness radius, it is the first position:
    no other one lies there.
    """
    first, last = rows.v[0], rows.v[-1]
    turns = whole_turns(drive.leads, first, last)
    if not drive.leads.repeats_after(turns):
        return False
    gap = np.abs(last - FULL_TURN * turns - first) + 4.0 * EPSILON * np.abs(last)
    away = float((gap / drive.leads.scale)[: drive.solver.unknowns].max())
    return away + float(rows.radius[-1]) < float(rows.uniqueness_radius[0])


def _nodes_behind(own: Parametrization, here: Node, t: Array, rows: SolvedRows) -> list[Node]:
    """Proved rows as nodes; det J keeps its sign along proved steps."""
    v, first, second = (x[:, own.order] for x in (rows.v, rows.first, rows.second))
    return [
        Node(
            t=at,
            v=v[k],
            first=first[k],
            second=second[k],
            orientation=here.orientation,
            condition=float(rows.condition[k]),
            nearness=float(rows.condition[k]),  # at most that
        )
        for k, at in enumerate(t.tolist())
        if k
    ]
