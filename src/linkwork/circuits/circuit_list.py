"""Functions of a mechanism's kinematic chain."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from linkwork import wings
from linkwork.circuits import inverting
from linkwork.circuits.arcs import Arc, Explorer, is_regular, positions_at_value
from linkwork.circuits.assembling import Assemblies, positions_at
from linkwork.circuits.branches import CurveBranch, weakest_place
from linkwork.circuits.dead_inputs import (
    DeadPointInputs,
    Interval,
    dead_point_inputs,
    intervals_between,
)
from linkwork.circuits.failure import remedies
from linkwork.circuits.homotopy.isolated_roots import SEED
from linkwork.circuits.results import (
    Branch,
    Circuit,
    Circuits,
    Configurations,
    PathCount,
    solution_counts,
)
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.arrays import REGULAR_CONDITION, Array, Deferred, DisjointSets
from linkwork.core.foundation.errors import InputError, NotConvergedError, UnknownNameError, choices
from linkwork.core.foundation.names import canonical, short_number
from linkwork.core.foundation.statuses import Certification, CircuitEnd, Completeness, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.foundation.values import check_flags
from linkwork.core.motion.branch_rows import motion_of_rows
from linkwork.core.motion.following import Drive
from linkwork.core.motion.limits import change_point_limit, dead_point_limit
from linkwork.core.motion.model import Model, without_redundant
from linkwork.core.motion.positions import (
    Evidence,
    found_message,
    input_rate,
    name_series,
    position_of,
    target_values,
)
from linkwork.core.motion.solving import Start, failed_position, first_position, solve
from linkwork.core.numerics.branch_tracking import TrackOptions, same_position
from linkwork.core.numerics.change_point import Crossing
from linkwork.core.numerics.newton import NewtonOptions, SolvedRows
from linkwork.core.results.check import Inversion
from linkwork.core.results.failure import Failure
from linkwork.core.results.listing import (
    Column,
    Row,
    listed_links,
    redundant_lines,
    short,
    value_cells,
)
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Certificate, NearestAssembly, Position
from linkwork.core.results.quantity import Kind


def inversions(mechanism: Mechanism) -> tuple[Inversion, ...]:
    """All inversions of the chain, each with its type.

    Examples
    --------
    >>> import linkwork as lw
    >>> found = lw.circuits.inversions(lw.example("four-bar"))
    >>> [inversion.type.split(":")[0] for inversion in found][:2]
    ['crank-rocker (GCRR)', 'double-crank (GCCC)']
    """
    return inverting.inversions(mechanism.model)


def nearest_assembly(
    mechanism: Mechanism, at: float | Mapping[str, float] | None = None
) -> NearestAssembly:
    """The position nearest to closure, for a mechanism that does not close.

    Parameters
    ----------
    at : number or Mapping[str, number], optional
        Input value(s) in file units; by default those of the guess.

    Examples
    --------
    >>> import linkwork as lw
    >>> short = lw.example("four-bar").with_dimensions({"A B": 50})
    >>> round(lw.circuits.nearest_assembly(short, at=180).gap, 1)  # mm
    10.0
    """
    return remedies.nearest_assembly(mechanism.model, at)


# ----------------------------------------------------------------------
# Seeds of circuits: configurations at inputs that every circuit must pass.


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


# ----------------------------------------------------------------------
# Circuits as columns and sentences.


def branch_columns(found: Circuits, circuit: Circuit, digits: int = 10) -> list[Column]:
    """The range of every branch of a circuit."""
    unit = f" [{found.input_unit}]" if found.input_unit else ""
    branches = circuit.branches
    names = [branch.name.removeprefix(f"{circuit.name} ") for branch in branches]
    low, high = ([short(b.input_range[k], digits) for b in branches] for k in range(2))
    configurations = [branch.configuration or "-" for branch in branches]
    return [
        Column(header=circuit.name, cells=names),
        Column(header=f"from {found.input}{unit}", cells=low, align="point"),
        Column(header="to", cells=high, align="point"),
        Column(header="at the guess's input", cells=configurations),
    ]


def circuit_fields(found: Circuits, circuit: Circuit) -> Iterator[tuple[str, str]]:
    """How a circuit ends, which links turn, its limits."""
    proof = "proved" if circuit.certified else "not proved"
    redundant = circuit.motion.redundant
    if redundant and circuit.certified:
        proof += f" without {listed_links(redundant)}"
    yield ("closed" if circuit.closed else "not closed"), f"{circuit.end.explanation}; {proof}"
    if circuit.closed:
        yield from _turning(circuit)
    resting = [
        branch.name.removeprefix(f"{circuit.name} ")
        for branch in circuit.branches
        if branch.end is CircuitEnd.INPUT_CONSTANT
    ]
    if resting:
        yield "input at rest", f"along {', '.join(resting)} {CircuitEnd.INPUT_CONSTANT.explanation}"
    for limit in (*circuit.dead_points, *circuit.change_points):
        yield limit.kind.word, limit.told(found.input, found.input_unit)
    yield from redundant_lines(redundant)
    dead = circuit.dead_points or circuit.change_points
    if not dead and isfinite(circuit.smallest_singular_value):  # infinite without unknowns
        where = f"{found.input} = {circuit.weakest:.3g} {found.input_unit}".rstrip()
        yield (
            "closest to a dead point",
            f"σ_min = {circuit.smallest_singular_value:.3g}, near {where}",
        )


def _turning(circuit: Circuit) -> Iterator[tuple[str, str]]:
    """Which links turn fully and which rock during one pass of the circuit."""
    if circuit.turns:
        times = "once" if circuit.turns == 1 else f"{circuit.turns} times"
        yield "input", f"turns {times} before the circuit closes"
    elif circuit.turns == 0:
        yield "input", "turns back at the dead points"
    turns = [f"{link} ({n:+d})" if abs(n) > 1 else link for link, n in circuit.turning.items() if n]
    rocks = [link for link, n in circuit.turning.items() if not n]
    if turns:
        yield "turning", ", ".join(turns)
    if rocks:
        yield "rocking", ", ".join(rocks)


# ----------------------------------------------------------------------
# Configurations as columns and sentences.


def configuration_columns(
    found: Configurations, kinds: Mapping[str, Kind], decimals: int = 6
) -> list[Column]:
    """A row for every configuration; ``kinds`` of the unknowns in order."""
    columns = [Column(header="name", cells=found.names)]
    for name, kind in kinds.items():
        if name not in found.positions[0].unknowns:
            continue  # a redundant link's length
        unit = found.positions[0].units.of(kind)
        rows = [Row(name=name, kind=kind, value=position.unknowns[name]) for position in found]
        header = f"{name} [{unit}]" if unit else name
        columns.append(Column(header=header, cells=value_cells(rows, decimals), align="point"))
    certified = [_certified(p.certificate) for p in found]
    columns.append(Column(header="certified", cells=certified))
    return columns


def completeness_fields(found: Configurations) -> Iterator[tuple[str, str]]:
    """Whether the list is complete, and the counts of solutions behind it."""
    yield "complete", found.message
    label = "paths"
    for count in found.paths:
        yield label, path_sentence(count, several=len(found.paths) > 1)
        label = ""


def path_sentence(count: PathCount, *, several: bool) -> str:
    """The counts of solutions of one block in words."""
    block = f"{', '.join(count.unknowns)}: " if several else ""
    if not count.paths:
        return f"{block}follow from the others"
    text = solution_counts(count)
    text += f", {count.multiple} multiple" if count.multiple else ""
    text += f", for {count.solved} positions of earlier blocks" if count.solved > 1 else ""
    others = [
        f"{number} {end}"
        for number, end in ((count.at_infinity, "to infinity"), (count.failed, "lost"))
        if number
    ]
    return f"{block}{text}" + (f"; {count.paths} paths: {', '.join(others)}" if others else "")


def _certified(certificate: Certificate) -> str:
    if certificate.certification is Certification.SUBSET_CERTIFIED:
        return "partly"
    return "yes" if certificate.certified else "no"


# ----------------------------------------------------------------------
# All configurations at one input value, as positions.


_NONE = "there is no configuration at this input: the loops cannot be closed"


def configurations(model: Model, at: float | Mapping[str, float] | None = None) -> Configurations:
    """All configurations at one input value, each with its certificate.

    Blocks of one loop are solved in closed form, larger ones by following the solutions of a
    random system of the same structure (:mod:`linkwork.circuits.homotopy.isolated_roots`).

    Parameters
    ----------
    at : number or Mapping[str, number], optional
        Input value(s) in file units; the guess's own if left out.

    Raises
    ------
    UnknownNameError, InputError
        For input values that do not fit the mechanism.
    """
    target = target_values(model, at)
    found = positions_at(model, target * model.input_scale)
    names = (variable.name for variable in model.equations.inputs)
    return Configurations(
        mechanism=model.description.name,
        positions=_positions(model, target, found),
        completeness=found.completeness,
        message=found.message,
        input=dict(zip(names, target.tolist(), strict=True)),
        input_units=model.input_units,
        paths=found.paths,
        seed=SEED,
    )


def _positions(model: Model, target: Array, found: Assemblies) -> tuple[Position, ...]:
    count, solver = len(found.v), model.compiled.solver
    if not count:
        return ()
    rates, proof = solver.rates(found.v, input_rate(model)), found.proof
    residual = solver.residual(found.v)
    inputs = np.repeat(target[None, :], count, axis=0)
    named = name_series(
        model, found.v, rates.first, rates.second, inputs, np.ones(count, dtype=bool)
    )
    status = Status.CONVERGED
    positions = []
    for k in range(count):
        certificate = Certificate(certification=Certification.POSITION_NOT_PROVED)
        if proof.holds[k]:
            certificate = Certificate(
                certification=without_redundant(
                    model.equations, Certification.CONFIGURATION_CERTIFIED
                ),
                radius=float(proof.radius[k]),
                unique_within=float(proof.least_uniqueness_radius[k]),
            )
        evidence = Evidence(
            status=status,
            message=found_message(status, float(rates.condition[k])),
            residual=float(residual[k]),
            iterations=int(found.iterations[k]),
            condition=float(rates.condition[k]),
            certificate=certificate,
            configuration=found.names[k],
        )
        positions.append(position_of(model, named, k, evidence, found.v[k, : solver.unknowns]))
    return tuple(positions)


def solve_configuration(
    model: Model, at: float | Mapping[str, float] | None, name: str, *, throw: bool = False
) -> Position:
    """The position at one input value in a named configuration, or on a named branch.

    Raises
    ------
    UnknownNameError, InputError
        If there is no configuration of this name at this input, or they cannot be listed.
    NotConvergedError
        Only with ``throw``: if there is no configuration at all at this input.
    """
    if is_branch_name(name):
        return solve(branch_start(model, name), at, throw=throw)
    found = configurations(model, at)
    if found.completeness is Completeness.NOT_LISTED:
        raise InputError(f"{model.description.name}: {found.message}")
    if len(found):
        return found[name]
    position = _explain_unassembled(model, target_values(model, at))
    if throw:
        raise NotConvergedError(position.message)
    return position


def _explain_unassembled(model: Model, target: Array) -> Position:
    """The message where there is no configuration: the loop that does not close, if one is known.

    Newton-Raphson is tried from the guess, as for every position; the message is that of its
    failure.
    """
    start = first_position(model, target * model.input_scale, NewtonOptions())
    if start.failure is not None:
        return failed_position(model, target, start.status, start.failure, start)
    failure = Failure(what=_NONE, units=model.units)
    return failed_position(model, target, Status.CANNOT_CLOSE, failure, start)


def start_in_configuration(model: Model, name: str) -> Model:
    """The model with a named configuration, at the guess's own input value, as its guess.

    A name such as ``circuit 1 branch 2`` takes a position on that branch instead.

    Raises
    ------
    UnknownNameError, InputError
        If there is no configuration of this name, or they cannot be listed.
    """
    if is_branch_name(name):
        return branch_start(model, name)
    found = positions_at(model, model.start_inputs)
    if found.completeness is Completeness.NOT_LISTED:
        raise InputError(f"{model.description.name}: {found.message}")
    if name not in found.names:
        raise UnknownNameError(
            f'there is no configuration "{name}" of {model.description.name} at its guess\'s '
            f"input {choices('configurations', found.names, name)}"
        )
    start = found.v[found.names.index(name)]
    return replace(model, equations=replace(model.equations, start=start), branch=name)
