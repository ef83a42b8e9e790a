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
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from threading import local
from typing import Any, TypeVar

from linkwork.core.foundation.errors import InputError, LinkworkError

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
