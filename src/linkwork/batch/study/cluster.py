"""Compute the parts of a study on a Dask cluster; the only module that uses dask.distributed.

Workers need only Linkwork: they receive their input with the task and return the results; only the
main process writes to the store.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any
from uuid import uuid4

from linkwork.batch.study.job import Job, Part, compute_part
from linkwork.batch.study.workers import Task, Values, pump_parts
from linkwork.foundation.errors import InputError
from linkwork.foundation.optional_packages import installed_with

__all__ = ["cluster_crew"]

_PATIENCE = 10  # timeout for the scheduler's answer and its first worker [s]
_AHEAD = 2  # parts for each thread of the cluster


def cluster_crew(job: Job, tasks: Iterable[Task], scheduler: str) -> Iterator[tuple[int, Part]]:
    """Parts in order of completion; those of workers that die are computed again.

    Raises
    ------
    MissingPackageError
        If dask.distributed is not installed.
    InputError
        If no scheduler answers, it has no workers, or these reject the job.
    """
    with installed_with("cluster", "studies on a cluster need dask.distributed"):
        import distributed
    try:
        client = distributed.Client(scheduler, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(
            f"no Dask scheduler answers at {scheduler} ({error}): start one with\n"
            "    dask scheduler"
        ) from None
    with client:
        _wait_for_workers(client, scheduler)
        # more pending parts than threads, so that no worker has to wait
        threads = sum(client.nthreads().values())
        run = uuid4().hex

        def submit(values: Values) -> Any:
            # a unique key each time: Dask would return a cached result for equal values
            return client.submit(compute_part, job, values, key=f"linkwork-{run}-{uuid4().hex}")

        try:
            yield from pump_parts(tasks, submit, _AHEAD * threads)
        except ModuleNotFoundError as error:
            raise InputError(
                f"the workers of {scheduler} lack {error.name}: install Linkwork {job.version} "
                "where they run"
            ) from None
        except distributed.KilledWorker as error:
            raise InputError(
                "workers ended repeatedly on the same designs, perhaps for lack of "
                f"memory: reduce chunk ({error})"
            ) from None


def _wait_for_workers(client: Any, scheduler: str) -> None:
    try:
        client.wait_for_workers(1, timeout=_PATIENCE)
    except TimeoutError:
        raise InputError(
            f"the scheduler at {scheduler} has no workers: start some with\n"
            f"    dask worker {scheduler} --nthreads 1"
        ) from None
