"""Verdicts on four-bars and slider-cranks, also inverted, compared with circuits."""

from __future__ import annotations

from collections import Counter

import numpy as np

from linkwork import Mechanism
from linkwork.core.foundation.arrays import Array
from linkwork.synthesis.defects.verdicts import DefectKind, judge
from linkwork.synthesis.loops.limits import Candidates, Drive, LoopKind
from linkwork.synthesis.poses.guiding_linkage import Design, linkage_of
from linkwork.synthesis.tasks.conditions import PrecisionPosition, Wishes
from linkwork.synthesis.tasks.task import Task
from tests.campaigns.library_defects import branches_at

__all__ = ["defect_campaign", "random_designs", "verdict_by_circuits"]

_POSITIONS = 4


def random_designs(kind: LoopKind, count: int, seed: int) -> Candidates:
    """Loops at random inputs and on random sides, so that all defects and none occur."""
    rng = np.random.default_rng([22, seed])
    draw = _random_design if kind.has_crank else _random_guides
    found = [draw(kind, rng) for _ in range(count)]
    return Candidates.joined(found)


def _random_design(kind: LoopKind, rng: np.random.Generator) -> Candidates:
    while True:
        a, c, b, g = rng.uniform(0.2, 2.0, 4)
        start, step = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.05, 0.9)
        crank = a * np.exp(1j * (start + step * np.arange(_POSITIONS)))
        if rng.random() < 0.2:
            crank = rng.permutation(crank)
        side = np.where(rng.random(_POSITIONS) < 0.15, -1.0, 1.0)
        if kind is LoopKind.FOUR_BAR:
            base = g - crank
            along = 0.5 * (np.abs(base) ** 2 + c**2 - b**2)
            across = np.abs(base) ** 2 * c**2 - along**2
            if (across <= 1e-6).any():
                continue
            coupler = base * (along + 1j * side * np.sqrt(across)) / np.abs(base) ** 2
        elif kind is LoopKind.INVERTED:
            base, offset = g - crank, rng.uniform(-0.7, 0.7) * rng.integers(0, 2)
            across = np.abs(base) ** 2 - offset**2
            if (across <= 1e-6).any():
                continue
            arm = complex(c, offset)
            coupler = base / (side * np.sqrt(across) + 1j * offset) * arm
            direction = abs(arm) / arm
        else:
            across = c**2 - (g - 1.0 - crank.imag) ** 2
            if (across <= 1e-6).any():
                continue
            coupler = side * np.sqrt(across) + 1j * (g - 1.0 - crank.imag)
        sliding = kind is LoopKind.SLIDER_CRANK
        direction = direction if kind is LoopKind.INVERTED else complex(sliding)
        return Candidates(
            kind=kind,
            fixed_a=np.array([0j]),
            fixed_b=np.array([1j * (g - 1.0) if sliding else g + 0j]),
            direction=np.array([direction]),
            moving_a=crank[None],
            moving_b=(crank + coupler)[None],
            guided=(crank + 0.7 * coupler * np.exp(0.4j))[None],
            error=np.array([1e-14]),
            miss=np.zeros(1),
        )


def _random_guides(kind: LoopKind, rng: np.random.Generator) -> Candidates:
    """A on the real line, or of an Oldham coupling on a line of the body through 0."""
    while True:
        c, h = rng.uniform(0.2, 2.0), rng.uniform(-0.7, 0.7) * rng.integers(0, 2)
        places = rng.uniform(-1.5, 1.0) + rng.uniform(0.05, 0.9) * np.arange(_POSITIONS)
        if rng.random() < 0.2:
            places = rng.permutation(places)
        side = np.where(rng.random(_POSITIONS) < 0.15, -1.0, 1.0)
        fixed_b = complex(*rng.uniform(-1.0, 1.0, 2))
        angle = rng.uniform(0.3, 2.8)
        line = np.exp(1j * angle)
        direction_a = 1.0 + 0j
        if kind is LoopKind.DOUBLE_SLIDER:
            a = places.astype(complex)
            across = ((a - fixed_b) * line.conjugate()).imag
            if (c**2 - across**2 <= 1e-6).any():
                continue
            b = a + (side * np.sqrt(c**2 - across**2) - 1j * across) * line
            direction = line
        elif kind is LoopKind.RAPSON:
            a, arm = places.astype(complex), complex(c, h)
            square = np.abs(fixed_b - a) ** 2 - h**2
            if (square <= 1e-6).any():
                continue
            b = a + (fixed_b - a) / (side * np.sqrt(square) + 1j * h) * arm
            direction = abs(arm) / arm
        else:
            one = np.exp(1j * places)
            other = one * line
            centre = one * (fixed_b * other.conj()).imag / (one * other.conj()).imag
            a, b = centre + c * one, centre + 0.8 * other
            seen = np.abs(b - a) / (b - a)
            direction_a, direction = complex((one * seen)[0]), complex((other * seen)[0])
        return Candidates(
            kind=kind,
            fixed_a=np.array([0j]),
            fixed_b=np.array([fixed_b]),
            direction=np.array([direction]),
            moving_a=a[None],
            moving_b=b[None],
            guided=(a + 0.7 * (b - a) * np.exp(0.4j))[None],
            error=np.array([1e-14]),
            miss=np.zeros(1),
            direction_a=np.array([direction_a]),
        )


def verdict_by_circuits(
    given: Candidates, drive: Drive, k: int, inputs: Array
) -> DefectKind | None:
    """The first of circuit and branch defects, by the circuits of the mechanism."""
    design = Design.of(given, k, drive, inputs, inputs[[0, -1]])
    position = PrecisionPosition(point=(0.0, 0.0))
    task = Task(kind="path", positions=(position, PrecisionPosition(point=(1.0, 0.0))))
    mechanism = Mechanism(linkage_of(design, task, "random design"))
    circuits = mechanism.circuits(certify=False)
    scale = np.pi / 180.0 if drive.turns else 1.0
    places = [
        {"A": given.moving_a[k, j], "B": given.moving_b[k, j]} for j in range(len(design.inputs))
    ]
    branches = [
        min(branches_at(circuits, value / scale, here, 0.0), default="")
        for value, here in zip(design.inputs, places, strict=True)
    ]
    if len({name.split(" branch")[0] for name in branches}) > 1:
        return DefectKind.CIRCUIT
    return DefectKind.BRANCH if len(set(branches)) > 1 else None


def defect_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """Counts and false claims of so many designs, each with one driven link."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    for kind in LoopKind:
        given = random_designs(kind, count // len(LoopKind), part)
        for which, drive in enumerate(given.drives):
            verdicts = judge(given, drive, Wishes())
            for k in range(which, len(given), 2):
                mine = next(
                    (d for d in (DefectKind.CIRCUIT, DefectKind.BRANCH) if verdicts.defects[d][k]),
                    None,
                )
                if verdicts.defects[DefectKind.NOT_PROVED][k]:
                    counts[f"{kind.value}, {drive.value}: not proved"] += 1
                    continue
                theirs = verdict_by_circuits(given, drive, k, verdicts.loops.input[k])
                told = "neither" if mine is None else mine.value
                counts[f"{kind.value}, {drive.value}: {told}"] += 1
                if mine is not theirs:
                    false.append(f"part {part}, {kind.value}, {drive.value}, {k}: {mine}, {theirs}")
    return counts, false
