"""Folders that a command fills again: it replaces the files of its kind and keeps all others."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from linkwork.foundation.errors import InputError
from linkwork.foundation.paths import unwritten
from linkwork.foundation.written_folder import PART, check_place, written_folder

__all__ = ["OwnFiles"]


@dataclass(frozen=True, kw_only=True)
class OwnFiles:
    """The files that a run writes into a folder, by their places in it.

    ``run``: what it is called; ``option``: how its user asks for a replacement; ``files``: their
    places; ``folders``: where they lie; ``read``: files that the run reads.
    """

    run: str
    files: re.Pattern[str]
    option: str = "--force"
    folders: Collection[str] = (".",)
    read: Collection[Path] = ()

    def check(self, root: Path, force: bool) -> Collection[str]:
        """The files of an earlier run, which this one will replace; called before the work.

        Raises
        ------
        InputError
            If the folder cannot be written, if it holds a file and nothing is to be replaced, or if
            the run reads a file that it would replace.
        """
        check_place(root)
        if not root.exists():
            return ()
        try:
            there = sorted(name for name in os.listdir(root) if not PART.fullmatch(name))
            earlier = tuple(self._earlier(root))
        except OSError as error:
            raise unwritten(root, error) from None
        if there and not force:
            raise InputError(
                f'the folder "{root}" is not empty: it holds "{there[0]}"; name a new folder, or '
                f"add {self.option}, which replaces the files of an earlier {self.run} and keeps "
                "all others"
            )
        for name in earlier:
            # a folder may be a link
            if (root / name).resolve() in self.read:
                raise InputError(
                    f'the folder "{root}" holds "{name}", which this {self.run} reads and would '
                    "replace: name a new folder"
                )
        return earlier

    def _earlier(self, root: Path) -> Iterator[str]:
        for folder in self.folders:
            place = root / folder
            for name in sorted(os.listdir(place)) if place.is_dir() else ():
                found = (Path(folder) / name).as_posix()
                if self.files.fullmatch(found) and not (place / name).is_dir():
                    yield found

    @contextmanager
    def written(self, root: Path, earlier: Collection[str]) -> Iterator[Path]:
        """A temporary folder whose files replace those of an earlier run.

        Raises
        ------
        InputError
            If a file cannot be written.
        """
        with written_folder(root, stale=earlier) as part:
            yield part
