"""Settings of the whole test run: Hypothesis profiles, pictures without a screen, kernels once."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile

import pytest
from hypothesis import settings

from linkwork.families.compiled.code_cache import is_compiled

# No profile has a deadline: the first example of a test pays for imports, and the
# workers of a parallel run share their cores.
settings.register_profile("ci", derandomize=True, deadline=None, print_blob=True)
settings.register_profile("dev", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "dev")

# what earlier runs have left in the user's cache must not decide a test; workers inherit the folder
os.environ.setdefault("LINKWORK_CACHE", tempfile.mkdtemp(prefix="linkwork-tests-"))
os.environ.setdefault("MPLBACKEND", "Agg")  # inherited by the commands that tests start

#: Modules that are compiled as they are loaded: what all loops share, then halves of the work.
_COMPILED = (
    ("linkwork.families.march.step_trial",),
    ("linkwork.families.march.lockstep",),
    ("linkwork.families.march.independent", "linkwork.families.march.march_programs"),
)


def pytest_configure(config: pytest.Config) -> None:
    """Kernels are compiled before workers begin: each of them would compile all, for itself."""
    if config.getoption("numprocesses", None) and not is_compiled("march.lockstep"):
        _compile(_COMPILED[:1])
        _compile(_COMPILED[1:])


def _compile(modules: tuple[tuple[str, ...], ...]) -> None:
    """Load modules, each tuple in a process of its own."""
    loading = [
        subprocess.Popen([sys.executable, "-c", f"import {', '.join(names)}"]) for names in modules
    ]
    for process in loading:
        process.wait()
