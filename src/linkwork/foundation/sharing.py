"""Work shared among threads; the calling thread takes part."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from threading import Lock
from typing import TypeVar

__all__ = ["cores", "share_out"]

Item = TypeVar("Item")


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def share_out(work: Callable[[Item], object], items: Iterable[Item], threads: int) -> None:
    """Apply ``work`` to every item; a free thread takes the next one.

    The calling thread works too, since a waiting thread would occupy a core while the new threads
    start. The first exception is raised here, and no further item is begun.
    """
    left, lock = iter(items), Lock()

    def take_turns() -> None:
        nonlocal left
        while True:
            # iterators are not safe among threads
            with lock:
                try:
                    item = next(left)
                except StopIteration:
                    return
            try:
                work(item)
            except BaseException:
                with lock:
                    # after an error no thread begins a further item
                    left = iter(())
                raise

    if threads <= 1:
        take_turns()
        return
    with ThreadPoolExecutor(threads - 1) as pool:
        helpers = [pool.submit(take_turns) for _ in range(threads - 1)]
        take_turns()
    for helper in helpers:
        # raises the error of a helper here
        helper.result()
