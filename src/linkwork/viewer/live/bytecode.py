"""Archives of the engine with the bytecode of its modules, for the next start of a page.

A browser compiles a thousand Python modules at every start, which takes half of it. The modules in
use are therefore added in compiled form to copies of the archives that they came from; a page keeps
the copies for its next visit.
"""

from __future__ import annotations

import marshal
import shutil
import sys
import zipfile
from collections.abc import Iterator
from importlib.util import MAGIC_NUMBER, cache_from_source
from pathlib import Path
from types import ModuleType

__all__ = ["with_bytecode"]

#: Of a compiled module that is never compared with its source (PEP 552).
_UNCHECKED = (1).to_bytes(4, "little") + bytes(8)
_EARLIEST = (1980, 1, 1, 0, 0, 0)  # of a ZIP archive


def with_bytecode(archive: Path, root: Path, target: Path) -> Iterator[None]:
    """Write a copy of an archive with bytecode, one module at each step.

    Parameters
    ----------
    archive : Path
        An archive of packages.
    root : Path
        Where its modules have been loaded from: a folder into which it was unpacked, or the archive
        itself.
    target : Path
        The copy.
    """
    shutil.copyfile(archive, target)
    with zipfile.ZipFile(target, "a") as copy:
        for name, module in list(sys.modules.items()):
            place, content = _compiled(name, module, root)
            if content:
                copy.writestr(zipfile.ZipInfo(place, _EARLIEST), content)
                yield


def _compiled(name: str, module: ModuleType, root: Path) -> tuple[str, bytes]:
    """The place of a compiled module in the archive, and its content; "" if it is not of it."""
    spec = getattr(module, "__spec__", None)
    origin = getattr(spec, "origin", None)
    get_code = getattr(getattr(spec, "loader", None), "get_code", None)
    if spec is None or spec.name != name or not origin or not origin.endswith(".py"):
        return "", b""
    if not Path(origin).is_relative_to(root) or get_code is None:
        return "", b""
    # an archive is searched for compiled modules next to their sources, a folder in __pycache__
    compiled = f"{origin}c" if root.is_file() else cache_from_source(origin)
    content = MAGIC_NUMBER + _UNCHECKED + marshal.dumps(get_code(name))
    return Path(compiled).relative_to(root).as_posix(), content
