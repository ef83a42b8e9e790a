"""Names of points, links and unknowns: Greek letters, spelling, LaTeX."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import cast

from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.values import as_told, is_listed

# ----------------------------------------------------------------------
# Spellings of names: ``θ₁₂``, ``ϑ12``, ``θ12`` and ``theta12`` are the same name.


#: The name of the fixed link.
GROUND = "ground"
GREEK = {
    "α": "alpha", "β": "beta", "γ": "gamma", "δ": "delta", "ε": "epsilon", "ζ": "zeta",
    "η": "eta", "θ": "theta", "ι": "iota", "κ": "kappa", "λ": "lambda", "μ": "mu",
    "ν": "nu", "ξ": "xi", "ο": "omicron", "π": "pi", "ρ": "rho", "σ": "sigma",
    "ς": "sigma", "τ": "tau", "υ": "upsilon", "φ": "phi", "χ": "chi", "ψ": "psi",
    "ω": "omega", "Γ": "Gamma", "Δ": "Delta", "Θ": "Theta", "Λ": "Lambda", "Ξ": "Xi",
    "Π": "Pi", "Σ": "Sigma", "Φ": "Phi", "Ψ": "Psi", "Ω": "Omega",
}  # fmt: skip
_LETTER = {spelled: letter for letter, spelled in GREEK.items() if letter != "ς"}


def as_name(name: object) -> str:
    """The name itself.

    Raises
    ------
    InputError
        If it is not a text.
    """
    if not isinstance(name, str):
        raise InputError(f"a name must be a text, got {as_told(name)}")
    return name


def as_names(what: str, given: object) -> tuple[str, ...]:
    """The names in a list; a text alone is one name.

    Raises
    ------
    InputError
        If it is not a list of texts; ``what`` names it in the message.
    """
    if isinstance(given, str):
        return (given,)
    if not is_listed(given):
        raise InputError(f"{what} must be a list of names, got {as_told(given)}")
    return tuple(map(as_name, cast(Iterable[object], given)))


def canonical(name: str) -> str:
    """The form in which names are compared: NFKC, Greek letters spelled out.

    Raises
    ------
    InputError
        If it is not a text.
    """
    return _canonical(as_name(name))


@lru_cache(maxsize=4096)  # asked for again and again while a dimension is dragged
def _canonical(name: str) -> str:
    # subscript digits become plain digits, wide letters narrow ones
    folded = unicodedata.normalize("NFKC", name)
    return "".join(GREEK.get(letter, letter) for letter in folded)


def find_spelling(name: str, known: Iterable[str]) -> str:
    """The spelling of a name in ``known``, or the name itself if it is not there."""
    if isinstance(known, Mapping) and as_name(name) in known:
        return name
    folded = canonical(name)
    return next((other for other in known if canonical(other) == folded), name)


def is_name(text: str) -> bool:
    """Whether ``text`` is a valid name: a letter or ``_``, then letters, digits, _ and '."""
    folded = unicodedata.normalize("NFKC", text)
    body = folded.rstrip("'")
    return body.isidentifier() and len(folded) <= 80


def _stem_and_index(name: str) -> tuple[str, str]:
    stem = name.rstrip("0123456789'")
    return stem, name[len(stem) :]


def pretty(name: str) -> str:
    """The name with a Greek letter where it starts with a spelled one: ``theta12`` → ``θ12``."""
    stem, index = _stem_and_index(name)
    head, bar, tail = stem.partition("_")
    return _LETTER.get(head, head) + bar + tail + index


def latex_name(name: str) -> str:
    r"""The name for LaTeX: ``theta12`` → ``\theta_{12}``, ``crank`` → ``\mathrm{crank}``."""
    stem, index = _stem_and_index(canonical(name))
    head, _, tail = stem.rstrip("_").partition("_")
    if any(letter.isdigit() for letter in head) and not tail:  # O2O4: the last digit is no index
        head, index = head + index.rstrip("'"), index[len(index.rstrip("'")) :]
    primes = index.count("'") * "'"
    subscript = ",".join(part for part in (tail.replace("_", r"\_"), index.rstrip("'")) if part)
    base = rf"\{head}" if head in _LETTER else head if len(head) == 1 else rf"\mathrm{{{head}}}"
    if len(subscript) > 1 or not subscript.isalnum():
        subscript = f"{{{subscript}}}" if subscript else ""
    return base + primes + (f"_{subscript}" if subscript else "")


def free_name(name: str, taken: set[str]) -> str:
    """``name``, with a number if it is in ``taken`` (canonical names); it is added to them."""
    found, k = name, 1
    while canonical(found) in taken:
        found, k = f"{name}{k}", k + 1
    taken.add(canonical(found))
    return found


# ----------------------------------------------------------------------
# Texts in LaTeX's text mode.


_LATEX = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#",
    "%": r"\%", "_": r"\_", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}",
    "°": r"$^\circ$", "·": r"$\cdot$", "−": "$-$", "⁻": "$^-$", "′": "$'$",
    "ₓ": "$_x$", "ᵧ": "$_y$",
    "µ": r"$\mu$", "≤": r"$\leq$", "≥": r"$\geq$", "±": r"$\pm$", "×": r"$\times$", "→": r"$\to$",
    "∞": r"$\infty$", "|": r"$|$", "<": "$<$", ">": "$>$", "–": "--", "…": r"\dots{}",
    "∠": r"$\angle$", "₋": "$_-$", "‖": r"$\|$",
    **{digit: f"$_{k}$" for k, digit in enumerate("₀₁₂₃₄₅₆₇₈₉")},
    **{digit: f"$^{k}$" for k, digit in enumerate("⁰¹²³⁴⁵⁶⁷⁸⁹")},
    **{letter: f"$\\{name}$" for letter, name in GREEK.items() if name not in ("omicron",)},
}  # fmt: skip


def as_latex(text: str) -> str:
    """A text for LaTeX's text mode."""
    return "".join(_LATEX.get(letter, letter) for letter in text)


# ----------------------------------------------------------------------
# Short decimal numbers: 180 instead of 180.00000000000003.


_SAME_NUMBER = 1e-13  # relative: rounding of a few operations


def short_number(value: float) -> float:
    """The value to nine decimals where that is the same number to rounding."""
    short = round(float(value), 9)
    return (
        short + 0.0 if abs(short - value) <= _SAME_NUMBER * max(1.0, abs(value)) else float(value)
    )
