"""The task of a worker: solve some designs and return the values to store."""

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

_MOST_PROBLEMS = 20  # distinct reasons recorded for one part
_FURTHER = "further reasons"


def linkwork_version() -> str:
    """The running version of Linkwork."""
    try:
        return version("linkwork")
    except PackageNotFoundError:  # a source tree that is not installed
        return "unknown"


def passes_name(condition: str) -> str:
    """The name of the array of a filter's results."""
    return f"passes.{condition}"


@dataclass(frozen=True, kw_only=True)
class Job:
    """The computation for every design; sent to workers.

    Parameters
    ----------
    description : Description
        The mechanism, with the study's range of its input.
    keep : tuple of str
        Quantities at every row.
    reductions : Mapping[str, Call]
        One number per design, by the name of its array.
    filters : Mapping[str, Condition]
        Conditions on a design, by name.
    certify : bool
    device : str
        ``"cpu"`` or ``"gpu"``; every worker needs this device.
    version : str
        Version of Linkwork; a worker with another version rejects the job.
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
    """The results of D consecutive designs.

    Parameters
    ----------
    arrays : Mapping[str, (D,) or (D, R)]
        By the names of the store's arrays.
    rows : Mapping[str, int]
        Number of rows by status, of designs that could be built.
    problems : Mapping[str, int]
        Number of designs that could not be built, by reason.
    """

    arrays: Mapping[str, AnyArray]
    rows: Mapping[str, int]
    problems: Mapping[str, int]


def compute_part(job: Job, values: Mapping[str, Array | float]) -> Part:
    """Compute the results of some designs.

    Parameters
    ----------
    values : Mapping[str, (D,) or number]
        The varied numbers, in file units.

    Raises
    ------
    InputError
        If the version of Linkwork differs from that of the main process.
    """
    # results of two versions may differ by rounding: a store must not mix them
    if job.version != linkwork_version():
        raise InputError(
            f"the study was started with Linkwork {job.version}, a worker has "
            f"{linkwork_version()}: install the same version everywhere"
        )
    family = family_of(_model(job.description), values)
    built = family.designs.problem == 0
    # one thread, since the processes of a study already share the cores
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


# a worker computes many parts of one study, and building a model takes long
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
