"""Files to begin with."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from pathlib import Path

import click

from linkwork import wings
from linkwork.core.commands.options import check_outputs, text_to_copy, write_text
from linkwork.core.commands.terminal import (
    debug_option,
    fields,
    json_option,
    print_json,
    print_lines,
    title_lines,
)
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import save_text
from linkwork.core.textfile.keys import schema_of, schema_text
from linkwork.core.textfile.reader import blank_sheet, examples as example_names

# ----------------------------------------------------------------------
# ``linkwork examples``


_NO_FAMILY = "other"


def _tasks() -> tuple[str, ...]:
    """The names of tasks to begin with."""
    return wings.use("synthesis.tasks.templates").template_names()


@click.command("examples")
@click.argument("name", required=False)
@click.option("-o", "--output", metavar="PATH", help="Write to this file.")
@click.option("--force", is_flag=True, help="Overwrite the file if it exists.")
@json_option
@debug_option
def examples_command(name: str | None, output: str | None, force: bool, as_json: bool) -> None:
    """List the mechanisms of the library and tasks, or copy one.

    \b
      linkwork examples
      linkwork examples rapier-drive
      linkwork examples rapier-drive -o rapier.toml
    """
    if name is None:
        if output is not None:
            raise InputError("-o needs the name of an example: linkwork examples NAME -o PATH")
        if as_json:
            print_json(
                {
                    "examples": _entries(example_names()),
                    "tasks": _entries(_tasks()),
                }
            )
        else:
            print_lines(_listing())
        return
    text = text_to_copy(name)
    if as_json and output is None:
        print_json({"name": name, "text": text})
        return
    if output is None or output == "-":
        click.echo(text, nl=False)
        return
    check_outputs("-", output)
    if Path(output).exists() and not force:
        raise InputError(f'"{output}" exists already: choose another name, or add --force')
    write_text(output, [text])
    if as_json:
        print_json({"written": [output]})
    else:
        command = "synthesize" if name in _tasks() else "sweep"
        print_lines([f"Wrote {output}. Next: linkwork {command} {output}"])


def _entries(names: Iterable[str]) -> list[dict[str, str]]:
    """Name, title and family of files."""
    found = []
    for name in names:
        data = tomllib.loads(text_to_copy(name))
        title, family = str(data.get("name", "")), str(data.get("family", _NO_FAMILY))
        found.append({"name": name, "title": title, "family": family})
    return found


def _listing() -> list[str]:
    """Name and title of every example, by family, and of every task."""
    titles: dict[str, dict[str, str]] = {}
    for entry in _entries(example_names()):
        titles.setdefault(entry["family"], {})[entry["name"]] = entry["title"]
    lines: list[str] = []
    for family in sorted(titles, key=lambda family: (family == _NO_FAMILY, family.casefold())):
        lines += [*title_lines(family), *fields(titles[family].items()), ""]
    tasks = [(entry["name"], entry["title"]) for entry in _entries(_tasks())]
    lines += [*title_lines("Tasks, for linkwork synthesize"), *fields(tasks), ""]
    return [*lines, "To copy an example: linkwork examples NAME -o FILE.toml"]


# ----------------------------------------------------------------------
# ``linkwork new``


@click.command("new")
@click.argument("name")
@click.option(
    "--from",
    "model",
    metavar="EXAMPLE",
    help='A mechanism or a task to begin with: "linkwork examples" lists them.',
)
@json_option
@debug_option
def new_command(name: str, model: str | None, as_json: bool) -> None:
    """Write a new file of a mechanism or a task.

    \b
      linkwork new press                        (a blank sheet, press.toml)
      linkwork new press --from toggle-press    (a copy with that name)
      linkwork new tipper --from three-poses    (a task: linkwork synthesize)

    "linkwork view press.toml" opens it to draw on. Existing files are never
    overwritten.
    """
    path = Path(name)
    if path.name in ("", ".."):
        raise InputError(
            f'"{name}" is not the name of a file: write one, as in "linkwork new press"'
        )
    path = path if path.suffix else path.with_suffix(".toml")
    text = blank_sheet(path.stem) if model is None else _named(text_to_copy(model), path.stem)
    if path.exists():
        raise InputError(f'"{path}" exists already: choose another name, or open it')
    save_text(text, path)
    if as_json:
        print_json({"file": str(path)})
    else:
        click.echo(f"{path} was written. To draw on it: linkwork view {path}")


def _named(text: str, name: str) -> str:
    """A file's text under another name."""
    title = blank_sheet(name).splitlines()[1]
    return re.sub(r"(?m)^name\s*=.*$", lambda _: title, text, count=1)


# ----------------------------------------------------------------------
# ``linkwork schema``


@click.command("schema")
@click.option("--plan", is_flag=True, help="Print the schema of study plans instead.")
@click.option("--task", is_flag=True, help="Print the schema of task files instead.")
@click.option("--json", is_flag=True, expose_value=False, help="Print JSON, as without it.")
@debug_option
def schema_command(plan: bool, task: bool) -> None:
    """Print the JSON Schema of mechanism files.

    With it, editors complete keys and mark errors while you type.

    \b
      linkwork schema > linkwork.schema.json
      linkwork schema --plan > plan.schema.json
      linkwork schema --task > task.schema.json
    """
    if plan and task:
        raise InputError("--plan and --task are two schemas: ask for one")
    plans, tasks = "families.study.plan", "synthesis.tasks.task_keys"
    form = wings.use(plans).PLAN if plan else wings.use(tasks).TASK if task else None
    click.echo(schema_text(schema_of(form) if form else None), nl=False)
