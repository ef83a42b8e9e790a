"""Compiles the kernels beside a run's workers: ``python -m tests.compile_kernels MARK``.

The file MARK is there until they are compiled.
"""

from __future__ import annotations

import sys
from pathlib import Path

import linkwork as lw


def main(mark: Path) -> None:
    """Moves a four-bar in every way that compiled code is used for."""
    try:
        four_bar = lw.example("four-bar")
        motion = four_bar.family({"O2 A": [40.0, 41.0, 110.0]}).sweep()  # one has dead points
        motion["B.x.d1"]
        four_bar.sweep(step=0.005)  # so long a table that it is worth while
    finally:
        mark.unlink()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
