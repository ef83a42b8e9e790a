"""Worker processes on this machine that compute the parts of a study.

``concurrent.futures.ProcessPoolExecutor`` and other pools based on multiprocessing, such as Dask's
``LocalCluster``, are not suitable:

* Their processes run the caller's main module again, so a study in a script without
  ``if __name__ == "__main__"`` ends in an error.
* The death of one process breaks the pool and fails all running parts; the part that caused it is
  not known, so designs that always kill their worker would be retried forever.
* Their processes hold both ends of their pipes, so they survive a killed run.

Separate processes, each with its own pipe and thread, avoid these problems.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Lock
from time import monotonic
from typing import Any, Protocol
from uuid import uuid4

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import as_path
from linkwork.core.foundation.loading import cores, installed_with
from linkwork.core.foundation.values import whole_number
from linkwork.families.gpu.kernel import graphics_card
from linkwork.families.study.packages import check_packages
from linkwork.families.study.plan import read_plan
from linkwork.families.study.store import open_store
from linkwork.families.study.study import Job, Part, Study, compute_part
from linkwork.families.study.summary import Summary, summary_of

Values = Mapping[str, "Array | float"]
#: The number of a chunk, and its varied numbers.
Task = tuple[int, Values]

_MOST_DEATHS = 3  # deaths of workers on the same part
_WORKERS_PATIENCE = 1.0  # interval of checks for Ctrl-C [s]


class _Future(Protocol):
    def result(self) -> Any: ...

    def add_done_callback(self, fn: Callable[[Any], object], /) -> object: ...


def one_after_the_other(job: Job, tasks: Iterable[Task]) -> Iterator[tuple[int, Part]]:
    """Compute the parts in this process."""
    for k, values in tasks:
        yield k, compute_part(job, values)


def local_crew(job: Job, tasks: Iterable[Task], workers: int) -> Iterator[tuple[int, Part]]:
    """Compute the parts in worker processes, in order of completion."""
    crew = _Processes(job, workers)
    pool = ThreadPoolExecutor(workers)

    try:
        yield from pump_parts(tasks, lambda values: pool.submit(crew.part, values), workers + 1)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        crew.end()
        pool.shutdown()


def pump_parts(
    tasks: Iterable[Task], submit: Callable[[Values], _Future], most: int
) -> Iterator[tuple[int, Part]]:
    """Parts in order of completion; at most ``most`` are running."""
    ready: SimpleQueue[_Future] = SimpleQueue()
    pending: dict[_Future, int] = {}
    waiting = iter(tasks)
    while True:
        while len(pending) < most and (task := next(waiting, None)) is not None:
            future = submit(task[1])
            pending[future] = task[0]
            future.add_done_callback(ready.put)
        if not pending:
            return
        future = _next(ready)
        yield pending.pop(future), future.result()


def _next(ready: SimpleQueue[_Future]) -> _Future:
    """The next completed future; Ctrl-C works meanwhile on every system."""
    while True:
        try:
            return ready.get(timeout=_WORKERS_PATIENCE)
        except Empty:
            continue


class _Processes:
    """Worker processes, each used by one thread at a time."""

    def __init__(self, job: Job, count: int) -> None:
        self._job = job
        self._idle: SimpleQueue[subprocess.Popen[bytes]] = SimpleQueue()
        self._all: set[subprocess.Popen[bytes]] = set()
        self._ended = False
        self._changing = Lock()
        for _ in range(count):
            self._idle.put(self._started())

    def part(self, values: Values) -> Part:
        """The part of some designs, computed by an idle process.

        Raises
        ------
        InputError
            If the job is rejected, or processes die on it repeatedly.
        """
        for _ in range(_MOST_DEATHS):
            process = self._idle.get()
            try:
                answer = self._asked(process, values)
            except (EOFError, OSError, pickle.UnpicklingError):
                # after an incomplete answer the pipe cannot be used: start a new process
                process.kill()
                self._idle.put(self._in_place_of(process))
                continue
            self._idle.put(process)
            if isinstance(answer, str):
                raise InputError(answer)
            return answer
        raise InputError(
            f"worker processes ended {_MOST_DEATHS} times on the same designs, perhaps for lack "
            "of memory: reduce chunk or --workers"
        )

    def end(self) -> None:
        """End all processes."""
        with self._changing:
            self._ended = True
        for process in self._all:
            process.kill()
        for process in self._all:
            process.wait()
            for stream in (process.stdin, process.stdout):
                if stream is not None:
                    with suppress(OSError):  # unread data is discarded
                        stream.close()

    def _asked(self, process: subprocess.Popen[bytes], values: Values) -> Part | str:
        assert process.stdin is not None
        assert process.stdout is not None
        pickle.dump((self._job, values), process.stdin, pickle.HIGHEST_PROTOCOL)
        process.stdin.flush()
        answer: Part | str = pickle.load(process.stdout)
        return answer

    def _in_place_of(self, dead: subprocess.Popen[bytes]) -> subprocess.Popen[bytes]:
        with self._changing:
            return dead if self._ended else self._started()

    def _started(self) -> subprocess.Popen[bytes]:
        # new session: Ctrl-C reaches only the main process, which ends its workers
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", "linkwork.families.study.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**_quiet_threads(), "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            start_new_session=True,
        )
        self._all.add(process)
        return process


def _quiet_threads() -> dict[str, str]:
    """The environment of a process that uses one core."""
    return {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", **os.environ}


# ----------------------------------------------------------------------
# Compute the parts of a study on a Dask cluster; the only module that uses dask.distributed.
#
# Workers need only Linkwork: they receive their input with the task and return the results; only
# the main process writes to the store.


_CLUSTER_PATIENCE = 10  # timeout for the scheduler's answer and its first worker [s]
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
        client = distributed.Client(scheduler, timeout=_CLUSTER_PATIENCE, set_as_default=False)
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
        client.wait_for_workers(1, timeout=_CLUSTER_PATIENCE)
    except TimeoutError:
        raise InputError(
            f"the scheduler at {scheduler} has no workers: start some with\n"
            f"    dask worker {scheduler} --nthreads 1"
        ) from None


# ----------------------------------------------------------------------
# Run a study chunk by chunk into its store, with any number of workers.


@dataclass(frozen=True, kw_only=True)
class Progress:
    """Progress of a run.

    Parameters
    ----------
    total : int
        Designs of the study.
    done : int
        Designs stored.
    before : int
        Designs stored before this run.
    seconds : float
        Time since the start of the run [s].
    """

    total: int
    done: int
    before: int
    seconds: float

    @property
    def rate(self) -> float:
        """Designs per second of this run."""
        return (self.done - self.before) / self.seconds if self.seconds > 0 else 0.0

    @property
    def left(self) -> float | None:
        """Remaining time at this rate [s], if known."""
        return (self.total - self.done) / self.rate if self.rate else None


def run_study(
    plan: Study | Path | str,
    store: Path | str,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    force: bool = False,
    progress: Callable[[Progress], None] | None = None,
) -> Summary:
    """Compute the designs of a plan into a Zarr store that ``xarray.open_zarr`` reads.

    Parameters
    ----------
    plan : Study or path
        A plan, or its file.
    store : path
        A folder, usually ``….zarr``. A store of the same study is resumed.
    workers : int, optional
        Processes on this machine; by default one per core, or one with a graphics card. With one,
        the calling process computes.
    scheduler : str, optional
        Address of a Dask scheduler, ``tcp://host:8786``, whose workers compute instead.
    force : bool
        Delete the study in the store and start over.
    progress : callable, optional
        Called with the progress at the beginning and after each chunk.

    Raises
    ------
    InputError
        If the plan is invalid, or the store belongs to another study (lists the differences).
    MissingPackageError
        If zarr or xarray, or dask.distributed for a cluster, is not installed.

    Notes
    -----
    The stored data depend on the plan only, not on the workers or their order. The store can be
    read at any moment; missing chunks read as missing values. Only this process writes to it: a
    chunk's files, each renamed when it is complete, then the ledger entry with their checksums.
    After a killed run, unfinished chunks are computed again, and so are damaged ones.
    """
    check_packages()
    if workers is not None:
        workers = whole_number("workers", workers, least=1)
    study = plan if isinstance(plan, Study) else read_plan(plan)
    if study.job.device == "gpu" and scheduler is None:
        graphics_card()  # raises an error before a store is created
    with open_store(study, as_path(store), force=force) as target:
        tell = _teller(study, target.done, progress)
        tell()
        left = [k for k in range(study.chunks) if k not in target.done]
        tasks = ((k, study.values(k)) for k in left)
        if left:
            # closing ends the workers also when the store fails
            with closing(_crew(study, tasks, len(left), workers, scheduler)) as parts:
                for k, part in parts:
                    target.write(k, part)
                    tell()
        repaired: tuple[int | str, ...] = (*target.repaired, *target.damaged)
    return replace(summary_of(store), repaired=repaired)


def _crew(
    study: Study,
    tasks: Iterable[Task],
    chunks: int,
    workers: int | None,
    scheduler: str | None,
) -> Generator[tuple[int, Part]]:
    """The parts of all tasks, from the selected kind of workers."""
    if workers is None:
        workers = 1 if study.job.device == "gpu" else cores()
    # more processes than chunks would only load Linkwork
    count = min(workers, chunks)
    if scheduler is not None:
        yield from cluster_crew(study.job, tasks, scheduler)
    elif count == 1:
        yield from one_after_the_other(study.job, tasks)
    else:
        yield from local_crew(study.job, tasks, count)


def _teller(
    study: Study, done: set[int], progress: Callable[[Progress], None] | None
) -> Callable[[], None]:
    """A function that reports the chunks in ``done`` to ``progress``."""
    began = monotonic()

    # designs of an earlier run do not count in the rate
    before = study.count_in(done)

    def tell() -> None:
        if progress is not None:
            progress(
                Progress(
                    total=study.plan.count,
                    done=study.count_in(done),
                    before=before,
                    seconds=monotonic() - began,
                )
            )

    return tell
