"""The whole cycle: a table of positions along one branch, or around the whole circuit."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from linkwork import wings
from linkwork.core.foundation.arrays import BoolArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import Certification, ChangePointPolicy, CircuitEnd, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.foundation.values import check_flags, given_or
from linkwork.core.motion.branch_rows import (
    Asked,
    BranchRows,
    Report,
    beyond_change_point,
    ends_passed,
    rows_of_branch,
)
from linkwork.core.motion.extremes import check_quantities, output_limit_at, output_limits
from linkwork.core.motion.following import Drive, enter_path, track_to
from linkwork.core.motion.limits import BranchEnd
from linkwork.core.motion.model import FITS, Model, leading_input, misfit
from linkwork.core.motion.rows_between import RowsBetween, fitting, message_of, motion_of_rows
from linkwork.core.motion.solving import Start, first_position
from linkwork.core.motion.sweep_table import NamedEnd, SweepTable
from linkwork.core.numerics.branch_tracking import Node, Track
from linkwork.core.numerics.local_parametrization import coincide, whole_turns
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.numerics.passage import Passage
from linkwork.core.numerics.system import SolvedRows
from linkwork.core.results.limit import Limit, LimitKind, OutputLimit
from linkwork.core.results.motion import Motion

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
