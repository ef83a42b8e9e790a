"""Settings of the whole test run: Hypothesis profiles, pictures without a screen, kernels once."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
from hypothesis import settings

from linkwork.kernels.program.kernel_cache import kernels_are_compiled

# No profile has a deadline: the first example of a test pays for imports, and the
# workers of a parallel run share their cores.
settings.register_profile("ci", derandomize=True, deadline=None, print_blob=True)
settings.register_profile("dev", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "dev")

os.environ.setdefault("MPLBACKEND", "Agg")  # inherited by the commands that tests start

_TREE = Path(__file__).parents[1]
#: Tests that run compiled kernels. They come last: on a new machine the kernels take two minutes
#: to compile, and every worker that wants them at once would compile all of them.
_BY_KERNELS = (
    "tests/batch",
    "tests/cli/test_study.py",
    "tests/kernels",
    "tests/motion/test_long_tables.py",
    "tests/surface/test_wrong_arguments.py",
)
#: Names a file that is there while the run's first process has the kernels compiled.
_COMPILING = "LINKWORK_TESTS_COMPILING"
_LONGEST = 600  # s: then a worker compiles for itself


def _is_by_kernels(item: pytest.Item) -> bool:
    return item.path.relative_to(_TREE).as_posix().startswith(_BY_KERNELS)


def pytest_configure(config: pytest.Config) -> None:
    """The first process of a parallel run has the kernels compiled while other tests run."""
    if not config.getoption("numprocesses", None) or kernels_are_compiled():
        return
    handle, mark = tempfile.mkstemp(prefix="linkwork-compiling-")
    os.close(handle)
    os.environ[_COMPILING] = mark
    compiling = subprocess.Popen([sys.executable, "-m", "tests.compile_kernels", mark], cwd=_TREE)

    def end() -> None:
        compiling.terminate()
        compiling.wait()
        Path(mark).unlink(missing_ok=True)

    config.add_cleanup(end)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests of compiled kernels last."""
    items.sort(key=_is_by_kernels)


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Tests of compiled kernels wait until they are compiled."""
    mark = os.environ.get(_COMPILING)
    if mark is not None and _is_by_kernels(item):
        for _ in range(_LONGEST):
            if not Path(mark).exists():
                break
            time.sleep(1.0)
