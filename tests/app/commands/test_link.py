"""The command that prints links, and commands that are given a link instead of a file."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path

import pytest

import linkwork as lw
from linkwork.app.live.requests import Save
from linkwork.app.live.server import LiveServer
from linkwork.core.textfile.link import fragment_of, text_of_link
from tests.core.commands.conftest import FOUR_BAR, Run

APP = "https://example.org/linkwork/"
LINK = fragment_of(FOUR_BAR)
COMMENTED = "# mine\r\n" + FOUR_BAR


def test_the_link_of_a_file_is_its_text_with_comments_and_line_ends(run: Run, folder: Path) -> None:
    (folder / "mine.toml").write_bytes(COMMENTED.encode())
    done = run("link", "mine.toml", "--app", APP)
    assert (done.exit_code, done.stderr) == (0, "")
    assert done.stdout == APP + fragment_of(COMMENTED) + "\n"
    back = run("link", done.stdout.strip(), "--text")
    assert back.stdout_bytes == COMMENTED.encode()


def test_a_changed_number_is_in_the_link(run: Run) -> None:
    done = run("link", "four-bar.toml", "--set", "a=38")
    assert lw.load(done.stdout.strip()).description.dimensions["a"] == 38


def test_a_library_name_and_standard_input_have_links_too(run: Run) -> None:
    assert text_of_link(run("link", "jansen-leg").stdout) == lw.example_text("jansen-leg")
    assert text_of_link(run("link", "-", stdin=FOUR_BAR).stdout) == FOUR_BAR


@pytest.mark.parametrize(
    "words",
    [
        ("check",),
        ("equations",),
        ("solve", "--at", "60"),
        ("solve", "--set", "a=38"),
        ("quantities",),
        ("sweep", "--csv", "-"),
        ("configurations", "--json"),
        ("link", "--app", APP),
    ],
)
def test_a_command_does_with_a_link_what_it_does_with_the_file(
    run: Run, words: tuple[str, ...]
) -> None:
    command, *options = words
    of_file = run(command, "four-bar.toml", *options)
    assert of_file.exit_code == 0
    for link in (LINK, LINK.removeprefix("#"), APP + LINK):
        of_link = run(command, link, *options)
        assert (of_link.exit_code, of_link.stderr) == (0, "")
        assert of_link.stdout == of_file.stdout


def test_hints_do_not_repeat_the_link(run: Run) -> None:
    assert "--csv cycle.csv" in run("sweep", LINK).stdout
    never = fragment_of(FOUR_BAR.replace("a = 40", "a = 400"))
    assert "linkwork solve LINK --show-steps" in run("sweep", never).stdout
    assert "linkwork solve LINK" in run("configurations", never).stdout


def test_a_file_wins_over_a_link_of_the_same_name(run: Run, folder: Path) -> None:
    name = fragment_of("")
    (folder / name).write_text(FOUR_BAR, encoding="utf-8")
    assert run("solve", name).stdout == run("solve", "four-bar.toml").stdout


def test_the_mechanism_of_a_link_is_edited_under_a_free_name(
    run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Unserved(LiveServer):
        def run(self, tell: Callable[[], None] = lambda: None) -> None:
            tell()
            self._workbench.handle(Save())

    monkeypatch.setattr("linkwork.app.commands.LiveServer", Unserved)
    for name in ("linked.toml", "linked2.toml", "linked3.toml"):
        done = run("view", LINK, "--no-browser", "--json")
        assert json.loads(done.stdout)["file"] == name
        assert (folder / name).read_text("utf-8") == FOUR_BAR


@pytest.mark.parametrize("suffix", ["svg", "png"])
def test_a_qr_code_is_written(run: Run, folder: Path, suffix: str) -> None:
    done = run("link", "four-bar.toml", "--app", APP, "--qr", f"code.{suffix}")
    assert done.stdout == f"{APP}{LINK}\nWrote code.{suffix}.\n"
    data = (folder / f"code.{suffix}").read_bytes()
    assert data.startswith({"svg": b"<svg xmlns", "png": b"\x89PNG"}[suffix])


def test_html_for_a_course_page_has_no_script(run: Run, folder: Path) -> None:
    title = '<b> & "quotes"'
    text = FOUR_BAR.replace('"Four-bar"', json.dumps(title))
    (folder / "odd.toml").write_text(text, encoding="utf-8")
    done = run("link", "odd.toml", "--app", "https://example.org/?a=1&b=2", "--embed")
    assert done.stdout == (
        f'<iframe src="https://example.org/?a=1&amp;b=2{fragment_of(text)}" '
        'title="&lt;b&gt; &amp; &quot;quotes&quot;" width="100%" height="640"\n'
        'loading="lazy" sandbox="allow-scripts allow-downloads"></iframe>\n'
    )


def test_json_has_all_of_it(run: Run) -> None:
    done = run("link", "four-bar.toml", "--app", APP, "--embed", "--qr", "a.svg", "--json")
    data = json.loads(done.stdout)
    assert data["link"] == APP + LINK
    assert data["characters"] == len(APP + LINK)
    assert data["embed"].startswith("<iframe ")
    assert data["written"] == ["a.svg"]
    assert json.loads(run("link", LINK, "--text", "--json").stdout)["text"] == FOUR_BAR


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            (LINK[:-3],),
            "Error: 1 problem in the link\n"
            "  is incomplete or was changed on its way: copy the whole link again\n",
        ),
        (
            ("https://example.org/four-bar.toml",),
            "Error: 1 problem in the link\n"
            "  has no mechanism: a link of Linkwork ends in #lw1= and the packed mechanism;\n"
            "  nothing is read from the network\n",
        ),
        (
            ("four-bar.toml", "--qr", "a.svg"),
            "Error: --qr needs the address of a Linkwork app: add --app URL, as in --app\n"
            "  https://example.org/linkwork/\n",
        ),
        (
            ("four-bar.toml", "--embed"),
            "Error: --embed needs the address of a Linkwork app: add --app URL, as in --app\n"
            "  https://example.org/linkwork/\n",
        ),
        (
            ("four-bar.toml", "--app", "example.org"),
            'Error: "example.org" is not the address of an app: give its whole URL without #,\n'
            "  as in https://example.org/linkwork/\n",
        ),
        (
            ("four-bar.toml", "--app", APP, "--qr", "a.jpg"),
            'Error: cannot write "a.jpg": a QR code needs the suffix .svg or .png\n',
        ),
        (
            ("a" * 300,),
            f"Error: 1 problem in\n  {'a' * 300}\n  cannot be read: File name too long\n",
        ),
    ],
)
def test_what_makes_no_sense_is_refused(run: Run, words: tuple[str, ...], message: str) -> None:
    done = run("link", *words)
    assert (done.exit_code, done.stdout, done.stderr) == (2, "", message)


def test_a_link_too_long_for_a_qr_code_is_refused(run: Run, folder: Path) -> None:
    noise = f"# {hashlib.shake_256().hexdigest(3000)}\n"
    (folder / "long.toml").write_text(FOUR_BAR + noise, encoding="utf-8")
    assert run("link", "long.toml", "--app", APP).exit_code == 0
    done = run("link", "long.toml", "--app", APP, "--qr", "a.svg")
    assert done.exit_code == 2
    assert done.stderr.startswith("Error: a QR code holds at most 2,953 characters, this link has ")
    assert not (folder / "a.svg").exists()
