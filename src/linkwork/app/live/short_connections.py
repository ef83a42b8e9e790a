"""Connections of the live page's server that end by themselves; this module loads uvicorn.

Any program on this machine can open connections and send nothing. Only a page with the token holds
one: every other connection ends after a while, and makes room for a newer one before that.
"""

from __future__ import annotations

import asyncio
from typing import cast

from uvicorn.protocols.http.h11_impl import H11Protocol

#: Seconds after which a connection that did not become a page's is closed.
PATIENCE = 10.0
_MOST = 32  # at a time


class ShortConnection(H11Protocol):
    """Requests for pages over one connection, which becomes that of a page or is closed."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Close the oldest connection beyond the largest number, and this one after a while."""
        super().connection_made(cast("asyncio.Transport", transport))
        loop = asyncio.get_running_loop()
        self._since = loop.time()
        loop.call_later(PATIENCE, self._close)
        waiting = [other for other in self.connections if isinstance(other, ShortConnection)]
        waiting = [other for other in waiting if not other.transport.is_closing()]
        if len(waiting) > _MOST:
            min(waiting, key=lambda other: other._since)._close()

    def _close(self) -> None:
        # a connection that has been upgraded belongs to a page, which has shown the token
        if self in self.connections:
            self.transport.close()
