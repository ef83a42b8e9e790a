"""All circuits of a mechanism, seeded from its configurations between dead points."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.foundation.deferred import Deferred
from linkwork.foundation.disjoint_sets import DisjointSets
from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import canonical
from linkwork.foundation.rounding import REGULAR_CONDITION
from linkwork.foundation.short_number import short_number
from linkwork.foundation.status import Status
from linkwork.foundation.value_types import check_flags
from linkwork.motion import failure as why
from linkwork.motion.circuit.arcs import Arc, Explorer, positions_at_value
from linkwork.motion.circuit.seeding import Seeding
from linkwork.motion.circuit.walks import Walks
from linkwork.motion.circuit.weakest import weakest_place
from linkwork.motion.curve_branches import CurveBranch
from linkwork.motion.drive import Drive
from linkwork.motion.limits import change_point_limit, dead_point_limit
from linkwork.motion.model import Model
from linkwork.motion.motion_of_rows import motion_of_rows
from linkwork.numerics.continuation.change_point import Crossing
from linkwork.numerics.continuation.local_parametrization import same_position
from linkwork.numerics.rows import SolvedRows
from linkwork.results.circuits import Branch, Circuit, Circuits
from linkwork.results.failure import Failure
from linkwork.results.motion import Motion

__all__ = ["branch_start", "circuits", "is_branch_name"]


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
        self.explorer = Explorer(Walks(drive, certify))
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
        return why.without_circuit(self.model, start.v)

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
