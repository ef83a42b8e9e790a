"""Mechanism files: TOML in, with every problem at its line; TOML out, and the JSON Schema."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.textfile.lines import Lines
    from linkwork.textfile.reader import ReadFile, read_bytes, read_file, read_text
    from linkwork.textfile.schema import json_schema, schema_of, schema_text
    from linkwork.textfile.text_edits import TextEdits
    from linkwork.textfile.writer import save, save_text, write_text
else:
    __getattr__ = loader(
        __name__,
        {
            "lines": ("Lines",),
            "reader": ("ReadFile", "read_bytes", "read_file", "read_text"),
            "schema": ("json_schema", "schema_of", "schema_text"),
            "text_edits": ("TextEdits",),
            "writer": ("save", "save_text", "write_text"),
        },
    )

__all__ = [
    "Lines",
    "ReadFile",
    "TextEdits",
    "json_schema",
    "read_bytes",
    "read_file",
    "read_text",
    "save",
    "save_text",
    "schema_of",
    "schema_text",
    "write_text",
]
