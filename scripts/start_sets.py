"""Solves the start sets that are shipped, or checks them against newly solved members.

They are those of all mechanisms of the library, of all trusses of up to three loops (the
configurations of Assur groups), and of the dead points of all pin-jointed linkages of up to eight
links with one crank at the ground.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
import time
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT)]  # the trusses are those of the tests

import numpy as np

import linkwork as lw
from linkwork.circuits.homotopy import parameter_roots as start_sets
from linkwork.circuits.homotopy.dead_point_family import DeadPointFamily
from linkwork.circuits.homotopy.isolated_roots import (
    Solved,
    Structure,
    solve_random_member,
)
from linkwork.core.foundation.files import CACHE_VARIABLE
from tests.campaigns.circuits import dead_inputs_of
from tests.oracles.trusses import FIVE_LINKS, SEVEN_LINKS, Edges, edges_of, truss

_DYAD = "Bw"  # a triangle: two links on a frame
_GROUPS = (_DYAD, *FIVE_LINKS, *SEVEN_LINKS)
_MOST_LINKS = 8
_CHECK = 7  # random numbers other than those of the shipped sets


def linkages() -> Iterator[Edges]:
    """The pins of all linkages that grow from links 0, the ground, and 1, the crank, by groups."""
    known: set[str] = set()
    waiting: list[Edges] = [[(0, 1)]]
    while waiting:
        pins = waiting.pop()
        links = 1 + max(map(max, pins))
        for grown in _grown(pins, links):
            name = _form(grown)
            if name not in known:
                known.add(name)
                waiting.append(grown)
                yield grown


def _grown(pins: Edges, links: int) -> Iterator[Edges]:
    """Every group of up to eight links in all, with feet on links of a linkage."""
    for graph in _GROUPS:
        count, edges = edges_of(graph)
        if links + count - 1 > _MOST_LINKS:
            continue
        for frame in range(count):
            others = [k for k in range(count) if k != frame]
            new = {old: links + k for k, old in enumerate(others)}
            inside = [(new[a], new[b]) for a, b in edges if frame not in (a, b)]
            feet = [new[a + b - frame] for a, b in edges if frame in (a, b)]
            for under in product(range(links), repeat=len(feet)):
                if len(set(under)) > 1:
                    yield [*pins, *inside, *zip(under, feet, strict=True)]


def _form(pins: Edges) -> str:
    """A linkage without the order of its links, by refining colours of a graph."""
    links = 1 + max(map(max, pins))
    colours = ["ground", "crank", *["link"] * (links - 2)]
    for _ in range(links):
        seen = [
            repr((colours[k], sorted(colours[a + b - k] for a, b in pins if k in (a, b))))
            for k in range(links)
        ]
        colours = [hashlib.md5(text.encode()).hexdigest() for text in seen]
    return repr(sorted(colours))


def driven(pins: Edges, rng: np.random.Generator) -> lw.Mechanism:
    """A linkage with its pins anywhere, driven at link 1."""
    places = rng.uniform(-1.0, 1.0, (len(pins), 2)).tolist()
    links = 1 + max(map(max, pins))
    return lw.linkage(
        points={f"J{k}": (x, y) for k, (x, y) in enumerate(places)},
        links={
            f"b{link}" if link else "ground": tuple(
                f"J{k}" for k, pair in enumerate(pins) if link in pair
            )
            for link in range(links)
        },
        inputs=lw.Input(link="b1", from_=0, to=360, step=10),
    )


def solve_all() -> None:
    """Ask for everything that needs a start set."""
    rng = np.random.default_rng(1)
    for name in lw.examples():
        mechanism = lw.example(name)
        try:
            mechanism.configurations()
            if mechanism.model.equations.inputs:
                dead_inputs_of(mechanism)
        except lw.LinkworkError as error:
            _say(f"{name}: {error}")
    for graph in _GROUPS:
        count, _ = edges_of(graph)
        for frame in range(count):
            truss(graph, rng, ground=frame).configurations()
    for number, pins in enumerate(linkages(), start=1):
        dead_inputs_of(driven(pins, rng))
        if number % 50 == 0:
            _say(f"{number} linkages, {len(start_sets.own_sets())} sets")


def _say(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def family_of(kept: start_sets.StartSet) -> Structure | DeadPointFamily:
    """The family of a set."""
    own = kept.topology
    if not own.own:
        return Structure(rows=own.rows, columns=own.columns)
    return DeadPointFamily(rows=own.rows, columns=own.columns, own=own.own, slots=own.slots)


def build() -> None:
    """Write the shipped file anew."""
    start_sets.SHIPPED.unlink(missing_ok=True)
    arrays = {}
    with tempfile.TemporaryDirectory() as folder:
        os.environ[CACHE_VARIABLE] = folder
        solve_all()
        for path in start_sets.own_sets():
            with np.load(path) as stored:
                if stored[f"{path.stem}.sure"]:
                    arrays.update({name: stored[name] for name in stored.files})
    np.savez_compressed(start_sets.SHIPPED, **arrays)
    size = start_sets.SHIPPED.stat().st_size
    _say(f"{len(arrays) // 5} sets, {size / 1024:.0f} KiB")


def check() -> int:
    """Solve another random member of every family; how many sets have another number of roots."""
    wrong = 0
    with np.load(start_sets.SHIPPED) as stored:
        names = sorted({name.rpartition(".")[0] for name in stored.files})
        sets = [
            start_sets.StartSet.of_arrays(
                {field: stored[f"{name}.{field}"] for field in start_sets.StartSet.__annotations__}
            )
            for name in names
        ]
    for name, kept in zip(names, sets, strict=True):
        begin = time.perf_counter()
        again: Solved[Any] = solve_random_member(family_of(kept), _CHECK)
        ok = len(again.x) == len(kept.x)
        wrong += not ok
        took = time.perf_counter() - begin
        text = "as shipped" if ok else f"BUT {len(kept.x)} SHIPPED"
        _say(f"{name}: {len(again.x)} solutions, {text} ({took:.1f} s)")
    _say(f"{len(sets)} sets, {wrong} wrong")
    return wrong


if __name__ == "__main__":
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit("scripts/start_sets [--check]")
    if sys.argv[1:]:
        sys.exit(bool(check()))
    build()
