"""Odd values, names, formulas and Python objects for random inputs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

__all__ = ["FORMULAS", "NAMES", "NUMBERS", "OBJECTS", "pick"]

T = TypeVar("T")

#: TOML literals of numbers at and beyond every limit.
NUMBERS = (
    "0", "-0.0", "0.0", "1", "-1", "2", "3", "1e-300", "5e-324", "1e-12", "1e-9", "1e9", "1e15",
    "1e23", "-1e23", "1e100", "1e154", "1e155", "-1e200", "1e300", "1e308", "-1e308",
    "1.7976931348623157e308", "nan", "inf", "-inf", "+inf", "1000000", "1000000.5", "360e6",
    "9007199254740993", "9223372036854775807", "9" * 40, "0x7fff", "0b1", "1_000", "90", "180",
    "360", "-360", "720", "0.1", "1e-3", "45.0", "true", "false",
)  # fmt: skip

NAMES = (
    "", " ", "  a ", "θ2", "theta2", "θ", "Ω", "ground", "link", "input", "i", "e", "pi", "cis",
    "sin", "x", "y", "A", "B", "A B", "A B C", "O2 A", "a.b", "A.x", "A.velocity", "time", "status",
    "nowhere", "1", "0", "nan", "inf", "true", "None", "__init__", "a" * 300, "ä", "é́", "😀",
    "\\u0000", "\\n", "\\t", "\\u200b", "\\u202e", "クランク", "A, B", "O4", "crank", "coupler",
    "rocker", "min(A.x)", "stroke(B.x)", "max", "[A]", "A=B", "%s", "{0}", "$A", "'", "#",
)  # fmt: skip

FORMULAS = (
    "1/0", "0/0", "0^0", "sqrt(-1)", "asin(2)", "log(0)", "exp(1000)", "1e308*10", "1e999", "-",
    "(", ")", "((1)", "2*", "*2", "a", "a+", "x^2", "x^0.5", "x^-1", "x^x", "2^2^2^2^2", "9^9^9^9",
    "i", "i*i", "e^(i*90)", "cis(1e300)", "cis(nan)", "tan(90)", "abs(-1)", "sin", "sin()",
    "sin(1,2)",
    "atan2(0, 0)", "1 = 1", "x = x", "0 = 0", "x = 1", "x*y = 1e308", "x + 1e-300 = 0", "10,5",
    "1e", "1.2.3", "ππ", "2π", "α*β", "min(1)", "floor(x)", "pi^pi", "-x^2", "--1", "+1", "1 - - 1",
    "x^20 - 1e308 = 0", "exp(exp(exp(x))) = 1", "x/x = 1", "1/x = 0", "sqrt(x) = -1", "sin(x) = 2",
    "abs(x) = -1", "x^1e6 = 2", "a*cis(b)", "conj(x)", "40mm", "2 k", "a b", "x ** 2 = 4",
    "x^(1/3)",
    "(" * 40 + "1" + ")" * 40, "-" * 60 + "1", "+".join(["x"] * 200) + " = 1", "x^x^x^x^x = 2",
    "*".join(["sin(x)"] * 30) + " = 0", "cis(" * 30 + "1" + ")" * 30,
)  # fmt: skip

#: Python objects of every type, for arguments of every type.
OBJECTS: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 3, 10**6, 10**400, -(2**63), 0.0, -0.0, 1.5, 1e308, 1e23,
    float("nan"),
    float("inf"), 1j, complex("nan"), "", "A", "crank", "four-bar", "O2 A", "1/0", "\0", "😀",
    "\ud800", b"",
    b"A", bytearray(b"x"), [], [1], ["A"], [None], [[]], [1, "A"], (), (1, 2), ("A", "B"), {},
    {"A": 1},
    {"A": None}, {1: 2}, {"O2 A": [1, 2]}, {"O2 A": 40}, {"O2 A": []}, {"O2 A": "x"}, {"a": (1, 2)},
    {"theta2": 40}, {None: None}, set(), {1, 2}, frozenset({"A"}), range(3), range(0), object,
    object(), int,
    len, lambda: 1, lambda x: x, slice(None), Ellipsis, Path("nowhere.toml"), Path(),
    Path("/"), np.float64(2), np.int32(3), np.array([]), np.array([1.0, 2.0]), np.array([[1.0]]),
    np.array("A"), np.array([None]), np.array(1.0), np.datetime64("2020-01-01"), iter([1, 2]),
    (x for x in "AB"), memoryview(b"A"), ValueError("x"), type("Odd", (), {})(), [float("nan")] * 3,
    {"O2 A": [float("nan")]}, {"O2 A": [1e308, -1e308]}, {"O2 A": np.array([40, 41.0])}, "x" * 5000,
)  # fmt: skip


def pick(rng: np.random.Generator, entries: Sequence[T]) -> T:
    """One of the entries."""
    return entries[int(rng.integers(len(entries)))]
