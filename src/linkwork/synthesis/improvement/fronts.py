"""The designs that no other one surpasses in every objective, and a spread of them.

References
----------
V. Pareto, Manuale di economia politica, Società Editrice Libraria, Milano 1906.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import combinations, product

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray
from linkwork.core.motion.model import model_of
from linkwork.synthesis.improvement.fit_problem import (
    APPROACH,
    FitProblem,
    FittedNumbers,
    Fitting,
    TradeOff,
    check_moved,
)
from linkwork.synthesis.improvement.proved_design import (
    ImprovedDesign,
    fitted_design,
    interrupted_design,
)
from linkwork.synthesis.lane_least_squares import starts_of

_ALIKE = 1e-6  # of the span of an objective: repeated fits agree to this


def objective_spans(values: Array, every: Array | None = None) -> Array:
    """The ranges of objectives over designs (D, K), (K,).

    If values differ by a millionth of the largest at most, the largest (of ``every`` design if
    passed) is used instead.
    """
    spans = np.ptp(values, axis=0) if len(values) else np.zeros(values.shape[1])
    largest = np.abs(values if every is None else every).max(axis=0, initial=0.0)
    flat = spans <= _ALIKE * largest
    return np.where(flat, np.where(largest > 0.0, largest, 1.0), spans)


def alike(values: Array, k: int, spans: Array) -> IndexArray:
    """The designs whose objectives (D, K) equal those of one, to the accuracy of fits."""
    return np.flatnonzero((np.abs(values - values[k]) <= _ALIKE * spans).all(axis=1))


def undominated(values: Array) -> IndexArray:
    """The designs, by rising first objective, that no other one dominates.

    A design dominates another one if no objective is larger by more than fits agree to, and one is
    smaller by more than that. Of equal designs the one with the smallest sum stays.

    Parameters
    ----------
    values : (D, K)
        Objectives; smaller is better. Designs without all of them are left out.
    """
    known = np.flatnonzero(np.isfinite(values).all(axis=1))
    rows = values[known]
    if not len(rows):
        return known
    scaled = (rows - rows.min(axis=0)) / objective_spans(rows[_strictly(rows)], rows)
    kept: list[int] = []
    for k in np.argsort(scaled.sum(axis=1), kind="stable"):
        no_larger = scaled[kept] <= scaled[k] + _ALIKE
        if not no_larger.all(axis=1).any():
            kept.append(int(k))
    order = np.lexsort(rows[kept].T[::-1])
    return np.asarray(known[np.array(kept)[order]])


def _strictly(values: Array) -> IndexArray:
    """The designs that no other one dominates by any difference."""
    order = np.lexsort(values.T[::-1])
    kept: list[int] = []
    for k in order:
        if not (values[kept] <= values[k]).all(axis=1).any():
            kept.append(int(k))
    return np.array(kept, dtype=np.intp)


def spread(values: Array, count: int) -> IndexArray:
    """So many of the designs of a front (D, K), in their order: those with the least of an
    objective, then always the one farthest from those taken.
    """
    if len(values) <= count:
        return np.arange(len(values))
    scaled = (values - values.min(axis=0)) / objective_spans(values)
    taken = list(dict.fromkeys(map(int, scaled.argmin(axis=0))))[:count]
    away = np.full(len(values), np.inf)
    for k in taken:
        away = np.minimum(away, np.linalg.norm(scaled - scaled[k], axis=1))
    while len(taken) < count:
        far = int(away.argmax())
        taken.append(far)
        away = np.minimum(away, np.linalg.norm(scaled - scaled[far], axis=1))
    return np.sort(np.array(taken, dtype=np.intp))


# ----------------------------------------------------------------------
# Designs between several objectives: weighted sums, then limits where the front has gaps.
#
# Every objective is minimised alone from all starts. Weighted sums begin at these designs and find
# the convex parts of the front. Between neighbours that are far apart, one objective is limited and
# another one minimised, which finds the rest; a gap that stays is a jump of the front.
#
# References
# ----------
# I. Y. Kim, O. L. de Weck, Adaptive weighted-sum method for bi-objective optimization, Structural
# and Multidisciplinary Optimization 29 (2005) 149-158, doi:10.1007/s00158-004-0465-1.


_OTHERS = (0.1, 0.01, 1e-3, 1e-4)  # weights that decide between equal designs
_STEPS = 40  # of each round
_ROUNDS = (40, 20, 20, 20, 20)  # steps; after each the shifts of limits and bounds change
_BEST = 2  # minima of each objective at which weighted sums begin
_EVEN = 1.2  # parts of an even front: narrower gaps are not divided
_FILLINGS = 3  # rounds that fill gaps
#: The largest residual of a bound that holds: less than its margin.
BROKEN = 1e-5


def fit_front(
    fitting: Fitting,
    starts: Array,
    count: int,
    *,
    progress: Callable[[float], None] | None = None,
) -> FittedNumbers:
    """All designs on the way to a front of ``count`` designs, from starts (D, P)."""
    front = _Front(fitting, starts, count, progress)
    try:
        for stage in (front.minimise_each, front.weigh, front.limit):
            stage()
            if front.problem.work.stopped:
                break
    except KeyboardInterrupt:
        # between the steps of lanes
        front.fit = replace(front.fit, interrupted=True)
    return front.result()


class _Front:
    """Lanes of one problem, taken into use stage by stage."""

    def __init__(
        self,
        fitting: Fitting,
        starts: Array,
        count: int,
        progress: Callable[[float], None] | None,
    ) -> None:
        probe = FitProblem(fitting, 1)
        self.size, self.count = len(probe.objectives.names), count
        self.weights = _weights(self.size, count)
        self.limits = _levels(self.size, count)
        alone = self.size * len(starts)
        weighted = len(self.weights) * self.size * _BEST
        between = 2 * count * _FILLINGS if self.size == 2 else len(self.limits)
        self.used, lanes = 0, alone + weighted + between
        self.problem = FitProblem(fitting, lanes)
        self.problem.work.tell = progress
        fillings = _FILLINGS if self.size == 2 else 1
        self.problem.work.whole = APPROACH + len(_OTHERS) * _STEPS + (2 + fillings) * sum(_ROUNDS)
        self.alone = np.arange(alone)
        fit = self.problem.reached(self.problem.begun(np.tile(starts, (self.size, 1))), self.alone)
        if not fit.interrupted:
            check_moved(self.problem)
        # lanes that are not used yet
        self.fit = fit.take(np.minimum(np.arange(lanes), alone - 1))
        self.trade = self._trade(lanes)
        self._tried: set[tuple[int, float]] = set()

    def _trade(self, lanes: int) -> TradeOff:
        objectives = self.problem.objectives
        values = self._values(self.alone)
        scale = np.nanmax(np.where(np.isfinite(values), values, np.nan), axis=0, initial=0.0)
        weights = np.ones((lanes, self.size))
        limits = np.full_like(weights, np.inf)
        return TradeOff(objectives, np.where(scale > 0.0, scale, 1.0), weights, limits)

    def _values(self, lanes: IndexArray) -> Array:
        """Objectives of lanes (D, K), infinite where they are not known or a bound is broken."""
        result = self.problem.measured(self.fit, lanes)
        values = self.problem.objectives.values(result)
        fine = np.isfinite(values).all(axis=1) & (self.problem.objectives.broken(result) <= BROKEN)
        return np.where(fine[:, None], values, np.inf)

    def _run(self, lanes: IndexArray, rounds: Sequence[int]) -> None:
        self.problem.trade = self.trade
        for k, steps in enumerate(rounds):
            running = lanes[np.isfinite(self.fit.total[lanes]) | (k == 0)]
            if not len(running) or self.fit.interrupted:
                break
            if k == len(rounds) - 1:
                self.problem.correct(self.fit, running)
            self.fit = self.problem.further(self.fit, running, steps)
        self.used = max(self.used, int(lanes.max(initial=-1)) + 1)

    def _begin(self, parents: Sequence[int]) -> IndexArray:
        """New lanes that start at the state of other lanes."""
        of = np.array(parents, dtype=np.intp)
        to = self.used + np.arange(len(of))
        self.fit = replace(
            self.fit, x=self.fit.x.copy(), t=self.fit.t.copy(), total=self.fit.total.copy()
        )
        self.problem.copy_lanes(self.fit, of, to)
        return to

    def minimise_each(self) -> None:
        """Minimise each objective alone; the others decide between equal designs."""
        goal = np.repeat(np.arange(self.size), len(self.alone) // self.size)
        for other in _OTHERS:
            self.trade.weights[self.alone] = other
            self.trade.weights[self.alone, goal] = 1.0
            self._run(self.alone, (_STEPS,))
        if self.problem.multipliers:
            self._run(self.alone, _ROUNDS)

    def weigh(self) -> None:
        """Weighted sums, from the best designs of each objective."""
        values = self._values(self.alone)
        parents: list[int] = []
        for each in values.T:
            best = np.argsort(each, kind="stable")[:_BEST]
            parents += [int(k) for k in best if np.isfinite(each[k])]
        if not parents:
            return
        front = values[undominated(values)]
        spans = objective_spans(front)
        weights = [weight for weight in self.weights for _ in parents]
        lanes = self._begin(parents * len(self.weights))
        # squares of large objectives with small spans would outweigh bounds
        smaller = float(np.min(spans / np.maximum(spans, front.max(axis=0))))
        self.trade.weights[lanes] = np.array(weights) * (smaller * self.trade.units / spans)
        self._run(lanes, _ROUNDS if self.problem.multipliers else (2 * _STEPS,))

    def limit(self) -> None:
        """Minimise one objective with limits on the others."""
        if self.size > 2:
            self._level()
            return
        for _ in range(_FILLINGS):
            if not self._fill() or self.fit.interrupted:
                break

    def _fill(self) -> bool:
        """Limits that divide the widest gaps between neighbours; whether there were any."""
        values = self._values(np.arange(self.used))
        front = undominated(values)
        places = values[front]
        if len(front) < 2:
            return False
        spans = objective_spans(places)
        scaled = (places - places.min(axis=0)) / spans
        gaps = np.linalg.norm(np.diff(scaled, axis=0), axis=1)
        fillings: list[tuple[int, int, int, float, float]] = []
        for k, part in enumerate(_divided(gaps, self.count, self.count - len(front))):
            held = int(np.abs(scaled[k + 1] - scaled[k]).argmax())
            low, high = places[k, held], places[k + 1, held]
            for share in np.arange(1, part) / part:
                limit = float(low + share * (high - low))
                if (held, limit) not in self._tried:
                    self._tried.add((held, limit))
                    fillings.append((int(front[k]), int(front[k + 1]), held, float(share), limit))
        fillings = fillings[: (len(self.fit) - self.used) // 2]
        if not fillings:
            return False
        one, other, held_ones, shares, limits = (
            np.array(part) for part in zip(*fillings, strict=True)
        )
        nearer = np.where(shares < 0.5, one, other)
        lanes = self._begin([*nearer, *nearer])
        # from the nearer neighbour, and from a design between both
        between = self.fit.x[one] + shares[:, None] * (self.fit.x[other] - self.fit.x[one])
        self.problem.trade = None
        self.problem.move(self.fit, lanes[len(fillings) :], between)
        held_ones = np.tile(held_ones, 2)
        self._set_free(lanes, places, spans)
        self.trade.weights[lanes, held_ones] *= _OTHERS[-1]
        self.trade.limits[lanes, held_ones] = np.tile(limits, 2) / self.trade.units[held_ones]
        self._run(lanes, _ROUNDS)
        return True

    def _set_free(self, lanes: IndexArray, places: Array, spans: Array) -> None:
        """Weights of objectives that are minimised, and stiffness of limits, for lanes.

        Objectives count by their largest values on the front (F, K), limits by its spans: where
        an objective is large and its span small, squares of what is left would outweigh limits.
        """
        largest = places.max(axis=0)
        self.trade.weights[lanes] = self.trade.units / np.where(largest > 0.0, largest, spans)
        self.trade.stiffness[lanes] = self.trade.units / spans

    def _level(self) -> None:
        """Limits of all objectives but one at levels between the least and the largest values."""
        every = np.arange(self.used)
        values = self._values(every)
        front = undominated(values)
        if len(front) < 2:
            return
        places = values[front]
        low, spans = places.min(axis=0), objective_spans(places)
        parents, kept, limits = [], [], []
        for free, shares in self.limits:
            limit = low + shares * spans
            over = np.maximum(0.0, (places - limit) / spans)
            over[:, free] = 0.0
            parents.append(int(front[np.linalg.norm(over, axis=1).argmin()]))
            kept.append(free)
            limits.append(limit / self.trade.units)
        lanes = self._begin(parents)
        self._set_free(lanes, places, spans)
        self.trade.weights[lanes] *= _OTHERS[-1]
        self.trade.weights[lanes, kept] /= _OTHERS[-1]
        self.trade.limits[lanes] = limits
        self.trade.limits[lanes, kept] = np.inf
        self._run(lanes, _ROUNDS)

    def result(self) -> FittedNumbers:
        """All lanes that were used; the sum of those that break a bound is infinite."""
        self.problem.trade = None
        fit = replace(
            self.fit,
            total=np.where(np.arange(len(self.fit)) < self.used, self.fit.total, np.inf),
        )
        return self.problem.result(fit)


def _weights(size: int, count: int) -> Array:
    """Weights spread over the objectives, (W, K); the sum of their squares is 1."""
    parts = size
    while True:
        shares = [np.diff([0, *ends, parts]) for ends in combinations(range(1, parts), size - 1)]
        if 2 * len(shares) >= count:
            return np.sqrt(np.array(shares) / parts)
        parts += 1


def _levels(size: int, count: int) -> list[tuple[int, Array]]:
    """The objective that is free, and the levels of the others as shares of their spans, (K,)."""
    if size == 2:
        return []
    steps = 2
    while steps ** (size - 1) < count:
        steps += 1
    shares = np.arange(1, steps + 1) / (steps + 1)
    between = [
        (free, np.array(levels))
        for free in range(size)
        for levels in product(*(([0.0] if k == free else shares) for k in range(size)))
    ]
    return between[:: -(-len(between) // (_FILLINGS * count))]


def _divided(gaps: Array, count: int, missing: int) -> list[int]:
    """Into how many parts gaps are divided, the widest one always first: so that no design is
    missing, and no part is wider than those of an even front of ``count`` designs.
    """
    parts = np.ones(len(gaps), dtype=int)
    even = float(gaps.sum()) / max(1, count - 1)
    for added in range(count):
        widest = int((gaps / parts).argmax())
        if added >= missing and gaps[widest] / parts[widest] <= _EVEN * even:
            break
        parts[widest] += 1
    return [int(part) for part in parts]


# ----------------------------------------------------------------------
# The proved designs of a front: those that no other sound design surpasses in every goal.


def front_designs(
    fits: Sequence[FittedNumbers],
    count: int,
    is_sound: Callable[[ImprovedDesign], bool],
    tell: Callable[[float], None],
) -> tuple[ImprovedDesign, ...]:
    """The front by rising first goal, then the designs that are not sound.

    Goals are measured anew on the motion that proves a design. A design that is not sound makes
    room for those that only it dominates. An interruption ends the proofs: the front is that of the
    designs proved by then.

    Parameters
    ----------
    fits : sequence of FittedNumbers
    count : int
        The largest number of designs of the front.
    is_sound : callable
        Whether a proved design meets every requirement.
    tell : callable
        Called before each proof with the finished fraction of the proofs.

    Raises
    ------
    KeyboardInterrupt
        If no design was proved before it.
    """
    lanes = [(fit, k) for fit in fits for k in np.flatnonzero(np.isfinite(fit.total)).tolist()]
    values = np.array([fit.objectives[k] for fit, k in lanes])
    values = values.reshape(len(lanes), len(fits[0].names))
    broken = np.array([fit.broken[k] for fit, k in lanes])
    kept = broken <= BROKEN
    if len(lanes) and not kept.any():
        # the design that comes nearest to the bounds is shown, and refused
        kept[broken.argmin()] = True
    values = np.where(kept[:, None], values, np.inf)
    proved: dict[int, ImprovedDesign] = {}
    refused: dict[int, ImprovedDesign] = {}
    share, stopped = 0.0, False
    while True:
        front = undominated(values)
        chosen = [int(k) for k in front[spread(values[front], count)]]
        new = [k for k in chosen if k not in proved]
        if not new:
            break
        spans = objective_spans(values[front])
        every = len(proved) + len(new)
        try:
            for k in new:
                share = max(share, len(proved) / every)
                tell(share)
                design = _measured(fitted_design(*lanes[k]), *lanes[k])
                if is_sound(design):
                    # equal designs would take its place by rounding
                    values[alike(values, k, spans)] = np.inf
                    values[k] = list(design.goals.values())
                else:
                    values[k] = np.inf
                    refused[k] = design
                proved[k] = design
        except KeyboardInterrupt:
            stopped = True
            values[[k not in proved for k in range(len(lanes))]] = np.inf
    if stopped and not proved:
        raise KeyboardInterrupt
    designs = (*(proved[k] for k in chosen), *refused.values())
    return tuple(map(interrupted_design, designs)) if stopped else designs


def _measured(design: ImprovedDesign, fit: FittedNumbers, k: int) -> ImprovedDesign:
    """The design of a lane with its goals on its own proved motion."""
    if design.motion is None or not design.motion.found.any():
        return design
    path = fit.fitting.path
    at = None if path is None else replace(path, inputs=fit.t[k], timed=True)
    model = model_of(design.description)
    problem = FitProblem(replace(fit.fitting, model=model, motion=design.motion, path=at), 1)
    x = np.array(list(design.numbers.values()))[None]
    misses = problem.measured(starts_of(x, np.zeros((1, 0))), np.zeros(1, dtype=int))
    values = problem.objectives.values(misses)[0]
    design = replace(design, goals=dict(zip(design.goals, map(float, values), strict=True)))
    if np.isfinite(values).all():
        return design
    message = f"{design.message}; a goal has no value on the branch of its table"
    return replace(design, sound=False, message=message)
