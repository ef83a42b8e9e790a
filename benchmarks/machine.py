"""A short description of the measuring machine."""

from __future__ import annotations

import os
import platform
import re
from importlib.metadata import version
from pathlib import Path

__all__ = ["machine"]


def machine() -> str:
    """``one core of an AMD EPYC, AVX-512; Python 3.11, NumPy 2.4``."""
    with_numpy = f"Python {_short(platform.python_version())}, NumPy {_short(version('numpy'))}"
    return f"{_core()}; {with_numpy}"


def _short(number: str) -> str:
    return ".".join(number.split(".")[:2])


def _core() -> str:
    try:
        described = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return f"one core of {os.cpu_count()}, {platform.machine()}"
    found = re.search(r"model name\s*:\s*(.+)", described)
    model = re.sub(r"\((R|TM)\)| CPU| Processor| @.*", "", found[1]).strip() if found else ""
    if not model:
        return f"one core, {platform.machine()}"
    article = "an" if model[0] in "AEIOU" else "a"
    wide = next((text for flag, text in _VECTORS if flag in described), "")
    return f"one core of {article} {model}{wide}"


_VECTORS = (("avx512f", ", AVX-512"), ("avx2", ", AVX2"), ("asimd", ", NEON"))
