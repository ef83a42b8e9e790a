"""The task of one worker: the motions of some designs, and the values to keep."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from linkwork.batch.family import Family, family_of
from linkwork.batch.study.measures import Condition, Measured
from linkwork.foundation.arrays import AnyArray, Array
from linkwork.foundation.errors import InputError
from linkwork.foundation.status import Status
from linkwork.mechanism.description import Description
from linkwork.motion import Model, as_described
from linkwork.results.quantities.registry import Call

__all__ = ["Job", "Part", "compute_part", "linkwork_version", "passes_name"]

_MOST_PROBLEMS = 20  # distinct reasons that are kept of one part
_FURTHER = "further reasons"


def linkwork_version() -> str:
    """The version of Linkwork that runs here."""
    try:
        return version("linkwork")
    except PackageNotFoundError:  # a tree on the path that was never installed
        return "unknown"


def passes_name(condition: str) -> str:
    """The name of the array that says which designs pass a filter."""
    return f"passes.{condition}"


@dataclass(frozen=True, kw_only=True)
class Job:
    """What is computed of every design; goes to workers.

    Parameters
    ----------
    description : Description
        The mechanism, with the study's range of its input.
    keep : tuple of str
        Quantities at every row.
    reductions : Mapping[str, Call]
        One number per design, by the name of its array.
    filters : Mapping[str, Condition]
        What a design has to pass, by name.
    certify : bool
    device : str
        ``"cpu"`` or ``"gpu"``; every worker needs one.
    version : str
        Of Linkwork; a worker with another one refuses.
    """

    description: Description
    keep: tuple[str, ...]
    reductions: Mapping[str, Call]
    filters: Mapping[str, Condition]
    certify: bool
    device: str
    version: str


@dataclass(frozen=True, kw_only=True)
class Part:
    """What was computed of D consecutive designs.

    Parameters
    ----------
    arrays : Mapping[str, (D,) or (D, R)]
        By the names of the store's arrays.
    rows : Mapping[str, int]
        How many rows ended in which status, of designs that were built.
    problems : Mapping[str, int]
        Why so many designs could not be built.
    """

    arrays: Mapping[str, AnyArray]
    rows: Mapping[str, int]
    problems: Mapping[str, int]


def compute_part(job: Job, values: Mapping[str, Array | float]) -> Part:
    """The part of some designs.

    Parameters
    ----------
    values : Mapping[str, (D,) or number]
        What varies, in file units.

    Raises
    ------
    InputError
        If this is another version of Linkwork than the one that asks.
    """
    # results of two versions may differ by rounding: a store must not mix them
    if job.version != linkwork_version():
        raise InputError(
            f"the study was started with Linkwork {job.version}, a worker has "
            f"{linkwork_version()}: install the same version everywhere"
        )
    family = family_of(_model(job.description), values)
    built = family.designs.problem == 0
    # one thread: the processes of a study share the cores already
    motion = family.sweep(certify=job.certify, threads=1, device=job.device)
    measured = Measured(motion)
    passes = {name: built & condition.holds(measured) for name, condition in job.filters.items()}
    passed = np.logical_and.reduce([built, *passes.values()])
    arrays: dict[str, AnyArray] = {
        "built": built,
        "found": motion.found.sum(axis=1, dtype=np.int32),
        "certified": motion.certified.sum(axis=1, dtype=np.int32),
        "passed": passed,
    }
    arrays |= {passes_name(name): values for name, values in passes.items()}
    arrays |= {name: measured.value(str(call)) for name, call in job.reductions.items()}
    for name in job.keep:
        # designs that do not pass are left out, so that the store compresses
        arrays[name] = np.where(passed[:, None], measured[name], np.nan)
    if job.keep:
        arrays["status"] = motion.status
    return Part(arrays=arrays, rows=_rows(motion.status[built]), problems=_problems(family))


# a worker gets many parts of one study, and a model takes long to build
@lru_cache(maxsize=2)
def _model(description: Description) -> Model:
    return as_described(description)


def _rows(status: AnyArray) -> dict[str, int]:
    """Rows by status, in the order of codes."""
    codes, numbers = np.unique(status, return_counts=True)
    pairs = zip(codes.tolist(), numbers.tolist(), strict=True)
    return {Status.of_code(code).name: number for code, number in pairs}


def _problems(family: Family) -> dict[str, int]:
    """Designs that cannot be built by reason, the most frequent first."""
    designs = family.designs
    numbers = designs.problem[designs.problem > 0]
    counts = Counter(designs.problems[int(number)] for number in numbers)
    # ties by name, so that the order does not depend on the chunks
    ordered = sorted(counts.items(), key=lambda pair: (-pair[1], pair[0]))
    kept = dict(ordered[:_MOST_PROBLEMS])
    rest = sum(count for _, count in ordered[_MOST_PROBLEMS:])
    return {**kept, **({_FURTHER: rest} if rest else {})}
