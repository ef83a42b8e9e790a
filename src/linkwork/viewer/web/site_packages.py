"""The packages of the engine in one archive: NumPy, Linkwork and what they need in a browser."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator, Mapping
from importlib import metadata, resources
from importlib.resources.abc import Traversable

__all__ = ["late_files", "site_packages"]

_EARLIEST = (1980, 1, 1, 0, 0, 0)  # of a ZIP archive
#: Data that only some visits need: files of their own, loaded when they are read.
_LATE = (
    "design/atlas/paths.npz",
    "design/precision/start_linkages.npz",
    "design/six_bars/start_six_bars.npz",
    "numerics/homotopy/start_sets.npz",
)
#: What a page never imports: commands, studies, and the front end (but for the pages
#: that it exports).
_UNUSED = (
    "batch/study",
    "cli",
    "design/atlas/stored_paths.py",
    "export/code",
    "kernels/gpu",
    "viewer/web",
    *(f"viewer/static/{name}.js" for name in ("live", "linkwork", "web", "web_worker", "widget")),
    "viewer/library.json",
    "__main__.py",
)
#: Parts of wheels that serve tests and compilers, or that a page never imports.
_TOOLS = (
    "tests",
    "testing",
    "f2py",
    "sboms",
    "conftest.py",
    "conftest.pyc",
    "RECORD",
)
_SOURCES = (".a", ".c", ".h", ".lib", ".pxd", ".pyi", ".pyx")


def site_packages(wheels: Mapping[str, bytes]) -> bytes:
    """An archive of all packages; the same files give the same bytes."""
    files = dict(_linkwork())
    for wheel in wheels.values():
        files |= _files_of(wheel)
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:  # not compressed: it is packed as a whole
        for name, data in sorted(files.items()):
            archive.writestr(zipfile.ZipInfo(name, _EARLIEST), data)
    return content.getvalue()


def late_files() -> dict[str, bytes]:
    """The files that are not in the archive, by their places in it."""
    package = resources.files("linkwork")
    return {f"linkwork/{name}": (package / name).read_bytes() for name in _LATE}


def _linkwork() -> Iterator[tuple[str, bytes]]:
    version = metadata.version("linkwork")
    head = f"Metadata-Version: 2.1\nName: linkwork\nVersion: {version}\n"
    yield f"linkwork-{version}.dist-info/METADATA", head.encode()
    for name, data in _walk(resources.files("linkwork"), ""):
        yield f"linkwork/{name}", data


def _walk(folder: Traversable, where: str) -> Iterator[tuple[str, bytes]]:
    for entry in folder.iterdir():
        name = f"{where}{entry.name}"
        if name in _UNUSED or name in _LATE or entry.name == "__pycache__":
            continue
        if entry.is_dir():
            yield from _walk(entry, f"{name}/")
        else:
            yield name, entry.read_bytes()


def _files_of(wheel: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(wheel)) as archive:
        return {
            name: archive.read(name)
            for name in archive.namelist()
            if not name.endswith(("/", *_SOURCES)) and not {*_TOOLS} & {*name.split("/")}
        }
