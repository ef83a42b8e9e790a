"""The march of one topology on a graphics card: designs in chunks, two of them under way."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.foundation.arrays import AnyArray, Array, BoolArray
from linkwork.kernels.gpu.compiling import graphics_card
from linkwork.kernels.gpu.printing import device_source
from linkwork.kernels.march.printed_sections import ThreadState
from linkwork.kernels.march.sweep_kernel import Steps, SweepKernel
from linkwork.kernels.march.work_arrays import MarchResult
from linkwork.kernels.program.code_cache import load_compiled
from linkwork.kernels.program.execution import Execution

__all__ = ["Chunk", "DeviceKernel"]

_OPTIONS = ("tolerance", "most_turn", "most_correction", "most_drift")
_BLOCK = 128  # threads: with 255 registers each two blocks fit one multiprocessor
_STAGED = 256 << 20  # bytes of results that one chunk brings back

_Kernels = tuple[Any, Any]  # to be indexed with a grid, and called then


class DeviceKernel(SweepKernel):
    """Programs and registers for one loop table, run on a graphics card; see
    :class:`linkwork.kernels.march.sweep_kernel.SweepKernel` for its parameters.
    """

    _kernels: _Kernels | None = None
    _chunks: tuple[Chunk, ...] = ()  # of the latest run: page-locked memory is slow to get

    def choose_execution(self, execution: Execution) -> None:
        """Write the kernels out; a graphics card compiles each of them at its first launch.

        Raises
        ------
        MissingPackageError
            Without numba-cuda.
        InputError
            Without a graphics card, or if the folder for compiled code cannot be written to.
        """
        if self._kernels is not None:
            return
        self._card = graphics_card()
        self._state = ThreadState.of(self._sections, _OPTIONS)
        source = device_source(self._sections, self._state, self.certified)
        self._kernels = load_compiled(source, "begin"), load_compiled(source, "march")

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
        """March D designs through R rows, as a :class:`SweepKernel` does.

        The march of one chunk runs while results of the chunk before are copied back. Rows that are
        not reached keep arbitrary numbers in ``found``.
        """
        count, given = len(start), self.guess_nodes(guess, start)
        begun = np.zeros(count, dtype=bool)
        if not count:
            return begun
        results = found._asdict() | {"begun": begun}
        chunks = self._room(len(rows), count)
        waiting: tuple[Chunk, slice] | None = None
        for k, first in enumerate(range(0, count, chunks[0].designs)):
            chunk, part = chunks[k % 2], slice(first, min(first + chunks[0].designs, count))
            own = {name: coefficients[name][part] for name in chunk.coefficients}
            chunk.load(rows, self._options(steps), own, given[:, part])
            chunk.launch()
            chunk.send_back()
            if waiting is not None:
                waiting[0].collect(results, waiting[1])
            waiting = chunk, part
        assert waiting is not None
        waiting[0].collect(results, waiting[1])
        return begun

    def load(
        self,
        chunk: Chunk,
        coefficients: Mapping[str, Array],
        guess: Array,
        start: Array,
        rows: Array,
        steps: Steps,
    ) -> None:
        """Fill a chunk with the first designs; see :meth:`run`."""
        part = slice(0, chunk.designs)
        own = {name: coefficients[name][part] for name in chunk.coefficients}
        given = self.guess_nodes(guess[:, part], start[part])
        chunk.load(rows, self._options(steps), own, given)

    def chunk(self, rows: int, designs: int) -> Chunk:
        """Room on the device for some designs over some rows."""
        self.choose_execution(Execution())
        assert self._kernels is not None
        shape = _Shape(
            unknowns=self.table.unknowns,
            size=self.nodes.shape[1],
            rows=rows,
            designs=designs,
            certified=self.certified,
        )
        return Chunk.on(self._card, self._kernels, self._state, shape)

    def _options(self, steps: Steps) -> tuple[Array, Array]:
        options = [getattr(steps, name) for name in self._state.options]
        return np.array([steps.first, steps.largest, steps.smallest]), np.array(options)

    def _room(self, rows: int, count: int) -> tuple[Chunk, ...]:
        """One chunk for all designs, or two equal ones that are used in turn."""
        self.choose_execution(Execution())
        each = 8 * (rows * (self.table.unknowns + 2) + len(self._state.coefficients))
        each += 8 * (6 * self.nodes.shape[1] + 4)
        free = self._card.current_context().get_memory_info().free
        free += sum(chunk.designs * each for chunk in self._chunks)
        most = max(1, int(min(_STAGED, free / 4) // each))
        parts = -(-count // most)
        designs = -(-count // parts)
        known = self._chunks
        if not (
            known
            and len(known) >= min(parts, 2)
            and (known[0].designs, known[0].rows) == (designs, rows)
        ):
            self._chunks = ()  # given back before more is asked for
            self._chunks = tuple(self.chunk(rows, designs) for _ in range(min(parts, 2)))
        return self._chunks


@dataclass(frozen=True, kw_only=True)
class _Shape:
    """Sizes of a chunk's arrays; ``size``: numbers of a node."""

    unknowns: int
    size: int
    rows: int
    designs: int
    certified: bool

    @property
    def outputs(self) -> dict[str, tuple[tuple[int, ...], type]]:
        """Results by their names in :class:`MarchResult`, and which designs begin."""
        radii = self.rows if self.certified else 1  # unused, because nothing has no address
        return {
            "unknowns": ((self.unknowns, self.rows, self.designs), np.float64),
            "radius": ((radii, self.designs), np.float64),
            "reached": ((self.rows, self.designs), np.bool_),
            "begun": ((self.designs,), np.bool_),
            "end": ((2, self.designs), np.float64),
            "last": ((2, 2 * self.size, self.designs), np.float64),
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Chunk:
    """Designs on a graphics card, and where their results are brought back to.

    Parameters
    ----------
    designs, rows : int
        How many there is room for.
    kernels, stream
        ``begin`` and ``march`` of a topology, and the stream they run in.
    coefficients : tuple of str
        The names that the kernels read, in their order.
    inputs : dict of device arrays
        ``design`` (C, M), ``given`` (S, M), ``rows`` (R,), ``steps`` (3,), ``options`` (O,).
    node : device array
        Where mechanisms start, (S, M).
    outputs, staged : dict
        Results by their names in ``_Shape.outputs``, on the device; in page-locked memory those
        that are brought back.
    """

    designs: int
    rows: int
    kernels: _Kernels
    stream: Any
    coefficients: tuple[str, ...]
    inputs: dict[str, Any]
    node: Any
    outputs: dict[str, Any]
    staged: dict[str, Any]

    @classmethod
    def on(cls, card: Any, kernels: _Kernels, state: ThreadState, shape: _Shape) -> Chunk:
        """Room on a card."""
        inputs = {
            "design": (len(state.coefficients), shape.designs),
            "given": (shape.size, shape.designs),
            "rows": (shape.rows,),
            "steps": (3,),
            "options": (len(state.options),),
        }
        return cls(
            designs=shape.designs,
            rows=shape.rows,
            kernels=kernels,
            stream=card.stream(),
            coefficients=state.coefficients,
            inputs={name: card.device_array(own, np.float64) for name, own in inputs.items()},
            node=card.device_array((shape.size, shape.designs), np.float64),
            outputs={name: card.device_array(*own) for name, own in shape.outputs.items()},
            staged={
                name: card.pinned_array(*own)
                for name, own in shape.outputs.items()
                if shape.certified or name != "radius"
            },
        )

    def load(
        self,
        rows: Array,
        steps: tuple[Array, Array],
        coefficients: Mapping[str, Array],
        given: Array,
    ) -> None:
        """Coefficients by register (m,) and guesses (S, m) of m ≤ ``designs`` designs.

        ``steps``: their sizes, and the other options. Room that is left over is filled with guesses
        that lead nowhere.
        """
        design = np.ones(self.inputs["design"].shape)
        guess = np.full(self.inputs["given"].shape, np.nan)
        for j, name in enumerate(self.coefficients):
            design[j, : given.shape[1]] = coefficients[name]
        guess[:, : given.shape[1]] = given
        values = (design, guess, np.ascontiguousarray(rows), *steps)
        for name, value in zip(self.inputs, values, strict=True):
            self.inputs[name].copy_to_device(value, stream=self.stream)

    def launch(self) -> None:
        """Let the device begin and march."""
        own, out, blocks = self.inputs, self.outputs, -(-self.designs // _BLOCK)
        with warnings.catch_warnings():  # that a small grid leaves much of the device idle
            warnings.simplefilter("ignore")
            begin = self.kernels[0][blocks, _BLOCK, self.stream]
            march = self.kernels[1][2 * blocks, _BLOCK, self.stream]
        design, options, node = own["design"], own["options"], self.node
        begun, reached, end = out["begun"], out["reached"], out["end"]
        begin(design, options, own["given"], node, begun, reached, end)
        march(
            design, options, node, begun, own["rows"], own["steps"],
            out["unknowns"], out["radius"], reached, end, out["last"],
        )  # fmt: skip

    def send_back(self) -> None:
        """Ask for the results."""
        for name, values in self.staged.items():
            self.outputs[name].copy_to_host(values, stream=self.stream)

    def collect(self, results: Mapping[str, AnyArray], part: slice) -> None:
        """Wait for the results and enter them, by name, as those of some designs."""
        self.stream.synchronize()
        count = part.stop - part.start
        for name, values in self.staged.items():
            results[name][..., part] = values[..., :count]
