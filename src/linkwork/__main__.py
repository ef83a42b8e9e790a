"""The program, also as ``python -m linkwork``: Ctrl-C is quiet from the first import on."""

from __future__ import annotations

import sys
from importlib import import_module

from linkwork.core.commands.terminal import (
    INTERRUPTED,
    ignore_interrupts,
    leave,
    was_interrupted,
    watch_interrupts,
)


def main() -> None:
    """Entry point of the installed program."""
    try:
        watch_interrupts()
        # imports take most of a short run, and are interrupted like the rest
        import_module("linkwork.core.commands.main").main()
    except KeyboardInterrupt:
        sys.stderr.write("\nInterrupted.\n")
        leave(INTERRUPTED)
    except SystemExit as end:
        if was_interrupted() and isinstance(end.code, int):
            leave(end.code)
        raise
    finally:
        ignore_interrupts()


if __name__ == "__main__":
    main()
