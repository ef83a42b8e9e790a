"""Descriptions by their form, for tests that know which one a mechanism has."""

from __future__ import annotations

from typing import TypeVar

from linkwork import Mechanism
from linkwork.core.mechanism.description import Description

__all__ = ["described_as"]

_Form = TypeVar("_Form", bound=Description)


def described_as(form: type[_Form], mechanism: Mechanism) -> _Form:
    """A mechanism's description, which has that form."""
    description = mechanism.description
    assert isinstance(description, form)
    return description
