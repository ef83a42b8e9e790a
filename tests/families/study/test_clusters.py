"""Studies on a Dask cluster of two worker processes, one of which is killed on the way."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from linkwork.core.foundation.errors import InputError, MissingPackageError
from linkwork.families.study import chunks_with_record, run_study
from tests.families.study.plans import contents, edited, study

pytestmark = pytest.mark.extended

SOURCE = Path(__file__).parents[3] / "src"
LONG = (("count = 300", "count = 800"), ("chunk = 64", "chunk = 40"))


def _start(folder: Path, *words: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, *words],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(SOURCE)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def _until(there: Callable[[], bool], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not there():
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """The address of a scheduler, and its two workers."""
    file = tmp_path / "scheduler.json"
    here = ["--host", "127.0.0.1", "--no-dashboard"]
    dask = ["-m", "dask"]
    started = [
        _start(tmp_path, *dask, "scheduler", "--port", "0", "--scheduler-file", str(file), *here)
    ]
    try:
        _until(file.exists)
        one = ["--nthreads", "1", "--no-nanny"]
        for _ in range(2):
            words = [*dask, "worker", "--scheduler-file", str(file), *one, *here]
            started.append(_start(tmp_path, *words))
        yield json.loads(file.read_text(encoding="utf-8"))["address"], started[1:]
    finally:
        for process in started:
            process.kill()
            process.wait()


def test_a_worker_that_is_killed_changes_nothing(
    cluster: tuple[str, list[subprocess.Popen[bytes]]], tmp_path: Path
) -> None:
    address, workers = cluster
    (tmp_path / "plan.toml").write_text(edited(*LONG), encoding="utf-8")
    store = tmp_path / "out.zarr"
    words = ["-m", "linkwork", "study", "plan.toml", "-o", "out.zarr", "--scheduler", address]
    run = _start(tmp_path, *words)
    try:
        _until(lambda: len(chunks_with_record(store)) >= 4)
        workers[0].send_signal(signal.SIGKILL)
        stored = len(chunks_with_record(store))
        assert stored < 20
        assert run.wait(60) == 0
    finally:
        run.kill()
        run.wait()
    run_study(study(*LONG), tmp_path / "whole.zarr", workers=1)
    assert contents(store) == contents(tmp_path / "whole.zarr")


def test_without_dask_the_command_is_said_that_installs_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(MissingPackageError) as caught:
        run_study(study(), tmp_path / "out.zarr", scheduler="tcp://nowhere:1")
    assert str(caught.value) == (
        'studies on a cluster need dask.distributed: pip install "linkwork[cluster]"'
    )


def test_without_zarr_the_command_is_said_that_installs_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "zarr", None)
    with pytest.raises(MissingPackageError) as caught:
        run_study(study(), tmp_path / "out.zarr")
    assert str(caught.value) == (
        'studies are stored by zarr and xarray: pip install "linkwork[study]"'
    )


@pytest.mark.filterwarnings("ignore")  # whatever Dask leaves behind when nobody answers
def test_a_scheduler_that_does_not_answer_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("linkwork.families.study.running._CLUSTER_PATIENCE", 0.2)
    with pytest.raises(InputError) as caught:
        run_study(study(), tmp_path / "out.zarr", scheduler="tcp://127.0.0.1:9")
    assert str(caught.value).startswith("no Dask scheduler answers at tcp://127.0.0.1:9 (")
    assert str(caught.value).endswith("): start one with\n    dask scheduler")


def test_dask_is_loaded_only_for_a_cluster(tmp_path: Path) -> None:
    (tmp_path / "plan.toml").write_text(edited(("count = 300", "count = 64")), encoding="utf-8")
    program = (
        "import sys\n"
        "from linkwork.core.commands.main import linkwork\n"
        "linkwork(['study', 'plan.toml', '-o', 'out.zarr'], standalone_mode=False)\n"
        "print('distributed' in sys.modules, file=sys.stderr)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(SOURCE)},
        capture_output=True,
        check=True,
    )
    assert done.stderr == b"False\n"
