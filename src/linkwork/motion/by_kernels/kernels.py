"""The kernels of topologies, each made once; this module loads compiled code."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from functools import lru_cache

from linkwork.kernels.gpu.kernel import DeviceKernel
from linkwork.kernels.march.rate_programs import PlaceProgram, row_program
from linkwork.kernels.march.sweep_kernel import SweepKernel
from linkwork.motion.by_kernels.equations import block_parts, lines_of_lengths
from linkwork.motion.model import Model

__all__ = ["kernel_of", "row_program_of"]

_KEPT = 128  # kernels; one takes a hundredth of a second to make, and some 100 kB


@dataclass(frozen=True)
class _Topology:
    """A mechanism as all with the same ``key`` are: their equations differ in numbers only.

    ``zeros``: coefficients that are zero, by register.
    """

    key: Hashable
    zeros: frozenset[str]
    model: Model = field(compare=False)

    @classmethod
    def of(cls, model: Model, zeros: frozenset[str]) -> _Topology:
        blocks = tuple((tuple(p.equations), p.unknowns) for p in block_parts(model))
        lengths = tuple(sorted(lines_of_lengths(model)))
        return cls((model.compiled.table.structure, blocks, lengths), zeros, model)


def kernel_of(
    model: Model, zeros: frozenset[str], certify: bool, device: str = "cpu"
) -> SweepKernel:
    """The kernel of a mechanism's topology.

    Parameters
    ----------
    zeros : frozenset of str
        Coefficients that are zero, by register.
    """
    return _kernel(_Topology.of(model, zeros), certify, device)


def row_program_of(model: Model, zeros: frozenset[str], certify: bool) -> PlaceProgram:
    """The program that computes rates and evidence of the rows of a mechanism's topology."""
    return _row_program(_Topology.of(model, zeros), certify)


@lru_cache(maxsize=_KEPT)
def _kernel(topology: _Topology, certify: bool, device: str) -> SweepKernel:
    kind = DeviceKernel if device == "gpu" else SweepKernel
    model = topology.model
    return kind(model.compiled.table, block_parts(model), topology.zeros, certify)


@lru_cache(maxsize=_KEPT)
def _row_program(topology: _Topology, certify: bool) -> PlaceProgram:
    model = topology.model
    table, parts = model.compiled.table, block_parts(model)
    return row_program(table, parts, lines_of_lengths(model), topology.zeros, certified=certify)
