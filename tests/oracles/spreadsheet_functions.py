"""The functions that formulas may use, with their numbers of arguments (ECMA-376 part 1, 18.17.7).

Written from the syntax lines of the specification. ``None``: an argument list of one to 255.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

__all__ = ["ARGUMENTS", "calls"]

ARGUMENTS: dict[str, tuple[int, int | None]] = {
    "ABS": (1, 1), "ACOS": (1, 1), "AND": (1, None), "ASIN": (1, 1), "ATAN": (1, 1),
    "ATAN2": (2, 2), "COS": (1, 1), "COUNT": (1, None), "COUNTIF": (2, 2), "DEGREES": (1, 1),
    "EXP": (1, 1), "IF": (2, 3), "IFERROR": (2, 2), "INDEX": (2, 4), "ISNUMBER": (1, 1),
    "LN": (1, 1), "LOG10": (1, 1), "MAX": (1, None), "MIN": (1, None), "MINVERSE": (1, 1),
    "MMULT": (2, 2), "NA": (0, 0), "PI": (0, 0), "RADIANS": (1, 1), "SIN": (1, 1),
    "SQRT": (1, 1), "SUM": (1, None), "SUMPRODUCT": (1, None), "SUMSQ": (1, None),
    "SUMXMY2": (2, 2), "TAN": (1, 1),
}  # fmt: skip

_PART = re.compile(r'"(?:[^"]|"")*"|[A-Za-z_][\w.]*\(|[(){},]|[^"(){},A-Za-z_]+|[\w.]+')


def calls(formula: str) -> Iterator[tuple[str, int, int]]:
    """Function, number of arguments and depth of every call in a formula."""
    assert "".join(_PART.findall(formula)) == formula
    open_calls: list[list[str | int]] = []
    before = ""
    for part in _PART.findall(formula):
        if part.endswith("("):
            open_calls.append([part[:-1], 0, len(open_calls) + 1])
        elif part == "{":
            open_calls.append(["{", 0, 0])
        elif part == "," and open_calls[-1][0] not in ("", "{"):
            open_calls[-1][1] = int(open_calls[-1][1]) + 1
        elif part in (")", "}"):
            name, commas, depth = open_calls.pop()
            if name not in ("", "{"):
                empty = before == f"{name}("
                yield str(name), 0 if empty else int(commas) + 1, int(depth)
        before = part
    assert not open_calls
