"""An atlas of the paths that studies have stored."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import BoolArray, ComplexArray
from linkwork.core.foundation.errors import InputError
from linkwork.families.study.store import attributes_of, chunks_with_record, read_chunks
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
    whole, done = sum(len(chunks_with_record(path)) for path in stores), 0

    def tell() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done / whole)

    unfinished = []
    families = []
    for path, attributes in zip(stores, known, strict=True):
        family, stored = _family_of_store(path, attributes, tell)
        families.append(family)
        count = attributes["linkwork_identity"]["count"]
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


def _family_of_store(
    path: Path, attributes: Mapping[str, Any], tell: Callable[[], None]
) -> tuple[AtlasFamily, int]:
    """The paths of a store, and the number of its designs."""
    known = attributes["linkwork_identity"]
    (point,) = _points(known["keep"])
    varied = known["varied"]
    constants = {name: x for name, x in known["dimensions"].items() if name not in varied}
    names = (*varied, *constants)
    numbers = [np.zeros((0, len(names)), dtype=np.float32)]
    shapes = [np.zeros((0, 32), dtype=np.float16)]
    stored = damaged = 0
    for chunk in read_chunks(path):
        tell()
        damaged += bool(chunk.changed)
        if damaged:
            continue
        stored += len(chunk.designs)
        arrays = chunk.arrays
        z = arrays[f"{point}.x"] + 1j * arrays[f"{point}.y"]
        good = arrays["passed"] & _are_closed(z)
        shape = coefficients(z[good][:, :-1])[0]
        columns = {name: arrays[name][good] for name in varied} | constants
        values = np.stack(np.broadcast_arrays(*columns.values()), axis=1)
        there = np.isfinite(shape).all(axis=1)
        # chunk by chunk in the precision that is kept: a million designs fit in little memory
        numbers.append(values[there].astype(np.float32))
        shapes.append(np.ascontiguousarray(shape[there]).view(float).astype(np.float16))
    if damaged:
        raise InputError(
            f'damaged chunks of "{path}": {damaged}; repeat the command of its study, '
            "which computes them again"
        )
    lengths = np.concatenate(numbers)
    if not len(lengths):
        raise InputError(f'"{path}" has no closed path: keep it over a whole turn of the crank')
    family = AtlasFamily(
        title=attributes["mechanism_name"],
        mechanism=known["mechanism"],
        point=point,
        names=names,
        numbers=lengths,
        shapes=np.concatenate(shapes),
    )
    return family, stored


def _are_closed(z: ComplexArray) -> BoolArray:
    """Whether paths (D, N) end where they begin; false where rows are missing."""
    size = np.abs(z - z[:, :1]).max(axis=1)
    return np.asarray(np.abs(z[:, -1] - z[:, 0]) <= _CLOSED * size)
