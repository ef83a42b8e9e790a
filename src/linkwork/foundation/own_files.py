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
from linkwork.foundation.written_folder import PART, check_place, moved_aside, written_folder

__all__ = ["OwnFiles"]

_LINE = re.compile(r"(\w{64})  (.+)")


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
        try:
            earlier = self._earlier(root)
            taken = next((name for name in self._met(root) if name not in earlier), "")
            there = sorted(name for name in os.listdir(root) if not self._is_hidden(name))
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
            If a file cannot be written, or would replace one that came into the folder meanwhile or
            has been changed; then all files are in a folder beside it, which the message names.
        """
        stale: set[str] = set()
        with written_folder(root, last=self._list, stale=stale) as part:
            yield part
            # what has been changed since the check is the user's
            stale |= self._earlier(root) & {*earlier}
            new = {path: path.read_bytes() for path in sorted(part.rglob("*")) if path.is_file()}
            names = {path: path.relative_to(part).as_posix() for path in new}
            kept = [path for path, name in names.items() if self._meets(root, name, stale)]
            lines = {
                path: f"{hashlib.sha256(content).hexdigest()}  {names[path]}\n"
                for path, content in new.items()
                if names[path].isprintable()  # a line has one name
            }
            changed = [names[path] for path in kept if not _has(root / names[path], new[path])]
            if changed:
                save_text("".join(lines.values()), part / self._list)
                aside = moved_aside(part, root)
                told = f'was changed meanwhile at "{changed[0]}" and stays as it is'
                raise InputError(f'the folder "{root}" {told}: all files are in "{aside}"')
            listed = "".join(line for path, line in lines.items() if path not in kept)
            for path in kept:
                path.unlink()  # the user has the same
            if root.exists():
                # whatever an obstacle leaves of both runs is listed
                before = root / self._list
                known = before.read_text("utf-8") if before.is_file() else ""
                save_text(known + listed, before)
            save_text(listed, part / self._list)

    @property
    def _list(self) -> str:
        return f".linkwork-{self.run}.sha256"

    def _meets(self, root: Path, name: str, own: Collection[str]) -> bool:
        return name not in own and os.path.lexists(root / name)

    def _is_hidden(self, name: str) -> bool:
        return name == self._list or PART.fullmatch(name) is not None

    def _earlier(self, root: Path) -> set[str]:
        """The files of the list that nobody has changed."""
        file = root / self._list
        if not os.path.lexists(file):
            return set()
        text = file.read_text("utf-8", "replace") if file.is_file() else "?"
        listed = [_LINE.fullmatch(line) for line in text.splitlines()]
        if file.is_symlink() or None in listed:
            raise self._refusal(root, self._list)
        pairs = [match.groups() for match in listed if match is not None]
        return {name for digest, name in pairs if self._own(root, name, digest)}

    def _own(self, root: Path, name: str, digest: str) -> bool:
        whole = Path(os.path.realpath(root))
        place = whole / name
        # what lies elsewhere, or where a link leads, is the user's
        is_here = place.is_relative_to(whole) and Path(os.path.realpath(place)) == place
        if not (is_here and place.is_file() and place.relative_to(whole).as_posix() == name):
            return False
        content = place.read_bytes()
        needed = place in self.read and content != self.named.get(name)
        return hashlib.sha256(content).hexdigest() == digest and not needed

    def _met(self, root: Path) -> Iterator[str]:
        """What lies where the run would write something else."""
        inner = {folder for name in self.named for folder in Path(name).parents}
        for folder in sorted(inner.union(map(Path, self.folders))):
            place = root / folder
            other = os.path.lexists(place) and not place.is_dir()
            if other or (folder.name and place.is_symlink()):
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
