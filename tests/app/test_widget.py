"""The notebook widget: its state in Python, its front end in a browser with a stub of a model."""

from __future__ import annotations

import builtins
import json
from collections.abc import Callable
from functools import partial
from importlib import resources
from pathlib import Path
from typing import Any

import pytest
import traitlets

import linkwork as lw
from linkwork.app import motion_page, motions_widget
from linkwork.app.pages.notebook import _widget_class
from linkwork.app.pages.offline_page import page_json
from linkwork.core.motion.iterating import moving_loops


@pytest.fixture(scope="module")
def circuits() -> dict[str, lw.Motion]:
    return lw.example("four-bar").cycles()


@pytest.fixture(scope="module")
def limited() -> lw.Motion:
    return lw.example("rapier-drive-limited").sweep()


def _page(motions: dict[str, lw.Motion], **options: Any) -> Any:
    return json.loads(page_json(motion_page(motions, **options)))


def test_its_state_is_the_data_of_the_page(circuits: dict[str, lw.Motion]) -> None:
    bar = lw.example("four-bar")
    widget = bar.widget(all_circuits=True)
    assert widget.get_state()["page"] == _page(
        circuits, equations=bar.equations().mathml(), loops=partial(moving_loops, bar.model)
    )
    assert widget.configuration == "circuit 1"
    assert widget.row == 0


def test_a_motion_has_one_of_its_own(limited: lw.Motion) -> None:
    widget = limited.widget()
    assert widget.page == _page({"motion": limited})
    assert widget.row == limited.found.argmax()
    assert widget.configuration == "motion"


def test_a_notebook_without_widgets_shows_a_picture(limited: lw.Motion) -> None:
    data, *_ = limited.widget()._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in data
    assert data["text/html"] == limited._repr_html_()


def test_a_row_without_a_position_is_refused(limited: lw.Motion) -> None:
    widget = limited.widget()
    missing = int((~limited.found).argmax())
    found = limited.found.nonzero()[0]
    with pytest.raises(traitlets.TraitError) as caught:
        widget.row = missing
    assert str(caught.value) == (
        f'row {missing} of "motion" has no position to show: '
        f"{len(found)} rows from {found[0]} to {found[-1]} have one"
    )
    widget.row = int(found[-1])
    assert widget.row == found[-1]


def test_an_unknown_configuration_is_refused_with_those_that_exist(
    circuits: dict[str, lw.Motion],
) -> None:
    widget = motions_widget(circuits)
    with pytest.raises(traitlets.TraitError) as caught:
        widget.configuration = "circuit 3"
    assert str(caught.value) == (
        'there is no configuration "circuit 3" (configurations: circuit 2, circuit 1)'
    )


def test_another_configuration_keeps_the_row_or_takes_the_nearest(limited: lw.Motion) -> None:
    widget = motions_widget({"part": limited, "start": lw.example("four-bar").sweep(to=90)})
    widget.row = int(limited.found.nonzero()[0][-1])
    assert widget.row > 90
    widget.configuration = "start"
    assert widget.row == 90
    widget.row = 7
    widget.configuration = "part"
    assert widget.row == 7


def test_all_circuits_are_the_mechanisms_own(circuits: dict[str, lw.Motion]) -> None:
    with pytest.raises(
        lw.InputError, match=r"^a widget shows either the given motion or all circuits, not both$"
    ):
        lw.example("four-bar").widget(circuits["circuit 1"], all_circuits=True)


def test_without_anywidget_the_message_has_the_command(
    limited: lw.Motion, monkeypatch: pytest.MonkeyPatch
) -> None:
    really = builtins.__import__

    def without(name: str, *rest: Any, **named: Any) -> Any:
        if name == "anywidget":
            raise ModuleNotFoundError(name)
        return really(name, *rest, **named)

    monkeypatch.setattr(builtins, "__import__", without)
    _widget_class.cache_clear()
    with pytest.raises(lw.MissingPackageError) as caught:
        limited.widget()
    assert str(caught.value) == 'widgets need anywidget: pip install "linkwork[notebook]"'


# In a browser

_STUB = """<!doctype html><html><head><meta charset="utf-8"><style>
td { color: rgb(1, 2, 3) !important; }</style></head>
<body data-jp-theme-light="false"><div id="one"></div><div id="two"></div>
<script>
window.told = [];
window.modelOf = (state) => {
  const heard = {}, fresh = {};
  const fire = (name) => (heard["change:" + name] || []).slice().forEach((one) => one());
  return {
    state,
    get: (name) => state[name],
    set(name, value) {
      if (state[name] === value) return;
      state[name] = fresh[name] = value;
      fire(name);
    },
    save_changes() { told.push(structuredClone(fresh)); for (const k in fresh) delete fresh[k]; },
    on: (event, one) => (heard[event] ||= []).push(one),
    off: (event, one) => (heard[event] = heard[event].filter((other) => other !== one)),
    python(name, value) { state[name] = value; fire(name); },
    listeners: () => Object.values(heard).flat().length,
  };
};
</script>
<script type="module">
const script = document.getElementById("esm").textContent;
const url = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
window.asked = (await import(url)).default;
window.mountAt = (id, state) => {
  const model = modelOf(state);
  const gone = asked.render({ model, el: document.getElementById(id) });
  return { model, gone, lw: document.querySelector(`#${id} > div`).shadowRoot };
};
</script></body></html>"""

Mounted = Callable[..., Any]


@pytest.fixture
def notebook(browser: Any, tmp_path: Path) -> Any:
    """A page that imports the widget's script as anywidget does; fails on any message."""
    script = (resources.files("linkwork.app") / "static" / "widget.js").read_text("utf-8")
    target = tmp_path / "notebook.html"
    assert "</script" not in script
    holder = f'<script id="esm" type="text/plain">{script}</script>\n<script>\nwindow.told'
    target.write_text(_STUB.replace("<script>\nwindow.told", holder), "utf-8")
    context = browser.new_context(
        offline=True, reduced_motion="reduce", viewport={"width": 1000, "height": 900}
    )
    page = context.new_page()
    said: list[str] = []
    page.on("console", lambda message: said.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(target.as_uri())
    page.wait_for_function("!!window.mountAt")
    yield page
    context.close()
    assert said == []


def _mount(page: Any, motions: dict[str, lw.Motion], **state: Any) -> None:
    first = {"configuration": next(iter(motions)), "row": 0, "page": _page(motions)}
    page.evaluate("state => { window.one = mountAt('one', state); }", first | state)


def _shown(page: Any) -> int:
    return int(page.evaluate("one.lw.querySelector('.lw').dataset.row"))


def test_it_shows_what_the_model_says(notebook: Any, circuits: dict[str, lw.Motion]) -> None:
    _mount(notebook, circuits, configuration="circuit 2", row=33)
    assert _shown(notebook) == 33
    assert notebook.evaluate("one.lw.querySelector('select').selectedIndex") == 1
    notebook.evaluate("one.model.python('row', 120)")
    assert _shown(notebook) == 120
    notebook.evaluate("one.model.python('configuration', 'circuit 1')")
    assert notebook.evaluate("one.lw.querySelector('select').selectedIndex") == 0
    assert _shown(notebook) == 120
    assert notebook.evaluate("told") == []  # what Python said is not told to Python


def test_what_the_person_does_is_told_to_python(
    notebook: Any, circuits: dict[str, lw.Motion]
) -> None:
    _mount(notebook, circuits, row=10)
    notebook.locator("#one .lw-canvas").click(position={"x": 5, "y": 5})
    for _ in range(3):
        notebook.keyboard.press("ArrowRight")
    # keys that come quickly are told together, or one after the other on a slow machine
    notebook.wait_for_function("told.at(-1)?.row === 13")
    assert _shown(notebook) == 13
    notebook.keyboard.press("PageDown")
    notebook.wait_for_function("told.at(-1).configuration")
    assert notebook.evaluate("one.model.state.configuration") == "circuit 2"
    assert notebook.evaluate("one.model.state.row") == _shown(notebook)


def test_keys_elsewhere_on_the_page_are_left_alone(
    notebook: Any, circuits: dict[str, lw.Motion]
) -> None:
    _mount(notebook, circuits)
    notebook.evaluate("document.activeElement.blur()")
    notebook.keyboard.press("ArrowRight")
    assert _shown(notebook) == 0


def test_styles_neither_come_in_nor_go_out_and_colours_are_the_notebooks(
    notebook: Any, circuits: dict[str, lw.Motion]
) -> None:
    _mount(notebook, circuits)
    colour = "getComputedStyle(one.lw.querySelector('td')).color"
    assert notebook.evaluate(colour) != "rgb(1, 2, 3)"
    assert notebook.evaluate("getComputedStyle(document.body).marginTop") == "8px"
    theme = "one.lw.querySelector('.lw').dataset.theme"
    assert notebook.evaluate(theme) == "dark"
    notebook.evaluate("document.body.dataset.jpThemeLight = 'true'")
    notebook.wait_for_function(f"{theme} === 'light'")


def test_two_do_not_disturb_each_other_and_one_goes_away_whole(
    notebook: Any, circuits: dict[str, lw.Motion]
) -> None:
    _mount(notebook, circuits, row=5)
    other = {"configuration": "motion", "row": 50, "page": _page({"motion": circuits["circuit 1"]})}
    notebook.evaluate("state => { window.two = mountAt('two', state); }", other)
    assert notebook.evaluate("two.lw.querySelector('.lw').dataset.row") == "50"
    assert _shown(notebook) == 5
    notebook.evaluate("window.old = two.lw.querySelector('.lw'), two.gone()")
    notebook.evaluate("document.body.dataset.jpThemeLight = 'true'")
    notebook.wait_for_function("one.lw.querySelector('.lw').dataset.theme === 'light'")
    assert notebook.evaluate("old.dataset.theme") == "dark"
    assert notebook.evaluate("two.model.listeners()") == 0
    assert notebook.evaluate("two.lw.querySelector('.lw')") is None
    assert _shown(notebook) == 5
