"""A motion as a notebook widget: the front end of pages, synchronised with Python.

Only this module uses anywidget, and imports it on first use.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import lru_cache
from importlib import resources
from typing import Any

import numpy as np

from linkwork.foundation.errors import choices
from linkwork.foundation.optional_packages import installed_with
from linkwork.results.force import Force
from linkwork.results.motion import Motion
from linkwork.viewer.notebook_html import motion_html
from linkwork.viewer.offline_page import page_json
from linkwork.viewer.page_building import Loops, motion_page

__all__ = ["motion_widget", "motions_widget"]


def motion_widget(motion: Motion) -> Any:
    """One motion; see :meth:`linkwork.results.motion.Motion.widget`."""
    return motions_widget({"motion": motion})


def motions_widget(
    motions: Mapping[str, Motion],
    *,
    equations: Sequence[tuple[str, str]] = (),
    loops: Loops | None = None,
    forces: Sequence[Force] = (),
) -> Any:
    """A widget that plays motions of one mechanism; its user selects, plays and drags them.

    Parameters
    ----------
    motions : Mapping[str, Motion]
        By the name of the circuit or configuration, in the order of the widget. Motions without
        any position are left out.
    equations : sequence of (str, str)
        Labels and MathML of the loop equations.
    loops : callable, optional
        See :func:`~linkwork.viewer.page_building.motion_page`.
    forces : sequence of Force
        Drawn as arrows.

    Returns
    -------
    anywidget.AnyWidget
        Its traits ``configuration`` (a name) and ``row`` (the number of a row of that motion, from
        0) follow the actions of the user and can be set.

    Raises
    ------
    InputError
        If there is nothing to draw.
    MissingPackageError
        If anywidget is not installed.
    """
    kind = _widget_class()
    data = motion_page(motions, equations=equations, loops=loops, forces=forces)
    page = json.loads(page_json(data))
    rows = {name: np.flatnonzero(m.found) for name, m in motions.items() if m.found.any()}
    shown = motions[next(iter(rows))]
    found = {name: frozenset(found.tolist()) for name, found in rows.items()}
    return kind(page, found, motion_html(shown))


@lru_cache
def _widget_class() -> Any:
    """The class of the widget, created at its first use, when anywidget is imported."""
    with installed_with("notebook", "widgets need anywidget"):
        import anywidget
        import traitlets
    script = resources.files("linkwork.viewer") / "static" / "widget.js"

    # No types from here on: the type checker may run without anywidget and traitlets.
    class MotionWidget(anywidget.AnyWidget):  # type: ignore[misc]
        """The displayed row and motion; rejects rows and names that do not exist."""

        _esm = script.read_text(encoding="utf-8")
        page = traitlets.Dict().tag(sync=True)
        configuration = traitlets.Unicode().tag(sync=True)
        row = traitlets.Int().tag(sync=True)

        def __init__(
            self, page: dict[str, Any], rows: Mapping[str, frozenset[int]], picture: str
        ) -> None:
            self._rows, self._picture = rows, picture
            first = next(iter(rows))
            super().__init__(page=page, configuration=first, row=min(rows[first]))

        def _repr_mimebundle_(self, **kwargs: Any) -> Any:
            """The widget, and a picture for exported notebooks, which have no widgets."""
            data, *rest = super()._repr_mimebundle_(**kwargs)
            return ({**data, "text/html": self._picture}, *rest)

        @traitlets.validate("configuration")  # type: ignore[untyped-decorator]
        def _known(self, proposal: Any) -> str:
            name: str = proposal["value"]
            if name not in self._rows:
                raise traitlets.TraitError(
                    f'there is no configuration "{name}" '
                    f"{choices('configurations', self._rows, name)}"
                )
            return name

        @traitlets.validate("row")  # type: ignore[untyped-decorator]
        def _found(self, proposal: Any) -> int:
            row: int = proposal["value"]
            if row not in self._rows[self.configuration]:
                rows = self._rows[self.configuration]
                raise traitlets.TraitError(
                    f'row {row} of "{self.configuration}" has no position to show: '
                    f"{len(rows)} rows from {min(rows)} to {max(rows)} were found"
                )
            return row

        @traitlets.observe("configuration")  # type: ignore[untyped-decorator]
        def _moved(self, change: Any) -> None:
            """The same row if it has a position, otherwise the nearest row with a position."""
            there = self._rows[change["new"]]
            if self.row not in there:
                self.row = min(there, key=lambda row: (abs(row - self.row), row))

    return MotionWidget
