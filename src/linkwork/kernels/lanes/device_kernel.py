"""The march of one topology on a graphics card: designs in chunks, two of them under way."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.kernels.lanes.device_compiling import graphics_card
from linkwork.kernels.lanes.device_printing import ThreadState, device_source
from linkwork.kernels.lanes.lane_kernel import Gear, LaneKernel, LaneRows, Steps
from linkwork.kernels.lanes.written import written

__all__ = ["Chunk", "DeviceKernel"]

_OPTIONS = ("tolerance", "most_turn", "most_correction", "most_drift")
_BLOCK = 128  # threads: with 255 registers each two blocks fit one multiprocessor
_STAGED = 512 << 20  # bytes of results that one chunk brings back


class DeviceKernel(LaneKernel):
    """Programs and registers for one loop table, run on a graphics card; see
    :class:`linkwork.kernels.lanes.lane_kernel.LaneKernel` for its parameters.
    """

    _kernels: tuple[Callable[..., Any], Callable[..., Any]] | None = None

    def shift(self, gear: Gear) -> None:
        """Write the kernels out; a graphics card compiles each of them at its first launch.

        Raises
        ------
        MissingPackageError
            Without numba-cuda.
        InputError
            Without a graphics card, or if the folder for compiled code cannot be written to.
        """
        self._card = graphics_card()
        self._state = ThreadState.of(self._sections, _OPTIONS)
        source = device_source(self._sections, self._state, self.certified)
        self._kernels = written(source, "begin"), written(source, "march")

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
        """March D designs through R rows, as a :class:`LaneKernel` does.

        The march of one chunk runs while results of the one before are brought back. What is not
        reached is left in ``found`` as it comes.
        """
        count = len(start)
        if not count:
            return
        given = np.zeros((self.nodes.shape[1], count))
        given[: self.table.unknowns], given[-1] = guess, start
        chunks = [self.chunk(rows, steps, count) for _ in range(2)]
        waiting: tuple[Chunk, slice] | None = None
        for k, first in enumerate(range(0, count, chunks[0].designs)):
            part = slice(first, min(first + chunks[0].designs, count))
            chunk = chunks[k % 2]
            chunk.load({name: values[part] for name, values in coefficients.items()}, given[:, part])
            chunk.launch()
            chunk.send_back()
            if waiting is not None:
                waiting[0].collect(found, waiting[1])
            waiting = chunk, part
        assert waiting is not None
        waiting[0].collect(found, waiting[1])

    def chunk(self, rows: Array, steps: Steps, count: int) -> Chunk:
        """Room on the device for as many of ``count`` designs as fit twice."""
        if self._kernels is None:
            self.shift(Gear())
        assert self._kernels is not None
        sizes = np.array([steps.first, steps.largest, steps.smallest])
        options = np.array([getattr(steps, name) for name in self._state.options])
        n, size = self.table.unknowns, self.nodes.shape[1]
        each = 8 * (len(rows) * (n + 2) + len(self._state.coefficients) + 6 * size + 8)
        free = self._card.current_context().get_memory_info().free
        most = max(1, int(min(_STAGED, free / 4) // each))
        parts = -(-count // most)  # equal ones, so that all have the same arrays
        return Chunk.on(
            self._card,
            self._kernels,
            self._state.coefficients,
            (rows, sizes, options),
            (n, size, -(-count // parts)),
            self.certified,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Chunk:
    """Designs on a graphics card, and where their results are brought back to.

    Parameters
    ----------
    designs : int
        How many there is room for.
    card, kernels, stream :
        numba.cuda, ``begin`` and ``march`` of a topology, and the stream they run in.
    coefficients : tuple of str
        The names that the kernels read, in their order.
    table : tuple
        Rows, sizes of steps and options, on the device.
    inputs, node : tuple, device array
        Coefficients (C, M) and guesses (S, M); where mechanisms start (S, M).
    outputs, staged : dict
        Results by their names in :class:`LaneRows`, on the device and in page-locked memory.
    """

    designs: int
    card: Any
    kernels: tuple[Callable[..., Any], Callable[..., Any]]
    stream: Any
    coefficients: tuple[str, ...]
    table: tuple[Any, Any, Any]
    inputs: tuple[Any, Any]
    node: Any
    outputs: dict[str, Any]
    staged: dict[str, Any]

    @classmethod
    def on(
        cls,
        card: Any,
        kernels: tuple[Callable[..., Any], Callable[..., Any]],
        coefficients: tuple[str, ...],
        table: tuple[Array, Array, Array],
        sizes: tuple[int, int, int],
        certified: bool,
    ) -> Chunk:
        """Room for designs; ``sizes``: unknowns, numbers of a node, designs."""
        n, size, designs = sizes
        rows = len(table[0])
        shapes: dict[str, tuple[tuple[int, ...], type]] = {
            "v": ((n, rows, designs), np.float64),
            "radius": ((rows if certified else 1, designs), np.float64),
            "reached": ((rows, designs), np.bool_),
            "found": ((designs,), np.bool_),
            "stopped": ((2, designs), np.float64),
            "last": ((2, 2 * size, designs), np.float64),
        }
        return cls(
            designs=designs,
            card=card,
            kernels=kernels,
            stream=card.stream(),
            coefficients=coefficients,
            table=(
                card.to_device(np.ascontiguousarray(table[0])),
                card.to_device(table[1]),
                card.to_device(table[2]),
            ),
            inputs=(
                card.device_array((len(coefficients), designs), np.float64),
                card.device_array((size, designs), np.float64),
            ),
            node=card.device_array((size, designs), np.float64),
            outputs={name: card.device_array(*what) for name, what in shapes.items()},
            staged={name: card.pinned_array(*what) for name, what in shapes.items()},
        )

    def load(self, coefficients: Mapping[str, Array], given: Array) -> None:
        """Coefficients by register (m,) and guesses (S, m) of m ≤ ``designs`` designs; room that is
        left over is filled with guesses that lead nowhere.
        """
        design, guess = np.ones(self.inputs[0].shape), np.full(self.inputs[1].shape, np.nan)
        for j, name in enumerate(self.coefficients):
            design[j, : given.shape[1]] = coefficients[name]
        guess[:, : given.shape[1]] = given
        self.inputs[0].copy_to_device(design, stream=self.stream)
        self.inputs[1].copy_to_device(guess, stream=self.stream)

    def launch(self) -> None:
        """Let the device begin and march."""
        (rows, steps, options), (design, given), out = self.table, self.inputs, self.outputs
        begin, march = self.kernels
        blocks = -(-self.designs // _BLOCK)
        with warnings.catch_warnings():  # that a small grid leaves much of the device idle
            warnings.simplefilter("ignore")
            first, second = begin[blocks, _BLOCK, self.stream], march[2 * blocks, _BLOCK, self.stream]
        first(design, options, given, self.node, out["found"], out["reached"], out["stopped"])
        second(
            design, options, self.node, out["found"], rows, steps,
            out["v"], out["radius"], out["reached"], out["stopped"], out["last"],
        )  # fmt: skip

    def send_back(self) -> None:
        """Ask for the results."""
        for name, values in self.outputs.items():
            values.copy_to_host(self.staged[name], stream=self.stream)

    def collect(self, found: LaneRows, part: slice) -> None:
        """Wait for the results and enter them as those of some designs."""
        self.stream.synchronize()
        count = part.stop - part.start
        for name, values in self.staged.items():
            own = getattr(found, name)
            if len(own):  # radii are there with proofs only
                own[..., part] = values[..., :count]
