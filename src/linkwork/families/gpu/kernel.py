"""Compiling functions for a graphics card: the only module that imports numba.cuda."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from typing import Any, ParamSpec, TypeVar

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array, BoolArray
from linkwork.core.foundation.errors import InputError, MissingPackageError
from linkwork.core.record.printing import PYTHON
from linkwork.families.compiled.code_cache import Execution, load_compiled
from linkwork.families.march.march_programs import (
    OPTIONS,
    START_STEPS,
    STEPS,
    MarchPrograms,
    Steps,
    ThreadState,
    printed_sections,
)
from linkwork.families.march.step_trial import MarchResult
from linkwork.families.march.sweep_kernel import SweepKernel

_P = ParamSpec("_P")
_R = TypeVar("_R")


def numba_cuda() -> Any:
    """The package; loading it takes half a second."""
    from numba import cuda

    return cuda


def graphics_card() -> Any:
    """The package, where there is a graphics card that it can use (or its simulator).

    Raises
    ------
    MissingPackageError
        With the package to install.
    InputError
        If there is no such device.
    """
    if find_spec("numba_cuda") is None:
        raise MissingPackageError(
            'families on a graphics card need numba-cuda: pip install "linkwork[gpu]"'
        )
    cuda = numba_cuda()
    if not cuda.is_available():
        raise InputError(
            "no usable graphics card was found: an NVIDIA card needs its driver and CUDA's "
            'compiler (pip install "numba-cuda[cu12]" or "[cu13]"); leave out device="gpu" to '
            "use the processor"
        )
    return cuda


def name_of(card: Any) -> str:
    """The name of the graphics card in use."""
    name = card.get_current_device().name
    return name.decode() if isinstance(name, bytes) else str(name)


def on_device(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """A function that kernels call; it becomes a part of them, so that arrays of a thread that are
    addressed by constants stay in registers.
    """
    cuda = numba_cuda()
    inlined = {} if _simulated() else {"forceinline": True}
    placed: Callable[_P, _R] = cuda.jit(device=True, **inlined)(function)
    return placed


def kernel(function: Callable[..., Any]) -> Any:
    """A function that a graphics card runs in many threads, compiled once for each kind of card."""
    return numba_cuda().jit(cache=True)(function)


def _simulated() -> bool:
    """Whether kernels are run as Python, for tests."""
    from numba import config

    return bool(getattr(config, "ENABLE_CUDASIM", 0))


# ----------------------------------------------------------------------
# Programs written out for a graphics card: functions of a thread's state, and two kernels.


_HEAD = """\
import math

from linkwork.families.gpu import march as device_march
from linkwork.families.gpu.march import cuda, kernel, on_device, sin_cos
"""
_KERNELS = """\
SECTIONS = device_march.Sections(predict, correct, correct_slowly, judge)
SHAPE = device_march.{shape}


@kernel
def begin(design, options, given, node, begun, reached, end):
    member = cuda.grid(1)
    if member < given.shape[1]:
        for row in range(reached.shape[0]):
            reached[row, member] = False
        end[0, member] = math.nan
        end[1, member] = math.nan
        w = cuda.local.array({length}, "float64")
        start = device_march.Start(member, design, options, given)
        device_march.begin(SECTIONS, SHAPE, w, start, node, begun)


@kernel
def march(design, options, node, begun, rows, steps, v, radius, reached, end, last):
    thread = cuda.grid(1)
    member, way = thread % node.shape[1], thread // node.shape[1]
    if way < 2 and begun[member]:
        w = cuda.local.array({length}, "float64")
        start = device_march.Start(member, design, options, node)
        table = device_march.InputTable(rows, steps, SHAPE.unknowns)
        found = device_march.MarchResult(member, v, radius, reached, end, last)
        device_march.follow(SECTIONS, SHAPE, w, start, way, table, found)
"""


def device_source(programs: MarchPrograms, state: ThreadState, certified: bool) -> str:
    """A module with the kernels ``begin`` and ``march`` of one topology.

    Parameters
    ----------
    programs : MarchPrograms
    state : ThreadState
    certified : bool
        Whether the programs prove their positions.
    """
    named = programs.registers.named
    first = {"weights": "a1", "good": "good.0", "radius": "radius.0", "live": "live0.0"}
    sizes = {name: state.place[named[register]] for name, register in first.items()} | {
        "unknowns": named["d0.0"],
        "size": programs.nodes.shape[1],
        "blocks": state.blocks,
        "coefficients": len(state.coefficients),
        "options": len(state.options),
    }
    numbers = "".join(f"{name}={number}, " for name, number in sizes.items())
    shape = f"Shape({numbers}certified={certified})"
    live = [state.place[named[f"live{b}.0"]] for b in range(state.blocks)]
    proofs = [f"prove{b}(w)" for b in range(len(programs.by_kind["prove"]))]
    functions = [
        *(f"@on_device\n{text}" for text in printed_sections(programs, state, PYTHON)),
        _function("predict", ["reach(w)", "given(w)"]),
        _function("correct", *map(_newton, range(state.blocks), live)),
        _function("correct_slowly", *map(_slowly, range(state.blocks), live)),
        _function("judge", proofs, ["agree(w)"]),
    ]
    kernels = _KERNELS.format(shape=shape, length=len(state.place))
    return "\n\n".join([_HEAD, *functions, kernels])


def _function(name: str, *parts: Sequence[str]) -> str:
    body = "\n".join(f"    {line}" for lines in parts for line in lines)
    return f"@on_device\ndef {name}(w):\n{body}\n"


def _newton(block: int, live: int) -> list[str]:
    """A block's Newton-Raphson steps."""
    return [f"begin{block}(w)", *_while_live(f"iterate{block}", live, STEPS - 1)]


def _slowly(block: int, live: int) -> list[str]:
    """Those from a guess, with small steps."""
    return [f"w[{live}] = 1.0", *_while_live(f"damped{block}", live, START_STEPS)]


def _while_live(function: str, live: int, most: int) -> list[str]:
    return [
        f"for _ in range({most}):",
        f"    if w[{live}] == 0.0:",
        "        break",
        f"    {function}(w)",
    ]


# ----------------------------------------------------------------------
# The march of one topology on a graphics card: designs in chunks, two of them under way.


_BLOCK = 128  # threads: with 255 registers each two blocks fit one multiprocessor
_STAGED = 256 << 20  # bytes of results that one chunk brings back


class DeviceKernel(SweepKernel):
    """Programs and registers for one loop table, run on a graphics card; see
    :class:`linkwork.families.march.sweep_kernel.SweepKernel` for its parameters.
    """

    #: ``begin`` and ``march``, to be indexed with a grid and called then.
    kernels: tuple[Any, ...] = ()
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
        if self.kernels:
            return
        self.card = graphics_card()
        self.state = ThreadState.of(self._sections, OPTIONS)
        source = device_source(self._sections, self.state, self.certified)
        self.kernels = load_compiled(source, "begin"), load_compiled(source, "march")

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
        count = len(start)
        begun = np.zeros(count, dtype=bool)
        if not count:
            return begun
        results = found._asdict() | {"begun": begun}
        chunks = self._room(len(rows), count)
        waiting: list[tuple[Chunk, slice]] = []
        for k, first in enumerate(range(0, count, chunks[0].designs)):
            chunk, part = chunks[k % 2], slice(first, min(first + chunks[0].designs, count))
            self.load(chunk, part, coefficients, guess, start, rows, steps)
            chunk.launch()
            chunk.send_back()
            waiting.append((chunk, part))
            if k:
                before, its_part = waiting.pop(0)
                before.collect(results, its_part)
        for chunk, part in waiting:
            chunk.collect(results, part)
        return begun

    def load(
        self,
        chunk: Chunk,
        part: slice,
        coefficients: Mapping[str, Array],
        guess: Array,
        start: Array,
        rows: Array,
        steps: Steps,
    ) -> None:
        """Fill a chunk with some designs; see :meth:`run`.

        Room that is left over is filled with guesses that lead nowhere.
        """
        given = self.guess_nodes(guess[:, part], start[part])
        count = given.shape[1]
        design = np.ones((len(self.state.coefficients), chunk.designs))
        nodes = np.full((len(given), chunk.designs), np.nan)
        for j, name in enumerate(self.state.coefficients):
            design[j, :count] = coefficients[name][part]
        nodes[:, :count] = given
        options = np.array([getattr(steps, name) for name in self.state.options])
        values = (design, nodes, np.ascontiguousarray(rows), steps.sizes, options)
        for array, value in zip(chunk.inputs.values(), values, strict=True):
            array.copy_to_device(value, stream=chunk.stream)

    def chunk(self, rows: int, designs: int) -> Chunk:
        """Room on the device for some designs over some rows."""
        return Chunk(self, rows, designs)

    def _room(self, rows: int, count: int) -> tuple[Chunk, ...]:
        """One chunk for all designs, or two equal ones that are used in turn."""
        each = 8 * (rows * (self.table.unknowns + 2) + len(self.state.coefficients))
        each += 8 * (6 * self.nodes.shape[1] + 4)
        free = self.card.current_context().get_memory_info().free
        free += sum(chunk.designs * each for chunk in self._chunks)
        parts = -(-count // max(1, int(min(_STAGED, free / 4) // each)))
        sizes = [(-(-count // parts), rows)] * min(parts, 2)
        if [(chunk.designs, chunk.rows) for chunk in self._chunks] != sizes:
            self._chunks = ()  # given back before more is asked for
            self._chunks = tuple(self.chunk(rows, designs) for designs, _ in sizes)
        return self._chunks


class Chunk:
    """Designs on a graphics card, and where their results are brought back to.

    Parameters
    ----------
    kernel : DeviceKernel
    rows, designs : int
        How many there is room for.

    Attributes
    ----------
    inputs : dict of device arrays
        ``design`` (C, M), ``given`` (S, M), ``rows`` (R,), ``steps`` (3,), ``options`` (O,).
    node : device array
        Where mechanisms start, (S, M).
    outputs, staged : dict
        Results by their names in :class:`MarchResult`, and which designs begin, on the device; in
        page-locked memory those that are brought back.
    """

    def __init__(self, kernel: DeviceKernel, rows: int, designs: int) -> None:
        card, state, size = kernel.card, kernel.state, kernel.nodes.shape[1]
        self.designs, self.rows = designs, rows
        self.kernels, self.stream = kernel.kernels, card.stream()
        inputs = {
            "design": (len(state.coefficients), designs),
            "given": (size, designs),
            "rows": (rows,),
            "steps": (3,),
            "options": (len(state.options),),
        }
        radii = rows if kernel.certified else 1  # unused, because nothing has no address
        outputs: dict[str, tuple[tuple[int, ...], type]] = {
            "unknowns": ((kernel.table.unknowns, rows, designs), np.float64),
            "radius": ((radii, designs), np.float64),
            "reached": ((rows, designs), np.bool_),
            "begun": ((designs,), np.bool_),
            "end": ((2, designs), np.float64),
            "last": ((2, 2 * size, designs), np.float64),
        }
        self.inputs = {name: card.device_array(own, np.float64) for name, own in inputs.items()}
        self.node = card.device_array((size, designs), np.float64)
        self.outputs = {name: card.device_array(*own) for name, own in outputs.items()}
        if not kernel.certified:
            del outputs["radius"]
        self.staged = {name: card.pinned_array(*own) for name, own in outputs.items()}

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
