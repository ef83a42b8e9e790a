"""Cold starts as whole processes: ``import linkwork`` and ``linkwork solve`` against NumPy."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import linkwork as lw
from benchmarks.timing import bar, interleaved

__all__ = ["measure"]


def measure(repeats: int = 15) -> bool:
    """Bars: import at most 0.05 s over NumPy's; a cold solve at most 2.5 × importing NumPy."""
    print("process start (medians of whole processes)")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rapier.toml"
        path.write_text(lw.example_text("rapier-drive"), encoding="utf-8")

        # Compiled modules are cached as for any installed package, wherever this is run.
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
        environment["PYTHONPYCACHEPREFIX"] = folder

        def python(*arguments: str) -> None:
            command = [sys.executable, *arguments]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)

        numpy_, linkwork_, solve = interleaved(
            [
                lambda: python("-c", "import numpy"),
                lambda: python("-c", "import numpy, linkwork"),
                lambda: python("-m", "linkwork", "solve", str(path)),
            ],
            repeats,
        )
    over = [b - a for a, b in zip(numpy_, linkwork_, strict=True)]
    cold = [b / a for a, b in zip(numpy_, solve, strict=True)]
    held = bar("import linkwork over import numpy [s]", over, 0.05)
    return bar("linkwork solve rapier / import numpy", cold, 2.5) and held
