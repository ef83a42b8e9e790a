"""Designs of a fit with their proofs: certified sweeps, and misses on the branches they prove."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from linkwork.design.improvement.fit_problem import FittedNumbers
from linkwork.design.improvement.goals import PathGoal
from linkwork.design.improvement.improved_design import ImprovedDesign
from linkwork.design.improvement.mechanism_fit import path_misses
from linkwork.design.improvement.motion_bounds import nearly_dead
from linkwork.design.improvement.whole_motion import WholeMotion
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import LinkworkError
from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.plain_numbers import told_beside
from linkwork.mechanism.description import Description
from linkwork.mechanism.varied_number import VariedNumber, with_numbers
from linkwork.motion.model import Model, model_of
from linkwork.motion.sweeping import sweep
from linkwork.results.branch_end import branch_end

__all__ = ["fitted_design", "interrupted_design", "proved_design"]

_INTERRUPTED = "interrupted: the best so far; "


def fitted_design(
    model: Model,
    numbers: Sequence[VariedNumber],
    path: PathGoal | None,
    found: FittedNumbers,
    k: int,
) -> ImprovedDesign:
    """The design of one lane of a fit."""
    told = _INTERRUPTED if found.interrupted else ""
    new = dict(zip(numbers, map(float, found.x[k]), strict=True))
    design = replace(
        proved_design(
            with_numbers(model.description, new), {q.name: x for q, x in new.items()}, told
        ),
        total=float(found.total[k]),
        largest=float(found.largest[k]),
        goals=dict(zip(found.names, map(float, found.objectives[k]), strict=True)),
    )
    broken = [*_broken(found, k)]
    if broken:
        told = "; ".join([design.message, *broken])
        design = replace(design, broken=tuple(broken), sound=False, message=told)
    if path is None:
        return design
    rms = float(np.sqrt(found.path[k] / len(path.places)))
    return _on_path(replace(design, rms=rms), model, numbers, path, found.t[k])


def _broken(found: FittedNumbers, k: int) -> Iterator[str]:
    """The bounds that a design breaks, in words."""
    for goal, (below, above) in zip(found.bounds, found.beyond[k], strict=True):
        least, most = goal.least, goal.most
        if least is not None and below > 0.0:
            down = told_beside(least - below, least)
            yield f"goal {goal.of} comes down to {down}, wanted at least {least:g}"
        if most is not None and above > 0.0:
            up = told_beside(most + above, most)
            yield f"goal {goal.of} comes up to {up}, wanted at most {most:g}"


def interrupted_design(design: ImprovedDesign) -> ImprovedDesign:
    """A design that says that it is the best so far."""
    told = design.message.removeprefix(_INTERRUPTED)
    return replace(design, message=f"{_INTERRUPTED}{told}")


def proved_design(
    description: Description, numbers: Mapping[str, float] = FrozenDict(), told: str = ""
) -> ImprovedDesign:
    """A mechanism with its proof: a certified sweep of its whole table.

    ``numbers``: those that were found; ``told``: the beginning of the message.
    """
    motion, whole, near_dead = None, None, ""
    try:
        model = model_of(description)
        motion = sweep(model)
        whole = WholeMotion.of(model, motion)
        lost = int(np.count_nonzero(~motion.certified))
        end = branch_end(motion)
        near_dead = "" if lost or end is not None else nearly_dead(motion, whole)
        sound = not (lost or end is not None or near_dead)
        told += f"{lost} of {len(motion)} rows are not proved" if lost else "all rows are proved"
        if end is not None:
            lead = next(iter(motion.inputs))
            told += f"; the branch ends at the {end.kind.word} "
            told += end.told(lead, motion.input_units[lead])
        told += f"; {near_dead}" if near_dead else ""
    except LinkworkError as error:
        sound, told = False, f"{told}{error}"
    return ImprovedDesign(
        description=description,
        numbers=numbers,
        total=np.nan,
        largest=np.nan,
        rms=0.0,
        sound=sound,
        message=told,
        near_dead=near_dead,
        motion=motion,
        whole_motion=whole,
    )


def _on_path(
    design: ImprovedDesign,
    model: Model,
    numbers: Sequence[VariedNumber],
    path: PathGoal,
    t: Array,
) -> ImprovedDesign:
    """The design with its distances from the points, measured on its own proved branch."""
    order = slice(None, None, -1 if path.falling else 1)
    own = tuple(map(float, t[order] / model.input_scale[0]))
    misses = np.full(len(own), np.nan)
    if design.motion is not None and design.motion.found.any():
        x = np.array(list(design.numbers.values()))
        at = replace(path, inputs=t, timed=True)
        misses = path_misses(model_of(design.description), design.motion, numbers, at, x)[order]
    told, sound = design.message, design.sound
    if not np.isfinite(misses).all():
        told, sound = f"{told}; not all points lie on the branch of its table", False
    return replace(design, inputs=own, misses=tuple(map(float, misses)), sound=sound, message=told)
