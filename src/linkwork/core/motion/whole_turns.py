"""Motions that repeat themselves after whole turns of the input: laps are left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.rounding import EPSILON, UNIT_ROUNDOFF
from linkwork.core.foundation.statuses import Certification
from linkwork.core.foundation.units import FULL_TURN, AngleUnit
from linkwork.core.motion.following import Drive
from linkwork.core.numerics.branch_tracking import Node, follow
from linkwork.core.numerics.local_parametrization import same_position, whole_turns
from linkwork.core.numerics.system import SolvedRows

_FAR = 3.0  # turns up to which the motion is simply followed
_MOST_COUNTED = 1e15  # turns: of more, the rounding of a number is more than a turn
_MOST_FOLLOWED = 10_000  # turns of a motion that does not repeat itself
_MOST_TURNS = 60  # of the input, after which a motion counts as one that never repeats itself


@dataclass(frozen=True, kw_only=True, eq=False)
class Lap:
    """The way of a motion from a position back to it, while the input turns on.

    ``begin``, ``end``: of the input, internal units. ``turns``: of the input in a lap. ``gained``
    (N,): whole turns of every angle in a lap; what every length gains, in units of 2π.
    """

    drive: Drive
    begin: Node
    end: Node
    turns: int
    gained: Array

    @property
    def width(self) -> float:
        """Of a lap, in radians of the input."""
        return self.turns * FULL_TURN

    @property
    def _unit(self) -> AngleUnit:
        return self.drive.model.units.angle

    def number_of(self, values: Array) -> Array:
        """The laps (B,) between the beginning and inputs (B,) in file units."""
        begin = self._unit.from_radians(self.begin.t)
        number: Array = np.floor((values - begin) / (self.turns * self._unit.turn))
        return number

    def nearer(self, values: Array, number: Array) -> Array:
        """Inputs (B,) in file units that many laps (B,) nearer to the beginning."""
        return self._unit.without_turns(values, number * self.turns)

    def intended(self, nearer: Array) -> Array:
        """Inputs (B,) in internal units, apart from ``nearer`` by what that may be off by.

        Proofs hold for all inputs in between.
        """
        t = nearer * self.drive.unit
        return t + 4.0 * UNIT_ROUNDOFF * (1.0 + np.abs(t))

    def leads_back(self, closing: SolvedRows) -> bool:
        """Whether the row at the end of the lap is proved to be the position at its beginning."""
        leads, begin, end = self.drive.leads, self.begin.v, closing.v[0]
        return bool(
            closing.certification[0] == Certification.CERTIFIED.code
            and np.array_equal(_gained(self.drive, begin, end), self.gained)
            and same_position(leads, begin, end, self.gained)
        )

    def after(self, rows: SolvedRows, number: Array, proved: bool) -> SolvedRows:
        """Rows of the first lap that many laps (B,) later.

        Large angles are rounded; radii grow by that. ``proved``: whether a lap leads back.
        """
        v = rows.v + np.multiply.outer(number * FULL_TURN, self.gained)
        weights = self.drive.solver.variable_scale
        roundings = np.where(self.drive.leads.is_angle, 2.0, 4.0) * EPSILON
        off = (roundings * np.abs(v) * (v != rows.v) / weights).max(axis=1)
        radius, room = rows.radius + off, rows.uniqueness_radius - off
        certified = rows.certification == Certification.CERTIFIED.code
        lost = certified & ~(radius < room)
        rows = rows.with_columns(v=v, radius=radius, uniqueness_radius=room)
        rows = rows.set(lost, certification=Certification.POSITION_NOT_PROVED.code)
        if proved:
            return rows
        further = certified & ~lost & (number != 0.0)
        return rows.set(further, certification=Certification.MOTION_NOT_PROVED.code)


def lap_of(drive: Drive, begin: Node, t: Array) -> Lap | None:
    """The lap of a motion, if inputs ``t`` (B,) far from each other or from its beginning are
    asked for.

    Raises
    ------
    InputError
        If so many turns are asked for that a motion which never comes back cannot be followed.

    Returns
    -------
    Lap or None
        ``None`` with several inputs or a length as input, if all inputs are near, or if the
        motion does not come back to its beginning while the input turns on.
    """
    inputs = drive.model.equations.inputs
    if len(inputs) != 1 or inputs[0].kind != "angle":
        return None
    asked = max(np.ptp(t), np.abs(t - begin.t).max()) / FULL_TURN
    if not asked > _FAR:
        return None
    if asked > _MOST_COUNTED:
        raise InputError(
            f"{inputs[0].name} is asked for {asked:.4g} turns from the guess: beyond 1e15 turns a "
            "number says nothing about the angle; leave out whole turns"
        )
    here = begin
    for turns in range(1, int(min(asked, _MOST_TURNS)) + 1):
        nodes, end = follow(drive.solver, drive.path, here, begin.t + turns * FULL_TURN)
        if end is not None:
            return None
        if not nodes:  # a turn is less than the rounding of this angle
            break
        here = nodes[-1]
        gained = _gained(drive, begin.v, here.v)
        if same_position(drive.leads, begin.v, here.v, gained):
            return Lap(drive=drive, begin=begin, end=here, turns=turns, gained=gained)
    if asked > _MOST_FOLLOWED:
        raise InputError(
            f"{inputs[0].name} is asked for {asked:.4g} turns from the guess, and the motion does "
            f"not repeat itself within {_MOST_TURNS} turns: at most {_MOST_FOLLOWED:,} turns are "
            "followed; start from a guess nearer to the values asked for"
        )
    return None


def _gained(drive: Drive, begin: Array, end: Array) -> Array:
    """Whole turns of angles (N,) on the way between two positions, and what lengths gain by them.

    A wheel that rolls on gains the same length with every turn: a straight equation says how much,
    in units of 2π.
    """
    leads = drive.leads
    gained = whole_turns(leads, begin, end)
    known = leads.is_angle.copy()
    straight = leads.table.straight_parts
    for _ in straight:  # a length may follow from another one
        for weights in straight:
            free = np.flatnonzero((weights != 0.0) & ~known)
            if len(free) == 1:
                gained[free] = -(weights @ gained) / weights[free]
                known[free] = True
    return gained
