"""Plans for tests: small ones, and the wrong ones with their whole messages."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from linkwork.families.study import Study, read_plan_text

__all__ = ["PLAN", "contents", "edited", "study"]

#: Some designs have no crank that turns: they stop at dead points.
PLAN = """\
format = 1
name = "A small study"
mechanism = "four-bar"
sampling = "latin-hypercube"
count = 300
seed = 1
chunk = 64
keep = ["B.x", "rocker"]
[dimensions]
"O2 A" = { from = 36, to = 44 }
"A B" = { from = 110, to = 130 }
"O4 B" = { from = 66, to = 90 }
[input]
from = 0
to = 330
step = 30
[reductions]
swing = "stroke(rocker)"
mu_mean = "mean(mu)"
[filters]
cycle = "whole cycle"
transmission = "mu >= 25"
"""


def edited(*edits: tuple[str, str], text: str = PLAN) -> str:
    """A plan with some of its text replaced; an empty replacement takes the line away."""
    for old, new in edits:
        assert text.count(old) == 1, old
        text = text.replace(old, new) if new else text.replace(old + "\n", "")
    return text


def study(*edits: tuple[str, str], folder: Path | str = ".") -> Study:
    """The study of an edited plan."""
    return read_plan_text(edited(*edits), "plan.toml", folder)


def contents(store: Path) -> Mapping[str, bytes]:
    """Every file of a store by its path."""
    return {
        str(path.relative_to(store)): path.read_bytes()
        for path in sorted(store.rglob("*"))
        if path.is_file()
    }
