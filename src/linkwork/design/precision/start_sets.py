"""Solved random members of the families of precision positions, shipped with the package.

``scripts/start_linkages`` computes them by monodromy and confirms them by the trace test. The
solutions are kept in single precision and polished when they are read, so that no file is trusted
with a number.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Protocol

import numpy as np

from linkwork.design.precision.problem import CONDITIONS, PrecisionProblem
from linkwork.foundation.arrays import AnyArray
from linkwork.foundation.errors import InputError
from linkwork.numerics.homotopy.monodromy import Family, Member, first_of_each
from linkwork.numerics.homotopy.parameter_path import ParameterPath, polish_ends

__all__ = [
    "SHIPPED",
    "SHIPPED_PROBLEMS",
    "NamedFamily",
    "as_arrays",
    "member_of_arrays",
    "start_member",
    "stored_member",
]

SHIPPED = Path(__file__).with_name("start_linkages.npz")
#: All families with a point; poses alone are solved by dyads.
SHIPPED_PROBLEMS = tuple(
    PrecisionProblem(poses=poses, points=points, pivots=pivots)
    for pivots in range(3)
    for poses in range(CONDITIONS)
    if (points := CONDITIONS - 2 * poses - 2 * pivots) > 0
)


class NamedFamily(Family, Protocol):
    """A family whose solved member is shipped."""

    @property
    def name(self) -> str:
        """The name of its start set."""

    @property
    def last(self) -> slice:
        """The parameters of the last equation."""


def as_arrays(problem: NamedFamily, member: Member) -> dict[str, AnyArray]:
    """A solved member as arrays of the shipped file."""
    name = problem.name
    return {
        f"{name}.parameters": member.parameters,
        f"{name}.x": member.x.astype(np.complex64),
    }


@cache
def start_member(problem: PrecisionProblem) -> Member:
    """The shipped solved member of a family; raises like :func:`stored_member`."""
    return stored_member(problem, SHIPPED)


def stored_member(problem: NamedFamily, path: Path) -> Member:
    """The solved member of a family in a shipped file.

    Raises
    ------
    InputError
        If the installation is damaged: the file lacks the family, or has wrong numbers.
    """
    try:
        with np.load(path) as stored:
            return member_of_arrays(problem, stored)
    except (OSError, KeyError, ValueError):
        raise InputError(f"{path} is damaged: install Linkwork again") from None


def member_of_arrays(problem: NamedFamily, arrays: Mapping[str, AnyArray]) -> Member:
    """The member of :func:`as_arrays`, its solutions polished.

    Raises
    ------
    KeyError, ValueError
        If these are no arrays of a solved member.
    """
    parameters, x = (arrays[f"{problem.name}.{field}"] for field in ("parameters", "x"))
    path = ParameterPath(system=problem, start=parameters, goal=parameters)
    sharp = polish_ends(path, x.astype(complex))
    if not sharp.regular.all() or len(
        first_of_each(problem.fingerprint(sharp.x, parameters))
    ) < len(x):
        raise ValueError("some solutions are none, or equal")
    return Member(parameters=parameters, x=sharp.x)
