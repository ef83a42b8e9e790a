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
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from queue import Empty, SimpleQueue
from threading import Lock
from typing import Any, Protocol

from linkwork.batch.study.job import Job, Part, compute_part
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError

__all__ = ["Task", "Values", "local_crew", "one_after_the_other", "pump_parts"]

Values = Mapping[str, "Array | float"]
#: The number of a chunk, and its varied numbers.
Task = tuple[int, Values]

_MOST_DEATHS = 3  # deaths of workers on the same part
_PATIENCE = 1.0  # interval of checks for Ctrl-C [s]


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
            return ready.get(timeout=_PATIENCE)
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
            [sys.executable, "-P", "-m", "linkwork.batch.study.worker"],
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
