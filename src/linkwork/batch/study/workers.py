"""Processes of this machine compute the parts of a study.

``concurrent.futures.ProcessPoolExecutor`` cannot serve here, nor can what is built on
multiprocessing, such as Dask's ``LocalCluster``:

* Its processes run the caller's main module once more, so a study in a script without
  ``if __name__ == "__main__"`` ends in an error.
* The death of one process breaks the pool and fails all parts under way; which part a process died
  over is not known, so designs that always kill their worker would be computed for ever.
* Its processes hold both ends of their pipes, so they outlive a run that was killed.

A process with a pipe of its own, asked by one thread, has none of this.
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
#: The number of a chunk, and what varies in it.
Task = tuple[int, Values]

_MOST_DEATHS = 3  # of processes over one and the same part
_PATIENCE = 1.0  # seconds between looks whether somebody wants to interrupt


class _Future(Protocol):
    def result(self) -> Any: ...

    def add_done_callback(self, fn: Callable[[Any], object], /) -> object: ...


def one_after_the_other(job: Job, tasks: Iterable[Task]) -> Iterator[tuple[int, Part]]:
    """Parts computed by this process."""
    for k, values in tasks:
        yield k, compute_part(job, values)


def local_crew(job: Job, tasks: Iterable[Task], workers: int) -> Iterator[tuple[int, Part]]:
    """Parts computed by so many processes, in the order in which they are ready."""
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
    """Parts in the order in which they are ready; no more than ``most`` are under way."""
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
    """The next future that is done; Ctrl-C is heard meanwhile on every system."""
    while True:
        try:
            return ready.get(timeout=_PATIENCE)
        except Empty:
            continue


class _Processes:
    """Worker processes, each asked by one thread at a time."""

    def __init__(self, job: Job, count: int) -> None:
        self._job = job
        self._idle: SimpleQueue[subprocess.Popen[bytes]] = SimpleQueue()
        self._all: set[subprocess.Popen[bytes]] = set()
        self._ended = False
        self._changing = Lock()
        for _ in range(count):
            self._idle.put(self._started())

    def part(self, values: Values) -> Part:
        """The part of some designs, by whichever process is idle.

        Raises
        ------
        InputError
            If the job is refused, or processes die over it again and again.
        """
        for _ in range(_MOST_DEATHS):
            process = self._idle.get()
            try:
                answer = self._asked(process, values)
            except (EOFError, OSError, pickle.UnpicklingError):
                # an answer cut short leaves the pipe out of step: a new process takes over
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
                    with suppress(OSError):  # what it did not read is lost with it
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
        # in a session of its own: Ctrl-C reaches the run, which ends its workers itself
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
