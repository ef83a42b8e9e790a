"""The motions of many designs over one table of inputs, as arrays."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.batch.designs import Designs
from linkwork.batch.lane_rows import DesignRows, message_alone
from linkwork.batch.quantity_values import QuantityValues
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray, StatusArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.errors import MissingPackageError
from linkwork.foundation.status import Status

__all__ = ["FamilyMotion"]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class FamilyMotion:
    """Positions of D designs at R input values.

    Parameters
    ----------
    designs : Designs
    inputs : (R, p)
        What was asked, everyday units.
    rows : DesignRows
        Unknowns, statuses and proofs, internal units.
    """

    designs: Designs
    inputs: Array
    rows: DesignRows

    def __len__(self) -> int:
        return len(self.designs)

    def __repr__(self) -> str:
        told = ", ".join(f"{n} {status.name}" for status, n in self.counts.items())
        return (
            f'<FamilyMotion of "{self.designs.base.description.name}": {len(self)} designs × '
            f"{len(self.inputs)} inputs; {told}>"
        )

    @cached_property
    def _values(self) -> QuantityValues:
        return QuantityValues(self.designs, self.inputs, self.rows.v)

    def __getitem__(self, name: str) -> Array:
        """Values of a quantity by name, (D, R), everyday units; NaN where there is no position.

        Names are those of a :class:`~linkwork.results.motion.Motion`: ``family["B.x"]``.

        Raises
        ------
        UnknownNameError
            With the names that exist.
        """
        return self._values.of(name)

    def trace(self, point: str) -> ComplexArray:
        """The path of a point as x + iy, (D, R)."""
        return self._values.trace(point)

    @property
    def dimensions(self) -> Mapping[str, Array]:
        """What varies from design to design, (D,) each, everyday units."""
        return self.designs.dimensions

    @property
    def status(self) -> StatusArray:
        """Codes, (D, R); see :meth:`linkwork.Status.of_code`."""
        return self.rows.status.T

    @property
    def found(self) -> BoolArray:
        """Which rows hold a position, (D, R)."""
        found: BoolArray = np.isin(self.rows.status.T, Status.CONVERGED.code)
        return found

    @property
    def certification(self) -> StatusArray:
        """Codes, (D, R)."""
        return self.rows.certification.T

    @property
    def certified(self) -> BoolArray:
        """Which rows are proved, (D, R)."""
        proved: BoolArray = np.isin(self.rows.certification.T, Certification.CERTIFIED.code)
        return proved

    @property
    def radius(self) -> Array:
        """Within this a true position lies, (D, R), weighted; NaN where nothing is proved."""
        return self.rows.radius.T

    @property
    def counts(self) -> Counter[Status]:
        """How many rows ended in which status."""
        codes, numbers = np.unique(self.rows.status, return_counts=True)
        pairs = zip(codes.tolist(), numbers.tolist(), strict=True)
        return Counter({Status.of_code(code): number for code, number in pairs})

    def message(self, k: int) -> str:
        """Why rows of the k-th design have no position: what the design says by itself; "" if all
        were found.
        """
        if self.found[k].all():
            return ""
        return self.designs.message(k) or message_alone(self.designs, k)

    def to_xarray(self, *names: str) -> Any:
        """An xarray Dataset over designs and inputs, with units.

        Parameters
        ----------
        names : str
            Quantities; all of them if none is named.
        """
        try:
            import xarray
        except ImportError:
            raise MissingPackageError(
                'labelled arrays need xarray: pip install "linkwork[tables]"'
            ) from None
        model = self.designs.base
        lead = model.equations.inputs[0].name
        axes = ("design", lead)
        inputs = {v.name for v in model.equations.inputs}
        data: dict[str, tuple[Any, Any, dict[str, str]]] = {
            name: (axes, self[name], {"units": self._values.unit(name)})
            for name in (names or self._values.names())
            if name not in inputs
        }
        data["status"] = (axes, self.status, {"meaning": _codes(Status)})
        data["certified"] = (axes, self.certified, {})
        data |= {name: ("design", values, {}) for name, values in self.dimensions.items()}
        units = {"units": model.input_units[lead]}
        return xarray.Dataset(data, coords={lead: (lead, self.inputs[:, 0], units)})


def _codes(kind: type[Status]) -> str:
    return ", ".join(f"{member.code} {member.name}" for member in kind)
