"""Programs that are measured with one thread: the limits must stand before NumPy is loaded."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence

__all__ = ["LIMITS", "environment", "run_alone"]

LIMITS = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


def environment() -> dict[str, str]:
    """This process's environment with one thread for every numerical library."""
    return {**os.environ, **LIMITS}


def run_alone(module: str, arguments: Sequence[str]) -> int:
    """Run ``python -m module`` in a process of its own with one thread; its exit code."""
    command = [sys.executable, "-m", module, *arguments]
    return subprocess.run(command, env=environment(), check=False).returncode
