"""``linkwork schema``"""

from __future__ import annotations

import click

from linkwork.batch.study.plan_keys import PLAN
from linkwork.cli.options import debug_option
from linkwork.design.tasks.task_keys import TASK
from linkwork.foundation.errors import InputError
from linkwork.textfile.schema import schema_of, schema_text

__all__ = ["schema"]


@click.command
@click.option("--plan", is_flag=True, help="Print the schema of study plans instead.")
@click.option("--task", is_flag=True, help="Print the schema of task files instead.")
@click.option("--json", is_flag=True, expose_value=False, help="Print JSON, as without it.")
@debug_option
def schema(plan: bool, task: bool) -> None:
    """Print the JSON Schema of mechanism files.

    With it, editors complete keys and mark errors while you type.

    \b
      linkwork schema > linkwork.schema.json
      linkwork schema --plan > plan.schema.json
      linkwork schema --task > task.schema.json
    """
    if plan and task:
        raise InputError("--plan and --task are two schemas: ask for one")
    form = PLAN if plan else TASK if task else None
    click.echo(schema_text(schema_of(form) if form else None), nl=False)
