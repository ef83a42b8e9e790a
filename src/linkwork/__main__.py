"""The program, also as ``python -m linkwork``: Ctrl-C is quiet from the first import on."""

from __future__ import annotations

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


if __name__ == "__main__":
    main()
