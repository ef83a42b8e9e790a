"""Seeds of circuits: configurations at inputs that every circuit must pass."""

from __future__ import annotations

from collections.abc import Callable

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.foundation.completeness import Completeness
from linkwork.foundation.rounding import REGULAR_CONDITION
from linkwork.motion.assembly.assembling import Assemblies, positions_at
from linkwork.motion.circuit.arcs import Explorer
from linkwork.motion.circuit.dead_inputs import DeadPointInputs, dead_point_inputs
from linkwork.motion.circuit.intervals import Interval, intervals_between
from linkwork.motion.drive import Drive
from linkwork.motion.start import Start, first_position
from linkwork.numerics.continuation.branch_tracking import TrackOptions
from linkwork.numerics.newton import NewtonOptions

__all__ = ["Seeding"]

_LOOKED_AT = 24  # input values at which all configurations are listed if dead points may be missing


class Seeding:
    """Configurations at chosen inputs, each followed along its circuit by an explorer.

    ``names``: the configurations at the guess's input with their names. ``seeded``: at how many
    input values configurations were listed. ``unclear``: in how many intervals no list was sure.
    ``start``: the position at the guess, once looked for.
    """

    def __init__(self, drive: Drive, explorer: Explorer) -> None:
        self.drive, self.model, self.explorer = drive, drive.model, explorer
        self.names: list[tuple[Array, str]] = []
        self.dead: DeadPointInputs | None = None
        self.seeded = self.unclear = 0
        self.start: Start | None = None
        self._lists: dict[float, Assemblies] = {}
        self._told = 0.0

    def look(self, progress: Callable[[float], None] | None) -> None:
        """Seed with the guess, the configurations at its input, and those between dead points.

        A second time if a proof has replaced a curve: what follows from it may be different.
        """
        self._look(progress)
        if not self.explorer.settle():
            self.explorer.restart()
            self._look(progress)

    def _look(self, progress: Callable[[float], None] | None) -> None:
        model = self.model
        self.names, self.seeded, self.unclear = [], 0, 0
        start = self.start or first_position(model, model.start_inputs, NewtonOptions())
        self.start = start
        # at a dead point the input cannot lead; the circuit is found from other inputs
        if start.status.ok and self._regular(start.v, TrackOptions().largest_condition):
            self.explorer.visit(start.v)
        value = float(model.start_inputs[self.drive.lead])
        found = self._positions_at(value)
        if found.completeness is Completeness.NOT_LISTED:
            return
        self.names = list(zip(found.v, found.names, strict=True))
        sure = self._visit_circuits(found)
        self.dead = self.dead or dead_point_inputs(model, self.drive.path, self.drive.lead)
        intervals = self._intervals(value, sure)
        for k, interval in enumerate(intervals):
            self._look_into(interval)
            self._told = max(self._told, (k + 1) / len(intervals))
            if progress is not None:
                progress(self._told)

    def _positions_at(self, value: float) -> Assemblies:
        """All configurations at a value of the leading input."""
        if value not in self._lists:
            self._lists[value] = positions_at(self.model, self.drive.path.at(value))
        return self._lists[value]

    def _intervals(self, value: float, sure: bool) -> list[Interval]:
        """Where to look; a ``value`` whose list is ``sure`` represents its interval."""
        assert self.dead is not None
        place = self.drive.leads.parameter
        turns, scale = bool(self.drive.leads.is_angle[place]), float(self.drive.leads.scale[place])
        cuts = self.dead.cuts
        found = intervals_between(cuts, value if sure else None, scale, turns=turns)
        if not len(cuts) and not sure:
            # without a cut one value serves for all: not the guess, whose list was not sure
            found = [(value + 0.1 * scale, value - 0.17 * scale)]
        if not self.dead.cover_all:
            found += [(further,) for further in self._further_inputs(value)]
        return found

    def _look_into(self, interval: Interval) -> None:
        """List the configurations at one value of an interval, at another where that fails."""
        if not any(self._visit_circuits(self._positions_at(value)) for value in interval):
            self.unclear += 1

    def _visit_circuits(self, found: Assemblies) -> bool:
        """Follow the circuits of all configurations; whether none is missing or left out."""
        regular = [self._regular(v) for v in found.v]
        for v, good in zip(found.v, regular, strict=True):
            if good:
                self.explorer.visit(v)
        self.seeded += 1
        return found.completeness.complete and all(regular)

    def _regular(self, v: Array, most: float | None = None) -> bool:
        """Whether the input can lead at a position: not at dead points and change points."""
        own = self.drive.leads.with_parameter(self.drive.leads.parameter)
        largest = REGULAR_CONDITION if most is None else most
        return own is not None and own.node(v).nearness < largest

    def _further_inputs(self, start: float) -> list[float]:
        """Equally spaced over a turn, or over the input's table."""
        if self.drive.free:
            return [start + k * FULL_TURN / _LOOKED_AT for k in range(1, _LOOKED_AT)]
        t = self.model.rows[:, self.drive.lead]
        low, high = float(min(t.min(), start)), float(max(t.max(), start))
        # off the round numbers at which a table begins and ends
        return [low + (high - low) * (k + 0.5) / _LOOKED_AT for k in range(_LOOKED_AT)]

    def _ends(self) -> str:
        """The limits of circuits."""
        assert self.dead is not None
        ends = ["all dead points"]
        if self.dead.multiple.any():
            ends.append("change points")
        if len(self.dead.poles):
            ends.append("inputs at which a length runs to infinity")
        return " and ".join([", ".join(ends[:-1]), ends[-1]] if len(ends) > 1 else ends)

    def completeness(self) -> tuple[Completeness, str]:
        """Of the list of circuits."""
        if self.dead is None:
            what = "only the circuit of the guess" if self.explorer.arcs else "only the guess"
            return Completeness.NOT_LISTED, (
                f"{what}: the configurations of these equations cannot be listed"
            )
        count = self.seeded
        if self.dead.cover_all and not self.unclear:
            where = "the guess's input (there is no dead point)"
            if len(self.dead.cuts):
                where = f"{count} input values, at least one between any two of them"
            return Completeness.WITH_PROBABILITY_ONE, (
                f"the list of circuits is complete with probability one: {self._ends()} were "
                f"found, and all configurations at {where}"
            )
        what = "the circuits found at" if self.unclear else "every circuit that contains one of"
        reason = ""
        if not self.dead.cover_all:
            reason = f" ({self.dead.reason})"
        return Completeness.NOT_PROVED, (
            f"{what} {count} input values; a circuit that lies between two of them would be "
            f"missing{reason}"
        )
