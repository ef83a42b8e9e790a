"""A step of a curve that leads across a change point, and the curve up to that point.

Steps keep the sign of det J, but where two crossings coincide the sign is the same on both sides.
Such a step cannot be proved. The place in it that is nearest to a singular one is next to the
change point, if there is one.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from linkwork.circuits.homotopy.bilinear_homotopy import nearest_solution
from linkwork.circuits.homotopy.dead_point_family import dead_point_roots
from linkwork.circuits.homotopy.dead_points import DeadPointSystem, Slot
from linkwork.circuits.homotopy.monodromy import keeps_complex_input, real_motion
from linkwork.circuits.results import PathCount
from linkwork.core.equations.compiling import (
    DirectionForm,
    NoDirectionForm,
    ParametrizedTable,
    check_independent,
    direction_form,
)
from linkwork.core.foundation.arrays import (
    ALMOST_DOUBLE,
    ALMOST_REAL,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
)
from linkwork.core.foundation.lanes import phase
from linkwork.core.foundation.statuses import CircuitEnd, Completeness
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.model import Model
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.branch_tracking import (
    BOLD,
    InputPath,
    Node,
    Parametrization,
    Parametrizations,
    follow,
)
from linkwork.core.numerics.change_point import crossing_near
from linkwork.core.numerics.curve_tracing import Curve, Leg, crossing_beyond, node_between
from linkwork.core.numerics.decomposition import closure_of
from linkwork.core.table.loop_table import LoopTable, TableSplitter

_NARROWINGS = 24  # of a step at most, each
_INSIDE_STEP = (0.4, 0.6)  # to before the second or behind the first of these shares
_SHORT = 5e-4  # of the leader's natural size: from so near change points are located


def cut_at_crossing(leads: Parametrizations, curve: Curve, number: int, after: int) -> Curve | None:
    """The curve up to a change point in the step behind the node ``after`` of a leg.

    Returns
    -------
    Curve or None
        ``None`` if no change point is found there. It may need another leader than the leg's: the
        curve then has one more leg.
    """
    leg = curve.legs[number]
    if not 0 <= after < len(leg.nodes) - 1:
        return None
    low = _before_singular(leg.led, *leg.nodes[after : after + 2])
    if low is None:
        return None
    way = replace(leg, nodes=(*leg.nodes[: after + 1], low))
    sign = math.copysign(1.0, leg.nodes[-1].t - leg.nodes[0].t)
    v, heading = leg.led.whole(low.v), sign * leg.led.whole(low.first)
    speed = np.abs(heading) / leads.scale
    for lead in np.argsort(-speed, kind="stable").tolist():
        led = leads.with_parameter(lead)
        if led is None or not speed[lead] > 0.0:
            continue
        here, side = led.node(v), math.copysign(1.0, heading[lead])
        found = crossing_beyond(leads, led, here, side)
        if found is None:
            continue
        nodes, end = follow(led.solver, led.path, here, 0.5 * (here.t + float(found.v[lead])), BOLD)
        if end is not None or not nodes:
            continue
        return Curve(
            legs=(*curve.legs[:number], way, Leg(led=led, nodes=(here, *nodes))),
            end=CircuitEnd.CHANGE_POINT,
            passes=tuple(each for each in curve.passes if each[0] < number),
            crossing=found,
        )
    return None


def _before_singular(led: Parametrization, low: Node, high: Node) -> Node | None:
    """The node of a step just before its place that is nearest to a singular one."""
    for _ in range(_NARROWINGS):
        if abs(high.t - low.t) <= _SHORT * led.path.size:
            break
        first, second = (node_between(led, low, high, share) for share in _INSIDE_STEP)
        if first is None or second is None:
            return None
        if first.nearness < second.nearness:
            low = first
        else:
            high = second
    return low


# ----------------------------------------------------------------------
# Dead points of blocks as polynomial systems with the input as an unknown.


_DEPENDENT = 1e-9  # smallest singular value of the lengths' columns, relative to the largest


@dataclass(frozen=True, kw_only=True, eq=False)
class DeadPointForm:
    """The dead points of one block as a system of polynomials.

    Parameters
    ----------
    form : DirectionForm
        Form of the block and all blocks it depends on; the leading input is the last unknown.
    system : DeadPointSystem
    variables : (n,) int
        Indices of the form's unknowns among the variables of the mechanism.
    poles : tuple of float, optional
        Input angles φ at which lengths of the block run to infinity while those it depends on stay
        finite; ``None`` if unknown.
    """

    form: DirectionForm
    system: DeadPointSystem
    variables: IndexArray
    known: Array
    poles: tuple[float, ...] | None

    def positions(self, x: ComplexArray, near: Array) -> Array:
        """The unknowns (R, n) at real solutions x; angles within half a turn of ``near`` (N,)."""
        known = np.repeat(self.known[None, :], len(x), axis=0)
        return self.form.unknowns(x[:, : 2 * self.system.size], known, near[self.variables])

    def lead(self, x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """The leading input at a solution x (n,), in terms of U and of V, and both gradients.

        Returns
        -------
        value, slope : (2,), (2, n)
            e^{iθ} up to a constant factor, or a length; conjugates of each other if real.
        """
        form, m = self.form, self.system.size
        number = form.table.unknowns - 1
        value, slope = np.zeros(2, dtype=complex), np.zeros((2, len(x)), dtype=complex)
        for side, begin in enumerate((0, m)):
            if number in form.turning:
                weights = form.angles[form.turning.tolist().index(number)]
                used = begin + np.flatnonzero(weights)
                power = weights[weights != 0.0]
                value[side] = np.prod(x[used] ** power)
                slope[side, used] = value[side] * power / x[used]
                continue
            k = form.sliding.tolist().index(number)
            here, along = begin + form.directions + k, form.along[k]
            way = complex(x[begin + along]) if along >= 0 else 1.0
            value[side] = x[here] / way
            slope[side, here] = 1.0 / way
            if along >= 0:
                slope[side, begin + along] = -value[side] / way
        return value, slope


def dead_point_form(
    leads: ParametrizedTable, solver: BlockSolver, path: InputPath, number: int
) -> DeadPointForm | None:
    """The form of a block; ``None`` if the block cannot lock or the input does not move it.

    Raises
    ------
    NoDirectionForm
        If this form does not exist.
    """
    members = closure_of(solver, number)
    blocks = [solver.blocks[k] for k in members]
    own = blocks[-1]
    table = own.system
    used = {int(k) for block in blocks for k in block.variables[len(block.unknowns) :]}
    n = solver.unknowns
    # without a varying input the block is constant
    inputs = [k - n for k in sorted(used) if k >= n and path.rate[k - n]]
    if not isinstance(table, LoopTable) or not table.loops.rows or not inputs:
        return None
    lead = leads.parameter
    others = [n + j for j in inputs if n + j != lead]
    # linear rows for the other inputs follow those of the table
    whole = leads.table
    waiting = [j for j in range(len(path.rate)) if n + j != lead]
    lines = len(whole.pattern()) - len(whole.functions) - len(waiting)
    equations = [e for block in blocks for e in block.equations]
    equations += [lines + waiting.index(k - n) for k in others]
    unknowns = [*(int(u) for block in blocks for u in block.unknowns), *others, lead]
    part, known = TableSplitter(whole).part(equations, unknowns)
    form = direction_form(part, free=1)
    at = path.at(0.0)
    values = np.array([at[k - n] for k in known])
    left, _ = form.closures(values[None, :], np.zeros((1, len(known))))
    check_independent(left[0])
    place = {u: k for k, u in enumerate(unknowns)}
    mine = [place[int(u)] for u in own.unknowns]
    return DeadPointForm(
        form=form,
        system=DeadPointSystem(
            left=left[0],
            right=left[0].conj(),
            rows=form.rows,
            own=table.loops.rows,
            slots=_slots(form, mine, table.loops.rows),
        ),
        variables=np.array(unknowns, dtype=np.intp),
        known=values,
        poles=_poles(form, left[0][-table.loops.rows :], mine),
    )


def _slots(form: DirectionForm, own: list[int], loops: int) -> tuple[Slot, ...]:
    """The terms of the rates of the block's unknowns, with all others constant."""
    count, size = form.directions, form.rows.shape[1]
    still = [k for k, j in enumerate(form.turning.tolist()) if j not in own]
    turns = _null_space(form.angles[still])  # of the directions
    lengths = [k for k, j in enumerate(form.sliding.tolist()) if j in own]
    if turns.shape[1] + len(lengths) != 2 * loops:
        raise NoDirectionForm("do not have two unknown directions or lengths for every loop")
    slots: list[Slot] = []
    for number, column in enumerate(turns.T.tolist()):
        slots += [(d, d, number, w, w) for d, w in enumerate(column) if w]
        for k, a in enumerate(form.along):
            if a >= 0 and column[a]:
                slots.append((count + k, count + k, number, column[a], column[a]))
    for number, k in enumerate(lengths, turns.shape[1]):
        a = form.along[k]
        slots.append((count + k, a if a >= 0 else size, number, 1.0, -1.0))
    return tuple(slots)


def _null_space(rows: Array) -> Array:
    """A basis (D, K) of the null space of an integer matrix (R, D), by elimination."""
    rows = rows.copy()
    pivots: list[int] = []
    for column in range(rows.shape[1]):
        begin = len(pivots)
        if begin == len(rows):
            break
        best = begin + int(np.argmax(np.abs(rows[begin:, column])))
        if abs(rows[best, column]) < 1e-9:
            continue
        rows[[begin, best]] = rows[[best, begin]]
        rows[begin] /= rows[begin, column]
        for k in range(len(rows)):
            if k != begin:
                rows[k] -= rows[k, column] * rows[begin]
        pivots.append(column)
    free = [k for k in range(rows.shape[1]) if k not in pivots]
    basis = np.zeros((rows.shape[1], len(free)))
    for number, k in enumerate(free):
        basis[k, number] = 1.0
        for row, pivot in enumerate(pivots):
            # 0.0 - x, as -x would leave -0.0
            basis[pivot, number] = 0.0 - rows[row, k]
    return basis


def _poles(form: DirectionForm, closures: ComplexArray, own: list[int]) -> tuple[float, ...] | None:
    """Input angles at which lengths of the block's closures (l, M + 1) can run to infinity."""
    lengths = [k for k, j in enumerate(form.sliding.tolist()) if j in own]
    along = [form.along[k] for k in lengths]
    columns = closures[:, [form.directions + k for k in lengths]]
    # much larger lengths cannot close the loop, so they stay finite
    if not lengths or _closed_by_nothing(columns, along):
        return ()
    if len(columns) == 1 and len(lengths) == 2 and form.directions == 1 and sum(along) == -1:
        # one along the input, one along a fixed line: parallel twice per turn
        turning = along.index(0)
        ratio = complex(columns[0, 1 - turning] / columns[0, turning])
        angle = phase(ratio)
        shift = float((form.angles @ np.array([angle]))[-1] + form.shift[-1, -1])
        return (shift, shift + math.pi)
    return None


def _closed_by_nothing(columns: ComplexArray, along: list[int]) -> bool:
    """Whether lengths much larger than all others violate a closure for all directions."""
    real = []
    for column, a in zip(columns.T, along, strict=True):
        real.append(np.concatenate([column.real, column.imag]))
        if a >= 0:
            real.append(np.concatenate([-column.imag, column.real]))
    if len(real) > len(real[0]):
        return False
    sizes = np.linalg.svd(np.array(real), compute_uv=False)
    return bool(sizes[-1] > _DEPENDENT * sizes[0])


# ----------------------------------------------------------------------
# Trial input values: one in each interval between neighbouring dead points.
#
# Between them the number of configurations is constant, so each configuration at one value
# represents a piece of a circuit over the whole interval.


#: Input values of one interval, in the order in which they are tried.
Interval = tuple[float, ...]

_PLACES = (0.5, 0.45, 0.62, 0.31)  # of an interval; the middle is the furthest from both ends
_OUTSIDE = (0.5, 0.37, 0.83)  # natural sizes of the input, beyond the outermost values
_INSIDE_RANGE = 0.2  # of an interval: how far from its ends its sample value lies
_NARROW = 1e-12  # relative width: nothing fits between the ends


def intervals_between(
    cuts: Array, guess: float | None, scale: float, *, turns: bool
) -> list[Interval]:
    """The intervals between cuts (K,), rising, without the one that holds ``guess``.

    Parameters
    ----------
    turns : bool
        Whether the input is an angle, with ``cuts`` from -π to π; a length has two more intervals
        that are open at one side.
    """
    if not len(cuts):
        return []
    if turns:
        # around the circle the last cut is followed by the first one
        ends = [*cuts, cuts[0] + FULL_TURN]
        if guess is not None:
            guess = float(cuts[0] + np.remainder(guess - cuts[0], FULL_TURN))
        return [_inside(a, b) for a, b in _open(ends, guess)]
    found = [_inside(a, b) for a, b in _open(cuts, guess)]
    below = tuple(float(cuts[0] - place * scale) for place in _OUTSIDE)
    above = tuple(float(cuts[-1] + place * scale) for place in _OUTSIDE)
    if guess is None or guess > cuts[0] - _INSIDE_RANGE * scale:
        found.insert(0, below)
    if guess is None or guess < cuts[-1] + _INSIDE_RANGE * scale:
        found.append(above)
    return found


def _open(ends: Sequence[float] | Array, guess: float | None) -> Iterable[tuple[float, float]]:
    for a, b in pairwise(ends):
        width = b - a
        if width <= _NARROW * max(1.0, abs(a), abs(b)):
            continue
        # a guess too near to an end may see a double configuration there
        inside = _INSIDE_RANGE * width
        if guess is None or not a + inside <= guess <= b - inside:
            yield float(a), float(b)


def _inside(a: float, b: float) -> Interval:
    return tuple(a + place * (b - a) for place in _PLACES)


# ----------------------------------------------------------------------
# The input values of all dead points, from polynomials.


_MOST_PATHS = 300  # from products of linear forms: three loops at most, or a dyad behind three
_SAME_INPUT = 1e-9  # weighted: two inputs are one,
_SAME_MULTIPLE_INPUT = 1e-5  # and that of a multiple solution and another one
_MOVES = 1e-6  # of the largest change: an unknown that changes less counts as at rest
_COMPLEX_CURVES = "not proved: complex dead points form a continuum, which may contain real ones"
_WHOLE = 1e-12  # how far a rate may be from a whole number
_STEPS = 40  # towards a multiple solution
_GRADES = {
    Completeness.WITH_PROBABILITY_ONE: (
        "the list of dead points is complete with probability one: all solution paths are "
        "accounted for"
    ),
    Completeness.NOT_PROVED: "not proved: solution paths were lost, so dead points may be missing",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class DeadPointInputs:
    """Where the input can lock, internal units.

    Parameters
    ----------
    values : (K,)
        Of the leading input, rising; an angle from -π to π. A block can lock there; whether those
        that depend on it can be closed there is not asked.
    multiple : (K,) bool
        At which solutions coincide, as at change points.
    completeness, message : Completeness, str
        Whether no dead point is missing.
    poles : (P,)
        Inputs at which a length runs to infinity; there, too, configurations begin and end.
    poles_known : bool
        Whether these are all.
    counts : tuple of PathCount
        One for each block that can lock.
    """

    values: Array
    multiple: BoolArray
    completeness: Completeness
    message: str
    poles: Array
    poles_known: bool
    counts: tuple[PathCount, ...]

    @property
    def cuts(self) -> Array:
        """Dead points and poles, rising."""
        return np.sort(np.concatenate([self.values, self.poles]))

    @property
    def cover_all(self) -> bool:
        """Whether the number of configurations is constant between any two neighbouring cuts."""
        return self.completeness.complete and self.poles_known

    @property
    def reason(self) -> str:
        """Why it may not be."""
        unbounded = "" if self.poles_known else "a length can run to infinity between them"
        return self.message if not self.completeness.complete else unbounded


def dead_point_inputs(model: Model, path: InputPath, lead: int) -> DeadPointInputs:
    """All input values at which a block locks while those it depends on do not.

    Parameters
    ----------
    path : InputPath
        How the inputs move in lock-step.
    lead : int
        The input that the path is measured by.
    """
    return _Search(model, path, lead).run()


class _Search:
    def __init__(self, model: Model, path: InputPath, lead: int) -> None:
        # rates that are whole numbers but for the rounding of a table in degrees
        whole = np.round(path.rate)
        rate = np.where(np.abs(path.rate - whole) <= _WHOLE, whole, path.rate)
        self.model, self.path, self.number = model, replace(path, rate=rate), lead
        self.leads = ParametrizedTable(
            model.compiled.table, self.path, lead, model.compiled.leaders
        )
        self.grade = Completeness.WITH_PROBABILITY_ONE
        self.reasons: list[str] = []
        self.values: list[float] = []
        self.doubles: list[float] = []
        self.counts: list[PathCount] = []
        self.poles: list[float] = []
        self.poles_known = True

    def run(self) -> DeadPointInputs:
        """Block by block."""
        solver = self.model.compiled.solver
        for number, block in enumerate(solver.blocks):
            names = tuple(self.model.equations.unknowns[int(k)].name for k in block.unknowns)
            try:
                form = dead_point_form(self.leads, solver, self.path, number)
                if form is not None:
                    self._add(form, number, names)
            except NoDirectionForm as reason:
                self.grade = self.grade.and_then(Completeness.NOT_LISTED)
                self.reasons.append(f"the equations of {', '.join(names)} {reason}")
        values, multiple = self._sort_values()
        message = "; ".join(self.reasons) if self.reasons else _GRADES[self.grade]
        return DeadPointInputs(
            values=values,
            multiple=multiple,
            completeness=self.grade,
            message=message,
            poles=np.sort(np.array(self._wrap_angle(self.poles), dtype=float)),
            poles_known=self.poles_known,
            counts=tuple(self.counts),
        )

    def _add(self, form: DeadPointForm, number: int, names: tuple[str, ...]) -> None:
        system = form.system
        if form.poles is None:
            self.poles_known = False
        else:
            self.poles += form.poles
        if system.bound > _MOST_PATHS:
            raise NoDirectionForm(
                f"depend on {system.loops} loops; their dead points would take {system.bound} "
                f"paths, more than the {_MOST_PATHS} that are followed"
            )
        roots = dead_point_roots(system)
        if not (roots.sure and roots.accounted_for):
            self.grade = self.grade.and_then(Completeness.NOT_PROVED)
        if roots.continuum:
            self._grade_curves(form, roots.curves)
        real = _real(form, roots.x, ALMOST_REAL)
        # multiple solutions are known to the square root of rounding: a wider tolerance
        sharp = [nearest_solution(system, x, _STEPS) for x in roots.multiple]
        double = _real(form, np.array(sharp).reshape(roots.multiple.shape), ALMOST_DOUBLE)
        start = self.model.equations.start
        self.values += self._wrap_angle(form.positions(real, start)[:, -1].tolist())
        self.doubles += self._wrap_angle(
            [self._crossing(form, number, x) for x in form.positions(double, start)]
        )
        self.counts.append(roots.counted(names, len(real) + len(double), system.bound))

    def _grade_curves(self, form: DeadPointForm, curves: ComplexArray) -> None:
        """Grade the list where curves of dead points, through solutions (C, n), may be real."""
        open_ = [x for x in curves if not keeps_complex_input(form.system, x, form.lead)]
        if not open_:
            return
        self.grade = self.grade.and_then(Completeness.CONTINUUM)
        for x in open_:
            moving = real_motion(form.system, x, form.lead)
            if moving is not None:
                self.reasons.append(self._moving(form, np.stack(moving)))
                return
        self.reasons.append(_COMPLEX_CURVES)

    def _moving(self, form: DeadPointForm, x: ComplexArray) -> str:
        """Which unknowns differ between two positions x (2, n) with the same input."""
        here, there = form.positions(x, self.model.equations.start)
        variables = self.model.equations.variables
        gap = np.abs(there - here) / self.leads.scale[form.variables]
        moving = form.variables[:-1][gap[:-1] > _MOVES * gap[:-1].max()]
        scale, lead = self.model.input_scale, self.model.equations.inputs[self.number]
        value = self._wrap_angle([float(here[-1])])[0] / scale[self.number]
        at = f"{lead.name} = {round(value, 6) + 0.0:.6g} {self.model.input_units[lead.name]}"
        names = ", ".join(variables[int(k)].name for k in np.sort(moving))
        return f"{names} can move while the input is constant, as at {at}"

    def _crossing(self, form: DeadPointForm, number: int, x: Array) -> float:
        """The input of a multiple solution x (n,): a change point's to rounding."""
        v = self.model.equations.start.copy()
        solver = self.model.compiled.solver
        v[solver.unknowns :] = self.path.at(float(x[-1]))
        v[form.variables] = x
        found = crossing_near(solver, self.path, number, v)
        return float(x[-1]) if found is None else found

    def _wrap_angle(self, values: list[float]) -> list[float]:
        """An angle's values from -π to π."""
        if not self.leads.is_angle[self.leads.parameter]:
            return values
        return [math.remainder(value, 2.0 * math.pi) for value in values]

    def _sort_values(self) -> tuple[Array, BoolArray]:
        """Values without repetitions; those of simple dead points come first."""
        scale = float(self.leads.scale[self.leads.parameter])
        turns = bool(self.leads.is_angle[self.leads.parameter])
        kept: list[tuple[float, bool]] = []
        for values, multiple, same in (
            (self.doubles, True, _SAME_MULTIPLE_INPUT),
            (self.values, False, _SAME_INPUT),
        ):
            for value in values:
                gaps = np.abs([value - old for old, many in kept if many == multiple])
                if turns:
                    # -π and π are one value
                    gaps = np.minimum(gaps, 2.0 * np.pi - gaps)
                # several positions lock at one input where blocks have several configurations
                if not (gaps <= same * scale).any():
                    kept.append((value, multiple))
        kept.sort()
        return (
            np.array([value for value, _ in kept], dtype=float),
            np.array([multiple for _, multiple in kept], dtype=bool),
        )


def _real(form: DeadPointForm, x: ComplexArray, within: float) -> ComplexArray:
    """Those of solutions x (R, n) that are their own mirror images."""
    m = form.system.size
    gap = np.abs(x[:, :m] - x[:, m : 2 * m].conj()).max(axis=1, initial=0.0)
    real: ComplexArray = x[gap < within * (1.0 + np.abs(x[:, : 2 * m]).max(axis=1, initial=0.0))]
    return real
