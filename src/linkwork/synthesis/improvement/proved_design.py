"""A mechanism with improved numbers, and the evidence for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.containers import FrozenDict
from linkwork.core.foundation.errors import LinkworkError, internal
from linkwork.core.foundation.values import told_beside
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.varied_numbers import with_numbers
from linkwork.core.motion.model import model_of
from linkwork.core.motion.sweeping import sweep
from linkwork.core.results.motion import Motion, branch_end
from linkwork.synthesis.improvement.fit_problem import FittedNumbers, Fitting, path_misses
from linkwork.synthesis.improvement.goals import PathGoal
from linkwork.synthesis.improvement.whole_motion import WholeMotion, nearly_dead


@internal("description", "motion", "whole_motion", "unproved")
@dataclass(frozen=True, kw_only=True, eq=False)
class ImprovedDesign:
    """A mechanism with improved numbers.

    Parameters
    ----------
    description : Description
        With its new numbers.
    numbers : Mapping[str, float]
        Those that varied [file units].
    total : float
        The weighted sum of squares of all misses.
    largest : float
        The largest weighted miss, broken bounds aside.
    rms : float
        The root mean square of the distances from the points; 0 without points [length].
    sound : bool
        Whether all rows of its table are proved to be on one branch, which does not end between
        them, and goals are within their bounds.
    message : str
        Why it is not sound, and how the search ended.
    inputs : tuple of float
        The leading inputs at the points; none without points [file units].
    misses : tuple of float
        The distances from the points, on the branch of the table; NaN where this has no position.
    goals : Mapping[str, float]
        The root mean square of the misses of each goal that is no bound, by quantity or point,
        without its weight [file units].
    broken : tuple of str
        The bounds of goals that it breaks, in words.
    near_dead : str
        That it all but reaches a dead point, in words; else empty.
    unmoved : str
        Why it is the mechanism as it was, whose goals are missed; else empty.
    motion : Motion, optional
        Its table with the proofs; ``None`` if it has no position.
    whole_motion : WholeMotion, optional
        The motion between the rows too; ``None`` if that is not proved.

    Examples
    --------
    >>> import linkwork as lw
    >>> goal = {"of": "rocker", "at": [0, 90, 180], "values": [60, 80, 100]}
    >>> best = lw.synthesis.improve(lw.example("four-bar"), goal, vary=["A B", "O4 B"], starts=4)[0]
    >>> sorted(best.numbers), best.sound
    (['A B', 'O4 B'], True)
    """

    description: Description
    numbers: Mapping[str, float]
    total: float
    largest: float
    rms: float
    sound: bool
    message: str
    inputs: tuple[float, ...] = ()
    misses: tuple[float, ...] = ()
    goals: Mapping[str, float] = field(default_factory=dict)
    broken: tuple[str, ...] = ()
    near_dead: str = ""
    unmoved: str = ""
    motion: Motion | None = None
    whole_motion: WholeMotion | None = None

    @classmethod
    def unproved(cls, description: Description, message: str) -> ImprovedDesign:
        """A mechanism as it is, without a sweep."""
        return cls(
            description=description,
            numbers={},
            total=np.nan,
            largest=np.nan,
            rms=0.0,
            sound=False,
            message=message,
        )

    def __repr__(self) -> str:
        return f"<ImprovedDesign: total {self.total:.4g}, {self.message}>"


# ----------------------------------------------------------------------
# Designs of a fit with their proofs: certified sweeps, and misses on the branches they prove.


_INTERRUPTED = "interrupted: the best so far; "


def fitted_design(fit: FittedNumbers, k: int) -> ImprovedDesign:
    """The design of one lane of a fit."""
    message, path = _INTERRUPTED if fit.interrupted else "", fit.fitting.path
    new = dict(zip(fit.fitting.numbers, map(float, fit.x[k]), strict=True))
    description = with_numbers(fit.fitting.model.description, new)
    design = replace(
        proved_design(description, {q.name: x for q, x in new.items()}, message),
        total=float(fit.total[k]),
        largest=float(fit.largest[k]),
        goals=dict(zip(fit.names, map(float, fit.objectives[k]), strict=True)),
    )
    broken = [*_broken(fit, k)]
    if broken:
        message = "; ".join([design.message, *broken])
        design = replace(design, broken=tuple(broken), sound=False, message=message)
    if path is None:
        return design
    rms = float(np.sqrt(fit.path[k] / len(path.places)))
    return _on_path(replace(design, rms=rms), fit.fitting, path, fit.t[k])


def _broken(fit: FittedNumbers, k: int) -> Iterator[str]:
    """The bounds that a design breaks, in words."""
    for goal, (below, above) in zip(fit.bounds, fit.beyond[k], strict=True):
        least, most = goal.least, goal.most
        if least is not None and below > 0.0:
            down = told_beside(least - below, least)
            yield f"goal {goal.of} comes down to {down}, wanted at least {least:g}"
        if most is not None and above > 0.0:
            up = told_beside(most + above, most)
            yield f"goal {goal.of} comes up to {up}, wanted at most {most:g}"


def interrupted_design(design: ImprovedDesign) -> ImprovedDesign:
    """A design that says that it is the best so far."""
    message = design.message.removeprefix(_INTERRUPTED)
    return replace(design, message=f"{_INTERRUPTED}{message}")


def proved_design(
    description: Description, numbers: Mapping[str, float] = FrozenDict(), text: str = ""
) -> ImprovedDesign:
    """A mechanism with its proof: a certified sweep of its whole table.

    ``numbers``: the result of the fit; ``text``: the beginning of the message.
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
        text += f"{lost} of {len(motion)} rows are not proved" if lost else "all rows are proved"
        if end is not None:
            lead = next(iter(motion.inputs))
            text += f"; the branch ends at the {end.kind.word} "
            text += end.told(lead, motion.input_units[lead])
        text += f"; {near_dead}" if near_dead else ""
    except LinkworkError as error:
        sound, text = False, f"{text}{error}"
    return replace(
        ImprovedDesign.unproved(description, text),
        numbers=numbers,
        sound=sound,
        near_dead=near_dead,
        motion=motion,
        whole_motion=whole,
    )


def _on_path(design: ImprovedDesign, fitting: Fitting, path: PathGoal, t: Array) -> ImprovedDesign:
    """The design with its distances from the points, measured on its proved branch."""
    order = slice(None, None, -1 if path.falling else 1)
    places = tuple(map(float, t[order] / fitting.model.input_scale[0]))
    misses = np.full(len(places), np.nan)
    if design.motion is not None and design.motion.found.any():
        x = np.array(list(design.numbers.values()))
        at = replace(path, inputs=t, timed=True)
        model = model_of(design.description)
        misses = path_misses(model, design.motion, fitting.numbers, at, x)[order]
    text, sound = design.message, design.sound
    if not np.isfinite(misses).all():
        text, sound = f"{text}; not all points lie on the branch of its table", False
    return replace(
        design, inputs=places, misses=tuple(map(float, misses)), sound=sound, message=text
    )
