"""Rest: which way the loads start a machine that friction, a stop or a load holds, and when."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from linkwork.dynamics.events import BEHIND, Bound
from linkwork.dynamics.joint_friction import Rubbing
from linkwork.dynamics.reduced_leg import ReducedLeg
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.rounding import EPSILON

__all__ = ["Support", "excesses", "first_start", "just_ahead"]

_PIECES, _NODES, _LOOKS = 64, 17, 33  # pieces of the time at first, and places on each
_DEEPEST = 12  # halvings of a piece
_RESOLVED = 1e-4  # of the largest value: last coefficients of a polynomial through the places
_HALVINGS = 60
_ROUNDING = 1e-14  # of the larger acceleration
_MARGIN = 4.0  # of the change of an acceleration within rounding of the place
_SLOW = 1e-20  # of the leg in a second: a speed that has a direction only; also of accelerations


def excesses(leg: ReducedLeg, s: float, times: Array, gain: Array, ways: Sequence[float]) -> Array:
    """The acceleration along each of the ways ±1 with which a machine at rest would start, (B, W);
    not positive where it stays.

    It starts in a direction if friction against this motion, and loads that switch with it, leave
    an acceleration along it. That is where the effort of the input lies beyond those that hold it:
    see ``crank.effort.backward``. All switches must follow the state.
    """
    found = {}
    for way in (1.0, -1.0):
        rubbing = None
        if leg.friction is not None:
            rubbing = Rubbing(direction=way, ways=leg.friction.ways(s, way))
        near, pace = just_ahead(leg, s, way)
        speed = np.full_like(times, pace)
        # an equilibrium between two floating-point numbers pulls away on both sides
        pull, further = (
            way * leg.acceleration(np.full_like(times, place), speed, times, gain, rubbing)
            for place in (near, 2.0 * near - s)
        )
        with np.errstate(invalid="ignore"):
            pull = pull - _MARGIN * np.nan_to_num(np.maximum(further - pull, 0.0), posinf=0.0)
        # friction locks, but a load without a value ends the rest
        found[way] = np.where(np.isfinite(pull), pull, 0.0 if rubbing else np.inf)
    size = np.maximum(np.abs(found[1.0]), np.abs(found[-1.0]))
    least = _SLOW * float(np.ptp(leg.table.edges))
    rounding = np.where(np.isfinite(size), _ROUNDING * size + least, 0.0)
    return np.stack([found[way] - rounding for way in ways], axis=1)


def just_ahead(leg: ReducedLeg, s: float, way: float) -> tuple[float, float]:
    """Place and speed of a motion that begins at ``s``."""
    size = float(np.ptp(leg.table.edges))
    return s + way * BEHIND * EPSILON * (abs(s) + size), way * _SLOW * size


def first_start(
    leg: ReducedLeg, s: float, t: float, until: float, gain: Array, ways: Sequence[float]
) -> tuple[float, float]:
    """When a machine at rest starts to move in one of the ways, and in which; ``until`` and 0 if
    it does not. Located to rounding.
    """

    def pull(times: Array) -> Array:
        found: Array = excesses(leg, s, times, gain, ways)
        return found

    if not ways:
        return until, 0.0
    # friction that locks one way leaves the other; both at once is for the larger
    now = pull(np.array([t]))[0]
    if now.max() > 0.0:
        return t, float(ways[int(np.argmax(now))])
    if until <= t or "t" not in leg.reduction.names:
        return until, 0.0
    edges = np.linspace(t, until, _PIECES + 1)
    # a pulse between two comparisons may be short
    edges = np.union1d(edges, [*_switch_times(leg, s, edges, gain)])
    for low, high in pairwise(edges.tolist()):
        start = _first_positive(lambda x: pull(x).max(axis=1), low, high, _DEEPEST)
        if start is not None:
            return start, float(ways[int(np.argmax(pull(np.array([start]))[0]))])
    return until, 0.0


def _switch_times(leg: ReducedLeg, s: float, edges: Array, gain: Array) -> Iterator[float]:
    """Just after comparisons change their values during a rest."""
    if not leg.reduction.switch_count:
        return

    def positive(times: Array) -> BoolArray:
        found: BoolArray = leg.margins(np.full_like(times, s), 0.0 * times, times, gain) > 0.0
        return found

    values = positive(edges)
    for k, number in np.argwhere(values[1:] != values[:-1]).tolist():
        low, high = edges[k : k + 2].tolist()
        while high - low > 2.0 * math.ulp(
            max(high, edges[1])
        ):  # at t = 0 the first piece is the scale
            middle = 0.5 * (low + high)
            same = positive(np.array([middle]))[0, number] == values[k, number]
            low, high = (middle, high) if same else (low, middle)
        yield high


def _first_positive(
    function: Callable[[Array], Array], low: float, high: float, depth: int
) -> float | None:
    """Just after a function becomes positive between two times; ``None`` if it does not."""
    x = np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
    values = function(0.5 * (low + high) + 0.5 * (high - low) * x)
    last = np.abs(np.polynomial.chebyshev.chebfit(x, values, _NODES - 1)[-2:]).max()
    if last > _RESOLVED * np.abs(values).max() and depth > 0:
        middle = 0.5 * (low + high)
        first = _first_positive(function, low, middle, depth - 1)
        return first if first is not None else _first_positive(function, middle, high, depth - 1)
    times = np.linspace(low, high, _LOOKS)
    positive = np.flatnonzero(function(times) > 0.0)
    if not len(positive):
        return None
    if positive[0] == 0:
        return low
    low, high = times[positive[0] - 1 : positive[0] + 1].tolist()
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if high - low <= 2.0 * math.ulp(high):
            break
        low, high = (low, middle) if function(np.array([middle]))[0] > 0.0 else (middle, high)
    return high


@dataclass(frozen=True, eq=False)
class Support:
    """The stops that a machine at rest touches: their numbers by the way that each blocks."""

    bounds: Sequence[Bound]
    touching: Mapping[float, int]

    @property
    def free(self) -> list[float]:
        """The ways that no stop blocks."""
        return [way for way in (1.0, -1.0) if way not in self.touching]

    def pushes(
        self, leg: ReducedLeg, s: float, times: Array, gain: Array
    ) -> list[tuple[int, float]]:
        """The number of the stop that pushes and its push at times (B,); -1 for none, NaN with
        friction, which leaves it open.
        """
        if not self.touching:
            return [(-1, 0.0)] * len(times)
        here = np.full_like(times, s)
        force = leg.acceleration(here, 0.0 * times, times, gain) * leg.numbers(here)[:, 0]
        found = []
        for one in force.tolist():
            number = self.touching.get(math.copysign(1.0, one), -1)
            push = 0.0 if number < 0 else -one / self.bounds[number].slope(leg, s, 0.0, gain)
            found.append((number, math.nan if leg.reduction.rubs and number >= 0 else push))
        return found

    def holder(self, leg: ReducedLeg, s: float, t: float, gain: Array) -> str:
        """What holds a machine that stays at rest; "" if nothing has to."""
        ways = (1.0, -1.0)
        pulls = excesses(leg, s, np.array([t]), gain, ways)[0]
        for way, pull in zip(ways, pulls, strict=True):
            if pull > 0.0 and way in self.touching:
                return f"the stop of {self.bounds[self.touching[way]].asked.name}"
        if leg.reduction.rubs:
            return "friction"
        return "a load that switches there" if leg.reduction.switch_count else ""
