"""Circuit and branch defects of a mechanism of any kind, by following the circuit of a position."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.design.synthesis.defect_messages import Defect
from linkwork.design.synthesis.verdicts import DefectKind
from linkwork.foundation.angles import within_half_a_turn
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.completeness import Completeness
from linkwork.motion.assembly.assembling import Assemblies, positions_at
from linkwork.motion.circuit.followed_circuit import (
    FollowedCircuit,
    explorer_of,
    is_regular,
    straight_way,
)
from linkwork.motion.curve_branches import CurveBranch
from linkwork.motion.drive import Drive
from linkwork.motion.model import Model
from linkwork.motion.named_quantities import RowValues
from linkwork.motion.start import first_position
from linkwork.numerics.continuation.local_parametrization import coincide
from linkwork.numerics.newton import NewtonOptions

__all__ = ["defects_by_circuits"]

# of a point's way: a position that is missed by less lies on the branch, and other branches are
# farther away, unless the input is nearer than the square of this to a dead point
_MISSED = 1e-6
# of the mechanism's size: nearer to a place than this, configurations are equally near
_EQUALLY_NEAR = 1e-9

#: Places of some points [length].
Places = Mapping[str, complex]


def defects_by_circuits(
    model: Model, inputs: Sequence[float], places: Sequence[Places]
) -> tuple[Defect, ...]:
    """The circuit or branch defect of a mechanism that passes positions; none if it has neither.

    Most mechanisms pass their positions on the branch of the guess, straight from the least to
    the greatest input. Else a position is the configuration at its input that comes nearest to its
    places, and the circuit of the first one is followed until all are met, or all of it.

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
        If the mechanism has no input, or several that time drives.
    """
    return _Search(Drive.of_circuits(model), inputs, places).defects()


@dataclass(frozen=True, kw_only=True, eq=False)
class _Start:
    """A first position (N,), its circuit, and the branches that it may lie on."""

    v: Array
    circuit: FollowedCircuit
    branches: list[CurveBranch]


class _Search:
    def __init__(self, drive: Drive, inputs: Sequence[float], places: Sequence[Places]) -> None:
        self.drive, self.model, self.leads = drive, drive.model, drive.leads
        self.values = [float(value) * drive.unit for value in inputs]
        self.places = places
        self.explorer = explorer_of(drive)
        self._lists: dict[int, Assemblies] = {}
        self._ways: dict[CurveBranch, float] = {}

    def defects(self) -> tuple[Defect, ...]:
        """None if one branch passes all positions, else the defect of that which comes farthest."""
        if len(self.values) < 2:
            return ()
        guess = self._guess()
        way = None if guess is None else straight_way(self.drive, guess, self.values[:1])
        mine = [] if way is None else [way[0]]
        if any(self._is_straight(v) for v in mine):
            return ()
        others = [
            v for v in self._regular_starts() if not any(coincide(self.leads, v, w) for w in mine)
        ]
        if any(self._is_straight(v) for v in others):
            return ()
        starts = self._starts(guess)
        found = [] if starts else [self._no_start()]
        for start in starts:
            defect = self._first_defect(start)
            if defect is None:
                return ()
            found.append(defect)
        return (min(found, key=_claim),)

    def _guess(self) -> Array | None:
        """The position (N,) of the guess, if the input can lead there."""
        inputs = self.model.start_inputs
        done = first_position(self.model, inputs, NewtonOptions(), explained=False)
        return done.v if done.status.ok and is_regular(self.leads, done.v) else None

    def _is_straight(self, v: Array) -> bool:
        """Whether the branch of a position (N,) passes all positions, followed straight."""
        here = straight_way(self.drive, v, self.values)
        if here is None:
            return False
        way = sum(float(np.abs(np.diff(z)).sum()) for z in self._points(here))
        missed = [self._distances(here[k : k + 1], k)[0] for k in range(len(here))]
        return bool(max(missed) <= _MISSED * way)

    def _starts(self, guess: Array | None) -> list[_Start]:
        """Every circuit and branch that the first position may lie on."""
        if self._list(0).completeness is Completeness.NOT_LISTED:
            if guess is None:
                return []
            circuit = FollowedCircuit(self.explorer, guess)
            branches = [b for b in circuit.branches() if self._passes(circuit, b, 0)]
            return [_Start(v=guess, circuit=circuit, branches=branches)] if branches else []
        starts: list[_Start] = []
        for v in self._regular_starts():
            circuit = FollowedCircuit(self.explorer, v)
            branch = next((b for b in circuit.known if circuit.lies_on(b, v)), None)
            if branch is not None:
                starts.append(_Start(v=v, circuit=circuit, branches=[branch]))
        return starts

    def _regular_starts(self) -> list[Array]:
        """The configurations (N,) nearest to the first position at which the input can lead."""
        return [v for v in self._nearest(0) if is_regular(self.leads, v)]

    def _first_defect(self, start: _Start) -> Defect | None:
        """Where the first branch is left that passes all positions up to there."""
        branches = start.branches
        for k in range(1, len(self.values)):
            branches = self._passing(start.circuit, branches, k)
            if not branches:
                return self._change(start, k)
        return None

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
            way = sum(float(np.abs(np.diff(z)).sum()) for z in self._points(branch.v))
            self._ways[branch] = way
        return self._ways[branch]

    def _change(self, start: _Start, k: int) -> Defect:
        """The defect in front of a position that the branches of the one before do not pass."""
        circuit, listed = start.circuit, self._list(k)
        if listed.completeness is Completeness.NOT_LISTED:
            if any(self._passes(circuit, branch, k) for branch in circuit.branches()):
                return _changes(DefectKind.BRANCH, k)
            return _unlisted(k)
        near = self._nearest(k)
        if not near and not self._is_limit(circuit, k):
            return _unreached(listed, k)
        near = [v for v in near if is_regular(self.leads, v)]
        joined = self._are_joined(circuit, near) if near else None
        if joined:
            return _changes(DefectKind.BRANCH, k)
        if not near or self._is_limit(circuit, k):
            return _at_dead_point(k)
        if joined is None:
            return _not_proved(f"the circuit of position {k} was not followed to its end")
        return _changes(DefectKind.CIRCUIT, k)

    def _are_joined(self, mine: FollowedCircuit, near: Sequence[Array]) -> bool | None:
        """Whether one of some positions (N,) is on a circuit; ``None`` if the circuits cannot be
        followed to their ends.

        Two circuits are one where their arcs meet at a change point, and they are two as soon as
        one of them is whole without the other's position.
        """
        if any(mine.has(v) for v in near):
            return True
        others: list[FollowedCircuit] = []
        for v in () if mine.is_whole else near:
            other = FollowedCircuit(self.explorer, v)
            if not any(other.meets(one) for one in others):
                others.append(other)
        while True:
            for one in (mine, *others):
                one.join_arcs()
            if any(mine.meets(other) for other in others):
                return True
            others = [other for other in others if not other.is_whole]
            if mine.is_whole or not others:
                return False
            ahead = [one for one in (mine, *others) if not one.ended]
            if not ahead:
                return None
            # from both sides
            min(ahead, key=lambda one: len(one.arcs)).follow_next()

    def _is_limit(self, circuit: FollowedCircuit, k: int) -> bool:
        """Whether a position is at an end of a branch, to the rounding of its input."""
        p = self.leads.parameter
        scale, turns = float(self.leads.scale[p]), self.leads.is_angle[p : p + 1]
        for branch in circuit.branches():
            for turn in (branch.begin, branch.end):
                if turn is None:
                    continue
                gap = within_half_a_turn(np.array([turn.t - self.values[k]]), turns)
                if abs(float(gap[0])) > _MISSED * scale:
                    continue
                missed = float(self._distances(turn.v[None, :], k)[0])
                # next to a dead point places move by about the square root of the input's change
                if missed <= np.sqrt(_MISSED) * self._way(branch):
                    return True
        return False

    def _no_start(self) -> Defect:
        """Why no circuit of the first position can be followed."""
        listed = self._list(0)
        if listed.completeness is Completeness.NOT_LISTED:
            return _unlisted(0)
        if self._regular_starts():
            return _not_proved("the circuit of position 1 cannot be followed")
        return _at_dead_point(0) if len(listed.v) else _unreached(listed, 0)

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
        still = np.zeros_like(v)
        rows = RowValues(self.model, v, still, still, np.ones(len(v), dtype=bool))
        return [
            rows.series(f"{name}.x").value + 1j * rows.series(f"{name}.y").value
            for name in self.places[0]
        ]


def _claim(defect: Defect) -> tuple[bool, int, bool]:
    """What is not proved comes first, then the defect that occurs last, and the milder one."""
    proved = defect.kind is not DefectKind.NOT_PROVED
    return proved, -max(defect.between or (0,)), defect.kind is not DefectKind.BRANCH


def _changes(kind: DefectKind, k: int) -> Defect:
    """A change before the position number k from 0."""
    message = f"{kind.value} between positions {k} and {k + 1}"
    return Defect(kind=kind, between=(k, k + 1), message=message)


def _not_proved(why: str) -> Defect:
    return Defect(kind=DefectKind.NOT_PROVED, between=None, message=f"not proved: {why}")


def _at_dead_point(k: int) -> Defect:
    return _not_proved(f"position {k + 1} is at a dead point")


def _unlisted(k: int) -> Defect:
    return _not_proved(
        f"position {k + 1} is not on the circuit of the guess, and the configurations of these "
        "equations cannot be listed"
    )


def _unreached(listed: Assemblies, k: int) -> Defect:
    message = f"no position of the mechanism has the input of position {k + 1}"
    if not listed.completeness.complete:
        return _not_proved(message)
    return Defect(kind=DefectKind.RANGE, between=None, message=message)
