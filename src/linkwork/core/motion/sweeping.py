"""The table of a sweep: requested rows, and rows of limits in their places."""

from __future__ import annotations

import math
from bisect import bisect_left, insort
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from linkwork import wings
from linkwork.core.foundation.arrays import EPSILON, Array, BoolArray, IndexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import short_number
from linkwork.core.foundation.statuses import Certification, ChangePointPolicy, CircuitEnd, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.foundation.values import check_flags, given_or
from linkwork.core.motion.branch_rows import (
    Asked,
    BranchRows,
    Report,
    RowsBetween,
    beyond_change_point,
    ends_passed,
    fitting,
    message_of,
    motion_of_rows,
    rows_of_branch,
)
from linkwork.core.motion.extremes import check_quantities, output_limit_at, output_limits
from linkwork.core.motion.following import Drive, enter_path, track_to
from linkwork.core.motion.limits import BranchEnd
from linkwork.core.motion.model import FITS, Model, leading_input, misfit
from linkwork.core.motion.solving import Start, first_position
from linkwork.core.numerics.branch_tracking import Node, Track, coincide, whole_turns
from linkwork.core.numerics.newton import NewtonOptions, SolvedRows
from linkwork.core.numerics.passage import Passage
from linkwork.core.results.failure import Limit, LimitKind, OutputLimit
from linkwork.core.results.motion import Motion

_SAME_PLACE = 1e-11  # relative: values of the path so near to each other are one place


class _PlaceOfEnd(NamedTuple):
    """Where an end may be in the table, and how far that is from where it was met."""

    guessed: bool  # no row of its branch is next to it
    away: float
    t: float


def _slack_at(t: float) -> float:
    return _SAME_PLACE * max(1.0, abs(t))


#: The end of a branch, and the branch's name.
NamedEnd = tuple[BranchEnd, str]


class SweepTable:
    """Rows over values ``t`` of a path, in the order they were asked for.

    Parameters
    ----------
    found : BranchRows
        The rows of the branch that the table is begun with.
    windows : ((float, float), (float, float))
        Smallest and largest value of t that has a place in the table, and those that the sweep was
        asked for.
    period : float
        How far away rows are the same position, or infinity.
    """

    def __init__(
        self,
        drive: Drive,
        asked: Asked,
        found: BranchRows,
        windows: tuple[tuple[float, float], tuple[float, float]],
        period: float,
    ) -> None:
        self.drive, self.asked, self.rows = drive, asked, found.rows
        self.window, self.span = windows
        self.period = period
        self._placed = found.placed.copy()
        self._order = np.argsort(asked.t, kind="stable")
        self._sorted = asked.t[self._order]
        self._ends: list[NamedEnd] = []
        self._replaced: dict[int, SolvedRows] = {}  # by the row of the table
        self._between: dict[float, SolvedRows] = {}  # by t
        self._between_t: list[float] = []  # sorted

    def not_straight(self, end: BranchEnd) -> IndexArray:
        """Rows beyond the end of a branch that are not there, or only whole turns around."""
        missing = self.rows.status != Status.CONVERGED.code
        missing |= self._placed != self.asked.t
        slack = end.slack + 4.0 * EPSILON * abs(end.t)
        return np.flatnonzero(missing & (end.side * (self.asked.t - end.t) > slack))

    def take(self, found: BranchRows, where: IndexArray) -> BoolArray:
        """Take rows of another branch, asked for at the rows ``where``; which of all were taken.

        Straight ahead comes before whole turns around, and of these the first position found.
        """
        straight = found.converged & (found.placed == self.asked.t[where])
        put = straight | (self.rows.status[where] != Status.CONVERGED.code)
        self.rows = self.rows.put(where[put], found.rows.take(np.flatnonzero(put)))
        self._placed[where[put]] = found.placed[put]
        taken = np.zeros(len(self.rows), dtype=bool)
        taken[where[put & found.converged]] = True
        return taken

    def leave_out(self, where: IndexArray, status: Status) -> None:
        """Give those of some rows that have no position a status."""
        there = self.rows.status[where] == Status.CONVERGED.code
        self.rows = self.rows.set(where[~there], status=status.code)

    def drop(self, where: IndexArray, status: Status) -> None:
        """Remove the positions of some rows, which were reached the other way around."""
        proved = self.rows.asks_for_proofs
        why = Certification.NO_POSITION if proved else Certification.NOT_ASKED
        inputs, variables = self.rows.inputs[where], self.rows.v.shape[1]
        self.rows = self.rows.put(where, SolvedRows.blank(inputs, variables, status, why))
        self._placed[where] = np.nan

    def places_of(self, t: float) -> Array:
        """Where a value belongs in the table's range, whole periods apart too, (P,).

        Of many places between two rows only those next to the rows count.
        """
        low, high = self.window
        slack = _slack_at(max(abs(low), abs(high)))
        here = np.array([t])
        if np.isfinite(self.period):
            first = np.ceil((low - slack - t) / self.period)
            last = np.floor((high + slack - t) / self.period)
            if last - first < 2 * len(self._sorted):
                number = np.arange(first, last + 1.0)
            else:
                below = np.floor((self._sorted - t) / self.period)
                number = np.unique(np.concatenate([below, below + 1.0]))
            here = t + number * self.period
        return here[(here >= low - slack) & (here <= high + slack)]

    def _beside(self, here: Array, apart: float) -> tuple[IndexArray, IndexArray]:
        """The sorted rows below values of t (P,) and above them, -1 and B where there is none.

        ``apart``: how far away at least, relative; negative for rows that may be there.
        """
        slack = apart * np.maximum(1.0, np.abs(here))
        below = np.searchsorted(self._sorted, here - slack, side="left") - 1
        return below, np.searchsorted(self._sorted, here + slack, side="right")

    def turns_at(self, here: float) -> int:
        """By how many whole turns the names of rows next to a value of t differ from it.

        On a further branch the rows bear the inputs of the table, whole turns away if need be:
        one put between them does the same, inside the table's range if it can.
        """
        lead, scale = self.drive.lead, self.drive.unit
        at = int(np.searchsorted(self._sorted, here))
        near = np.arange(max(0, at - 2), min(len(self._sorted), at + 2))
        beside = self._order[near[np.argsort(np.abs(self._sorted[near] - here), kind="stable")[:2]]]
        named = self.asked.in_file_units[beside, lead] * scale
        turns = [round(float(gap) / FULL_TURN) for gap in named - self.asked.t[beside]]
        slack = _slack_at(abs(here))
        low, high = self.span
        inside = [k for k in turns if low - slack <= here + k * FULL_TURN <= high + slack]
        return (inside or turns or [0])[0]

    def put_ends(self, ends: Sequence[NamedEnd]) -> list[BranchEnd]:
        """A row of its own for every end of a branch whose place lies in the table.

        Returned are the ends with their limits named as those rows are.
        """
        self._ends += ends
        placed = {k: places[0] for k, (end, _) in enumerate(ends) if (places := self._places(end))}
        named = [end for end, _ in ends]
        for k in sorted(placed, key=placed.__getitem__):
            (end, branch), here = ends[k], placed[k].t
            if self._put_at(end, branch, here) or not placed[k].guessed:
                named[k] = self._named(end, here)
        return named

    def named(self, end: BranchEnd) -> BranchEnd:
        """An end with its limit named in the range of the table, if it has a place there."""
        places = self._places(end)
        return self._named(end, places[0].t) if places else end

    def _named(self, end: BranchEnd, here: float) -> BranchEnd:
        """The end named at a place; as a row that was asked for there is, if it may be that."""
        lead = self.drive.lead
        named = end.with_input_named(float(self._inputs(end, here)[0, lead]))
        low, high = named.limit.bracket
        if not named.limit.located:
            return named
        for row in self._rows_at(here, _slack_at(here)):
            asked = float(self.asked.in_file_units[row, lead])
            if low <= asked <= high:
                return replace(named, limit=replace(named.limit, input=asked))
        return named

    def _rows_at(self, here: float, slack: float) -> IndexArray:
        """The rows that were asked for at a value of t."""
        first = np.searchsorted(self._sorted, here - slack, side="left")
        last = np.searchsorted(self._sorted, here + slack, side="right")
        return self._order[first:last]

    def _places(self, end: BranchEnd) -> list[_PlaceOfEnd]:
        """Where an end belongs in the table, best first.

        It belongs whole turns away only if rows on the branch's side of it were found as many turns
        away, or no such row was found.
        """
        here = self.places_of(end.t)
        below, above = self._beside(here, _SAME_PLACE)
        nearest = below if end.side > 0 else above
        none = (nearest < 0) | (nearest == len(self._sorted))
        row = self._order[np.where(none, 0, nearest)]
        gap = self.asked.t[row] - self._placed[row] - (here - end.t)
        guessed = none | np.isnan(gap)
        keep = np.flatnonzero(guessed | (np.abs(gap) <= 1.0))
        return sorted(
            _PlaceOfEnd(bool(guessed[k]), abs(float(here[k]) - end.t), float(here[k])) for k in keep
        )

    def _put_at(self, end: BranchEnd, branch: str, here: float) -> bool:
        if end.v is None or end.first is None:
            return True
        slack = end.slack + 4.0 * EPSILON * abs(here)
        return self.put(self._row_of(end, end.v, end.first, branch, here), here, slack)

    def _row_of(
        self, end: BranchEnd, v: Array, first: Array, branch: str, here: float
    ) -> SolvedRows:
        solver = self.drive.solver
        row = SolvedRows.blank(self._inputs(end, here), solver.variables, Status.CONVERGED)
        return row.set(
            v=v,
            first=first,
            residual=solver.residual(v[None, :]),
            condition=np.inf,
            certification=end.certification.code,
            radius=end.radius,
            uniqueness_radius=end.uniqueness_radius,
            branch=branch,
            limit=end.limit.kind.word,
        )

    def put(self, row: SolvedRows, here: float, slack: float | None = None) -> bool:
        """A row at a value of t: in the place of one that was asked for just there, or between.

        ``slack``: how far a row that was asked for just there may be. Whether it was put: where a
        limit is already nothing is.
        """
        slack = _slack_at(here) if slack is None else slack
        place = bisect_left(self._between_t, here - slack)
        if any(t <= here + slack for t in self._between_t[place : place + 1]):
            return False
        same = self._rows_at(here, slack).tolist()
        fresh = [k for k in same if k not in self._replaced]
        for k in fresh:
            self._replaced[k] = row.set(inputs=self.rows.inputs[k])
        if not same:
            insort(self._between_t, here)
            self._between[here] = row
        return bool(fresh) or not same

    def finish(self) -> tuple[SolvedRows, BoolArray]:
        """All rows in the table's order, and which of them were not asked for."""
        everywhere = [(p, k) for k, (end, _) in enumerate(self._ends) for p in self._places(end)]
        for place, k in sorted(everywhere):  # where nothing else is, whole turns away
            self._put_at(*self._ends[k], place.t)
        rows = self.rows
        if self._replaced:
            others = SolvedRows.concatenate(list(self._replaced.values()))
            rows = rows.put(np.array(list(self._replaced)), others)
        added = np.arange(len(rows) + len(self._between)) >= len(rows)
        if not self._between:
            return rows, added
        t = np.concatenate([self.asked.t, list(self._between)])
        backwards = len(self.asked.t) > 1 and self.asked.t[-1] < self.asked.t[0]
        order = np.argsort(-t if backwards else t, kind="stable")
        rows = SolvedRows.concatenate([rows, *self._between.values()])
        return rows.take(order), added[order]

    def shows(self, t: float, here: Array, own: BoolArray) -> BoolArray:
        """At which places (P,) of a value of t a neighbouring row shows the same turn of a branch.

        Parameters
        ----------
        own : (B,)
            The rows of that branch.
        """
        shown = np.zeros(len(here), dtype=bool)
        below, above = self._beside(here, -_SAME_PLACE)
        for beside in (below, above):
            row = self._order[beside.clip(0, len(self._sorted) - 1)]
            away = self.asked.t[row] - self._placed[row] - (here - t)
            there = (beside >= 0) & (beside < len(self._sorted))
            shown |= there & own[row] & (np.abs(away) <= 1.0)
        return shown

    def _inputs(self, end: BranchEnd, here: float) -> Array:
        """The inputs at an end as short numbers, shifted by the whole turns to ``here``, (1, p)."""
        scale, path = self.drive.model.input_scale, self.drive.path
        in_file_units = np.array([short_number(x) for x in path.at(end.t) / scale])
        in_file_units[self.drive.lead] = end.limit.input
        turns = round((here - end.t) / FULL_TURN) + self.turns_at(here)
        return (in_file_units + turns * path.rate * (FULL_TURN / scale))[None, :]


# ----------------------------------------------------------------------
# The whole cycle: a table of positions along one branch, or around the whole circuit.


_MOST_CROSSINGS = 64
_ROUNDING = 1e-14  # of whole turns, which are no floats
_SAME_EXTREME = 1e-6  # of the leading input: extremes nearer to each other are one


def sweep(
    model: Model,
    *,
    certify: bool = True,
    through: bool = False,
    change_points: str | ChangePointPolicy = ChangePointPolicy.STOP,
    limits_of: str | Iterable[str] = (),
    options: NewtonOptions | None = None,
    progress: Callable[[float], None] | None = None,
    explained: bool = True,
) -> Motion:
    """The positions at every row of the input's table, on the branch of the guess.

    The branch is followed from the input value of the guess both ways with steps as short as
    safety demands, whatever the table's step. A row outside its reach is tried a whole turn away,
    and kept with its status if it is not there either. Every dead point and change point that is
    met adds a row of its own with the exact value. Long tables are computed by compiled kernels
    where that is quicker: the same to rounding.

    Parameters
    ----------
    certify : bool
        Prove every position, and that the motion to it stays on the start's branch.
    through : bool
        Go on through dead points, the input turning back, around the whole circuit: the rows of
        every further branch follow, in the direction of travel.
    change_points : str
        ``stop`` at a change point, go ``straight`` on (keep the tangent) or ``turn`` (take the
        branch that crosses).
    limits_of : str, or several
        Quantities whose largest and smallest values are located, a row for each.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.
    explained : bool
        Find out why there is no start; that takes many times longer than finding that there is
        none.

    Raises
    ------
    InputError, UnknownNameError
        For a policy or a quantity that does not exist.
    """
    policy = ChangePointPolicy.of(change_points)
    check_flags(progress, certify=certify, through=through)
    _ = model.rows  # without an input there is nothing to sweep: an error
    if through and model.untimed is not None:
        raise InputError("time does not turn back at dead points: leave out through, or the law")
    quantities = check_quantities(model, limits_of)
    opt = given_or(NewtonOptions(), "options", options)
    work = _begin_sweep(model, certify, opt, policy, progress, explained=explained)
    if isinstance(work, Start):
        return _without_start(model, work)
    if through:
        work.go_around(work.tables[0].asked)
    for name in quantities:
        work.locate_extremes(name)
    return work.motion()


def sweep_rows(model: Model, *, certify: bool = True) -> tuple[SolvedRows, tuple[BranchEnd, ...]]:
    """The rows that :func:`sweep` finds for the table, and the ends of the branch they lie on.

    No row is added for limits; a limit has the input at which it was met, not one whole turns away.
    """
    options, policy = NewtonOptions(), ChangePointPolicy.STOP
    work = _begin_sweep(model, certify, options, policy, None, explained=False)
    if isinstance(work, Start):
        return _no_rows(model), ()
    rows, added = work.tables[0].finish()
    asked = rows.take(np.flatnonzero(~added))
    return fitting(model, asked), work.branches[0].found.ends


def _begin_sweep(
    model: Model,
    certify: bool,
    options: NewtonOptions,
    policy: ChangePointPolicy,
    progress: Callable[[float], None] | None,
    *,
    explained: bool = True,
) -> _Sweep | Start:
    """The sweep of the start's branch; the start itself, with the reason, if there is none."""
    rows = model.rows
    start = first_position(model, model.start_inputs, options, explained=explained)
    if not start.status.ok:
        return start
    lead, rate = leading_input(rows)
    drive = Drive.through(model, rows[0], rate, lead)
    t, named = rows[:, lead], model.rows_in_file_units
    asked = Asked(t=t, inputs=rows, in_file_units=named)
    entry = enter_path(drive, start, asked.t, certify)
    if entry is None:
        message = "no row of the table can be reached from the input values of the guess"
        return replace(start, message=message)
    work = _Sweep(
        drive, certify, Report(progress, entry[0].t, float(asked.t.min()), float(asked.t.max()))
    )
    work.message = start.message
    work.run(*entry, asked, policy)
    return work


@dataclass(frozen=True, kw_only=True, eq=False)
class _Branch:
    """A branch in its table: which of the table's rows are its own, and how its proofs are graded.

    ``standing``: the certification of rows that are proved on it.
    """

    table: SweepTable
    found: BranchRows
    name: str
    standing: Certification
    own: BoolArray


class _Sweep:
    """The parts of a sweep as they are found: branches with their rows, limits, extremes."""

    def __init__(self, drive: Drive, certify: bool, report: Report) -> None:
        self.drive, self.model = drive, drive.model
        self.certify, self.report = certify, report
        self.tables: list[SweepTable] = []
        self.branches: list[_Branch] = []
        self.ends: list[BranchEnd] = []
        self.limits: list[Limit] = []
        self.output_limits: list[OutputLimit] = []
        self.circuit: CircuitEnd | None = None
        self.message = ""

    def run(self, anchor: Node, entered: bool, asked: Asked, policy: ChangePointPolicy) -> None:
        """The table of the start's branch, and of those beyond change points if asked."""
        # no row of the path is graded higher than the way onto it
        standing = Certification.CERTIFIED if entered else Certification.MOTION_NOT_PROVED
        found = self._branch(anchor, asked, self.model.branch, standing)
        span = float(asked.t.min()), float(asked.t.max())
        period = found.lap.width if found.lap else FULL_TURN if self.drive.free else math.inf
        table = SweepTable(self.drive, asked, found, (span, span), period)
        self.tables.append(table)
        first = self._keep(table, found, self.model.branch, standing, found.here)
        below: list[NamedEnd] = []
        above: list[NamedEnd] = []
        for end in found.ends:
            met = self._cross(first, end.demote(standing), policy)
            (below if end.side < 0 else above).extend(met)
        self.ends = table.put_ends([*below[::-1], *above])
        self.limits = [end.limit for end in self.ends]

    def _branch(
        self,
        anchor: Node,
        asked: Asked,
        name: str,
        standing: Certification,
        passage: Passage | None = None,
    ) -> BranchRows:
        found = rows_of_branch(self.drive, anchor, asked, self.report, self.certify, passage)
        rows = found.rows.demote(standing).set(found.converged, branch=name)
        return replace(found, rows=rows)

    def _keep(
        self,
        table: SweepTable,
        found: BranchRows,
        name: str,
        standing: Certification,
        own: BoolArray,
    ) -> _Branch:
        """Keep a branch with its own rows (B,), which are no other branch's any more."""
        for other in (branch for branch in self.branches if branch.table is table):
            other.own[own] = False
        branch = _Branch(table=table, found=found, name=name, standing=standing, own=own.copy())
        self.branches.append(branch)
        return branch

    def _cross(self, first: _Branch, end: BranchEnd, policy: ChangePointPolicy) -> list[NamedEnd]:
        """Rows beyond the change points on one side, as far as the policy leads; the ends met.

        A chosen way comes before the way around through a whole turn; behind a change point that is
        not passed any more there is none. A way on which a redundant link does not fit is no way:
        its rows get that status.
        """
        table, name, met = first.table, first.name, []
        for _ in range(_MOST_CROSSINGS):
            beyond = table.not_straight(end)
            if policy is ChangePointPolicy.STOP or not len(beyond):
                break
            if end.limit.kind is LimitKind.UNKNOWN:  # it may be a change point to be crossed
                table.drop(beyond, end.limit.status)
            if not end.crossings:
                break
            passage = beyond_change_point(self.drive, end, policy)
            if passage is None:
                if policy is ChangePointPolicy.STRAIGHT:
                    table.drop(beyond, Status.LOST)
                break
            if misfit(self.model.equations, passage.node.v[None, :])[0] > FITS:
                table.leave_out(beyond, Status.DOES_NOT_FIT)
                break
            for passed in ends_passed(self.drive, end, passage, self.certify):
                limit = replace(passed.limit, passed=policy.value)
                met.append((replace(passed, limit=limit), name))
                name = self.model.circuit
            standing = Certification.BRANCH_CHOSEN
            found = self._branch(passage.node, table.asked.take(beyond), name, standing, passage)
            self._keep(table, found, name, standing, table.take(found, beyond))
            ahead = [other for other in found.ends if other.side == end.side]
            if not ahead:
                return met
            end = ahead[0].demote(standing)
        else:
            table.drop(table.not_straight(end), Status.LOST)
        return [*met, (end, name)]

    def go_around(self, asked: Asked) -> None:
        """The further branches of the circuit, in the direction of travel."""
        track = self.branches[0].found.track
        anchor = track.nodes[track.start]
        if self.branches[0].found.proved_to_ends or not self.certify:
            # a regular start: the circuit is traced from there, and a dead point cannot lead it
            anchor = min(track.nodes, key=self._steepness)
        around = wings.use("circuits.circuit_sweep").further_branches(
            self.drive, anchor.v, asked, self.report, self.certify
        )
        self.circuit = around.end
        placed: list[BranchEnd] = []
        for branch in around.branches:
            found, name = branch.found, branch.name
            found = replace(found, rows=found.rows.set(found.converged, branch=name))
            windows = (branch.window, (float(asked.t.min()), float(asked.t.max())))
            table = SweepTable(self.drive, branch.asked, found, windows, math.inf)
            self.tables.append(table)
            self._keep(table, found, name, branch.standing, found.here)
            placed += table.put_ends([(end, name) for end in branch.ends])
        table = self.tables[0]
        fresh = [
            next((known for known in placed if self._is_same(end, known)), table.named(end))
            for end in around.dead_points
            if not any(self._is_same(end, known) for known in self.ends)
        ]
        self.ends += fresh
        self.limits += [end.limit for end in fresh]
        beyond = table.rows.status == Status.OUT_OF_REACH.code
        # of a closed circuit all branches are known, so other inputs are outside of it
        beyond &= around.leaves_out(asked.t, self.drive.free)
        table.rows = table.rows.set(beyond, status=Status.OUT_OF_CIRCUIT.code)

    def _is_same(self, end: BranchEnd, known: BranchEnd) -> bool:
        """Whether two ends are one place: near each other, at one value as far as it is known.

        Two dead points may lie close together; they are two if their brackets are apart.
        """
        leads = self.drive.leads
        if end.v is None or known.v is None or not coincide(leads, end.v, known.v):
            return False
        turns = float(whole_turns(leads, known.v, end.v)[leads.parameter])
        gap = abs(end.t - known.t - turns * FULL_TURN) / self.drive.unit
        width = sum(limit.bracket[1] - limit.bracket[0] for limit in (end.limit, known.limit))
        return gap <= width + _ROUNDING * max(1.0, abs(end.limit.input), abs(known.limit.input))

    def _steepness(self, node: Node) -> float:
        """Large near dead points, where a single equation has no bad condition, and crossings."""
        weights = self.model.compiled.table.variable_scale
        return node.condition * float(np.abs(node.first / weights).max())

    def locate_extremes(self, name: str) -> None:
        """Rows at which a quantity is largest or smallest, on every branch; and at dead points."""
        lead = self.drive.lead
        for branch in self.branches:
            if not branch.own.any():
                continue
            table = branch.table
            places: list[float] = []
            for t, extreme in output_limits(self.drive, self._whole_track(branch), name):
                here = table.places_of(t)
                mine = [
                    place
                    for place in here[table.shows(t, here, branch.own)].tolist()
                    if not any(abs(place - other) < _SAME_EXTREME for other in places)
                ]
                if not mine:
                    continue
                places += mine
                word = f"{extreme.kind} of {name}"
                row = self._branch_row(branch, t).set(limit=word)
                named = [self._moved(branch, row, t, place) for place in mine]
                self.output_limits.append(extreme.named(float(named[0].inputs[0, lead])))
                for place, moved in zip(mine, named, strict=True):
                    table.put(moved, place)
        at_ends = [output_limit_at(self.drive, end, name) for end in self.ends]
        # a quantity can be extreme at the dead point itself, where both rates vanish
        self.output_limits += dict.fromkeys(extreme for extreme in at_ends if extreme is not None)

    def _whole_track(self, branch: _Branch) -> Track:
        """The branch's track, of a further branch of the circuit up to its dead points."""
        found, table = branch.found, branch.table
        if table is self.tables[0]:
            return found.track
        anchor = found.track.nodes[found.track.start]
        return track_to(self.drive.solver, self.drive.path, anchor, table.window)

    def _branch_row(self, branch: _Branch, t: float) -> SolvedRows:
        """The row of a branch at a value of t."""
        track = branch.found.track
        inputs = self.drive.path.at(np.array([t]))
        in_file_units = inputs / self.model.input_scale
        asked = Asked(t=np.array([t]), inputs=inputs, in_file_units=in_file_units)
        anchor = track.nodes[track.start]
        return self._branch(anchor, asked, branch.name, branch.standing).rows

    def _moved(self, branch: _Branch, row: SolvedRows, t: float, here: float) -> SolvedRows:
        """A row of a branch at a value of t, named by its place in the table."""
        table, lap, path = branch.table, branch.found.lap, self.drive.path
        turns = round((here - t) / FULL_TURN) + table.turns_at(here)
        named = row.inputs + turns * path.rate * (FULL_TURN / self.model.input_scale)
        if lap is not None:
            row = lap.after(row, np.array([round((here - t) / lap.width)]), branch.found.lap_proved)
        return row.with_columns(inputs=named)

    def motion(self) -> Motion:
        """Everything in one result."""
        first, *further = (table.finish() for table in self.tables)
        added = [first[1], *(np.ones(len(rows), dtype=bool) for rows, _ in further)]
        rows = SolvedRows.concatenate([first[0], *(rows for rows, _ in further)])
        motion = replace(
            motion_of_rows(self.model, rows, self.message, np.concatenate(added)),
            limits=tuple(self.limits),
            output_limits=tuple(self.output_limits),
            circuit=self.circuit,
            between=RowsBetween(self.model, rows),
        )
        return replace(motion, message=message_of(motion, self.model))


def _no_rows(model: Model) -> SolvedRows:
    return SolvedRows.blank(
        model.rows_in_file_units, model.compiled.solver.variables, Status.NO_START
    )


def _without_start(model: Model, start: Start) -> Motion:
    rows = _no_rows(model)
    nothing_added = np.zeros(len(rows), dtype=bool)
    motion = motion_of_rows(model, rows, start.message, nothing_added)
    return replace(motion, failure=start.failure)
