"""Settings of the whole test run: Hypothesis profiles, pictures without a screen, kernels once."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from hypothesis import settings

from linkwork.kernels.program.kernel_cache import kernels_are_compiled

# No profile has a deadline: the first example of a test pays for imports, and the
# workers of a parallel run share their cores.
settings.register_profile("ci", derandomize=True, deadline=None, print_blob=True)
settings.register_profile("dev", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "dev")

os.environ.setdefault("MPLBACKEND", "Agg")  # inherited by the commands that tests start

#: Modules that are compiled as they are loaded, two halves of the work.
_COMPILED = (
    "import linkwork.kernels.march.rowwise",
    "import linkwork.kernels.march.independent, linkwork.kernels.march.lockstep",
)


def pytest_configure(config: pytest.Config) -> None:
    """Kernels are compiled before workers begin: each of them would compile all, for itself."""
    if config.getoption("numprocesses", None) and not kernels_are_compiled():
        compiling = [subprocess.Popen([sys.executable, "-c", code]) for code in _COMPILED]
        for process in compiling:
            process.wait()
