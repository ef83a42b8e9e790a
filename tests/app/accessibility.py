"""What axe-core finds wrong with a page."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

__all__ = ["assert_accessible"]

_AXE = Path(__file__).parents[2] / "frontend/node_modules/axe-core/axe.min.js"
_RUN = """() => axe.run(document, { resultTypes: ["violations"] }).then(({ violations }) =>
  violations.filter(({ impact }) => impact === "serious" || impact === "critical").flatMap(
    ({ id, nodes }) => nodes.map(({ html, any }) => `${id}: ${html} ${any[0]?.message ?? ""}`)))"""


def assert_accessible(page: Any) -> None:
    """Fail on anything serious or critical; skip where axe-core is not installed, never in CI."""
    if not _AXE.exists():
        if os.environ.get("CI") == "true":
            pytest.fail("CI needs axe-core: scripts/frontend check installs it")
        pytest.skip("axe-core is not installed (scripts/frontend check)")
    page.evaluate(_AXE.read_text(encoding="utf-8"))
    found = page.evaluate(_RUN)
    assert not found, "\n".join(found)
