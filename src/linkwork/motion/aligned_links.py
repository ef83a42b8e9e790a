"""The links that are in line at a singular position."""

from __future__ import annotations

import math
from itertools import combinations

from linkwork.foundation.arrays import Array
from linkwork.mechanism.linkage import Linkage
from linkwork.motion.model import Model
from linkwork.numerics.block_solver import Block

__all__ = ["links_in_line"]

_IN_LINE = 1e-6  # rad: links are in line at a dead point to the square root of rounding or better


def links_in_line(model: Model, number: int, v: Array) -> tuple[str, ...]:
    """The links of a block that have all their joints of one loop on one line, at v (N,).

    Two unknown vectors of a loop are in line if they are parallel and follow each other: as the
    only two of the loop, or as links with a common pin. Links that are merely parallel are not.
    """
    block = model.compiled.solver.blocks[number]
    names: set[str] = set()
    for vectors in _vectors(model, block, v):
        for (a, one), (b, other) in combinations(vectors.items(), 2):
            if not (len(vectors) == 2 or _pinned(model, a, b)):
                continue
            product = one.conjugate() * other
            if product and abs(math.remainder(math.atan2(product.imag, product.real), math.pi)) < (
                _IN_LINE
            ):
                names |= {a, b}
    return tuple(sorted(names))


def _vectors(model: Model, block: Block, v: Array) -> list[dict[str, complex]]:
    """Per loop of a block, the vectors that turn with one unknown angle of the block each.

    A loop with a vector that turns with several of them is left out.
    """
    equations = model.equations
    value = {variable.symbol: float(x) for variable, x in zip(equations.variables, v, strict=True)}
    mine = {equations.unknowns[int(k)].symbol: equations.unknowns[int(k)] for k in block.unknowns}
    found = []
    for number in block.equations:
        if number >= len(equations.loops):
            continue
        vectors: dict[str, complex] = {}
        for term in equations.loops[number].terms:
            unknown = [name for name, _ in term.phase if name in mine]
            if not unknown:
                continue
            if len(term.phase) > 1:
                vectors = {}
                break
            turn = sum(weight * value[name] for name, weight in term.phase)
            length = 1.0 if term.length is None else value[term.length]
            vector = term.value * length * complex(math.cos(turn), math.sin(turn))
            name = mine[unknown[0]].name
            vectors[name] = vectors.get(name, 0j) + vector
        found.append(vectors)
    return found


def _pinned(model: Model, a: str, b: str) -> bool:
    description = model.description
    if not isinstance(description, Linkage) or not {a, b} <= description.links.keys():
        return False
    return not set(description.links[a]).isdisjoint(description.links[b])
