"""Rebuilds the shipped atlas of paths, or with ``--check`` compares it with the plans.

The plans in ``examples/atlas`` describe millions of designs; the shipped atlas has fewer of each.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "src"))

from linkwork.families.study import (
    read_plan_text,
    run_study,
)
from linkwork.synthesis.atlas import SHIPPED, PathAtlas, atlas_of_stores

_COUNT, _CHECKED = 20_000, 300  # designs of each plan
_WHOLE = "count     = 1_000_000"
_NAMES = ("four-bar", "slider-crank", "stephenson")


def build(count: int) -> PathAtlas:
    """The atlas of the first designs of every plan."""
    plans = ROOT / "examples" / "atlas"
    with tempfile.TemporaryDirectory() as folder:
        stores = []
        for name in _NAMES:
            plan = (plans / f"{name}.toml").read_text(encoding="utf-8")
            study = read_plan_text(plan.replace(_WHOLE, f"count = {count}"), folder=plans)
            stores.append(Path(folder) / f"{name}.zarr")
            run_study(study, stores[-1])
        return atlas_of_stores(stores)


def check() -> None:
    """The first designs of every plan are those of the shipped atlas."""
    few, whole = build(_CHECKED), PathAtlas.shipped()
    for name, one, other in zip(_NAMES, few.families, whole.families, strict=True):
        count = len(one)
        same = np.array_equal(one.numbers, other.numbers[:count])
        near = np.abs(one.shapes.astype(float) - other.shapes[:count]).max() < 1e-2
        if not (same and near and one.mechanism == other.mechanism):
            raise SystemExit(
                f"{name}: the shipped atlas is not that of its plan: run scripts/atlas"
            )
    sys.stdout.write(f"the first {_CHECKED} designs of {len(_NAMES)} plans are those shipped\n")


if __name__ == "__main__":
    if sys.argv[1:] == ["--check"]:
        check()
    else:
        build(_COUNT).save(SHIPPED)
        sys.stdout.write(f"{SHIPPED.relative_to(ROOT)}: {SHIPPED.stat().st_size} bytes\n")
