"""A mechanism's own quantities from its solved variables, as arrays of any one shape."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.expression.derivatives import Jet, evaluate
from linkwork.core.expression.tree import names_in
from linkwork.core.foundation.arrays import (
    UNIT_ROUNDOFF,
    Array,
    BoolArray,
    ComplexArray,
    ComputedDict,
    IndexArray,
)
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.motion.model import Model, largest_misfits, leading_input
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.branch_tracking import InputPath, Node, Track, rows_of_nodes
from linkwork.core.numerics.newton import SolvedRows
from linkwork.core.numerics.path_proof import prove_path
from linkwork.core.numerics.position_proof import rounding_of_inputs
from linkwork.core.results.failure import Failure
from linkwork.core.results.position import Certificate, NewtonTrail, Position
from linkwork.core.results.quantities.definition import Group
from linkwork.core.results.quantities.registry import row_quantity
from linkwork.core.results.quantity import Kind
from linkwork.core.results.tables import Series


class LastAxis:
    """Numbers that are asked for as the last axis of an array."""

    def __init__(self, numbers: Sequence[Any]) -> None:
        self.numbers = numbers

    def __getitem__(self, index: tuple[Any, int]) -> Any:
        return self.numbers[index[-1]]


class QuantityValues(ABC):
    """Quantities of the positions whose variables a subclass gives, shape S.

    Parameters
    ----------
    model : Model
    lost : S
        Where there is no position.
    still : S
        The rate of parts that do not move: 0, NaN where there is no position.
    link_constants : (…, links)
        Constants that links add to their variables [rad], in the order of the equations.
    dimensions : (…, dimensions)
        Named numbers in the order of the equations; leading axes as the last ones of S.
    """

    def __init__(
        self, model: Model, lost: BoolArray, still: Array, link_constants: Array, dimensions: Array
    ) -> None:
        self.model, self.equations, self.lost, self.still = model, model.equations, lost, still
        self.link_constants, self.dimensions = link_constants, dimensions
        self.names = {variable.name: variable for variable in self.equations.variables}

    @abstractmethod
    def variable(self, symbol: str) -> Jet:
        """A variable by its symbol, internal units."""

    @abstractmethod
    def place(self, point: str) -> Jet:
        """A point by its exact name."""

    def own(self, name: str) -> Jet:
        """A quantity by its exact name: file units, derivatives in radians and lengths."""
        asked = self.model.motion_quantities.own[name]
        match asked.group:
            case Group.LINK:
                jet = self._link(name)
            case Group.SLIDER:
                jet = self.variable(canonical(self.equations.sliders[name]))
            case Group.OUTPUT:
                return self._output(name)
            case Group.COORDINATE:
                return self._coordinate(name)
            case _:
                jet = self.variable(self.names[name].symbol)
        return Jet(jet.v / self.model.units.scale(asked.own.kind), jet.d1, jet.d2)

    def _link(self, name: str) -> Jet:
        angle = self.equations.links[name]
        number = list(self.equations.links).index(name)
        blank = np.where(self.lost, np.nan, 0.0)
        constant = Jet(blank + self.link_constants[..., number], self.still, self.still)
        if angle.variable is None:
            return constant
        return self.variable(canonical(angle.variable)) + constant

    def _coordinate(self, name: str) -> Jet:
        point, _, axis = name.rpartition(".")
        place = self.place(point)
        parts = (place.v, place.d1, place.d2)
        return Jet(*(part.real if axis == "x" else part.imag for part in parts))

    def _output(self, name: str) -> Jet:
        """Formulas see and give file units; derivatives of angles come back in radians."""
        output = self.equations.outputs[name]
        scale = self.model.units.scale(Kind(output.kind))
        with np.errstate(all="ignore"):
            jet = evaluate(output.formula, self._known(name), self.equations.angle)
        v, d1, d2 = (
            np.where(self.lost, np.nan, np.broadcast_to(part, self.lost.shape))
            for part in (jet.v, jet.d1 * scale, jet.d2 * scale)
        )
        return Jet(v, d1, d2)

    def _known(self, name: str) -> Mapping[str, Jet]:
        """The values of an output's names: dimensions, variables, links, coordinates, …"""
        equations = self.equations
        used = {node.name for node in names_in(equations.outputs[name].formula)}
        zero = np.zeros(())
        found = {
            own: Jet(self.dimensions[..., k], zero, zero)
            for k, own in enumerate(equations.dimensions)
            if own in used
        }
        for variable in equations.variables:
            if variable.symbol in used:
                jet = self.variable(variable.symbol)
                found[variable.symbol] = self._in_file_units(jet, Kind(variable.kind))
        for link in equations.links:
            if canonical(link) in used and canonical(link) not in found:
                found[canonical(link)] = self._in_file_units(self._link(link), Kind.ANGLE)
        for point in equations.points:
            for axis in "xy":
                symbol = coordinate_name(point, axis)
                if symbol in used:
                    found[symbol] = self._coordinate(f"{point}.{axis}")
        for symbol in used - set(found):
            if row_quantity(symbol) is not None:
                asked = self.model.quantities.find(symbol)
                jet, scale = asked.jet(self), self.model.units.scale(asked.own.kind)
                found[symbol] = Jet(jet.v, jet.d1 / scale, jet.d2 / scale)
        return found

    def _in_file_units(self, jet: Jet, kind: Kind) -> Jet:
        scale = 1.0 / self.model.units.scale(kind)
        return Jet(jet.v * scale, jet.d1 * scale, jet.d2 * scale)


def term_jet(c: Any, length: Jet, turn: Jet | None) -> Jet:
    """c s e^{iψ} with both derivatives, for numbers of any kind.

    Parameters
    ----------
    c : complex
    length : Jet
        s, or the constant 1.
    turn : Jet, optional
        ψ; ``None`` for a fixed direction.
    """
    angle = Jet.constant(0.0) if turn is None else turn
    if turn is not None:
        c = c * (np.cos(angle.v) + 1j * np.sin(angle.v))  # eq. (1)
    first = length.d1 + 1j * (length.v * angle.d1)  # derivative of eq. (1)
    # eq. (3) with a = b
    second = length.d2 - length.v * (angle.d1 * angle.d1)
    second = second + 1j * (2.0 * (length.d1 * angle.d1) + length.v * angle.d2)
    return Jet(c * length.v, c * first, c * second)


# ----------------------------------------------------------------------
# The quantities of the rows of a motion by name, in the units of its file.


@dataclass(frozen=True, kw_only=True)
class Named:
    """All quantities of a batch of positions by name; each is computed when it is asked for."""

    inputs: dict[str, Array]
    unknowns: Mapping[str, Series]
    links: Mapping[str, Series]
    sliders: Mapping[str, Series]
    points: Mapping[str, tuple[Series, Series]]
    outputs: Mapping[str, Series]

    def find(self, name: str) -> Series:
        """A variable or output by its name, or a coordinate of a point."""
        for table in (self.unknowns, self.links, self.sliders, self.outputs):
            if name in table:
                return table[name]
        point, _, axis = name.rpartition(".")
        return self.points[point][axis == "y"]


class RowValues(QuantityValues):
    """Quantities of B rows; rows that were not found are NaN.

    Parameters
    ----------
    v, first, second : (B, N)
        Variables with their derivatives by the leading input, internal units.
    found : (B,)
    """

    def __init__(
        self, model: Model, v: Array, first: Array, second: Array, found: BoolArray
    ) -> None:
        lost = ~found
        angles = np.array([angle.constant for angle in model.equations.links.values()])
        numbers = np.array(list(model.equations.dimensions.values()), dtype=float)
        super().__init__(model, lost, np.where(lost, np.nan, 0.0), angles, numbers)
        self.columns = [np.where(lost[:, None], np.nan, part) for part in (v, first, second)]
        self.number = {x.symbol: k for k, x in enumerate(self.equations.variables)}

    def variable(self, symbol: str) -> Jet:
        """A variable by its symbol, internal units, (B,)."""
        k = self.number[symbol]
        return Jet(*(part[:, k] for part in self.columns))

    def place(self, point: str) -> Jet:
        """A point by its exact name, (B,)."""
        number, parts = self._places
        return Jet(*(part[:, number[point]] for part in parts))

    @cached_property
    def _places(self) -> tuple[dict[str, int], tuple[ComplexArray, ...]]:
        """All points at once, which takes little longer than one: numbers, (B, points) each."""
        table = self.model.compiled.points
        return {name: k for k, name in enumerate(table.names)}, table.jet(*self.columns)

    def series(self, name: str) -> Series:
        """A quantity of every row by its name.

        Raises
        ------
        UnknownNameError
            With the nearest names.
        """
        asked = self.model.quantities.find(name)
        jet = asked.jet(self)
        return Series(quantity=asked.own, value=jet.v, first=jet.d1, second=jet.d2)


def name_series(
    model: Model,
    v: Array,
    first: Array,
    second: Array,
    inputs: Array,
    found: BoolArray,
) -> Named:
    """Name the columns of a batch; rows that were not found become NaN.

    Parameters
    ----------
    v, first, second : (B, N)
        Variables with their derivatives by the leading input, internal units.
    inputs : (B, p)
        The input values asked for, file units (they may differ from ``v`` by whole turns).
    """
    values = RowValues(model, v, first, second, found)
    names = model.quantities.names
    columns = enumerate(model.equations.inputs)
    return Named(
        inputs={variable.name: inputs[:, k] for k, variable in columns},
        unknowns=ComputedDict(names.unknowns, values.series),
        links=ComputedDict(names.links, values.series),
        sliders=ComputedDict(names.sliders, values.series),
        points=ComputedDict(
            names.points, lambda name: (values.series(f"{name}.x"), values.series(f"{name}.y"))
        ),
        outputs=ComputedDict(names.outputs, values.series),
    )


# ----------------------------------------------------------------------
# Certificates of solved rows: the position, and the motion from the start to it.


_FAR_FROM_SINGULAR = 1e5  # condition up to which a track's nodes must be proved
_TURN = 1e-9  # rad: an input this near to whole turns from the input asked for is the same one


def prove_rows(
    solver: BlockSolver,
    path: InputPath,
    track: Track,
    rows: SolvedRows,
    asked: Array,
) -> tuple[SolvedRows, bool]:
    """Prove rows solved along a track for the inputs ``asked`` (B, p).

    The rows and the track's nodes around them are sorted along the path; every position and every
    step between neighbours is proved, and a row is certified if proved steps join it to the
    track's start.

    Returns
    -------
    rows, up_to_ends
        The rows with ``certification``, ``radius`` and ``uniqueness_radius``; whether the track
        itself is proved up to both ends.
    """
    found = np.flatnonzero(rows.status == Status.CONVERGED.code)
    if not len(found):
        return unproved(rows, Certification.NO_POSITION), True
    nodes = nodes_around(track, rows.t[found])
    points, place = _path_points(solver, [track.nodes[k] for k in nodes], rows, asked, found)
    anchor = int(place[nodes.index(track.start)])
    proof = prove_path(solver, path, points, anchor=anchor)
    joined = proof.connected_to(anchor)
    mine = place[len(nodes) :]
    position = proof.position.holds[mine]
    certification = np.select(
        [joined[mine], ~position, proof.given_up_before(anchor)[mine]],
        [
            Certification.CERTIFIED.code,
            Certification.POSITION_NOT_PROVED.code,
            Certification.PROOF_TOO_LONG.code,
        ],
        default=Certification.MOTION_NOT_PROVED.code,
    )
    proved = unproved(rows, Certification.NO_POSITION).set(
        found,
        certification=certification,
        radius=np.where(position, proof.position.radius[mine], np.nan),
        uniqueness_radius=np.where(position, proof.position.least_uniqueness_radius[mine], np.nan),
    )
    return proved, bool(joined[place[: len(nodes)]].all())


def unproved(rows: SolvedRows, why: Certification) -> SolvedRows:
    """The rows without proofs, all for one reason."""
    unknown = np.full(len(rows), np.nan)
    code = np.full(len(rows), why.code, dtype=np.int8)
    return rows.with_columns(certification=code, radius=unknown, uniqueness_radius=unknown)


def nodes_around(track: Track, t: Array) -> list[int]:
    """The numbers of the nodes between the start and all rows, and of those that can be proved."""
    begin = track.nodes[track.start].t
    low, high = min(begin, float(t.min())), max(begin, float(t.max()))
    return [
        k
        for k, node in enumerate(track.nodes)
        # nodes beyond the rows are proved too where that is easy, so that ends can be certified
        if low <= node.t <= high or node.nearness < _FAR_FROM_SINGULAR
    ]


def _path_points(
    solver: BlockSolver, nodes: Sequence[Node], rows: SolvedRows, asked: Array, found: IndexArray
) -> tuple[SolvedRows, IndexArray]:
    """Nodes and rows sorted along the path; the place of each of them, the nodes first."""
    apart = inputs_apart(rows.v[found][:, solver.unknowns :], asked[found])
    points = SolvedRows.concatenate(
        [_points_of(solver, nodes), rows.take(found).with_columns(input_radius=apart)]
    )
    order = np.argsort(points.t, kind="stable")
    place = np.empty(len(order), dtype=np.intp)
    place[order] = np.arange(len(order))
    return points.take(order), place


def _points_of(solver: BlockSolver, nodes: Sequence[Node]) -> SolvedRows:
    points = rows_of_nodes(nodes)
    return points.with_columns(input_radius=rounding_of_inputs(points.v, solver.unknowns))


def way_is_proved(solver: BlockSolver, path: InputPath, nodes: Sequence[Node]) -> bool:
    """Whether every position and every step of a track is proved."""
    points = _points_of(solver, nodes)
    return bool(prove_path(solver, path, points, anchor=0).connected_to(0).all())


def inputs_apart(inputs: Array, asked: Array) -> Array:
    """How far the intended inputs may be from given ones, modulo whole turns, (B, p).

    From the conversion of units, the rounding of a straight line, and 2π, which is no float.
    """
    gap = np.abs(inputs - asked)
    turns = np.round(gap / (2.0 * np.pi))
    rest = np.abs(gap - turns * (2.0 * np.pi)) + UNIT_ROUNDOFF * 2.0 * (
        np.abs(inputs) + np.abs(asked)
    )
    # a gap that is no whole turn counts in full
    turned = (turns > 0) & (rest < _TURN)
    apart: Array = rounding_of_inputs(inputs, 0) + np.where(turned, rest, gap)
    return apart


# ----------------------------------------------------------------------
# Rows of a solved batch as positions with their evidence.


_HOPELESS = 1e12  # condition beyond which derivatives mean nothing
_SINGULAR = (
    "position found at a dead point or change point, where its derivatives do not exist and no "
    "motion can start"
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Evidence:
    """How a position was found, or why not."""

    status: Status
    message: str
    residual: float
    iterations: int
    condition: float
    certificate: Certificate
    trails: tuple[NewtonTrail, ...] = ()
    configuration: str = ""
    failure: Failure | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class SolvedPosition:
    """A position, found or not according to ``status``: variables v (N,) and evidence.

    ``first`` (N,): derivatives at a dead point or change point, NaN where there are none.
    """

    v: Array
    status: Status
    residual: float
    iterations: int
    certificate: Certificate
    first: Array | None = None


def found_message(status: Status, condition: float, failure: Failure | None = None) -> str:
    """The sentence for a status, its explanation, or that of a position too near to singular."""
    # such a position counts as found, but its derivatives are noise
    if status.ok and condition > _HOPELESS:
        return _SINGULAR
    return status.value if failure is None else failure.message


def target_values(model: Model, at: float | Mapping[str, float] | None) -> Array:
    """The input values asked for, in file units, (p,); the guess's own for ``None``.

    Raises
    ------
    UnknownNameError, InputError
        For input values that do not fit the mechanism.
    """
    if at is None:
        return model.start_in_file_units
    if not isinstance(at, Mapping):
        inputs = model.equations.inputs
        at = {inputs[0].name if len(inputs) == 1 else "": at}
    return model.input_values(dict(at))


def input_rate(model: Model) -> Array:
    """How all inputs move by the leading one, (p,)."""
    rows = model.rows if model.description.inputs else np.zeros((1, 0))
    return leading_input(rows)[1]


def position_of(model: Model, named: Named, row: int, evidence: Evidence, q: Array) -> Position:
    """One row of named quantities as a position; ``q`` (n,) in internal units."""
    axes = [f"{point}.{axis}" for point in named.points for axis in "xy"]
    names = [*named.unknowns, *named.links, *named.sliders, *named.outputs, *axes]

    def of_row(number: Callable[[Series], Any]) -> ComputedDict[str, Any]:
        """A number of every quantity, computed when it is asked for."""
        return ComputedDict(names, lambda name: number(named.find(name)))

    def place(point: str) -> tuple[float, float]:
        x, y = named.points[point]
        return float(x.value[row]), float(y.value[row])

    first = of_row(lambda series: float(series.first[row]))
    second = of_row(lambda series: float(series.second[row]))
    speed = model.speed
    return Position(
        mechanism=model.description.name,
        units=model.units,
        skeleton=model.skeleton,
        quantities=model.quantities,
        status=evidence.status,
        message=evidence.message,
        input={name: float(value[row]) for name, value in named.inputs.items()},
        input_units=model.input_units,
        derivative_unit=model.derivative_unit,
        unknowns=_values(named.unknowns, row),
        links=_values(named.links, row),
        sliders=_values(named.sliders, row),
        points=ComputedDict(named.points, place),
        outputs=_values(named.outputs, row),
        value_units=of_row(lambda series: model.units.of(series.quantity.kind)),
        first=first,
        second=second,
        velocity={} if speed is None else of_row(lambda s: float(s.first[row]) * speed),
        acceleration={} if speed is None else of_row(lambda s: float(s.second[row]) * speed**2),
        speed=speed,
        residual=evidence.residual,
        iterations=evidence.iterations,
        condition=evidence.condition,
        certificate=evidence.certificate,
        configuration=evidence.configuration,
        q=q,
        steps=evidence.trails,
        failure=evidence.failure,
        redundant=_misfits(model, q),
    )


def _misfits(model: Model, q: Array) -> dict[str, float]:
    """How far redundant links are from their lengths; none where there is no position."""
    if not model.equations.redundant or np.isnan(q).any():
        return {}
    return largest_misfits(model.equations, q[None, :])


def _values(table: Mapping[str, Series], row: int) -> Mapping[str, float]:
    return ComputedDict(table, lambda name: float(table[name].value[row]))
