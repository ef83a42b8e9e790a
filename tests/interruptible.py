"""Processes that an interrupt reaches, also where the shell that began it all ignores it."""

from __future__ import annotations

import signal

__all__ = ["interruptible"]


def interruptible() -> None:
    """In a new process: what runs in the background has inherited that interrupts are ignored."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
