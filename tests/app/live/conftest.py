"""A mechanism file, a workbench on it, and a server that answers on a real socket."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from websockets.sync.client import ClientConnection, connect

import linkwork as lw
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.server import LiveServer
from linkwork.app.live.workbench import Workbench

FOUR_BAR = """\
# A four-bar to be dragged about
format = 1
name = "Four-bar"  # shown as the title

[points]
O2 = [0, 0]
A = [35, 20]  # a sketch
B = [146, 66]
O4 = [100, 0]
P = [90, 90]

[links]
ground = ["O2", "O4"]
crank = ["O2", "A"]
coupler = ["A", "B", "P"]
rocker = ["O4", "B"]

[dimensions]
a = 40  # the crank

[lengths]
"O2 A" = "a"
"A B" = 120
"O4 B" = 80
"O2 O4" = 100

[input]
link = "crank"

[trace]
points = ["P"]
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A file with a four-bar."""
    file = tmp_path / "four-bar.toml"
    file.write_text(FOUR_BAR, encoding="utf-8")
    return file


@pytest.fixture
def bench(path: Path) -> Workbench:
    """A workbench on that file."""
    return Workbench(MechanismFile(path), lw.loads)


@dataclass
class Served:
    """A server that runs, and what it takes to talk to it."""

    server: LiveServer
    workbench: Workbench
    path: Path

    @property
    def host(self) -> str:
        return f"127.0.0.1:{self.server.port}"

    def connect(self, **changes: Any) -> ClientConnection:
        """A page's connection; ``token``, ``origin``, ``headers`` to get something wrong."""
        token = changes.get("token", self.server.token)
        return connect(
            f"ws://{self.host}{changes.get('path', '/live')}",
            subprotocols=changes.get("subprotocols", ["linkwork", f"token.{token}"]),
            origin=changes.get("origin", f"http://{self.host}"),
            additional_headers=changes.get("headers"),
            max_size=None,
            proxy=None,
        )


@contextmanager
def serving(workbench: Workbench) -> Iterator[LiveServer]:
    """A workbench behind a socket, ended at the end."""
    server = LiveServer(workbench)
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        yield server
    finally:
        server.stop()
        thread.join(10)
        assert not thread.is_alive()


@pytest.fixture
def serve() -> Iterator[Callable[[Workbench], LiveServer]]:
    """Starts servers of workbenches; ask for it before a page, so that pages close first."""
    with ExitStack() as ends:
        yield lambda workbench: ends.enter_context(serving(workbench))


@pytest.fixture
def served(path: Path) -> Iterator[Served]:
    """A server of a test's own."""
    workbench = Workbench(MechanismFile(path), lw.loads)
    with serving(workbench) as server:
        yield Served(server, workbench, path)


@pytest.fixture(scope="module")
def standing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server for all tests of a module that leave it as it is."""
    file = tmp_path_factory.mktemp("standing") / "four-bar.toml"
    file.write_text(FOUR_BAR, encoding="utf-8")
    workbench = Workbench(MechanismFile(file), lw.loads)
    with serving(workbench) as server:
        yield Served(server, workbench, file)
        assert not workbench.unsaved


def ask(page: ClientConnection, kind: str, **fields: Any) -> None:
    """Send a request."""
    page.send(json.dumps({"kind": kind, **fields}))


def told(page: ClientConnection, kind: str, seconds: float = 10.0) -> dict[str, Any]:
    """The next event of a kind; others are passed over."""
    while True:
        event: dict[str, Any] = json.loads(page.recv(timeout=seconds))
        if event["kind"] == kind:
            return event
