"""Seeds of circuits: configurations at inputs that every circuit must pass."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork import wings
from linkwork.circuits.arcs import Arc, Explorer, is_regular, positions_at_value
from linkwork.circuits.assembling import Assemblies, positions_at
from linkwork.circuits.branches import CurveBranch, weakest_place
from linkwork.circuits.dead_inputs import (
    DeadPointInputs,
    Interval,
    dead_point_inputs,
    intervals_between,
)
from linkwork.circuits.results import Branch, Circuit, Circuits
from linkwork.core.foundation.arrays import Array, DisjointSets
from linkwork.core.foundation.containers import Deferred
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import canonical, short_number
from linkwork.core.foundation.rounding import REGULAR_CONDITION
from linkwork.core.foundation.statuses import Certification, CircuitEnd, Completeness, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.foundation.values import check_flags
from linkwork.core.motion.following import Drive
from linkwork.core.motion.limits import change_point_limit, dead_point_limit
from linkwork.core.motion.model import Model
from linkwork.core.motion.rows_between import motion_of_rows
from linkwork.core.motion.solving import Start, first_position
from linkwork.core.numerics.branch_tracking import TrackOptions
from linkwork.core.numerics.change_point import Crossing
from linkwork.core.numerics.local_parametrization import same_position
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.numerics.system import SolvedRows
from linkwork.core.results.failure import Failure
from linkwork.core.results.motion import Motion

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

    def look(self, progress: Callable[[float], None] | None) -> None:
        """Seed with the guess, the configurations at its input, and those between dead points."""
        model = self.model
        start = self.start = first_position(model, model.start_inputs, NewtonOptions())
        # at a dead point the input cannot lead; the circuit is found from other inputs
        most = TrackOptions().largest_condition
        if start.status.ok and is_regular(self.drive.leads, start.v, most):
            self.explorer.visit(start.v)
        value = float(model.start_inputs[self.drive.lead])
        found = self._positions_at(value)
        if found.completeness is Completeness.NOT_LISTED:
            return
        self.names = list(zip(found.v, found.names, strict=True))
        sure = self._visit_circuits(found)
        self.dead = dead_point_inputs(model, self.drive.path, self.drive.lead)
        intervals = self._intervals(value, sure)
        for k, interval in enumerate(intervals):
            # another value where the list of one fails
            self.unclear += not any(
                self._visit_circuits(self._positions_at(value)) for value in interval
            )
            if progress is not None:
                progress((k + 1) / len(intervals))

    def _positions_at(self, value: float) -> Assemblies:
        """All configurations at a value of the leading input."""
        return positions_at(self.model, self.drive.path.at(value))

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

    def _visit_circuits(self, found: Assemblies) -> bool:
        """Follow the circuits of all configurations; whether none is missing or left out."""
        regular = [is_regular(self.drive.leads, v) for v in found.v]
        for v, good in zip(found.v, regular, strict=True):
            if good:
                self.explorer.visit(v)
        self.seeded += 1
        return found.completeness.complete and all(regular)

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


# ----------------------------------------------------------------------
# All circuits of a mechanism, seeded from its configurations between dead points.


def circuits(
    model: Model,
    *,
    certify: bool = True,
    progress: Callable[[float], None] | None = None,
) -> Circuits:
    """Every circuit as a proved curve, with its branches.

    All configurations at the guess's own input and between any two neighbouring dead points are
    listed; through each that lies on no circuit yet the curve of positions is followed in both
    directions, through dead points, and at change points into every branch. Where dead points may
    be missing from their list, further inputs are looked at.

    Raises
    ------
    InputError
        If the mechanism has no input, or several that time drives.
    """
    check_flags(progress, certify=certify)
    work = _Circuits(Drive.of_circuits(model), certify)
    work.seeding.look(progress)
    return work.result()


@dataclass(frozen=True, kw_only=True, eq=False)
class _Group:
    """Arcs that change points join."""

    arcs: tuple[Arc, ...]
    crossings: tuple[Crossing, ...]


class _Circuits:
    def __init__(self, drive: Drive, certify: bool) -> None:
        self.drive, self.leads, self.model, self.certify = drive, drive.leads, drive.model, certify
        self.explorer = Explorer(drive, certify)
        self.seeding = Seeding(drive, self.explorer)

    def result(self) -> Circuits:
        """Circuits in the order found: that of the guess first."""
        found = [
            self._circuit(f"circuit {number}", group)
            for number, group in enumerate(self._groups(), start=1)
        ]
        name = self.model.equations.inputs[self.drive.lead].name
        grade, message = self.seeding.completeness()
        return Circuits(
            mechanism=self.model.description.name,
            circuits=tuple(found),
            completeness=grade,
            message=message,
            input=name,
            input_unit=self.model.input_units[name],
            seeded=self.seeding.seeded,
            failure=None if found else self._failure(),
        )

    def _failure(self) -> Failure | None:
        """Why no circuit could be found, as far as the position of the guess shows."""
        start = self.seeding.start
        if start is None or not start.status.ok:
            return None if start is None else start.failure
        return wings.use("circuits.failure.failing").without_circuit(self.model, start.v)

    def _groups(self) -> list[_Group]:
        """Arcs joined by the change points they share, in the order found."""
        explorer = self.explorer
        arcs, crossings = [a for a in explorer.arcs if explorer.fits(a)], explorer.crossings
        joined = DisjointSets(len(arcs))
        first: dict[int, int] = {}
        for k, arc in enumerate(arcs):
            for crossing in arc.crossings:
                joined.unite(k, first.setdefault(crossing, k))
        groups: dict[int, list[int]] = {}
        for k in range(len(arcs)):
            groups.setdefault(joined.root(k), []).append(k)
        return [
            _Group(
                arcs=tuple(arcs[k] for k in members),
                crossings=tuple(
                    crossings[c] for c in sorted({c for k in members for c in arcs[k].crossings})
                ),
            )
            for members in groups.values()
        ]

    def _circuit(self, name: str, group: _Group) -> Circuit:
        scale = self.drive.unit
        pieces = [(arc, branch) for arc in group.arcs for branch in arc.branches]
        branches = [branch for _, branch in pieces]
        named = tuple(
            self._branch(f"{name} branch {number}", arc, branch)
            for number, (arc, branch) in enumerate(pieces, start=1)
        )
        ranges = np.array([branch.range(self.leads.parameter) for branch in branches]) / scale
        turns = [turn for arc in group.arcs for walk in arc.walks for turn in walk.turns]
        end = _end_of(group)
        limits = [limit.v for limit in turns] + [limit.v for limit in group.crossings]
        solved = Deferred(
            lambda: [b for arc in group.arcs for b in self.explorer.solved_branches(arc)]
        )
        around = self._around(group) if end.closed else None
        return Circuit(
            name=name,
            end=end,
            certified=all(arc.certified for arc in group.arcs),
            input_range=(
                short_number(float(ranges[:, 0].min())),
                short_number(float(ranges[:, 1].max())),
            ),
            turns=self._turns(around),
            turning={} if around is None else self._turning(around),
            branches=named,
            dead_points=tuple(dead_point_limit(self.drive, turn) for turn in turns),
            change_points=tuple(
                change_point_limit(self.drive, crossing) for crossing in group.crossings
            ),
            weakness=Deferred(lambda: self._weakness(limits, solved.value)),
            course=Deferred(lambda: self._motion(solved.value, named)),
        )

    def _weakness(
        self, limits: Sequence[Array], branches: Sequence[CurveBranch]
    ) -> tuple[float, float]:
        """The smallest singular value, and the input there in file units."""
        singular, v = (0.0, limits[0]) if limits else weakest_place(self.leads, branches)
        return singular, float(v[self.leads.parameter] / self.drive.unit)

    def _branch(self, name: str, arc: Arc, branch: CurveBranch) -> Branch:
        low, high = branch.range(self.leads.parameter)
        scale = self.drive.unit
        return Branch(
            name=name,
            input_range=(short_number(low / scale), short_number(high / scale)),
            configuration=self._configuration_on(branch),
            certified=arc.certified,
            end=arc.end,
        )

    def _configuration_on(self, branch: CurveBranch) -> str:
        """The first of the configurations at the guess's input that lies on a branch."""
        value = float(self.model.start_inputs[self.drive.lead])
        for here in positions_at_value(self.leads, branch, value):
            for v, name in self.seeding.names:
                if same_position(self.leads, here, v):
                    return name
        return ""

    def _around(self, group: _Group) -> Array:
        legs = group.arcs[0].up.curve.legs
        change: Array = legs[-1].v[-1] - legs[0].v[0]
        return change

    def _turns(self, around: Array | None) -> int | None:
        p = self.leads.parameter
        if around is None or not self.leads.is_angle[p]:
            return None
        return abs(round(float(around[p]) / FULL_TURN))

    def _turning(self, around: Array) -> dict[str, int]:
        """Whole turns of the links, for one turn of the input in its positive direction."""
        equations = self.model.equations
        sign = -1.0 if around[self.leads.parameter] < 0.0 else 1.0
        number = {v.symbol: k for k, v in enumerate(equations.variables)}
        angles = {v.name: k for k, v in enumerate(equations.variables) if v.kind == "angle"}
        links = {
            link: number[angle.variable]
            for link, angle in equations.links.items()
            if angle.variable is not None
        }
        return {
            name: round(sign * float(around[k]) / FULL_TURN)
            for name, k in (links or angles).items()
        }

    def _motion(self, pieces: Sequence[CurveBranch], names: Sequence[Branch]) -> Motion:
        model, solver = self.model, self.model.compiled.solver
        v = np.concatenate([branch.v for branch in pieces])
        inputs = v[:, solver.unknowns :] / model.input_scale
        rates = solver.rates(v, self.drive.path.rate)
        singular = ~(rates.nearness < REGULAR_CONDITION)
        rates = rates.set(singular, first=np.nan, second=np.nan)
        rates = rates.with_columns(residual=solver.residual(v))
        blank = SolvedRows.blank(inputs, solver.variables, Status.CONVERGED)
        rows, begin = blank.put(np.arange(len(v)), rates), 0
        for branch, named in zip(pieces, names, strict=True):
            here = slice(begin, begin + len(branch.v))
            begin += len(branch.v)
            code = Certification.CERTIFIED if named.certified else Certification.MOTION_NOT_PROVED
            code = code if self.certify else Certification.NOT_ASKED
            limits = np.array(branch.limits, dtype=object)
            rows = rows.set(here, branch=named.name, limit=limits, certification=code.code)
        return motion_of_rows(model, rows, "", np.zeros(len(v), dtype=bool))


def _end_of(group: _Group) -> CircuitEnd:
    """Of all arcs that which leaves most open; change points where arcs only meet others."""
    ends = [arc.end for arc in group.arcs]
    if group.crossings and all(
        end in (CircuitEnd.CLOSED, CircuitEnd.CHANGE_POINT, CircuitEnd.INPUT_CONSTANT)
        for end in ends
    ):
        return CircuitEnd.CHANGE_POINT
    return max(ends, key=list(CircuitEnd).index)


def is_branch_name(name: str) -> bool:
    """Whether a name is one of a circuit or of a branch."""
    return re.fullmatch(r"circuit \d+( branch \d+)?", canonical(name)) is not None


def branch_start(model: Model, name: str) -> Model:
    """The model with a position on a named circuit or branch as its guess.

    At the guess's input value if the branch passes it, else where the input leads best.

    Raises
    ------
    UnknownNameError
        With the names that exist.
    """
    work = _Circuits(Drive.along_table(model), False)
    work.seeding.look(None)
    known: dict[str, CurveBranch] = {}
    for number, group in enumerate(work._groups(), start=1):
        pieces = [branch for arc in group.arcs for branch in arc.branches]
        known[f"circuit {number}"] = pieces[0]
        for k, branch in enumerate(pieces, start=1):
            known[f"circuit {number} branch {k}"] = branch
    if name not in known:
        names = [key for key in known if "branch" in key]
        raise UnknownNameError(
            f'there is no "{name}" of {model.description.name} {choices("branches", names, name)}'
        )
    branch = known[name]
    here = positions_at_value(work.leads, branch, float(model.start_inputs[work.drive.lead]))
    if not here and branch.ratio == 0.0:
        raise InputError(f'the input is at rest on "{name}", so no motion can start there')
    start = here[0] if here else branch.anchor
    equations = replace(model.equations, start=start)
    return replace(
        model, equations=equations, branch=name if "branch" in name else f"{name} branch 1"
    )
