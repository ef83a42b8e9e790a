"""The types of the messages in TypeScript say what the dataclasses say."""

from __future__ import annotations

import re

from linkwork.app.live.events import EVENTS
from linkwork.app.live.messages import typescript_types
from linkwork.app.live.requests import REQUESTS


def interface(name: str) -> str:
    found = re.search(rf"export interface {name} \{{\n(.*?)\n\}}", typescript_types(), re.DOTALL)
    assert found is not None, name
    return found[1]


def test_a_request_has_its_kind_and_may_leave_out_what_has_a_default() -> None:
    assert interface("SetNumber").splitlines() == [
        '  kind: "set_number";',
        "  id?: number;",
        "  name: string;",
        "  value: number | string;",
        "  any_formula?: boolean;",
        "  live?: boolean;",
        "  rates?: boolean;",
    ]
    assert "  edits: readonly (LiveEdit)[];" in interface("Together")
    assert "  step?: number | string | null;" in interface("SetInput")


def test_an_event_has_all_its_fields() -> None:
    assert "  answers: number | null;" in interface("Refused")
    cycle = interface("MotionFound")
    assert "  limits: readonly (LimitFound)[];" in cycle
    assert "?" not in cycle
    assert "  page: PageData | null;" in cycle
    assert "  points: Record<string, readonly [" in interface("PositionFound")
    assert "interface PageData" not in typescript_types()


def test_every_message_and_every_part_has_its_type_once() -> None:
    text = typescript_types()
    names = re.findall(r"export interface (\w+)", text)
    assert len(set(names)) == len(names)
    assert {m.__name__ for m in (*REQUESTS, *EVENTS)} <= set(names)
    names.append("PageData")  # imported from the module of its own
    used = set(re.findall(r"\b[A-Z]\w+", re.sub(r"//.*|\".*?\"", "", text)))
    assert used - set(names) == {"Record", "LiveEdit", "LiveRequest", "LiveEvent"}
