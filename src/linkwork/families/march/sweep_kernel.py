"""Sharing designs out among threads."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Set
from contextlib import suppress
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import (
    Array,
    BoolArray,
    IndexArray,
    TurnArray,
    allocate_aligned,
)
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.loading import share_out
from linkwork.core.record.closure import BlockPart
from linkwork.core.record.printing import trial_source
from linkwork.core.record.recorder import LANES, ROLES, Code, registers_read
from linkwork.core.table.loop_table import LoopTable
from linkwork.families import march as loops
from linkwork.families.compiled.code_cache import Execution, is_cached, load_compiled
from linkwork.families.compiled.compiling import compiled
from linkwork.families.compiled.interpreter import run
from linkwork.families.march.dead_points import LastNodes
from linkwork.families.march.march_programs import (
    OPTIONS,
    WEIGHTS,
    PlaceProgram,
    Steps,
    march_programs,
)
from linkwork.families.march.step_trial import InputTable, MarchResult, Tasks, Topology, begin

MOST_DESIGNS = 4096  # designs that one thread works on at a time, at most
LEAST_LANES = 2  # times LANES: designs in a part where threads share them, at least


def share_of_threads(count: int, threads: int) -> list[slice]:
    """Parts of ``count`` designs, each of whole groups of lanes.

    Of several threads each takes half of its share of the designs that are left, so that the last
    parts are small and no thread waits long for the others.
    """
    parts, first = list[slice](), 0
    while first < count:
        size = MOST_DESIGNS
        if threads > 1:
            lanes = -(-(count - first) // (LANES * 2 * threads))
            size = min(MOST_DESIGNS, max(LEAST_LANES, lanes) * LANES)
        parts.append(slice(first, min(first + size, count)))
        first += size
    return parts


# ----------------------------------------------------------------------
# The march of one topology, ready to run: programs in one array, registers by number.


_FEW = 4  # designs: both ways of so many fill the lanes that a processor computes at once


class SweepKernel:
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
        noted = ["good", "radius", *[f"live{b}" for b in range(len(parts))]]
        self.noted = reg.all_of([f"{name}.0" for name in noted])
        self.shared = reg.all_of(programs.shared)
        self.weights = reg.all_of(WEIGHTS)
        self.height = max(programs.height, reg.count)
        self._sections = programs
        #: The workspace of the steps asked for last; replaced whole, for threads share a kernel.
        self._blank: tuple[Steps, Array] | None = None
        # written out; the loaded one is kept, for its address is used
        self._trial: Any = None
        self._loaded: Any = None

    @property
    def trial(self) -> int:
        """Address of the trial written out, 0 where the interpreter does it."""
        written_out = self._trial  # read once: another thread may choose
        return 0 if written_out is None else int(written_out.address)

    def choose_execution(self, execution: Execution) -> None:
        """Write the trial out, if that is asked for or saves time.

        Raises
        ------
        InputError
            If it is asked for, and the folder for compiled code cannot be written to.
        """
        self._trial = None  # not what was chosen before: values may not depend on that
        if execution.specialised:
            self._trial = self._written_out()
        elif execution.specialised is None and self._pays_written_out(execution):
            with suppress(InputError):  # compiled code was not required: the interpreter serves
                self._trial = self._written_out()

    def _written_out(self) -> Any:
        if self._loaded is None:
            self._loaded = load_compiled(self.source(), "trial")
        return self._loaded

    def _pays_written_out(self, execution: Execution) -> bool:
        length = len(self.code)
        return execution.pays(length) or (
            execution.pays_compiled(length)
            and (self._loaded is not None or is_cached(self.source()))
        )

    def source(self) -> str:
        """A trial of this topology written out: prediction, one correction, proof, judgement."""
        kinds = self._sections.by_kind
        ordered = [p for kind in ("predict", "begin", "prove", "judge") for p in kinds[kind]]
        after = [p for kind in ("iterate", "prove", "judge") for p in kinds[kind]]
        kept = {*self.nodes[0].tolist(), *self.noted.tolist(), *registers_read(after)}
        return trial_source(
            [section.code for section in ordered],
            self.nodes.shape[1],
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
        found: MarchResult,
        threads: int = 1,
    ) -> BoolArray:
        """March D designs through R rows.

        Parameters
        ----------
        coefficients : Mapping[str, (D,)]
            By register; names that no program uses are left out.
        guess : (n, D)
            Of the unknowns, at ``start`` (D,).
        rows : (R,)
            Increasing values of t.
        found : MarchResult
            Filled, see :meth:`result`.

        Returns
        -------
        (D,)
            Designs whose start was found.
        """
        count, given = len(start), self.guess_nodes(guess, start)
        named = self.registers.named
        used = [name for name in coefficients if name in named]
        design = np.array([coefficients[name] for name in used]).reshape(len(used), count)
        topology = self._topology(np.array([named[name] for name in used], dtype=np.intp))
        table = InputTable(rows, steps.sizes, self.table.unknowns)
        begun = np.zeros(count, dtype=bool)

        def one(part: slice) -> None:
            own, some = found._replace(first=part.start), np.ascontiguousarray(design[:, part])
            begun[part] = self._part(topology, some, given[:, part], table, steps, own)

        parts = share_of_threads(count, threads)
        share_out(one, parts, min(threads, len(parts)))
        return begun

    def result(self, v: Array, radius: Array) -> MarchResult:
        """Room for a march: unknowns v (n, R, D) and radii (R, D), (0, D) without proofs, are
        written to where positions are found.
        """
        _, rows, count = v.shape
        reached, end = np.zeros((rows, count), dtype=bool), np.full((2, count), np.nan)
        last = np.empty((2, 2 * self.nodes.shape[1], count))
        return MarchResult(0, v, radius, reached, end, last)

    def guess_nodes(self, guess: Array, start: Array) -> Array:
        """Guesses (n, D) at ``start`` (D,) as nodes, (S, D)."""
        node = np.zeros((self.nodes.shape[1], len(start)))
        node[: self.table.unknowns], node[-1] = guess, start
        return node

    def last_nodes(self, found: MarchResult, way: int, where: IndexArray) -> LastNodes:
        """The nodes at which some designs stopped, downwards (0) or upwards (1)."""
        n, last = self.table.unknowns, found.last[way][:, where]
        w, s, x = (last[k * n : (k + 1) * n] for k in range(3))
        q, p = (last[self.nodes.shape[1] :][k * n : (k + 1) * n] for k in range(2))
        errors = x if self.certified else np.zeros_like(w)
        return LastNodes(t=found.end[way, where], w=w, s=s, q=q, p=p, x=errors)

    def workspace(self, steps: Steps) -> Array:
        """A workspace with constants and options in place."""
        # filling constants takes longer than copying a filled workspace
        blank = self._blank
        if blank is None or blank[0] != steps:
            space = self.registers.filled(self.height, LANES)
            for name in OPTIONS:
                if name in self.registers.named:
                    space[self.registers.named[name]] = getattr(steps, name)
            blank = self._blank = steps, space
        own = allocate_aligned(self.height, LANES)
        own[:] = blank[1]
        return own

    def _part(
        self,
        topology: Topology,
        design: Array,
        given: Array,
        table: InputTable,
        steps: Steps,
        found: MarchResult,
    ) -> BoolArray:
        """March designs (C, M) from their guesses (S, M); which of them start."""
        space, given = self.workspace(steps), np.ascontiguousarray(given)
        node, begun = np.empty_like(given), np.zeros(given.shape[1], dtype=bool)
        begin(topology, space, design, given, node, begun)
        tasks = Tasks.room(2 * len(begun), len(node))
        if np.count_nonzero(begun) > _FEW:
            left = loops.in_step(topology, space, design, node, begun, table, tasks, found)
        else:
            members = np.repeat(np.flatnonzero(begun), 2)
            left = len(members)
            tasks.member[:left], tasks.node[:, :left] = members, node[:, members]
            tasks.way[:left] = np.tile([1, 0], left // 2)
        if left:
            loops.march(topology, space, design, table, tasks, left, found)
        return begun

    def _topology(self, coefficients: IndexArray) -> Topology:
        return Topology(
            code=self.code,
            length=len(self.code) // ROLES,
            spans=self.spans,
            weights=self.weights,
            nodes=self.nodes,
            noted=self.noted,
            shared=self.shared,
            coefficients=coefficients,
            trial=self.trial,
        )


# ----------------------------------------------------------------------
# Programs run over the positions of many designs, in compiled code.


_PART = 1024  # designs that one thread works on at a time


def at_places(
    reading: PlaceProgram,
    coefficients: Mapping[str, Array],
    v: Array,
    inputs: Array,
    turns: TurnArray,
    threads: int = 1,
) -> Array:
    """Run a program at the positions of D designs in R rows.

    Parameters
    ----------
    coefficients : Mapping[str, (D,)]
        By register; names that the program does not use are left out.
    v : (n, R, D)
        Unknowns; NaN gives NaN.
    inputs : (R, p)
    turns : (R, D)
        Whole turns by which the first input of a position exceeds the row's.

    Returns
    -------
    (len(reading.wanted), R, D)
    """
    n, rows, count = v.shape
    named = reading.registers.named
    used = [name for name in coefficients if name in named]
    design = np.array([coefficients[name] for name in used]).reshape(len(used), count)
    # a variable that the program does not use is loaded into a register of its own
    spare = max(reading.program.height, reading.registers.count)
    places = np.array([named[name] for name in used], dtype=np.intp)
    variables = [named.get(f"v{k}", spare) for k in range(n + inputs.shape[1])]
    found = np.empty((len(reading.wanted), rows, count))

    def one(first: int) -> None:
        part = slice(first, first + _PART)
        _evaluate(
            reading.program.code, reading.registers.filled(spare + 1, LANES), places,
            np.array(variables, dtype=np.intp), np.ascontiguousarray(design[:, part]),
            v[:, :, part], inputs, turns[:, part], reading.registers.all_of(reading.wanted),
            found[:, :, part],
        )  # fmt: skip

    firsts = range(0, count, _PART)
    share_out(one, firsts, min(threads, len(firsts)))
    return found


@compiled
def _evaluate(
    code: Code,
    w: Array,
    places: IndexArray,
    variables: IndexArray,
    design: Array,
    v: Array,
    inputs: Array,
    turns: TurnArray,
    wanted: IndexArray,
    found: Array,
) -> None:
    """LANES designs at a time, row by row."""
    unknowns, rows, count = v.shape
    for base in range(0, count, LANES):
        lanes = min(LANES, count - base)
        for lane in range(LANES):
            member = base + min(lane, lanes - 1)
            for j in range(len(places)):
                w[places[j], lane] = design[j, member]
        for row in range(rows):
            for k in range(unknowns):
                for lane in range(lanes):
                    w[variables[k], lane] = v[k, row, base + lane]
            for j in range(inputs.shape[1]):
                for lane in range(lanes):
                    w[variables[unknowns + j], lane] = inputs[row, j]
            if inputs.shape[1]:
                for lane in range(lanes):
                    turn = turns[row, base + lane]
                    if turn:
                        w[variables[unknowns], lane] += turn * 2.0 * math.pi
            run(code, w)
            for j in range(len(wanted)):
                for lane in range(lanes):
                    found[j, row, base + lane] = w[wanted[j], lane]
