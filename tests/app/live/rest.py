"""Waiting until a page is at rest."""

from __future__ import annotations

from typing import Any

_AT_REST = """() => new Promise((resolve) => {
  let [last, frames] = ["", 0];
  const look = () => {
    const { a, d, e, f } = document.querySelector(".lw-drawing").getScreenCTM();
    const { updates } = document.getElementById("linkwork").dataset;
    const { open } = document.querySelector(".lw-busy").dataset;
    const now = [a, d, e, f, updates].join();
    [last, frames] = [now, now === last && !Number(open) ? frames + 1 : 0];
    if (frames < 12) requestAnimationFrame(look);
    else resolve();
  };
  look();
})"""


def at_rest(page: Any) -> None:
    """Wait until every request is answered and the drawing has kept its place for a while."""
    page.evaluate(_AT_REST)
