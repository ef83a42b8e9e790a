"""The live page over real sockets: what is answered, what is refused, and what survives."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from http.client import HTTPConnection, HTTPResponse
from pathlib import Path
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidStatus
from websockets.sync.client import ClientConnection

import linkwork as lw
from linkwork.app.live.messages import LARGEST_MESSAGE
from linkwork.app.live.server import LiveServer
from linkwork.app.live.workbench import Workbench
from tests.app.live.conftest import FOUR_BAR, Served, ask, told


def answer(
    served: Served, path: str = "/", method: str = "GET", **headers: str
) -> tuple[HTTPResponse, bytes]:
    """One request and its answer."""
    with closing(HTTPConnection("127.0.0.1", served.server.port, timeout=10)) as connection:
        connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        for name, value in {"Host": served.host, **headers}.items():
            connection.putheader(name, value)
        connection.endheaders()
        response = connection.getresponse()
        return response, response.read()


def raw(served: Served, request: bytes) -> bytes:
    """The answer to bytes that no client library would send."""
    with socket.create_connection(("127.0.0.1", served.server.port), timeout=10) as link:
        link.sendall(request)
        found = b""
        try:
            while piece := link.recv(65536):
                found += piece
        except ConnectionResetError:
            pass
        return found


# Pages


def test_the_page_is_answered_with_nothing_but_itself(standing: Served) -> None:
    response, body = answer(standing)
    assert response.status == 200
    assert b"Linkwork" in body
    policy = response.headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "script-src 'self';" in policy
    assert "frame-ancestors 'none'" in policy
    assert "unsafe" not in policy
    assert response.headers["x-content-type-options"] == "nosniff"
    assert response.headers["referrer-policy"] == "no-referrer"
    assert response.headers["cache-control"] == "no-store"
    assert response.headers["x-frame-options"] == "DENY"
    assert response.headers["server"] is None
    script, _ = answer(standing, "/live.js")
    assert script.headers["content-type"].startswith("text/javascript")


def test_the_page_works_under_both_names_of_this_machine(standing: Served) -> None:
    name = f"localhost:{standing.server.port}"
    assert answer(standing, Host=name)[0].status == 200
    with standing.connect(origin=f"http://{standing.host}") as page:
        assert told(page, "file_state")["title"] == "Four-bar"


def test_nothing_that_is_served_carries_the_token_or_the_file(standing: Served) -> None:
    for path in ("/", "/live.js"):
        _, body = answer(standing, path)
        assert standing.server.token.encode() not in body
        assert b"A four-bar to be dragged about" not in body


@pytest.mark.parametrize(
    "target",
    [
        "/four-bar.toml",
        "/../four-bar.toml",
        "/..%2ffour-bar.toml",
        "/%2e%2e/%2e%2e/etc/passwd",
        "//etc/passwd",
        "/./",
        "/live.js/",
        "/live%2ejs",
        "/LIVE.JS",
        "/live",
        "/live.js%00",
        "/.git/config",
        "/static/../live.js",
        "/\\..\\..\\four-bar.toml",
        "*",
    ],
)
def test_no_other_path_leads_anywhere(standing: Served, target: str) -> None:
    status = raw(standing, f"GET {target} HTTP/1.1\r\nHost: {standing.host}\r\n\r\n".encode())
    assert re.match(rb"HTTP/1.1 4\d\d ", status), status[:80]
    assert b"four" not in status
    assert b"root:" not in status


def test_an_absolute_address_of_elsewhere_is_not_fetched(standing: Served) -> None:
    found = raw(
        standing, f"GET http://example.com/ HTTP/1.1\r\nHost: {standing.host}\r\n\r\n".encode()
    )
    assert re.match(rb"HTTP/1.1 4\d\d ", found), found[:80]


@pytest.mark.parametrize(
    "host",
    ["example.com", "127.0.0.1", "127.0.0.1:1", "localhost", "127.0.0.1.example.com:{port}", ""],
)
def test_a_foreign_host_is_refused(standing: Served, host: str) -> None:
    name = host.format(port=standing.server.port)
    response, body = answer(standing, Host=name)
    assert response.status == 421
    assert body == b"this server does not answer under that name"


def test_a_request_without_host_or_with_two_is_refused(standing: Served) -> None:
    assert b" 400 " in raw(standing, b"GET / HTTP/1.1\r\n\r\n").split(b"\r\n")[0]
    assert b" 421 " in raw(standing, b"GET / HTTP/1.0\r\n\r\n").split(b"\r\n")[0]
    two = f"GET / HTTP/1.1\r\nHost: {standing.host}\r\nHost: example.com\r\n\r\n"
    assert re.match(rb"HTTP/1.1 4(00|21) ", raw(standing, two.encode()))


@pytest.mark.parametrize(
    "origin", ["http://example.com", "null", "https://{host}", "http://{host}.x"]
)
def test_a_foreign_origin_is_refused(standing: Served, origin: str) -> None:
    response, _ = answer(standing, Origin=origin.format(host=standing.host))
    assert response.status == 403


@pytest.mark.parametrize(
    "method", ["POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "PATCH"]
)
def test_no_method_changes_anything(standing: Served, method: str) -> None:
    response, _ = answer(standing, method=method)
    assert response.status in (400, 405)
    assert answer(standing)[0].status == 200


@pytest.mark.parametrize("method", ["POST", "GET"])
def test_a_body_of_100_megabytes_is_refused_unread(standing: Served, method: str) -> None:
    size = 100_000_000
    head = f"{method} / HTTP/1.1\r\nHost: {standing.host}\r\nContent-Length: {size}\r\n\r\n"
    with socket.create_connection(("127.0.0.1", standing.server.port), timeout=10) as link:
        link.sendall(head.encode())
        found = link.recv(65536)  # the answer comes before any of it is sent
        assert re.match(rb"HTTP/1.1 4(05|13) ", found), found[:80]
        assert b"connection: close" in found.lower()
        assert poured(link, size) < size // 4  # what fits into buffers on the way
    assert answer(standing)[0].status == 200


def poured(link: socket.socket, size: int) -> int:
    """How many bytes of so many go through before the other side hangs up."""
    sent, piece = 0, bytes(1_000_000)
    try:
        while sent < size:
            sent += link.send(piece)
    except (ConnectionResetError, BrokenPipeError):
        pass
    return sent


def test_an_endless_body_in_pieces_is_refused(standing: Served) -> None:
    head = f"GET / HTTP/1.1\r\nHost: {standing.host}\r\nTransfer-Encoding: chunked\r\n\r\n"
    assert b" 413 " in raw(standing, head.encode()).split(b"\r\n")[0]


def test_an_endless_head_is_refused(standing: Served) -> None:
    head = f"GET / HTTP/1.1\r\nHost: {standing.host}\r\nX: " + "a" * 200_000
    assert re.match(rb"HTTP/1.1 4\d\d ", raw(standing, head.encode()))


@pytest.mark.parametrize("noise", [b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", b"\0" * 5000])
def test_noise_is_no_request(standing: Served, noise: bytes) -> None:
    assert not raw(standing, noise + b"\r\n\r\n").startswith(b"HTTP/1.1 200")
    assert answer(standing)[0].status == 200


# The connection


@pytest.mark.parametrize(
    "changes",
    [
        {"token": "wrong"},
        {"token": ""},
        {"subprotocols": ["linkwork"]},
        {"subprotocols": None},
        {"origin": "http://example.com"},
        {"origin": None},
        {"origin": "null"},
        {"path": "/other"},
        {"path": "/live/../live2"},
    ],
)
def test_a_stranger_gets_no_connection(standing: Served, changes: dict[str, object]) -> None:
    with pytest.raises(InvalidStatus) as caught, standing.connect(**changes):
        pass
    assert caught.value.response.status_code == 403


def test_the_right_token_beside_a_wrong_one_is_no_way_to_try_many(standing: Served) -> None:
    offers = ["linkwork", f"token.{standing.server.token}", "token.guess"]
    with pytest.raises(InvalidHandshake), standing.connect(subprotocols=offers):
        pass


def test_a_connection_under_a_foreign_host_is_refused(standing: Served) -> None:
    lines = [
        "GET /live HTTP/1.1",
        "Host: example.com",
        f"Origin: http://{standing.host}",
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        "Sec-WebSocket-Version: 13",
        f"Sec-WebSocket-Protocol: linkwork, token.{standing.server.token}",
    ]
    ours = raw_head(standing, lines)
    assert b" 403 " in ours
    lines[1] = f"Host: {standing.host}"
    assert b" 101 " in raw_head(standing, lines)


def raw_head(served: Served, lines: list[str]) -> bytes:
    with socket.create_connection(("127.0.0.1", served.server.port), timeout=10) as link:
        link.sendall("\r\n".join([*lines, "", ""]).encode())
        return link.recv(65536).split(b"\r\n")[0]


@contextmanager
def strangers(served: Served, count: int, head: bytes = b"") -> Iterator[list[socket.socket]]:
    """Connections that send the beginning of a request, or nothing, and wait."""
    with ExitStack() as stack:
        links = []
        for _ in range(count):
            link = socket.create_connection(("127.0.0.1", served.server.port), timeout=10)
            links.append(stack.enter_context(link))
            link.sendall(head)
        yield links


@pytest.mark.parametrize("head", [b"", b"GET / HTTP/1.1\r\nHost: 127"])
def test_strangers_that_hold_connections_do_not_keep_the_owner_out(
    served: Served, head: bytes
) -> None:
    with served.connect() as page:
        told(page, "motion_found")
        with strangers(served, 100, head):
            response, _ = answer(served)
            assert response.status == 200
            ask(page, "undo", id=1)  # the page is not disturbed
            assert told(page, "refused")["answers"] == 1
    with strangers(served, 100, head), reconnected(served) as page:
        assert told(page, "motion_found")["certified"] == 361


def test_a_connection_without_a_page_ends_by_itself(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("linkwork.app.live.short_connections.PATIENCE", 0.3)
    with served.connect() as page:
        told(page, "motion_found")
        with strangers(served, 2, b"GET /") as links:
            began = time.monotonic()
            while time.monotonic() - began < 5.0:
                try:
                    links[0].sendall(b"x")  # one byte at a time
                except OSError:
                    break
                time.sleep(0.05)
            assert time.monotonic() - began < 3.0
            assert links[1].recv(100) == b""
        ask(page, "undo", id=1)
        assert told(page, "refused")["answers"] == 1


def test_a_second_page_is_told_why_it_must_wait(served: Served) -> None:
    with served.connect() as first:
        told(first, "motion_found")
        with served.connect() as second:
            assert told(second, "refused")["message"].startswith("another page shows this file")
            with pytest.raises(ConnectionClosed) as caught:
                second.recv(timeout=10)
            assert caught.value.rcvd is not None
            assert caught.value.rcvd.code == 4009
        ask(first, "undo", id=1)  # the first one is not disturbed
        assert told(first, "refused")["answers"] == 1
    with reconnected(served) as third:
        assert told(third, "motion_found")["certified"] == 361


@contextmanager
def reconnected(served: Served) -> Iterator[ClientConnection]:
    """A connection as soon as it is noticed that the one before is gone."""
    for _ in range(100):
        with served.connect() as page:
            try:
                told(page, "file_state")
            except ConnectionClosed:
                time.sleep(0.05)
                continue
            yield page
            return
    raise AssertionError("the page before is still connected")


def test_a_closed_tab_loses_nothing(served: Served) -> None:
    with served.connect() as page:
        told(page, "motion_found")
        ask(page, "set_number", name="A B", value=125, live=True)
        told(page, "motion_found")
        page.socket.shutdown(socket.SHUT_RDWR)  # no farewell
    with reconnected(served) as again:
        ask(again, "reload")
        before = told(again, "motion_found")
        assert before["certified"] == 361
        ask(again, "undo")
        state = told(again, "file_state")
        while state["undo"] != "A B = 125":
            state = told(again, "file_state")
        assert '"A B" = 125' in state["text"]
        assert state["unsaved"]
    assert served.path.read_text(encoding="utf-8") == FOUR_BAR


def test_a_tab_closed_while_requests_wait_harms_nothing(served: Served) -> None:
    with served.connect() as page:
        for k in range(80):
            ask(page, "set_number", name="A B", value=120 + k / 10, live=True)
    with reconnected(served) as again:
        ask(again, "solve_at", at={})
        assert told(again, "position_found")["status"] == "CONVERGED"


def test_malformed_messages_are_answered_one_by_one(served: Served) -> None:
    with served.connect() as page:
        told(page, "motion_found")
        for message in ("", "{", "[]", "null", '{"kind": "no"}', "[" * 50_000, '"\\ud800"'):
            page.send(message)
            assert told(page, "refused")["message"]
        page.send(b"\x00\xff")
        assert told(page, "refused")["message"] == "messages are text, this one is binary"
        page.send('{"kind": "set_number", "id": 5, "name": "a"}')
        refused = told(page, "refused")
        assert refused["answers"] == 5
        assert refused["message"] == "set_number: value is missing: send it with the message"
        ask(page, "solve_at", id=6, at={"crank": 60})
        assert told(page, "position_found")["answers"] == 6


def test_a_message_beyond_the_limit_ends_the_connection_and_nothing_else(served: Served) -> None:
    with served.connect() as page:
        told(page, "motion_found")
        ask(page, "set_number", name="A B", value=125)
        told(page, "motion_found")
        with suppress(ConnectionClosed):  # the server may close while this is being sent
            page.send(" " * (LARGEST_MESSAGE + 1))
        with pytest.raises(ConnectionClosed) as caught:
            told(page, "nothing more")
    # the end of the socket may overtake the frame that tells why
    assert caught.value.rcvd is None or caught.value.rcvd.code == 1009
    with reconnected(served) as again:
        ask(again, "undo")
        assert '"A B" = 120' in told(again, "file_state")["text"]


def test_only_the_latest_place_of_a_slider_is_solved(served: Served) -> None:
    with served.connect() as page:
        told(page, "motion_found")
        for k in range(60):
            ask(page, "set_number", id=k, name="A B", value=120 + k / 10, live=True)
        ask(page, "set_number", id=60, name="A B", value=126)
        answers: list[int] = []
        while not answers or answers[-1] != 60:
            answers.append(told(page, "motion_found")["answers"])
        assert answers == sorted(answers)
        assert len(answers) < 61


def test_an_edit_is_saved_to_the_one_file(served: Served) -> None:
    with served.connect() as page:
        told(page, "motion_found")
        ask(page, "set_number", name="a", value=42)
        ask(page, "save", id=9)
        assert told(page, "saved")["answers"] == 9
    assert "a = 42  # the crank" in served.path.read_text(encoding="utf-8")
    assert [file.name for file in served.path.parent.iterdir()] == ["four-bar.toml"]


def test_a_change_on_disk_reaches_the_page(served: Served) -> None:
    with served.connect() as page:
        told(page, "motion_found")
        served.path.write_text(FOUR_BAR.replace('"Four-bar"', '"Other"'), encoding="utf-8")
        changed = told(page, "file_changed")
        assert (changed["reloaded"], changed["answers"]) == (True, None)
        assert told(page, "file_state")["title"] == "Other"


def test_our_own_mistake_is_said_and_survived(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError("oh")

    with served.connect() as page:
        told(page, "motion_found")
        monkeypatch.setattr(Workbench, "handle", fail)
        ask(page, "undo")
        assert told(page, "refused")["message"].endswith("please report it: ZeroDivisionError: oh")
        monkeypatch.undo()
        ask(page, "solve_at", at={})
        assert told(page, "position_found")["status"] == "CONVERGED"


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere 127.0.0.2 may not exist")
def test_it_listens_on_this_machine_only(standing: Served) -> None:
    assert standing.server.address.startswith("http://127.0.0.1:")
    with pytest.raises(OSError, match=r"(?i)refused"):  # this machine too, by another address
        socket.create_connection(("127.0.0.2", standing.server.port), timeout=5)


def test_every_server_has_its_own_token_and_port(served: Served, bench: Workbench) -> None:
    other = LiveServer(bench)
    try:
        assert other.token != served.server.token
        assert len(other.token) >= 43  # 256 bits
        assert other.port != served.server.port
        with pytest.raises(lw.InputError, match=f"port {served.server.port} cannot be used: "):
            LiveServer(bench, served.server.port)
    finally:
        other.stop()
        other.run()


# The command


def begun(path: Path | str, cwd: Path | None = None) -> tuple[subprocess.Popen[str], str]:
    """The command as a process, and the address that it prints."""
    process = subprocess.Popen(
        [sys.executable, "-m", "linkwork", "view", str(path), "--no-browser"],
        cwd=cwd,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert process.stdout is not None
    for text in process.stdout:
        if text.strip().startswith("http://"):
            return process, text.strip()
    raise AssertionError("no address was printed")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_the_command_ends_cleanly_and_keeps_what_is_unsaved(path: Path, number: int) -> None:
    process, address = begun(path)
    server: Any = _AsPrinted(address)
    workbench: Any = None  # in the process of the command
    served = Served(server, workbench, path)
    with served.connect() as page:
        told(page, "motion_found")
        ask(page, "set_number", name="a", value=42)
        told(page, "motion_found")
        os.kill(process.pid, number)
        output, _ = process.communicate(timeout=20)
    kept = path.parent / "four-bar.unsaved.toml"
    assert process.returncode == 0
    assert "Unsaved changes were written to" in output
    assert kept.name in output
    assert "Traceback" not in output
    assert "a = 42" in kept.read_text(encoding="utf-8")
    assert path.read_text(encoding="utf-8") == FOUR_BAR


class _AsPrinted:
    """Port and token from an address."""

    def __init__(self, address: str) -> None:
        found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/#([\w-]+)", address)
        assert found is not None
        self.port, self.token = int(found[1]), found[2]


def test_nothing_is_left_behind_if_nothing_changed(path: Path) -> None:
    process, _ = begun(path)
    os.kill(process.pid, signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    assert "kept" not in output
    assert [file.name for file in path.parent.iterdir()] == ["four-bar.toml"]


def test_a_file_that_cannot_be_read_is_refused_by_the_command(tmp_path: Path) -> None:
    words = [sys.executable, "-m", "linkwork", "view", "--no-browser"]
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    for name, message in (
        ("binary.toml", "UTF-8"),
        (".", "is a folder"),
        ("-", "standard input cannot be edited and saved"),
    ):
        done = subprocess.run(
            [*words, name], cwd=tmp_path, capture_output=True, text=True, timeout=30
        )
        assert done.returncode == 2
        assert message in done.stderr, done.stderr


def test_without_its_packages_the_command_says_what_to_install(path: Path) -> None:
    program = (
        "import sys; sys.modules['uvicorn'] = None\n"
        "from linkwork.core.commands.main import linkwork\n"
        f"linkwork(['view', {str(path)!r}, '--no-browser'])\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 2
    assert 'pip install "linkwork[view]"' in " ".join(done.stderr.split())


def test_a_mechanism_of_the_library_is_opened_and_saved_under_its_name(tmp_path: Path) -> None:
    process, address = begun("four-bar", cwd=tmp_path)
    server: Any = _AsPrinted(address)
    workbench: Any = None
    with Served(server, workbench, tmp_path / "four-bar.toml").connect() as page:
        assert told(page, "motion_found")["certified"] == 361
        assert list(tmp_path.iterdir()) == []
        ask(page, "reload")
        ask(page, "set_number", name="O2 A", value=42)
        told(page, "motion_found")
        ask(page, "save")
        state = told(page, "file_state")
        while state["unsaved"]:
            state = told(page, "file_state")
        saved = tmp_path / "four-bar.toml"
        saved.rename(tmp_path / "away.toml")
        ask(page, "reload")  # the file is gone: the library's text does not take its place
        assert "there is no such file" in json.dumps(told(page, "problems_found"))
        (tmp_path / "away.toml").rename(saved)
        os.kill(process.pid, signal.SIGINT)
        process.communicate(timeout=60)
    assert [file.name for file in tmp_path.iterdir()] == ["four-bar.toml"]
    assert '"O2 A"  = 42' in (tmp_path / "four-bar.toml").read_text(encoding="utf-8")
    words = [sys.executable, "-m", "linkwork", "view", "--no-browser", "four-bar"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2
    assert 'there is a file "four-bar.toml" already: to open it, linkwork view four-bar.toml' in (
        done.stderr.replace("\n  ", " ")
    )


def test_a_task_to_begin_with_is_opened_under_its_name(tmp_path: Path) -> None:
    process, address = begun("three-poses", cwd=tmp_path)
    server: Any = _AsPrinted(address)
    workbench: Any = None
    with Served(server, workbench, tmp_path / "three-poses.toml").connect() as page:
        state = told(page, "task_state")
        assert (state["title"], len(state["positions"])) == ("Three poses", 3)
        os.kill(process.pid, signal.SIGINT)
        process.communicate(timeout=60)
    assert list(tmp_path.iterdir()) == []
