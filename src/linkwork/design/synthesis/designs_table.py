"""All designs of a synthesis as a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from linkwork.design.defects.judged_design import JudgedDesign
from linkwork.design.synthesis.result import Synthesis
from linkwork.foundation.arrays import AnyArray
from linkwork.results.quantities.transmission import TRANSMISSION_ANGLE
from linkwork.results.table import Table

__all__ = ["designs_table", "front_of", "goal_misses", "relative_misses"]

_POINTS = ("A0", "B0", "C0", "S", "T", "U", "V", "A", "B", "C", "D", "K", "P")


def designs_table(found: Synthesis, files: Mapping[int, str] | None = None) -> Table:
    """Designs in their order: numbers, points at the first position, verdict and file.

    Points that a kind of mechanism does not have are NaN.
    """
    task, designs = found.task, found.designs
    columns: dict[str, AnyArray] = {
        "design": np.arange(1, len(designs) + 1),
        "mechanism": np.array([design.mechanism for design in designs]),
        "drive": np.array([design.driven for design in designs]),
        "delivered": np.array([design.delivered for design in designs]),
    }
    units = dict.fromkeys(columns, "")
    numbers = {
        "score": ("", [design.score for design in designs]),
        TRANSMISSION_ANGLE.word: (task.angle.value, [design.transmission for design in designs]),
        "size": (task.length, [design.size for design in designs]),
        "error": (found.error_unit, [design.error for design in designs]),
    }
    for name, misses in goal_misses(designs).items():
        numbers[f"miss of {name}"] = "", misses
    for name in _POINTS:
        places = [design.points.get(name, complex(np.nan, np.nan)) for design in designs]
        if not np.isnan(np.array([*places, 0j])[:-1]).all():
            numbers[f"{name}.x"] = task.length, [place.real for place in places]
            numbers[f"{name}.y"] = task.length, [place.imag for place in places]
    for name, (unit, values) in numbers.items():
        columns[name], units[name] = np.array(values, dtype=float), unit
    reasons = [design.defects[0].message if design.kinds else "" for design in designs]
    columns["defect"], units["defect"] = np.array(reasons, dtype=str), ""
    named = [(files or {}).get(k, "") for k in range(len(designs))]
    columns["file"], units["file"] = np.array(named, dtype=str), ""
    return Table(columns=columns, units=units, index="design")


def front_of(found: Synthesis) -> dict[str, list[float]]:
    """The misses of every goal of the delivered designs; none if they are no front."""
    improvement = found.task.improvement
    return goal_misses(found.delivered) if improvement is not None and improvement.front else {}


def goal_misses(designs: Sequence[JudgedDesign]) -> dict[str, list[float]]:
    """The misses of every goal that improved designs have, in their order."""
    names = dict.fromkeys(name for design in designs for name in design.goals)
    return {name: [design.goals.get(name, np.nan) for design in designs] for name in names}


def relative_misses(design: JudgedDesign) -> dict[str, float]:
    """The misses of the goals of an improved design, each relative to the largest value wanted."""
    improvement = design.task.improvement
    goals = [] if improvement is None else [own for own in improvement.goals if not own.is_bound]
    sizes = [max(map(abs, (*own.values, own.target or 0.0))) for own in goals]
    usual = max(sizes, default=0.0) or 1.0
    # points are the first of all misses, and no goal
    misses = list(design.goals.items())[-len(goals) :] if goals else []
    return {name: x / (size or usual) for (name, x), size in zip(misses, sizes, strict=False)}
