"""Questions of a page: answers come from the motion, and what tells them is hidden."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

import linkwork as lw
from linkwork.app import motion_page
from linkwork.app.pages.page_building import answers_of, questions_of
from linkwork.core.foundation.errors import MechanismError
from linkwork.core.mechanism.description import Question

LOCKS = Question(text="At which crank angle does it lock?", answer="dead points", tolerance=0.5)


def asking(*questions: Question, a: float = 40) -> lw.Motion:
    lengths = {"O2 A": a, "A B": 120, "O4 B": 80, "O2 O4": 100}
    return lw.example("four-bar").changed(questions=questions, lengths=lengths).sweep(step=90)


def question(answer: str | float, **more: Any) -> Question:
    return Question(text="?", answer=answer, tolerance=0.1, **more)


def test_dead_points_are_the_answers_of_the_input() -> None:
    motion = asking(LOCKS, a=80)
    (told,), (answer,) = questions_of(motion), answers_of(motion)
    # where coupler and rocker are in line, one over the other: A and O4 are 120 − 80 apart
    inner = math.degrees(math.acos((80**2 + 100**2 - 40**2) / (2 * 80 * 100)))
    assert (told.unit, told.turn, told.tolerance) == ("deg", 360, 0.5)
    assert answer.known
    assert min(abs(value - inner) for value in answer.values) < 1e-6


def test_a_mechanism_that_never_locks_has_no_answer_and_it_is_known() -> None:
    (answer,) = answers_of(asking(LOCKS))
    assert (answer.known, answer.values) == (True, ())


def test_numbers_of_the_motion_rows_and_given_numbers_are_answers() -> None:
    motion = asking(
        question("stroke(rocker)"),
        question("mu", at=90),
        question("B.x", at=90.0),
        question(7.5, unit="mm"),
    )
    found = [answer.values for answer in answers_of(motion)]
    row = 1
    expected = [
        motion.value("stroke(rocker)"),
        motion["mu"][row],
        motion.points["B"][0].value[row],
        7.5,
    ]
    assert [value for (value,) in found] == pytest.approx(expected, rel=1e-12)
    told = [(one.unit, one.turn) for one in questions_of(motion)]
    assert told == [("deg", 0), ("deg", 360), ("mm", 0), ("mm", 0)]


def test_a_quantity_between_the_rows_is_not_known() -> None:
    (answer,) = answers_of(asking(question("mu", at=45)))
    assert not answer.known


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (
            "rocker",
            'differs from row to row: add the input, at = 90, or ask for .*"max\\(rocker\\)"',
        ),
        ("stroke(rokcer)", 'rocker.*; or ask for "dead points" or "change points"'),
    ],
)
def test_a_quantity_that_does_not_exist_is_refused(answer: str, message: str) -> None:
    with pytest.raises(MechanismError, match=message) as caught:
        asking(question(answer))
    assert caught.value.problems[0].key == ("questions", 0, "answer")


def test_a_page_hides_the_answer_until_it_is_given(open_page: Callable[..., Any]) -> None:
    page = open_page({"motion": asking(LOCKS, question("mu", at=90, hide=("charts",)), a=80)})
    note = page.locator(".lw-question p")
    field = page.locator(".lw-question input").first
    secret = page.locator(".lw-facts .lw-table, .lw-readout, .lw-marks, .lw-proof")
    assert secret.count()
    assert not any(one.is_visible() for one in secret.all())
    field.fill("30")
    field.press("Enter")
    assert "Not within 0.5 deg" in note.first.text_content()
    assert not any(one.is_visible() for one in secret.all())
    field.fill("−22,6°")  # a whole turn further is the same
    field.press("Enter")
    assert note.first.text_content().startswith("Right: 22.33")
    assert page.locator(".lw-facts .lw-table").is_visible()
    assert not page.locator(".lw-charts").is_visible()  # the other question hides them
    page.get_by_role("button", name="Show the answer").nth(1).click()
    assert page.locator(".lw-charts").is_visible()


def test_pages_without_questions_have_none() -> None:
    page = motion_page({"motion": lw.example("four-bar").sweep(step=90, certify=False)})
    assert page.questions == ()
    assert page.motions[0].answers == ()
