"""Enumerations whose members are stored in arrays by a small whole number."""

from __future__ import annotations

from enum import Enum
from typing import Self

from linkwork.foundation.arrays import StatusArray

__all__ = ["CodedEnum"]


class CodedEnum(Enum):
    """Members are sentences; codes number them in the order of the class."""

    code: int

    def __init__(self, sentence: str) -> None:
        self.code = len(type(self).__members__)

    @classmethod
    def of_code(cls, code: int) -> Self:
        """The member with this code."""
        return tuple(cls)[code]

    @classmethod
    def of_codes(cls, codes: StatusArray) -> tuple[Self, ...]:
        """The members with these codes (B,)."""
        return tuple(map(tuple(cls).__getitem__, codes.tolist()))
