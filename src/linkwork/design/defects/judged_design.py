"""One design of a synthesis with the verdict on it, whatever its kind."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.design.defects.defect_messages import Defect
from linkwork.design.defects.verdicts import DefectKind
from linkwork.design.tasks.task import Task
from linkwork.foundation.internal import internal
from linkwork.mechanism.description import Description
from linkwork.results.quantities.transmission import TRANSMISSION_ANGLE

__all__ = ["JudgedDesign"]


@internal("linkage", "kinds", "task")
@dataclass(frozen=True, kw_only=True, eq=False)
class JudgedDesign(ABC):
    """A mechanism for a task, and what keeps it from doing it.

    Parameters
    ----------
    task : Task
    number : int
        Its rank among the sound designs from 1, or its place among the refused ones.
    delivered : bool
        Whether it is sound and among the wanted number of designs.
    score : float
        The weighted score of the ranking, 0 to 1.

    Examples
    --------
    >>> import linkwork as lw
    >>> task = lw.Task.function("log10(x)", x=(1, 2), input=(45, 105), output=(0, 90))
    >>> design = task.solve().delivered[0]
    >>> isinstance(design, lw.JudgedDesign), design.number, design.driven
    (True, 1, 'A0')
    """

    task: Task
    number: int = 0
    delivered: bool = False
    score: float = np.nan

    @property
    @abstractmethod
    def mechanism(self) -> str:
        """The kind of mechanism, or the mechanism that was improved as the task names it."""

    @property
    @abstractmethod
    def driven(self) -> str:
        """The driven link in words, or the leading input."""

    @property
    @abstractmethod
    def numbers(self) -> dict[str, float]:
        """The numbers that vary [file units]; none where all of them are found."""

    @property
    def goals(self) -> dict[str, float]:
        """The misses of goals [file units]; none where positions are met, or miss by the error."""
        return {}

    @property
    @abstractmethod
    def points(self) -> dict[str, complex]:
        """The points at the first position [length]."""

    @property
    @abstractmethod
    def inputs(self) -> tuple[float, ...]:
        """The inputs at the positions [file units]."""

    @property
    @abstractmethod
    def first_input(self) -> float:
        """The input at the first position [file units]."""

    @property
    @abstractmethod
    def linkage(self) -> Description:
        """The mechanism, with the name of its design."""

    @property
    @abstractmethod
    def transmission(self) -> float:
        """The least transmission angle over the driven range, or a lower bound of it; NaN where
        that is not defined [file's angle unit].
        """

    @property
    @abstractmethod
    def size(self) -> float:
        """The longest link, or the largest distance of fixed pivots [length]."""

    @property
    @abstractmethod
    def shortest(self) -> float:
        """The shortest link, or distance of fixed pivots [length]."""

    @property
    @abstractmethod
    def error(self) -> float:
        """How far positions are missed, the largest distance; or the structural error."""

    @property
    @abstractmethod
    def error_unit(self) -> str:
        """The unit of the error."""

    @property
    @abstractmethod
    def kinds(self) -> tuple[DefectKind, ...]:
        """The kinds of its defects; none for a sound design."""

    @property
    @abstractmethod
    def defects(self) -> tuple[Defect, ...]:
        """Its defects in words; none for a sound design."""

    @property
    def _name(self) -> str:
        refused = ", refused" if self.kinds else ""
        return f"{self.task.name}, design {self.number}{refused}"

    def _details(self) -> Mapping[str, Any]:
        """Further plain data of a kind of designs."""
        return {}

    def to_dict(self, file: str | None = None) -> dict[str, Any]:
        """Plain data, as in the command line's JSON."""
        return {
            "file": file,
            "mechanism": self.mechanism,
            "points": {name: [z.real, z.imag] for name, z in self.points.items()},
            "drive": self.driven,
            "inputs": list(self.inputs),
            "delivered": self.delivered,
            TRANSMISSION_ANGLE.word: self.transmission,
            "size": self.size,
            "shortest": self.shortest,
            "error": self.error,
            "score": self.score,
            **self._details(),
            "defects": [
                {
                    "kind": defect.kind.name.lower(),
                    "between": None if defect.between is None else list(defect.between),
                    "message": defect.message,
                }
                for defect in self.defects
            ],
        }
