"""Texts in LaTeX's text mode."""

from __future__ import annotations

from linkwork.foundation.names import GREEK

__all__ = ["as_latex"]

_LATEX = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#",
    "%": r"\%", "_": r"\_", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}",
    "°": r"$^\circ$", "·": r"$\cdot$", "−": "$-$", "²": "$^2$", "³": "$^3$", "′": "$'$",
    "µ": r"$\mu$", "≤": r"$\leq$", "≥": r"$\geq$", "±": r"$\pm$", "×": r"$\times$", "→": r"$\to$",
    "∞": r"$\infty$", "|": r"$|$", "<": "$<$", ">": "$>$", "–": "--", "…": r"\dots{}",
    "∠": r"$\angle$", "₋": "$_-$", "‖": r"$\|$",
    **{digit: f"$_{k}$" for k, digit in enumerate("₀₁₂₃₄₅₆₇₈₉")},
    **{letter: f"$\\{name}$" for letter, name in GREEK.items() if name not in ("omicron",)},
}  # fmt: skip


def as_latex(text: str) -> str:
    """A text for LaTeX's text mode."""
    return "".join(_LATEX.get(letter, letter) for letter in text)
