"""Random trusses of the literature: every configuration found, every real one proved."""

from __future__ import annotations

from collections import Counter

import numpy as np

import linkwork as lw
from linkwork import Completeness
from tests.oracles.trusses import FIVE_LINKS, NINE_LINKS, SEVEN_LINKS, truss

__all__ = ["configuration_campaign", "judge_list", "judge_truss"]

#: Trusses of four loops looked at, from the fewest to the most configurations.
FOUR_LOOPS = tuple(NINE_LINKS)[::3]


def judge_truss(mechanism: lw.Mechanism, count: int) -> list[str]:
    """What is wrong with the list of a truss that has ``count`` complex configurations."""
    return judge_list(mechanism, mechanism.configurations(), count)


def judge_list(mechanism: lw.Mechanism, found: lw.circuits.Configurations, count: int) -> list[str]:
    """What is wrong with this list."""
    (paths,) = found.paths
    wrong = []
    if (paths.finite, paths.expected, paths.bound) != (count, count, count):
        wrong.append(
            f"{paths.finite} solutions, {paths.expected} expected, "
            f"{paths.bound} at most, not {count}"
        )
    if paths.failed or paths.multiple or paths.at_infinity:
        wrong.append(f"paths lost: {paths}")
    if not all(position.certificate.certified for position in found):
        wrong.append("a real configuration is not proved")
    if not found.completeness.complete:
        wrong.append(found.message)
    if paths.finite == paths.bound and found.completeness is not Completeness.PROVED:
        wrong.append("complete, but not proved")
    if len(found) != paths.real or (paths.finite - len(found)) % 2:
        wrong.append(f"{len(found)} real configurations of {paths.real}: complex ones are pairs")
    sketch = mechanism.solve()
    if not any(np.abs(np.exp(1j * p.q) - np.exp(1j * sketch.q)).max() < 1e-6 for p in found):
        wrong.append("the sketch is not in the list")
    return [f"{mechanism.name}: {what}" for what in wrong]


def configuration_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """``count`` random trusses: eight of up to three loops, one of four, and so on."""
    rng = np.random.default_rng([11, part])
    few = {**FIVE_LINKS, **SEVEN_LINKS}
    tally: Counter[str] = Counter()
    false: list[str] = []
    for number in range(part * count, (part + 1) * count):
        nine = number // 9
        graphs, k = (FOUR_LOOPS, nine) if number % 9 == 8 else (tuple(few), number - nine)
        graph = graphs[k % len(graphs)]
        known = few.get(graph, NINE_LINKS.get(graph, 0))
        mechanism = truss(graph, rng, size=10.0 ** rng.uniform(-2, 3))
        found = mechanism.configurations()
        false += judge_list(mechanism, found, known)
        tally[f"trusses with {known:2} configurations"] += 1
        tally["configurations"] += known
        tally["lists proved complete"] += found.completeness is Completeness.PROVED
    return tally, false
