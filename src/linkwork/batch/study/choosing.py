"""The designs of a study from the ``[dimensions]`` of its plan."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.batch.sampling import (
    CHUNK,
    Distribution,
    Normal,
    Plan,
    Uniform,
    from_table,
    grid,
    latin_hypercube,
    random,
)
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError
from linkwork.mechanism.description import Problems

__all__ = ["Choice", "Triangular", "choose_values", "values_between"]

_RANGE = frozenset({"from", "to"})
_LEVELS = _RANGE | {"levels"}
_TRIANGLE = _RANGE | {"likeliest"}
_NORMAL = frozenset({"mean", "deviation"})

#: What a plan of this sampling must give, and which keys say nothing in it.
_NEEDED = {
    "grid": ((), ("count", "seed", "table", "columns")),
    "random": (("count", "seed"), ("table", "columns")),
    "latin-hypercube": (("count", "seed"), ("table", "columns")),
    "table": (("table",), ("count", "seed")),
}
_WANTED = {
    "grid": "values: [40, 50, 60] or { from = 40, to = 60, levels = 3 }",
    "random": "a distribution: { from = 36, to = 44 }, { mean = 40, deviation = 0.1 }, "
    "{ from = 36, to = 44, likeliest = 41 }, or values that are as likely: [40, 50, 60]",
    "latin-hypercube": "a range: { from = 36, to = 44 }",
    "table": "one number for all designs: what varies stands in the table",
}
_DOES = {
    "grid": "a grid is every combination of its values",
    "random": "random designs are drawn",
    "latin-hypercube": "random designs are drawn",
    "table": "designs stand in the table",
}


@dataclass(frozen=True)
class Choice:
    """Each of some values is as likely."""

    values: tuple[float, ...]

    def __call__(self, generator: np.random.Generator, count: int) -> Array:
        drawn: Array = np.array(self.values)[generator.integers(len(self.values), size=count)]
        return drawn


@dataclass(frozen=True)
class Triangular:
    """Values from ``low`` to ``high``, those near ``likeliest`` drawn most often."""

    low: float
    likeliest: float
    high: float

    def __post_init__(self) -> None:
        if not self.low <= self.likeliest <= self.high or self.low == self.high:
            raise InputError(
                "a triangle needs from <= likeliest <= to and from < to, "
                f"got {self.low:g}, {self.likeliest:g}, {self.high:g}"
            )

    def __call__(self, generator: np.random.Generator, count: int) -> Array:
        return generator.triangular(self.low, self.likeliest, self.high, count)


def choose_values(
    content: Mapping[str, Any], folder: Path, problems: Problems
) -> tuple[Plan, Mapping[str, float]] | None:
    """What varies and what is the same for all designs; ``None`` with problems noted.

    Parameters
    ----------
    content : Mapping
        Of a plan, its structure checked.
    folder : Path
        Where the table is looked for.
    """
    before = len(problems)
    sampling = content["sampling"]
    needed, useless = _NEEDED[sampling]
    for key in needed:
        if key not in content:
            problems.add((key,), f'is missing: sampling = "{sampling}" needs it')
    for key in useless:
        if key in content:
            problems.add((key,), f"has no effect: {_DOES[sampling]}; leave it out")
    given = content.get("dimensions", {})
    constants = {name: float(entry) for name, entry in given.items() if _is_number(entry)}
    varied = {name: entry for name, entry in given.items() if name not in constants}
    read = {
        "grid": _levels,
        "random": _distribution,
        "latin-hypercube": _range,
        "table": _nothing,
    }[sampling]
    found = {name: _read(name, entry, sampling, read, problems) for name, entry in varied.items()}
    if not varied and sampling != "table":
        problems.add(("dimensions",), f"varies nothing: {_WANTED[sampling]}")
    # a plan is made only of sound dimensions: its own errors would repeat those noted
    if len(problems) > before:
        return None
    try:
        plan = _plan(content, folder, found)
    except InputError as error:
        problems.add(("table",) if sampling == "table" else ("dimensions",), str(error))
        return None
    for name in set(plan) & set(constants):
        problems.add(("dimensions", name), "is a column of the table too: leave one out")
    if not plan.count:
        problems.add(("table",), "has no rows: a study needs at least one design")
    return None if len(problems) > before else (plan, constants)


def values_between(plan: Plan, start: int, stop: int) -> dict[str, Array]:
    """The designs from ``start`` up to ``stop``, without those before, (stop - start,) each."""
    pieces = [
        {
            # random values are drawn in chunks of fixed size, so that a design does not depend on
            # the chunks of the study
            name: values[max(start - k * CHUNK, 0) : stop - k * CHUNK]
            for name, values in _chunk_of(plan, k).items()
        }
        for k in range(start // CHUNK, -(-stop // CHUNK))
    ]
    return {name: np.concatenate([piece[name] for piece in pieces]) for name in plan}


@lru_cache(maxsize=2)
def _chunk_of(plan: Plan, k: int) -> Mapping[str, Array]:
    """A chunk of a plan; chunks of a study, which are smaller, need it several times."""
    return plan.chunk(k)


def _plan(content: Mapping[str, Any], folder: Path, found: Mapping[str, Any]) -> Plan:
    match content["sampling"]:
        case "grid":
            return grid(found)
        case "random":
            return random(content["count"], found, content["seed"])
        case "latin-hypercube":
            return latin_hypercube(content["count"], found, content["seed"])
        case _:
            return from_table(folder / content["table"], content.get("columns"))


def _read(
    name: str,
    entry: Any,
    sampling: str,
    read: Callable[[Any], Any],
    problems: Problems,
) -> Any:
    """What one dimension does in its sampling; ``None`` with a problem noted."""
    key = ("dimensions", name)
    try:
        found = read(entry)
    except InputError as error:
        problems.add(key, str(error))
        return None
    if found is None:
        got = "a list" if isinstance(entry, list) else ", ".join(entry) or "an empty table"
        problems.add(key, f'sampling = "{sampling}" needs {_WANTED[sampling]}; got {got}')
    return found


def _is_number(entry: Any) -> bool:
    return isinstance(entry, int | float)


def _ends(entry: Mapping[str, float]) -> tuple[float, float]:
    low, high = float(entry["from"]), float(entry["to"])
    if low > high:
        raise InputError(f"from = {low:g} must not be larger than to = {high:g}")
    return low, high


def _levels(entry: Any) -> Array | None:
    if isinstance(entry, list):
        return np.array(entry, dtype=float)
    if set(entry) != _LEVELS:
        return None
    # NumPy would silently keep the lower end only
    if entry["levels"] == 1 and entry["from"] != entry["to"]:
        raise InputError("levels = 1 cannot include both ends of the range: use two or more levels")
    low, high = _ends(entry)
    return np.linspace(low, high, entry["levels"])


def _distribution(entry: Any) -> Distribution | None:
    if isinstance(entry, list):
        return Choice(tuple(map(float, entry)))
    if set(entry) == _RANGE:
        return Uniform(*_ends(entry))
    if set(entry) == _TRIANGLE:
        return Triangular(float(entry["from"]), float(entry["likeliest"]), float(entry["to"]))
    if set(entry) == _NORMAL:
        return Normal(float(entry["mean"]), float(entry["deviation"]))
    return None


def _range(entry: Any) -> tuple[float, float] | None:
    return _ends(entry) if not isinstance(entry, list) and set(entry) == _RANGE else None


def _nothing(entry: Any) -> None:
    return None
