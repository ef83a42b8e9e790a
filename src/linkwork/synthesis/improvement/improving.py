"""Improve a mechanism: better numbers for its goals, each design swept and proved."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, MechanismError, Problem
from linkwork.core.foundation.lanes import NotElementwise
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.varied_numbers import VariedNumber, number_named
from linkwork.core.motion.model import Model
from linkwork.core.motion.sweeping import sweep
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.design.derivatives.rows import chosen_numbers
from linkwork.synthesis.improvement.curves import paths_of
from linkwork.synthesis.improvement.fit_problem import (
    FittedNumbers,
    Fitting,
    fit_numbers,
    misses_before,
)
from linkwork.synthesis.improvement.fronts import fit_front, front_designs
from linkwork.synthesis.improvement.lanes import DesignWriter
from linkwork.synthesis.improvement.proved_design import (
    ImprovedDesign,
    fitted_design,
    interrupted_design,
    least_in_rows,
)
from linkwork.synthesis.improvement.settings import (
    STARTS,
    Aid,
    Goal,
    Improvement,
    Points,
    Together,
    kept_relations,
    spread_starts,
)
from linkwork.synthesis.lane_least_squares import Box, Progress, part_of

__all__ = [
    "FACTOR",
    "STARTS",
    "box_of",
    "improved_designs",
    "numbers_to_vary",
    "transmission_goals",
]

FACTOR = 4.0  # factor by which lengths may change, unless the task bounds them
_SEARCH = 0.9  # share of the search in the work; the rest is proofs
_FAR = 2.0  # longest numbers or links, by which others may change
_FIRST = 0.6  # share of the first search, if starts may have to be led again
_AGAIN, _RELATED = 0.2, 0.1  # of starts led again, and of each kind of relation after that
_OFF = math.radians(0.25)  # dead points: starts that lead to one are led again, so far from all
# near a number that a goal does not depend on, such as a rod's length in a stroke without offset,
# all steps would fail that move it by its effect alone
_LEAST_EFFECT = 0.3
_EQUAL_NUMBERS = 1e-6  # relative difference of numbers of equal designs


def improved_designs(
    model: Model,
    goals: Sequence[Goal | Points],
    settings: Improvement,
    progress: Progress | None = None,
    *,
    is_sound: Callable[[ImprovedDesign], bool] = lambda design: design.sound,
    enough: int | None = None,
) -> tuple[ImprovedDesign, ...]:
    """Different fits, sound ones first, then by their misses; or a front, in its order,
    and the designs found on the way to it that are not sound.

    ``is_sound``: a condition on designs of a front. ``enough``: so many sound
    designs end the proofs of an interrupted search without a front. An interruption of the proofs
    keeps those done.

    Raises
    ------
    InputError, MechanismError
        For goals that contradict themselves, or a mechanism without a motion.
    """
    _check(settings, goals)
    points = next((goal for goal in goals if isinstance(goal, Points)), None)
    others = [goal for goal in goals if isinstance(goal, Goal)]
    numbers = numbers_to_vary(model, settings.vary)
    if not numbers:
        raise InputError(f'"{model.description.name}" has no number that can vary alone')
    box = box_of(model, numbers, settings)
    starts = box.inside(spread_starts(model, numbers, settings))
    search = _Search(model, numbers, box, points, settings, is_sound, enough)
    held = {goal.of for goal in others}
    kept_off = [goal for goal in transmission_goals(model, _OFF) if goal.of not in held]
    one = bool(settings.front or (points and not kept_off))
    search.progress = part_of(progress, 0.0, 1.0 if one else _FIRST)
    try:
        fits = search.fits(others, starts)
    except NotElementwise:
        raise InputError(_unfollowed(model, numbers)) from None
    if settings.front:
        front = front_designs(fits, settings.front, is_sound, search.tell_proofs)
        return tuple(map(interrupted_design, front)) if search.interrupted else front
    designs = search.proved(fits, range(len(starts)), [])
    locked = [k for k, done in designs if _locks(done)]
    if locked and kept_off and not search.interrupted:
        search.progress = part_of(progress, _FIRST, 1.0 - _FIRST if points else _AGAIN)
        known = [done for done in designs if done[1].sound or done[0] not in locked]
        led = known
        try:
            fits = search.fits([*others, *kept_off], starts[locked])
            led = search.proved(fits, locked, known)
        except KeyboardInterrupt:
            search.interrupted = True
        # starts that cannot be kept off, or are not led again, keep their designs
        again = {k for k, _ in led}
        designs = led + [done for done in designs if done not in known and done[0] not in again]
    # fits that lose starts, lock or do not move break a relation
    hampered = search.lost or any(_locks(done) or search.moved(done).unmoved for _, done in designs)
    reached = points or search.interrupted or any(_is_reached(done) for _, done in designs)
    if hampered and not reached:
        designs = search.related(others, designs, len(starts), progress)
    if search.interrupted and not designs:
        raise KeyboardInterrupt
    explained = interrupted_design if search.interrupted else search.moved
    results = [explained(done) for _, done in designs]
    return tuple(sorted(results, key=partial(_rank, settings)))


def _is_reached(design: ImprovedDesign) -> bool:
    """Whether a sound design has no miss that a person would see."""
    sizes = [abs(float(x)) for x in design.numbers.values()]
    return design.sound and design.largest <= _EQUAL_NUMBERS * max(sizes, default=1.0)


def _locks(design: ImprovedDesign) -> bool:
    """Whether a design comes to a dead point."""
    return design.motion is not None and _is_locked(design.motion)


def _is_locked(motion: Motion) -> bool:
    return not motion.found.all() or least_in_rows(motion) * motion.units.angle.radians < _OFF


def _rank(settings: Improvement, design: ImprovedDesign) -> tuple[bool, float]:
    return not design.sound, design.largest if settings.fit == "minimax" else design.total


@dataclass(eq=False)
class _Search:
    """Fits from starts, and their proofs, which the user may stop."""

    model: Model
    numbers: Sequence[VariedNumber]
    box: Box
    points: Points | None
    settings: Improvement
    is_sound: Callable[[ImprovedDesign], bool]
    enough: int | None
    progress: Progress | None = None
    interrupted: bool = False
    begun: int = 0
    lost: int = 0
    before: float = math.inf

    def fits(
        self, goals: Sequence[Goal], starts: Array, together: Together | None = None
    ) -> list[FittedNumbers]:
        """Fits from starts (D, P), one for each way to time the points."""
        model, settings = self.model, self.settings
        motion = sweep(model, certify=False)
        if not motion.found.any():
            raise InputError(f'"{model.description.name}" has no position: improve one that moves')
        paths = paths_of(model, motion, self.points) if self.points else (None,)
        fits: list[FittedNumbers] = []
        for part, path in enumerate(paths):
            told = part_of(self.progress, _SEARCH * part / len(paths), _SEARCH / len(paths))
            fitting = Fitting(
                model=model,
                motion=motion,
                numbers=self.numbers,
                box=self.box if together is None else together.box(self.box),
                path=path,
                goals=goals,
                together=together,
            )
            if path is None and not settings.front and not _is_locked(motion):
                self.before = misses_before(fitting, minimax=settings.fit == "minimax")
            if settings.front:
                fit = fit_front(fitting, starts, settings.front, progress=told)
            else:
                fit = fit_numbers(fitting, starts, minimax=settings.fit == "minimax", progress=told)
            fits.append(fit)
            self.begun += len(starts)
            self.lost += len(starts) - int(np.isfinite(fit.total).sum())
            self.interrupted |= fit.interrupted
            if self.interrupted:
                break
        return fits

    def related(
        self,
        goals: Sequence[Goal],
        known: list[tuple[int, ImprovedDesign]],
        count: int,
        progress: Progress | None,
    ) -> list[tuple[int, ImprovedDesign]]:
        """Known designs, and those whose numbers keep the relations of the mechanism.

        ``count``: so many starts for each kind of relation.
        """
        motion = sweep(self.model, certify=False)
        rng = np.random.default_rng(self.settings.seed)
        for k, together in enumerate(kept_relations(self.model, motion, self.numbers)):
            self.progress = part_of(progress, _FIRST + _AGAIN + k * _RELATED, _RELATED)
            spread = self.settings.spread * rng.uniform(-1.0, 1.0, (count, len(together.sizes)))
            spread[0] = 0.0
            starts = together.box(self.box).inside(together.sizes * (1.0 + spread))
            try:
                known = self.proved(self.fits(goals, starts, together), [-1] * count, known)
            except MechanismError:  # a goal changes with none of these sizes
                continue
            except KeyboardInterrupt:
                self.interrupted = True
            if self.interrupted or any(_is_reached(design) for _, design in known):
                break
        return known

    def proved(
        self,
        fits: Sequence[FittedNumbers],
        starts: Sequence[int],
        known: Sequence[tuple[int, ImprovedDesign]],
    ) -> list[tuple[int, ImprovedDesign]]:
        """Known designs and different ones of fits from starts with these numbers, the best first,
        each with the number of its start.
        """
        designs, sound = [*known], sum(self.is_sound(design_known) for _, design_known in known)
        minimax = self.settings.fit == "minimax"
        best = sorted(
            (float((fit.largest if minimax else fit.total)[k]), part, int(k))
            for part, fit in enumerate(fits)
            for k in np.flatnonzero(np.isfinite(fit.total))
        )
        try:
            for done, (_, part, k) in enumerate(best):
                self.tell_proofs(done / len(best))
                if self.interrupted and self.enough is not None and sound >= self.enough:
                    break
                fit = fits[part]
                if not _is_known(fit.x[k], [design_known for _, design_known in designs]):
                    design = fitted_design(fit, k)
                    designs.append((starts[int(fit.start[k])], design))
                    sound += self.is_sound(design)
        except KeyboardInterrupt:
            self.interrupted = True
        return designs

    def moved(self, design: ImprovedDesign) -> ImprovedDesign:
        """A design; one that misses its goals as the mechanism did is no improvement."""
        x = np.array([float(q.of(self.model.description)) for q in self.numbers])
        misses = design.largest if self.settings.fit == "minimax" else design.total
        still = _is_known(x, [design]) or misses >= self.before * (1.0 - _EQUAL_NUMBERS)
        if not still or _is_reached(replace(design, sound=True)):
            return design
        reason = "nothing improved: the mechanism as it was is no farther from its goals; "
        if self.lost:
            reason += f"{self.lost} of {self.begun} starts have no position on its branch"
        else:
            reason += "no small change of those that vary brings its goals nearer"
        if design.goals:
            reason += f"; it misses {', '.join(f'{n} by {m:.4g}' for n, m in design.goals.items())}"
        return replace(design, sound=False, unmoved=reason, message=f"{design.message}; {reason}")

    def tell_proofs(self, fraction: float) -> None:
        """A fraction of the proofs is done; an interruption of the telling does not end them."""
        if not self.interrupted and self.progress is not None:
            try:
                self.progress(_SEARCH + (1.0 - _SEARCH) * fraction)
            except KeyboardInterrupt:
                self.interrupted = True


def transmission_goals(model: Model, least: float) -> Iterator[Aid]:
    """A least transmission angle of all dyads, as bounds in all rows [rad]."""
    angle = model.description.angle
    bound = angle.from_radians(least)
    for name, quantity in model.quantities.derived.items():
        if quantity.row is TRANSMISSION_ANGLE:
            yield Aid(of=name, least=bound, most=angle.turn / 2.0 - bound)


def _check(settings: Improvement, goals: Sequence[Goal | Points]) -> None:
    problems = [*settings.problems(), *settings.front_problems(goals)]
    for k, goal in enumerate(goals):
        problems += [(("goals", k, *key), message) for key, message in goal.problems()]
    if not goals:
        problems.append((("goals",), "are missing: add a goal"))
    if sum(isinstance(goal, Points) for goal in goals) > 1:
        problems.append((("goals",), "name points twice: one point follows them"))
    if problems:
        raise MechanismError([Problem(key=k, message=m) for k, m in problems], "the improvement")


def numbers_to_vary(model: Model, names: Sequence[str]) -> tuple[VariedNumber, ...]:
    """The numbers that the settings name, or all lengths, angles, offsets, dimensions and fixed
    pivots whose changes a fit can follow.
    """
    numbers, _ = chosen_numbers(model, names or None)
    if names:
        return numbers
    description = model.description
    fixed = set(description.links.get(GROUND, ())) if isinstance(description, Draft) else set()
    # the length between two fixed pivots determines their coordinates, and follows from them
    lengths = description.lengths if isinstance(description, Draft) else ()
    ends_of_lengths = [set(name.split()) for name in lengths]
    held = set().union(*(ends for ends in ends_of_lengths if ends <= fixed))
    usual = tuple(
        q
        for q in numbers
        if (q.table == "points" and q.key in fixed - held)
        or (q.table == "lengths" and not set(q.key.split()) <= fixed)
        or q.table in ("angles", "sliders", "dimensions")
    )
    if _is_followed(model, usual):
        return usual
    return tuple(q for q in usual if _is_followed(model, [q]))


def _is_followed(model: Model, numbers: Sequence[VariedNumber]) -> bool:
    """Whether designs with other numbers have equations of the same form."""
    try:
        DesignWriter(model, numbers)
    except NotElementwise:
        return False
    return True


def box_of(model: Model, numbers: Sequence[VariedNumber], settings: Improvement) -> Box:
    """The bounds of numbers.

    Raises
    ------
    InputError
        For bounds of a number that does not vary.
    """
    x = np.array([float(q.of(model.description)) for q in numbers])
    description = model.description
    lengths = description.lengths.values() if isinstance(description, Draft) else ()
    # a coordinate of 0 may vary by itself too
    longest = max((abs(float(description.numbers(length))) for length in lengths), default=0.0)
    far = _FAR * max(float(np.abs(x).max()), longest)
    is_length = np.array([q.table == "lengths" for q in numbers])
    least = np.where(is_length, x / FACTOR, x - far)
    most = np.where(is_length, x * FACTOR, x + far)
    for name, (low, high) in settings.bounds.items():
        number = number_named(model.description, name)
        if number not in numbers:
            raise InputError(f'"{name}" has bounds and does not vary: add it to vary')
        k = numbers.index(number)
        least[k], most[k] = low, high
    return Box(least=least, most=most, least_effect=_LEAST_EFFECT)


def _unfollowed(model: Model, numbers: Sequence[VariedNumber]) -> str:
    """Which numbers a fit cannot vary, in words."""
    names = [f'"{number.name}"' for number in numbers if not _is_followed(model, [number])]
    of_mechanism = f'of "{model.description.name}"'
    if not names:
        return f"a fit cannot vary all these numbers {of_mechanism} together: vary fewer"
    return f"a fit cannot vary {', '.join(names)} {of_mechanism}: vary other numbers"


def _is_known(x: Array, designs: Sequence[ImprovedDesign]) -> bool:
    others = [np.array(list(design.numbers.values())) for design in designs]
    return any(np.abs(other - x).max() <= _EQUAL_NUMBERS * np.abs(x).max() for other in others)
