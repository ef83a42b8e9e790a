"""The interface of all peers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from typing import Any

from benchmarks.peers.dyad_linkage import ComplexArray
from benchmarks.peers.work import Work

__all__ = ["DyadPeer", "Peer", "Prepared"]


@dataclass(frozen=True, kw_only=True)
class Prepared:
    """A prepared task: the timed function, and the conversion of its result.

    Parameters
    ----------
    run : callable
        Solves all rows of all members and returns the peer's own result. Timed.
    read : callable
        Turns that result into positions of the compared point, shape (members, rows), complex,
        NaN where there is none. Not timed.
    """

    run: Callable[[], Any]
    read: Callable[[Any], ComplexArray]


class Peer(ABC):
    """A solver that can be compared.

    Attributes
    ----------
    name : str
        In tables.
    distribution : str
        Its name for ``pip install``.
    module : str
        The imported module.
    most_members : int, optional
        Maximum number of members of a family, to limit the run time.
    """

    name: str
    distribution: str
    module: str
    most_members: int | None = None

    def missing(self) -> str:
        """Reason why it cannot be used here; "" if it can."""
        if find_spec(self.module) is None:
            return f"not installed (pip install {self.distribution})"
        return ""

    def version(self) -> str:
        """The installed version; "" if unknown."""
        try:
            return version(self.distribution)
        except PackageNotFoundError:
            return ""

    def cannot(self, work: Work) -> str:
        """Reason why it cannot do this task; "" if it can."""
        return ""

    @abstractmethod
    def prepare(self, work: Work) -> Prepared:
        """Set up the task; not timed."""


class DyadPeer(Peer):
    """A peer that places points one after the other."""

    def cannot(self, work: Work) -> str:
        return "" if work.dyads else "cannot: dyads only"
