"""The whole test suite under every pair of linear algebra kernel and SIMD level of this machine."""

from __future__ import annotations

import os
import re
import subprocess
from collections import Counter
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["processor_campaign"]

ROOT = Path(__file__).resolve().parents[2]
#: Kernels of OpenBLAS, and the level of a processor, as NumPy calls it, that each of them needs.
_KERNELS = {"Prescott": "X86_V2", "Haswell": "X86_V3", "SkylakeX": "X86_V4"}
_EVERY = "extended or not extended"
_FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+)", re.MULTILINE)
_PASSED = re.compile(r"(\d+) passed")


def _environments() -> list[dict[str, str]]:
    """The variables that select each pair: the kernels of this machine, with SIMD and without."""
    config: Any = np.show_config(mode="dicts")
    levels = config["SIMD Extensions"]
    kernels = [k for k, level in _KERNELS.items() if level in levels["baseline"] + levels["found"]]
    simd = " ".join(levels["found"])
    return [
        {"OPENBLAS_CORETYPE": kernel, "NPY_DISABLE_CPU_FEATURES": disabled}
        for kernel, disabled in product(kernels, dict.fromkeys(("", simd)))
    ]


def processor_campaign(count: int) -> tuple[Counter[str], list[str]]:
    """Run all tests under the first ``count`` pairs; every failed test is a false claim."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    for chosen in _environments()[:count]:
        name = " without SIMD" if chosen["NPY_DISABLE_CPU_FEATURES"] else ""
        name = f"{chosen['OPENBLAS_CORETYPE']}{name}"
        done = subprocess.run(
            [str(ROOT / "scripts" / "test"), "-m", _EVERY],
            env={**os.environ, **chosen},
            capture_output=True,
            text=True,
            check=False,
        )
        passed = _PASSED.search(done.stdout)
        counts[f"{name}: tests passed"] = int(passed[1]) if passed else 0
        false += [f"{name}: {test}" for test in _FAILED.findall(done.stdout)]
        if done.returncode and not _FAILED.search(done.stdout):
            false.append(f"{name}: {done.stdout[-2000:]}{done.stderr[-2000:]}")
    return counts, false
