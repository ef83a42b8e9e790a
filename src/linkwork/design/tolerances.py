"""Tolerances: worst case, root sum square, shares, and random designs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from linkwork import wings
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import find_spelling
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.foundation.values import finite_number, whole_number
from linkwork.core.mechanism.varied_numbers import (
    VariedNumber,
    clearances_of,
    deviations_of,
    number_named,
    pins_of,
)
from linkwork.core.motion.model import Model, model_of
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from linkwork.design.sensitivities import LIMITS, is_of_motion, play_of, sensitivity_of
from linkwork.design.tolerance_results import (
    Contribution,
    Sampled,
    Sensitivity,
    SensitivityStatus,
    Tolerance,
    per,
)
from linkwork.families.sampling import Normal, random


@dataclass(frozen=True, kw_only=True)
class Deviations:
    """Standard deviations of numbers, and clearances of pins by point, in file units."""

    numbers: Mapping[VariedNumber, float]
    clearances: Mapping[str, float]


def _stated_deviations(
    model: Model,
    numbers: Mapping[str, float] | None,
    clearances: Mapping[str, float] | None,
) -> Deviations:
    """The stated deviations and clearances, or those of the file.

    Raises
    ------
    UnknownNameError, InputError
        For a name that is not known, a negative number, or if there are none.
    """
    description = model.description
    if numbers is None:
        spread = deviations_of(description)
    else:
        spread = {
            number_named(description, name): _size(name, size) for name, size in numbers.items()
        }
    pins = pins_of(description)
    if clearances is None:
        play = dict(clearances_of(description))
    else:
        play = {}
        for name, size in clearances.items():
            point = find_spelling(name, pins)
            if point not in pins:
                raise UnknownNameError(
                    f'"{name}" is no pin of two links {choices("pins", pins, name)}'
                )
            play[point] = _size(name, size)
    if not spread and not play:
        raise InputError(
            f"nothing deviates in {description.name}: add [tolerances], as in "
            f'"A B" = {{ deviation = 0.05 }}, or [clearances]'
        )
    return Deviations(numbers=spread, clearances=play)


def _size(name: str, value: float) -> float:
    size = finite_number(name, value)
    if size < 0:
        raise InputError(f'"{name}" must not deviate by a negative number, got {size:g}')
    return size


def _pin_forces(pins: tuple[tuple[str, str], ...], moved: Array) -> dict[str, Array]:
    """The forces between links at every pin for a unit load at the quantity, (rows,).

    A displacement of one link equals an opposite displacement of all other links: the link with
    the smallest effect stays, the other links move against it.
    """
    effects: dict[str, list[Array]] = {}
    for (_, point), rates in zip(pins, moved, strict=True):
        effects.setdefault(point, []).append(np.hypot(rates[:, 0], rates[:, 1]))
    return {point: np.sort(sizes, axis=0)[1:].sum(axis=0) for point, sizes in effects.items()}


def _contributions(
    model: Model, sensitivity: Sensitivity, deviations: Deviations, forces: Mapping[str, Array]
) -> Iterator[Contribution]:
    """Every dimension and pin, without its share yet."""
    length = model.description.length
    for number, size in deviations.numbers.items():
        rate = float(sensitivity.derivatives[number.name])
        change = abs(rate) * size
        yield Contribution(
            name=number.name, kind="dimension", sensitivity=rate,
            unit=sensitivity.unit_by(number.name), deviation=size,
            deviation_unit=sensitivity.units[number.name], worst=change, standard=change,
            share=math.nan
        )  # fmt: skip
    for point, size in deviations.clearances.items():
        force = float(forces[point].sum())
        # eq. (125): c |R| cos ψ for all directions ψ alike
        standard = size * math.sqrt(0.5 * float((forces[point] ** 2).sum()))
        yield Contribution(
            name=point, kind="clearance", sensitivity=force, unit=per(sensitivity.unit, length),
            deviation=size, deviation_unit=length, worst=force * size, standard=standard,
            share=math.nan,
        )  # fmt: skip


def _sample(
    model: Model,
    solved: Position | Motion,
    of: str,
    deviations: Deviations,
    forces: Mapping[str, Array],
    drawn: tuple[int, int],
) -> Sampled:
    """Draw designs with normal numbers; clearances add their first-order effect."""
    description, (count, seed) = model.description, drawn
    spread = {q: size for q, size in deviations.numbers.items() if size > 0.0}
    if spread:
        plan = random(
            count, {q.name: Normal(q.of(description), size) for q, size in spread.items()}, seed
        )
        values = _of_designs(model, solved, of, plan)
    else:
        nominal = solved.value(of) if isinstance(solved, Motion) else solved[of]
        values = np.full(count, float(nominal))
    # another stream than that of the numbers
    generator = np.random.Generator(np.random.Philox(seed + 1))
    for point, size in deviations.clearances.items():
        for force in forces[point]:
            values = values + size * force * np.cos(generator.uniform(0.0, FULL_TURN, count))
    there = values[np.isfinite(values)]
    # without a design all numbers are NaN
    known = there if len(there) else np.full(1, np.nan)
    deviation = float(there.std(ddof=1)) if len(there) > 1 else 0.0 * float(known[0])
    return Sampled(
        designs=count,
        found=len(there),
        seed=seed,
        mean=float(known.mean()),
        deviation=deviation,
        error=deviation / math.sqrt(2.0 * max(len(there) - 1, 1)),
        low=float(known.min()),
        high=float(known.max()),
    )


def _of_designs(
    model: Model, solved: Position | Motion, of: str, plan: Mapping[str, Array]
) -> Array:
    """The quantity of every design, (D,); NaN where it does not exist."""
    family_of = wings.use("families.family").family_of
    if isinstance(solved, Motion):
        name = of.strip()
        return family_of(model, plan).reduced(() if name in LIMITS else [name])[name]
    # every design is followed from the position that all deviations start from
    return family_of(_at_one_row(model, solved), plan).sweep(certify=False)[of][:, 0]


def _at_one_row(model: Model, position: Position) -> Model:
    """The mechanism with the input of a position as its only row, starting there."""
    description = model.description
    rows = tuple(
        replace(which, from_=position.input[x.name], to=position.input[x.name], step=1)
        for which, x in zip(description.inputs, model.equations.inputs, strict=True)
    )
    return model_of(replace(description, inputs=rows)).from_position(position)


def tolerance(
    mechanism: Mechanism,
    of: str,
    at: float | Mapping[str, float] | None = None,
    *,
    deviations: Mapping[str, float] | None = None,
    clearances: Mapping[str, float] | None = None,
    samples: int = 0,
    seed: int = 1,
    configuration: str | None = None,
    motion: Motion | None = None,
) -> Tolerance:
    """What deviations of numbers and clearances of pins do to a quantity.

    Worst case, root sum square and the share of each are of first order; ``samples`` random
    designs are solved too, as a family.

    Parameters
    ----------
    of : str
        A quantity at a position, or a number of a whole motion: ``stroke(d)``.
    at : number or Mapping[str, number], optional
        Input value(s) in file units; by default those of the guess.
    deviations : Mapping[str, number], optional
        Standard deviations of numbers; by default those in the file's ``[tolerances]``.
    clearances : Mapping[str, number], optional
        Differences of the radii of hole and pin, by point; by default ``[clearances]``.
    samples : int
        Number of random designs.
    seed : int
        Equal seeds draw equal designs.
    configuration, motion
        As in :func:`sensitivity`.

    Returns
    -------
    Tolerance

    Raises
    ------
    UnknownNameError, InputError
        If a name is not known, a deviation is negative, or there is none.

    Examples
    --------
    >>> import linkwork as lw
    >>> crank = lw.example("slider-crank")
    >>> found = lw.design.tolerance(crank, "d", at=60, deviations={"O2 A": 0.02, "B A": 0.05})
    >>> round(found.worst_case, 6), found.contributions[0].name
    (0.057301, 'B A')
    """
    model = mechanism.model
    stated = _stated_deviations(model, deviations, clearances)
    solved: Motion | Position
    if is_of_motion(of):
        if at is not None:
            raise InputError(f'"{of}" is a number of a whole motion: leave out at')
        solved = mechanism.sweep(configuration=configuration) if motion is None else motion
    else:
        solved = mechanism.solve(at, configuration=configuration)
    count, start = whole_number("samples", samples), whole_number("seed", seed)
    names = [number.name for number in stated.numbers]
    pins = tuple((link, p) for p in stated.clearances for link in pins_of(model.description)[p])
    result = sensitivity_of(model, solved, of, names)
    forces = _pin_forces(pins, play_of(model, solved, of, pins))
    parts = list(_contributions(model, result, stated, forces))
    total = math.fsum(part.standard**2 for part in parts)
    status = result.status
    if status is SensitivityStatus.FOUND and not math.isfinite(total):
        status = SensitivityStatus.CORNER
    shared = [replace(p, share=p.standard**2 / total if total > 0.0 else 0.0) for p in parts]
    sampled = None
    if count and status is not SensitivityStatus.NO_POSITION:
        sampled = _sample(model, solved, of, stated, forces, (count, start))
    return Tolerance(
        mechanism=result.mechanism,
        of=result.of,
        unit=result.unit,
        inputs={name: float(value) for name, value in result.inputs.items()},
        input_units=result.input_units,
        value=float(result.value),
        contributions=tuple(sorted(shared, key=lambda part: (-part.share, part.name))),
        status=status,
        sampled=sampled,
    )
