"""The files of the page that solves in the browser alone: a folder for a host, or one HTML file."""

from __future__ import annotations

import base64
import gzip
import hashlib
import html
import json
from collections.abc import Mapping
from importlib import metadata, resources

from linkwork.viewer.live.served_pages import library_json
from linkwork.viewer.web.pyodide_files import PACKAGES, PyodideFiles
from linkwork.viewer.web.site_packages import late_files, site_packages

__all__ = ["MARK", "web_folder", "web_page"]

#: Begins the name of the generator in every page; tells our pages from others.
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
    return (resources.files("linkwork.viewer") / "static" / name).read_text(encoding="utf-8")


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
