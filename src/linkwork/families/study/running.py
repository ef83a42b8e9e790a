"""An executor of worker processes on this machine, and what such a process does.

``concurrent.futures.ProcessPoolExecutor`` is not suitable:

* Its processes run the caller's main module again, so a study in a script without
  ``if __name__ == "__main__"`` ends in an error.
* Its processes hold both ends of their pipes, so they survive a killed run. Ctrl-C reaches them
  too, and their tracebacks reach the terminal.

Threads are not suitable: most of the time of a call is spent in code that holds the GIL.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from threading import local
from time import monotonic
from typing import Any, TypeVar

from linkwork import wings
from linkwork.core.foundation.errors import InputError, LinkworkError
from linkwork.core.foundation.files import as_path
from linkwork.core.foundation.loading import cores, installed_with
from linkwork.core.foundation.values import whole_number
from linkwork.families.study.plan import read_plan
from linkwork.families.study.store import Summary, check_packages, open_store, summary_of
from linkwork.families.study.study import Part, Study, compute_part

Result = TypeVar("Result")


class ProcessExecutor(ThreadPoolExecutor):
    """Runs functions of modules in processes, one for each thread of the pool.

    Parameters
    ----------
    count : int
    """

    def __init__(self, count: int) -> None:
        super().__init__(count, initializer=self._start)
        self._own = local()
        self._processes: list[subprocess.Popen[bytes]] = []

    def submit(
        self, function: Callable[..., Result], /, *arguments: Any, **named: Any
    ) -> Future[Result]:
        """The result of a call in a process.

        A :class:`LinkworkError` of the function becomes an :class:`InputError`, and so does the
        death of a process.
        """
        future: Future[Result] = super().submit(self._result, (function, arguments, named))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = True) -> None:
        """End the processes; calls that are running fail."""
        for process in self._processes:
            process.kill()
        super().shutdown(wait, cancel_futures=cancel_futures)
        for process in self._processes:  # those that were just starting too
            process.kill()
            with suppress(OSError), process:  # closing its input fails if that has unread data
                pass

    def _start(self) -> None:
        """The process of a thread."""
        self._own.process = subprocess.Popen(
            [sys.executable, "-P", "-m", __name__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            # one core for each process
            env={
                "OMP_NUM_THREADS": "1",
                "OPENBLAS_NUM_THREADS": "1",
                **os.environ,
                "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
            },
            # new session: Ctrl-C reaches only the main process, which ends the others
            start_new_session=True,
        )
        self._processes.append(self._own.process)

    def _result(self, call: object) -> Any:
        process = self._own.process
        try:
            pickle.dump(call, process.stdin, pickle.HIGHEST_PROTOCOL)
            process.stdin.flush()
            result = pickle.load(process.stdout)
        except (EOFError, OSError, ValueError, pickle.UnpicklingError):
            raise InputError(
                "a worker process has ended, perhaps for lack of memory: reduce chunk or "
                "--workers; the same command goes on from the chunks that are stored"
            ) from None
        if isinstance(result, LinkworkError):
            raise result
        return result


def serve() -> None:
    """Read calls from the input and write their results to the output, until the input ends.

    The input ends with the process that started this one, so a killed run leaves no processes.
    """
    calls = sys.stdin.buffer
    results = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # printed text must not enter the results
    with suppress(EOFError, BrokenPipeError, pickle.UnpicklingError):
        while True:
            function, arguments, named = pickle.load(calls)
            try:
                result = function(*arguments, **named)
            except LinkworkError as error:
                result = InputError(str(error))
            pickle.dump(result, results, pickle.HIGHEST_PROTOCOL)
            results.flush()
    os._exit(0)  # the main process has ended


if __name__ == "__main__":
    serve()


# ----------------------------------------------------------------------
# Run a study chunk by chunk into its store: in this process, in worker processes, or on a cluster.
#
# Workers are executors of ``concurrent.futures``. They need only Linkwork: they receive their input
# with the call and return the results; only the main process writes to the store.


_INTERRUPT_CHECK = 1.0  # interval of checks for Ctrl-C, which some systems need [s]
_CLUSTER_PATIENCE = 10  # timeout for the scheduler's answer and its first worker [s]
_AHEAD = 2  # parts for each thread of the cluster: no worker has to wait


def compute_parts(
    study: Study, chunks: Iterable[int], workers: int, scheduler: str | None
) -> Generator[tuple[int, Part]]:
    """The parts of some chunks in order of completion, with the numbers of the chunks.

    With a scheduler its cluster computes, otherwise worker processes; with one worker, the calling
    process.
    """
    if scheduler is not None:
        with cluster_executor(scheduler, study.job.version) as (cluster, threads):
            yield from _completed(study, chunks, cluster, _AHEAD * threads)
    elif workers > 1:
        with ProcessExecutor(workers) as processes:
            yield from _completed(study, chunks, processes, workers + 1)
    else:
        for k in chunks:
            yield k, compute_part(study.job, study.values(k))


def _completed(
    study: Study, chunks: Iterable[int], executor: Executor, most: int
) -> Iterator[tuple[int, Part]]:
    """Parts in order of completion; at most ``most`` are running."""
    running: dict[Future[Part], int] = {}
    waiting = iter(chunks)
    while True:
        for k in islice(waiting, most - len(running)):
            running[executor.submit(compute_part, study.job, study.values(k))] = k
        if not running:
            return
        for future in wait(running, _INTERRUPT_CHECK, FIRST_COMPLETED).done:
            yield running.pop(future), future.result()


@contextmanager
def cluster_executor(scheduler: str, version: str) -> Iterator[tuple[Executor, int]]:
    """The executor of a Dask cluster, and the number of its threads.

    Parts of workers that die are computed again.

    Raises
    ------
    MissingPackageError
        If dask.distributed is not installed.
    InputError
        If no scheduler answers, it has no workers, or these lack Linkwork or end repeatedly.
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
        try:
            client.wait_for_workers(1, timeout=_CLUSTER_PATIENCE)
        except TimeoutError:
            raise InputError(
                f"the scheduler at {scheduler} has no workers: start some with\n"
                f"    dask worker {scheduler} --nthreads 1"
            ) from None
        try:
            # pure: Dask would return a stored result for equal values
            yield client.get_executor(pure=False), sum(client.nthreads().values())
        except ModuleNotFoundError as error:
            raise InputError(
                f"the workers of {scheduler} lack {error.name}: install Linkwork {version} "
                "where they run"
            ) from None
        except distributed.KilledWorker as error:
            raise InputError(
                "workers ended repeatedly on the same designs, perhaps for lack of "
                f"memory: reduce chunk ({error})"
            ) from None


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
    chunk's files, each with its checksum and renamed when it is complete, then the chunk's record.
    After a killed run, unfinished chunks are computed again, and so are damaged ones.
    """
    check_packages()
    if workers is not None:
        workers = whole_number("workers", workers, least=1)
    study = plan if isinstance(plan, Study) else read_plan(plan)
    if study.job.device == "gpu" and scheduler is None:  # an error before a store is created
        wings.use("families.gpu.kernel").graphics_card()
    if workers is None:
        workers = 1 if study.job.device == "gpu" else cores()
    with open_store(study, as_path(store), force=force) as target:
        began = monotonic()
        # designs of an earlier run do not count in the rate
        before = study.count_in(target.done)

        def tell() -> None:
            if progress is not None:
                count, done = study.plan.count, study.count_in(target.done)
                seconds = monotonic() - began
                progress(Progress(total=count, done=done, before=before, seconds=seconds))

        tell()
        left = [k for k in range(study.chunks) if k not in target.done]
        if left:
            # more processes than chunks would only load Linkwork
            parts = compute_parts(study, left, min(workers, len(left)), scheduler)
            with closing(parts):  # ends the workers also when the store fails
                for k, part in parts:
                    target.write(k, part)
                    tell()
    return replace(summary_of(store), repaired=target.damaged)
