"""Circuits and configurations are sequences, and their members have names."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
import pytest

import linkwork as lw


@cache
def _circuits() -> lw.circuits.Circuits:
    return lw.example("four-bar").circuits()


@cache
def _configurations() -> lw.circuits.Configurations:
    return lw.example("four-bar").configurations(60)


_LISTS = pytest.mark.parametrize(
    ("found", "second"), [(_circuits, "circuit 2"), (_configurations, "crossed")]
)


@_LISTS
def test_a_list_with_names_is_a_sequence(found: Callable[[], Any], second: str) -> None:
    members = found()
    assert Sequence in type(members).__mro__
    both = tuple(members)
    assert len(members) == len(both) == 2
    assert members[1:] == members[1:3] == both[1:]
    assert members[::-1] == tuple(reversed(members)) == both[::-1]
    assert members[5:] == ()
    assert members[np.int64(1)] is members[-1] is members[second] is both[1]
    assert both[1] in members
    assert members.index(both[1]) == 1


@_LISTS
def test_what_a_list_does_not_have_is_named(found: Callable[[], Any], second: str) -> None:
    members = found()
    with pytest.raises(lw.UnknownNameError, match=rf'there is no .*"{second}x".* \(.*{second}\b'):
        members[second + "x"]
    with pytest.raises(IndexError):
        members[2]
    with pytest.raises(lw.UnknownNameError, match=r'there is no .*"1\.0"'):
        members[1.0]
