"""An atlas of the paths that studies have stored."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from linkwork.batch.study.chunk_manifest import read_entries
from linkwork.batch.study.store import attributes_of
from linkwork.batch.study.zarr_files import check_packages, open_arrays
from linkwork.design.atlas.path_atlas import AtlasFamily, PathAtlas
from linkwork.design.atlas.path_shape import coefficients
from linkwork.foundation.arrays import BoolArray, ComplexArray
from linkwork.foundation.errors import InputError

__all__ = ["atlas_of_stores"]

_CLOSED = 1e-6  # of the path's size: the first and last row are one position


def atlas_of_stores(stores: Sequence[Path]) -> PathAtlas:
    """The atlas of studies that keep the path of a point over a whole turn.

    Raises
    ------
    InputError
        If a store keeps no path, or has no closed path.
    """
    check_packages()
    return PathAtlas(families=tuple(map(_family_of_store, stores)))


def _family_of_store(path: Path) -> AtlasFamily:
    attributes = attributes_of(path)
    known = attributes["linkwork_identity"]
    arrays = open_arrays(path)
    kept = known["keep"]
    points = [name[:-2] for name in kept if name.endswith(".x") and f"{name[:-2]}.y" in kept]
    if len(points) != 1:
        raise InputError(
            f'"{path}" keeps the paths of {len(points)} points: an atlas needs one, e.g. '
            'keep = ["P.x", "P.y"] in the plan'
        )
    names = tuple(name for name, _ in known["dimensions"] if arrays[name].ndim == 1)
    numbers, shapes = [np.zeros((0, len(names)))], [np.zeros((0, 32))]
    for _, entry in sorted(read_entries(path)[0].items()):
        part = slice(entry.start, entry.stop)
        z = arrays[f"{points[0]}.x"][part] + 1j * arrays[f"{points[0]}.y"][part]
        good = arrays["passed"][part] & _are_closed(z)
        own = coefficients(z[good][:, :-1])[0]
        values = np.stack([arrays[name][part][good] for name in names], axis=1)
        there = np.isfinite(own).all(axis=1)
        numbers.append(values[there])
        shapes.append(np.ascontiguousarray(own[there]).view(float))
    found = np.concatenate(numbers).astype(np.float32)
    if not len(found):
        raise InputError(f'"{path}" has no closed path: keep it over a whole turn of the crank')
    return AtlasFamily(
        title=attributes["mechanism_name"],
        mechanism=known["mechanism"],
        point=points[0],
        names=names,
        numbers=found,
        shapes=np.concatenate(shapes).astype(np.float16),
    )


def _are_closed(z: ComplexArray) -> BoolArray:
    """Whether paths (D, N) end where they begin; false where rows are missing."""
    size = np.abs(z - z[:, :1]).max(axis=1)
    return np.asarray(np.abs(z[:, -1] - z[:, 0]) <= _CLOSED * size)
