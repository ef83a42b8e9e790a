"""Positions at which a mechanism can rest under its loads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["Equilibrium"]


@dataclass(frozen=True, kw_only=True)
class Equilibrium:
    """An equilibrium of a mechanism.

    Parameters
    ----------
    input : float
        The value of the first input, in file units.
    values : Mapping[str, float]
        All variables by name, in file units.
    stable : bool
        Whether a small displacement leads back.
    frequency : float
        The natural frequency of small oscillations about a stable one [Hz]; of an unstable one
        the rate 1/s at which a displacement grows, divided by 2π, negative. With several inputs
        the least of ``frequencies``.
    frequencies : tuple of float
        Those of all its modes, rising; one for each input.
    indifferent : str
        ``near`` where the loads balance at neighbouring positions too, ``everywhere`` where they
        balance at all positions, else empty.

    Examples
    --------
    >>> import linkwork as lw
    >>> pendulum = lw.linkage(
    ...     length="m", points={"O": (0, 0), "A": (1, 0)},
    ...     links={"ground": ["O"], "bar": ["O", "A"]},
    ...     inputs=lw.Input(link="bar"), masses={"bar": lw.Mass(mass=1, center=(1, 0))},
    ...     gravity=lw.Gravity(),
    ... )
    >>> [(round(each.input), each.stable) for each in pendulum.equilibria()]
    [(-90, True), (90, False)]
    """

    input: float
    values: Mapping[str, float]
    stable: bool
    frequency: float
    frequencies: tuple[float, ...]
    indifferent: str = ""
