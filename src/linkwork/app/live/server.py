"""Access control of the live page, based on the request header.

The server listens on this machine only, but any web site open in a browser of this machine can send
requests to it. Host and Origin must be those of this server (a foreign name could resolve to this
machine), and the WebSocket needs the token of the address.
"""

from __future__ import annotations

import asyncio
import hmac
import secrets
import signal
import socket
import threading
from collections.abc import Awaitable, Callable, Iterable, Iterator, Mapping, MutableMapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Any

from linkwork.app.live.events import Event, Refused
from linkwork.app.live.messages import LARGEST_MESSAGE, MessageError, decoded, encoded
from linkwork.app.live.session import Bench, Desk
from linkwork.app.live.workbench import Workbench
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.loading import installed_with

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
        listed = list(headers)
        if (refusal := self._foreign(listed)) is not None:
            return refusal
        if method not in ("GET", "HEAD"):
            return Refusal(status=405, message="only GET is answered here")
        if _has_body(listed):
            return Refusal(status=413, message="a request here has no body")
        if raw_path.decode("latin-1") not in self.paths:
            return Refusal(status=404, message="there is nothing here")
        return None

    def connection_refused(
        self, path: str, headers: Headers, subprotocols: Iterable[str]
    ) -> Refusal | None:
        """The reason to refuse a connection; ``None`` to accept it."""
        listed = list(headers)
        if (refusal := self._foreign(listed)) is not None:
            return refusal
        if not _all(listed, b"origin"):
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


# ----------------------------------------------------------------------
# The fixed files of the live page, the same for every mechanism.


_HTML = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>Linkwork</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="linkwork.css">
<link rel="stylesheet" href="live.css">
</head>
<body>
<main id="linkwork"><noscript>This page needs JavaScript.</noscript></main>
<script id="linkwork-library" type="application/json">LIBRARY</script>
<script src="live.js"></script>
</body>
</html>
"""
_TYPES = {"css": "text/css", "js": "text/javascript"}
_FILES = ("linkwork.css", "live.css", "live.js")


def library_json() -> str:
    """The library, written by ``scripts/thumbnails.py``, for a script element."""
    text = (resources.files("linkwork.app") / "library.json").read_text("utf-8")
    return text.replace("</", "<\\/")


@lru_cache
def served_pages() -> Mapping[str, tuple[str, bytes]]:
    """Served files by path: media type and content.

    Scripts and styles are those of ``static/``, which ``scripts/frontend build`` writes.
    """
    static = resources.files("linkwork.app") / "static"
    page = _HTML.replace("LIBRARY", library_json())
    pages = {"/": ("text/html; charset=utf-8", page.encode())}
    for name in _FILES:
        kind = _TYPES[name.rpartition(".")[2]]
        pages[f"/{name}"] = (f"{kind}; charset=utf-8", (static / name).read_bytes())
    return pages


# ----------------------------------------------------------------------
# The server of the live page, on this machine only: one file, one page, one connection.


Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]

_LOOPBACK = "127.0.0.1"
_MOST_WAITING = 100  # queued requests or events; a faster page has to wait
_OCCUPIED = 4009  # close code: another page is connected
_MOST_WAITING_TO_CONNECT = 32
_LARGEST_HEAD = 16_384  # bytes


class LiveServer:
    """Serves one workbench to one page at a time.

    Parameters
    ----------
    workbench : Workbench or Bench
    port : int
        0 selects a free port.

    Raises
    ------
    InputError
        If the port is taken.
    """

    def __init__(self, workbench: Workbench | Bench, port: int = 0) -> None:
        self._socket = _listening(port)
        self.port: int = self._socket.getsockname()[1]
        # other programs and web pages on this machine can reach the port, but do not know the token
        self.token = secrets.token_urlsafe(32)
        self._guard = Guard(port=self.port, token=self.token, paths=served_pages())
        self._workbench = workbench
        self._page: asyncio.Queue[str] | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._desk = Desk(workbench, self._tell)
        self._server: Any = None
        self._ended = False

    @property
    def address(self) -> str:
        """The address for the browser; browsers never send the part after #."""
        return f"http://{_LOOPBACK}:{self.port}/#{self.token}"

    def run(self, tell: Callable[[], None] = lambda: None) -> None:
        """Serve until :meth:`stop`, Ctrl-C or SIGTERM.

        Parameters
        ----------
        tell : callable
            Called before the server starts, after its packages are imported: Ctrl-C then ends it.

        Raises
        ------
        MissingPackageError
            If uvicorn or websockets is not installed.
        """
        try:
            with self._ended_by_signals():
                self._server = _uvicorn(self._app)
                tell()
                self._desk.prepare()  # solved while the browser loads the page
                if not self._ended:
                    self._server.run(sockets=[self._socket])
        finally:
            self._desk.close()
            self._socket.close()

    def stop(self) -> None:
        """Stop the server; any thread may call this."""
        self._ended = True
        if self._server is not None:
            self._server.should_exit = True

    @contextmanager
    def _ended_by_signals(self) -> Iterator[None]:
        """Stop the server at Ctrl-C, SIGTERM or a closed terminal, without loss of data.

        While uvicorn runs, its handlers are active; it raises a received signal again at its
        end.
        """
        before: dict[int, Any] = {}
        if threading.current_thread() is threading.main_thread():
            for name in ("SIGINT", "SIGTERM", "SIGHUP"):
                if number := getattr(signal, name, None):
                    before[number] = signal.signal(number, lambda *_: self.stop())
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    async def _app(self, scope: Scope, receive: Receive, send: Send) -> None:
        """An ASGI application, as uvicorn calls it."""
        if scope["type"] == "websocket":
            await self._connection(scope, receive, send)
        elif scope["type"] == "http":
            await self._answer(scope, send)

    async def _answer(self, scope: Scope, send: Send) -> None:
        """Send one of the fixed pages; request bodies are not read."""
        headers = self._guard.security_headers
        refusal = self._guard.refused(scope["method"], scope["raw_path"], scope["headers"])
        if refusal is None:
            status, (kind, content) = 200, served_pages()[scope["path"]]
        else:
            status, kind, content = refusal.status, "text/plain", refusal.message.encode()
            headers["connection"] = "close"
        headers |= {"content-type": kind, "content-length": str(len(content))}
        lines = [(name.encode(), entry.encode()) for name, entry in headers.items()]
        await send({"type": "http.response.start", "status": status, "headers": lines})
        await send({"type": "http.response.body", "body": content})

    async def _connection(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle the connection of a page with the token, until it ends."""
        await receive()  # the connection request
        refusal = self._guard.connection_refused(
            scope["path"], scope["headers"], scope["subprotocols"]
        )
        if refusal is not None:
            await send({"type": "websocket.close"})  # not accepted: the answer is 403
            return
        await send({"type": "websocket.accept", "subprotocol": SUBPROTOCOL})
        # one page at a time: two pages could conflict
        if self._page is not None:
            message = encoded(Refused(message=_OCCUPIED_MESSAGE))
            await send({"type": "websocket.send", "text": message})
            await send({"type": "websocket.close", "code": _OCCUPIED})
            return
        self._page, self._loop = asyncio.Queue(), asyncio.get_running_loop()
        sending = asyncio.create_task(self._send(send, self._page))
        try:
            self._desk.open()
            await self._receive(receive, self._page)
        finally:
            self._page = None  # the workbench keeps its state for the next page
            sending.cancel()

    async def _receive(self, receive: Receive, telling: asyncio.Queue[str]) -> None:
        """Receive requests until the page disconnects."""
        while True:
            # the page waits while the socket is not read
            while max(self._desk.waiting, telling.qsize()) > _MOST_WAITING:
                await asyncio.sleep(0.02)
            message = await receive()
            if message["type"] == "websocket.disconnect":
                return
            text = message.get("text")
            try:
                if text is None:
                    raise MessageError("messages are text, this one is binary")
                self._desk.ask(*decoded(text))
            except MessageError as error:
                telling.put_nowait(encoded(Refused(message=str(error)), error.id))

    @staticmethod
    async def _send(send: Send, telling: asyncio.Queue[str]) -> None:
        with suppress(OSError):  # the page has disconnected
            while True:
                await send({"type": "websocket.send", "text": await telling.get()})

    def _tell(self, events: list[Event], number: int | None) -> None:
        """Called by the desk: pass events to the network thread."""
        loop = self._loop
        if loop is None:
            return
        messages = [encoded(event, number) for event in events]
        try:
            # asyncio queues may only be used from their thread
            loop.call_soon_threadsafe(self._put, messages)
        except RuntimeError:  # the event loop is closed: no receiver
            return

    def _put(self, messages: list[str]) -> None:
        if self._page is not None:
            for message in messages:
                self._page.put_nowait(message)


_OCCUPIED_MESSAGE = (
    "another page shows this file already, and only one page can edit it: "
    "close that page, then reload this page"
)


def _listening(port: int) -> socket.socket:
    """A listening socket on the loopback address only."""
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        listening.bind((_LOOPBACK, port))
        listening.listen(_MOST_WAITING_TO_CONNECT)
    except (OSError, OverflowError) as error:
        listening.close()
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            f"port {port} cannot be used: {reason}; leave out --port to use a free port"
        ) from None
    return listening


def _uvicorn(app: Callable[..., Any]) -> Any:
    """A uvicorn server without logs, which could contain the token."""
    with installed_with("view", "the live page needs uvicorn and websockets"):
        import uvicorn
        import websockets  # noqa: F401 - uvicorn's way to hold the connection
    from linkwork.app.live.short_connections import ShortConnection

    config = uvicorn.Config(
        app,
        interface="asgi3",
        http=ShortConnection,
        ws="websockets-sansio",
        lifespan="off",
        log_config=None,
        log_level="critical",
        access_log=False,
        proxy_headers=False,
        server_header=False,
        date_header=False,
        ws_max_size=LARGEST_MESSAGE,
        # on one machine, compression takes more time than it saves
        ws_per_message_deflate=False,
        h11_max_incomplete_event_size=_LARGEST_HEAD,
        timeout_graceful_shutdown=1,
    )
    return uvicorn.Server(config)
