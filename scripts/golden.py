"""Rewrites the golden drawings in the form compared by the tests."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # for the form defined in the tests

from tests.core.drawing.golden_form import FOLDER, GOLDEN, drawn


def main() -> None:
    """Write one file for each mechanism, and no others."""
    FOLDER.mkdir(exist_ok=True)
    for old in FOLDER.glob("*.svg"):
        old.unlink()
    for name in GOLDEN:
        (FOLDER / f"{name}.svg").write_text(drawn(name), encoding="utf-8")
    sys.stdout.write(f"Wrote {len(GOLDEN)} drawings to {FOLDER.relative_to(ROOT)}.\n")


if __name__ == "__main__":
    main()
