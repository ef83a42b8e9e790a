"""Loop-closure equations: derived from a mechanism or read from a file, displayed, compiled."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.core.equations.model import LoopEquations as LoopEquations
    from linkwork.core.equations.writing import EquationSheet as EquationSheet
else:
    __getattr__ = loader(__name__)
