"""The page in a real browser: what a person does with it, and the numbers it shows."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.app import motion_page, offline_page
from linkwork.app.pages.moving_scene import moving_scene
from linkwork.app.pages.offline_page import page_json
from linkwork.app.pages.packing import play_order, unpressed
from linkwork.app.pages.page_building import drawn_page
from linkwork.core.drawing import render
from linkwork.core.drawing.annotations import Force
from linkwork.core.drawing.scene import Disc, Role
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.motion.iterating import moving_loops
from tests.described import described_as

Open = Callable[..., Any]


@pytest.fixture(scope="module")
def jansen() -> lw.Motion:
    return lw.example("jansen-leg").cycle()


@pytest.fixture(scope="module")
def limited() -> lw.Motion:
    return lw.example("rapier-drive-limited").cycle()


def _row(page: Any) -> int:
    return int(page.locator(".lw").get_attribute("data-row"))


def _until(page: Any, condition: str) -> None:
    """Wait until an expression holds; the page's own policy forbids Playwright's way of waiting."""
    for _ in range(200):
        if page.evaluate(condition):
            return
        page.wait_for_timeout(25)
    pytest.fail(f"never came true: {condition}")


def _number(text: str) -> float:
    return float(re.sub(r"[^0-9.\-].*$", "", text.replace("\u2212", "-")))


def _cells(page: Any, name: str) -> list[str]:
    found: list[str] = (
        page.locator("tr", has=page.get_by_role("rowheader", name=name, exact=True))
        .first.locator("td")
        .all_inner_texts()
    )
    return found


def _pin(page: Any, name: str, motion: lw.Motion) -> tuple[float, float]:
    """The place of a moving point on the screen."""
    handle = page.locator(f'.lw-handle[data-point="{list(motion.points).index(name)}"]')
    box = handle.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def test_table_shows_the_numbers_of_the_library(open_page: Open, jansen: lw.Motion) -> None:
    page = open_page({"motion": jansen})
    for row in (0, 123, 360):
        page.evaluate(f"linkwork.goToRow({row % 360})")
        assert _number(_cells(page, "foot")[0]) == pytest.approx(
            jansen["foot"][row % 360], rel=1e-5
        )
        assert _number(_cells(page, "foot")[1]) == pytest.approx(
            jansen["foot.d1"][row % 360], rel=1e-3
        )
        assert _number(_cells(page, "F")[0]) == pytest.approx(jansen["F.x"][row % 360], rel=1e-5)
    assert page.locator('[data-fact="position"]').inner_text() == "position found"
    assert "a true position lies within" in page.locator('[data-fact="proof"]').inner_text()


def test_dragging_the_crank_pin_around_turns_the_crank(open_page: Open, jansen: lw.Motion) -> None:
    page = open_page({"motion": jansen})
    x0, y0 = _pin(page, "A", jansen)
    centre = page.locator('circle[data-of="O"][data-role="pin"]').bounding_box()
    ox, oy = centre["x"] + centre["width"] / 2, centre["y"] + centre["height"] / 2
    radius, start = math.hypot(x0 - ox, y0 - oy), math.atan2(oy - y0, x0 - ox)
    page.mouse.move(x0, y0)
    page.mouse.down()
    for degrees in range(0, 451, 15):
        angle = start + math.radians(degrees)
        page.mouse.move(ox + 1.3 * radius * math.cos(angle), oy - 1.3 * radius * math.sin(angle))
    page.mouse.up()
    assert _row(page) == pytest.approx(90, abs=2)


def test_dragging_goes_on_through_a_dead_point(open_page: Open, limited: lw.Motion) -> None:
    page = open_page({"motion": limited})
    rows = []
    turning = limited["θ12"]
    ox, oy = _centre(page, "A0")
    x, y = _pin(page, "A", limited)
    page.mouse.move(x, y)
    page.mouse.down()
    radius = math.hypot(x - ox, y - oy)
    for degrees in [*range(0, 161, 5), *range(160, 99, -5)]:
        angle = math.radians(degrees)
        page.mouse.move(ox + radius * math.cos(angle), oy - radius * math.sin(angle))
        rows.append(_row(page))
    page.mouse.up()
    assert turning[rows].max() == pytest.approx(149.617, abs=0.1)  # the dead point is reached
    assert limited.branch[rows[0]] != limited.branch[rows[-1]]  # and passed
    assert turning[rows[-1]] == pytest.approx(100, abs=3)


def _centre(page: Any, name: str) -> tuple[float, float]:
    box = page.locator(f'circle[data-of="{name}"][data-role="pin"]').bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def test_keys_step_play_and_go_to_the_ends(open_page: Open, jansen: lw.Motion) -> None:
    page = open_page({"motion": jansen})
    keys = page.keyboard
    rows = []
    for key in ("ArrowRight", "Shift+ArrowRight", "ArrowLeft", "End", "ArrowRight", "Home"):
        keys.press(key)
        rows.append(_row(page))
    assert rows == [1, 11, 10, 359, 0, 0]
    play = page.get_by_role("button", name="Play")
    keys.press("Space")
    _until(page, "Number(document.querySelector('.lw').dataset.row) > 5")
    keys.press("Space")
    assert play.is_visible()
    resting = _row(page)
    page.wait_for_timeout(120)
    assert _row(page) == resting


def test_motion_is_still_where_reduced_motion_is_preferred(
    open_page: Open, jansen: lw.Motion
) -> None:
    page = open_page({"motion": jansen})
    page.wait_for_timeout(150)
    assert _row(page) == 0
    moving = open_page({"motion": jansen}, reduced_motion="no-preference")
    _until(moving, "Number(document.querySelector('.lw').dataset.row) > 2")


def test_choosing_a_circuit_shows_it_at_the_same_input(open_page: Open) -> None:
    four_bar = lw.example("four-bar")
    motions = four_bar.cycles()
    assert len(motions) == 2
    page = open_page(motions)
    page.evaluate("linkwork.goToRow(75)")
    page.get_by_label("Circuit").select_option("circuit 2")
    (name,) = [n for n in motions["circuit 2"].unknowns if n != "coupler"]
    assert _row(page) == 75
    assert _number(_cells(page, name)[0]) == pytest.approx(motions["circuit 2"][name][75], rel=1e-5)
    assert motions["circuit 1"][name][75] != pytest.approx(motions["circuit 2"][name][75], rel=1e-2)
    page.get_by_label("Circuit").evaluate("choice => choice.blur()")
    page.keyboard.press("PageUp")
    assert page.get_by_label("Circuit").input_value() == "0"


def test_paths_names_vectors_and_velocities_can_be_shown_and_hidden(
    open_page: Open, jansen: lw.Motion
) -> None:
    page = open_page(
        {"motion": jansen}, loops=partial(moving_loops, lw.example("jansen-leg").model)
    )
    page.evaluate("linkwork.goToRow(40)")
    trace, name = page.locator(".r-trace").first, page.locator("text.r-label").first
    for what, shape in (("Paths", trace), ("Names", name)):
        assert shape.evaluate("one => getComputedStyle(one).display") != "none"
        page.get_by_label(what).uncheck()
        assert shape.evaluate("one => getComputedStyle(one).display") == "none"
    page.get_by_label("Velocities").check()
    shaft = page.locator(".lw-velocities g").nth(_moving(jansen).index("F")).locator(".shaft")
    x0, y0, x1, y1 = map(float, re.findall(r"-?[\d.]+(?:e-?\d+)?", shaft.get_attribute("d")))
    velocity = complex(jansen["F.x.d1"][40], jansen["F.y.d1"][40])
    drawn = complex(x1 - x0, y0 - y1)
    assert drawn / abs(drawn) == pytest.approx(velocity / abs(velocity), abs=1e-4)
    page.get_by_label("Vectors").check()
    arrow = page.locator(".lw-vectors g", has=page.get_by_text("AB", exact=True)).first
    ends = arrow.locator(".shaft").get_attribute("d")
    x0, y0, x1, y1 = map(float, re.findall(r"-?[\d.]+(?:e-?\d+)?", ends))
    way = jansen.trace("B")[40] - jansen.trace("A")[40]
    assert complex(x0, -y0) == pytest.approx(jansen.trace("A")[40], rel=1e-4)
    assert (x1 - x0) / (y0 - y1) == pytest.approx(way.real / way.imag, rel=1e-3)


def _arrow(page: Any, kind: str, number: int) -> complex:
    """An arrow from its tail to its tip, as it is drawn."""
    group = page.locator(f".lw-{kind} > g").nth(number)
    shaft, head = (group.locator(f".{part}").get_attribute("d") for part in ("shaft", "head"))
    x0, y0 = map(float, re.findall(_NUMBER, shaft)[:2])
    x1, y1 = map(float, re.findall(_NUMBER, head)[:2])
    return complex(x1 - x0, y0 - y1)


_NUMBER = r"-?[\d.]+(?:e-?\d+)?"


@pytest.mark.parametrize(
    ("label", "order", "by"), [("Velocity", 1, "d1"), ("Acceleration", 2, "d2")]
)
def test_arrows_have_the_length_that_the_legend_tells(
    open_page: Open, jansen: lw.Motion, label: str, order: int, by: str
) -> None:
    page, row = open_page({"motion": jansen}), 205
    page.evaluate(f"linkwork.goToRow({row})")
    assert page.locator(".lw-legend").is_hidden()
    page.get_by_label({1: "Velocities", 2: "Accelerations"}[order]).check()
    told = page.locator(".lw-legend").inner_text()
    found = re.fullmatch(rf"{label} scale: ([\d.]+) mm = ([\d.]+) mm/rad(²?)", told)
    assert found is not None, told
    assert (found[3] == "²") == (order == 2)
    rate = complex(jansen[f"F.x.{by}"][row], jansen[f"F.y.{by}"][row])
    kind = {1: "velocities", 2: "accelerations"}[order]
    arrow = _arrow(page, kind, _moving(jansen).index("F"))
    assert arrow == pytest.approx(float(found[1]) / float(found[2]) * rate, rel=2e-3)


def test_arrows_stay_in_view(open_page: Open) -> None:
    motion = lw.example("rapier-drive").cycle()
    page = open_page({"motion": motion}, forces=[Force(at="D", x=-50.0, y=0.0)])
    canvas = page.locator(".lw-drawing").bounding_box()
    for row in (0, 90, 180, 270):
        page.evaluate(f"linkwork.goToRow({row})")
        for what in (".head", "text"):
            box = page.locator(f".lw-forces {what}").bounding_box()
            assert canvas["x"] <= box["x"] <= canvas["x"] + canvas["width"] - box["width"]
    whole = page.locator(".lw-drawing").get_attribute("viewBox")
    page.get_by_label("Forces").uncheck()
    assert page.locator(".lw-drawing").get_attribute("viewBox") != whole


def test_there_is_no_rate_at_a_dead_point(open_page: Open, limited: lw.Motion) -> None:
    page = open_page({"motion": limited})
    row = next(int(k) for k in play_order(limited)[0] if limited.limit[k])
    assert not np.isfinite(limited["s16.d1"][row])
    page.evaluate(f"linkwork.goToRow({row})")
    assert _number(_cells(page, "s₁₆")[0]) == pytest.approx(limited["s16"][row], rel=1e-5)
    assert _cells(page, "s₁₆")[1] == "–"
    page.get_by_label("Velocities").check()
    assert page.locator(".lw-velocities .shaft:visible").count() == 0


def test_residuals_of_zero_are_zero(open_page: Open) -> None:
    motion = lw.example("four-bar").cycle()
    row = int(np.flatnonzero(motion.residual == 0)[0])
    page = open_page({"motion": motion})
    page.evaluate(f"linkwork.goToRow({row})")
    assert page.locator('[data-fact="residual"]').inner_text() == "0 of the longest link"


def test_a_negative_speed_turns_everything_the_other_way(open_page: Open) -> None:
    motion = lw.example("crank-slider").cycle()
    assert motion.speed == -30
    page = open_page({"motion": motion})
    page.keyboard.press("ArrowRight")
    assert _row(page) == 359
    page.get_by_label("Velocities").check()
    tip, tail = page.evaluate(_INPUT_ENDS.replace('"A0"', '"O2"'))
    assert tail[0] * tip[1] - tail[1] * tip[0] < 0
    velocity = complex(motion["A.x.velocity"][359], motion["A.y.velocity"][359])
    arrow = _arrow(page, "velocities", _moving(motion).index("A"))
    assert (arrow / velocity).imag == pytest.approx(0, abs=1e-3 * abs(arrow / velocity))
    found = re.fullmatch(
        r"Velocity scale: ([\d.]+) mm = ([\d.]+) mm/s", page.locator(".lw-legend").inner_text()
    )
    assert found is not None
    assert (arrow / velocity).real == pytest.approx(float(found[1]) / float(found[2]), rel=2e-3)


def test_names_of_arrows_do_not_stand_on_each_other(open_page: Open) -> None:
    motion = lw.example("rapier-drive").cycle()
    page = open_page({"motion": motion})
    for label in ("Velocities", "Accelerations"):
        page.get_by_label(label).check()
    for row in (0, 40, 200, 300):
        page.evaluate(f"linkwork.goToRow({row})")
        boxes = page.locator(".lw-overlay text:visible").evaluate_all(
            "all => all.map(one => one.getBoundingClientRect().toJSON())"
        )
        assert len(boxes) >= 4
        for one, other in combinations(boxes, 2):
            across = min(one["right"], other["right"]) - max(one["left"], other["left"])
            up = min(one["bottom"], other["bottom"]) - max(one["top"], other["top"])
            assert min(across / one["width"], up / one["height"]) < 0.3


def test_forces_are_shown_at_once(open_page: Open, jansen: lw.Motion) -> None:
    page = open_page({"motion": jansen}, forces=[Force(at="F", x=30.0, y=60.0, unit="N")])
    found = re.fullmatch(
        r"Force scale: ([\d.]+) mm = ([\d.]+) N\ndashed: below [\d.]+ N, not to scale",
        page.locator(".lw-legend").inner_text(),
    )
    assert found is not None
    arrow = _arrow(page, "forces", 0)
    assert arrow == pytest.approx(float(found[1]) / float(found[2]) * (30 + 60j), rel=1e-4)
    page.get_by_label("Forces").uncheck()
    assert page.locator(".lw-legend").is_hidden()
    assert page.locator(".lw-forces").is_hidden()
    assert not open_page({"motion": jansen}).get_by_label("Forces").is_visible()


def test_the_arrow_of_what_is_driven_turns_round_with_it(
    open_page: Open, limited: lw.Motion
) -> None:
    page = open_page({"motion": limited})
    rises = np.diff(limited["θ12"]) > 0
    head = page.locator("path.r-input.lw-head")
    away = []
    for row in (10, int(np.flatnonzero(~rises)[10])):
        page.evaluate(f"linkwork.goToRow({row})")
        tip, tail = page.evaluate(_INPUT_ENDS)
        away.append(tail[0] * tip[1] - tail[1] * tip[0] > 0)
        assert away[-1] == rises[row]
    assert away == [True, False]
    assert head.count() == 1


#: Tip and tail of the arrow of the input, from the driven pivot, in the plane.
_INPUT_ENDS = """() => {
  const svg = document.querySelector('.lw-drawing');
  const back = svg.getScreenCTM().inverse();
  const place = (element, k) => {
    const numbers = element.getAttribute('d').match(/-?[\\d.]+(?:e-?\\d+)?/g).map(Number);
    const [x, y] = numbers.slice(k, k + 2);
    return new DOMPoint(x, y).matrixTransform(back.multiply(element.getScreenCTM()));
  };
  const [shaft, head] = document.querySelectorAll('path.r-input');
  const pin = document.querySelector('circle[data-of="A0"][data-role="pin"]');
  const o = new DOMPoint(pin.cx.baseVal.value, pin.cy.baseVal.value)
    .matrixTransform(back.multiply(pin.getScreenCTM()));
  return [place(head, 0), place(shaft, 0)].map(({ x, y }) => [x - o.x, o.y - y]);
}"""


def _moving(motion: lw.Motion) -> list[str]:
    return [name for name in motion.points if name not in motion.skeleton.fixed]


def test_scrubbing_and_clicking_a_plot_choose_the_row(open_page: Open, jansen: lw.Motion) -> None:
    page = open_page({"motion": jansen})
    page.get_by_label("Position of the motion").fill("200")
    assert _row(page) == 200
    plot = page.locator(".lw-chart svg").first
    box = plot.bounding_box()
    plot.click(
        position={"x": box["width"] * (52 + 0.25 * (420 - 72)) / 420, "y": box["height"] / 2}
    )
    assert _row(page) == pytest.approx(90, abs=25)
    dot = page.locator(".lw-dot").first.bounding_box()
    line = page.locator(".lw-now").first.bounding_box()
    assert dot["x"] + dot["width"] / 2 == pytest.approx(line["x"] + line["width"] / 2, abs=1)


def test_svg_png_and_page_show_the_same_coordinates(open_page: Open, jansen: lw.Motion) -> None:
    moving = moving_scene(jansen)
    row, size = 77, moving.scene.measures.size
    page = open_page({"motion": jansen})
    page.evaluate(f"linkwork.goToRow({row})")
    shown = page.evaluate(_PINS)
    scene = moving.at(row)
    pins = {p.of: p.centre for p in scene.select(Disc) if p.role in (Role.PIN, Role.TRACED)}
    assert shown.keys() == pins.keys()
    for name, place in pins.items():
        assert shown[name] == pytest.approx(place, abs=2e-6 * size)
    # In the SVG file the same points, up to one scale and one shift for all of them.
    text = render(scene, "svg").decode()
    written = {
        name: _svg_centre(text, f"{'traced' if name == 'F' else 'pin'}:{name}") for name in pins
    }
    there = np.array([complex(*written[name]) for name in pins])
    here = np.array([complex(x, -y) for x, y in pins.values()])
    scale = (there[1] - there[0]) / (here[1] - here[0])
    assert abs(scale.imag) <= 1e-6 * abs(scale)
    assert there == pytest.approx(there[0] + scale * (here - here[0]), abs=1e-4)


_PINS = """() => {
  const svg = document.querySelector('.lw-drawing');
  const back = svg.getScreenCTM().inverse();
  const found = {};
  for (const one of svg.querySelectorAll('circle[data-role=pin], circle[data-role=traced]')) {
    const local = new DOMPoint(one.cx.baseVal.value, one.cy.baseVal.value);
    const place = local.matrixTransform(back.multiply(one.getScreenCTM()));
    found[one.dataset.of] = [place.x, -place.y];
  }
  return found;
}"""


def _svg_centre(text: str, gid: str) -> tuple[float, float]:
    """The middle of the outline of a disc in an SVG file."""
    path = re.search(rf'<g id="{re.escape(gid)}">\s*<path d="([^"]+)"', text)
    assert path is not None, gid
    numbers = np.array(re.findall(r"-?\d+\.?\d*", path[1]), dtype=float).reshape(-1, 2)
    low, high = numbers.min(axis=0), numbers.max(axis=0)
    x, y = (low + high) / 2
    return float(x), float(y)


def test_page_works_on_a_phone_by_touch(open_page: Open, jansen: lw.Motion) -> None:
    page = open_page({"motion": jansen}, viewport={"width": 390, "height": 844}, has_touch=True)
    wide = page.evaluate("document.documentElement.scrollWidth")
    assert wide <= 390
    page.get_by_role("button", name="Play").tap()
    _until(page, "Number(document.querySelector('.lw').dataset.row) > 2")
    button = page.get_by_role("button", name="Pause").bounding_box()
    assert min(button["width"], button["height"]) >= 44


def test_page_tells_a_screen_reader_where_the_motion_rests(
    open_page: Open, jansen: lw.Motion
) -> None:
    page = open_page({"motion": jansen})
    page.keyboard.press("Shift+ArrowRight")
    _until(page, "document.querySelector('[aria-live]').textContent.includes('10°')")
    assert page.get_by_role("img", name="Jansen leg (Strandbeest): crank 10°").count() == 1
    scrub = page.get_by_label("Position of the motion")
    assert scrub.get_attribute("aria-valuetext") == "crank = 10°, 11 of 360"


def test_page_follows_the_colours_of_the_system(open_page: Open, jansen: lw.Motion) -> None:
    colour = "getComputedStyle(document.querySelector('.lw')).backgroundColor"
    assert open_page({"motion": jansen}).evaluate(colour) == "rgb(255, 255, 255)"
    page = open_page({"motion": jansen}, color_scheme="dark")
    dark = page.evaluate(colour)
    assert dark != "rgb(255, 255, 255)"
    page.get_by_role("button", name="Light or dark").click()
    assert page.evaluate(colour) == "rgb(255, 255, 255)"


def test_equations_are_set_as_mathematics(open_page: Open, jansen: lw.Motion) -> None:
    equations = lw.example("jansen-leg").equations().mathml()
    page = open_page({"motion": jansen}, equations=equations)
    assert page.locator(".lw-equation math msup").count() > len(equations)


def test_a_page_of_one_circuit_is_small(jansen: lw.Motion) -> None:
    equations = lw.example("jansen-leg").equations().mathml()
    page = offline_page(motion_page({"motion": jansen}, equations=equations))
    assert len(jansen) == 361
    assert len(page.encode()) <= 400_000


@pytest.mark.extended  # follows six circuits
def test_a_page_of_all_circuits_is_small() -> None:
    mechanism = lw.example("jansen-leg")
    page = motion_page(mechanism.cycles(), equations=mechanism.equations().mathml())
    assert len(page.motions) == 6
    assert len(offline_page(page).encode()) <= 1_000_000


def test_names_of_a_mechanism_cannot_break_the_page(open_page: Open) -> None:
    nasty = "</title></script><script>document.title='broken'</script> & \"<b>"
    motion = lw.example("four-bar").changed(name=nasty).cycle()
    page = open_page({"motion": motion})
    assert page.title() == nasty
    assert page.get_by_role("heading", level=1).inner_text() == nasty


def test_other_data_take_the_place_of_the_old_ones(open_page: Open, jansen: lw.Motion) -> None:
    page = open_page({"motion": jansen})
    page.evaluate("linkwork.goToRow(50)")
    lengths = {**described_as(Linkage, lw.example("jansen-leg")).lengths, "O A": 14.0}
    changed = lw.example("jansen-leg").changed(lengths=lengths).cycle()
    drawn = moving_scene(changed, like=moving_scene(jansen))
    data = drawn_page({"motion": changed}, [drawn], pack=unpressed)
    page.evaluate(f"linkwork.update({page_json(data)})")
    assert _row(page) == 50
    assert _number(_cells(page, "foot")[0]) == pytest.approx(changed["foot"][50], rel=1e-5)
    assert _number(_cells(page, "foot")[0]) != pytest.approx(jansen["foot"][50], rel=1e-3)


def test_pages_of_another_format_are_refused(open_page: Open, jansen: lw.Motion) -> None:
    data = page_json(replace(motion_page({"motion": jansen}), format=99))
    page = open_page({"motion": jansen})
    said = page.evaluate(
        f"(() => {{ try {{ linkwork.update({data}) }} catch (e) {{ return e.message }} }})()"
    )
    assert said == "this front end reads page data of format 1, not 99"
