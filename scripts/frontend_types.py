"""The TypeScript types of the front end's data, from the Python dataclasses.

python scripts/frontend_types.py          writes frontend/src/page_data.ts
python scripts/frontend_types.py --check  says whether it is current
"""

from __future__ import annotations

import sys
import types
import typing
from dataclasses import fields, is_dataclass
from pathlib import Path

from linkwork.viewer import page_data

TARGET = Path(__file__).resolve().parent.parent / "frontend" / "src" / "page_data.ts"
PLAIN = {str: "string", int: "number", float: "number", bool: "boolean", type(None): "null"}


def typescript(kind: object) -> str:
    """The TypeScript type of JSON that holds a Python type."""
    if isinstance(kind, type) and kind in PLAIN:
        return PLAIN[kind]
    if is_dataclass(kind) and isinstance(kind, type):
        return kind.__name__
    origin, inside = typing.get_origin(kind), typing.get_args(kind)
    if origin is tuple and len(inside) == 2 and inside[1] is Ellipsis:
        own = typescript(inside[0])
        return f"readonly ({own})[]" if " | " in own else f"readonly {own}[]"
    if origin in (typing.Union, types.UnionType):
        return " | ".join(map(typescript, inside))
    if origin is dict and inside[0] is str:
        return f"Readonly<Record<string, {typescript(inside[1])}>>"
    if origin is typing.Literal:
        return " | ".join(f'"{value}"' for value in inside)
    raise TypeError(f"{kind!r} has no counterpart in the front end: use plain data")


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
    head = "// Written by scripts/frontend types from src/linkwork/viewer/page_data.py."
    return "\n\n".join([head, *map(interface, kinds)]) + "\n"


def main(arguments: list[str]) -> int:
    text = module_text()
    if arguments == ["--check"]:
        if not TARGET.exists() or TARGET.read_text(encoding="utf-8") != text:
            sys.stderr.write(
                "frontend/src/page_data.ts is not current: run scripts/frontend types\n"
            )
            return 1
        return 0
    TARGET.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
