"""A large study, its memory, and what becomes of it when it is killed and bytes flip."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np

from linkwork.families.study import chunks_with_record, verify_store
from tests.families.study.plans import contents

__all__ = ["study_campaign"]

_ROOT = Path(__file__).resolve().parents[2]
_KILLS = 20
_FLIPS = 100  # bytes
_MOST_MEMORY = 1 << 30  # bytes of the process and its workers together
_SEED = 31
_CHUNKS = 100  # or more: twenty kills leave something to do
_LARGEST_CHUNK = 8192

_PLAN = """\
format = 1
name = "Four-bars by the million"
mechanism = "four-bar"
sampling = "latin-hypercube"
count = {count}
chunk = {chunk}
seed = 1
[dimensions]
"O2 A" = {{ from = 36, to = 44 }}
"A B" = {{ from = 110, to = 130 }}
"O4 B" = {{ from = 66, to = 90 }}
[input]
from = 0
to = 356.4
step = 3.6
[reductions]
swing = "stroke(rocker)"
mu_min = "min(mu)"
mu_max = "max(mu)"
mean_height = "mean(B.y)"
[filters]
cycle = "whole cycle"
transmission = "mu >= 25"
"""


def study_campaign(count: int) -> tuple[Counter[str], list[str]]:
    """Counts and false claims of a study of so many four-bars at 100 inputs."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        plan = _PLAN.format(count=count, chunk=max(min(count // _CHUNKS, _LARGEST_CHUNK), 1))
        (folder / "plan.toml").write_text(plan, encoding="utf-8")
        begun, seconds = _uninterrupted(folder, counts, false)
        _killed(folder, begun, seconds, counts, false)
        if contents(folder / "whole.zarr") != contents(folder / "killed.zarr"):
            false.append("the study that was killed is not the one that was not")
        _flipped(folder, counts, false)
    counts["designs"] = count
    return counts, false


def _started(folder: Path, store: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", "linkwork", "study", "plan.toml", "-o", store, "--quiet"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(_ROOT / "src")},
        stdout=subprocess.DEVNULL,
    )


def _uninterrupted(folder: Path, counts: Counter[str], false: list[str]) -> tuple[float, float]:
    """Run the study once; seconds until its first chunk, and from there to its end."""
    start = time.monotonic()
    first, peak = None, 0
    process = _started(folder, "whole.zarr")
    while process.poll() is None:
        peak = max(peak, _memory(process.pid))
        if first is None and _chunks(folder / "whole.zarr"):
            first = time.monotonic()
        time.sleep(0.05)
    end = time.monotonic()
    if process.returncode:
        false.append(f"the study ended with {process.returncode}")
    counts["seconds without interruption"] = round(end - start)
    counts["chunks"] = _chunks(folder / "whole.zarr")
    counts["MiB of memory at most, all processes together"] = peak >> 20
    if peak > _MOST_MEMORY:
        false.append(f"{peak >> 20} MiB of memory are more than {_MOST_MEMORY >> 20}")
    return (first or end) - start, end - (first or end)


def _killed(
    folder: Path, begun: float, seconds: float, counts: Counter[str], false: list[str]
) -> None:
    """Run it again and kill it at random moments of its work, then let it end."""
    rng = np.random.default_rng(_SEED)
    store = folder / "killed.zarr"
    for k in range(_KILLS):
        before = _chunks(store)
        process = _started(folder, store.name)
        if k % 5 == 4:  # before it has stored anything of its own
            time.sleep(begun * rng.uniform(0.0, 0.9))
        else:
            while process.poll() is None and _chunks(store) == before:
                time.sleep(0.002)
            time.sleep(rng.uniform(0.0, 0.7 * seconds / _KILLS))
        if process.poll() is None:
            counts["killed"] += 1
        process.kill()
        process.wait()
        counts["killed in the middle of chunks"] += any(store.rglob("*.partial"))
        counts["killed after further chunks"] += _chunks(store) > before
    counts["chunks before the last run"] = _chunks(store)
    if _started(folder, store.name).wait():
        false.append("the study that was killed does not go on")


def _flipped(folder: Path, counts: Counter[str], false: list[str]) -> None:
    """Change random bytes of the whole study and let the command repair it."""
    rng = np.random.default_rng(_SEED)
    store, wanted = folder / "whole.zarr", contents(folder / "whole.zarr")
    files = sorted(path for path, data in wanted.items() if data)
    changed = set()
    for _ in range(_FLIPS):
        path = files[int(rng.integers(len(files)))]
        data = bytearray((store / path).read_bytes())
        data[int(rng.integers(len(data)))] ^= int(rng.integers(1, 256))
        (store / path).write_bytes(data)
        changed.add(path)
    found = verify_store(store)
    named = {name for names in found.chunks.values() for name in names}
    silent = {path for path in changed - named if "/c/" in path}  # others are metadata
    counts["files with flipped bytes"] = len(changed)
    counts["damaged chunks"] = len(found.chunks)
    if silent or not named <= changed:
        false.append(f"flipped bytes were not found in {sorted(silent)}, or found elsewhere")
    if _started(folder, store.name).wait() or contents(store) != wanted:
        false.append("the study with flipped bytes was not repaired")


def _chunks(store: Path) -> int:
    return len(chunks_with_record(store))


def _memory(pid: int) -> int:
    """Bytes of a process and its children; what they share is counted once."""
    total = 0
    try:
        rollup = Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="ascii")
        total += 1024 * int(rollup.split("\nPss:")[1].split()[0])
        for task in Path(f"/proc/{pid}/task").iterdir():
            children = (task / "children").read_text(encoding="ascii").split()
            total += sum(_memory(int(child)) for child in children)
    except (OSError, IndexError):  # ended meanwhile
        return total
    return total
