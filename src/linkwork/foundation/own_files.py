"""Folders that a command fills again: it replaces what it wrote, and leaves all other files alone.

A run leaves a list of its files with their hashes in the folder. A file of the list that has its
hash is the command's own; every other file is the user's, and is never replaced or deleted.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from linkwork.foundation.errors import InputError
from linkwork.foundation.paths import unwritten
from linkwork.foundation.written_file import save_text
from linkwork.foundation.written_folder import check_place, written_folder

__all__ = ["OwnFiles"]

_REMEDY = "rename or move it, or name a new folder"


@dataclass(frozen=True, kw_only=True)
class OwnFiles:
    """The files that a run may write into a folder, named by their places in it.

    ``run``: what it is called; ``option``: how its user asks for a replacement; ``numbered``: the
    names of files whose number is not known before; ``named``: other files, with their contents
    where these are known before; ``folders``: folders in it, besides those of ``named``; ``read``:
    files that the run reads and that must stay.
    """

    run: str
    option: str
    numbered: re.Pattern[str]
    named: Mapping[str, bytes | None] = field(default_factory=dict)
    folders: Collection[str] = ()
    read: Collection[Path] = ()

    @property
    def _list(self) -> str:
        return f".linkwork-{self.run}.json"

    def check(self, root: Path, fresh: bool) -> Collection[str]:
        """The files of an earlier run, which this one may replace; looks before the work.

        Raises
        ------
        InputError
            If the folder cannot be written; if it holds a file and is not to be filled afresh; or
            if it holds one that is not of an earlier run and would be replaced.
        """
        check_place(root)
        if not root.exists():
            return ()
        try:
            listed = self._listed(root)
            earlier = [name for name, digest in listed.items() if _is_own(root, name, digest)]
            obstacle = next(self._obstacles(root, listed, earlier), "")
            there = sorted(path.name for path in root.iterdir() if path.name != self._list)
        except (OSError, ValueError) as error:
            raise unwritten(root, error) from None
        if fresh and obstacle:
            raise InputError(f'the folder "{root}" holds {obstacle}')
        if there and not fresh:
            advice = (
                f", or add {self.option}, which replaces the files of an earlier {self.run} and "
                "keeps all others"
            )
            raise InputError(
                f'the folder "{root}" is not empty: it holds "{there[0]}"; name a new folder'
                f"{'' if obstacle else advice}"
            )
        return earlier

    @contextmanager
    def written(self, root: Path, earlier: Collection[str]) -> Iterator[Path]:
        """A temporary folder whose files replace those of an earlier run, and their list.

        Raises
        ------
        InputError
            If a file cannot be written, or would replace one that came into the folder meanwhile.
        """
        with written_folder(root, stale=earlier) as part:
            yield part
            digests = {}
            for path in sorted(path for path in part.rglob("*") if path.is_file()):
                name, content = path.relative_to(part).as_posix(), path.read_bytes()
                if name in earlier or not os.path.lexists(root / name):
                    digests[name] = _digest(content)
                elif _has(root / name, content):
                    path.unlink()  # the user's own file, which stays
                else:
                    raise InputError(f'the folder "{root}" holds {self._told(name, "")}')
            save_text(json.dumps(digests, indent=0, ensure_ascii=False), part / self._list)

    def _listed(self, root: Path) -> dict[str, str]:
        """The files of the list with their hashes; none of a list that Linkwork did not write."""
        try:
            listed = json.loads((root / self._list).read_bytes())
        except (FileNotFoundError, ValueError):
            return {}
        return {k: str(v) for k, v in listed.items()} if isinstance(listed, dict) else {}

    def _obstacles(
        self, root: Path, listed: Collection[str], earlier: Collection[str]
    ) -> Iterator[str]:
        """What lies where this run would write, and what to do about it."""
        for name in earlier:
            if (root / name).resolve() in self.read and not _has(root / name, self.named.get(name)):
                yield f'"{name}", which is read: name a new folder'
        inner = {folder for name in self.named for folder in Path(name).parents} - {Path()}
        for folder in sorted(inner.union(map(Path, self.folders))):
            place = root / folder
            if os.path.lexists(place) and not (place.is_dir() and _is_real(root, folder)):
                yield f'"{folder.as_posix()}", which is a link or a file: {_REMEDY}'
        found = [
            name
            for name, content in self.named.items()
            if os.path.lexists(root / name) and not _has(root / name, content)
        ]
        for inside in filter(Path.is_dir, (root, *(root / name for name in self.folders))):
            names = sorted(name for name in os.listdir(inside) if self.numbered.fullmatch(name))
            found += [(inside / name).relative_to(root).as_posix() for name in names]
        yield from (self._told(name, listed) for name in found if name not in earlier)

    def _told(self, name: str, listed: Collection[str]) -> str:
        why = f"was changed since an earlier {self.run} wrote it"
        why = why if name in listed else f"no earlier {self.run} wrote"
        return f'"{name}", which {why}; this one could write over it: {_REMEDY}'


def _is_own(root: Path, name: str, digest: str) -> bool:
    place = root / name
    return _is_real(root, name) and place.is_file() and _digest(place.read_bytes()) == digest


def _is_real(root: Path, name: str | Path) -> bool:
    """Whether a place lies in the folder, and no link in the folder leads to it."""
    whole = Path(os.path.realpath(root))
    place = whole / name
    return place.is_relative_to(whole) and Path(os.path.realpath(place)) == place


def _has(path: Path, content: bytes | None) -> bool:
    return content is not None and path.is_file() and path.read_bytes() == content


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
