"""Forces of differentiated rows: the same free bodies and virtual work, with taped numbers.

The equilibrium W r + b = 0 is solved with plain numbers; one step from its solution,
r - W⁻¹ (W r + b), then has the derivatives of the solution, with those of friction and of all that
follows from r.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.core.expression.derivatives import Jet
from linkwork.core.foundation.arrays import Array, inverses
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.lanes import is_batched
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.dimensions import Numbers
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops
from linkwork.core.mechanism.machine import LoadedBodies
from linkwork.core.motion.positions import RowValues
from linkwork.core.results.quantity import Kind
from linkwork.design.derivatives.rows import DifferentiatedRows
from linkwork.design.derivatives.tape import Tape
from linkwork.forces.reactions.drives import (
    effort_name,
    free_bodies,
    free_bodies_of,
    known_acts,
    read_bodies,
    read_first_links,
    set_down,
    work_terms,
)
from linkwork.forces.reactions.free_bodies import Act, FreeBodies
from linkwork.forces.reactions.geometry import AppliedLoads, Geometry
from linkwork.forces.reactions.parts import apply_load, join_loads, line_of
from linkwork.forces.reactions.system import NO_WORK, joint_forces, totals


class TapedGeometry(Geometry):
    """Places and rates on a tape; derivatives by each input as lists of (B,)."""

    def __init__(self, rows: DifferentiatedRows) -> None:
        super().__init__(rows.model, rows)
        self.taped = rows

    @property
    def numbers(self) -> Numbers:
        """Reads numbers and formulas of the file."""
        return self.taped.description.numbers

    def partial(self, point: str) -> Any:
        """Derivatives of a point with respect to each input; (B,) of the only one."""
        if self.alone:
            return self.place(point).d1
        return [moved.place(point).d1 for moved in self.taped.by_input]

    def turning(self, link: str) -> Any:
        """Derivatives of a link's angle with respect to each input; (B,) of the only one."""
        if self.alone:
            return self.angle(link).d1
        if link == GROUND:
            return [np.zeros(self.rows) for _ in self.model.equations.inputs]
        return [Geometry(self.model, moved).angle(link).d1 for moved in self.taped.by_input]

    def partial_local(self, link: str, place: Any) -> Any:
        """Derivatives of a point in the frame of a link with respect to each input."""
        arm = 1j * self.direction(link).v * place
        if self.alone:
            return self.partial(self.links[link][0]) + self.turning(link) * arm
        pairs = zip(self.partial(self.links[link][0]), self.turning(link), strict=True)
        return [moved + turned * arm for moved, turned in pairs]


class ReadGeometry(TapedGeometry):
    """Places of a linkage that was read from loops, by the points and terms of these."""

    def __init__(self, rows: DifferentiatedRows, nominal: FreeBodies) -> None:
        super().__init__(rows)
        self.links, self.read = nominal.linkage.links, nominal.geometry
        self.length = nominal.geometry.length  # of the unknown moments
        known = set(super().points)
        #: Points of lines that the file lacks, a unit from the other one.
        self.ends: dict[str, Any] = {}
        for slider in nominal.linkage.sliders:
            direction = _line_of(slider.name, rows)
            if direction is not None and not known.issuperset(slider.line):
                way = line_of(slider.line, nominal.geometry)
                side = np.sign((np.conj(way) * _bare(direction)).real)
                self._add_ends(slider.line, side * direction, known)
        #: The points whose places are not known.
        self.unknown = [p for p in nominal.linkage.points if p not in known.union(self.ends)]

    def kind(self, name: str) -> Kind:
        """What an input of the linkage measures."""
        return self.read.kind(name)

    def _add_ends(self, line: tuple[str, str], along: Any, known: set[str]) -> None:
        start, end = line
        if end in known:
            self.ends[start] = super().place(end).v - along
            return
        zero = np.zeros(self.rows, dtype=complex)
        first = super().place(start).v if start in known else zero
        self.ends |= {end: first + along} | ({} if start in known else {start: zero})

    def place(self, point: str) -> Jet:
        """A point of the file; of a line without points there one that gives its direction."""
        if point not in self.ends:
            return super().place(point)
        zero = np.zeros(self.rows, dtype=complex)
        return Jet(self.ends[point], zero, zero)


def _line_of(slider: str, rows: DifferentiatedRows) -> Any:
    """The unit vector along which a variable length of the loops lies on ground, on the tape."""
    symbols = {x.name: x.symbol for x in rows.equations.variables}
    for loop in rows.taped.loops:
        for term in loop.terms:
            if term.length == symbols.get(slider) and not term.phase:
                return term.value / np.abs(term.value)
    return None


class LoadedRows(DifferentiatedRows):
    """Differentiated rows with the forces of their loads; parameters as of the base class."""

    def force(self, name: str) -> Any:
        """An effort, reaction, energy or total on the tape, (B,).

        Raises
        ------
        InputError
            If its derivatives are not known.
        """
        why = self._unknown(name)
        if not why:
            with np.errstate(all="ignore"):
                for known in self._tables():
                    if name in known:
                        return known[name]
            why = "its loops do not read as links and joints"
            if isinstance(self.description, Loops) and self._read_reactions[1]:
                pin = self._read_reactions[1][0]
                why = f"the loops have a pin {pin} that is no point of the file: add it to [points]"
        raise InputError(f'the derivatives of "{name}" are not known: {why}')

    def _unknown(self, name: str) -> str:
        """Why no force, or this one, has known derivatives; "" if that is not known yet."""
        if name == "disagreement":
            return "it measures rounding"
        if self.model.untimed is not None:
            return "time drives the rows; give the input a speed instead of a law, or sample"
        if getattr(self.description, "friction", None) and len(self.equations.inputs) > 1:
            return "friction depends on the rates of several inputs; sample its tolerance"
        return ""

    def _tables(self) -> Iterator[dict[str, Any]]:
        """All quantities of forces; reactions last, for free bodies cost the most."""
        yield self._efforts
        yield self._totals
        if isinstance(self.description, Linkage):
            yield self._losses
            yield self._joints.readings()
        elif isinstance(self.description, Loops):
            yield self._read_reactions[0]

    @cached_property
    def _loads(self) -> AppliedLoads:
        """All loads; those of a linkage are those of its free bodies."""
        return self._applied(TapedGeometry(self), self.description)

    def _applied(self, geometry: Geometry, description: Description) -> AppliedLoads:
        assert isinstance(description, LoadedBodies)
        applied = AppliedLoads(geometry, 0.0 if self.speed is None else self.speed)
        applied.weigh(description)
        if isinstance(description, Linkage):
            bodies = FreeBodies(description, geometry, applied)
            join_loads(bodies)
        elif isinstance(description, Loops):
            for load in description.loads:
                apply_load(load, applied)
        return applied

    @cached_property
    def _ideal(self) -> tuple[list[Any], Array]:
        """Efforts of all inputs without friction, and the size of the largest term, (B,)."""
        efforts: list[Any] = [np.zeros(len(self.solution)) for _ in self.equations.inputs]
        largest = np.zeros(len(self.solution))
        alone = self._loads.geometry.alone
        for load, moved in work_terms(self._loads):
            for k, rate in enumerate([moved] if alone else moved):
                efforts[k] = efforts[k] - (np.conj(load) * rate).real  # eq. (71)
                largest = np.fmax(largest, np.abs(_bare(load)) * np.abs(_bare(rate)))
        return efforts, largest

    @cached_property
    def _efforts(self) -> dict[str, Any]:
        """Efforts of all inputs by virtual work, and their power."""
        inputs, efforts = self.equations.inputs, list(self._ideal[0])
        if self._rubs:
            efforts[0] = efforts[0] + self._joints.friction_effort()
        named = {effort_name(x.name): effort for x, effort in zip(inputs, efforts, strict=True)}
        if self.speed is not None:
            rates = zip(self._input_rate, efforts, strict=True)
            named["power"] = sum((rate * effort for rate, effort in rates), 0.0) * self.speed
        return named

    @property
    def _rubs(self) -> bool:
        return bool(getattr(self.description, "friction", None))

    @cached_property
    def _losses(self) -> dict[str, Any]:
        """What friction takes of the only input's power, and its effort the other way."""
        if not self._rubs:
            return {}
        (ideal,), largest = self._ideal
        joints = self._joints
        useful, lost = ideal * joints.way, joints.friction_effort() * joints.way
        # at a dead point of the loads the efficiency jumps
        works = np.abs(_bare(useful)) > NO_WORK * largest
        spent = np.where(works, useful + lost, np.nan)
        ahead = _bare(useful) >= 0.0
        losses = {"efficiency": np.where(ahead, useful / spent, spent / useful)}
        if self.speed is None:
            (name,) = (x.name for x in self.equations.inputs)
            back = self._equilibrium(-1.0).friction_effort()
            losses[f"{effort_name(name)}.backward"] = ideal + back
        else:
            losses["friction_power"] = lost * np.abs(self.speed)
        return losses

    @cached_property
    def _totals(self) -> dict[str, Any]:
        """Forces on the ground, energies and powers."""
        applied = self._loads
        return {name: value for name, _, _, value in totals(applied.geometry, applied)}

    @cached_property
    def _read_reactions(self) -> tuple[dict[str, Any], list[str]]:
        """The reactions of a linkage that was read from loops, none if they read otherwise; points
        of it that the file lacks.
        """
        plain = Geometry(self.model, self._plain)
        nominal = read_bodies(plain, self._applied(plain, self.model.description))
        if nominal is None:
            return {}, []
        geometry = ReadGeometry(self, nominal)
        applied = set_down(self._applied(TapedGeometry(self), self.description), nominal.linkage)
        if geometry.unknown or applied is None:
            return {}, geometry.unknown
        taped = free_bodies(nominal.linkage, geometry, applied)
        return _Equilibrium(taped, nominal, self.tape, 1.0).readings(), []

    @cached_property
    def _plain(self) -> RowValues:
        """The same rows with plain numbers."""
        there = np.logical_not(self.lost)
        return RowValues(self.model, self.solution, *self._rates, there)

    @cached_property
    def _joints(self) -> _Equilibrium:
        """The equilibrium of a linkage in motion, or about to move."""
        return self._equilibrium(1.0)

    def _equilibrium(self, side: float) -> _Equilibrium:
        """The equilibrium of a linkage that moves on, or back."""
        description, geometry = self.description, TapedGeometry(self)
        assert isinstance(description, Linkage)
        nominal = free_bodies_of(self.model, self._plain)
        applied = AppliedLoads(geometry, 0.0 if self.speed is None else self.speed)
        applied.weigh(description)
        taped = free_bodies(description, geometry, applied)
        return _Equilibrium(taped, nominal, self.tape, side)


class _Equilibrium:
    """The equilibrium of free bodies whose acts are on a tape, solved with plain numbers."""

    def __init__(self, bodies: FreeBodies, nominal: FreeBodies, tape: Tape, side: float) -> None:
        self.bodies, self.tape = bodies, tape
        geometry, rate = nominal.geometry, nominal.applied.rate
        #: 1 or -1: which way the leading input moves, or is about to.
        self.way = side * float(geometry.table_direction if rate == 0.0 else np.sign(rate))
        acts = known_acts(nominal)
        # plain numbers decide about friction, self-stress and lift-off
        self.solved = joint_forces(nominal, acts, np.broadcast_to(self.way, geometry.rows))
        self.acts = known_acts(bodies)
        self._solve()

    def _solve(self) -> None:
        """Unknowns, and the amounts that follow from them, on the tape."""
        bodies, solved, tape = self.bodies, self.solved, self.tape
        r, amounts, inverse = solved.unknowns, solved.amounts, solved.balance.inverse
        rest: list[Any] = [np.zeros(len(r)) for _ in range(bodies.equations)]
        sums: list[tuple[list[Act], Any]] = [([act], 1.0) for act in self.acts]
        sums += [(list(acts), r[:, k]) for k, acts in enumerate(bodies.unknowns)]
        sums += [(list(item.acts), amounts[:, k]) for k, item in enumerate(bodies.following)]
        for group, factor in sums:
            for act in group:
                for row, value in bodies.entries(act):
                    rest[row] = rest[row] + value * factor
        # eq. (126): the step that equilibrium takes, and that of the amounts with it
        step = tape.stepped(np.zeros_like(r), inverse, rest)
        changes = self._changes(step)
        answers = solved.answers
        self.unknowns = [
            tape.combine(
                r[:, k],
                [
                    (1.0, step[k]),
                    *((item[:, k], c) for item, c in zip(answers, changes, strict=True)),
                ],
            )
            for k in range(r.shape[1])
        ]
        self.amounts = [
            tape.combine(amounts[:, k], [(1.0, change)]) for k, change in enumerate(changes)
        ]

    def _changes(self, step: list[Any]) -> list[Any]:
        """The changes of all amounts, which depend on the unknowns that they change."""
        bodies, solved, count = self.bodies, self.solved, len(self.bodies.following)
        rows = len(solved.unknowns)
        if not count:
            return []
        matrix = np.tile(np.eye(count), (rows, 1, 1))
        sides: list[Any] = []
        for k, follower in enumerate(bodies.following):
            places = list(follower.size.unknowns)
            u = solved.unknowns[:, places]
            size: Any = follower.size.value(u)
            # friction acts against the motion, whatever the tape says
            sign = np.sign(solved.amounts[:, k]) * np.sign(_bare(size))
            slope = sign[:, None] * solved.bodies.following[k].size.gradient(u)
            side: Any = self.tape.combine(np.zeros(rows), [(sign, size)])
            for place, j in enumerate(places):
                side = side + slope[:, place] * step[j]
                for other, answer in enumerate(solved.answers):
                    matrix[:, k, other] -= slope[:, place] * answer[:, j]
            sides.append(side)
        return self.tape.stepped(np.zeros((rows, count)), -inverses(matrix), sides)

    def friction_effort(self) -> Any:
        """What friction adds to the effort of the only input, (B,)."""
        total: Any = 0.0
        for amount, follower in zip(self.amounts, self.bodies.following, strict=True):
            if follower.motion is not None:
                total = total - amount * follower.motion
        return total

    def readings(self) -> dict[str, Any]:
        """All named quantities."""
        bodies, readings = self.bodies, dict[str, Any]()
        acts = list(self.acts)
        for amount, follower in zip(self.amounts, bodies.following, strict=True):
            acts += [Act(a.on, a.place, a.force * amount, a.moment) for a in follower.acts]
        read_first_links(bodies, acts)
        for reading in bodies.readings:
            value = reading.constant + sum((f * self.unknowns[k] for k, f in reading.terms), 0.0)
            if reading.follow is not None:
                value = value + self.amounts[reading.follow]
            readings[reading.name] = value
        return readings


def _bare(value: Any) -> Array:
    """The values of a number that may be on a tape."""
    return value.values if is_batched(value) else value
