"""All assembly configurations at one input, and whether the list is complete."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

from linkwork.foundation.completeness import Completeness
from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.named_sequence import NamedSequence
from linkwork.foundation.presenting import presenter
from linkwork.results.position import Position
from linkwork.results.summary import Summary, driven_text

__all__ = ["Configurations", "PathCount", "configurations_summary", "solution_counts"]


@dataclass(frozen=True, kw_only=True)
class PathCount:
    """The counts of solutions of one block, summed over all configurations of the blocks before it.

    Parameters
    ----------
    unknowns : tuple of str
        The unknowns of the block.
    solved : int
        The number of configurations of earlier blocks for which the block was solved.
    paths : int
        Solution paths: finite + at_infinity + multiple + failed.
    finite : int
        Isolated complex solutions.
    real : int
        Real solutions; each is a configuration.
    at_infinity, multiple, failed : int
        Paths that ended at infinity, at a multiple solution, or were lost.
    expected : int
        The number of solutions of a random mechanism with the same structure.
    bound : int
        The largest possible number of solutions.
    theorem : str
        The theorem behind the bound.

    Examples
    --------
    >>> import linkwork as lw
    >>> count = lw.example("four-bar").configurations(60).paths[0]
    >>> count.finite, count.real, count.bound
    (2, 2, 2)
    """

    unknowns: tuple[str, ...]
    solved: int = 1
    paths: int = 0
    finite: int = 0
    real: int = 0
    at_infinity: int = 0
    multiple: int = 0
    failed: int = 0
    expected: int = 0
    bound: int = 0
    theorem: str = ""

    def plus(self, *others: PathCount) -> PathCount:
        """The sum of this count and others of the same block."""
        counts = (self, *others)
        kept = ("unknowns", "theorem")
        numbers = [f.name for f in fields(self) if f.name not in kept]
        sums = {name: sum(getattr(count, name) for count in counts) for name in numbers}
        theorems = dict.fromkeys(count.theorem for count in counts)
        return replace(self, theorem=" and ".join(theorems), **sums)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Configurations(NamedSequence[Position]):
    """All assembly configurations of a mechanism at one input value.

    A sequence of positions, each with its name in ``position.configuration``; indexed by number
    (from 0), by slice or by name. The order is by block in solving order; within a block ``open``
    before ``crossed``, otherwise by the block's unknowns, angles from 0 to a full turn.

    Parameters
    ----------
    mechanism : str
        The name of the mechanism.
    positions : tuple of Position
        The configurations.
    completeness : Completeness
        Whether the list is complete.
    message : str
        The same as a sentence, with remarks on this list.
    input, input_units : Mapping
        Input values and their units.
    paths : tuple of PathCount
        The counts of solutions of every block.
    seed : int
        The seed of all random numbers.

    Examples
    --------
    >>> import linkwork as lw
    >>> found = lw.example("four-bar").configurations(60)
    >>> found.names
    ('open', 'crossed')
    >>> round(found["crossed"]["rocker"], 3)
    -111.77
    """

    mechanism: str
    positions: tuple[Position, ...]
    completeness: Completeness
    message: str
    input: Mapping[str, float]
    input_units: Mapping[str, str] = FrozenDict()
    paths: tuple[PathCount, ...] = ()
    seed: int

    @property
    def _by_name(self) -> tuple[tuple[str, Position], ...]:
        return tuple((position.configuration, position) for position in self.positions)

    def _unknown(self, name: object) -> tuple[str, str]:
        here = f"of {self.mechanism} at this input"
        return f'there is no configuration "{name}" {here}', "configurations"

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all configurations."""
        return tuple(position.configuration for position in self.positions)

    def __repr__(self) -> str:
        return str(configurations_summary(self))

    def _repr_html_(self) -> str:
        """A picture and a short table, for notebooks."""
        return presenter(Configurations._repr_html_)(self)

    def to_dict(self) -> dict[str, Any]:
        """The list as JSON-ready data."""
        return {
            "mechanism": self.mechanism,
            "input": dict(self.input),
            "configurations": [position.to_dict() for position in self.positions],
            "completeness": self.completeness.name,
            "complete": self.completeness.complete,
            "message": self.message,
            "paths": [{**asdict(count), "unknowns": list(count.unknowns)} for count in self.paths],
            "seed": self.seed,
        }


def configurations_summary(found: Configurations) -> Summary:
    """One row per configuration, then the completeness and the ends of the paths."""
    at = driven_text(found.input, found.input_units)
    head = f"Configurations of {found.mechanism}" + (f" at {at}" if at else "")
    rows = []
    for position in found:
        values = ", ".join(f"{name} = {value:.8g}" for name, value in position.unknowns.items())
        certified = "certified" if position.certificate.certified else "not certified"
        rows.append((position.configuration, f"{values}  {certified}"))
    rows.append(("completeness", found.message))
    rows.append(("paths", "; ".join(map(solution_counts, found.paths))))
    return Summary(head, tuple(rows))


def solution_counts(count: PathCount) -> str:
    """``6 complex solutions, 4 of them real``."""
    finite = count.finite + count.multiple
    return f"{finite} complex solution{'' if finite == 1 else 's'}, {count.real} of them real"
