"""The page that solves in a browser alone, from a host, from a disk and in a frame.

The engine is that of ``LINKWORK_PYODIDE``, a folder as ``scripts/web_files`` collects it.
"""

from __future__ import annotations

import base64
import json
import math
import os
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, ClassVar

import pytest

import linkwork as lw
from linkwork import example_text
from linkwork.app.live.session import BrowserDesk
from linkwork.app.web.web_app import pyodide_files, web_folder
from linkwork.synthesis.solvers.solving import solve_task
from tests.app.web.comparing import differences
from tests.library_mechanisms import driven_examples

_FOLDER = os.environ.get("LINKWORK_PYODIDE", "")
_READY = ".lw[data-row]"  # the first cycle is shown
_PATIENCE = 60_000  # [ms]: others may use the cores
#: Keeps the worker of the page, what it says and what it does.
_LISTENING = """
window.said = [];
window.done = [];
window.Worker = class extends Worker {
  constructor(...given) {
    super(...given);
    window.engine = this;
    this.addEventListener("message", ({data}) => {
      if (typeof data === "string") window.said.push(data);
      else window.done.push(data.doing ?? Object.keys(data)[0]);
    });
  }
};
delete window.showSaveFilePicker;
"""
#: The first bytes of the snapshot that is kept, or "" if there is none; it can be damaged.
_SNAPSHOT = """async (damage) => {
  const cache = await caches.open((await caches.keys())[0]), place = "https://linkwork.invalid/snapshot";
  const kept = await cache.match(place);
  if (!kept) return "";
  const bytes = new Uint8Array(await kept.arrayBuffer());
  if (damage) {
    bytes.fill(0, 0, 64);
    await cache.put(place, new Response(bytes, { headers: kept.headers }));
  }
  return bytes.subarray(0, 64).join();
}"""

#: Whether the atlas is kept for later visits.
_KEPT_ATLAS = """async () => {
  const cache = await caches.open((await caches.keys())[0]);
  return (await cache.keys()).some(({url}) => url.includes("paths.npz"));
}"""
#: A task of eleven points on an ellipse, the last of them twice.
_CURVE = base64.b64encode(
    (
        'format = 1\ntask = "path"\nmechanism = "four-bar"\n[improve]\nstarts = 2\n'
        + "".join(
            f"[[positions]]\npoint = [{50 * math.cos(a):.3f}, {20 * math.sin(a):.3f}]\n"
            for a in [*(k * math.tau / 12 for k in range(12)), 11 * math.tau / 12]
        )
    ).encode()
).decode()

pytestmark = pytest.mark.skipif(
    not _FOLDER, reason="needs LINKWORK_PYODIDE, a folder as scripts/web_files collects it"
)

Open = Callable[..., Any]


@dataclass
class Site:
    """A folder of the page, and the address of its host."""

    folder: Path
    address: str


class _Silent(SimpleHTTPRequestHandler):
    asked: ClassVar[list[str]] = []

    def log_message(self, *_: object) -> None:
        """Note what was asked for, and say nothing."""
        self.asked.append(self.path)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    """The page on a host of static files."""
    folder = tmp_path_factory.mktemp("site")
    for name, content in web_folder(pyodide_files(Path(_FOLDER))).items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(content)
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Silent, directory=str(folder)))
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield Site(folder, f"http://127.0.0.1:{server.server_port}/")
    server.shutdown()
    thread.join(10)
    server.server_close()


@pytest.fixture
def open_web(site: Site, watched: Callable[..., Any]) -> Open:
    """Opens a page."""

    def opened(address: str, **options: Any) -> Any:
        own = (site.address, site.folder.as_uri(), "blob:", "data:")
        page = watched(own, **options)
        page.context.set_default_timeout(_PATIENCE)
        page.context.add_init_script(_LISTENING)
        page.goto(address)
        return page

    return opened


def told(page: Any, kind: str) -> dict[str, Any]:
    """The last event of a kind."""
    events: list[dict[str, Any]] = [*map(json.loads, page.evaluate("() => window.said"))]
    return [event for event in events if event["kind"] == kind][-1]


def set_slider(page: Any, name: str, value: float, *, live: bool) -> None:
    """Drag a slider to a value; it is released if not ``live``."""
    page.locator(f'[data-number="{name}"] input[type=range]').evaluate(
        """(slider, [value, kind]) => {
          slider.value = String(value);
          slider.dispatchEvent(new Event(kind));
        }""",
        [value, "input" if live else "change"],
    )


def in_python(text: str, folder: Path) -> dict[str, Any]:
    """The cycle of a text, as the same program sends it here."""
    events: list[str] = []
    folder.mkdir(exist_ok=True)
    before = Path.cwd()
    os.chdir(folder)
    try:
        BrowserDesk(lw.loads, example_text, events.append, list, solve_task).open("a.toml", text)
    finally:
        os.chdir(before)
    return next(e for e in map(json.loads, events) if e["kind"] == "motion_found")


def asked(page: Any, request: dict[str, Any]) -> dict[str, Any]:
    """The answer of the worker to a request, past the state of the file and signs of work."""
    answer: dict[str, Any] = json.loads(
        page.evaluate(
            """(request) => new Promise((resolve) => {
              const id = (window.asked ??= 1000) + 1;
              window.asked = id;
              const hear = ({data}) => {
                if (typeof data !== "string") return;
                const {kind, answers} = JSON.parse(data);
                if (answers !== id || kind === "file_state" || kind === "working") return;
                window.engine.removeEventListener("message", hear);
                resolve(data);
              };
              window.engine.addEventListener("message", hear);
              window.engine.postMessage(JSON.stringify({...request, id}));
            })""",
            request,
        )
    )
    return answer


def assert_same(page: Any, names: list[str], folder: Path) -> None:
    """The browser's cycles of library mechanisms are those of CPython."""
    found = {}
    for name in names:
        event = asked(page, {"kind": "set_text", "text": example_text(name)})
        assert event["kind"] == "motion_found", (name, event)
        if problems := list(differences(event, in_python(example_text(name), folder))):
            found[name] = problems
    assert found == {}


def test_the_page_of_a_host_solves_as_python_does(
    open_web: Open, site: Site, tmp_path: Path
) -> None:
    page = open_web(f"{site.address}#example=four-bar")
    assert "For tests only" in page.locator("body").inner_text()
    page.wait_for_selector(_READY)
    assert_same(page, ["four-bar", "jansen-leg", "rapier-drive"], tmp_path)


def test_a_length_is_dragged_and_the_cycle_is_that_of_the_library(
    open_web: Open, site: Site, tmp_path: Path
) -> None:
    page = open_web(f"{site.address}#example=jansen-leg")
    page.wait_for_selector(_READY)
    state = told(page, "file_state")
    number = state["numbers"][0]
    for k in range(10):
        set_slider(page, number["name"], number["value"] * (1 + k / 1000), live=True)
    page.locator("#linkwork[data-live=true]").wait_for()
    set_slider(page, number["name"], number["value"] * 1.01, live=False)
    page.locator("#linkwork[data-live=false]").wait_for()
    state = told(page, "file_state")
    assert state["unsaved"]
    assert list(differences(told(page, "motion_found"), in_python(state["text"], tmp_path))) == []


def test_files_are_exported_or_the_missing_package_is_named(open_web: Open, site: Site) -> None:
    page = open_web(f"{site.address}#example=four-bar")
    page.wait_for_selector(_READY)
    for suffix, kind in {"html": "exported", "csv": "exported", "xlsx": "refused"}.items():
        answer = asked(page, {"kind": "export", "format": suffix, "row": None, "dark": False})
        assert answer["kind"] == kind, answer
    assert "pip install" in answer["message"]


def test_a_newer_change_cancels_a_cycle_that_is_being_solved(open_web: Open, site: Site) -> None:
    page = open_web(f"{site.address}#example=jansen-leg")
    page.wait_for_selector(_READY)
    assert_cancelled(page)


def assert_cancelled(page: Any) -> None:
    """Of two changes of Jansen's leg only the newer is solved."""
    changes = [
        json.dumps({"kind": "set_number", "name": "A B", "value": 50 + k / 10, "id": 1000 + k})
        for k in range(2)
    ]
    page.evaluate(
        """([first, second]) => {
          window.engine.postMessage(first);
          window.engine.postMessage(second);  // it waits when the first begins to be solved
        }""",
        changes,
    )
    page.wait_for_function(
        """() => window.said.map(JSON.parse).some(
          ({kind, answers}) => kind === "motion_found" && answers === 1001)"""
    )
    events = map(json.loads, page.evaluate("() => window.said"))
    assert [event["answers"] for event in events if event["kind"] == "motion_found"] == [None, 1001]


@pytest.mark.parametrize("early", [True, False])
def test_a_mechanism_of_the_library_is_chosen_while_the_engine_loads_or_later(
    early: bool, open_web: Open, site: Site
) -> None:
    page = open_web(site.address)
    if not early:
        page.wait_for_function("() => window.said.some((told) => told.includes('start_offered'))")
    page.locator(".lw-start [data-example=whitworth]").first.click()
    page.locator(".lw-file", has_text="whitworth").wait_for()
    assert told(page, "file_state")["text"] == example_text("whitworth")
    assert page.locator(".lw-start").count() == 0


def test_one_file_opens_from_a_disk_keeps_work_and_saves_it(open_web: Open, site: Site) -> None:
    page = open_web((site.folder / "index.html").as_uri(), offline=True)
    page.locator(".lw-start [data-example=four-bar]").first.click()
    page.wait_for_selector(_READY)
    # a disk's folder cannot be read by a page
    assert page.url.endswith("/linkwork.html#example=four-bar")
    page.locator('[data-number="A B"] input[type=text]').fill("125")
    page.keyboard.press("Enter")
    page.locator("[data-unsaved=true]").wait_for()
    page.on("dialog", lambda dialog: dialog.accept())  # changes are not saved
    page.reload()
    page.locator("[data-unsaved=true]").wait_for()
    text = told(page, "file_state")["text"]
    assert "125" in text
    with page.expect_download() as download:
        page.locator(".lw-save").click()
    assert Path(download.value.path()).read_text("utf-8") == text
    page.locator("[data-unsaved=false]").wait_for()
    assert page.evaluate("() => localStorage.length") == 0


def test_a_sandboxed_frame_solves(open_web: Open, site: Site) -> None:
    inside = f'<iframe sandbox="allow-scripts" src="{site.address}" width="1000" height="700">'
    (site.folder / "course.html").write_text(f'<link rel="icon" href="data:,">{inside}</iframe>')
    page = open_web(f"{site.address}course.html")
    frame = page.frame_locator("iframe")
    frame.locator(".lw-start [data-example=four-bar]").first.click()
    frame.locator(_READY).wait_for()


def test_the_second_visit_needs_no_network(open_web: Open, site: Site) -> None:
    page = open_web(f"{site.address}#example=four-bar")
    page.wait_for_selector(_READY)
    page.evaluate("() => navigator.serviceWorker.ready.then(() => undefined)")
    page.context.set_offline(True)
    page.reload()
    page.wait_for_selector(_READY)
    assert told(page, "motion_found")["missing"] == 0


def with_snapshot(page: Any) -> Any:
    """A page whose next visits start from a snapshot, without a network."""
    page.wait_for_selector(_READY)
    page.evaluate("() => navigator.serviceWorker.ready.then(() => undefined)")
    for _ in range(_PATIENCE // 1000):
        if page.evaluate(_SNAPSHOT, None):
            break
        page.wait_for_timeout(1000)
    page.context.set_offline(True)
    return page


@pytest.mark.extended
def test_a_later_visit_starts_from_a_snapshot_and_solves_as_python_does(
    open_web: Open, site: Site, tmp_path: Path
) -> None:
    page = with_snapshot(open_web(f"{site.address}#example=four-bar"))
    page.goto(f"{site.address}#example=jansen-leg")
    page.wait_for_selector(_READY)
    assert page.evaluate("() => window.done") == ["Starting Python …", "Solving …"]
    (worker,) = page.workers
    loaded = worker.evaluate("performance.getEntriesByType('resource').map(({ name }) => name)")
    assert [name for name in loaded if "wasm" in name]  # the worker's own request
    assert_cancelled(page)
    set_slider(page, "O A", 15.5, live=False)
    page.locator("[data-unsaved=true]").wait_for()
    page.wait_for_function("() => window.said.some((said) => said.includes('15.5'))")
    assert_same(page, driven_examples()[::8], tmp_path)


@pytest.mark.extended
def test_a_snapshot_that_cannot_be_read_is_made_again(open_web: Open, site: Site) -> None:
    page = with_snapshot(open_web(f"{site.address}#example=four-bar"))
    damaged = page.evaluate(_SNAPSHOT, "damage")
    page.reload()
    page.wait_for_selector(_READY)
    done = page.evaluate("() => window.done")
    assert done == ["Starting Python …", "again", "Starting Python …", *done[3:]]
    assert "Loading the solver …" in done
    with_snapshot(page)
    assert page.evaluate(_SNAPSHOT, None) != damaged


def test_the_atlas_is_loaded_when_it_is_asked_for_and_kept(open_web: Open, site: Site) -> None:
    _Silent.asked.clear()
    page = open_web(f"{site.address}#example=four-bar")
    page.wait_for_selector(_READY)
    sizes = {path: path.stat().st_size for path in (site.folder / "engine").iterdir()}
    loaded = sum(size for path, size in sizes.items() if path.suffixes[0] != ".npz")
    assert loaded < 10.5e6  # with the page itself: less than 11 MB at the first visit
    assert [path for path in _Silent.asked if ".npz" in path] == []
    answer = asked(page, {"kind": "open_file", "name": "a.toml", "content": _CURVE})
    assert answer["kind"] == "task_state"  # two positions at one place: nothing to be solved
    refused = asked(page, {"kind": "find_nearest"})
    assert "complete it first" in refused["message"]
    asked(page, {"kind": "remove_task_point", "of": "position", "index": 12})
    page.locator(".lw-task[data-solved]").wait_for()
    page.get_by_role("button", name="Nearest in the atlas").click()
    page.locator(".lw-t-designs tbody th", has_text="A10").wait_for()
    (one,) = (path for path in _Silent.asked if ".npz" in path)
    assert "paths.npz" in one
    page.wait_for_function(_KEPT_ATLAS)


@pytest.mark.extended
def test_all_driven_mechanisms_are_solved_as_in_python(
    open_web: Open, site: Site, tmp_path: Path
) -> None:
    page = open_web(f"{site.address}#example=four-bar")
    page.wait_for_selector(_READY)
    assert_same(page, driven_examples(), tmp_path)


@pytest.mark.extended
def test_a_simulation_in_a_browser_has_the_events_of_python(open_web: Open, site: Site) -> None:
    page = open_web(f"{site.address}#example=crank-press")
    page.wait_for_selector(".lw[data-row]")
    page.get_by_role("tab", name="Simulate").click()
    page.get_by_label("Until").fill("0.1")
    page.get_by_label("Start speed").fill("60 rad/s")
    page.get_by_label("Until").press("Enter")
    page.wait_for_selector('.lw-simulate [data-complete="true"]')
    own = lw.example("crank-press").simulate(0.1, start_speed="60 rad/s")
    found = told(page, "simulation_found")
    assert [event["row"] for event in found["events"]] == [
        row for row, word in enumerate(own.limit) if word
    ]
    assert found["rows"] == len(own)
    page.get_by_label("Until").fill("5000")
    page.get_by_label("Until").press("Enter")
    page.get_by_role("button", name="Cancel").click()
    page.get_by_text("The simulation was cancelled: simulate again").first.wait_for()
