"""``linkwork schema``"""

from __future__ import annotations

import click

from linkwork.cli.options import debug_option
from linkwork.textfile.schema import schema_text

__all__ = ["schema"]


@click.command
@debug_option
def schema() -> None:
    """Print the JSON Schema of mechanism files.

    Editors that know it complete keys and mark mistakes while you type.

    \b
      linkwork schema > linkwork.schema.json
    """
    click.echo(schema_text(), nl=False)
