"""``linkwork schema``"""

from __future__ import annotations

import click

from linkwork.batch.study.plan_keys import PLAN
from linkwork.cli.options import debug_option
from linkwork.textfile.schema import schema_of, schema_text

__all__ = ["schema"]


@click.command
@click.option("--plan", is_flag=True, help="Print the schema of study plans instead.")
@click.option("--json", is_flag=True, expose_value=False, help="Print JSON, as without it.")
@debug_option
def schema(plan: bool) -> None:
    """Print the JSON Schema of mechanism files.

    With it, editors complete keys and mark errors while you type.

    \b
      linkwork schema > linkwork.schema.json
      linkwork schema --plan > plan.schema.json
    """
    click.echo(schema_text(schema_of(PLAN) if plan else None), nl=False)
