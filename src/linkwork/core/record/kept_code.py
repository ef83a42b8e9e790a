"""Code of printed functions in the user's cache: writing it takes milliseconds a shape."""

from __future__ import annotations

import hashlib
import importlib.util
import marshal
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from types import CodeType

from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import cache_folder, save_bytes

_DIGEST = 32  # bytes


@cache
def _version() -> bytes:
    """A digest of all that decides how functions are written: code of another one is not used."""
    digest = hashlib.sha256(importlib.util.MAGIC_NUMBER)
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return digest.digest()


class KeptCode:
    """The code of a shape's functions; ``key`` tells shapes apart."""

    def __init__(self, key: str) -> None:
        self._key = key
        self._path: Path | None = None
        self._codes: dict[str, CodeType] | None = None

    def get(self, name: str, write: Callable[[], str]) -> CodeType:
        """The code of a function; ``write`` gives its source if it is not kept yet."""
        if self._codes is None:
            self._codes = self._read()
        code = self._codes.get(name)
        if code is None:
            code = self._codes[name] = compile(write(), f"<{name}>", "exec")
            self._keep()
        return code

    def _read(self) -> dict[str, CodeType]:
        if sys.platform == "emscripten":  # nothing lasts longer than the page
            return {}
        with suppress(OSError, RuntimeError):  # RuntimeError: no home
            digest = hashlib.sha256(_version() + self._key.encode()).hexdigest()[:_DIGEST]
            self._path = cache_folder("functions") / f"{digest}.bin"
            held = self._path.read_bytes()
            check, data = held[:_DIGEST], held[_DIGEST:]
            if hashlib.sha256(data).digest() == check:
                found: dict[str, CodeType] = marshal.loads(data)
                return found
        return {}

    def _keep(self) -> None:
        if self._path is None:
            return
        data = marshal.dumps(self._codes)
        with suppress(OSError, InputError):
            self._path.parent.mkdir(parents=True, exist_ok=True)
            save_bytes(hashlib.sha256(data).digest() + data, self._path)
