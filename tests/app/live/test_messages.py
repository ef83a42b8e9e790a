"""Messages are taken literally or refused with their place; no JSON whatever does harm."""

from __future__ import annotations

import json
import math
from dataclasses import fields
from typing import Any, get_args

import pytest
from hypothesis import given, strategies as st

from linkwork.app.live import requests as ask
from linkwork.app.live.events import EVENTS, Refused
from linkwork.app.live.messages import LARGEST_MESSAGE, MessageError, decoded, encoded, kind_of


def sent(**fields: Any) -> str:
    return json.dumps(fields)


def test_a_request_is_read_as_it_was_written() -> None:
    text = sent(kind="move_point", id=7, point="A", x=1, y=2.5, lengths_follow=True, live=True)
    wanted = ask.MovePoint(point="A", x=1.0, y=2.5, lengths_follow=True, live=True)
    assert decoded(text) == (wanted, 7)
    assert decoded(sent(kind="undo")) == (ask.Undo(), None)


def test_a_value_may_be_a_number_or_a_formula() -> None:
    assert decoded(sent(kind="set_number", name="a", value="2*b"))[0] == ask.SetNumber(
        name="a", value="2*b"
    )
    assert decoded(sent(kind="set_number", name="a", value=2))[0] == ask.SetNumber(
        name="a", value=2.0
    )
    assert decoded(sent(kind="set_input", step=None))[0] == ask.SetInput()


def test_changes_together_are_messages_inside_a_message() -> None:
    edits = [
        {"kind": "add_point", "name": "Q", "x": 0, "y": 1},
        {"kind": "add_link", "name": "bar", "points": ["Q", "B"]},
    ]
    request, _ = decoded(sent(kind="together", edits=edits))
    assert request == ask.Together(
        edits=(
            ask.AddPoint(name="Q", x=0.0, y=1.0),
            ask.AddLink(name="bar", points=("Q", "B")),
        )
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "the message is not JSON: "),
        ("[]", "a message is a JSON object with its kind, got a list"),
        ("{}", "kind: there is no kind null (kinds: set_number, "),
        (sent(kind="set_numbr"), 'kind: there is no kind "set_numbr" (kinds: set_number, '),
        (sent(kind=["undo"]), "kind: there is no kind a list (kinds: "),
        (sent(kind="undo", now=1), 'undo: "now" is not a field (there are no fields)'),
        (sent(kind="set_number", name="a"), "set_number: value is missing: send it with"),
        (sent(kind="set_number", name=1, value=1), "set_number: name: must be text, got 1"),
        (
            sent(kind="set_number", name="a", value=True),
            "set_number: value: must be a number, got true",
        ),
        (
            sent(kind="set_number", name="a", value=None),
            "set_number: value: must be a number, got null",
        ),
        (
            sent(kind="set_number", name="a", value=1, live=1),
            "set_number: live: must be true or false, got 1",
        ),
        (
            '{"kind": "set_number", "name": "a", "value": 1e999}',
            "set_number: value: must be a finite number",
        ),
        (
            '{"kind": "set_number", "name": "a", "value": NaN}',
            "NaN is not a number in JSON: send a finite number or null",
        ),
        (
            '{"kind": "undo", "kind": "redo"}',
            '"kind" occurs twice in one object: send it once',
        ),
        (
            sent(kind="set_number", name="a" * 1001, value=1),
            "set_number: name: has 1001 characters, at most 1000 are read",
        ),
        (
            '{"kind": "set_number", "name": "\\ud800", "value": 1}',
            "set_number: name: contains a lone surrogate: send valid Unicode",
        ),
        (sent(kind="set_input", drive=5), "set_input: drive: must be text, got 5"),
        (sent(kind="set_input", start=[]), "set_input: start: must be a number, got a list"),
        (
            sent(kind="add_link", name="l", points="AB"),
            'add_link: points: must be a list, got "AB"',
        ),
        (
            sent(kind="add_link", name="l", points=["A", 2]),
            "add_link: points[1]: must be text, got 2",
        ),
        (
            sent(kind="add_link", name="l", points=["A"] * 1001),
            "add_link: points: has 1001 entries, at most 1000 are read",
        ),
        (
            sent(kind="solve_at", at=[1]),
            "solve_at: at: must be an object of names and numbers, got a list",
        ),
        (
            sent(kind="newton_steps", guess={}, at={}, max_steps=1.5),
            "newton_steps: max_steps: must be a whole number, got 1.5",
        ),
        (
            sent(kind="together", edits=[{"kind": "undo"}]),
            'together: edits[0]: there is no kind "undo" (kinds: ',
        ),
        (sent(kind="undo", id=-1), "id: must be a whole number from 0 to 9007199254740992"),
        (sent(kind="undo", id=True), "id: must be a whole number from 0 to 9007199254740992"),
        ("[" * 100_000, "the message is not JSON: "),
        ('{"kind": ' + "9" * 5000 + "}", "the message is not JSON: "),
    ],
)
def test_what_is_wrong_is_said_with_its_place(text: str, message: str) -> None:
    with pytest.raises(MessageError) as caught:
        decoded(text)
    assert str(caught.value).startswith(message)


def test_the_id_comes_back_with_a_refusal() -> None:
    with pytest.raises(MessageError) as caught:
        decoded(sent(kind="set_number", id=12, name="a"))
    assert caught.value.id == 12


def test_a_message_too_large_is_not_parsed() -> None:
    with pytest.raises(MessageError, match="at most 2500000 are read"):
        decoded('"' + "é" * (LARGEST_MESSAGE // 2) + '"')


def test_a_file_of_the_largest_size_fits_into_a_message() -> None:
    assert decoded(sent(kind="set_text", text="\\" * 1_000_000))[0] == ask.SetText(
        text="\\" * 1_000_000
    )


NAMES = sorted({field.name for request in ask.REQUESTS for field in fields(request)})
PLAIN = (
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5)
    | st.sampled_from([kind_of(request) for request in ask.REQUESTS])
)  # fmt: skip
JSON = st.recursive(
    PLAIN,
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.sampled_from(["kind", *NAMES]), inner, max_size=5)
    ),
    max_leaves=12,
)


@given(JSON)
def test_random_json_is_read_or_refused(data: Any) -> None:
    try:
        request, _ = decoded(json.dumps(data))
    except MessageError:
        return
    assert isinstance(request, ask.REQUESTS)


@given(st.sampled_from(ask.REQUESTS), st.data())
def test_random_fields_are_read_with_their_types_or_refused(
    request: type, data: st.DataObject
) -> None:
    entries = {field.name: data.draw(JSON) for field in fields(request)}
    try:
        found, _ = decoded(json.dumps({"kind": kind_of(request), **entries}))
    except MessageError:
        return
    assert isinstance(found, request)
    for entry in vars(found).values():
        assert not (isinstance(entry, float) and not math.isfinite(entry))


@given(st.binary(max_size=60))
def test_random_bytes_are_refused(data: bytes) -> None:
    with pytest.raises(MessageError):
        decoded(data)


def test_every_kind_has_one_name() -> None:
    kinds = [kind_of(message) for message in (*ask.REQUESTS, *EVENTS)]
    assert len(set(kinds)) == len(kinds)
    assert kind_of(ask.ChooseConfiguration) == "choose_configuration"


def test_fields_are_of_types_that_every_language_has() -> None:
    def leaves(kind: Any) -> set[Any]:
        parts = [part for part in get_args(kind) if part is not Ellipsis]
        return {leaf for part in parts for leaf in leaves(part)} if parts else {kind}

    import typing

    for message in (*ask.REQUESTS, *EVENTS):
        for name, kind in typing.get_type_hints(message).items():
            for leaf in leaves(kind):
                plain = leaf in (str, int, float, bool, type(None))
                assert plain or hasattr(leaf, "__dataclass_fields__"), f"{message}.{name}: {leaf}"


def test_an_event_says_what_it_is_and_what_it_answers() -> None:
    assert json.loads(encoded(Refused(message="no"), 3)) == {
        "kind": "refused",
        "answers": 3,
        "message": "no",
    }


def test_no_event_leaves_with_a_number_that_is_none() -> None:
    none: Any = math.nan
    with pytest.raises(ValueError, match="Out of range float values"):
        encoded(Refused(message=none))
