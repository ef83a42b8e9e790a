"""Equations of MathML as terms, in the languages of Word and Typst, so that lines can break."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from xml.etree import ElementTree as Tree

__all__ = ["mathml_terms", "office_terms", "typst_terms"]

_BREAKS = ("+", "\u2212", "=")
_SILENT = ("\u2061", "\u2062")  # application of a function, times
_SPACE = '<mspace width="0.17em"/>'


def mathml_terms(mathml: str) -> list[str]:
    """The terms of a ``<math>`` element, each as an element that begins with its sign."""
    found: list[str] = []
    for parts in _terms(mathml):
        lead = parts[0]
        if lead.tag == "mo" and len(found):
            lead.set("form", "infix")
        inside = "".join(Tree.tostring(part, encoding="unicode") for part in parts)
        for silent in _SILENT:  # browsers leave no room for them
            inside = inside.replace(f"<mo>{silent}</mo>", _SPACE)
        found.append(f"<math>{inside}</math>")
    return found


def office_terms(mathml: str) -> list[str]:
    """The terms as runs of Office MathML, each the content of an ``m:oMath`` element.

    No term begins with an equals sign, which LibreOffice shows as an error.
    """
    found: list[str] = []
    for parts in _terms(mathml):
        shown = "".join(map(_office, parts))
        if found and parts[0].tag == "mo" and parts[0].text == "=":
            found[-1] += shown
        else:
            found.append(shown)
    return found


def typst_terms(mathml: str) -> list[str]:
    """The terms in the notation of formulas of Typst."""
    return [" ".join(filter(None, map(_typst, parts))) for parts in _terms(mathml)]


def _terms(mathml: str) -> Iterator[list[Tree.Element]]:
    """The elements of an equation, divided before every sign between terms."""
    here: list[Tree.Element] = []
    for part in Tree.fromstring(mathml):
        sign = part.tag == "mo" and part.text in _BREAKS
        # a sign after an equals sign belongs to the same term
        if sign and here and not (here[-1].tag == "mo" and here[-1].text in _BREAKS):
            yield here
            here = []
        here.append(part)
    yield here


def _office(part: Tree.Element) -> str:
    inside = [_office(child) for child in part]
    match part.tag:
        case "mi" | "mn" | "mo":
            text = part.text or ""
            if text in _SILENT:
                return ""
            # names of several letters and numbers are upright
            plain = part.tag != "mi" or len(text) > 1
            style = '<m:rPr><m:sty m:val="p"/></m:rPr>' if plain else ""
            return f"<m:r>{style}<m:t>{escape(text)}</m:t></m:r>"
        case "msub":
            return f"<m:sSub><m:e>{inside[0]}</m:e><m:sub>{inside[1]}</m:sub></m:sSub>"
        case "msup":
            return f"<m:sSup><m:e>{inside[0]}</m:e><m:sup>{inside[1]}</m:sup></m:sSup>"
        case "mfrac":
            return f"<m:f><m:num>{inside[0]}</m:num><m:den>{inside[1]}</m:den></m:f>"
        case "msqrt":
            hidden = '<m:radPr><m:degHide m:val="1"/></m:radPr><m:deg/>'
            return f"<m:rad>{hidden}<m:e>{''.join(inside)}</m:e></m:rad>"
        case _:
            return "".join(inside)


def _typst(part: Tree.Element) -> str:
    inside = [shown for child in part if (shown := _typst(child))]
    match part.tag:
        case "mi" | "mn" | "mo":
            return _typst_letter(part)
        case "msub":
            return f"attach({inside[0]}, b: {inside[1]})"
        case "msup":
            return f"attach({inside[0]}, t: {inside[1]})"
        case "mfrac":
            return f"frac({inside[0]}, {inside[1]})"
        case "msqrt":
            return f"sqrt({' '.join(inside)})"
        case _:
            return " ".join(inside)


def _typst_letter(part: Tree.Element) -> str:
    text = part.text or ""
    if text in _SILENT:
        return "thin" if text == _SILENT[1] else ""
    quoted = '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if part.tag == "mi":
        return f"italic({quoted})" if len(text) == 1 else f"upright({quoted})"
    if part.tag == "mn":
        return quoted
    return {"\u2212": "minus", "+": "plus", "=": "eq", "\u2032": "prime"}.get(text, quoted)
