"""Random inputs of every kind, in processes that are ended when they do not answer.

``python -m tests.campaigns.fuzz 12 99`` repeats the inputs of these numbers.
"""

from __future__ import annotations

import multiprocessing
import os
import resource
import signal
import sys
import tempfile
import warnings
from collections import Counter
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import FrameType
from typing import NoReturn

from tests.campaigns.fuzzing.trials import trial
from tests.campaigns.fuzzing.witness import TooLongError, Witness

__all__ = ["fuzz_campaign"]

_MEMORY = 6 << 30  # bytes of address space of a process
_STOPPED = 8.0  # seconds of processor time of one input
_KILLED = 300.0  # seconds on the clock without an answer
_AT_ONCE = 200  # inputs of one order


def fuzz_campaign(count: int, first: int = 0) -> tuple[Counter[str], list[str]]:
    """Counts and false claims of so many inputs."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    left = [
        range(k, min(k + _AT_ONCE, first + count)) for k in range(first, first + count, _AT_ONCE)
    ]
    left.reverse()
    crew = [_Worker() for _ in range(int(os.environ.get("LINKWORK_FUZZERS", os.cpu_count() or 1)))]
    while left or any(worker.numbers for worker in crew):
        for worker in crew:
            if not worker.numbers and left:
                worker.order(left.pop())
        busy = {worker.connection: worker for worker in crew if worker.numbers}
        ready = wait([*busy], _KILLED)
        for connection in ready or [*busy]:
            worker = busy[connection]
            number = worker.numbers[0]
            answer = worker.answer() if ready else None
            if answer is None:
                counts["processes that did not answer"] += 1
                false.append(f"{number}: no answer")
                rest = worker.numbers[1:]
                worker.replace()
                if rest:
                    worker.order(rest)
                continue
            worker.numbers = worker.numbers[1:]
            counts += answer[0]
            counts["inputs"] += 1
            false += [f"{number}: {what}" for what in answer[1]]
            for what in answer[1] if os.environ.get("LINKWORK_FUZZERS") else ():
                print(f"{number}: {what}", flush=True)
    for worker in crew:
        worker.end()
    return counts, false


class _Worker:
    """A process and the numbers of the inputs that it has not answered."""

    numbers: range = range(0)

    def __init__(self) -> None:
        self._start()

    def _start(self) -> None:
        self.connection, theirs = multiprocessing.Pipe()
        self._process: BaseProcess = multiprocessing.get_context("spawn").Process(
            target=_work, args=(theirs,), daemon=True
        )
        self._process.start()
        theirs.close()

    def order(self, numbers: range) -> None:
        """Send numbers of inputs."""
        self.numbers = numbers
        self.connection.send(numbers)

    def answer(self) -> tuple[Counter[str], list[str]] | None:
        """The outcome of the next input; ``None`` if the process has ended."""
        try:
            answer: tuple[Counter[str], list[str]] = self.connection.recv()
        except EOFError:
            return None
        return answer

    def replace(self) -> None:
        """End the process and start another."""
        self.end()
        self.numbers = range(0)
        self._start()

    def end(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join()
        self.connection.close()


def _work(connection: Connection) -> None:
    _guard()
    with tempfile.TemporaryDirectory() as name:
        while True:
            try:
                numbers = connection.recv()
            except EOFError:
                return
            for number in numbers:
                found = _tried(number, Path(name))
                connection.send((found.counts, found.false))


def _guard() -> None:
    """Limit memory, stop long inputs, and make every warning an error."""
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    signal.signal(signal.SIGPROF, _stop)
    warnings.simplefilter("error")


def _stop(_: int, frame: FrameType | None) -> NoReturn:
    signal.setitimer(signal.ITIMER_PROF, _STOPPED)
    raise TooLongError(f"stopped after {_STOPPED:.0f} s")


def _tried(number: int, folder: Path) -> Witness:
    signal.setitimer(signal.ITIMER_PROF, _STOPPED)
    try:
        return trial(number, folder)
    except TooLongError:  # between two calls
        witness = Witness()
        witness.false.append(f"more than {_STOPPED:.0f} s")
        return witness
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


if __name__ == "__main__":
    _guard()
    with tempfile.TemporaryDirectory() as folder:
        for number in sys.argv[1:]:
            outcome = _tried(int(number), Path(folder))
            print(number, dict(outcome.counts), *outcome.false, sep="\n  ")
