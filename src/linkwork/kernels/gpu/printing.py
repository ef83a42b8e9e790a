"""Programs written out for a graphics card: functions of a thread's state, and two kernels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from linkwork.kernels.march.march_programs import WEIGHTS, MarchPrograms
from linkwork.kernels.march.step_control import START_STEPS, STEPS
from linkwork.kernels.program.printing import Body
from linkwork.kernels.program.program import Program

__all__ = ["ThreadState", "device_source"]

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


@dataclass(frozen=True, kw_only=True)
class ThreadState:
    """Which registers a thread keeps, and where; as :mod:`device_march` says.

    Parameters
    ----------
    place : Mapping[int, int]
        By register.
    coefficients, options : tuple of str
        Names of registers that are filled before a program runs.
    blocks : int
    """

    place: Mapping[int, int]
    coefficients: tuple[str, ...]
    options: tuple[str, ...]
    blocks: int

    @classmethod
    def of(cls, programs: MarchPrograms, options: Sequence[str]) -> ThreadState:
        """The state that the programs of a topology need; ``options``: names that may be read."""
        named, blocks = programs.registers.named, len(programs.begin)
        own = {*programs.nodes.ravel().tolist(), *(named[name] for name in programs.noted)}
        noted = ["good.0", "radius.0", *(f"live{b}.0" for b in range(blocks))]
        more = [name for name in programs.noted if name not in noted]
        given = [name for name in named if named[name] not in own and name not in WEIGHTS]
        coefficients = tuple(name for name in given if name not in options)
        used = tuple(name for name in options if name in named)
        order = [named[name] for name in (*WEIGHTS, *noted, *coefficients, *used, *more)]
        order = [*programs.nodes.ravel().tolist(), *order]
        place = {register: k for k, register in enumerate(order)}
        return cls(place=place, coefficients=coefficients, options=used, blocks=blocks)


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
    named = {"reach": programs.predict, "given": programs.given, "agree": programs.judge}
    for kind in ("begin", "damped", "iterate", "prove"):
        named |= {f"{kind}{b}": program for b, program in enumerate(getattr(programs, kind))}
    constants = {register: value for value, register in programs.registers.constants.items()}
    live = [state.place[programs.registers.named[f"live{b}.0"]] for b in range(state.blocks)]
    functions = [
        *(_section(name, program, state, constants) for name, program in named.items()),
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


def _section(
    name: str, program: Program, state: ThreadState, constants: Mapping[int, float]
) -> str:
    body = Body(lambda register: f"w[{state.place[register]}]", constants)
    body.add(program.code)
    body.end(state.place.keys())
    return _function(name, body.lines)


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
