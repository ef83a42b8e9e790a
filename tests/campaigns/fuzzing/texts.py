"""Texts of mechanism files and study plans, changed at random."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable

import numpy as np

from linkwork.core.textfile.reader import example_text, examples
from tests.campaigns.fuzzing.odd import FORMULAS, NAMES, NUMBERS, pick

__all__ = [
    "changed_bytes",
    "changed_text",
    "equation_text",
    "library_text",
    "plan_text",
    "task_text",
]

_TOKEN = re.compile(r'"[^"\n]*"|[-+]?[\d.]+(?:e[-+]?\d+)?|[^\W\d]\w*|\[\[?|\]\]?|\n|\S')
_NUMBER = re.compile(r"[-+]?[\d.]+(?:e[-+]?\d+)?")

Change = Callable[[np.random.Generator, list[str]], list[str]]

#: The ends of files of one equation each: what a beginner types.
_EQUATIONS = (
    'format = 1\n[equations]\nF = "x^2 - 2 = 0"\n[guess]\nx = 1\n',
    'format = 1\n[equations]\nF = "x^2 + y^2 = 25"\nG = "y = x + 1"\n[guess]\nx = 2\ny = 3\n',
    'format = 1\n[equations]\nF = "x^3 - 3*x + t = 0"\n[guess]\nx = 2\nt = 1\n'
    '[input]\nvariable = "t"\nfrom = -1\nto = 1\nstep = 0.5\n',
    'format = 1\n[dimensions]\na = 40\nb = 120\nc = 80\nd = 100\n[loops]\n'
    'bar = "a*cis(θ2) + b*cis(θ3) = d + c*cis(θ4)"\n[guess]\n"θ2" = 60\n"θ3" = 20\n"θ4" = 65\n'
    '[input]\nvariable = "θ2"\nfrom = 0\nto = 90\nstep = 30\n',
    'format = 1\n[loops]\na = "2*cis(p) + 2*cis(q) = 3"\n[guess]\np = 40\nq = -40\n',
)  # fmt: skip

_PLAN = """\
format = 1
name = "A small study"
mechanism = "four-bar"
sampling = "latin-hypercube"
count = 12
seed = 1
chunk = 4
keep = ["B.x", "rocker"]
[dimensions]
"O2 A" = { from = 36, to = 44 }
"A B" = [110, 120, 130]
"O4 B" = { mean = 70, deviation = 3 }
[input]
from = 0
to = 330
step = 60
[reductions]
swing = "stroke(rocker)"
mu_mean = "mean(mu)"
[filters]
cycle = "whole cycle"
transmission = "mu >= 25"
"""


#: The ends of tasks of every kind.
_TASKS = (
    'task = "motion"\n[wanted]\ntransmission = { least = 30 }\n'
    "lengths = { most = 1400, ratio = 20 }\nclear_of = [[140, 40, 30]]\n"
    "[rank]\nby = { transmission = 2, size = 1 }\ndeliver = 5\n",
    'task = "mixed"\nmechanism = "four-bar"\n[given]\nfixed_pivots = [[0, 0], [400, 0]]\n',
    'task = "path"\nmechanism = ["four-bar", "slider-crank"]\n[wanted]\norder = "any"\n'
    "fixed_pivots = { inside = [[0, 0], [400, 0], [400, 300]] }\n[improve]\nstarts = 10\n",
    'task = "function"\nmechanism = "slider-crank"\n[function]\nof = "log10(x)"\nx = [1, 2]\n'
    'input = [45, 105]\noutput = [0, 90]\nfit = "minimax"\n',
    'task = "function"\nmechanism = "four-bar"\n[function]\n'
    "pairs = [[0, 0], [20, 10], [35, 20], [50, 45]]\n",
)  # fmt: skip
_POSITIONS = ([0, 0, 0], [40, -40, 10], [100, -80, 25], [170, -110, 45], [260, -140, 75])


def library_text(rng: np.random.Generator) -> str:
    """The text of a mechanism of the library."""
    return example_text(pick(rng, list(examples())))


def equation_text(rng: np.random.Generator) -> str:
    """A small file of equations, often with other formulas."""
    text = pick(rng, _EQUATIONS)
    if rng.random() < 0.5:
        formulas = re.findall(r'= ("[^"\n]*=[^"\n]*")', text)
        new = pick(rng, FORMULAS)
        if "=" not in new and rng.random() < 0.8:
            new += f" = {pick(rng, FORMULAS) if rng.random() < 0.3 else pick(rng, NUMBERS)}"
        text = text.replace(pick(rng, formulas), f'"{new}"', 1)
    return changed_text(rng, text) if rng.random() < 0.8 else text


def plan_text(rng: np.random.Generator) -> str:
    """A small plan of a study, changed."""
    text = _PLAN
    if rng.random() < 0.4:
        text = text.replace('"four-bar"', f'"{pick(rng, list(examples()))}"')
    if rng.random() < 0.3:
        text = text.replace("latin-hypercube", pick(rng, ["grid", "random", "table"]))
    return changed_text(rng, text)


def task_text(rng: np.random.Generator) -> str:
    """A small task of synthesis, often changed."""
    text = f"format = 1\n{pick(rng, _TASKS)}"
    if '"function"' not in text:
        for x, y, angle in _POSITIONS[: int(rng.integers(6))]:
            text += f"[[positions]]\npoint = [{x}, {y}]\n"
            if '"motion"' in text or rng.random() < 0.3:
                text += f"angle = {angle}\n"
            if rng.random() < 0.1:
                text += f"{pick(rng, ['input', 'tolerance'])} = {pick(rng, NUMBERS)}\n"
    return changed_text(rng, text) if rng.random() < 0.8 else text


def changed_text(rng: np.random.Generator, text: str) -> str:
    """The text after one to three changes of tokens or lines."""
    for _ in range(pick(rng, [1, 1, 1, 1, 2, 3])):
        if rng.random() < 0.1:
            text = _changed_lines(rng, text)
            continue
        # the gaps between tokens are at even indices
        pieces = re.split(f"({_TOKEN.pattern})", text)
        text = "".join(pick(rng, _CHANGES)(rng, pieces))
    return text


def changed_bytes(rng: np.random.Generator, text: str) -> bytes:
    """The bytes of a text with some flipped, removed, inserted or cut off."""
    data = bytearray(text.encode())
    for _ in range(int(rng.integers(1, 5))):
        at = int(rng.integers(max(len(data), 1)))
        match int(rng.integers(5)):
            case 0 if data:
                data[at] ^= 1 << int(rng.integers(8))
            case 1:
                data[at : at + int(rng.integers(1, 9))] = b""
            case 2:
                data[at:at] = bytes(rng.integers(0, 256, int(rng.integers(1, 5)), dtype=np.uint8))
            case 3:
                data[at:at] = pick(
                    rng, [b"\xef\xbb\xbf", b"\r\n", b"\r", b"\0", b'"""', b"'", b"[["]
                )
            case _:
                if rng.random() < 0.2:
                    del data[at:]
    return bytes(data)


def _tokens(pieces: list[str], accept: Callable[[str], bool]) -> list[int]:
    return [k for k in range(1, len(pieces), 2) if accept(pieces[k])]


def _replaced(
    rng: np.random.Generator, pieces: list[str], accept: Callable[[str], bool], new: str
) -> list[str]:
    where = _tokens(pieces, accept)
    if where:
        pieces[pick(rng, where)] = new
    return pieces


def _new_number(rng: np.random.Generator, pieces: list[str]) -> list[str]:
    return _replaced(rng, pieces, lambda t: bool(_NUMBER.fullmatch(t)), pick(rng, NUMBERS))


def _scaled_number(rng: np.random.Generator, pieces: list[str]) -> list[str]:
    numbers = _tokens(pieces, lambda t: bool(_NUMBER.fullmatch(t)))
    if numbers:
        k = pick(rng, numbers)
        with contextlib.suppress(ValueError):
            pieces[k] = repr(
                float(pieces[k]) * pick(rng, [0.5, 0.9, 1 + 1e-9, 1.3, 3, -1, 1e3, 1e-3])
            )
    return pieces


def _new_formula(rng: np.random.Generator, pieces: list[str]) -> list[str]:
    text = f'"{pick(rng, FORMULAS)}"'
    return _replaced(rng, pieces, lambda t: t[:1] == '"' or bool(_NUMBER.fullmatch(t)), text)


def _new_name(rng: np.random.Generator, pieces: list[str]) -> list[str]:
    return _replaced(rng, pieces, lambda t: t[:1] == '"', f'"{pick(rng, NAMES)}"')


def _name_of_another(rng: np.random.Generator, pieces: list[str]) -> list[str]:
    names = _tokens(pieces, lambda t: t[:1] == '"' or t.isidentifier())
    if len(names) > 1:
        pieces[pick(rng, names)] = pieces[pick(rng, names)]
    return pieces


def _in_formula(rng: np.random.Generator, pieces: list[str]) -> list[str]:
    """Swap a letter, number or sign within a quoted formula."""
    texts = _tokens(pieces, lambda t: t[:1] == '"' and len(t) > 3)
    if texts:
        k = pick(rng, texts)
        at = int(rng.integers(1, len(pieces[k]) - 1))
        new = pick(
            rng,
            ["+", "-", "*", "/", "^", "(", ")", "i", "0", "9", "e", "x", "=", " ", ",", "1e308"],
        )
        pieces[k] = pieces[k][:at] + new + pieces[k][at + int(rng.integers(2)) :]
    return pieces


def _another_type(rng: np.random.Generator, pieces: list[str]) -> list[str]:
    values = ("[]", "{}", "[1, 2]", '["A", 3]', "{ a = 1 }", "[[]]", "[[1, 2], [3]]", "1979-05-27",
              "07:32:00", '""', "'x'", "[{}]", "[" * 30 + "]" * 30)  # fmt: skip
    return _replaced(rng, pieces, lambda t: t != "\n", pick(rng, values))


def _without(rng: np.random.Generator, pieces: list[str]) -> list[str]:
    return _replaced(rng, pieces, lambda t: True, "")


def _twice(rng: np.random.Generator, pieces: list[str]) -> list[str]:
    k = pick(rng, range(1, max(len(pieces), 2), 2))
    return [*pieces[: k + 1], " ", *pieces[k:]] if k < len(pieces) else pieces


_CHANGES: tuple[Change, ...] = (
    _new_number, _new_number, _new_number, _new_number, _scaled_number, _scaled_number,
    _scaled_number, _scaled_number, _scaled_number, _new_formula, _new_formula, _new_name,
    _name_of_another, _name_of_another, _in_formula, _another_type, _without, _twice,
)  # fmt: skip


def _changed_lines(rng: np.random.Generator, text: str) -> str:
    """The text with a line doubled, removed, moved, or taken from another file."""
    lines = text.split("\n")
    at, other = (int(rng.integers(len(lines))) for _ in range(2))
    match int(rng.integers(5)):
        case 0:
            lines.insert(other, lines[at])
        case 1:
            del lines[at]
        case 2:
            lines[at], lines[other] = lines[other], lines[at]
        case 3:
            foreign = library_text(rng).split("\n")
            lines.insert(at, pick(rng, foreign))
        case _:
            tables = [k for k, line in enumerate(lines) if line.startswith("[")]
            if tables:
                begin = pick(rng, tables)
                end = next((k for k in tables if k > begin), len(lines))
                del lines[begin:end]
    return "\n".join(lines)
