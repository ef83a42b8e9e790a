"""Solved random members of families of systems, kept on disk: shipped ones, and the user's own.

A random member takes up to a minute to be solved and depends on the topology only. The solutions
that are read are polished again, so that no file is trusted with a number.
"""

from __future__ import annotations

import hashlib
import zipfile
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from linkwork.foundation.arrays import AnyArray, ComplexArray
from linkwork.foundation.cache_folder import cache_folder, keep_arrays
from linkwork.numerics.homotopy.topology import Topology

__all__ = ["SHIPPED", "StartSet", "name_of", "own_sets", "read_sets", "write_set"]

#: The sets of the library and of common topologies; made by ``scripts/start_sets``.
SHIPPED = Path(__file__).with_name("start_sets.npz")
_VERSION = 1  # of the random members and of the data stored of them


@dataclass(frozen=True, kw_only=True, eq=False)
class StartSet:
    """A random member of a topology's family, ``left`` and ``right``, with its solutions ``x``.

    ``sure``: whether these are confirmed to be all.
    """

    topology: Topology
    left: ComplexArray
    right: ComplexArray
    x: ComplexArray
    sure: bool

    def as_arrays(self) -> dict[str, AnyArray]:
        """The set as arrays; the solutions in single precision, because readers polish them."""
        return {
            "topology": np.array(self.topology.as_text()),
            "left": self.left,
            "right": self.right,
            "x": self.x.astype(np.complex64),
            "sure": np.array(self.sure),
        }

    @classmethod
    def of_arrays(cls, arrays: dict[str, AnyArray]) -> StartSet:
        """The set of :meth:`as_arrays`.

        Raises
        ------
        KeyError, TypeError, ValueError
            If these are no arrays of a set.
        """
        left, right, x = (np.asarray(arrays[n], dtype=complex) for n in ("left", "right", "x"))
        topology = Topology.of_text(str(arrays["topology"]))
        shape = len(topology.columns[0]), len(topology.columns)
        width = 2 * (topology.unknowns + topology.own)
        if left.shape != shape or right.shape != shape or (len(x) and x.shape[1:] != (width,)):
            raise ValueError("closures and solutions do not have the shapes of the topology")
        return cls(topology=topology, left=left, right=right, x=x, sure=bool(arrays["sure"]))


def read_sets(topology: Topology) -> Iterator[StartSet]:
    """The sets of families that may be this one in different order; this one's own set first."""
    own, signature = name_of(topology), topology.signature
    for path in (SHIPPED, *own_sets(signature)):
        # a file that cannot be read is no set: it is computed, and written again
        with suppress(OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile):
            with path.open("rb") as file, np.load(file) as stored:
                names = {name.rpartition(".")[0] for name in stored.files}
                near = sorted((n for n in names if n.startswith(signature)), key=own.__ne__)
                found = [
                    {field: stored[f"{name}.{field}"] for field in StartSet.__annotations__}
                    for name in near
                ]
            yield from map(StartSet.of_arrays, found)


def own_sets(signature: str = "") -> list[Path]:
    """The files of the user's cache whose names begin so."""
    return sorted(_folder().glob(f"{signature}*.npz"))


def write_set(kept: StartSet) -> None:
    """Keep a set in the user's cache, whole or not at all; nothing where that is not possible."""
    name = name_of(kept.topology)
    arrays = {f"{name}.{field}": array for field, array in kept.as_arrays().items()}
    keep_arrays(_folder() / f"{name}.npz", arrays)


def name_of(topology: Topology) -> str:
    """The name of a topology's set: its signature, and a digest of the order of its unknowns."""
    digest = hashlib.sha256(f"{_VERSION} {topology.as_text()}".encode()).hexdigest()[:12]
    return f"{topology.signature}-{digest}"


def _folder() -> Path:
    return cache_folder("start_sets")
