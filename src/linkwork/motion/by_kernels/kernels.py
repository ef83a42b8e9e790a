"""The kernels of mechanisms, each made once; this module loads compiled code."""

from __future__ import annotations

from weakref import WeakKeyDictionary

from linkwork.equations.compiling import Compiled
from linkwork.kernels.gpu.kernel import DeviceKernel
from linkwork.kernels.march.rate_programs import PlaceProgram, row_program
from linkwork.kernels.march.sweep_kernel import SweepKernel
from linkwork.motion.by_kernels.equations import block_parts, lines_of_lengths
from linkwork.motion.model import Model

__all__ = ["kernel_of", "row_program_of"]

#: Kernels and programs of mechanisms that are in use.
_KERNELS: WeakKeyDictionary[Compiled, dict[tuple[frozenset[str], bool, str], SweepKernel]] = (
    WeakKeyDictionary()
)
_ROW_PROGRAMS: WeakKeyDictionary[Compiled, dict[tuple[frozenset[str], bool], PlaceProgram]] = (
    WeakKeyDictionary()
)


def kernel_of(
    model: Model, zeros: frozenset[str], certify: bool, device: str = "cpu"
) -> SweepKernel:
    """The kernel of a mechanism's equations, made once.

    Parameters
    ----------
    zeros : frozenset of str
        Coefficients that are zero, by register.
    """
    known, key = _KERNELS.setdefault(model.compiled, {}), (zeros, certify, device)
    if key not in known:
        kind = DeviceKernel if device == "gpu" else SweepKernel
        known[key] = kind(model.compiled.table, block_parts(model), zeros, certify)
    return known[key]


def row_program_of(model: Model, zeros: frozenset[str], certify: bool) -> PlaceProgram:
    """The program that computes rates and evidence of a mechanism's rows, made once."""
    known, key = _ROW_PROGRAMS.setdefault(model.compiled, {}), (zeros, certify)
    if key not in known:
        table, parts = model.compiled.table, block_parts(model)
        lengths = lines_of_lengths(model)
        known[key] = row_program(table, parts, lengths, zeros, certified=certify)
    return known[key]
