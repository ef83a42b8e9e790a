"""Names of a file as identifiers of a language: ``O2 A`` becomes ``O2_A``, ``θ12`` ``theta12``."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Set
from dataclasses import dataclass, field

from linkwork.foundation.names import canonical

__all__ = ["Identifiers"]

_ODD = re.compile(r"[^A-Za-z0-9]+")
_LONGEST = 60


@dataclass
class Identifiers:
    """Unique identifiers by key, which differ in more than upper and lower case.

    Parameters
    ----------
    reserved : set of str
        Words that are taken, in lower case.
    """

    reserved: Set[str]
    of: dict[str, str] = field(default_factory=dict)
    _used: set[str] = field(default_factory=set)

    def claim(self, key: str, wanted: str) -> str:
        """An identifier for ``key``, as similar as possible to the preferred one."""
        plain = unicodedata.normalize("NFKD", canonical(wanted).replace("'", "_prime"))
        stem = _ODD.sub("_", plain.encode("ascii", "ignore").decode()).strip("_")[:_LONGEST]
        if not stem or not stem[0].isalpha():
            stem = f"x_{stem}".rstrip("_")
        name, count = stem, 1
        while name.lower() in self._used or name.lower() in self.reserved:
            count += 1
            name = f"{stem}_{count}"
        self._used.add(name.lower())
        self.of[key] = name
        return name
