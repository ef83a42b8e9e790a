"""The forces of all joints: unknowns by equilibrium, friction and what else follows from them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, FrozenDict, StatusArray
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops
from linkwork.core.mechanism.machine import LoadedBodies
from linkwork.core.motion.model import Model
from linkwork.core.results.quantities.definition import Solved
from linkwork.core.results.quantity import Kind
from linkwork.forces.reactions.coupling import Coupling
from linkwork.forces.reactions.drives import (
    effort_kind,
    effort_name,
    efforts,
    energies,
    free_bodies,
    known_acts,
    read_bodies,
    read_first_links,
)
from linkwork.forces.reactions.free_bodies import Act, Balance, FreeBodies, Reading, balance
from linkwork.forces.reactions.geometry import AppliedLoads, Geometry
from linkwork.forces.reactions.parts import apply_load
from linkwork.forces.reactions.switches import stop_efforts, stop_values, undetermined_stops
from linkwork.forces.results import ForceStatus

_STRESSED = 1e-9  # part of a doubtful force that makes another one doubtful
_AT_REST = 1e-12  # of the fastest motion: rounding of a joint that does not move


@dataclass(frozen=True, kw_only=True, eq=False)
class FrictionEfforts:
    """What friction adds to the efforts of p inputs in B rows.

    Parameters
    ----------
    efforts, largest : (p, B)
        The sum of its terms, and the size of the largest one.
    doubt : (B,)
        Where a self-stress changes the sum.
    """

    efforts: Array
    largest: Array
    doubt: BoolArray


@dataclass(frozen=True, kw_only=True, eq=False)
class JointForces:
    """The solution in B rows: n unknowns and K amounts of what follows from them.

    Parameters
    ----------
    unknowns : (B, n)
    amounts : (B, K)
        Times the acts of the followers; of friction opposite to the motion.
    doubtful : (B, K)
        Where a self-stress changes an amount.
    found, proved : (B,)
        Whether friction leaves an equilibrium, and whether this is proved.
    """

    bodies: FreeBodies
    balance: Balance
    answers: Sequence[Array]
    unknowns: Array
    amounts: Array
    doubtful: BoolArray
    found: BoolArray
    proved: BoolArray

    def read(self, reading: Reading) -> tuple[Array, BoolArray]:
        """A reading and where it is not determined, (B,) each."""
        value: Array = np.zeros(len(self.unknowns)) + reading.constant
        for k, factor in reading.terms:
            value += factor * self._given[:, k]
        if reading.follow is not None:
            value += self.amounts[:, reading.follow]
        if self.balance.stress is None and not self.doubtful.any():
            return value, np.zeros(len(value), dtype=bool)
        factors = np.zeros_like(self.unknowns)
        for k, factor in reading.terms:
            factors[:, k] += factor
        doubt = self.balance.undetermined(factors)
        for k, answer in enumerate(self.answers):
            change = np.abs((factors * answer).sum(axis=1))
            doubt |= self.doubtful[:, k] & ((change > _STRESSED) | (reading.follow == k))
        return value, doubt

    @cached_property
    def _given(self) -> Array:
        """The unknowns; 0 where they do not exist, for readings that need none of them."""
        return np.nan_to_num(self.unknowns)

    def acts(self) -> Iterable[Act]:
        """What follows from the unknowns."""
        for follower, amount in zip(self.bodies.following, self.amounts.T, strict=True):
            for act in follower.acts:
                yield Act(act.on, act.place, act.force * amount, act.moment * amount)

    def friction_efforts(self) -> FrictionEfforts:
        """What friction adds to the efforts."""
        rows, inputs = len(self.unknowns), len(self.bodies.geometry.input_rates)
        total, largest = np.zeros((inputs, rows)), np.zeros((inputs, rows))
        doubt = np.zeros(rows, dtype=bool)
        for k, follower in enumerate(self.bodies.following):
            if follower.motion is None:
                continue
            term = self.amounts[:, k] * follower.motion
            total -= term
            largest = np.maximum(largest, np.abs(term))
            doubt |= self.doubtful[:, k] & (np.abs(follower.motion) > 0.0).any(axis=0)
        return FrictionEfforts(efforts=total, largest=largest, doubt=doubt)


def joint_forces(bodies: FreeBodies, acts: Iterable[Act], direction: Array) -> JointForces:
    """Solve the equilibrium of all bodies under known acts.

    Parameters
    ----------
    direction : (B,)
        1 or -1: which way the leading input moves, or is about to.
    """
    known = balance(bodies.matrix())
    start = known.solve(bodies.sums(acts))
    followers = bodies.following
    rows, count = len(start), len(followers)
    signs = np.ones((rows, count))
    for k, follower in enumerate(followers):
        if follower.motion is not None:
            signs[:, k] = -_way(follower.motion, bodies) * direction
    # the equations are linear: what follows is added to the first solution
    answers = [known.solve(bodies.sums(follower.acts)) for follower in followers]
    if not count:
        every = np.ones(rows, dtype=bool)
        return JointForces(
            bodies=bodies, balance=known, answers=(), unknowns=start, amounts=np.zeros((rows, 0)),
            doubtful=np.zeros((rows, 0), dtype=bool), found=every, proved=every,
        )  # fmt: skip
    # friction in a stressed joint is as unknown as its force
    doubtful = doubtful_followers(bodies, known, answers)
    first, change = np.zeros((rows, count, 2)), np.zeros((rows, count, 2, count))
    for j, follower in enumerate(followers):
        for m, own in enumerate(follower.size.unknowns):
            first[:, j, m] = start[:, own]
            for k, answer in enumerate(answers):
                # what is not determined must not spoil the rest
                change[:, j, m, k] = np.where(doubtful[:, k], 0.0, answer[:, own] * signs[:, k])
    rubs = np.array([follower.motion is not None for follower in followers])
    sizes = [follower.size for follower in followers]
    solved = Coupling(sizes=sizes, start=first, change=change, rubs=rubs).solve()
    amounts = np.where(doubtful, 0.0, solved.sizes * signs)
    total = start + sum(amounts[:, k, None] * answer for k, answer in enumerate(answers))
    # rows without equilibrium of other reasons have no friction to blame
    lost = ~np.isfinite(start).all(axis=1)
    return JointForces(
        bodies=bodies, balance=known, answers=answers, unknowns=total, amounts=amounts,
        doubtful=doubtful, found=solved.found | lost, proved=solved.proved,
    )  # fmt: skip


def _way(motion: Array, bodies: FreeBodies) -> Array:
    """The sign of a relative motion when the leading input grows; 0 at rest, (B,)."""
    geometry = bodies.geometry
    each = np.broadcast_to(motion, (len(motion), geometry.rows))
    rate = (geometry.input_ways.T * each.T).sum(axis=-1)
    limit = _AT_REST * geometry.fastest * max(1.0, geometry.length)
    found: Array = np.where(np.abs(rate) > limit, np.sign(rate), 0.0)
    return found


def doubtful_followers(bodies: FreeBodies, known: Balance, answers: Sequence[Array]) -> BoolArray:
    """Which followers a self-stress changes, of itself or through others, (B, K)."""
    rows, count = len(answers[0]), len(answers)
    found = np.zeros((rows, count), dtype=bool)
    unit = np.zeros_like(answers[0])
    for k, follower in enumerate(bodies.following):
        # a self-stress may load one component of a force only
        for own in follower.size.unknowns:
            unit[:] = 0.0
            unit[:, own] = 1.0
            found[:, k] |= known.undetermined(unit)
    # doubts spread by reactions: at most through all followers
    for _ in range(count):
        for k, follower in enumerate(bodies.following):
            for own in follower.size.unknowns:
                for other, answer in enumerate(answers):
                    found[:, k] |= found[:, other] & (np.abs(answer[:, own]) > _STRESSED)
    return found


# ----------------------------------------------------------------------
# The forces of a mechanism: reactions by free bodies, efforts by virtual work, each checking the
# other.


_UNBOUNDED = 1e9  # radians, or longest links, per unit of the input: no rate at all
#: Of the largest term of a sum of work: less is none.
NO_WORK = 1e-12


@dataclass(frozen=True, kw_only=True, eq=False)
class ForceValue:
    """A quantity of forces in B rows.

    ``undetermined``: where a self-stress changes it; ``lifted``: where a joint that can only push
    would have to pull; ``slipping``: where a rolling wheel would need more adhesion. ``pin``: of a
    force on a point this point, the link on which it acts and the one that exerts it.
    """

    kind: Kind
    about: str
    value: Array
    undetermined: BoolArray
    lifted: BoolArray
    slipping: BoolArray
    pin: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class ForceRows:
    """All forces in B rows: quantities by name, the status code of every row, and whether it is
    proved that friction leaves an equilibrium or none.

    ``undefined``: formulas of loads with the rows in which they have no finite value.
    """

    values: Mapping[str, ForceValue]
    status: StatusArray
    proved: BoolArray
    undefined: Mapping[str, BoolArray] = FrozenDict()


@dataclass(eq=False)
class _Solution:
    geometry: Geometry
    applied: AppliedLoads
    regular: BoolArray
    values: dict[str, ForceValue] = field(default_factory=dict)

    def __post_init__(self) -> None:
        #: Where friction leaves no equilibrium, and where this, or the equilibrium, is proved.
        self.locked = np.zeros(self.geometry.rows, dtype=bool)
        self.proved = np.ones(self.geometry.rows, dtype=bool)
        #: Where friction holds the mechanism at rest.
        self.held = np.zeros(self.geometry.rows, dtype=bool)

    def slips(self, name: str, rows: BoolArray) -> None:
        """Mark where a wheel would need more adhesion."""
        self.values[name] = replace(self.values[name], slipping=rows & self.regular)

    def add(
        self, name: str, kind: Kind, about: str, value: Array,
        undetermined: BoolArray | None = None, *, pushes: bool = False, pin: tuple[str, ...] = (),
    ) -> None:  # fmt: skip
        none = np.zeros(self.geometry.rows, dtype=bool)
        unknown = none if undetermined is None else undetermined & self.regular
        value = np.where(self.regular & ~unknown, value, np.nan)
        # rounding of a contact without force is no lift-off
        lifted = value < -1e-9 * np.nanmax(np.abs(value), initial=0.0) if pushes else none
        self.values[name] = ForceValue(
            kind=kind,
            about=about,
            value=value,
            undetermined=unknown,
            lifted=lifted,
            slipping=none,
            pin=pin,
        )


def solve_forces(model: Model, solved: Solved) -> ForceRows:
    """All forces of solved positions.

    Raises
    ------
    InputError
        If a load uses a quantity that the mechanism does not have.
    """
    description = model.description
    assert isinstance(description, LoadedBodies)
    geometry = Geometry(model, solved)
    applied = AppliedLoads(geometry, model.speed or 0.0)
    bodies = None
    with np.errstate(all="ignore"):
        applied.weigh(description)
        if isinstance(description, Linkage):
            bodies = free_bodies(description, geometry, applied)
        elif isinstance(description, Loops):
            for load in description.loads:
                apply_load(load, applied)
            bodies = read_bodies(geometry, applied)
        by_work, largest = efforts(applied)
        # rates at a dead point are infinite, or huge if the row misses it by rounding
        has_rates = (geometry.fastest < _UNBOUNDED) & np.isfinite(by_work).all(axis=0)
        found = _Solution(geometry, applied, has_rates)
        stopped = undetermined_stops(geometry, bodies)
        found.regular &= ~stopped
        zero = np.zeros_like(by_work)
        rubbing = FrictionEfforts(
            efforts=zero, largest=zero, doubt=np.zeros(geometry.rows, dtype=bool)
        )
        drives: list[str] = []
        if bodies is not None:
            by_work = by_work + stop_efforts(bodies)
            rubbing = _add_reactions(found, bodies)
            drives = [effort_name(which.column) for which in bodies.linkage.inputs]
        _add_efforts(found, by_work, largest, drives, rubbing)
        if bodies is not None and bodies.rubs and len(by_work):
            _add_losses(found, by_work, largest, rubbing)
            if not applied.rate:
                _add_backward(found, bodies, by_work)
        # loads, weights and energies are known at rest all the same
        found.regular |= found.held | stopped
        for name, kind, about, value in stop_values(geometry):
            found.add(name, kind, about, value)
        for name, kind, about, value in totals(geometry, applied):
            point, pushed, _ = name.partition(".load.")
            found.add(name, kind, about, value, pin=(point, "", "") if pushed else ())
    moving = [p for p in geometry.points if p not in geometry.model.equations.fixed]
    # rows without a position have no place of any point
    lost = np.zeros(geometry.rows, dtype=bool)
    if moving:
        lost = ~np.isfinite(np.abs(geometry.place(moving[0]).v))
    status = np.where(found.regular, ForceStatus.FOUND.code, ForceStatus.NO_RATES.code)
    undefined = {formula: rows & ~lost for formula, rows in applied.undefined.items()}
    for rows in undefined.values():
        status[rows] = ForceStatus.NO_LOAD.code
    status[lost] = ForceStatus.NO_POSITION.code
    partly = np.any([value.undetermined for value in found.values.values()], axis=0)
    status[partly & found.regular] = ForceStatus.UNDETERMINED.code
    status[found.locked & ~lost] = ForceStatus.SELF_LOCKING.code
    status[stopped & ~lost] = ForceStatus.STOPPED.code
    status[found.held & ~lost] = ForceStatus.HELD.code
    return ForceRows(
        values=found.values, status=status.astype(np.int8), proved=found.proved, undefined=undefined
    )


def _add_reactions(found: _Solution, bodies: FreeBodies) -> FrictionEfforts:
    """All readings, from the unknowns and what follows from them."""
    # the same acts serve both ways
    acts = known_acts(bodies)
    direction = _direction(found)
    forces = joint_forces(bodies, acts, direction)
    rubbing = forces.friction_efforts()
    # where nothing balances the loads, no reading means anything
    found.regular &= np.isfinite(forces.unknowns).all(axis=1) | ~forces.found
    found.locked = found.regular & ~forces.found
    found.regular &= forces.found
    found.proved = forces.proved
    if bodies.rubs:
        found.held = found.regular & _held(bodies.geometry)
        found.regular &= ~found.held
    read_first_links(bodies, [*acts, *forces.acts()])
    for reading in bodies.readings:
        value, doubt = forces.read(reading)
        found.add(
            reading.name, reading.kind, reading.about, value, doubt, pushes=reading.pushes,
            pin=reading.pin,
        )  # fmt: skip
        if reading.adhesion is not None:
            normal, mu = reading.adhesion
            found.slips(reading.name, np.abs(value) > mu * np.abs(forces.unknowns[:, normal]))
    return rubbing


def _held(geometry: Geometry) -> BoolArray:
    """Rows of a structure, and of a simulation where the mechanism stays at rest, (B,)."""
    if not geometry.driven.equations.inputs:
        return np.ones(geometry.rows, dtype=bool)
    if geometry.model.untimed is None or geometry.model.description.timed:
        return np.zeros(geometry.rows, dtype=bool)
    found: BoolArray = (geometry.input_ways == 0.0).all(axis=0)
    return found


def _direction(found: _Solution) -> Array:
    """Which way the leading input moves, or the way of its table where it is at rest, (B,)."""
    geometry = found.geometry
    rate = np.broadcast_to(found.applied.rate, geometry.rows)
    return np.where(rate == 0.0, geometry.table_direction, np.sign(rate))


def _add_efforts(
    found: _Solution, ideal: Array, largest: Array, drives: Sequence[str], rubbing: FrictionEfforts
) -> None:
    """Efforts by virtual work, and their largest difference from those of the free bodies."""
    geometry = found.geometry
    worst = np.zeros(geometry.rows)
    largest = np.maximum(largest, rubbing.largest)
    # the effort by virtual work replaces the other one, which only checks it
    by_work, checked = ideal + rubbing.efforts, False
    for k, variable in enumerate(geometry.driven.equations.inputs):
        name = effort_name(variable.name)
        if drives:  # of the linkage that loops read as, under the name of the loops' variable
            found.values[name] = found.values.pop(drives[k])
        checked = name in found.values
        if checked:
            # the largest term may be one that several terms only approach
            size = np.where(largest[k] > 0.0, largest[k], 1.0)
            worst = np.fmax(worst, np.abs(found.values[name].value - by_work[k]) / size)
        kind = effort_kind(geometry.kind(variable.name))
        about = f"effort of the input {variable.name}"
        found.add(name, kind, about, by_work[k], rubbing.doubt)
    if not len(by_work):
        return
    if checked:
        found.add("disagreement", Kind.NUMBER, "difference of the two ways to the efforts", worst)
    if found.applied.rate:
        power = geometry.by_leading(by_work) * found.applied.rate
        found.add("power", Kind.POWER, "power of all inputs", power, rubbing.doubt)


def _add_losses(found: _Solution, ideal: Array, largest: Array, rubbing: FrictionEfforts) -> None:
    """The efficiency, the power of friction, and the other end of the range of efforts at rest."""
    geometry, rate = found.geometry, found.applied.rate
    # work per unit of the leading input along its motion
    way = _direction(found)
    useful = geometry.by_leading(ideal) * way
    lost = geometry.by_leading(rubbing.efforts) * way
    # nothing moves against the loads at their dead point: rounding would be taken for a sign
    useful = np.where(np.abs(useful) > NO_WORK * largest.max(axis=0), useful, 0.0)
    spent = useful + lost
    # the input drives the loads, or they drive it: a negative value means that friction holds them
    efficiency = np.where(useful >= 0.0, useful / spent, spent / useful)
    about = "useful part of the power"
    found.add("efficiency", Kind.NUMBER, about, efficiency, rubbing.doubt)
    if rate:
        about = "power that friction takes"
        found.add("friction_power", Kind.POWER, about, lost * np.abs(rate), rubbing.doubt)


def _add_backward(found: _Solution, bodies: FreeBodies, ideal: Array) -> None:
    """Efforts for motion against the direction of the table: at rest any between holds."""
    forces = joint_forces(bodies, known_acts(bodies), -_direction(found))
    more = forces.friction_efforts()
    for k, variable in enumerate(found.geometry.driven.equations.inputs):
        value = np.where(forces.found, ideal[k] + more.efforts[k], np.nan)
        kind = effort_kind(found.geometry.kind(variable.name))
        about = f"effort of the input {variable.name} for motion backwards"
        found.add(f"{effort_name(variable.name)}.backward", kind, about, value, more.doubt)


def totals(geometry: Geometry, applied: AppliedLoads) -> Iterator[tuple[str, Kind, str, Array]]:
    """The force and the moment on the ground, energies and powers: name, kind, about, (B,)."""
    force: ComplexArray = np.zeros(geometry.shape, dtype=complex)
    moment = np.zeros(geometry.shape)
    pushes = [(geometry.place(point).v, own) for point, own, _ in applied.forces]
    # internal forces cancel: loads, weights and inertia alone reach the ground
    for place, own in [*pushes, *((body.place, body.force) for body in applied.masses)]:
        force = force + own
        moment = moment + (place.conj() * own).imag
    for torque in [own for _, own in applied.torques] + [body.torque for body in applied.masses]:
        moment = moment + torque
    for point in dict.fromkeys(point for point, _, _ in applied.forces):
        total = np.zeros(geometry.shape, dtype=complex)
        for own in (own for name, own, _ in applied.forces if name == point):
            total = total + own
        for axis, part in (("x", total.real), ("y", total.imag)):
            yield f"{point}.load.{axis}", Kind.FORCE, f"loads and springs on {point}", part
    yield "shaking.x", Kind.FORCE, "force on the ground", force.real
    yield "shaking.y", Kind.FORCE, "force on the ground", force.imag
    yield "shaking.moment", Kind.MOMENT, "moment on the ground about the origin", moment
    about = {
        "kinetic_energy": "energy of all masses in motion",
        "stored_energy": "energy of springs and weights",
        "load_power": "power of loads and dampers on the mechanism",
        "energy_rate": "rate of the kinetic and stored energy",
    }
    if applied.moves:
        for name, value in energies(applied).items():
            kind = Kind.POWER if name in ("load_power", "energy_rate") else Kind.ENERGY
            yield name, kind, about[name], value
