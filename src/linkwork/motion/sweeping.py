"""The whole cycle: a table of positions along one branch, or around the whole circuit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.foundation.policy import ChangePointPolicy
from linkwork.foundation.status import Status
from linkwork.motion.around import further_branches
from linkwork.motion.branch_rows import Asked, BranchRows, Report, rows_of_branch
from linkwork.motion.crossing import beyond_change_point
from linkwork.motion.extremes import check_quantities, output_limits
from linkwork.motion.limits import BranchEnd
from linkwork.motion.lock_step import lock_step
from linkwork.motion.model import Model
from linkwork.motion.motion_of_rows import motion_of_rows
from linkwork.motion.proving import way_is_proved
from linkwork.motion.rows import SolvedRows
from linkwork.motion.start import Start, first_position
from linkwork.motion.sweep_table import SweepTable
from linkwork.motion.tracking import leading_scale, turns_freely
from linkwork.numerics.newton import NewtonOptions
from linkwork.numerics.track import InputPath, Node, follow, node_at
from linkwork.results.motion import Limit, LimitKind, Motion, OutputLimit

__all__ = ["sweep"]

_ENTRIES = (
    24  # rows, from the nearest on, at which a table of several inputs is tried to be entered
)
_MOST_CROSSINGS = 64


def sweep(
    model: Model,
    *,
    certify: bool = True,
    through: bool = False,
    change_points: str | ChangePointPolicy = ChangePointPolicy.STOP,
    limits_of: Sequence[str] = (),
    options: NewtonOptions | None = None,
    progress: Callable[[float], None] | None = None,
) -> Motion:
    """The positions at every row of the input's table, on the branch of the guess.

    The branch is followed from the guess's own input value both ways with steps as small as
    safety asks, whatever the table's step. A row outside its reach is tried a whole turn away,
    and kept with its status if it is not there either. Every dead point and change point that is
    met adds a row of its own with the exact value.

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
    limits_of : sequence of str
        Quantities whose largest and smallest values are located, a row for each.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.

    Raises
    ------
    InputError, UnknownNameError
        For a policy or a quantity that does not exist.
    """
    options = options or NewtonOptions()
    policy = ChangePointPolicy.of(change_points)
    rows = model.rows  # without an input there is nothing to sweep: an error
    check_quantities(model, limits_of)
    start = first_position(model, model.start_inputs, options)
    if not start.status.ok:
        return _without_start(model, start)
    lead, rate = lock_step(rows)
    path = InputPath(origin=rows[0] - rate * rows[0, lead], rate=rate)
    asked = Asked(t=rows[:, lead], inputs=rows, everyday=model.everyday_rows)
    entry = _onto_path(model, path, start, asked.t, lead, certify)
    if entry is None:
        message = "no row of the table could be reached from the guess's own input values"
        return _without_start(model, replace(start, message=message))
    work = _Sweep(model, path, lead, certify, Report(progress, entry[0].t, *_span(asked.t)))
    work.run(*entry, asked, policy)
    if through:
        work.go_around(entry[0], asked)
    for name in limits_of:
        work.locate_extremes(name)
    return work.motion(start.message)


def _span(t: Array) -> tuple[float, float]:
    return float(t.min()), float(t.max())


class _Sweep:
    """The parts of a sweep as they are found: branches with their rows, limits, extremes."""

    def __init__(
        self, model: Model, path: InputPath, lead: int, certify: bool, report: Report
    ) -> None:
        self.model, self.path, self.lead = model, path, lead
        self.certify, self.report = certify, report
        self.scale = leading_scale(model, lead)
        self.tables: list[SweepTable] = []
        self.branches: list[tuple[SweepTable, BranchRows, str]] = []
        self.limits: list[Limit] = []
        self.output_limits: list[OutputLimit] = []
        self.circuit: CircuitEnd | None = None

    def run(self, anchor: Node, entered: bool, asked: Asked, policy: ChangePointPolicy) -> None:
        """The table of the start's branch, and of those beyond change points if asked."""
        first = self._branch(anchor, asked)
        proved = Certification.CERTIFIED.code
        if not entered:
            code = first.rows.certification
            code[code == proved] = Certification.MOTION_NOT_PROVED.code
        free = turns_freely(self.model)
        table = SweepTable(self.model, self.path, asked, first.rows, _span(asked.t), free)
        self.tables.append(table)
        self._name(first, self.model.branch)
        self.branches.append((table, first, self.model.branch))
        below: list[Limit] = []
        above: list[Limit] = []
        for end in first.ends:
            passed = self._cross(table, end, policy)
            (below if end.side < 0 else above).extend(passed)
            table.put_end(end, self.model.branch)
        self.limits = [*below[::-1], *above]

    def _branch(self, anchor: Node, asked: Asked) -> BranchRows:
        return rows_of_branch(
            self.model, self.path, self.lead, anchor, asked, self.report, self.certify
        )

    @staticmethod
    def _name(found: BranchRows, branch: str) -> None:
        good = found.here & (found.rows.status == Status.CONVERGED.code)
        found.rows.branch[good] = branch

    def _cross(self, table: SweepTable, end: BranchEnd, policy: ChangePointPolicy) -> list[Limit]:
        """Rows beyond the change points on one side, as far as the policy leads; their limits."""
        told = []
        for _ in range(_MOST_CROSSINGS):
            beyond = np.flatnonzero(
                (table.rows.status != Status.CONVERGED.code)
                & (end.side * (table.asked.t - end.t) > 0.0)
            )
            if policy is ChangePointPolicy.STOP or end.crossing is None or not len(beyond):
                break
            node = beyond_change_point(
                self.model, self.path, end.crossing, end.side, self.scale, policy
            )
            if node is None:
                break
            told.append(replace(end.limit, passed=policy.value))
            found = self._branch(node, table.asked.take(beyond))
            code = found.rows.certification
            code[code == Certification.CERTIFIED.code] = Certification.BRANCH_CHOSEN.code
            self._name(found, self.model.circuit)
            table.rows.put(beyond, found.rows)
            self.branches.append((table, found, self.model.circuit))
            ahead = [other for other in found.ends if other.side == end.side]
            if not ahead:
                return told
            end = _after_choice(ahead[0])
            table.put_end(end, self.model.circuit)
        return [*told, end.limit]

    def go_around(self, anchor: Node, asked: Asked) -> None:
        """The further branches of the circuit, in the direction of travel."""
        around = further_branches(
            self.model, self.path, self.lead, anchor.v, asked, self.report, self.certify
        )
        self.circuit = around.end
        for branch in around.branches:
            rows = branch.found.rows
            table = SweepTable(self.model, self.path, branch.asked, rows, branch.window, False)
            self.tables.append(table)
            self._name(branch.found, branch.name)
            self.branches.append((table, branch.found, branch.name))
            for end in branch.ends:
                table.put_end(end, branch.name)
        known = {(limit.kind, round(limit.input, 9)) for limit in self.limits}
        self.limits += [
            limit
            for limit in around.dead_points
            if not any(_is_same(self.model, limit, other) for other in self.limits)
            and (limit.kind, round(limit.input, 9)) not in known
        ]

    def locate_extremes(self, name: str) -> None:
        """Rows at which a quantity is largest or smallest, on every branch."""
        for table, found, branch in self.branches:
            placed = found.placed[found.here]
            if not len(placed):
                continue
            window = _span(placed)
            places = output_limits(
                self.model, self.path, found.track, window, self.lead, self.scale, name
            )
            for t, limit in places:
                here = table.place_of(t)
                if here is None:
                    continue
                self.output_limits.append(limit)
                inputs = self.path.at(np.array([t]))
                row = self._branch_row(found, t, inputs, here)
                row.branch[0], row.limit[0] = branch, f"{limit.kind} of {name}"
                table.put(row, here)

    def _branch_row(self, found: BranchRows, t: float, inputs: Array, here: float) -> SolvedRows:
        anchor = found.track.nodes[found.track.start]
        everyday = inputs / self.model.input_scale
        turns = round((here - t) / (2.0 * np.pi))
        everyday = everyday + turns * self.path.rate * (2.0 * np.pi / self.model.input_scale)
        asked = Asked(t=np.array([t]), inputs=inputs, everyday=everyday)
        return self._branch(anchor, asked).rows

    def motion(self, message: str) -> Motion:
        """Everything in one result."""
        first, *further = (table.finished() for table in self.tables)
        added = [first[1], *(np.ones(len(rows), dtype=bool) for rows, _ in further)]
        return motion_of_rows(
            self.model,
            SolvedRows.joined([first[0], *(rows for rows, _ in further)]),
            message,
            added=np.concatenate(added),
            limits=tuple(self.limits),
            output_limits=tuple(self.output_limits),
            circuit=self.circuit,
        )


def _after_choice(end: BranchEnd) -> BranchEnd:
    """The end of a branch that was chosen at a change point."""
    if end.certification is not Certification.CERTIFIED:
        return end
    return replace(end, certification=Certification.BRANCH_CHOSEN)


def _is_same(model: Model, one: Limit, other: Limit) -> bool:
    """Whether two limits are one position, whole turns of the input aside."""
    gap = one.input - other.input
    if turns_freely(model):
        turn = 2.0 * np.pi / float(model.input_scale[0])
        gap -= turn * round(gap / turn)
    return one.kind is other.kind is LimitKind.DEAD_POINT and abs(gap) < 1e-9


def _onto_path(
    model: Model, path: InputPath, start: Start, t: Array, lead: int, certify: bool
) -> tuple[Node, bool] | None:
    """The start as a node of the table's path, and whether the way to it is proved.

    Several inputs are first led onto the path.
    """
    solver = model.compiled.solver
    own = model.start_inputs
    here = float(own[lead])
    if np.allclose(path.at(here), own, rtol=0, atol=1e-12 * leading_scale(model, lead)):
        return node_at(solver, path, here, start.v), True
    weights = solver.variable_scale[solver.unknowns :]
    distance = np.abs((path.at(t) - own) / weights).max(axis=1)
    nearest = np.argsort(distance, kind="stable")
    spread = np.linspace(0, len(t) - 1, min(len(t), _ENTRIES)).astype(np.intp)
    for row in (nearest[0], *nearest[spread[1:]]):
        entry = _led_to(model, path, start, float(t[row]), certify)
        if entry is not None:
            return entry
    return None


def _led_to(
    model: Model, path: InputPath, start: Start, t: float, certify: bool
) -> tuple[Node, bool] | None:
    """The start led to one row of the table along the straight line between their inputs."""
    solver = model.compiled.solver
    way = InputPath(origin=model.start_inputs, rate=path.at(t) - model.start_inputs)
    first = node_at(solver, way, 0.0, start.v)
    nodes, end = follow(solver, way, first, 1.0, 1.0)
    if end is not None:
        return None
    entered = certify and way_is_proved(solver, way, [first, *nodes])
    return node_at(solver, path, t, nodes[-1].v), entered


def _without_start(model: Model, start: Start) -> Motion:
    rows = SolvedRows.blank(model.everyday_rows, model.compiled.solver.variables, Status.NO_START)
    nothing_added = np.zeros(len(rows), dtype=bool)
    motion = motion_of_rows(model, rows, start.message, added=nothing_added)
    return replace(motion, failure=start.failure)
