"""An executor of worker processes on this machine, and what such a process does.

``concurrent.futures.ProcessPoolExecutor`` is not suitable:

* Its processes run the caller's main module again, so a study in a script without
  ``if __name__ == "__main__"`` ends in an error.
* The death of one process breaks the pool and fails all running calls; the call that caused it is
  not known.
* Its processes hold both ends of their pipes, so they survive a killed run. Ctrl-C reaches them
  too, and their tracebacks reach the terminal.

Threads are not suitable: most of the time of a call is spent in code that holds the GIL.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import suppress
from threading import Lock, get_ident
from typing import Any, TypeVar

from linkwork.core.foundation.errors import InputError, LinkworkError

_MOST_DEATHS = 3  # deaths of processes on the same call

Result = TypeVar("Result")


class ProcessExecutor(ThreadPoolExecutor):
    """Runs functions of modules in processes, one for each thread of the pool.

    A call whose process dies is repeated by a new process.

    Parameters
    ----------
    count : int
    """

    def __init__(self, count: int) -> None:
        super().__init__(count)
        self._process_of: dict[int, subprocess.Popen[bytes]] = {}
        self._changing = Lock()
        self._ended = False

    def submit(
        self, function: Callable[..., Result], /, *arguments: Any, **named: Any
    ) -> Future[Result]:
        """The result of a call in a process.

        A :class:`LinkworkError` of the function becomes an :class:`InputError`, and so do
        repeated deaths of processes.
        """
        call = (function, arguments, named)
        future: Future[Result] = super().submit(self._result, call)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = True) -> None:
        """End the processes; calls that are running fail."""
        with self._changing:
            self._ended = True
        for process in self._process_of.values():
            _end(process)
        super().shutdown(wait, cancel_futures=cancel_futures)

    def _result(self, call: object) -> Any:
        for _ in range(_MOST_DEATHS):
            process = self._process()
            try:
                assert process.stdin is not None
                assert process.stdout is not None
                pickle.dump(call, process.stdin, pickle.HIGHEST_PROTOCOL)
                process.stdin.flush()
                result = pickle.load(process.stdout)
            except (EOFError, OSError, ValueError, pickle.UnpicklingError):
                _end(process)  # after an incomplete answer the pipe cannot be used
                continue
            if isinstance(result, LinkworkError):
                raise result
            return result
        raise InputError(
            f"worker processes ended {_MOST_DEATHS} times on the same designs, perhaps for lack "
            "of memory: reduce chunk or --workers"
        )

    def _process(self) -> subprocess.Popen[bytes]:
        """The process of this thread; a new one in place of a dead one."""
        with self._changing:
            if self._ended:
                raise CancelledError
            process = self._process_of.get(get_ident())
            if process is None or process.poll() is not None:
                process = self._process_of[get_ident()] = subprocess.Popen(
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
            return process


def _end(process: subprocess.Popen[bytes]) -> None:
    with suppress(OSError), process:  # closing its input fails if that has unread data
        process.kill()


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
