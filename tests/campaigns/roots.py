"""Plain equations with and without roots, constructed so that the root is known beforehand."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

import linkwork as lw

__all__ = ["Equations", "random_equations", "root_campaign"]

_ROUNDINGS = 8.0 * 2.0**-52  # of the references, which are computed in floats


@dataclass(frozen=True)
class Equations:
    """Equations with a guess. ``order`` of their roots: 0 without one, 1 for simple ones.

    ``miss`` of some unknowns: how far they are from the root nearby; 0 where it is not known.
    """

    equations: Mapping[str, str]
    guess: Mapping[str, float]
    order: int
    miss: Callable[[Mapping[str, float]], float] = lambda _: 0.0


def _one(text: str, guess: float, order: int, *roots: float) -> Equations:
    def miss(found: Mapping[str, float]) -> float:
        return min(abs(found["x"] - root) for root in roots)

    return Equations({"F": text}, {"x": guess}, order, miss if roots else lambda _: 0.0)


def _without(rng: np.random.Generator) -> Equations:
    """Small somewhere, zero nowhere."""
    r, x = (float(v) for v in rng.uniform(-3.0, 3.0, 2))
    tiny = 10.0 ** -float(rng.uniform(4.0, 60.0))
    g = f"(x - ({r!r}))"
    texts = [
        "exp(-x) = 0",
        "1/x^2 = 0",
        f"{g}^2 + {tiny!r} = 0",
        f"{g}^{2 * int(rng.integers(2, 6))} = {-tiny!r}",
        f"cos{g} = {1.0 + max(tiny, 2.0**-52)!r}",
        f"sqrt({g}^2 + 1) + {tiny!r} = {1.0 - 2.0**-53!r}",
        f"exp{g} + exp(-{g}) = {2.0 - max(tiny, 2.0**-51)!r}",
        f"abs{g} + {tiny!r} = 0",
        f"hypot({g}, x) + {tiny!r} = 0",
        "exp(x)/(1 + exp(x)) = 0",
        f"max({g}, -{g}) = {-tiny!r}",
        f"1/(1 + {g}^2) = 0",
    ]
    systems = [
        {"1": f"(x - y)^2 + {tiny!r} = 0", "2": f"x + y = {r!r}"},
        {"1": f"x^2 + y^2 = {-tiny!r}", "2": "x = y"},
        {"1": "exp(-y) = 0", "2": f"y = x + {r!r}"},
    ]
    pick = int(rng.integers(len(texts) + len(systems)))
    if pick < len(texts):
        return _one(texts[pick], x or 1.0, 0)
    return Equations(systems[pick - len(texts)], {"x": x, "y": x + 0.5}, 0)


def _multiple(rng: np.random.Generator) -> Equations:
    """One root, of order two to eleven."""
    m, r = int(rng.integers(2, 12)), round(float(rng.uniform(-3.0, 3.0)), 1)
    x = r + float(rng.uniform(0.3, 1.5)) * float(rng.choice([-1.0, 1.0]))
    texts = [(f"(x - ({r!r}))^{m} = 0", m), (f"sin(x - ({r!r}))^2 = 0", 2)]
    texts += [(f"(exp(x - ({r!r})) - 1)^{m} = 0", m), (f"1 = cos(x - ({r!r}))", 2)]
    text, order = texts[int(rng.integers(len(texts)))]
    if "sin" in text or "cos" in text:
        x = r + 0.4 * (x - r)
    return _one(text, x, order, r)


def _simple(rng: np.random.Generator) -> Equations:
    """A root at which the derivative is not zero."""
    r, other = (round(float(v), 3) for v in rng.uniform(-3.0, 3.0, 2))
    a, b = (float(v) for v in rng.uniform(-0.9, 0.9, 2))
    size = 10.0 ** float(rng.uniform(-8.0, 8.0))
    c = float(rng.uniform(0.1, 5.0)) * size
    x = r + float(rng.uniform(-0.4, 0.4))
    kind = int(rng.integers(8))
    if kind == 0:
        return _one(f"(x - ({r!r}))*(x - ({other!r}))*(x^2 + 1) = 0", x, 1, r, other)
    if kind == 1:
        return _one(f"exp(x) = {c!r}", math.log(c) + 0.3, 1, math.log(c))
    if kind == 2:
        return _one(f"x^2 = {c!r}", math.sqrt(c) * 1.3, 1, math.sqrt(c), -math.sqrt(c))
    if kind == 3:
        return _one(f"tan(x) = {r!r}", math.atan(r) + 0.02, 1, math.atan(r))
    if kind == 4:
        return _one(f"(x - {c!r})^2 = {size!r}^2", c + 1.3 * size, 1, c + size, c - size)
    if kind == 5:
        return _one(f"abs(x - ({r!r})) + max(2*x, 3*x) = {c!r}", c, 1)
    if kind == 6:
        system = {"1": f"x + ({a!r})*sin(y) = {r!r}", "2": f"y + ({b!r})*cos(x) = {other!r}"}
        return Equations(system, {"x": r, "y": other}, 1)
    system = {
        "1": f"x + ({a!r})*sin(y) = {r!r}",
        "2": f"y + ({b!r})*atan(z) = {other!r}",
        "3": f"z^3 + z = x + {abs(a)!r}*exp(-x^2)",
    }
    return Equations(system, {"x": r, "y": other, "z": 0.5}, 1)


def random_equations(rng: np.random.Generator) -> Equations:
    """With a simple root, a multiple one, or none."""
    return (_without, _multiple, _simple)[int(rng.integers(3))](rng)


def root_campaign(seed: int, count: int) -> tuple[Counter[str], list[str]]:
    """Solve random plain equations: what was counted, and the claims that are false."""
    rng, counts, false = np.random.default_rng([40, seed]), Counter[str](), []
    for _ in range(count):
        case = random_equations(rng)
        position = lw.plain_equations(
            angle="rad", equations=case.equations, guess=case.guess
        ).solve()
        kind = (
            ("without a root", "with a simple root")[case.order] if case.order < 2 else "multiple"
        )
        counts[f"{kind}: {position.status.label}"] += 1
        found = position.status.ok
        if found and case.order != 1:
            false.append(f"found: {case}")
        certificate = position.certificate
        if found and not certificate.certified:
            false.append(f"found without a proof: {case}")
        elif found:
            scale = max(abs(value) or 1.0 for value in case.guess.values())
            rounding = _ROUNDINGS * max(map(abs, position.unknowns.values()))
            assert certificate.radius is not None
            if case.miss(position.unknowns) > certificate.radius * scale + rounding:
                false.append(f"outside its radius: {case}")
        elif case.order > 1 and position.status is lw.Status.ROOT_NOT_PROVED:
            counts["multiple: accuracy known"] += "of order" in position.message
            if "of order" in position.message:
                about = float(position.message.partition(" ± ")[2].partition(")")[0])
                if case.miss(position.unknowns) > 2.0 * about:
                    false.append(f"further away than said: {case}, {position.message}")
            elif "no root exists" in position.message:
                radius = float(position.message.partition(" ± ")[2].partition(",")[0])
                if case.miss(position.unknowns) < 0.99 * radius:
                    false.append(f"a root where none is said to be: {case}")
    return counts, false
