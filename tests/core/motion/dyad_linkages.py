"""Random linkages: a crank, and dyads of pins and slides one after the other."""

from __future__ import annotations

import cmath
import random

import linkwork as lw

__all__ = ["dyad_linkage"]


def dyad_linkage(seed: int) -> lw.Mechanism:
    """One to three dyads RRR, RRP or RPR on links that are there, at exact places."""
    rng = random.Random(seed)
    made = _Made(rng)
    for _ in range(rng.randint(1, 3)):
        rng.choice((made.pins, made.slider, made.slot))()
    return lw.linkage(
        points={name: (z.real, z.imag) for name, z in made.points.items()},
        links=made.links,
        sliders=made.sliders,
        slots=made.slots,
        inputs=lw.Input(link="crank", from_=0, to=10, step=1),
    )


class _Made:
    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.points = {"O": 0j, "A": 1 + 0.1j}
        self.links = {"ground": ["O"], "crank": ["O", "A"]}
        self.sliders: list[lw.Slider] = []
        self.slots: list[lw.Slot] = []

    def _new(self) -> str:
        name = f"p{len(self.points)}"
        self.points[name] = complex(self.rng.uniform(-5, 5), self.rng.uniform(-5, 5))
        return name

    def _link(self, *points: str) -> str:
        name = f"l{len(self.links)}"
        self.links[name] = [*points]
        if self.rng.random() < 0.5:
            self.links[name].append(self._new())
        return name

    def _moving(self) -> str:
        """A point of a link that moves."""
        still = self.links["ground"]
        return self.rng.choice(
            [p for name, points in self.links.items() if name != "ground" and len(points) > 1
             for p in points if p not in still]
        )  # fmt: skip

    def _pivot(self) -> str:
        self.links["ground"].append(self._new())
        return self.links["ground"][-1]

    def pins(self) -> None:
        """RRR from a moving point to ground or to a point of another link."""
        start = self._moving()
        end = self._moving() if self.rng.random() < 0.4 else self._pivot()
        if start == end or any({start, end} <= {*points} for points in self.links.values()):
            end = self._pivot()
        inner = self._new()
        self._link(start, inner)
        self._link(end, inner)

    def slider(self) -> None:
        """RRP from a moving point to a block on ground."""
        start, line, block = self._moving(), (self._pivot(), self._pivot()), self._new()
        a, b = (self.points[p] for p in line)
        place = a + self.rng.uniform(-2, 2) * (b - a)
        aside = 0.5 * 1j * (b - a) / abs(b - a)
        self.points[block] = place + aside
        self._link(start, block)
        name = f"block{len(self.links)}"
        self.links[name] = [block]
        self.sliders.append(
            lw.Slider(name=f"s{len(self.sliders)}", link=name, points=(block,), on="ground",
                      line=line, offset=0.5)
        )  # fmt: skip

    def slot(self) -> None:
        """RPR: a moving point runs along a link that turns about a new pivot."""
        moving, pivot, foot, end = self._moving(), self._pivot(), self._new(), self._new()
        way = cmath.rect(1, self.rng.uniform(0, 6))
        for name, far in ((foot, 1.0), (end, 3.0)):
            self.points[name] = self.points[moving] - far * way
        lever = f"l{len(self.links)}"
        self.links[lever] = [pivot, foot, end]
        self.slots.append(
            lw.Slot(name=f"t{len(self.slots)}", point=moving, on=lever, line=(foot, end))
        )
