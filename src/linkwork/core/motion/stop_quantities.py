"""The quantities that stops bound."""

from __future__ import annotations

from linkwork.core.foundation.errors import InputError, Problem
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.loaded import LoadedBodies
from linkwork.core.results.quantities.definition import Asked, Group
from linkwork.core.results.quantities.registry import Quantities


def bounded_quantity(name: str, known: Quantities) -> Asked:
    """The quantity of positions that a stop bounds.

    Raises
    ------
    InputError
        If there is none of this name, or it does not follow from positions alone.
    """
    asked = known.find(name)
    if asked.needs or asked.group is Group.EVIDENCE:
        raise InputError(
            f'"{name}" cannot be stopped: name a quantity of positions, such as a link or B.x'
        )
    return asked


def stop_problems(description: Description, known: Quantities) -> list[Problem]:
    """Stops of what the mechanism does not have."""
    problems = []
    for k, stop in enumerate(description.stops if isinstance(description, LoadedBodies) else ()):
        try:
            bounded_quantity(stop.of, known)
        except InputError as error:
            problems.append(Problem(key=("stops", k, "of"), message=str(error)))
    return problems
