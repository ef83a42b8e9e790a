"""A file of the visitor, opened as a new one: of Linkwork, or imported from another program."""

from __future__ import annotations

import base64
import binascii
import re
from dataclasses import dataclass
from pathlib import PurePosixPath, PureWindowsPath

from linkwork.exchange.formats import FORMATS, read_foreign
from linkwork.foundation.errors import InputError, MechanismFileError, Problem
from linkwork.textfile.toml_text import data_of, text_of
from linkwork.textfile.writer import write_text
from linkwork.viewer.live import events as tell
from linkwork.viewer.live.file_requests import OpenFile
from linkwork.viewer.live.mechanism_file import MechanismFile, new_file

__all__ = ["VisitorFile", "read_visitor_file"]

_NOT_OF_NAMES = re.compile(r"[^\w .+-]")
_LONGEST_STEM = 80  # characters
_SUFFIX = ".toml"


@dataclass(frozen=True, kw_only=True)
class VisitorFile:
    """The text to open, under a name that no file has, and what the visitor is told about it."""

    file: MechanismFile
    opened: tell.FileOpened


def read_visitor_file(request: OpenFile) -> VisitorFile:
    """A mechanism or task from the bytes of a file; nothing in it is executed.

    Raises
    ------
    MechanismFileError
        With the reason why it is not read, and its place.
    InputError
        If the message does not contain bytes.
    """
    name = PurePosixPath(PureWindowsPath(request.name).name).name
    try:
        data = base64.b64decode(request.content, validate=True)
    except (binascii.Error, ValueError):
        raise InputError(f'"{name}" has not arrived as base64: open it again') from None
    stem = _NOT_OF_NAMES.sub("-", PurePosixPath(name).stem).strip(" .")[:_LONGEST_STEM]
    if name.lower().endswith(_SUFFIX):
        text = text_of(data, name)
        if "format" not in data_of(text, name):
            told = "is not a file of Linkwork: these begin with format = 1"
            raise MechanismFileError([Problem(key=(), message=told)], name)
        opened = tell.FileOpened(source=name, format="", carried={}, renamed={}, left_out=())
    else:
        reading = read_foreign(data, name)
        text = write_text(reading.linkage)
        opened = tell.FileOpened(
            source=name,
            format=str(FORMATS[reading.format].TITLE),
            carried=reading.carried,
            renamed=dict(reading.renamed),
            left_out=tuple(map(str, reading.left_out)),
        )
    return VisitorFile(file=new_file(stem or "opened", text), opened=opened)
