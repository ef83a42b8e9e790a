"""Search for input values at which friction stops a mechanism."""

from __future__ import annotations

import math
from dataclasses import dataclass

from linkwork import motion
from linkwork.forces.solving import forces_of_motion, forces_of_position
from linkwork.motion.model import Model
from linkwork.results.motion import Motion
from linkwork.results.position import Position
from linkwork.results.reactions import ForceStatus
from linkwork.results.stall import Stall

__all__ = ["locate_stalls"]

_MOVES = (ForceStatus.FOUND, ForceStatus.UNDETERMINED)
_MOST_ROWS = 80
_PRECISE = 1e-11  # of the input value
_BESIDE = 0.02  # of the way to the zero: the next rows are on either side of it


def locate_stalls(
    model: Model, rows: Motion, *, configuration: str | None = None
) -> tuple[Stall, ...]:
    """Where the rows of a motion change between motion and self-locking; none with several inputs.

    The interval between two rows is narrowed by secants and halving to the precision of the input;
    the bracket is the narrowest with proofs on both sides.

    Raises
    ------
    InputError
        If nothing loads the mechanism.
    """
    found = forces_of_motion(model, rows)
    if len(rows.inputs) != 1:
        return ()
    name = next(iter(rows.inputs))
    stalls = []
    for k, (first, second) in enumerate(zip(found.statuses, found.statuses[1:], strict=False)):
        locks = ForceStatus.SELF_LOCKING
        if (first in _MOVES and second is locks) or (first is locks and second in _MOVES):
            values = [float(v) for v in rows.inputs[name][k : k + 2]]
            moving, locked = values if second is locks else values[::-1]
            search = _Search(model, name, configuration)
            stall = search.between(moving, locked)
            if stall is not None:
                stalls.append(stall)
    return tuple(stalls)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Row:
    """The forces at an input value; ``ease`` is 1 over the effort, 0 where none moves it."""

    value: float
    position: Position
    moves: bool
    proved: bool
    ease: float


@dataclass(frozen=True, eq=False)
class _Search:
    model: Model
    name: str
    configuration: str | None

    def at(self, value: float) -> _Row | None:
        """The row at an input value; ``None`` without forces."""
        if self.configuration is None:
            position = motion.solve(self.model, value)
        else:
            position = motion.solve_configuration(self.model, value, self.configuration)
        found = forces_of_position(self.model, position)
        if found.status not in (*_MOVES, ForceStatus.SELF_LOCKING):
            return None
        effort = float(found[f"{self.name}.effort"])
        return _Row(
            value=value,
            position=position,
            moves=found.status in _MOVES,
            proved=bool(found.proved) and position.certificate.certified,
            ease=1.0 / effort if effort else math.inf,
        )

    def between(self, moving: float, locked: float) -> Stall | None:
        """The stall between two values; ``None`` if a position between them is missing."""
        near, far = self.at(moving), self.at(locked)
        # another branch than that of the rows has no stall there
        if near is None or far is None or not near.moves or far.moves:
            return None
        last: _Row | None = None
        for k in range(_MOST_ROWS):
            width = far.value - near.value
            if abs(width) <= _PRECISE * max(abs(far.value), abs(near.value)):
                break
            row = self.at(_aim(near, far, last, beyond=k % 2 == 1))
            if row is None:
                return None
            if row.moves:
                near, last = row, near
            else:
                far = row
        # rows near the stall are too ill-conditioned to be proved: step back from it
        width = near.value - far.value
        ends = self._proved(near, moving, width), self._proved(far, locked, -width)
        known = [
            own.value if end is None else end for own, end in zip((near, far), ends, strict=True)
        ]
        names = self.model.motion_quantities.names
        return Stall(
            input=self.name,
            value=near.value,
            unit=self.model.units.of(names.inputs[self.name]),
            bracket=(known[0], known[1]),
            proved=None not in ends,
            position=near.position,
        )

    def _proved(self, row: _Row, end: float, step: float) -> float | None:
        """The nearest value towards the end of its side at which the answer is proved."""
        side = row.moves
        while not row.proved:
            if row.value == end:
                return None
            # proofs need a distance from the stall that rounding does not give
            step *= 10.0
            value = row.value + step if abs(step) < abs(end - row.value) else end
            found = self.at(value)
            if found is None or found.moves is not side:
                return None
            row = found
        return row.value


def _aim(near: _Row, far: _Row, last: _Row | None, *, beyond: bool) -> float:
    """Where to look next: around the zero of the ease, which a secant finds, or halfway."""
    middle = (near.value + far.value) / 2.0
    if last is None or near.ease == last.ease or not math.isfinite(near.ease + last.ease):
        return middle
    zero = near.value - near.ease * (near.value - last.value) / (near.ease - last.ease)
    way = zero - near.value
    value = zero + _BESIDE * way * (1.0 if beyond else -1.0)
    inside = min(near.value, far.value) < value < max(near.value, far.value)
    return value if inside else middle
