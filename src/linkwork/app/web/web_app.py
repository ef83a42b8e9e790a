"""The files of Pyodide and its packages: read or downloaded, and compared with known hashes."""

from __future__ import annotations

import base64
import gzip
import hashlib
import html
import io
import json
import zipfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import metadata, resources
from importlib.resources.abc import Traversable
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

from linkwork.app.live.server import library_json
from linkwork.core.foundation.errors import InputError

#: The packages among the files.
PACKAGES = ("numpy", "tomlkit", "platformdirs")
_FOLDER_LOCK = "lock.json"  # in a folder: hashes of files that are not the official ones
_PATIENCE = 60.0  # without an answer [s]
_LARGEST = 50_000_000  # bytes of one file

#: Receives the fraction done.
Progress = Callable[[float], None]


@dataclass(frozen=True)
class LockedFile:
    """A file, its address, and the hash of its content."""

    file: str
    url: str
    sha256: str


@dataclass(frozen=True, kw_only=True)
class PyodideFiles:
    """Contents by name, and the names of those that are not the official files."""

    contents: Mapping[str, bytes]
    unofficial: tuple[str, ...]


def pyodide_files(folder: Path | None = None, progress: Progress | None = None) -> PyodideFiles:
    """All files, compared with their hashes.

    Parameters
    ----------
    folder : Path, optional
        A folder that contains the files; without it they are downloaded. A file ``lock.json`` there
        (``{"numpy": {"file": …, "sha256": …}}``) replaces files, for tests.
    progress : callable, optional

    Raises
    ------
    InputError
        If a file is missing, cannot be downloaded, or has another hash.
    """
    official = _official()
    locked = official if folder is None else {**official, **_lock_of_folder(folder)}
    contents = {}
    for k, (name, file) in enumerate(locked.items()):
        content = _downloaded(file) if folder is None else _read_file(folder, file)
        _check_hash(file, content)
        contents[name] = content
        if progress is not None:
            progress((k + 1) / len(locked))
    unofficial = tuple(name for name in locked if locked[name].sha256 != official[name].sha256)
    return PyodideFiles(contents=contents, unofficial=unofficial)


@cache
def _official() -> Mapping[str, LockedFile]:
    text = (resources.files("linkwork.app.web") / "official.json").read_text("utf-8")
    return {name: LockedFile(**entry) for name, entry in json.loads(text).items()}


def _lock_of_folder(folder: Path) -> dict[str, LockedFile]:
    """Files named by the lock file of a folder, if it has one."""
    path = folder / _FOLDER_LOCK
    if not path.exists():
        return {}
    try:
        entries = json.loads(path.read_text("utf-8"))
        locked = {
            name: LockedFile(file=str(entry["file"]), url="", sha256=str(entry["sha256"]))
            for name, entry in entries.items()
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            f'"{path}" is not a lock file ({type(error).__name__}: {error}): write '
            '{"numpy": {"file": "…", "sha256": "…"}}, or remove it to use the official files'
        ) from None
    for name in locked:
        if name not in _official():
            raise InputError(f'"{path}": "{name}" is not one of {", ".join(_official())}')
    return locked


def _read_file(folder: Path, file: LockedFile) -> bytes:
    try:
        return (folder / file.file).read_bytes()
    except OSError as error:
        raise InputError(
            f'cannot read "{folder / file.file}": {error.strerror or error}; '
            f"get it{_source(file) or ', or mend the lock file'}"
        ) from None


def _downloaded(file: LockedFile) -> bytes:
    try:
        with urlopen(file.url, timeout=_PATIENCE) as answer:
            content: bytes = answer.read(_LARGEST)
    except (URLError, OSError) as error:
        reason = getattr(error, "reason", None) or error
        raise InputError(
            f"cannot download {file.url}: {reason}; without a network, put this file and the "
            "others into a folder and name it: --pyodide FOLDER"
        ) from None
    return content


def _check_hash(file: LockedFile, content: bytes) -> None:
    digest = hashlib.sha256(content).hexdigest()
    if digest != file.sha256:
        raise InputError(
            f'"{file.file}" is not the expected file: its SHA-256 is {digest}, and {file.sha256} '
            f"was expected; get it again{_source(file)}"
        )


def _source(file: LockedFile) -> str:
    return f" from {file.url}" if file.url else ""


# ----------------------------------------------------------------------
# The packages of the engine in one archive: NumPy, Linkwork and what they need in a browser.


_EARLIEST = (1980, 1, 1, 0, 0, 0)  # of a ZIP archive
#: Data that only some visits need: separate files, loaded when they are read.
_LATE = (
    "circuits/homotopy/start_sets.npz",
    "synthesis/atlas/paths.npz",
    "synthesis/precision/start_linkages.npz",
    "synthesis/six_bars/start_six_bars.npz",
)
#: What a page never imports: commands, studies, and the front end (but for the pages
#: that it exports).
_UNUSED = (
    "app/web",
    "core/commands",
    "families/gpu",
    "families/study",
    "writers/code",
    *(f"app/static/{name}.js" for name in ("live", "linkwork", "web", "web_worker", "widget")),
    "app/library.json",
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
        if name in _UNUSED or name in _LATE or entry.name in ("__pycache__", "commands.py"):
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


# ----------------------------------------------------------------------
# The files of the page that solves in the browser alone: a folder for a host, or one HTML file.


#: Begins the name of the generator in every page; marks our pages.
MARK = '<meta name="generator" content="Linkwork web'
_SINGLE = "linkwork.html"  # in a folder: for disks and frames, where nothing can be fetched
_CACHED = 12  # digits of a build in the names of caches


def web_folder(pyodide: PyodideFiles) -> dict[str, bytes]:
    """The files of a folder by their paths, for any host of static files.

    ``index.html`` loads the engine from ``engine/`` and keeps it for visits without a network.
    Where it cannot load files (from a disk, in a sandboxed frame) it gives way to the one file that
    :func:`web_page` makes.
    """
    engine = _engine(pyodide)
    build = _build(engine)
    late = late_files()
    places = {name: f"engine/{name.rpartition('/')[2]}.bin" for name in (*engine, *late)}
    files = engine | late
    urls = {name: f"{place}?{_digest(files[name])}" for name, place in places.items()}
    offline = f'const LINKWORK_BUILD="{build}";{_static("web_offline.js")}'
    return {
        **{place: files[name] for name, place in places.items()},
        _SINGLE: _page(pyodide, engine, late, {}),
        "sw.js": offline.encode(),
        "index.html": _page(pyodide, engine, late, urls),
    }


def web_page(pyodide: PyodideFiles) -> bytes:
    """One HTML file that loads no other."""
    return _page(pyodide, _engine(pyodide), late_files(), {})


def _engine(pyodide: PyodideFiles) -> dict[str, bytes]:
    """The files of the engine by name, packed where that makes them smaller."""
    files = pyodide.contents
    scripts = [files["pyodide.asm.js"].decode(), files["pyodide.js"].decode()]
    worker = "\n".join([*map(_without_map, scripts), _static("web_worker.js")])
    return {
        "worker.js": _packed(worker.encode()),
        "pyodide.asm.wasm": _packed(files["pyodide.asm.wasm"]),
        "python_stdlib.zip": files["python_stdlib.zip"],
        "site.zip": _packed(site_packages({name: files[name] for name in PACKAGES})),
    }


def _page(
    pyodide: PyodideFiles,
    engine: Mapping[str, bytes],
    late: Mapping[str, bytes],
    urls: Mapping[str, str],
) -> bytes:
    """The HTML file; it contains the files of the engine that have no URL."""

    def listed(files: Mapping[str, bytes]) -> list[dict[str, str | int]]:
        return [
            {"name": name, "url": urls.get(name, ""), "size": len(content)}
            for name, content in files.items()
        ]

    info = json.loads(pyodide.contents["pyodide-lock.json"])["info"]
    about = {
        "build": _build(engine),
        "lock": {"info": info, "packages": {}},
        "files": listed(engine),
        "late": listed(late),
    }
    script = _static("web.js").strip()
    style = "".join(map(_static, ("linkwork.css", "live.css", "web.css")))
    contained = (
        f'<script id="linkwork-{name}" type="text/plain">{base64.b64encode(content).decode()}'
        "</script>"
        for name, content in {**engine, **late}.items()
        if name not in urls
    )
    return "\n".join(
        [
            '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            f'<meta http-equiv="Content-Security-Policy" content="{_policy(script, style)}">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            '<meta name="color-scheme" content="light dark">',
            f'{MARK} {html.escape(metadata.version("linkwork"))}">',
            '<title>Linkwork</title>\n<link rel="icon" href="data:,">',
            f"<style>{style}</style>\n</head>\n<body>",
            '<main id="linkwork"><noscript>This page needs JavaScript.</noscript></main>',
            *_warning(pyodide.unofficial),
            f'<script id="linkwork-engine" type="application/json">{json.dumps(about)}</script>',
            f'<script id="linkwork-library" type="application/json">{library_json()}</script>',
            f"<script>{script}</script>",
            *contained,
            "</body>\n</html>\n",
        ]
    ).encode()


def _policy(script: str, style: str) -> str:
    """The Content Security Policy: nothing foreign is loaded, and nothing is sent."""
    return (
        f"default-src 'none'; script-src '{_source_hash(script)}' 'wasm-unsafe-eval'; "
        f"style-src '{_source_hash(style)}'; img-src data: blob:; connect-src 'self'; "
        "worker-src blob: 'self'; base-uri 'none'; form-action 'none'"
    )


def _warning(unofficial: tuple[str, ...]) -> list[str]:
    if not unofficial:
        return []
    listed = html.escape(", ".join(unofficial))
    return [f'<p class="lw-built">For tests only: not the official files of {listed}.</p>']


def _static(name: str) -> str:
    return (resources.files("linkwork.app") / "static" / name).read_text(encoding="utf-8")


def _without_map(script: str) -> str:
    """A script without the comment that names its source map, a file that is not there."""
    return "\n".join(line for line in script.split("\n") if not line.startswith("//# source"))


def _packed(content: bytes) -> bytes:
    return gzip.compress(content, 9, mtime=0)


def _source_hash(content: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(content.encode()).digest()).decode()}"


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:_CACHED]


def _build(engine: Mapping[str, bytes]) -> str:
    """A name that changes with every file of the engine."""
    return _digest("".join(map(_digest, engine.values())).encode())
