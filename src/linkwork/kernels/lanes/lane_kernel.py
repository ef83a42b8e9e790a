"""The march of one topology, ready to run: programs in one array, registers by number."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.errors import InputError
from linkwork.kernels.lanes.beginning import begin
from linkwork.kernels.lanes.closure import BlockPart
from linkwork.kernels.lanes.folding import LastNodes
from linkwork.kernels.lanes.lockstep import in_step
from linkwork.kernels.lanes.machine import LANES
from linkwork.kernels.lanes.march_programs import ROLES, march_programs
from linkwork.kernels.lanes.marching import march
from linkwork.kernels.lanes.printing import trial_source
from linkwork.kernels.lanes.program import SOURCES, Op, Program
from linkwork.kernels.lanes.tasks import Found, Table, Tasks
from linkwork.kernels.lanes.trial import Topology, by_machine
from linkwork.kernels.lanes.written import is_written, written
from linkwork.kernels.loop_table import LoopTable

__all__ = ["DEVICES", "Gear", "LaneKernel", "LaneRows", "Steps"]

#: What a march can run on.
DEVICES = ("cpu", "gpu")

_WEIGHTS = [f"{name}{role}" for role in range(1, ROLES) for name in "ab"]
_PART = 4096  # designs that one thread works on at a time


@dataclass(frozen=True, kw_only=True)
class Steps:
    """How lanes step: sizes in t, tolerances as weighted changes.

    ``tolerance``: below it a Newton-Raphson step is the last one; the error left is about its
    square. ``most_correction``, ``most_drift``: without proofs, the largest first correction and
    change of rates times step that are trusted.
    """

    first: float = 0.05
    largest: float = 0.6
    smallest: float = 1e-5
    tolerance: float = 1e-8
    most_turn: float = float(np.radians(40.0))
    most_correction: float = 0.1
    most_drift: float = 0.5

    def times(self, size: float) -> Steps:
        """For a path whose natural step is so many times longer: a length for lengths."""
        return replace(
            self,
            first=size * self.first,
            largest=size * self.largest,
            smallest=size * self.smallest,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class LaneRows:
    """Where the march of D designs over R rows leaves what it finds.

    ``v`` (n, R, D): unknowns, untouched where not reached. ``radius`` (R, D): of the proof,
    weighted ((0, D) without). ``reached`` (R, D). ``found`` (D,): the start. ``stopped`` (2, D):
    the last value of t downwards and upwards where a design could go no further, NaN where it went
    through; ``last`` (2, S, D): the node there, see :meth:`LaneKernel.last_nodes`.
    """

    v: Array
    radius: Array
    reached: BoolArray
    found: BoolArray
    stopped: Array
    last: Array

    @classmethod
    def over(cls, v: Array, radius: Array, kernel: LaneKernel) -> LaneRows:
        """Nothing found yet; ``v`` and ``radius`` are written to."""
        _, rows, count = v.shape
        return cls(
            v=v,
            radius=radius,
            reached=np.zeros((rows, count), dtype=bool),
            found=np.zeros(count, dtype=bool),
            stopped=np.full((2, count), np.nan),
            last=np.empty((2, 2 * kernel.nodes.shape[1], count)),
        )

    def take(self, where: IndexArray) -> LaneRows:
        """Some of the designs."""
        return LaneRows(
            v=self.v[:, :, where],
            radius=self.radius[:, where],
            reached=self.reached[:, where],
            found=self.found[where],
            stopped=self.stopped[:, where],
            last=self.last[:, :, where],
        )


@dataclass(frozen=True, kw_only=True)
class Gear:
    """Whether the trial of a topology is written out and compiled, or done by the machine.

    Parameters
    ----------
    specialised : bool, optional
        Asked for; by default it is whatever takes less time for so many ``positions``.
    positions : int
    device : str
        Where it runs, one of :data:`DEVICES`; a graphics card runs nothing but what is compiled.

    Raises
    ------
    InputError
        For another device, or for a graphics card that should compile nothing.
    """

    specialised: bool | None = None
    positions: int = 0
    device: str = "cpu"

    def __post_init__(self) -> None:
        if self.device not in DEVICES:
            raise InputError(
                f'there is no device "{self.device}" (there are: {", ".join(DEVICES)})'
            )
        if self.device == "gpu" and self.specialised is False:
            raise InputError(
                "a graphics card runs nothing but compiled equations: leave out "
                'specialised=False or device="gpu"'
            )


# Compiling takes some 5 ms for each instruction, of which a position then costs 0.1 ns less.
_PAYS = 100_000_000  # positions
_PAYS_COMPILED = 1_000_000  # where an earlier run has left what it compiled
_LONGEST = 4_000  # instructions: the compiler's time grows faster than they do


class LaneKernel:
    """Programs and registers for one loop table.

    Parameters
    ----------
    table : LoopTable
        Without function rows.
    parts : sequence of BlockPart
        In the order in which blocks are solved.
    zeros : set of str
        Coefficients that are zero in every design, by register.
    certified : bool
        Whether every step is proved.
    """

    def __init__(
        self, table: LoopTable, parts: Sequence[BlockPart], zeros: Set[str], certified: bool
    ) -> None:
        self.table, self.certified = table, certified
        programs = march_programs(table, parts, zeros, certified)
        self.registers = reg = programs.registers
        self.code = np.concatenate(
            [section.code for moves in range(ROLES) for section in programs.turned(moves)]
        )
        ends = np.cumsum([len(section.code) for section in programs.sections])
        self.spans = np.stack([np.concatenate([[0], ends[:-1]]), ends], axis=1)
        self.nodes = np.ascontiguousarray(programs.nodes)
        self.places = programs.places
        noted = ["good", "radius", *[f"live{b}" for b in range(len(parts))]]
        self.noted = np.stack(
            [reg.all_of([f"{name}.{role}" for name in noted]) for role in range(ROLES)]
        )
        self.weights = reg.all_of(_WEIGHTS)
        self.height = max(programs.height, reg.count)
        self._sections = programs
        self.trial: Callable[..., None] = by_machine

    def shift(self, gear: Gear) -> None:
        """Write the trial out, if that is asked for or saves time.

        Raises
        ------
        InputError
            If it is asked for, and the folder for compiled code cannot be written to.
        """
        if gear.specialised is False or self.trial is not by_machine:
            return
        if not gear.specialised and gear.positions < _PAYS_COMPILED:
            return
        source = self.source()
        if gear.specialised:
            self.trial = written(source, "trial")
        elif len(self.code) <= ROLES * _LONGEST and (gear.positions >= _PAYS or is_written(source)):
            with suppress(InputError):  # nobody asked: the machine serves
                self.trial = written(source, "trial")

    def source(self) -> str:
        """A trial of this topology written out: prediction, one correction, proof, judgement."""
        sections = self._sections
        ordered = [sections.predict, *sections.begin, *sections.prove, sections.judge]
        after = [*sections.iterate, *sections.prove, sections.judge]
        kept = {*self.nodes[0].tolist(), *self.noted[0].tolist(), *_read(after)}
        return trial_source(
            [section.code for section in ordered],
            self.places.shape[1],
            kept,
            {register: value for value, register in self.registers.constants.items()},
        )

    def run(
        self,
        coefficients: Mapping[str, Array],
        guess: Array,
        start: Array,
        rows: Array,
        steps: Steps,
        found: LaneRows,
        threads: int = 1,
    ) -> None:
        """March D designs through R rows.

        Parameters
        ----------
        coefficients : Mapping[str, (D,)]
            By register; names that no program uses are left out.
        guess : (n, D)
            Of the unknowns, at ``start`` (D,).
        rows : (R,)
            Increasing values of t.
        found : LaneRows
            Filled.
        """
        named = self.registers.named
        used = [name for name in coefficients if name in named]
        count = len(start)
        design = np.array([coefficients[name] for name in used]).reshape(len(used), count)
        places = np.array([named[name] for name in used], dtype=np.intp)
        given = self.given(guess, start)

        def one(first: int) -> None:
            part = slice(first, first + _PART)
            self._part(places, design[:, part], given[:, part], rows, steps, found, part)

        firsts = range(0, count, _PART)
        if threads > 1 and len(firsts) > 1:
            with ThreadPoolExecutor(threads) as pool:
                list(pool.map(one, firsts))
        else:
            for first in firsts:
                one(first)

    def given(self, guess: Array, start: Array) -> Array:
        """Guesses (n, D) at ``start`` (D,) as nodes, (S, D)."""
        node = np.zeros((self.nodes.shape[1], len(start)))
        node[: self.table.unknowns], node[-1] = guess, start
        return node

    def last_nodes(self, found: LaneRows, way: int, where: IndexArray) -> LastNodes:
        """The nodes at which some designs stopped, downwards (0) or upwards (1)."""
        n, last = self.table.unknowns, found.last[way][:, where]
        w, s, x = (last[k * n : (k + 1) * n] for k in range(3))
        q, p = (last[self.nodes.shape[1] :][k * n : (k + 1) * n] for k in range(2))
        errors = x if self.certified else np.zeros_like(w)
        return LastNodes(t=found.stopped[way, where], w=w, s=s, q=q, p=p, x=errors)

    def _part(
        self,
        places: IndexArray,
        design: Array,
        given: Array,
        rows: Array,
        steps: Steps,
        found: LaneRows,
        part: slice,
    ) -> None:
        space = self.registers.filled(self.height, LANES)
        for name, value in (
            ("tolerance", steps.tolerance),
            ("most_turn", steps.most_turn),
            ("most_correction", steps.most_correction),
            ("most_drift", steps.most_drift),
        ):
            if name in self.registers.named:
                space[self.registers.named[name]] = value
        design = np.ascontiguousarray(design)
        given = np.ascontiguousarray(given)
        size, count = self.nodes.shape[1], design.shape[1]
        node, begun = np.empty((size, count)), np.zeros(count, dtype=bool)
        topology = self._topology(places)
        begin(topology, space, design, given, node, begun)
        found.found[part] = begun
        table = Table(
            rows, np.array([steps.first, steps.largest, steps.smallest]), self.table.unknowns
        )
        kept = Found(part.start, found.v, found.radius, found.reached, found.stopped, found.last)
        tasks = Tasks.room(2 * count, size)
        trial = self.trial, self.trial is not by_machine
        many = in_step(topology, *trial, space, design, node, begun, table, tasks, kept)
        march(topology, *trial, space, design, table, tasks, many, kept)

    def _topology(self, coefficients: IndexArray) -> Topology:
        return Topology(
            code=self.code,
            length=len(self.code) // ROLES,
            spans=self.spans,
            weights=self.weights,
            nodes=self.nodes,
            noted=self.noted,
            height=self.places.shape[1],
            coefficients=coefficients,
        )


def _read(programs: Sequence[Program]) -> set[int]:
    """Registers that programs read before they write them."""
    read, written = set[int](), set[int]()
    for program in programs:
        for number, target, *sources in program.code.tolist():
            op = Op(number)
            count = SOURCES[op]
            read.update(set(sources[:count]) - written)
            if op in (Op.KEEP, Op.LESS):
                read.update({target} - written)
            written.update({target, sources[2]} if op is Op.SIN else {target})
    return read
