"""The picture while a number is dragged: on a canvas, and afterwards in elements as before."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.live.opened_file import MechanismFile
from tests.app.conftest import browser as browser  # the fixture, for this folder too
from tests.app.live.test_by_keyboard import shown

Image = pytest.importorskip("PIL.Image")

#: Drags a slider by some steps, one for each answer, and waits until the last one is drawn.
_DRAGGED = """async ([name, share]) => {
  const page = document.getElementById('linkwork');
  const slider = document.querySelector(`[data-number="${name}"] input[type=range]`);
  const from = Number(slider.value);
  for (let k = 1; k <= 4; k++) {
    const drawn = new Promise(done => {
      const watch = new MutationObserver(() => (watch.disconnect(), done()));
      watch.observe(page, { attributeFilter: ['data-updates'] });
    });
    slider.value = String(from * (1 + share * k / 4));
    slider.dispatchEvent(new Event('input'));
    await drawn;
  }
}"""
#: Hides the buttons, as the page's content security policy allows.
_BARE = """() => {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync('.lw-tools, .lw-zoom { visibility: hidden }');
  document.adoptedStyleSheets = [...document.adoptedStyleSheets, sheet];
}"""
#: The page for a reader with eyes and without.
_STATE = """() => {
  const all = (selector, told) => [...document.querySelectorAll(selector)].map(told);
  const drawn = ['transform', 'd', 'cx', 'cy', 'r', 'class', 'style'];
  return {
    shapes: all('.lw-shapes :is(g, path, circle, text)', one =>
      [...drawn.map(name => one.getAttribute(name)), one.textContent].join(' ')),
    handles: all('.lw-handles circle', one => one.outerHTML),
    curves: all('.lw-curve', one => one.getAttribute('d')),
    cells: all('.lw-table td, .lw-value, .lw-proof dd', one => one.textContent),
    name: document.querySelector('.lw-drawing').getAttribute('aria-label'),
    words: document.querySelector('.lw-words').textContent,
  };
}"""


def _picture(page: Any) -> np.ndarray:
    """The drawing as it is on the screen, without buttons."""
    page.evaluate(_BARE)
    image = Image.open(io.BytesIO(page.locator(".lw-canvas").screenshot()))
    return np.asarray(image.convert("RGB"), dtype=float)


def _opened(browser: Any, text: str, folder: Path) -> Any:
    path = folder / "mechanism.toml"
    path.write_text(text, encoding="utf-8")
    return shown(browser, MechanismFile(path))


def _solved(page: Any, before: str) -> None:
    """Wait for the proved motion after so many updates."""
    page.locator(f"#linkwork:not([data-updates='{before}'])[data-live=false]").wait_for()


def _canvas(page: Any) -> int:
    return int(page.locator(".lw-quick").count())


@pytest.mark.parametrize(
    ("example", "length"),
    [
        ("four-bar", None),
        pytest.param("jansen-leg", "O A", marks=pytest.mark.extended),
        pytest.param("crank-press", "O A", marks=pytest.mark.extended),
        pytest.param("cam-roller-follower", None, marks=pytest.mark.extended),
    ],
)
def test_a_dragged_picture_is_that_of_the_elements(
    browser: Any, tmp_path: Path, example: str, length: str | None
) -> None:
    field = '[data-number="{}"] input[type=text]'
    with _opened(browser, lw.example_text(example), tmp_path) as (page, _):
        page.wait_for_selector(".lw[data-row]")
        name = length or page.locator("[data-number]").first.get_attribute("data-number")
        page.clock.install()  # a drag that does not rest
        page.clock.pause_at(page.evaluate("Date.now()") + 1000)
        page.evaluate(_DRAGGED, [name, 0.02])
        assert _canvas(page) == 1
        assert not page.locator(".lw-shapes").is_visible()
        quick = _picture(page)
        page.clock.run_for(1000)  # now it rests
        page.wait_for_function("() => !document.querySelector('.lw-quick')")
        slow = _picture(page)
        # the same colours at the same places; edges of lines are smoothed in other ways
        assert np.abs(quick - slow).mean() < 0.5
        assert (np.abs(quick - slow).max(axis=2) > 96).mean() < 1e-3
        # the drag ends: everything is as on a page that never saw it
        before = page.locator("#linkwork").get_attribute("data-updates")
        page.locator(f'[data-number="{name}"] input[type=range]').dispatch_event("change")
        _solved(page, before)
        page.clock.run_for(1000)
        left, value = page.evaluate(_STATE), page.locator(field.format(name)).input_value()
    with _opened(browser, lw.example_text(example), tmp_path) as (page, _):
        page.wait_for_selector(".lw[data-row]")
        before = page.locator("#linkwork").get_attribute("data-updates")
        page.locator(field.format(name)).fill(value)
        page.keyboard.press("Enter")
        _solved(page, before)
        page.wait_for_timeout(800)  # the position is told to screen readers
        assert page.evaluate(_STATE) == left
