"""Access control of the live page, decided from the header of a request.

The server listens on this machine only, but every web site that is open in a browser of this
machine can send requests to it. The Host must be this server's (otherwise a foreign name could
resolve to this machine), so must the Origin, and the WebSocket needs the token of the address.
"""

from __future__ import annotations

import hmac
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

__all__ = ["SUBPROTOCOL", "Guard", "Refusal"]

#: What a page offers when it connects; ``token.`` with the token is offered beside it.
SUBPROTOCOL = "linkwork"
_TOKEN = "token."

Headers = Iterable[tuple[bytes, bytes]]


@dataclass(frozen=True, kw_only=True)
class Refusal:
    """An HTTP status, and a sentence that tells nothing which the asker does not know."""

    status: int
    message: str


@dataclass(frozen=True, kw_only=True)
class Guard:
    """The rules for one server.

    Parameters
    ----------
    port : int
        Where it listens.
    token : str
        What a connection has to know.
    paths : collection of str
        What can be read.
    """

    port: int
    token: str
    paths: Mapping[str, object]

    @property
    def hosts(self) -> tuple[str, ...]:
        """The names under which the server answers."""
        return (f"127.0.0.1:{self.port}", f"localhost:{self.port}")

    @property
    def security_headers(self) -> dict[str, str]:
        """Sent with every answer: nothing from elsewhere, shown nowhere else, kept by nobody."""
        sockets = " ".join(f"ws://{host}" for host in self.hosts)
        return {
            "content-security-policy": (
                "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
                f"connect-src 'self' {sockets}; base-uri 'none'; form-action 'none'; "
                "frame-ancestors 'none'"
            ),
            "cache-control": "no-store",
            "cross-origin-opener-policy": "same-origin",
            "cross-origin-resource-policy": "same-origin",
            "referrer-policy": "no-referrer",
            "x-content-type-options": "nosniff",
            "x-frame-options": "DENY",
        }

    def refused(self, method: str, raw_path: bytes, headers: Headers) -> Refusal | None:
        """Why a request for a page is not answered; ``None`` if it is."""
        given = list(headers)
        if (refusal := self._foreign(given)) is not None:
            return refusal
        if method not in ("GET", "HEAD"):
            return Refusal(status=405, message="only GET is answered here")
        if _has_body(given):
            return Refusal(status=413, message="a request here has no body")
        if raw_path.decode("latin-1") not in self.paths:
            return Refusal(status=404, message="there is nothing here")
        return None

    def connection_refused(
        self, path: str, headers: Headers, subprotocols: Iterable[str]
    ) -> Refusal | None:
        """Why a connection is not made; ``None`` if it is."""
        given = list(headers)
        if (refusal := self._foreign(given)) is not None:
            return refusal
        if not _all(given, b"origin"):
            return Refusal(status=403, message="a connection needs an Origin")
        if path != "/live":
            return Refusal(status=404, message="there is nothing here")
        offered = list(subprotocols)
        tokens = [offer.removeprefix(_TOKEN) for offer in offered if offer.startswith(_TOKEN)]
        # compared in constant time, so that the time of an answer reveals nothing of the token
        known = [hmac.compare_digest(token.encode(), self.token.encode()) for token in tokens]
        # a browser cannot send headers of its own with a WebSocket: the token comes as a
        # subprotocol
        if SUBPROTOCOL not in offered or known != [True]:
            return Refusal(status=403, message="the token is missing or wrong")
        return None

    def _foreign(self, headers: list[tuple[bytes, bytes]]) -> Refusal | None:
        """Requests under another name, or from a page of another origin."""
        hosts = [host.encode() for host in self.hosts]
        named = _all(headers, b"host")
        # a foreign name that resolves to this machine (DNS rebinding) is refused
        if len(named) != 1 or named[0].lower() not in hosts:
            return Refusal(status=421, message="this server does not answer under that name")
        origins = _all(headers, b"origin")
        if origins and origins != [b"http://" + named[0].lower()]:
            return Refusal(status=403, message="pages of other origins are not answered")
        return None


def _all(headers: Headers, name: bytes) -> list[bytes]:
    return [entry for key, entry in headers if key.lower() == name]


def _has_body(headers: Headers) -> bool:
    lengths = _all(headers, b"content-length")
    return bool(_all(headers, b"transfer-encoding")) or any(length != b"0" for length in lengths)
