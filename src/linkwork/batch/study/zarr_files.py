"""Arrays as files of a Zarr store; the only module that uses zarr.

Files are created in memory and written by :mod:`~linkwork.batch.study.store`, each completely or
not at all.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from linkwork.batch.study.study import DESIGN, Variable
from linkwork.foundation.arrays import AnyArray

__all__ = ["LEDGER", "METADATA", "ZarrFiles", "open_arrays"]

#: The group that lists finished chunks.
LEDGER = "ledger"
#: The file that describes the whole store, or one array in its folder.
METADATA = "zarr.json"


class ZarrFiles:
    """The files of a store, created in memory.

    Parameters
    ----------
    variables : iterable of Variable
    sizes : Mapping[str, int]
        Length of every axis.
    chunk : int
        Designs per file.
    attributes : Mapping
        Attributes of the store.
    """

    def __init__(
        self,
        variables: Iterable[Variable],
        sizes: Mapping[str, int],
        chunk: int,
        attributes: Mapping[str, Any],
    ) -> None:
        import zarr
        from zarr.codecs import ZstdCodec
        from zarr.storage import MemoryStore

        self._files: dict[str, Any] = {}
        store = MemoryStore(self._files)
        group = zarr.open_group(store, mode="w", zarr_format=3, attributes=dict(attributes))
        group.create_group(LEDGER)
        self._arrays: dict[str, Any] = {}
        for variable in variables:
            array = group.create_array(
                variable.name,
                shape=tuple(sizes[axis] for axis in variable.axes),
                chunks=tuple(chunk if axis == DESIGN else sizes[axis] for axis in variable.axes),
                dtype=variable.dtype,
                fill_value=variable.fill,
                dimension_names=variable.axes,
                attributes=dict(variable.attributes),
                compressors=ZstdCodec(level=3),
            )
            if variable.values is not None:
                array[:] = variable.values
            self._arrays[variable.name] = array
        with warnings.catch_warnings():
            # used by xarray; other readers read the metadata of each array
            warnings.filterwarnings("ignore", message="Consolidated metadata")
            zarr.consolidate_metadata(store)
        #: Path and content of the files that exist before any computation.
        self.first = {path: buffer.to_bytes() for path, buffer in self._files.items()}

    def encoded(self, designs: range, arrays: Mapping[str, AnyArray]) -> dict[str, bytes]:
        """Path and content of the files that hold a chunk's arrays."""
        for name, values in arrays.items():
            self._arrays[name][designs.start : designs.stop] = values
        made = [path for path in self._files if path not in self.first]
        return {path: self._files.pop(path).to_bytes() for path in made}


def open_arrays(path: Path) -> Any:
    """The arrays of a store for reading, as a zarr group."""
    import zarr

    return zarr.open_group(str(path), mode="r")
