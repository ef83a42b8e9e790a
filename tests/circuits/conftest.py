"""The drawn four-bar, for sheets of configurations."""

from tests.core.drawing.conftest import four_bar

__all__ = ["four_bar"]
