"""Access control of the live page, based on the request header.

The server listens on this machine only, but any web site open in a browser of this machine can send
requests to it. Host and Origin must be those of this server (a foreign name could resolve to this
machine), and the WebSocket needs the token of the address.
"""

from __future__ import annotations

import hmac
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

__all__ = ["SUBPROTOCOL", "Guard", "Refusal"]

#: Subprotocol offered by a page, together with ``token.`` + token.
SUBPROTOCOL = "linkwork"
_TOKEN = "token."

Headers = Iterable[tuple[bytes, bytes]]


@dataclass(frozen=True, kw_only=True)
class Refusal:
    """An HTTP status, and a sentence without information unknown to the client."""

    status: int
    message: str


@dataclass(frozen=True, kw_only=True)
class Guard:
    """The rules for one server.

    Parameters
    ----------
    port : int
        The port of the server.
    token : str
        The token that a connection must present.
    paths : collection of str
        The paths that can be read.
    """

    port: int
    token: str
    paths: Mapping[str, object]

    @property
    def hosts(self) -> tuple[str, ...]:
        """The host names of the server."""
        return (f"127.0.0.1:{self.port}", f"localhost:{self.port}")

    @property
    def security_headers(self) -> dict[str, str]:
        """Headers of every answer: no foreign content, no embedding, no caching."""
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
        """The reason to refuse a request for a page; ``None`` to answer it."""
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
        """The reason to refuse a connection; ``None`` to accept it."""
        given = list(headers)
        if (refusal := self._foreign(given)) is not None:
            return refusal
        if not _all(given, b"origin"):
            return Refusal(status=403, message="a connection needs an Origin")
        if path != "/live":
            return Refusal(status=404, message="there is nothing here")
        offered = list(subprotocols)
        tokens = [offer.removeprefix(_TOKEN) for offer in offered if offer.startswith(_TOKEN)]
        # constant-time comparison: response times must not reveal the token
        known = [hmac.compare_digest(token.encode(), self.token.encode()) for token in tokens]
        # browsers cannot send custom headers with a WebSocket: the token is a
        # subprotocol
        if SUBPROTOCOL not in offered or known != [True]:
            return Refusal(status=403, message="the token is missing or wrong")
        return None

    def _foreign(self, headers: list[tuple[bytes, bytes]]) -> Refusal | None:
        """Refuse requests for another host name, or from another origin."""
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
