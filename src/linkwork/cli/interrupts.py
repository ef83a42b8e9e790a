"""Ctrl-C: one quiet end, whatever the program does at that moment.

Python raises ``KeyboardInterrupt`` at whatever instruction runs. Two kinds of code lose it: CPython
drops every exception of an object that is being deleted, and some libraries turn all exceptions
into their own. So the interrupt is remembered too.
"""

from __future__ import annotations

import _thread
import atexit
import os
import signal
import sys
import threading
from contextlib import suppress
from types import FrameType
from typing import NoReturn

__all__ = [
    "INTERRUPTED",
    "answer_interrupt",
    "check_interrupt",
    "ignore_interrupts",
    "leave",
    "was_interrupted",
    "watch_interrupts",
]

#: The shell's exit code after SIGINT.
INTERRUPTED = 128 + 2

_LATER = 0.02  # seconds after which a deletion has ended
_came = threading.Event()


def watch_interrupts() -> None:
    """Remember interrupts, unless the program runs in the background and ignores them."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)
    sys.unraisablehook = _interrupt_again


def was_interrupted() -> bool:
    """Whether Ctrl-C has been pressed."""
    return _came.is_set()


def check_interrupt() -> None:
    """Raise an interrupt once more that a library has dropped; long work calls this regularly."""
    if _came.is_set():
        raise KeyboardInterrupt


def answer_interrupt() -> None:
    """Forget an interrupt that has ended a search whose best results are kept."""
    _came.clear()


def ignore_interrupts() -> None:
    """The exit code stays what it is, whenever Ctrl-C was pressed or is pressed from now on."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # An interrupt of text that is executed, as in the making of a dataclass, has CPython end the
    # process by the signal even if it is caught; the next text that is executed revokes that.
    exec("")


def leave(code: int) -> NoReturn:
    """End the process at once: what is registered for its end is done, objects are not deleted.

    Deleting them takes a third of a second once compiled code is loaded.
    """
    ignore_interrupts()
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # the reader may be gone
            stream.flush()
    os._exit(code)


def _interrupt(number: int, frame: FrameType | None) -> None:
    _came.set()
    signal.default_int_handler(number, frame)


def _interrupt_again(lost: sys.UnraisableHookArgs) -> None:
    """Repeat an interrupt that came while an object was deleted."""
    if lost.exc_type is KeyboardInterrupt:
        threading.Timer(_LATER, _thread.interrupt_main).start()
    else:
        sys.__unraisablehook__(lost)
