"""An atlas of the paths that studies have stored."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import BoolArray, ComplexArray
from linkwork.core.foundation.errors import InputError
from linkwork.families.study.store import StoredChunk, attributes_of, open_arrays, read_chunks
from linkwork.synthesis.atlas.path_atlas import AtlasFamily, PathAtlas, coefficients

_CLOSED = 1e-6  # of the path's size: the first and last row are one position


def atlas_of_stores(
    stores: Sequence[Path], progress: Callable[[float], None] | None = None
) -> PathAtlas:
    """The atlas of studies that keep the path of a point over a whole turn.

    A store that is named twice counts once. ``progress``: called with the finished fraction; may
    raise an error to end the work.

    Raises
    ------
    InputError
        If a store is damaged, keeps no path, or has no closed path.
    """
    stores = [*{path.resolve(): path for path in stores}.values()]  # each of them once
    # wrong stores are refused before the first one is read
    known = [_checked(path) for path in stores]
    entries = [_entries(path) for path in stores]
    whole, done = sum(map(len, entries)), 0

    def tell() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done / whole)

    unfinished = []
    families = []
    for path, attributes, own in zip(stores, known, entries, strict=True):
        families.append(_family_of_store(path, attributes, own, tell))
        stored = sum(entry.stop - entry.start for entry in own)
        count = open_arrays(path)["passed"].shape[0]
        if stored < count:
            unfinished.append(f'"{path}" has {stored} of {count} designs: its study is unfinished')
    return PathAtlas(families=tuple(families), unfinished=tuple(unfinished))


def _checked(path: Path) -> Mapping[str, Any]:
    """The attributes of a store with the path of one point."""
    attributes = attributes_of(path)
    kept = attributes["linkwork_identity"]["keep"]
    count = len(_points(kept))
    if count != 1:
        raise InputError(
            f'"{path}" keeps the paths of {count} points: an atlas needs one, e.g. '
            'keep = ["P.x", "P.y"] in the plan'
        )
    return attributes


def _points(kept: Sequence[str]) -> list[str]:
    return [name[:-2] for name in kept if name.endswith(".x") and f"{name[:-2]}.y" in kept]


def _entries(path: Path) -> list[StoredChunk]:
    """The finished chunks of a store, in order."""
    sound, damaged = read_chunks(path)
    if damaged:
        raise InputError(
            f'damaged chunks of "{path}": {len(damaged)}; repeat the command of its study, '
            "which computes them again"
        )
    return [entry for _, entry in sorted(sound.items())]


def _family_of_store(
    path: Path,
    attributes: Mapping[str, Any],
    entries: Sequence[StoredChunk],
    tell: Callable[[], None],
) -> AtlasFamily:
    known = attributes["linkwork_identity"]
    arrays = open_arrays(path)
    (point,) = _points(known["keep"])
    names = tuple(known["varied"])
    numbers = [np.zeros((0, len(names)), dtype=np.float32)]
    shapes = [np.zeros((0, 32), dtype=np.float16)]
    for entry in entries:
        part = slice(entry.start, entry.stop)
        z = arrays[f"{point}.x"][part] + 1j * arrays[f"{point}.y"][part]
        good = arrays["passed"][part] & _are_closed(z)
        own = coefficients(z[good][:, :-1])[0]
        values = np.stack([arrays[name][part][good] for name in names], axis=1)
        there = np.isfinite(own).all(axis=1)
        # chunk by chunk in the precision that is kept: a million designs fit in little memory
        numbers.append(values[there].astype(np.float32))
        shapes.append(np.ascontiguousarray(own[there]).view(float).astype(np.float16))
        tell()
    found = np.concatenate(numbers)
    if not len(found):
        raise InputError(f'"{path}" has no closed path: keep it over a whole turn of the crank')
    return AtlasFamily(
        title=attributes["mechanism_name"],
        mechanism=known["mechanism"],
        point=point,
        names=names,
        numbers=found,
        shapes=np.concatenate(shapes),
    )


def _are_closed(z: ComplexArray) -> BoolArray:
    """Whether paths (D, N) end where they begin; false where rows are missing."""
    size = np.abs(z - z[:, :1]).max(axis=1)
    return np.asarray(np.abs(z[:, -1] - z[:, 0]) <= _CLOSED * size)
