"""Commands are typed in a folder with the usual files."""

from tests.core.commands.conftest import environment, folder, run, start

__all__ = ["environment", "folder", "run", "start"]
