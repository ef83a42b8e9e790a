"""From a recording to a program: an order, registers, products and sums in one instruction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.kernels.program.program import Op, Program, Registers
from linkwork.kernels.program.recorder import Recorder

__all__ = ["lower_program", "reserve"]


@dataclass
class _Lowering:
    """Assigning registers: a scratch register is free again after its last use."""

    recorder: Recorder
    registers: Registers
    scratch_from: int

    def run(self) -> Program:
        rec = self.recorder
        live = self._find_needed()
        self.fused = self._fuse_products(live)
        order = [k for k in sorted(live) if self._is_computed(k)]
        self.last = self._last_uses(order)
        self.place: dict[int, int] = {}
        self.free: list[int] = []
        self.top = self.scratch_from
        target = self._direct_targets(order)
        code: list[tuple[int, int, int, int, int]] = []
        for position, k in enumerate(order):
            if rec.ops[k] is not Op.COS:  # which its sine has written
                code.append(self._instruction(k, target))
            self._release(k, position)
        code += self._copies()
        return Program(code=np.array(code, dtype=np.uint32).reshape(len(code), 5), height=self.top)

    def _copies(self) -> list[tuple[int, int, int, int, int]]:
        """Writes to named registers that are left, in an order in which every source is read
        before it is overwritten; of a circle of sources one is copied first.
        """
        left = {
            self.registers.of(name): self._register(value)
            for name, value in self.recorder.writes.items()
        }
        left = {there: here for there, here in left.items() if here != there}
        found: list[tuple[int, int, int, int, int]] = []
        while left:
            read = set(left.values())
            there = next((there for there in left if there not in read), None)
            if there is None:
                there = next(iter(left))
                aside, self.top = self.top, self.top + 1
                found.append((int(Op.COPY), aside, there, aside, aside))
                left = {to: aside if here == there else here for to, here in left.items()}
            here = left.pop(there)
            found.append((int(Op.COPY), there, here, there, there))
        return found

    def _find_needed(self) -> set[int]:
        rec, todo, found = self.recorder, list(self.recorder.writes.values()), set[int]()
        while todo:
            k = todo.pop()
            if k in found:
                continue
            found.add(k)
            todo += rec.arguments[k]
            if rec.ops[k] is Op.SIN:  # its cosine is computed with it
                cosine = rec._known.get((Op.COS, (k,), None))
                todo += [] if cosine is None else [cosine]
        return found

    def _fuse_products(self, live: set[int]) -> dict[int, tuple[Op, tuple[int, int, int]]]:
        """Sums with a product that is used nowhere else, as one instruction."""
        rec = self.recorder
        uses = dict.fromkeys(live, 0)
        for k in live:
            for a in rec.arguments[k]:
                uses[a] += 1
        for k in rec.writes.values():
            uses[k] += 1
        found: dict[int, tuple[Op, tuple[int, int, int]]] = {}
        self.swallowed: set[int] = set()
        for k in sorted(live):
            if rec.ops[k] not in (Op.ADD, Op.SUB):
                continue
            a, b = rec.arguments[k]
            for product, other, op in ((b, a, Op.FNMA), (a, b, Op.FMS)):
                if rec.ops[product] is Op.MUL and uses[product] == 1:
                    kind = Op.FMA if rec.ops[k] is Op.ADD else op
                    one, two = rec.arguments[product]
                    found[k] = (kind, (one, two, other))
                    self.swallowed.add(product)
                    break
        return found

    def _is_computed(self, k: int) -> bool:
        return self.recorder.ops[k] not in (Op.INPUT, Op.CONSTANT) and k not in self.swallowed

    def _sources(self, k: int) -> tuple[int, ...]:
        return self.fused[k][1] if k in self.fused else self.recorder.arguments[k]

    def _last_uses(self, order: list[int]) -> dict[int, int]:
        last: dict[int, int] = {}
        for position, k in enumerate(order):
            last[k] = position
            for a in self._sources(k):
                last[a] = position
        for k in self.recorder.writes.values():
            last[k] = len(order)
        return last

    def _direct_targets(self, order: list[int]) -> dict[int, int]:
        """Values computed straight into the named register they are written to.

        Only where no later instruction reads the register's old value.
        """
        rec = self.recorder
        position = {k: p for p, k in enumerate(order)}
        for k in order:
            if rec.ops[k] is Op.COS:
                position[k] = position[rec.arguments[k][0]]
        found: dict[int, int] = {}
        self.in_place: set[int] = set()
        for name, value in rec.writes.items():
            before = rec._known.get((Op.INPUT, (), name))
            still_read = -1 if before is None else self.last.get(before, -1)
            if value not in position or value in found:
                continue
            if still_read < position[value]:
                found[value] = self.registers.of(name)
            elif still_read == position[value] and self._changes(value, before):
                found[value] = self.registers.of(name)
                self.in_place.add(value)
        return found

    def _changes(self, value: int, old: int | None) -> bool:
        """Whether a value is the old value in some lanes, or the old value less a number."""
        op, arguments = self.recorder.ops[value], self.recorder.arguments[value]
        if value in self.fused or arguments.count(old or -1) != 1:
            return False
        return (op is Op.WHERE and arguments[2] == old) or (op is Op.SUB and arguments[0] == old)

    def _register(self, k: int) -> int:
        rec = self.recorder
        if rec.ops[k] is Op.INPUT:
            return self.registers.of(_name(rec.payload[k]))
        if rec.ops[k] is Op.CONSTANT:
            return self.registers.of_constant(_constant(rec.payload[k]))
        return self.place[k]

    def _new_place(self, k: int, target: Mapping[int, int]) -> int:
        if k in target:
            place = target[k]
        elif self.free:
            place = self.free.pop()
        else:
            place = self.top
            self.top += 1
        self.place[k] = place
        return place

    def _instruction(self, k: int, target: Mapping[int, int]) -> tuple[int, int, int, int, int]:
        rec = self.recorder
        op, arguments = self.fused.get(k, (rec.ops[k], rec.arguments[k]))
        sources = [self._register(a) for a in arguments]
        place = self._new_place(k, target)
        if k in self.in_place:
            if op is Op.WHERE:
                return int(Op.KEEP), place, sources[0], sources[1], sources[1]
            return int(Op.LESS), place, sources[1], sources[1], sources[1]
        if op is Op.SIN:
            cosine = rec._known.get((Op.COS, (k,), None))
            if cosine is None:
                beside = self._new_place(-1 - k, {})
                self.free.append(beside)
            else:
                beside = self._new_place(cosine, target)
            return int(op), place, sources[0], place, beside
        sources += [place] * (3 - len(sources))
        return int(op), place, sources[0], sources[1], sources[2]

    def _release(self, k: int, position: int) -> None:
        for a in {k, *self._sources(k)}:
            place = self.place.get(a)
            if place is not None and place >= self.scratch_from and self.last[a] <= position:
                del self.place[a]
                self.free.append(place)


def lower_program(recorder: Recorder, registers: Registers, scratch_from: int) -> Program:
    """The program of recorded arithmetic, its scratch registers from a number on.

    Every name and constant it uses must have its register before (see :func:`reserve`).
    """
    return _Lowering(recorder, registers, scratch_from).run()


def reserve(recorder: Recorder, registers: Registers) -> None:
    """Give every name and constant of a recording its register."""
    for op, payload in zip(recorder.ops, recorder.payload, strict=True):
        if op is Op.INPUT:
            registers.of(_name(payload))
        elif op is Op.CONSTANT:
            registers.of_constant(_constant(payload))
    for name in recorder.writes:
        registers.of(name)


def _name(payload: object) -> str:
    assert isinstance(payload, str)
    return payload


def _constant(payload: object) -> float:
    assert isinstance(payload, float)
    return payload
