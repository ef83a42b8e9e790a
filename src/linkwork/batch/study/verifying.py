"""Whether a store is as it was written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from linkwork.batch.study.chunk_manifest import read_entries
from linkwork.batch.study.store import check_is_store, damaged_metadata
from linkwork.foundation.paths import as_path

__all__ = ["Verification", "verify_store"]


@dataclass(frozen=True, kw_only=True)
class Verification:
    """The files of a store compared with their checksums.

    Parameters
    ----------
    sound : int
        Chunks that are as they were written.
    metadata : tuple of str
        Changed files that describe the store.
    chunks : Mapping[int, tuple of str]
        Changed files of damaged chunks.
    """

    sound: int
    metadata: tuple[str, ...]
    chunks: Mapping[int, tuple[str, ...]]

    @property
    def intact(self) -> bool:
        """Whether nothing has changed."""
        return not self.metadata and not self.chunks

    def to_dict(self) -> dict[str, Any]:
        """The result in JSON types."""
        return {"intact": self.intact, **asdict(self)}


def verify_store(store: Path | str) -> Verification:
    """Compare all files of a study's store with their checksums; nothing is changed.

    Raises
    ------
    InputError
        If it is not the store of a study.
    """
    path = as_path(store)
    check_is_store(path)
    sound, damaged = read_entries(path)
    return Verification(sound=len(sound), metadata=damaged_metadata(path), chunks=damaged)
