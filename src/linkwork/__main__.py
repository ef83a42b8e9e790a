"""The program, also as ``python -m linkwork``: Ctrl-C is quiet from the first import on."""

from __future__ import annotations

import signal
import sys
from importlib import import_module

__all__ = ["main"]

_INTERRUPTED = 128 + 2  # the shell's exit code after SIGINT


def main() -> None:
    """Entry point of the installed program."""
    try:
        # imports take most of a short run, and are interrupted like the rest
        import_module("linkwork.cli.main").main()
    except KeyboardInterrupt:
        sys.stderr.write("\nInterrupted.\n")
        sys.exit(_INTERRUPTED)
    finally:
        _finish()


def _finish() -> None:
    """The exit code stays what it is, whenever Ctrl-C was pressed or is pressed from now on."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # An interrupt of text that is executed, as in the making of a dataclass, has CPython end the
    # process by the signal even if it is caught; the next text that is executed revokes that.
    exec("")


if __name__ == "__main__":
    main()
