"""The TypeScript types of the front end's data and of the live page's messages, from Python.

python scripts/frontend_types.py          writes frontend/src/page_data.ts and messages.ts
python scripts/frontend_types.py --check  checks that they are current
"""

from __future__ import annotations

import sys
import types
import typing
from dataclasses import fields, is_dataclass
from pathlib import Path

from linkwork.app.live.messages import typescript_types
from linkwork.app.pages import page_data

SOURCES = Path(__file__).resolve().parent.parent / "frontend" / "src"
PLAIN = {str: "string", int: "number", float: "number", bool: "boolean", type(None): "null"}


def typescript(kind: object) -> str:
    """The TypeScript type of a Python type as JSON."""
    if isinstance(kind, type) and kind in PLAIN:
        return PLAIN[kind]
    if is_dataclass(kind) and isinstance(kind, type):
        return kind.__name__
    origin, inside = typing.get_origin(kind), typing.get_args(kind)
    if origin is tuple and len(inside) == 2 and inside[1] is Ellipsis:
        own = typescript(inside[0])
        return f"readonly ({own})[]" if " " in own else f"readonly {own}[]"
    if origin in (typing.Union, types.UnionType):
        return " | ".join(map(typescript, inside))
    if origin is dict and inside[0] is str:
        return f"Readonly<Record<string, {typescript(inside[1])}>>"
    if origin is typing.Literal:
        return " | ".join(f'"{value}"' for value in inside)
    raise TypeError(f"{kind!r} has no TypeScript type: use plain data")


def interface(kind: type) -> str:
    """One dataclass as an interface, its docstring as the comment."""
    hints = typing.get_type_hints(kind)
    story = " ".join((kind.__doc__ or "").split()).replace("``", "`")
    rows = [f"/** {story} */", f"export interface {kind.__name__} {{"]
    rows += [f"  readonly {f.name}: {typescript(hints[f.name])};" for f in fields(kind)]
    return "\n".join([*rows, "}"])


def module_text() -> str:
    """The whole file."""
    kinds = [getattr(page_data, name) for name in page_data.__all__]
    head = "// Written by scripts/frontend types from src/linkwork/app/pages/page_data.py."
    return "\n\n".join([head, *map(interface, kinds)]) + "\n"


def main(arguments: list[str]) -> int:
    texts = {
        "page_data.ts": module_text(),
        "messages.ts": typescript_types(),
    }
    stale = 0
    for name, text in texts.items():
        target = SOURCES / name
        if arguments != ["--check"]:
            target.write_text(text, encoding="utf-8")
        elif not target.exists() or target.read_text(encoding="utf-8") != text:
            sys.stderr.write(f"frontend/src/{name} is not current: run scripts/frontend types\n")
            stale = 1
    return stale


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
