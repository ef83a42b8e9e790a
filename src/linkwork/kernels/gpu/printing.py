"""Programs written out for a graphics card: functions of a thread's state, and two kernels."""

from __future__ import annotations

from collections.abc import Sequence

from linkwork.kernels.march.march_programs import MarchPrograms
from linkwork.kernels.march.printed_sections import ThreadState, printed_sections
from linkwork.kernels.march.step_control import START_STEPS, STEPS
from linkwork.kernels.program.languages import PYTHON

__all__ = ["device_source"]

_HEAD = """\
import math

from linkwork.kernels.gpu import march as device_march
from linkwork.kernels.gpu.march import cuda, kernel, on_device, sin_cos
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
    unknowns, size = programs.registers.named["d0.0"], programs.nodes.shape[1]
    shape = (
        f"Shape(unknowns={unknowns}, size={size}, blocks={state.blocks}, "
        f"coefficients={len(state.coefficients)}, options={len(state.options)}, "
        f"certified={certified})"
    )
    live = [state.place[programs.registers.named[f"live{b}.0"]] for b in range(state.blocks)]
    functions = [
        *(f"@on_device\n{text}" for text in printed_sections(programs, state, PYTHON)),
        _function("predict", ["reach(w)", "given(w)"]),
        _function("correct", *map(_newton, range(state.blocks), live)),
        _function("correct_slowly", *map(_slowly, range(state.blocks), live)),
        _function("judge", [f"prove{b}(w)" for b in range(len(programs.prove))], ["agree(w)"]),
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
