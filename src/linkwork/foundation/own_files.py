"""Folders that a command fills again: it replaces what it wrote, and leaves all other files alone.

A run leaves a list of its files with their hashes in the folder, as ``sha256sum`` writes it. A file
of the list that has its hash is the command's own; all others are the user's.
"""

from __future__ import annotations

import hashlib
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


@dataclass(frozen=True, kw_only=True)
class OwnFiles:
    """The files that a run may write into a folder, by their places in it.

    ``run``: what it is called; ``option``: how its user asks for a replacement; ``numbered``: files
    whose numbers are not known before; ``named``: others, with their contents where these are known
    before; ``folders``: where files lie, besides those of ``named``; ``read``: files that the run
    reads, without links.
    """

    run: str
    option: str
    numbered: re.Pattern[str]
    named: Mapping[str, bytes | None] = field(default_factory=dict)
    folders: Collection[str] = (".",)
    read: Collection[Path] = ()

    def check(self, root: Path, fresh: bool) -> Collection[str]:
        """The files of an earlier run, which this one will replace; called before the work.

        Raises
        ------
        InputError
            If the folder cannot be written; if it holds a file and is not to be filled afresh; or
            if the run could write over a file that is not of an earlier run.
        """
        check_place(root)
        if not root.exists():
            return ()
        file = root / self._list
        try:
            text = file.read_text("utf-8", "replace") if file.is_file() else ""
            listed = re.findall(r"(\w{64})  (.+)", text)
            earlier = [name for digest, name in listed if self._own(root, name, digest)]
            taken = next((name for name in self._met(root) if name not in earlier), "")
            there = sorted({*os.listdir(root)} - {self._list})
        except (OSError, ValueError) as error:
            raise unwritten(root, error) from None
        if there and not fresh:
            replaces = f"replaces the files of an earlier {self.run} and keeps all others"
            advice = "" if taken else f", or add {self.option}, which {replaces}"
            told = f'is not empty: it holds "{there[0]}"; name a new folder{advice}'
            raise InputError(f'the folder "{root}" {told}')
        if taken:
            raise self._refusal(root, taken)
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
            listed = ""
            for path in sorted(path for path in part.rglob("*") if path.is_file()):
                name, content = path.relative_to(part).as_posix(), path.read_bytes()
                if name in earlier or not os.path.lexists(root / name):
                    listed += f"{hashlib.sha256(content).hexdigest()}  {name}\n"
                elif _has(root / name, content):
                    path.unlink()  # the user's own file, which stays
                else:
                    raise self._refusal(root, name)
            save_text(listed, part / self._list)

    @property
    def _list(self) -> str:
        return f".linkwork-{self.run}.sha256"

    def _own(self, root: Path, name: str, digest: str) -> bool:
        whole = Path(os.path.realpath(root))
        place = whole / name
        # what lies elsewhere, or where a link leads, is the user's
        is_here = place.is_relative_to(whole) and Path(os.path.realpath(place)) == place
        if not (is_here and place.is_file()):
            return False
        content = place.read_bytes()
        needed = place in self.read and content != self.named.get(name)
        return hashlib.sha256(content).hexdigest() == digest and not needed

    def _met(self, root: Path) -> Iterator[str]:
        """What lies where the run would write something else."""
        inner = {folder for name in self.named for folder in Path(name).parents}
        for folder in sorted(inner.union(map(Path, self.folders))):
            place = root / folder
            if place.is_file() or (folder.name and place.is_symlink()):
                yield folder.as_posix()
            for name in sorted(os.listdir(place)) if place.is_dir() else ():
                if self.numbered.fullmatch((folder / name).as_posix()):
                    yield (folder / name).as_posix()
        for name, content in self.named.items():
            if os.path.lexists(root / name) and not _has(root / name, content):
                yield name

    def _refusal(self, root: Path, name: str) -> InputError:
        why = f"which this {self.run} could write over and which is yours, changed or read by it"
        remedy = "rename or move it, or name a new folder"
        return InputError(f'the folder "{root}" holds "{name}", {why}: {remedy}')


def _has(path: Path, content: bytes | None) -> bool:
    return content is not None and path.is_file() and path.read_bytes() == content
