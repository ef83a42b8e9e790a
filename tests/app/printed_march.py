"""The march of a printed solver in plain Python, as an oracle of the page's."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from linkwork.app.pages.page_data import SolverData
from linkwork.core.foundation.arrays import Array
from linkwork.core.numerics import marching as prediction, marching as step_size
from linkwork.core.record.recorder import ROLES
from linkwork.families.march.march_programs import NODES, START_STEPS, STEPS
from linkwork.families.printed_solver import PrintedSolver

_HEAD = """\
import math

from linkwork.families.compiled import interpreter as sine

sin_cos = sine.sin_cos.py_func

"""


def imported(printed: PrintedSolver, folder: Path) -> Any:
    """The printed functions as a module."""
    file = folder / "printed.py"
    file.write_text(_HEAD + printed.source.replace("\ndef ", "\n\ndef "), "utf-8")
    spec = importlib.util.spec_from_file_location("printed", file)
    assert spec is not None
    assert spec.loader is not None
    module: ModuleType = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class PlainMarch:
    """Follows one mechanism as ``kernels.gpu.march`` does, number by number."""

    def __init__(self, functions: Any, printed: PrintedSolver, data: SolverData) -> None:
        self.f, self.p, self.steps = functions, printed, data.steps
        self.w = [0.0] * printed.state
        self.weights = ROLES * printed.size
        self.good = self.weights + 2 * NODES
        self.live = self.good + 2

    def solve(self, numbers: list[float], rows: Array) -> Array:
        """Unknowns (R, n) and radii, NaN where a row is not reached."""
        d = [0.0] * self.p.design
        with np.errstate(all="ignore"):
            self.f.design(numbers, d)
        found = np.full((len(rows), self.p.unknowns + 1), np.nan)
        node = self.begin(d)
        if node is not None:
            for way in (0, 1):
                self.follow(d, node, rows, way, found)
        return found

    def load(self, d: list[float], node: list[float]) -> None:
        first, start = self.live + self.p.blocks, self.p.unknowns + 2
        own = [*d[start : start + self.p.coefficients], *self.p.options]
        self.w[first : first + len(own)] = own
        self.w[: ROLES * self.p.size] = node * ROLES

    def begin(self, d: list[float]) -> list[float] | None:
        w, n, size = self.w, self.p.unknowns, self.p.size
        self.load(d, [*d[1 : n + 1], *[0.0] * (size - n - 1), d[n + 1]])
        w[self.weights : self.good] = [1.0, *[0.0] * (2 * NODES - 1)]
        w[self.good] = 1.0
        self.predict()
        for block in range(self.p.blocks):
            w[self.live + block] = 1.0
            self.while_live("damped", block, START_STEPS)
        for _ in range(2):
            w[size : 2 * size] = w[:size]
            self.judge()
        return w[:size] if w[self.good] > 0.5 else None

    def predict(self) -> None:
        self.f.reach(self.w)
        self.f.given(self.w)

    def while_live(self, kind: str, block: int, most: int) -> None:
        for _ in range(most):
            if self.w[self.live + block] == 0.0:
                break
            getattr(self.f, f"{kind}{block}")(self.w)

    def judge(self) -> None:
        for block in range(self.p.blocks):
            getattr(self.f, f"prove{block}")(self.w)
        self.f.agree(self.w)

    def follow(
        self, d: list[float], node: list[float], rows: Array, way: int, found: Array
    ) -> None:
        w, size = self.w, self.p.size
        self.load(d, node)
        spacing = np.full(NODES, math.inf)
        row = int(np.searchsorted(rows, w[size - 1])) - (way == 0)
        known, h = 1, self.steps[0]
        while 0 <= row < len(rows):
            goal, before = float(rows[row]), w[2 * size - 1]
            step, t = step_size.stride(goal, before, h), step_size.aim(goal, before, h)
            times = np.array([w[(k + 2) * size - 1] for k in range(NODES)])
            if not prediction.is_same_spacing(step, times, spacing):
                prediction.keep_spacing(step, times, spacing)
                self.weigh(float(times[0]) + step, times, known)
            w[size - 1] = t
            self.predict()
            for block in range(self.p.blocks):
                getattr(self.f, f"begin{block}")(w)
                self.while_live("iterate", block, STEPS - 1)
            self.judge()
            moved = abs(t - before)
            if w[self.good] > 0.5 and not step_size.is_lost(t, before, goal):
                if t == goal:
                    found[row] = [*w[: self.p.unknowns], w[self.good + 1]]
                    row += 2 * way - 1
                h = step_size.grow(h, moved, self.steps[1])
                known = min(known + 1, NODES) if moved else 1
                if moved:
                    w[size : ROLES * size] = w[: NODES * size]
            else:
                h = step_size.HALF * moved
                if h < self.steps[2]:
                    return

    def weigh(self, t: float, times: Array, known: int) -> None:
        used = prediction.trusted_nodes(t, times, known)
        for i in range(NODES):
            pair = prediction.hermite_weights(t, times, i, used) if i < used else (0.0, 0.0)
            self.w[self.weights + 2 * i : self.weights + 2 * i + 2] = map(float, pair)
