"""``linkwork atlas``"""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path

import click

from linkwork.api.path_atlas import NearPath, PathAtlas
from linkwork.cli.options import debug_option, json_option
from linkwork.cli.output_file import check_outputs
from linkwork.cli.terminal import print_json, print_lines, progress, title_lines, wrapped
from linkwork.cli.text_table import table_lines
from linkwork.design.tasks.curve_file import read_curve
from linkwork.foundation.errors import InputError, MechanismError, MechanismFileError
from linkwork.foundation.own_files import OwnFiles
from linkwork.foundation.paths import as_path
from linkwork.results.listing.column import Column
from linkwork.results.listing.number_text import significant
from linkwork.textfile.writer import save

__all__ = ["atlas"]

_SHOWN = 20
_OWN = OwnFiles(run="search", files=re.compile(r"near-\d+\.toml", re.IGNORECASE))


@click.command
@click.argument("sources", metavar="CURVE", nargs=-1)
@click.option("-o", "--output", metavar="PATH", help="Folder for mechanisms; with --index a file.")
@click.option("--atlas", "file", metavar="FILE", help="Another atlas than the shipped one.")
@click.option("--count", type=int, help="Mechanisms to find. Default: 100.")
@click.option("--force", is_flag=True, help="Replace the files of an earlier search.")
@click.option("--index", is_flag=True, help="Make an atlas of the stores of studies.")
@json_option
@debug_option
def atlas(
    sources: tuple[str, ...],
    output: str | None,
    file: str | None,
    count: int | None,
    force: bool,
    index: bool,
    as_json: bool,
) -> None:
    """Find mechanisms whose paths resemble a closed curve (CSV: x, y).

    Place, size, direction and timing do not count. With -o the mechanisms are
    written as files, placed on the curve: starts for improvement. An atlas is
    made of studies that keep the path of a point over a whole turn.

    \b
      linkwork atlas curve.csv
      linkwork atlas curve.csv --count 20 -o near
      linkwork atlas --index four-bar.zarr stephenson.zarr -o mine.npz
      linkwork atlas curve.csv --atlas mine.npz
    """
    if index:
        if force or (file, count) != (None, None):
            raise InputError("--index makes an atlas: leave out --atlas, --count and --force")
        _index(sources, output, as_json)
        return
    if len(sources) != 1:
        raise InputError("give one curve:\n    linkwork atlas curve.csv")
    try:
        curve = read_curve({"file": sources[0]}, None)
    except MechanismFileError:
        raise
    except MechanismError as error:  # there is no task that names the file
        raise InputError(error.problems[0].message) from None
    earlier = () if output is None else _OWN.check(as_path(output), force)
    with progress("comparing paths"):
        asked = PathAtlas.shipped() if file is None else PathAtlas.load(file)
        found = asked.nearest(curve.points, 100 if count is None else count)
    files: list[str] = []
    if output is not None:
        files = _write(found, as_path(output), earlier)
    if as_json:
        print_json({"paths": len(asked), "nearest": [_data(n, files) for n in found]})
        return
    lines = [*title_lines(f"{len(found)} of {len(asked)} paths near {sources[0]}"), *_rows(found)]
    if files:
        lines += ["", *wrapped(f"Wrote {len(files)} mechanisms in {output}.")]
    print_lines(lines)


def _index(stores: tuple[str, ...], output: str | None, as_json: bool) -> None:
    if not stores or output is None:
        raise InputError(
            "--index needs stores and a file:\n    linkwork atlas --index four-bar.zarr -o mine.npz"
        )
    check_outputs("-", output)
    with progress("reading paths") as tell:
        made = PathAtlas.of_stores(stores, tell)
    made.save(output)
    if as_json:
        print_json({"paths": len(made), "file": output, "unfinished": list(made.unfinished)})
        return
    count = len({as_path(store).resolve() for store in stores})
    shown = "1 store" if count == 1 else f"{count} stores"
    print_lines(wrapped(f"Wrote {len(made):,} paths of {shown} to {output}."))
    for told in made.unfinished:
        print_lines(wrapped(f"{told}. Finish it and repeat this command for the others."))


def _write(found: tuple[NearPath, ...], folder: Path, earlier: Collection[str]) -> list[str]:
    digits, files = len(str(len(found))), []
    with progress("writing mechanisms") as tell, _OWN.written(folder, earlier) as part:
        for near in found:
            name = f"near-{near.number:0{digits}}.toml"
            save(near.mechanism.description, part / name)
            files.append(str(folder / name))
            tell(near.number / len(found))
    return files


def _data(near: NearPath, files: list[str]) -> dict[str, object]:
    return {
        "distance": near.distance,
        "mechanism": near.family,
        "mirrored": near.is_mirrored,
        "numbers": near.numbers,
        "file": files[near.number - 1] if files else None,
    }


def _rows(found: tuple[NearPath, ...]) -> list[str]:
    """The nearest ones."""
    shown = found[:_SHOWN]
    lines = table_lines(
        [
            Column(header="", cells=[str(near.number) for near in shown], align="right"),
            Column(
                header="distance", cells=[significant(n.distance, 3) for n in shown], align="point"
            ),
            Column(header="mechanism", cells=[near.family for near in shown]),
            Column(header="", cells=["mirrored" if n.is_mirrored else "" for n in shown]),
        ]
    )
    more = len(found) - len(shown)
    return lines + (wrapped(f"and {more} more; --json lists all", "  ") if more else [])
