"""Connections of the live page's server that end by themselves; this module loads uvicorn.

Any program on this machine can open connections and send nothing. Only a page with the token holds
one: every other connection ends after a while, and makes room for a newer one before that.
"""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from typing import ClassVar, cast

from uvicorn.protocols.http.h11_impl import H11Protocol  # noqa: TID253 - loaded by a running server

__all__ = ["PATIENCE", "ShortConnection"]

#: Seconds after which a connection that did not become a page's is closed.
PATIENCE = 10.0
_MOST = 32  # at a time


class ShortConnection(H11Protocol):
    """Requests for pages over one connection, which becomes that of a page or is closed."""

    #: Open connections, oldest first.
    _open: ClassVar[OrderedDict[ShortConnection, asyncio.Transport]] = OrderedDict()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Close the oldest connections beyond the largest number, and this one after a while."""
        own = cast("asyncio.Transport", transport)
        super().connection_made(own)
        self._open[self] = own
        while len(self._open) > _MOST:
            next(iter(self._open))._close()
        asyncio.get_running_loop().call_later(PATIENCE, self._close)

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        self._open.pop(self, None)
        super().connection_lost(exc)

    def _close(self) -> None:
        transport = self._open.pop(self, None)
        # a connection that has been upgraded belongs to a page, which has shown the token
        if transport is not None and transport.get_protocol() is self:
            transport.close()
