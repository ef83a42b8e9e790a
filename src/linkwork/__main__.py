"""The program, also as ``python -m linkwork``: Ctrl-C is quiet from the first import on."""

from __future__ import annotations

import sys
from importlib import import_module

from linkwork.cli.interrupts import INTERRUPTED, ignore_interrupts, watch_interrupts

__all__ = ["main"]


def main() -> None:
    """Entry point of the installed program."""
    try:
        watch_interrupts()
        # imports take most of a short run, and are interrupted like the rest
        import_module("linkwork.cli.main").main()
    except KeyboardInterrupt:
        sys.stderr.write("\nInterrupted.\n")
        sys.exit(INTERRUPTED)
    finally:
        ignore_interrupts()


if __name__ == "__main__":
    main()
