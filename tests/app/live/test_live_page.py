"""The live page in a real browser: what is dragged, typed and chosen is what the library solves."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import linkwork as lw
from linkwork.circuits.failure.remedies import nearest_assembly
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.textfile.link import text_of_link
from tests.app.accessibility import assert_accessible
from tests.app.live.conftest import FOUR_BAR, Served
from tests.app.live.rest import at_rest
from tests.described import described_as

Open = Callable[..., Any]

BELT = """
[[belts]]
name = "belt"
wheels = ["crank", "wheel"]
centers = ["O2", "O4"]
radii = [20, 30]
"""


@pytest.fixture
def open_live(served: Served, watched: Callable[..., Any]) -> Open:
    """Opens the live page."""

    def opened(wait: str = ".lw[data-row]", **options: Any) -> Any:
        page = watched((f"http://{served.host}/",), **options)
        page.set_default_timeout(10_000)
        page.goto(served.server.address)
        page.wait_for_selector(wait)
        return page

    return opened


def shown_row(page: Any) -> int:
    return int(page.locator(".lw").get_attribute("data-row"))


def table(page: Any, name: str) -> float:
    """The value of a quantity in the table of the row that is shown."""
    row = page.locator(".lw-facts > .lw-table tr", has=page.locator("th", has_text=name)).first
    text = row.locator("td").first.text_content().replace("\u2212", "-")
    found = re.match(r"[-\d.]+", text)
    assert found is not None, text
    return float(found[0])


def type_number(page: Any, name: str, value: object) -> None:
    """Another value in the field of a number, and wait for its cycle."""
    field = page.locator(f'[data-number="{name}"] input[type=text]')
    before = page.locator("#linkwork").get_attribute("data-updates")
    field.fill(str(value))
    field.press("Enter")
    page.wait_for_function(
        "before => document.getElementById('linkwork').dataset.updates !== before", arg=before
    )


def test_the_crank_is_dragged_to_a_solved_row(open_live: Open) -> None:
    page = open_live()
    motion = lw.loads(FOUR_BAR).sweep()
    a = next(k for k, name in enumerate(motion.points) if name == "A")
    pin = page.locator(f'[data-point="{a}"]').bounding_box()
    x, y = pin["x"] + pin["width"] / 2, pin["y"] + pin["height"] / 2
    before = shown_row(page)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 60, y - 10, steps=5)
    page.mouse.up()
    row = shown_row(page)
    assert row != before
    assert table(page, "rocker") == pytest.approx(motion["rocker"][row], abs=1e-3)


def test_a_length_is_typed_and_the_cycle_is_that_of_the_library(
    open_live: Open, served: Served
) -> None:
    page = open_live()
    type_number(page, "A B", 130)
    motion = lw.loads(FOUR_BAR.replace('"A B" = 120', '"A B" = 130')).sweep()
    assert table(page, "rocker") == pytest.approx(motion["rocker"][shown_row(page)], abs=1e-3)
    assert page.title().startswith("•")
    assert served.path.read_text("utf-8") == FOUR_BAR  # nothing is written before it is saved


def test_a_longer_crank_has_dead_points(open_live: Open) -> None:
    page = open_live()
    assert page.locator(".lw-limit-button").count() == 0
    slider = page.locator('[data-number="a"] input[type=range]')
    slider.evaluate(
        """slider => {
          slider.value = "76";
          slider.dispatchEvent(new Event("input"));
          slider.dispatchEvent(new Event("change"));
        }"""
    )
    page.locator("#linkwork[data-live=false]").wait_for()
    page.locator(".lw-limit-button").first.wait_for()
    limits = lw.loads(FOUR_BAR.replace("a = 40", "a = 76")).sweep().limits
    page.wait_for_function(
        "text => document.querySelector('.lw-limit-button')?.textContent === text",
        arg=f"{limits[0].input:.4f}".rstrip("0").rstrip(".").replace("-", "\u2212") + "°",
    )
    assert page.locator(".lw-limit-button").count() == min(4, len(limits))
    assert page.locator(".lw-marks span").count() == len(limits)


def test_what_cannot_close_is_shown_with_its_gap(open_live: Open, served: Served) -> None:
    page = open_live()
    type_number(page, "O2 O4", 300)
    page.locator(".lw-gaps .lw-gap").first.wait_for()
    gap = nearest_assembly(lw.loads(served.workbench.text).model).gap
    said = page.locator(".lw-open").text_content()
    assert f"a gap of {gap:.2f}" in said, said
    page.get_by_role("button", name="Undo").click()
    page.locator(".lw-gaps").wait_for(state="detached")


def test_another_configuration_is_chosen(open_live: Open) -> None:
    page = open_live()
    page.get_by_role("tab", name="Configurations").click()
    page.locator(".lw-way").nth(1).wait_for()
    current = page.locator('.lw-way[aria-pressed="true"]').text_content()
    other = page.locator('.lw-way[aria-pressed="false"]')
    name = other.text_content()
    known = [way.configuration for way in lw.loads(FOUR_BAR).configurations()]
    assert sorted([current, name]) == sorted(known)
    other.click()
    page.locator(f'.lw-way[aria-pressed="true"]:has-text("{name}")').wait_for()
    motion = lw.loads(f'configuration = "{name}"\n{FOUR_BAR}').sweep()
    assert table(page, "rocker") == pytest.approx(motion["rocker"][shown_row(page)], abs=1e-3)


def test_saving_writes_the_file_and_a_conflict_is_asked_about(
    open_live: Open, served: Served
) -> None:
    page = open_live()
    type_number(page, "A B", 130)
    page.get_by_role("button", name="Save").click()
    page.get_by_text("Saved in").wait_for()
    assert served.path.read_text("utf-8") == FOUR_BAR.replace('"A B" = 120', '"A B" = 130')
    type_number(page, "A B", 131)
    served.path.write_text(FOUR_BAR.replace('"A B" = 120', '"A B" = 125'), "utf-8")
    page.get_by_role("button", name="Overwrite").click()
    page.get_by_text("Saved in").wait_for()
    assert served.path.read_text("utf-8") == FOUR_BAR.replace('"A B" = 120', '"A B" = 131')


def test_a_file_that_another_program_breaks_is_told_with_line_and_key(
    open_live: Open, served: Served
) -> None:
    page = open_live()
    served.path.write_text(FOUR_BAR.replace('"A B" = 120', '"A B" = -120'), "utf-8")
    told = page.locator(".lw-message li")
    told.wait_for()
    line = FOUR_BAR.splitlines().index('"A B" = 120') + 1
    assert told.locator("code").text_content().startswith(f"line {line}, lengths")
    assert page.locator(".lw-drawing .lw-moving").count() > 0  # what was shown before stays


def test_newton_is_followed_step_by_step(open_live: Open) -> None:
    page = open_live()
    page.get_by_role("tab", name="Newton").click()
    page.locator(".lw-steps tbody tr").first.wait_for()
    crank = float(lw.loads(FOUR_BAR).sweep()["crank"][shown_row(page)])
    iterates = lw.loads(FOUR_BAR).iterates({}, {"crank": crank}).iterates
    assert page.locator(".lw-steps tbody tr").count() == len(iterates)
    first = page.locator(".lw-steps tbody tr td").first.text_content()
    assert math.isclose(float(first), iterates[0].norm, rel_tol=1e-3)
    page.get_by_role("button", name="Step ›").click()
    assert "lw-chosen" in page.locator(".lw-steps tbody tr").nth(1).get_attribute("class")
    entry = page.locator(".lw-newton .lw-table").nth(1).locator("tbody tr").nth(1).locator("td")
    shown = float(entry.nth(1).text_content().replace("\u2212", "-"))
    assert shown == pytest.approx(iterates[1].jacobian[0][0], rel=1e-3)


def test_a_point_of_the_sketch_is_moved_with_the_arrow_keys(
    open_live: Open, served: Served
) -> None:
    page = open_live()
    page.keyboard.press("v")
    page.locator('[data-sketched="P"]').focus()
    page.keyboard.press("ArrowRight")
    page.locator("[aria-label$='changes are not saved']").wait_for()
    assert "P = [90, 90]" not in served.workbench.text
    page.get_by_role("button", name="Undo").click()
    page.locator("[aria-label$='four-bar.toml, saved']").wait_for()
    assert served.workbench.text == FOUR_BAR


def test_a_second_page_and_a_lost_connection_are_told(open_live: Open, served: Served) -> None:
    page = open_live()
    second = open_live(wait=".lw-wait[role=alert]")
    assert "Another page shows this file" in second.locator(".lw-wait").text_content()
    assert_accessible(second)
    page.close()
    second.get_by_role("button", name="Reload").click()
    second.locator(".lw[data-row]").wait_for()
    page = second
    served.server.stop()
    page.get_by_text("The connection is lost").wait_for()
    assert page.get_by_role("button", name="Save").is_disabled()
    assert page.locator(".lw-drawing .lw-moving").count() > 0


def test_a_phone_shows_everything_in_one_column(open_live: Open, tmp_path: Path) -> None:
    page = open_live(viewport={"width": 390, "height": 844}, has_touch=True, color_scheme="dark")
    wide = page.evaluate("document.documentElement.scrollWidth")
    assert wide <= 390
    assert page.locator('[data-number="A B"] input[type=range]').bounding_box()["width"] > 80


def test_a_slider_is_moved_by_keys_and_the_motion_stays(open_live: Open) -> None:
    page = open_live()
    before = shown_row(page)
    slider = page.locator('[data-number="A B"] input[type=range]')
    step = float(slider.get_attribute("step"))
    slider.focus()
    page.keyboard.press("ArrowRight")
    page.get_by_role("button", name=f"Undo: A B = {120 + step:g}").wait_for()
    assert shown_row(page) == before


def test_a_point_is_added_from_the_palette_and_removed_again(
    open_live: Open, served: Served
) -> None:
    page = open_live()
    page.get_by_role("tab", name="Build").click()
    piece = page.locator(".lw-piece").first
    piece.locator("summary").first.click()
    for label, text in (("name", "Q"), ("x", "120"), ("y", "40")):
        piece.get_by_label(label, exact=True).fill(text)
    piece.get_by_label("on link").select_option("rocker")
    piece.get_by_role("button", name="Add point").click()
    page.locator(".lw-drawing text[data-of=Q]").wait_for()
    mechanism = lw.loads(served.workbench.text)
    assert "Q" in described_as(Linkage, mechanism).links["rocker"]
    page.locator(".lw-group summary", has_text="Remove").click()
    page.get_by_role("button", name="Remove point Q").click()
    page.locator(".lw-drawing text[data-of=Q]").wait_for(state="detached")
    assert "Q" not in described_as(Linkage, lw.loads(served.workbench.text)).points


def test_a_belt_is_added_and_removed_with_its_wheel(open_live: Open, served: Served) -> None:
    page = open_live()
    page.get_by_role("tab", name="Build").click()
    link = page.locator(".lw-piece", has=page.get_by_text("Link", exact=True))
    link.locator("summary").first.click()
    link.get_by_label("name", exact=True).fill("wheel")
    link.get_by_label("O4", exact=True).check()
    link.get_by_role("button", name="Add link").click()
    page.locator(".lw-readiness li", has_text="wheel").wait_for()  # nothing turns it yet
    page.get_by_role("button", name="Undo").click()
    page.locator(".lw-complete").wait_for()
    served.path.write_text(FOUR_BAR.replace("rocker = [", 'wheel = ["O4"]\nrocker = [') + BELT)
    page.get_by_text("has been read again").wait_for()
    page.locator(".lw-group summary", has_text="Remove").click()
    page.get_by_role("button", name="Remove belt", exact=True).click()
    page.locator(".lw-readiness li").first.wait_for()
    page.get_by_role("button", name="Remove link wheel").click()
    page.locator(".lw-complete").wait_for()
    page.locator("[data-of=wheel]").first.wait_for(state="detached")
    assert lw.loads(served.workbench.text).description == lw.loads(FOUR_BAR).description


def test_what_no_longer_moves_can_be_edited_at_once(open_live: Open, served: Served) -> None:
    page = open_live()
    page.get_by_role("tab", name="Build").click()
    page.locator(".lw-group summary", has_text="Remove").click()
    page.get_by_role("button", name="Remove link coupler").click()
    page.locator(".lw-tools [aria-pressed=true]", has_text="Select").wait_for()
    assert page.get_by_role("button", name="Move", exact=True).is_disabled()
    page.get_by_role("button", name="Undo").click()
    page.locator(".lw-complete").wait_for()
    page.get_by_role("button", name="Move", exact=True).click()
    page.locator(".lw-transport").wait_for()
    assert served.workbench.text == FOUR_BAR


def test_a_part_is_added_from_the_palette(open_live: Open, served: Served) -> None:
    page = open_live()
    served.path.write_text(FOUR_BAR.replace("rocker = [", 'wheel = ["O4"]\nrocker = [') + BELT)
    page.get_by_text("has been read again").wait_for()
    page.get_by_role("tab", name="Build").click()
    page.locator(".lw-group summary", has_text="Remove").click()
    page.get_by_role("button", name="Remove belt", exact=True).click()
    page.locator(".lw-readiness li").first.wait_for()
    piece = page.locator(".lw-piece", has=page.get_by_text("Gear pair", exact=True))
    piece.locator("summary").first.click()
    piece.get_by_label("name", exact=True).fill("mesh")
    for name in ("crank", "wheel", "O2", "O4"):
        piece.get_by_label(name, exact=True).first.check()
    piece.locator("summary", has_text="More").click()
    piece.get_by_label("radii").fill("70, 30")
    piece.get_by_role("button", name="Add gear pair").click()
    page.get_by_role("button", name="Remove mesh").wait_for()
    (gear,) = described_as(Linkage, lw.loads(served.workbench.text)).gears
    assert (gear.name, gear.wheels, gear.radii) == ("mesh", ("crank", "wheel"), (70, 30))


def test_the_path_of_a_point_is_shown_or_not(open_live: Open, served: Served) -> None:
    page = open_live()
    page.get_by_role("tab", name="Build").click()
    page.locator(".lw-group summary", has_text="Paths of points").click()
    for name, on in (("B", True), ("P", False), ("B", False)):
        page.locator(".lw-group", has_text="Paths of points").get_by_label(
            name, exact=True
        ).set_checked(on)
        page.locator(f'[data-role=trace][data-of="{name}"]').first.wait_for(
            state="attached" if on else "detached"
        )
    assert "[trace]" not in served.workbench.text
    assert lw.loads(served.workbench.text).description.trace == ()


def test_newton_follows_the_input_that_is_shown(open_live: Open) -> None:
    page = open_live()
    page.get_by_role("tab", name="Newton").click()
    page.locator(".lw-steps tbody tr").first.wait_for()
    before = page.locator(".lw-steps tbody tr td").first.text_content()
    page.get_by_label("Position of the motion").fill("200")
    page.wait_for_function(
        "old => document.querySelector('.lw-steps tbody tr td').textContent !== old", arg=before
    )
    iterates = lw.loads(FOUR_BAR).iterates({}, {"crank": 200.0}).iterates
    at_rest(page)
    first = page.locator(".lw-steps tbody tr td").first.text_content()
    assert float(first) == pytest.approx(iterates[0].norm, rel=1e-3)
    assert page.locator(".lw-iterate .lw-gap").count() == len(iterates[0].apart) > 0


def test_a_formula_is_typed_over(open_live: Open, served: Served) -> None:
    page = open_live()
    type_number(page, "O2 A", 45)
    assert '"O2 A" = 45' in served.workbench.text
    type_number(page, "A B", "121,5")
    assert '"A B" = 121.5' in served.workbench.text


def test_a_length_that_would_help_does(open_live: Open, served: Served) -> None:
    page = open_live()
    page.locator('[data-number="O4 B"] input[type=text]').fill("20")
    page.locator('[data-number="O4 B"] input[type=text]').press("Enter")
    told = page.locator(".lw-open")
    told.wait_for()
    assert "At crank = " in told.text_content()
    page.locator(".lw-motion-notice button", has_text="O4 B = ").click()
    page.locator(".lw-limit-button").first.wait_for()
    assert page.locator(".lw-limit-button").count() > 0
    assert lw.loads(served.workbench.text).sweep().found.any()


def test_something_else_is_driven(open_live: Open, served: Served) -> None:
    page = open_live()
    page.get_by_role("tab", name="Build").click()
    form = page.locator(".lw-build form", has_text="Driven")
    form.get_by_label("Driven").select_option("link rocker")
    form.get_by_role("button", name="Set the input").click()
    page.locator(".lw-limit-button").first.wait_for()  # a rocker cannot turn all around
    assert lw.loads(served.workbench.text).description.inputs[0].link == "rocker"


def test_the_guess_is_dragged_in_the_drawing(open_live: Open) -> None:
    page = open_live()
    page.get_by_role("tab", name="Newton").click()
    handle = page.locator("[data-guessed=B]")
    handle.wait_for()
    slider = page.locator("[data-guess=rocker] input")
    before = float(slider.input_value())
    box = handle.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 90, y + 20, steps=6)
    page.mouse.up()
    page.wait_for_function(
        "old => Math.abs(document.querySelector('[data-guess=rocker] input').value - old) > 5",
        arg=before,
    )
    at_rest(page)  # the last place is solved
    guess = {"rocker": float(slider.input_value())}
    crank = float(lw.loads(FOUR_BAR).sweep()["crank"][shown_row(page)])
    iterates = lw.loads(FOUR_BAR).iterates(guess, {"crank": crank}).iterates
    assert page.locator(".lw-steps tbody tr").count() == len(iterates)
    first = page.locator(".lw-steps tbody tr td").first.text_content()
    assert float(first) == pytest.approx(iterates[0].norm, rel=2e-2)  # sliders have whole steps


def test_the_range_of_the_input_is_set(open_live: Open, served: Served) -> None:
    page = open_live()
    page.get_by_role("tab", name="Build").click()
    form = page.locator(".lw-build form", has_text="link crank")
    form.get_by_label("To [deg]").fill("90")
    form.get_by_role("button", name="Set the input").click()
    page.get_by_text("91 of 91 positions found").wait_for()
    assert float(lw.loads(served.workbench.text).sweep()["crank"][-1]) == 90.0


def test_equations_without_points_are_no_blank_page(open_live: Open, served: Served) -> None:
    page = open_live()
    served.path.write_text(
        'format = 1\nname = "Root"\nangle = "rad"\n\n[equations]\nF = "atan(x) = 0"\n\n'
        "[guess]\nx = 1.5\n",
        "utf-8",
    )
    page.get_by_text("the iteration diverged to infinity").wait_for()
    assert "atan(x)" in page.locator(".lw-plain-equations").text_content()
    page.get_by_role("tab", name="Newton").click()
    page.locator('.lw-outcome[data-trouble="INFLECTION"]').wait_for()


def test_a_link_is_made_copied_and_remembered(open_live: Open, served: Served) -> None:
    page = open_live(permissions=["clipboard-read", "clipboard-write"])
    page.get_by_role("button", name="Share by link").click()
    link = page.get_by_role("textbox", name="Link", exact=True)
    app = page.get_by_label("Address of a Linkwork app")
    page.wait_for_function("() => document.querySelector('.lw-copied textarea').value !== ''")
    assert text_of_link(link.input_value()) == FOUR_BAR
    assert page.get_by_label("HTML for a course page", exact=True).is_hidden()
    app.fill("example.org")
    app.press("Enter")
    page.get_by_text('"example.org" is not the address of an app').wait_for()
    app.fill("https://example.org/")
    app.press("Enter")
    page.get_by_role("img", name="QR code of the link").wait_for()
    page.get_by_role("button", name="Copy: Link").click()
    page.get_by_text("Copied").wait_for()
    copied = page.evaluate("navigator.clipboard.readText()")
    assert copied.startswith("https://example.org/#lw1=")
    assert lw.load(copied).description == lw.loads(served.workbench.text).description
    page.mouse.click(5, 5)  # beside the dialog, which keeps the keys
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Share by link").click()
    assert app.input_value() == "https://example.org/"
