"""A monkey at the live page: random actions of a person, after which page and file must agree."""

from __future__ import annotations

import json
import math
import random
import shutil
import tempfile
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import linkwork as lw
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.server import LiveServer
from linkwork.app.live.workbench import Workbench
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.textfile.reader import blank_sheet

__all__ = ["monkey_at", "monkey_campaign"]

_ACTIONS = 50  # at every mechanism
_SOON = 300  # ms, after which the page has told the width of its sheet
_COMPARED = 10  # actions between comparisons
_WINDOW = {"width": 1440, "height": 900}
_PATIENCE = 60_000  # ms for an answer
_NEAR = 1e-6  # of the size: drawn points agree with solved ones
#: Buttons that leave the page, open another file, or write files that take long.
_NOT = "New|Reload|Save|GIF|MP4|Share|Overwrite|Copy.*|Presentation|Print"
_KEYS = (
    "ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End", " ", "Escape", "Delete",
    "Tab", "Enter", "Control+z", "Control+Shift+z", "?", "f", *"mvlpsgdtmvlpsgdt",
)  # fmt: skip
_TYPED = ("0", "-5", "12.5", "3 in", "20 mm", "1e9", "-1e-9", "abc", "", "1e400", "nan", "7°")

#: Functions by name, for the page.
_PAGE = (Path(__file__).with_name("monkey.js")).read_text(encoding="utf-8").partition("\n")[2]


def _of_page(name: str) -> str:
    """A function of the page, as an expression."""
    return f"({_PAGE.strip()}).{name}"


class Monkey:
    """Random actions at a page of one workbench, and what is claimed of them."""

    def __init__(self, page: Any, bench: Workbench, seed: int) -> None:
        self.page, self.bench, self.rng = page, bench, random.Random(seed)
        self.begun = bench.text
        self.file = page.evaluate("() => window.seen.state.file")
        self.done: list[str] = []

    def act(self) -> None:
        """One action: a click, a drag, a key, a typed number or a changed text."""
        weights = {
            self._click: 18, self._drag: 30, self._key: 22, self._button: 12,
            self._type: 8, self._choose: 4, self._wheel: 4, self._text: 2,
        }  # fmt: skip
        (act,) = self.rng.choices(list(weights), list(weights.values()))
        act()

    def settle(self) -> None:
        """Wait until every request has its answer."""
        quiet = f"() => {_of_page('quiet')}()"
        try:
            self.page.wait_for_function(quiet, timeout=_PATIENCE)
        except Exception as error:
            if type(error).__name__ != "TimeoutError":  # that of Playwright
                raise
            waiting = self.page.evaluate("() => [...window.seen.pending.values()]")
            raise AssertionError(f"not answered: {waiting}") from None

    def problems(self) -> Iterator[str]:
        """What page and file do not agree in."""
        self.page.keyboard.press("Escape")
        self.page.keyboard.press("Escape")
        self.page.wait_for_timeout(_SOON)
        self.settle()
        seen = self.page.evaluate("() => window.seen.state")
        if seen["text"] != self.bench.text:
            yield "the page has another text than the file"
        if seen["unsaved"] != self.bench.unsaved:
            yield "the page does not know what is saved"
        shown = self._ask("shown")
        if shown["lost"] or not shown["able"]:
            yield "no action is possible"
        yield from shown["mistakes"]
        wrong = list(self._places(shown))
        if wrong:  # another drawing may be on its way: that of a sheet is not counted
            self.page.wait_for_timeout(10 * _SOON)
            self.settle()
            wrong = list(self._places(self._ask("shown")))
        yield from wrong

    def undone(self) -> Iterator[str]:
        """Undo everything: the text is that of the beginning, unless another file was opened."""
        for _ in range(400):
            self.settle()
            name = self.page.evaluate("() => window.seen.state.undo")
            if not name:
                break
            self._ask("undo")
        self.settle()
        if self.page.evaluate("() => window.seen.state.file") != self.file:
            return
        if self.bench.text != self.begun:
            yield "undoing everything does not give the text of the beginning"
        if self.page.evaluate("() => window.seen.state.text") != self.begun:
            yield "after undoing everything the page has another text"

    def _places(self, shown: dict[str, Any]) -> Iterator[str]:
        """The points of the drawing where the mechanism has them."""
        subject = self.bench.cycle.subject
        names = list(getattr(subject.description, "points", {}))
        if not shown["points"] or not names or shown["elsewhere"]:
            return
        row, motion = shown["row"], self.bench.cycle.motion
        if shown["edited"] or motion is None or subject.solvable is None:
            places = subject.places()
            if not places and isinstance(subject.description, Draft):
                draft = subject.description.drawable
                sketch = {name: draft.sketched(name) for name in draft.points}
                places = {name: (z.real, z.imag) for name, z in sketch.items()}
        elif row is None or row >= len(motion) or not motion.found[row]:
            return
        else:
            names = list(motion.points)
            places = {
                p: (float(x.value[row]), float(y.value[row])) for p, (x, y) in motion.points.items()
            }
        if not places:
            return
        names = list(places)
        size = max(math.hypot(*place) for place in places.values()) or 1.0
        for number, x, y in shown["points"]:
            if number >= len(names) or math.dist((x, y), places[names[number]]) > _NEAR * size:
                where = "in the sketch" if shown["edited"] else f"in row {row}"
                yield f"a point is drawn at {x:.6g}, {y:.6g} {where}"
                return

    def _ask(self, name: str, argument: object = None) -> Any:
        return self.page.evaluate(f"argument => {_of_page(name)}(argument)", argument)

    # Actions

    def _place(self) -> tuple[float, float]:
        """A pin or another place on the drawing."""
        box = self.page.locator(".lw-drawing").bounding_box()
        pins = self._ask("things", ["circle[data-role=pin], .lw-points circle", "$^"])
        if pins and self.rng.random() < 0.6:
            x, y, _ = self.rng.choice(pins)
            return x, y
        x, y = self.rng.random(), self.rng.random()
        return box["x"] + box["width"] * x, box["y"] + box["height"] * y

    def _click(self) -> None:
        x, y = self._place()
        self.done.append(f"click {x:.0f} {y:.0f}")
        self.page.mouse.click(x, y, click_count=self.rng.choice([1, 1, 1, 2]))

    def _drag(self) -> None:
        mouse, (x, y), (u, v) = self.page.mouse, self._place(), self._place()
        self.done.append(f"drag {x:.0f} {y:.0f} {u:.0f} {v:.0f}")
        mouse.move(x, y)
        mouse.down()
        mouse.move(u, v, steps=self.rng.choice([1, 3, 6]))
        if self.rng.random() < 0.1:
            self.page.keyboard.press(self.rng.choice(["Escape", "Control+z", "Delete"]))
        mouse.up()

    def _key(self) -> None:
        key = self.rng.choice(_KEYS)
        self.done.append(f"key {key}")
        self.page.keyboard.press(key)

    def _button(self) -> None:
        kind = self.rng.choice(
            [
                "button",
                "button",
                "[role=tab]",
                ".lw-tools button",
                "summary",
                "input[type=checkbox]",
            ]
        )
        if found := self._ask("things", [kind, _NOT]):
            x, y, name = self.rng.choice(found)
            self.done.append(f"button {name}")
            self.page.mouse.click(x, y)

    def _type(self) -> None:
        if found := self._ask("things", ["input[type=text], input[type=number]", "$^"]):
            x, y, name = self.rng.choice(found)
            typed = self.rng.choice([*_TYPED, f"{self.rng.uniform(-50, 200):.3g}"])
            self.done.append(f"type {typed!r} in {name}")
            self.page.mouse.click(x, y, click_count=3)
            self.page.keyboard.type(typed)
            self.page.keyboard.press(
                self.rng.choice(["Enter", "Enter", "Tab", "Escape", "Control+z"])
            )

    def _choose(self) -> None:
        """Another entry of a list, or a place on a slider."""
        if found := self._ask("things", ["select, input[type=range]", "$^"]):
            x, y, name = self.rng.choice(found)
            self.done.append(f"choose {name}")
            self._ask("choose", [x, y, self.rng.random()])

    def _wheel(self) -> None:
        self.page.mouse.move(*self._place())
        self.done.append("wheel")
        self.page.mouse.wheel(0, self.rng.choice([-400, -100, 100, 400]))

    def _text(self) -> None:
        """Change a line of the text of the file by hand."""
        tab = self.page.get_by_role("tab", name="Build")
        if not tab.count():  # a presentation has none
            return
        tab.evaluate("tab => tab.click()")
        area = self.page.locator(".lw-build textarea")
        lines = area.input_value().split("\n")
        k = self.rng.randrange(len(lines))
        lines[k] = self.rng.choice(["", lines[k] * 2, lines[k].replace("1", "2"), "[", "x = 1"])
        self.done.append(f"text line {k}: {lines[k]!r}")
        self._ask("write", "\n".join(lines))


def start_text(number: int) -> str:
    """A mechanism of the library, a random draft, or a blank sheet."""
    library = lw.examples()
    if number % 10 == 9:
        return blank_sheet("Untitled")
    if number % 2 == 0:
        return lw.example_text(list(library)[(number // 2) % len(library)])
    rng = random.Random(number)
    names = "ABCDEFGH"[: rng.randrange(2, 9)]
    points = [f"{p} = [{rng.uniform(-80, 80):.4g}, {rng.uniform(-50, 50):.4g}]" for p in names]
    links = [
        f"link{k} = {json.dumps(rng.sample(names, min(len(names), rng.choice([2, 2, 2, 3]))))}"
        for k in range(1, rng.randrange(2, 7))
    ]
    if rng.random() < 0.7:
        links.append(f"ground = {json.dumps(rng.sample(names, min(len(names), 2)))}")
    driven = ['[input]\nlink = "link1"'] if rng.random() < 0.6 else []
    return "\n".join(
        ["format = 1", 'name = "Random"', "[points]", *points, "[links]", *links, *driven, ""]
    )


@contextmanager
def _served(bench: Workbench) -> Iterator[LiveServer]:
    server = LiveServer(bench)
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        yield server
    finally:
        server.stop()
        thread.join(30)


def open_page(browser: Any, server: LiveServer, said: list[str]) -> Any:
    """A page of the server; what its console says goes to ``said``."""
    page = browser.new_context(viewport=_WINDOW, reduced_motion="reduce").new_page()
    page.set_default_timeout(60_000)
    page.on("console", lambda message: said.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("dialog", lambda dialog: dialog.accept())
    page.add_init_script(f"{_of_page('watch')}()")
    page.goto(server.address)
    page.wait_for_function(
        "() => window.seen.state !== null && document.querySelector('.lw-drawing')"
    )
    return page


def at_work(monkey: Monkey, actions: int, counts: Counter[str]) -> Iterator[str]:
    """Act, and compare page and file now and then, and when all is undone."""
    monkey.settle()
    for k in range(1, actions + 1):
        monkey.act()
        counts["actions"] += 1
        if k % _COMPARED == 0:
            yield from (
                f"{claim} after {', '.join(monkey.done[-15:])}" for claim in monkey.problems()
            )
            counts["comparisons"] += 1
    yield from monkey.undone()


def monkey_at(browser: Any, numbers: range, counts: Counter[str]) -> Iterator[str]:
    """False claims at mechanisms with these numbers."""
    with tempfile.TemporaryDirectory() as folder:
        for number in numbers:
            path = Path(folder) / f"mechanism-{number}.toml"
            path.write_text(start_text(number), encoding="utf-8")
            said: list[str] = []
            bench = Workbench(MechanismFile(path), lw.loads)
            with _served(bench) as server:
                page = open_page(browser, server, said)
                for claim in (*at_work(Monkey(page, bench, number), _ACTIONS, counts), *said):
                    yield f"{number}: {claim}"
                page.context.close()
            counts["mechanisms"] += 1


def monkey_campaign(size: int) -> tuple[Counter[str], list[str]]:
    """``size`` actions in all, 50 at every mechanism, in Chromium."""
    from playwright.sync_api import sync_playwright

    counts: Counter[str] = Counter()
    with sync_playwright() as playwright:
        program = shutil.which("chromium")
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        false = list(monkey_at(browser, range(-(-size // _ACTIONS)), counts))
        browser.close()
    return counts, false
