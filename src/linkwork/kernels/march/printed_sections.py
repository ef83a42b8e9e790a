"""The programs of a march printed as functions of one mechanism's state, in any language."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

from linkwork.kernels.march.march_programs import WEIGHTS, MarchPrograms
from linkwork.kernels.program.languages import Language
from linkwork.kernels.program.printing import Body

__all__ = ["ThreadState", "printed_sections"]


@dataclass(frozen=True, kw_only=True)
class ThreadState:
    """The registers that a march keeps, laid out as in :class:`linkwork.kernels.gpu.march.Shape`.

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
    def of(
        cls, programs: MarchPrograms, options: Sequence[str], fixed: Collection[str] = ()
    ) -> ThreadState:
        """The state that the programs of a topology need; ``options``: names that may be read,
        ``fixed``: coefficients that are written as numbers.
        """
        named, blocks = programs.registers.named, len(programs.begin)
        own = {*programs.nodes.ravel().tolist(), *(named[name] for name in programs.noted)}
        noted = ["good.0", "radius.0", *(f"live{b}.0" for b in range(blocks))]
        more = [name for name in programs.noted if name not in noted]
        known = {*WEIGHTS, *fixed}
        given = [name for name in named if named[name] not in own and name not in known]
        coefficients = tuple(name for name in given if name not in options)
        used = tuple(name for name in options if name in named)
        order = [named[name] for name in (*WEIGHTS, *noted, *coefficients, *used, *more)]
        order = [*programs.nodes.ravel().tolist(), *order]
        place = {register: k for k, register in enumerate(order)}
        return cls(place=place, coefficients=coefficients, options=used, blocks=blocks)


def printed_sections(
    programs: MarchPrograms,
    state: ThreadState,
    language: Language,
    fixed: Mapping[str, float] | None = None,
) -> Iterator[str]:
    """Functions ``reach``, ``given``, ``agree``, and ``begin``, ``damped``, ``iterate``, ``prove``
    of each block, of the state ``w``.

    Parameters
    ----------
    fixed : Mapping[str, float], optional
        Coefficients that are written as numbers.
    """
    named = {"reach": programs.predict, "given": programs.given, "agree": programs.judge}
    for kind in ("begin", "damped", "iterate", "prove"):
        named |= {f"{kind}{b}": program for b, program in enumerate(getattr(programs, kind))}
    registers = programs.registers
    constants = {register: value for value, register in registers.constants.items()}
    constants |= {
        registers.named[name]: value
        for name, value in (fixed or {}).items()
        if name in registers.named
    }
    for name, program in named.items():
        body = Body(lambda register: f"w[{state.place[register]}]", constants, language)
        body.add(program.code)
        body.end(state.place.keys())
        yield language.written(name, ["w"], body.lines)
