"""Offline pages of mechanisms for the site, and links that open a mechanism moving and editable."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.core.textfile.link import fragment_of

__all__ = ["FOLDER", "Opened", "moving_examples", "opened", "write_library_pages"]

FOLDER = "_live"
_APP = "app/index.html"
_AT_ONCE = 2  # processes: two cores in CI


@dataclass(frozen=True, kw_only=True)
class Opened:
    """A mechanism that a page shows.

    Parameters
    ----------
    title : str
    page : str
        Its offline page, relative to the root of the site.
    app : str
        Its address in the app, relative to the root; "" if the site has none.
    """

    title: str
    page: str
    app: str


def opened(
    source: str, folder: Path, site: Path, *, sliders: Sequence[str] = (), app: bool
) -> Opened:
    """Write the offline page of a mechanism unless it is there.

    ``source`` is a name of the library or of a file in ``folder``; after a semicolon it may change
    numbers: ``four-bar; O2 A=38``.
    """
    name, *changes = [part.strip() for part in source.split(";")]
    in_library = name in lw.examples()
    mechanism = lw.example(name) if in_library else lw.load(folder / name)
    changed = dict(change.split("=") for change in changes)
    if changed:
        mechanism = mechanism.changed(**_tables(mechanism, changed))
    words = [Path(name).stem, *(f"{key}-{value}" for key, value in changed.items()), *sliders]
    page = f"{FOLDER}/{'-'.join(words).replace(' ', '')}.html"
    path = site / page
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        mechanism.animate(path, sliders=sliders)
    text = mechanism.link() if changed else _fragment(name, folder, in_library)
    return Opened(title=mechanism.name, page=page, app=f"{_APP}{text}" if app else "")


def _fragment(name: str, folder: Path, in_library: bool) -> str:
    if in_library:
        return f"#example={name}"
    return fragment_of((folder / name).read_text(encoding="utf-8"))


def _tables(mechanism: lw.Mechanism, changed: dict[str, str]) -> dict[str, Any]:
    """Changed numbers by the table of the file that has them."""
    tables: dict[str, Any] = {}
    for name, value in changed.items():
        table = "lengths" if " " in name else "dimensions"
        if not hasattr(mechanism.description, table):
            raise InputError(f'"{mechanism.name}" has no [{table}] for "{name}"')
        tables.setdefault(table, {})[name] = float(value)
    return tables


def moving_examples() -> list[str]:
    """The mechanisms of the library that have an input, and points to draw."""
    described = {name: lw.example(name).description for name in lw.examples()}
    return [
        name
        for name, description in described.items()
        if description.inputs and getattr(description, "points", None)
    ]


def write_library_pages(site: Path, names: Iterable[str]) -> None:
    """Write the offline pages of library mechanisms, two at once."""
    with ProcessPoolExecutor(_AT_ONCE) as workers:
        for done in [workers.submit(_write_one, site, name) for name in names]:
            done.result()


def _write_one(site: Path, name: str) -> None:
    opened(name, site, site, app=False)
