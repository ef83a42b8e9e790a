"""Trial input values: one in each interval between neighbouring dead points.

Between them the number of configurations is constant, so each configuration at one value represents
a piece of a circuit over the whole interval.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from linkwork.circuits.dead_point_form import DeadPointForm, dead_point_form
from linkwork.circuits.homotopy.dead_point_family import dead_point_roots
from linkwork.circuits.homotopy.idle_component import keeps_complex_input, real_motion
from linkwork.circuits.homotopy.polynomial_system import nearest_solution
from linkwork.circuits.results import PathCount
from linkwork.core.equations.compiling import NoDirectionForm, ParametrizedTable
from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.core.foundation.rounding import ALMOST_DOUBLE, ALMOST_REAL
from linkwork.core.foundation.statuses import Completeness
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.model import Model
from linkwork.core.numerics.branch_tracking import InputPath
from linkwork.core.numerics.change_point import crossing_near

#: Input values of one interval, in the order in which they are tried.
Interval = tuple[float, ...]

_PLACES = (0.5, 0.45, 0.62, 0.31)  # of an interval; the middle is the furthest from both ends
_OUTSIDE = (0.5, 0.37, 0.83)  # natural sizes of the input, beyond the outermost values
_INSIDE = 0.2  # of an interval: how far from its ends its sample value lies
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
    if guess is None or guess > cuts[0] - _INSIDE * scale:
        found.insert(0, below)
    if guess is None or guess < cuts[-1] + _INSIDE * scale:
        found.append(above)
    return found


def _open(ends: Sequence[float] | Array, guess: float | None) -> Iterable[tuple[float, float]]:
    for a, b in pairwise(ends):
        width = b - a
        if width <= _NARROW * max(1.0, abs(a), abs(b)):
            continue
        # a guess too near to an end may see a double configuration there
        inside = _INSIDE * width
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
