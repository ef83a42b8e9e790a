"""Circuit and branch defects of a mechanism of any kind, by following the circuit of a position."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from linkwork.circuits.arcs import is_regular
from linkwork.circuits.assembling import Assemblies, positions_at
from linkwork.circuits.branches import CurveBranch
from linkwork.circuits.circuit_sweep import FollowedCircuit, explorer_of, straight_way
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import Completeness
from linkwork.core.foundation.units import within_half_a_turn
from linkwork.core.motion.following import Drive
from linkwork.core.motion.model import Model
from linkwork.core.motion.solving import first_position
from linkwork.core.numerics.branch_tracking import coincide, same_position
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.synthesis.defects.verdicts import Defect, DefectKind

# of a point's way: a position that is missed by less lies on the branch, and other branches are
# farther away, unless the input is nearer than the square of this to a dead point
_MISSED = 1e-6
# of the mechanism's size: positions that are missed by more lie elsewhere, however they are
# rounded; inputs at least this far from a branch's ends are clearly inside or outside
_ELSEWHERE = 1e-3
# of the mechanism's size: nearer to a place than this, configurations are equally near
_EQUALLY_NEAR = 1e-9
_LIMIT = "dead point or change point"

#: Places of some points [length].
Places = Mapping[str, complex]


def defects_by_circuits(
    model: Model, inputs: Sequence[float], places: Sequence[Places]
) -> tuple[Defect, ...]:
    """The circuit or branch defect of a mechanism that passes positions; none if it has neither.

    Most mechanisms pass their positions on the branch of the guess, straight from the least to
    the greatest input. Else a position is the configuration at its input that comes nearest to its
    places, and the circuits of first positions are followed until all are met, or all of them. An
    input that does not turn needs circuits only for branches that pass the most positions.

    Parameters
    ----------
    model : Model
    inputs : sequence of float
        The leading input at the positions [file units].
    places : sequence of Mapping[str, complex]
        Places of points at the positions.

    Raises
    ------
    InputError
        If the mechanism has no input, or several that time drives; for places it cannot pass.
    """
    return _Search(Drive.of_circuits(model), inputs, places).defects()


@dataclass(frozen=True, kw_only=True, eq=False)
class _Start:
    """A first position (N,), and how many positions its branches pass at most.

    ``circuit``: the circuit of the configuration, once it is followed. ``doubt``: the circuit ends
    at a position, to rounding, so that it may not pass this position.
    """

    v: Array
    passed: int
    circuit: FollowedCircuit | None = None
    doubt: Defect | None = None


class _Search:
    def __init__(self, drive: Drive, inputs: Sequence[float], places: Sequence[Places]) -> None:
        self.drive, self.model, self.leads = drive, drive.model, drive.leads
        self.values = [float(value) * drive.unit for value in inputs]
        self.places = places
        names = self.model.compiled.points.names
        # names that do not exist have a message of their own
        leads = [
            self.model.quantities.find(f"{name}.x").own.name for one in places[:1] for name in one
        ]
        self._numbers = [names.index(name.removesuffix(".x")) for name in leads]
        self.explorer = explorer_of(drive)
        self._lists: dict[int, Assemblies] = {}
        self._ways: dict[CurveBranch, float] = {}

    def defects(self) -> tuple[Defect, ...]:
        """None if one branch passes all positions, else the defect of that which comes farthest."""
        if len(self.values) < 2:
            return ()
        self._check_equal_inputs()
        guess = self._guess()
        way = None if guess is None else straight_way(self.drive, guess, self.values[:1])
        known = [] if way is None or np.isnan(way.v).any() else [way.v[0]]
        if any(self._is_straight(v) for v in known):
            return ()
        others = [
            v for v in self._regular_starts() if not any(coincide(self.leads, v, w) for w in known)
        ]
        if any(self._is_straight(v) for v in others):
            return ()
        starts = self._straight_starts() or self._followed_starts(guess)
        if not starts:
            return (self._no_start(),)
        most = max(start.passed for start in starts)
        leading = [start for start in starts if start.passed == most]
        if most == len(self.values):
            doubts = [start.doubt for start in leading if start.doubt is not None]
            return tuple(doubts[:1]) if len(doubts) == len(leading) else ()
        return (self._defect_behind(leading, most),)

    def _check_equal_inputs(self) -> None:
        """Refuse different places of one input to which one configuration comes nearest."""
        far = _ELSEWHERE * self.model.equations.length_scale
        for j, k in combinations(range(len(self.values)), 2):
            places = zip(self.places[j].values(), self.places[k].values(), strict=True)
            if self.values[j] != self.values[k] or all(abs(z - w) <= far for z, w in places):
                continue
            if any(same_position(self.leads, *p) for p in product(*map(self._nearest, (j, k)))):
                text = f"positions {j + 1} and {k + 1} differ, but have one input and one nearest "
                raise InputError(f"{text}configuration: correct one of them")

    def _defect_behind(self, leading: Sequence[_Start], most: int) -> Defect:
        """The defect between the last position that any branch passes and the next one.

        A change of branch is the mildest; whether other branches change circuits is no matter then.
        """
        doubts = [start.doubt for start in leading if start.doubt is not None]
        changes: list[Defect] = []
        for start in leading:
            if start.doubt is None:
                circuit = start.circuit or FollowedCircuit(self.explorer, start.v)
                changes.append(self._change(circuit, most))
                if changes[-1].kind is DefectKind.BRANCH:
                    return changes[-1]
        return min([*doubts, *changes], key=_claim)

    def _guess(self) -> Array | None:
        """The position (N,) of the guess, if the input can lead there."""
        inputs = self.model.start_inputs
        done = first_position(self.model, inputs, NewtonOptions(), explained=False)
        return done.v if done.status.ok and is_regular(self.leads, done.v) else None

    def _is_straight(self, v: Array) -> bool:
        """Whether the branch of a position (N,) passes all positions exactly, followed straight."""
        way = straight_way(self.drive, v, self.values)
        if way is None or np.isnan(way.v).any():
            return False
        missed = [self._distances(way.v[k : k + 1], k)[0] for k in range(len(way.v))]
        return bool(max(missed) <= _MISSED * self._length(way.v))

    def _straight_starts(self) -> list[_Start]:
        """The first positions, if the input does not turn, so that no branch has one of its values
        twice; none if it is in doubt how many positions some branch passes.
        """
        if self.leads.is_angle[self.leads.parameter]:
            return []
        starts = self._regular_starts()
        passed = [self._count_passed(v) for v in starts]
        known = [
            _Start(v=v, passed=k) for v, k in zip(starts, passed, strict=True) if k is not None
        ]
        return known if len(known) == len(starts) else []

    def _count_passed(self, v: Array) -> int | None:
        """How many positions the branch of the first one (N,) passes before it ends or is clearly
        elsewhere; ``None`` in doubt.
        """
        way = straight_way(self.drive, v, self.values)
        if way is None:
            return None
        length = self._length(way.v[~np.isnan(way.v[:, 0])])
        far = _ELSEWHERE * self.model.equations.length_scale
        # the last node in front of a dead point is a little before it
        edge = _ELSEWHERE * float(self.leads.scale[self.leads.parameter])
        for k, value in enumerate(self.values[1:], start=1):
            if value < way.low - edge or value > way.high + edge:
                return k
            if value < way.low + edge or value > way.high - edge:
                return None
            missed = self._distances(way.v[k : k + 1], k)[0]
            if missed <= _MISSED * length:
                continue
            if not any(same_position(self.leads, way.v[k], near) for near in self._nearest(k)):
                return k if missed > far else None
        return len(self.values)

    def _length(self, v: Array) -> float:
        """How long the paths of the points are through positions (K, N)."""
        return sum(float(np.abs(np.diff(z)).sum()) for z in self._points(v))

    def _followed_starts(self, guess: Array | None) -> list[_Start]:
        """Every circuit that the first position may lie on."""
        if self._list(0).completeness is Completeness.NOT_LISTED:
            if guess is None:
                return []
            circuit = FollowedCircuit(self.explorer, guess)
            branches = [b for b in circuit.branches() if self._passes(circuit, b, 0)]
            return [self._start(guess, circuit, branches)] if branches else []
        starts: list[_Start] = []
        for v in self._regular_starts():
            circuit = FollowedCircuit(self.explorer, v)
            branch = next((b for b in circuit.known if circuit.lies_on(b, v)), None)
            if branch is not None:
                starts.append(self._start(v, circuit, [branch]))
        return starts

    def _regular_starts(self) -> list[Array]:
        """The configurations (N,) nearest to the first position at which the input can lead."""
        return [v for v in self._nearest(0) if is_regular(self.leads, v)]

    def _start(self, v: Array, circuit: FollowedCircuit, branches: Sequence[CurveBranch]) -> _Start:
        """How far branches of a circuit, on one of which a first position (N,) lies, pass."""
        passed, doubt = 1, None
        for k in range(1, len(self.values)):
            passing = self._passing(circuit, branches, k)
            if not passing:
                passing = [branch for branch in branches if self._end_at(branch, k)]
                if not passing:
                    break
                doubt = doubt or _at_limit(self._end_at(passing[0], k), k)
            passed, branches = k + 1, passing
        return _Start(v=v, passed=passed, circuit=circuit, doubt=doubt)

    def _passing(
        self, circuit: FollowedCircuit, branches: Sequence[CurveBranch], k: int
    ) -> list[CurveBranch]:
        """Those of some branches that pass a position, or come nearest to it."""
        exact = [branch for branch in branches if self._passes(circuit, branch, k)]
        if exact:
            return exact
        near = self._nearest(k)
        return [b for b in branches if any(circuit.lies_on(b, v) for v in near)]

    def _passes(self, circuit: FollowedCircuit, branch: CurveBranch, k: int) -> bool:
        """Whether a branch passes a position as exactly as :func:`is_passed` asks."""
        here = circuit.positions(branch, self.values[k])
        if not here:
            return False
        missed = float(self._distances(np.stack(here), k).min())
        return missed <= _MISSED * self._way(branch)

    def _way(self, branch: CurveBranch) -> float:
        """How long the paths of the points are along a branch."""
        if branch not in self._ways:
            self._ways[branch] = self._length(branch.v)
        return self._ways[branch]

    def _change(self, circuit: FollowedCircuit, k: int) -> Defect:
        """The defect in front of a position that the branches of the one before do not pass."""
        listed = self._list(k)
        if listed.completeness is Completeness.NOT_LISTED:
            if any(self._passes(circuit, branch, k) for branch in circuit.branches()):
                return _changes(DefectKind.BRANCH, k)
            return _unlisted(k)
        near = self._nearest(k)
        regular = [v for v in near if is_regular(self.leads, v)]
        joined = self._are_joined(circuit, regular) if regular else None
        if joined:
            return _changes(DefectKind.BRANCH, k)
        limit = self._limit_at(circuit, k)
        if not near and not limit:
            return _unreached(listed, k)
        if not regular or limit:
            return _at_limit(limit or _LIMIT, k)
        if joined is None:
            return _not_proved(f"the circuit of position {k} was not followed to its end")
        return _changes(DefectKind.CIRCUIT, k)

    def _are_joined(self, first: FollowedCircuit, near: Sequence[Array]) -> bool | None:
        """Whether one of some positions (N,) is on a circuit; ``None`` if the circuits cannot be
        followed to their ends.

        Two circuits are the same if their arcs meet at a change point. They differ if one is
        complete without the other's position.
        """
        if any(first.has(v) for v in near):
            return True
        others: list[FollowedCircuit] = []
        for v in () if first.is_whole else near:
            other = FollowedCircuit(self.explorer, v)
            if not any(other.meets(one) for one in others):
                others.append(other)
        while True:
            for one in (first, *others):
                one.join_arcs()
            if any(first.meets(other) for other in others):
                return True
            others = [other for other in others if not other.is_whole]
            if first.is_whole or not others:
                return False
            ahead = [one for one in (first, *others) if not one.ended]
            if not ahead:
                return None
            # from both sides
            min(ahead, key=lambda one: len(one.arcs)).follow_next()

    def _limit_at(self, circuit: FollowedCircuit, k: int) -> str:
        """Where a branch of a circuit ends at a position: "dead point", "change point" or ""."""
        ends = (self._end_at(branch, k) for branch in circuit.branches())
        return next(filter(None, ends), "")

    def _end_at(self, branch: CurveBranch, k: int) -> str:
        """Where a branch ends at a position, to rounding: "dead point", "change point" or ""."""
        p = self.leads.parameter
        scale, turns = float(self.leads.scale[p]), self.leads.is_angle[p : p + 1]
        for limit, v in ((branch.limits[end], branch.v[end]) for end in (0, -1)):
            gap = within_half_a_turn(v[p : p + 1] - self.values[k], turns)
            if not limit or abs(float(gap[0])) > _MISSED * scale:
                continue
            missed = float(self._distances(v[None, :], k)[0])
            # next to a dead point places move by about the square root of the input's change
            if missed <= np.sqrt(_MISSED) * self._way(branch):
                return limit
        return ""

    def _no_start(self) -> Defect:
        """Why no circuit of the first position can be followed."""
        listed = self._list(0)
        if listed.completeness is Completeness.NOT_LISTED:
            return _unlisted(0)
        if self._regular_starts():
            return _not_proved("the circuit of position 1 cannot be followed")
        if len(listed.v):
            return _at_limit(_LIMIT, 0)
        return _unreached(listed, 0)

    def _list(self, k: int) -> Assemblies:
        """All configurations at the input of a position."""
        if k not in self._lists:
            self._lists[k] = positions_at(self.model, self.drive.path.at(self.values[k]))
        return self._lists[k]

    def _nearest(self, k: int) -> list[Array]:
        """The configurations (N,) that come nearest to a position; all whose points agree."""
        v = self._list(k).v
        if not len(v):
            return []
        missed = self._distances(v, k)
        same = _EQUALLY_NEAR * self.model.equations.length_scale
        return list(v[missed <= missed.min() + same])

    def _distances(self, v: Array, k: int) -> Array:
        """The sum of the distances of points from their places at variables (K, N), (K,)."""
        here = zip(self._points(v), self.places[k].values(), strict=True)
        return np.asarray(sum(np.abs(z - place) for z, place in here))

    def _points(self, v: Array) -> list[ComplexArray]:
        """The points that have places at variables (K, N), (K,) each."""
        places = self.model.compiled.points.places(v)
        return [places[:, number] for number in self._numbers]


def _claim(defect: Defect) -> tuple[bool, int, bool]:
    """What is not proved comes first, then the defect that occurs last, and the milder one."""
    proved = defect.kind is not DefectKind.NOT_PROVED
    return proved, -max(defect.between or (0,)), defect.kind is not DefectKind.BRANCH


def _changes(kind: DefectKind, k: int) -> Defect:
    """A change before the position number k from 0."""
    message = f"{kind.value} between positions {k} and {k + 1}"
    return Defect(kind=kind, between=(k, k + 1), message=message)


def _not_proved(why: str) -> Defect:
    return Defect(kind=DefectKind.NOT_PROVED, message=f"not proved: {why}")


def _at_limit(limit: str, k: int) -> Defect:
    return _not_proved(f"position {k + 1} is at a {limit}")


def _unlisted(k: int) -> Defect:
    return _not_proved(
        f"position {k + 1} is not on the circuit of the guess, and the configurations of these "
        "equations cannot be listed"
    )


def _unreached(listed: Assemblies, k: int) -> Defect:
    message = f"no position of the mechanism has the input of position {k + 1}"
    if not listed.completeness.complete:
        return _not_proved(message)
    return Defect(kind=DefectKind.RANGE, message=message)
