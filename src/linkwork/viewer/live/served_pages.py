"""The fixed files of the live page, the same for every mechanism."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from importlib import resources

__all__ = ["library_json", "served_pages"]

_HTML = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>Linkwork</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="linkwork.css">
<link rel="stylesheet" href="live.css">
</head>
<body>
<main id="linkwork"><noscript>This page needs JavaScript.</noscript></main>
<script id="linkwork-library" type="application/json">LIBRARY</script>
<script src="live.js"></script>
</body>
</html>
"""
_TYPES = {"css": "text/css", "js": "text/javascript"}
_FILES = ("linkwork.css", "live.css", "live.js")


def library_json() -> str:
    """The library, written by ``scripts/thumbnails.py``, for a script element."""
    text = (resources.files("linkwork.viewer") / "library.json").read_text("utf-8")
    return text.replace("</", "<\\/")


@lru_cache
def served_pages() -> Mapping[str, tuple[str, bytes]]:
    """Served files by path: media type and content.

    Scripts and styles are those of ``static/``, which ``scripts/frontend build`` writes.
    """
    static = resources.files("linkwork.viewer") / "static"
    page = _HTML.replace("LIBRARY", library_json())
    pages = {"/": ("text/html; charset=utf-8", page.encode())}
    for name in _FILES:
        kind = _TYPES[name.rpartition(".")[2]]
        pages[f"/{name}"] = (f"{kind}; charset=utf-8", (static / name).read_bytes())
    return pages
