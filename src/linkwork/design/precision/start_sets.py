"""Solved random members of the families of precision positions, shipped with the package.

``scripts/start_linkages`` computes them by monodromy and confirms them by the trace test. The
solutions are kept in single precision and polished when they are read, so that no file is trusted
with a number.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np

from linkwork.design.precision.problem import CONDITIONS, PrecisionProblem
from linkwork.foundation.arrays import AnyArray
from linkwork.foundation.errors import InputError
from linkwork.numerics.homotopy.monodromy import Member, first_of_each
from linkwork.numerics.homotopy.parameter_path import ParameterPath, polish_ends

__all__ = ["SHIPPED", "SHIPPED_PROBLEMS", "as_arrays", "member_of_arrays", "start_member"]

SHIPPED = Path(__file__).with_name("start_linkages.npz")
#: All families with a point; poses alone are solved by dyads.
SHIPPED_PROBLEMS = tuple(
    PrecisionProblem(poses=poses, points=points, pivots=pivots)
    for pivots in range(3)
    for poses in range(CONDITIONS)
    if (points := CONDITIONS - 2 * poses - 2 * pivots) > 0
)


def as_arrays(problem: PrecisionProblem, member: Member) -> dict[str, AnyArray]:
    """A solved member as arrays of the shipped file."""
    name = problem.name
    return {
        f"{name}.parameters": member.parameters,
        f"{name}.x": member.x.astype(np.complex64),
    }


@cache
def start_member(problem: PrecisionProblem) -> Member:
    """The shipped solved member of a family.

    Raises
    ------
    InputError
        If the installation is damaged: the file lacks the family, or has wrong numbers.
    """
    try:
        with np.load(SHIPPED) as stored:
            return member_of_arrays(problem, stored)
    except (OSError, KeyError, ValueError):
        raise InputError(f"{SHIPPED} is damaged: install Linkwork again") from None


def member_of_arrays(problem: PrecisionProblem, arrays: Mapping[str, AnyArray]) -> Member:
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
