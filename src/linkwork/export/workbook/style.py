"""The formats of the cells of a workbook."""

from __future__ import annotations

from typing import Any

__all__ = ["Style"]

_INK, _FAINT, _RULE = "#1f2933", "#7b8794", "#9aa5b1"
_FORMATS: dict[str, dict[str, Any]] = {
    "title": {"bold": True, "font_size": 16, "font_color": _INK},
    "heading": {"bold": True, "font_size": 12, "font_color": _INK, "bottom": 1},
    "group": {
        "bold": True, "align": "center", "bg_color": "#d9e2ec", "border": 1, "border_color": _RULE,
    },
    "head": {"bold": True, "align": "right", "shrink": True, "bg_color": "#eef2f6"},
    "head_left": {"bold": True, "align": "left", "valign": "top", "bg_color": "#eef2f6"},
    "unit": {
        "italic": True, "align": "right", "font_color": _FAINT, "bg_color": "#eef2f6", "bottom": 1,
    },
    "text": {},
    "wrapped": {"text_wrap": True, "valign": "top"},
    "note": {"italic": True, "font_color": _FAINT},
    "warning": {"text_wrap": True, "valign": "top", "font_color": "#9c3d00"},
    "code": {"font_name": "Consolas", "font_size": 10},
    "count": {"num_format": "0", "font_color": _FAINT},
    "number": {"num_format": "0.000000"},
    "general": {},
    "small": {"num_format": "0.0E+00"},
    "result": {"num_format": "0.0E+00", "align": "left"},
    "result_count": {"num_format": "0", "align": "left"},
    "unit_right": {"indent": 1},
    "slope": {"num_format": "0.0000"},
    "start": {"num_format": "0.000000", "left": 1, "left_color": _RULE},
    "input": {"bg_color": "#fff7cc", "font_color": "#0b3d91", "border": 1, "border_color": _RULE},
    "input_number": {
        "bg_color": "#fff7cc", "font_color": "#0b3d91", "num_format": "0.000000",
    },
    "derived": {"bg_color": "#e9f5ec", "border": 1, "border_color": _RULE},
    "value": {"italic": True, "font_color": _FAINT, "num_format": "0.000000"},
    "fixed": {
        "italic": True, "font_color": _FAINT, "bg_color": "#eceff1", "border": 1,
        "border_color": _RULE,
    },
    "right": {"align": "right"},
    "status": {"indent": 1, "shrink": True},
    "head_indented": {"bold": True, "align": "left", "indent": 1, "bg_color": "#eef2f6"},
    "relative": {"num_format": "0.0E+00", "align": "right"},
    "good": {"font_color": "#2d6a4f"},
    "doubtful": {"font_color": "#8d6708"},
    "lost": {"font_color": "#9c1c00"},
    "faded": {"font_color": "#b8c1cc"},
    "solved": {"font_color": _FAINT, "align": "right"},
    "changed": {"bg_color": "#ffe2b8", "bold": True},
    "wrong": {"bg_color": "#ffd9d1", "font_color": "#9c1c00", "bold": True},
}  # fmt: skip


class Style:
    """The formats of one workbook by name."""

    def __init__(self, workbook: Any) -> None:
        self._formats = {name: workbook.add_format(look) for name, look in _FORMATS.items()}

    def __getitem__(self, name: str) -> Any:
        return self._formats[name]
