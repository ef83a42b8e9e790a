"""The command ``linkwork fastest``."""

from __future__ import annotations

import click

import linkwork as lw


@click.command("fastest")
@click.argument("file")
@click.argument("point")
def fastest_command(file: str, point: str) -> None:
    """Show where a point moves fastest."""
    mechanism = lw.example(file) if file in lw.examples() else lw.load(file)
    motion = mechanism.sweep()
    speed = motion[f"{point}.speed"]
    row = int(speed.argmax())
    click.echo(f"{point} moves {speed[row]:.4g} per radian at row {row} of {len(motion)}")
