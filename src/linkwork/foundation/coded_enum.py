"""Enumerations whose members are stored in arrays by a small whole number."""

from __future__ import annotations

from enum import Enum
from typing import Self

import numpy as np

from linkwork.foundation.arrays import BoolArray, StatusArray

__all__ = ["CodedEnum"]


class CodedEnum(Enum):
    """Members are sentences; codes number them in the order of the class."""

    code: int

    def __init__(self, sentence: str) -> None:
        self.code = len(type(self).__members__)

    @property
    def label(self) -> str:
        """The name as words, as in ``out of reach``."""
        return self.name.lower().replace("_", " ")

    @classmethod
    def of_code(cls, code: int) -> Self:
        """The member with this code."""
        return tuple(cls)[code]

    @classmethod
    def of_codes(cls, codes: StatusArray) -> tuple[Self, ...]:
        """The members with these codes (B,)."""
        members = tuple(cls)
        # most tables have one status
        if len(codes) and (codes == codes[0]).all():
            return (members[codes[0]],) * len(codes)
        return tuple(map(members.__getitem__, codes.tolist()))

    def where(self, members: tuple[Self, ...]) -> BoolArray:
        """Which of some members are this one, (B,)."""
        if members.count(self) == len(members):
            return np.ones(len(members), dtype=bool)
        return np.array([member is self for member in members], dtype=bool)
