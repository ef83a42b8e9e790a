"""Output files: written completely or not at all, and never over the mechanism file."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

import click

from linkwork.export import csv_lines
from linkwork.foundation.errors import InputError
from linkwork.foundation.written_file import save_pieces
from linkwork.results.table import Table

__all__ = ["check_outputs", "write_bytes", "write_table", "write_text"]


def check_outputs(
    source: str, *outputs: str | None, workbook: str | None = None, as_json: bool = False
) -> None:
    """Reject files that cannot be written, before any computation.

    ``as_json``: standard output is taken.

    Raises
    ------
    InputError
        If a folder is missing, two outputs are the same file, an output is the mechanism file
        itself, the suffix belongs to another kind of file, or standard output is taken.
    """
    if as_json and "-" in outputs:
        raise InputError("--json and --csv - both use standard output: name a file for the table")
    if workbook is not None and Path(workbook).suffix.lower() != ".xlsx":
        raise InputError(f'cannot write "{workbook}": a workbook needs the suffix .xlsx')
    taken = {} if source == "-" else {_real(source): f'"{source}" is the mechanism file itself'}
    for name in (*outputs, workbook):
        if name is None or name == "-":
            continue
        path = Path(name)
        if name is not workbook and path.suffix.lower() in (".xlsx", ".xls", ".ods"):
            raise InputError(
                f'cannot write "{name}": tables are CSV files, use the suffix .csv; '
                "linkwork sweep writes workbooks with --xlsx"
            )
        if path.is_dir():
            raise InputError(f'cannot write "{name}": it is a folder')
        if not path.parent.is_dir():
            raise InputError(f'cannot write "{name}": there is no folder "{path.parent}"')
        # links are followed, so that two names of one file are found
        real = _real(name)
        if real in taken:
            raise InputError(f"{taken[real]}: write to another file")
        taken[real] = f'"{name}" is named twice'


def write_table(name: str | None, table: Table) -> list[str]:
    """Write a table as CSV to a file or, for ``-``, to standard output; returns a line about it."""
    if name is None:
        return []
    if name == "-":
        for line in csv_lines(table):
            click.echo(line, nl=False)
        return []
    write_text(name, csv_lines(table))
    return [f"Wrote {name}: {len(next(iter(table.columns.values())))} rows."]


def write_text(name: str, pieces: Iterable[str]) -> None:
    """Write UTF-8 text to a file; follow links, write to devices.

    Raises
    ------
    InputError
        If the file cannot be written; its former content is kept.
    """
    write_bytes(name, (piece.encode() for piece in pieces))


def write_bytes(name: str, pieces: Iterable[bytes]) -> None:
    """Write bytes to a file; follow links, write to devices.

    Raises
    ------
    InputError
        If the file cannot be written; its former content is kept.
    """
    save_pieces(pieces, name)


def _real(name: str) -> str:
    return os.path.realpath(name)
