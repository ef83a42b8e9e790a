"""Parse the bytes of a TOML file; reject broken or hostile files with a reason."""

from __future__ import annotations

import os
import re
import tomllib
from glob import escape
from pathlib import Path
from typing import Any, NoReturn

from linkwork.foundation.errors import MechanismFileError, Problem, choices
from linkwork.foundation.names import canonical
from linkwork.textfile.tokens import Token, Tokens

__all__ = ["LARGEST", "bytes_of", "data_of", "text_of"]

#: Maximum size of a file [bytes].
LARGEST = 1_000_000
_DEEPEST = 20  # nested brackets; the format needs three
_MOST_PARTS = 8  # of a dotted key; the parser's memory grows quadratically
_LONGEST_WORD = 400  # bare keys and numbers: Python itself rejects longer numbers
_PLACE = re.compile(r" \((?:at line (\d+), column (\d+)|at end of document)\)$")
_TWICE = re.compile(r"cannot declare \('(.*)'(?:,)?\) twice")
_SEPARATOR = "', '"
_NOT_QUOTED = re.compile(r"[\w']+")


def _refuse(name: str, message: str, line: int | None = None) -> NoReturn:
    raise MechanismFileError([Problem(key=(), message=message, line=line)], name)


def bytes_of(path: Path, name: str, most: int = LARGEST) -> bytes:
    """The bytes of a file, at most so many.

    Raises
    ------
    MechanismFileError
        If the file does not exist, cannot be read or is too large.
    """
    try:
        with path.open("rb") as file:
            # one byte more than allowed shows that the file is too large without reading all of it
            data = file.read(most + 1)
            if len(data) > most:
                _refuse(name, _too_large(max(path.stat().st_size, len(data)), most))
            return data
    except FileNotFoundError:
        _refuse(name, f"there is no such file {_files_beside(path)}")
    except IsADirectoryError:
        _refuse(name, f"is a folder: name one file in it {_files_beside(path / 'x')}")
    except (OSError, ValueError) as error:
        if os.path.isdir(path):  # opening a folder is a PermissionError on Windows
            _refuse(name, f"is a folder: name one file in it {_files_beside(path / 'x')}")
        reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
        _refuse(name, f"cannot be read: {reason}")


def _files_beside(path: Path) -> str:
    suffix = path.suffix or ".toml"
    try:
        found = sorted(other.name for other in path.parent.glob(f"*{escape(suffix)}"))
    except (OSError, ValueError):
        found = []
    return choices(f"{suffix[1:].upper()} files there", found, path.name)


def _too_large(size: int, most: int = LARGEST) -> str:
    return f"has {size / 1e6:.1f} MB: at most {most / 1e6:.0f} MB is read"


def text_of(data: bytes, name: str) -> str:
    """The text of UTF-8 bytes with or without BOM.

    Raises
    ------
    MechanismFileError
        If there are too many bytes, or they are not UTF-8.
    """
    if len(data) > LARGEST:
        _refuse(name, _too_large(len(data)))
    # byte order marks of UTF-16, written by Windows editors
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        _refuse(name, "is UTF-16 text: save it as UTF-8", 1)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        _refuse(
            name,
            f"byte {error.start} (0x{data[error.start]:02x}) is not UTF-8: save the file as UTF-8",
            line,
        )


def data_of(text: str, name: str) -> dict[str, Any]:
    """The data of a TOML text.

    Raises
    ------
    MechanismFileError
        If the text is too long, too deeply nested or not TOML; with line and column.
    """
    if len(text) > LARGEST:
        _refuse(name, _too_large(len(text)))
    text = text.removeprefix("\ufeff").replace("\r\n", "\n")
    if "\0" in text:
        at = text.index("\0")
        _refuse(name, "contains a NUL character: not a text file", text.count("\n", 0, at) + 1)
    if not text.strip():
        _refuse(name, 'is empty: "linkwork examples" lists files to start from', 1)
    _check_limits(Tokens(text), name)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        _refuse(name, *_explained(str(error), text))
    except (ValueError, RecursionError, OverflowError) as error:
        # The limits prevent all known cases; the parser may find others.
        _refuse(name, f"is not TOML: {error}", 1)


def _check_limits(tokens: Tokens, name: str) -> None:
    """Reject text that would need excessive memory or recursion in the parser."""
    depth = parts = 0
    previous: Token | None = None
    for token in tokens.all:
        dotted = previous is not None and previous.kind == "sign" and previous.text == "."
        if token.kind == "sign":
            depth += (token.text in "[{") - (token.text in "]}")
        elif token.kind in ("word", "string"):
            parts = parts + 1 if dotted else 1
            if token.kind == "word" and len(token.text) > _LONGEST_WORD:
                what = (
                    f"a word of {len(token.text)} characters: at most {_LONGEST_WORD} are allowed"
                )
                _refuse(name, what, tokens.line(token.at))
        if depth > _DEEPEST:
            _refuse(name, f"brackets nested deeper than {_DEEPEST} levels", tokens.line(token.at))
        if parts > _MOST_PARTS:
            what = f"a dotted key of more than {_MOST_PARTS} parts"
            _refuse(name, what, tokens.line(token.at))
        previous = token


def _explained(message: str, text: str) -> tuple[str, int]:
    """The parser's message with a hint, and its line."""
    rows = text.split("\n")
    place = _PLACE.search(message)
    what = _PLACE.sub("", message)
    what = what[:1].lower() + what[1:]
    if twice := _TWICE.fullmatch(what):
        what = f"the table [{twice[1].replace(_SEPARATOR, '.')}] occurs twice"
    if place is None or place[1] is None:
        # the parser gives no line for the end of the text: use the last line with content
        line = max((k for k, row in enumerate(rows, 1) if row.strip()), default=1)
        return f"is not TOML: {what} (at the end){_hint(what, rows[line - 1], None)}", line
    line, column = int(place[1]), int(place[2])
    row = rows[line - 1]
    return f"is not TOML: {what} (column {column}){_hint(what, row, column)}", line


def _hint(what: str, row: str, column: int | None) -> str:
    """The remedy; empty if it is uncertain."""
    if what == "cannot overwrite a value":
        return f": {row.split('=')[0].strip()} is given twice"
    if what.startswith("unclosed"):
        return ": a closing bracket or comma is missing before this"
    if what == r"illegal character '\n'":
        return ": the closing quote is missing"
    if column is None or column > len(row):
        return ""
    spaced = re.match(r"\s*([^\s=\"'#\[]+(?: +[^\s=\"'#\[]+)+)\s*=", row)
    if spaced and column <= spaced.end():
        return f': write a name with spaces in quotes: "{spaced[1]}"'
    if what == "invalid value":
        return ": write text, names and formulas in quotes"
    # a decimal comma, as in 1,5
    if row[column - 1] == "," and re.search(r"=\s*[-+]?\d+,\d+\s*(#.*)?$", row):
        return ": write decimals with a point"
    if unit := re.search(r"=\s*[-+]?[\d.]+\s*(mm|cm|dm|m|km|in|inch|ft|deg|rad)\s*(#.*)?$", row):
        key = "angle" if unit[1] in ("deg", "rad") else "length"
        return f': write numbers without a unit; {key} = "{unit[1]}" sets the unit'
    if row[column - 1] == "°":
        return ': write numbers without a unit; angle = "deg" sets the unit'
    word = next((w.group() for w in _NOT_QUOTED.finditer(row) if w.end() >= column), "")
    if "=" in row[: column - 1] and "{" not in row:
        return ": write text, names and formulas in quotes"
    if row[column - 1].isascii() or not word:
        return ""
    spelled = canonical(word)
    other = f", or write {spelled}" if spelled.isascii() and spelled.isidentifier() else ""
    return f': TOML needs quotes around names that are not ASCII: "{word}"{other}'
