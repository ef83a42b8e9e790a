"""A file of the visitor is opened or imported; a wrong one changes nothing."""

from __future__ import annotations

import base64
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import linkwork as lw
from linkwork import example_text
from linkwork.app.live import events as tell, requests as ask
from linkwork.app.live.messages import MessageError, decoded
from linkwork.app.live.opened_file import new_file, task_template
from linkwork.app.live.server import LiveServer
from linkwork.app.live.session import Bench
from linkwork.synthesis.solvers.solving import solve_task
from tests.readers.samples import GEOGEBRA, MJCF, PMKS_LINES, PYSLVS, URDF, dxf_text, packed

#: A file is dragged from another program onto the page, and dropped.
_DROP = """([name, code]) => {
  const data = new DataTransfer();
  data.items.add(new File([Uint8Array.from(atob(code), (c) => c.charCodeAt(0))], name));
  for (const kind of ["dragover", "drop"])
    document.body.dispatchEvent(
      new DragEvent(kind, { dataTransfer: data, bubbles: true, cancelable: true }));
}"""


@pytest.fixture
def sheet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Bench:
    """A bench on a four-bar in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return Bench(new_file("four-bar"), lw.loads, solve_task)


def file(name: str, content: str | bytes, *, discard: bool = False) -> ask.OpenFile:
    """A request to open a file."""
    data = content if isinstance(content, bytes) else content.encode()
    return ask.OpenFile(name=name, content=base64.b64encode(data).decode(), discard=discard)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("bar.json", lw.readers.exported(lw.example("hoeken"), "pylinkage").text),
        ("pmks.txt", PMKS_LINES),
        ("bar.pyslvs", PYSLVS),
        ("bar.ggb", packed(GEOGEBRA)),
        ("bar.xml", MJCF),
        ("arm.urdf", URDF),
        ("sketch.dxf", dxf_text()),
    ],
)
def test_a_file_of_another_program_opens_as_a_mechanism_with_what_it_lacks(
    sheet: Bench, name: str, content: str | bytes
) -> None:
    *_, opened = sheet.handle(file(name, content))
    assert isinstance(opened, tell.FileOpened)
    path = Path(name)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    found = lw.readers.imported(path)
    assert opened.carried == found.carried
    assert opened.left_out == tuple(map(str, found.left_out))
    assert sheet.current.name == f"{path.stem}.toml"
    assert not Path(sheet.current.name).exists()  # until it is saved


def test_files_of_linkwork_open_as_they_are(sheet: Bench) -> None:
    for text in (example_text("slider-crank"), task_template("five-poses").text):
        *_, opened = sheet.handle(file("mine.toml", text))
        assert isinstance(opened, tell.FileOpened)
        assert (sheet.text, opened.format) == (text, "")


@pytest.mark.parametrize(
    ("name", "content", "why"),
    [
        ("photo.png", b"\x89PNG\r\n\x1a\n\0", "is in no known format"),
        ("broken.toml", "[points", "is not TOML"),
        ("pyproject.toml", "[project]\n", "these begin with format = 1"),
        ("bar.json", '{"joints": 3}', "must be a list"),
        ("old.sam", "SAM", "no published format"),
        ("empty", "", "is in no known format"),
    ],
)
def test_a_wrong_file_says_why_and_the_sketch_stays(
    sheet: Bench, name: str, content: str | bytes, why: str
) -> None:
    sheet.handle(ask.SetNumber(name="O2 A", value=41))
    before = sheet.text, sheet.current.name
    (refused,) = sheet.handle(file(name, content, discard=True))
    assert isinstance(refused, tell.ProblemsFound)
    assert refused.where == name
    assert why in refused.problems[0].message
    assert (sheet.text, sheet.current.name) == before
    sheet.handle(ask.Undo())
    assert sheet.text == example_text("four-bar")


def test_unsaved_changes_are_not_lost_unasked(sheet: Bench) -> None:
    sheet.handle(ask.SetNumber(name="O2 A", value=41))
    before = sheet.text
    (refused,) = sheet.handle(file("bar.pyslvs", PYSLVS))
    assert isinstance(refused, tell.Refused)
    assert "are not saved" in refused.message
    assert sheet.text == before


@pytest.mark.parametrize(
    "name", ["../../x.pyslvs", "C:\\x.pyslvs", "x", "..", "a" * 300, "\n.toml"]
)
def test_names_of_files_stay_in_the_folder(sheet: Bench, tmp_path: Path, name: str) -> None:
    sheet.handle(file(name, PYSLVS))
    path = Path(sheet.current.name)
    assert path.resolve().parent == tmp_path
    assert len(path.name) < 100


def test_a_message_that_is_too_long_or_no_base64_is_refused(sheet: Bench) -> None:
    with pytest.raises(MessageError, match="at most 2400000 are read"):
        decoded(f'{{"kind": "open_file", "name": "a", "content": "{"A" * 2_400_001}"}}')
    (refused,) = sheet.handle(ask.OpenFile(name="a", content="é"))
    assert isinstance(refused, tell.Refused)
    assert "base64" in refused.message


def test_files_are_dropped_on_the_page(
    sheet: Bench, serve: Callable[[Bench], LiveServer], watched: Callable[..., Any]
) -> None:
    server = serve(sheet)
    page = watched((f"http://127.0.0.1:{server.port}/",))
    page.set_default_timeout(10_000)
    page.goto(server.address)
    page.locator(".lw[data-row]").wait_for()

    def drop(name: str, content: str) -> None:
        page.evaluate(_DROP, [name, base64.b64encode(content.encode()).decode()])

    drop("photo.png", "PNG")
    page.get_by_text("photo.png is not opened").wait_for()
    assert page.locator(".lw-file").inner_text() == "four-bar.toml"
    drop("arm.urdf", URDF)
    page.get_by_text("Imported arm.urdf (URDF): 5 points, 3 links, 2 inputs.").wait_for()
    assert page.locator(".lw-message li").count() == 3
    # on the start page the reason is where it can be seen
    page.get_by_role("button", name="New", exact=False).first.click()
    drop("photo.png", "PNG")
    page.locator(".lw-start-note", has_text="photo.png is not opened").wait_for()
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Open a file").click()
    chooser.value.set_files(
        {"name": "three.toml", "mimeType": "", "buffer": task_template("three-poses").text.encode()}
    )
    page.locator(".lw-task[data-solved]").wait_for()
    assert page.locator(".lw-start").count() == 0
    page.locator(".lw-task .lw-message", has_text="Opened three.toml.").wait_for()
