"""The motions of many designs over one table of inputs, as arrays."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, StatusArray
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices, internal
from linkwork.core.foundation.loading import installed_with
from linkwork.core.foundation.names import find_spelling
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.motion.model import leading_input
from linkwork.core.results.quantities.definition import Asked, AskedOfMotion, Group
from linkwork.core.results.quantities.registry import Quantities
from linkwork.core.results.quantity import Rate
from linkwork.core.results.tables import Series
from linkwork.families.building import Designs
from linkwork.families.design_sweep import DesignRows, FamilyLimits, message_single
from linkwork.families.located import closer_rows, located_number
from linkwork.families.values import (
    DesignRates,
    DesignValues,
    design_efforts,
    design_evidence,
    design_rates,
    design_speeds,
)

_MOST_BYTES = 4 << 30  # limit for labelled arrays requested without names
_EVIDENCE = ("residual", "condition", "radius")  # names of the evidence of rows
_NEAR = 1 << 16  # positions whose rates are computed at a time: temporaries fit into the cache


@internal(
    "designs",
    "rows",
    "quantities",
    "quantity",
    "leading",
    "threads",
    "unit",
    "number",
)
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class FamilyMotion:
    """Positions of D designs at R input values.

    Parameters
    ----------
    designs : Designs
    inputs : (R, p)
        Requested inputs, in file units.
    rows : DesignRows
        Unknowns, statuses and proofs, internal units.
    threads : int
        Number of cores that compute rates, at their first request.

    Examples
    --------
    >>> import linkwork as lw
    >>> motion = lw.example("four-bar").family({"O2 A": [38, 40, 42]}).sweep()
    >>> motion["rocker"].max(axis=1).round(3)  # of each design
    array([127.211, 128.682, 130.147])
    >>> bool(motion.found.all())
    True
    """

    designs: Designs
    inputs: Array
    rows: DesignRows
    threads: int = 1

    def __len__(self) -> int:
        return len(self.designs)

    def __repr__(self) -> str:
        told = ", ".join(f"{n} {status.name}" for status, n in self.counts.items())
        return (
            f'<FamilyMotion of "{self.designs.base.description.name}": {len(self)} designs × '
            f"{len(self.inputs)} inputs; {told}>"
        )

    @cached_property
    def _values(self) -> DesignValues:
        return DesignValues(self.designs, self.inputs, self.rows.v, self.rows.turns)

    @cached_property
    def _rates(self) -> DesignRates:
        return design_rates(self.designs, self.rows, self.threads)

    def _moving(self) -> Iterator[tuple[slice, DesignValues]]:
        """Quantities with rates, some designs at a time for the processor's cache."""
        # temporaries of all designs at once would leave the cache
        step = max(1, _NEAR // max(1, len(self.inputs)))
        for begin in range(0, len(self), step):
            part = slice(begin, begin + step)
            yield part, self._moving_part(part)

    def _moving_part(self, part: slice) -> DesignValues:
        """Quantities with rates of some designs."""
        v, turns = self.rows.v[:, :, part], self.rows.turns[:, part]
        own, rates = self.designs.take(part), self._rates.take(part)
        return DesignValues(own, self.inputs, v, turns, rates)

    @cached_property
    def _evidence(self) -> tuple[Array, Array]:
        return design_evidence(self.designs, self.rows, self.threads)

    @property
    def leading(self) -> Array:
        """The leading input, (R,) [rad] or [length]."""
        rows = self.designs.base.rows
        return rows[:, leading_input(rows)[0]]

    @property
    def quantities(self) -> Quantities:
        """All quantities by name."""
        return self.designs.base.quantities

    def quantity(self, name: str) -> Asked:
        """A quantity by name, checked before any computation.

        Raises
        ------
        UnknownNameError
            Lists the nearest names.
        """
        asked = self.quantities.find(name)
        if asked.group is Group.EVIDENCE and asked.name not in _EVIDENCE:
            raise UnknownNameError(
                f'families have no "{name}" {choices("evidence", _EVIDENCE, name)}'
            )
        asked.check_rate(self.speed if asked.rate and asked.rate.by_time else None)
        return asked

    def __getitem__(self, name: str) -> Array:
        """Values of a quantity by name, (D, R), file units; NaN where there is no position.

        Names are those of a :class:`~linkwork.core.results.motion.Motion`: ``family["B.x"]``, and
        of its rates ``family["B.x.d1"]``, ``family["B.x.velocity"]`` (angles in radians), which are
        NaN at dead points. ``condition``, ``residual`` and ``radius`` are available as in its
        table.

        Raises
        ------
        UnknownNameError
            Lists the nearest names.
        """
        asked = self.quantity(name)
        if asked.group is Group.EVIDENCE:
            evidence: Array = getattr(self, asked.name)
            return evidence
        if asked.group is Group.INPUT and asked.rate is None:
            # inputs are the same for all designs, and keep the unit of the file
            column = self.inputs[:, list(self.quantities.names.inputs).index(asked.name)]
            return np.broadcast_to(column, self.status.shape)
        if not asked.needs:
            return asked.values(self._values, None).T
        efforts = self._efforts(asked)
        if efforts is not None:
            return efforts
        found = np.empty(self.status.shape)
        for part, values in self._moving():
            speed = None if self.speed is None else self.speed[part]
            found[part] = asked.values(values, speed).T
        return found

    def _efforts(self, asked: Asked) -> Array | None:
        """The effort of the input, (D, R), if one program computes it for all designs."""
        if asked.group is not Group.DERIVED or asked.rate is not None:
            return None
        together = design_efforts(self.designs, self.rows, asked.name, self.threads)
        if together is None:
            return None
        found = together.T
        for k in self.rows.own:
            found[k] = asked.values(self._moving_part(slice(k, k + 1)), None)[:, 0]
        return found

    def series(self, name: str) -> Series:
        """A quantity with both derivatives with respect to the leading input, (D, R) each.

        Raises
        ------
        UnknownNameError
            Lists the nearest names.
        """
        asked = self.quantity(name)
        value, first, second = (np.empty(self.status.shape) for _ in range(3))
        for part, values in self._moving():
            jet = asked.jet(values)
            value[part], first[part], second[part] = jet.v.T, jet.d1.T, jet.d2.T
        return Series(quantity=asked.own, value=value, first=first, second=second)

    def value(self, name: str) -> Array:
        """A number of the whole motion of every design, (D,): ``family.value("stroke(s16)")``.

        Raises
        ------
        InputError, UnknownNameError
            If the name does not exist.
        """
        asked = self.quantities.find_of_motion(name)
        if not asked.follows:
            return self.number(asked, self[asked.of.name])
        found = np.empty(len(self))
        for part, values in self._moving():
            columns = (column.T for column in asked.columns(values))
            found[part] = asked.evaluate(self.leading, *columns)
        return found

    def number(self, asked: AskedOfMotion, value: Array) -> Array:
        """A number (D,) that follows from the values of a quantity (D, R) alone; extremes are
        located between the rows.
        """
        own = self._closer if asked.quantity.sides else self
        value = value if own.rows is self.rows else own[asked.of.name]
        return located_number(own.designs, own.rows, asked, value, self.threads)

    @cached_property
    def _closer(self) -> FamilyMotion:
        """The motions at rows so close that they show all extremes."""
        designs, rows = closer_rows(self.designs, self.rows, self.threads)
        return replace(self, designs=designs, inputs=designs.base.rows_in_file_units, rows=rows)

    def trace(self, point: str) -> ComplexArray:
        """The path of a point as x + iy, (D, R); ``trace("B.velocity")`` is its velocity."""
        own, rate = Rate.split(point)
        points = self.quantities.names.points
        own = find_spelling(own, points)
        if own not in points:
            raise UnknownNameError(f'there is no point "{own}" {choices("points", points, own)}')
        if rate is None:
            return self._values.place(own).v.T
        return self[f"{own}.x.{rate.value}"] + 1j * self[f"{own}.y.{rate.value}"]

    @cached_property
    def speed(self) -> Array | None:
        """The speed of every design's first input, (D,) [rad/s or length/s]; ``None`` without."""
        return design_speeds(self.designs)

    @property
    def condition(self) -> Array:
        """Condition number of the equations at every position, (D, R); see
        :class:`~linkwork.core.results.motion.Motion`.
        """
        return self._evidence[0].T

    @property
    def residual(self) -> Array:
        """Residual of every position, (D, R), relative to the longest link."""
        return self._evidence[1].T

    @cached_property
    def limits(self) -> FamilyLimits:
        """The range of inputs of every design, on the branch of its start."""
        model = self.designs.base
        unit = float(model.input_scale[leading_input(model.rows)[0]])
        return FamilyLimits.of(self.rows.limits, self.rows.limit_kinds, unit)

    @property
    def dimensions(self) -> Mapping[str, Array]:
        """The varied numbers, (D,) each, in file units."""
        return self.designs.dimensions

    @property
    def status(self) -> StatusArray:
        """Codes, (D, R); see :meth:`linkwork.Status.of_code`."""
        return self.rows.status.T

    @property
    def found(self) -> BoolArray:
        """Whether a row has a position, (D, R)."""
        return np.asarray(np.isin(self.rows.status.T, Status.CONVERGED.code))

    @property
    def certification(self) -> StatusArray:
        """Codes, (D, R)."""
        return self.rows.certification.T

    @property
    def certified(self) -> BoolArray:
        """Whether a row is proved, (D, R)."""
        proved: BoolArray = np.isin(self.rows.certification.T, Certification.CERTIFIED.code)
        return proved

    @property
    def radius(self) -> Array:
        """Radius within which a true position is proved, (D, R), weighted; NaN without a proof."""
        radius = self.rows.radius
        return radius.T if len(radius) else np.full(self.status.shape, np.nan)

    @property
    def counts(self) -> Counter[Status]:
        """Number of rows by status."""
        codes, numbers = np.unique(self.rows.status, return_counts=True)
        pairs = zip(codes.tolist(), numbers.tolist(), strict=True)
        return Counter({Status.of_code(code): number for code, number in pairs})

    def message(self, k: int) -> str:
        """Why rows of the k-th design have no position, as for the design alone; "" if all were
        found.
        """
        if self.found[k].all():
            return ""
        return self.designs.message(k) or message_single(self.designs, k)

    def to_xarray(self, *names: str) -> Any:
        """An xarray Dataset over designs and inputs, with units.

        Parameters
        ----------
        names : str
            Quantities and rates; all by default.

        Raises
        ------
        UnknownNameError
            Lists the existing names.
        InputError
            If the arrays do not fit into memory.
        """
        with installed_with("tables", "labelled arrays need xarray"):
            import xarray
        for name in names:  # before any computation
            self.quantity(name)
        model = self.designs.base
        lead = model.equations.inputs[0].name
        axes = ("design", lead)
        data: dict[str, tuple[Any, Any, dict[str, str]]] = {
            name: (axes, self[name], {"units": self.unit(name)})
            for name in (names or self._all_names())
        }
        data["status"] = (axes, self.status, {"meaning": _codes(Status)})
        data["certified"] = (axes, self.certified, {})
        data["limit.lower"] = ("design", self.limits.lower, {"units": model.input_units[lead]})
        data["limit.upper"] = ("design", self.limits.upper, {"units": model.input_units[lead]})
        data |= {name: ("design", values, {}) for name, values in self.dimensions.items()}
        units = {"units": model.input_units[lead]}
        return xarray.Dataset(data, coords={lead: (lead, self.inputs[:, 0], units)})

    def _all_names(self) -> list[str]:
        """All quantities but inputs, then their rates."""
        model = self.designs.base
        inputs = model.quantities.names.inputs
        own = [name for name in model.quantities.own if name not in inputs]
        known = (rate for rate in Rate if not rate.needs_series)
        asked = [rate for rate in known if not (rate.by_time and self.speed is None)]
        names = [*own, *(f"{name}.{rate.value}" for rate in asked for name in own)]
        names += [name for name in _EVIDENCE[:2] if name not in own]
        needed = 8 * len(names) * self.status.size
        if needed > _MOST_BYTES:
            raise InputError(
                f"{len(names)} quantities and rates of {len(self)} designs take "
                f"{needed / 2**30:.0f} GiB: name those you need"
            )
        return names

    def unit(self, name: str) -> str:
        """The unit of a quantity or rate, or ""."""
        return self.quantities.find(name).unit


def _codes(kind: type[Status]) -> str:
    return ", ".join(f"{member.code} {member.name}" for member in kind)
