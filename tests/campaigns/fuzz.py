"""Random inputs of every kind, in processes that are ended when they do not answer.

``python -m tests.campaigns.fuzz 12 99`` repeats the inputs of these numbers.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import resource
import signal
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import FrameType
from typing import NoReturn

from tests.campaigns.fuzzing.trials import trial
from tests.campaigns.fuzzing.witness import TooLongError, Witness

__all__ = ["fuzz_campaign"]

_MEMORY = 6 << 30  # bytes of address space of a process
_STOPPED = 12.0  # seconds of processor time of one input
_KILLED = 400.0  # seconds on the clock without an answer
_AT_ONCE = 200  # inputs of one order


def fuzz_campaign(
    count: int, first: int = 0, workers: int | None = None, tell: Callable[[str], object] = len
) -> tuple[Counter[str], list[str]]:
    """Counts and false claims of so many inputs; ``tell`` is called with each of these."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    ends = range(first, first + count, _AT_ONCE)
    left = [range(k, min(k + _AT_ONCE, first + count)) for k in ends][::-1]
    crew = [_Worker() for _ in range(workers or os.cpu_count() or 1)]
    while left or any(worker.numbers for worker in crew):
        for worker in crew:
            if not worker.numbers and left:
                worker.order(left.pop())
        for worker in _ready([worker for worker in crew if worker.numbers]):
            number = worker.numbers[0]
            found, wrong = worker.answer() or _NO_ANSWER
            counts += found
            counts["inputs"] += 1
            for what in wrong:
                false.append(f"{number}: {what}")
                tell(false[-1])
    for worker in crew:
        worker.end()
    return counts, false


_NO_ANSWER = Counter({"processes that did not answer": 1}), ["no answer"]


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
        """The outcome of the next input; without one the process is replaced by another."""
        left = self.numbers[1:]
        answer: tuple[Counter[str], list[str]] | None = None
        if self.connection.poll():
            with contextlib.suppress(EOFError):
                answer = self.connection.recv()
        self.numbers = left
        if answer is None:
            self.end()
            self._start()
            if left:
                self.order(left)
        return answer

    def end(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join()
        self.connection.close()


def _ready(busy: Sequence[_Worker]) -> list[_Worker]:
    """Those that have answered or ended; after a long time all of them."""
    ready = wait([worker.connection for worker in busy], _KILLED)
    return [worker for worker in busy if worker.connection in ready or not ready]


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


def main(numbers: list[str]) -> None:
    """Repeat inputs by their numbers and print what is false."""
    _guard()
    with tempfile.TemporaryDirectory() as folder:
        for number in numbers:
            outcome = _tried(int(number), Path(folder))
            lines = [number, *map(str, outcome.counts.items()), *outcome.false]
            sys.stdout.write("\n  ".join(lines) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
