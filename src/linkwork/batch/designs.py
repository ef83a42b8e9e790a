"""A family: many designs of one topology as arrays of coefficients."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Protocol, cast

import numpy as np

from linkwork.batch.building import Builder, build_design, family_base
from linkwork.foundation.arrays import AnyArray, Array, BoolArray, ComplexArray, IndexArray
from linkwork.foundation.errors import InputError, LinkworkError
from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.plain_numbers import as_told
from linkwork.foundation.value_types import check_class
from linkwork.mechanism.description import Description
from linkwork.mechanism.varied_number import VariedNumber, number_named, with_numbers
from linkwork.motion.model import Model

__all__ = ["Designs", "designs_of"]


class _HasModel(Protocol):
    @property
    def model(self) -> Model: ...


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Designs:
    """B designs of one topology as arrays.

    Arrays are in Fortran order: a coefficient of all designs is contiguous in memory. Rows of
    designs with a problem are NaN.

    Parameters
    ----------
    base : Model
        The mechanism itself: structure, blocks, names. Varied numbers keep their terms even if they
        are 0 in the mechanism, such as the offset of a slider.
    dimensions : Mapping[str, (B,)]
        The varied numbers, in file units, by the names given.
    quantities : tuple of VariedNumber
        The corresponding numbers of the description, in the same order.
    loops : (B, T) complex
        Coefficients of ``base.compiled.table.loops``, in the order of its terms, [length].
    linear : (B, R)
        Constants of ``base.compiled.table.linear``, [rad] or [length].
    points : (B, P) complex
        Coefficients of ``base.compiled.points.rows``, [length].
    link_angles : (B, links)
        Constants of ``base.equations.links``, [rad].
    start : (B, N)
        Guess of the unknowns, then its inputs, [rad] or [length].
    numbers : (B, D)
        All named dimensions, in the order of ``base.equations.dimensions``, in file units, for
        outputs and constants of plain equations.
    redundant : (B, r)
        Lengths of ``base.equations.redundant``.
    length_scale : (B,)
        The longest link.
    problem : (B,)
        Index of a design's problem in ``problems``; 0 for none.
    problems : tuple of str
        Distinct problems, the first one empty. Numbers that differ between designs are omitted:
        :meth:`message` contains those of one design.
    """

    base: Model
    dimensions: Mapping[str, Array]
    quantities: tuple[VariedNumber, ...]
    loops: ComplexArray
    linear: Array
    points: ComplexArray
    link_angles: Array
    start: Array
    numbers: Array
    redundant: Array
    length_scale: Array
    problem: IndexArray
    problems: tuple[str, ...] = ("",)

    def __len__(self) -> int:
        return len(self.problem)

    def __repr__(self) -> str:
        bad = int(np.count_nonzero(self.problem))
        varied = ", ".join(self.dimensions)
        return (
            f'<Designs of "{self.base.description.name}": {len(self)} with varied {varied}; '
            f"{bad} with a problem>"
        )

    def take(self, index: Sequence[int] | IndexArray | BoolArray | slice) -> Designs:
        """Some of the designs, in the order of ``index`` (integers, a mask or a slice)."""
        rows: dict[str, AnyArray] = {
            part.name: array[index]
            for part in fields(self)
            if isinstance(array := getattr(self, part.name), np.ndarray)
        }
        dimensions = {name: values[index] for name, values in self.dimensions.items()}
        return replace(self, dimensions=FrozenDict(dimensions), **rows)  # type: ignore[arg-type]

    def description(self, k: int) -> Description:
        """The description of the k-th design.

        Raises
        ------
        MechanismError
            If its description has a problem.
        """
        columns = zip(self.quantities, self.dimensions.values(), strict=True)
        numbers = {quantity: float(values[k]) for quantity, values in columns}
        return with_numbers(self.base.description, numbers)

    def design(self, k: int) -> Model:
        """The compiled model of the k-th design.

        Raises
        ------
        MechanismError
            If it has a problem.
        """
        return build_design(self.description(k))

    def message(self, k: int) -> str:
        """The problem of the k-th design, with its numbers; empty if there is none."""
        if not self.problem[k]:
            return ""
        try:
            self.design(k)
        except (LinkworkError, ArithmeticError) as error:
            return str(error)
        return self.problems[int(self.problem[k])]


def designs_of(mechanism: Model | _HasModel, dimensions: Mapping[str, object]) -> Designs:
    """Designs of a mechanism with some numbers varied.

    Parameters
    ----------
    mechanism : Model, or an object with a model
    dimensions : Mapping[str, number or (B,)]
        The varied numbers, in file units: a name of ``[dimensions]``; an entry of ``[lengths]``
        (``"O2 A"``) or ``[angles]`` (``"B A P"``); a coordinate (``"O4.x"``); the offset of a
        slider (``"s16.offset"``); in loops and plain equations a name of ``[guess]``. A plain
        number holds for all designs.

    Raises
    ------
    UnknownNameError
        If a name is not a number of the mechanism.
    InputError
        If an entry is not a number or array of numbers, or arrays differ in length.

    Notes
    -----
    A design that cannot be built has a problem; no error is raised. The equations equal those of
    the design compiled separately, to rounding. If the mechanism names a configuration, all designs
    start from it: a search for this configuration in every design would take too long.

    Examples
    --------
    >>> import linkwork as lw
    >>> from linkwork.batch import designs_of
    >>> designs = designs_of(lw.example("four-bar"), {"O2 A": [38, 40, -1]})
    >>> designs.problem.tolist(), designs.loops.shape[0]
    ([0, 0, 1], 3)
    """
    found: object = getattr(mechanism, "model", mechanism)
    check_class("the mechanism of a family", found, Model)
    model = cast(Model, found)
    if not isinstance(dimensions, Mapping):
        raise InputError(
            "a family needs a mapping of names and their values, as in "
            f'{{"a2": [40, 50]}}, got {as_told(dimensions)}'
        )
    quantities = tuple(number_named(model.description, name) for name in dimensions)
    _check_different(dict(zip(dimensions, quantities, strict=True)))
    columns = _columns(dimensions)
    base, together = family_base(model, quantities)
    builder = Builder(base, dict(zip(quantities, columns.values(), strict=True)), together)
    builder.run()
    arrays = builder.arrays
    if model.description.configuration:
        # see the notes: all designs start from the configuration of the mechanism
        arrays["start"][builder.problem == 0] = model.equations.start
    return Designs(
        base=base,
        dimensions=FrozenDict(columns),
        quantities=quantities,
        loops=arrays["loops"],
        linear=arrays["linear"],
        points=arrays["points"],
        link_angles=arrays["link_angles"],
        start=arrays["start"],
        numbers=arrays["numbers"],
        redundant=arrays["redundant"],
        length_scale=arrays["length_scale"][:, 0],
        problem=builder.problem,
        problems=tuple(builder.problems),
    )


def _check_different(named: Mapping[str, VariedNumber]) -> None:
    if not named:
        raise InputError("this family varies no numbers: give a dimension and its values")
    first: dict[VariedNumber, str] = {}
    for name, quantity in named.items():
        if first.setdefault(quantity, name) != name:
            raise InputError(f'"{first[quantity]}" and "{name}" are the same number: give it once')


def _columns(dimensions: Mapping[str, object]) -> dict[str, Array]:
    """Every entry as an array (B,), read-only."""
    given = {name: _numeric(name, values) for name, values in dimensions.items()}
    lengths = {name: len(values) for name, values in given.items() if values.ndim}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{name}: {count}" for name, count in lengths.items())
        raise InputError(f"arrays of a family need equal lengths, got {told}")
    count = max(lengths.values(), default=1)
    return {name: np.broadcast_to(values, (count,)) for name, values in given.items()}


def _numeric(name: str, values: object) -> Array:
    if np.ma.is_masked(values):
        raise InputError(
            f'"{name}" holds masked values: fill them (with NaN those designs are not found), '
            "or leave these designs out"
        )
    try:
        array = np.asarray(values)
    except ValueError:
        raise InputError(f'"{name}" needs a number or an array of numbers, got rows') from None
    if array.dtype.kind not in "iuf":
        raise InputError(f'"{name}" needs a number or an array of numbers, got {as_told(values)}')
    if array.ndim > 1:
        shape = " × ".join(map(str, array.shape))
        raise InputError(f'"{name}" needs a number or an array of one axis, got {shape} numbers')
    found = np.array(array, dtype=np.float64)
    # a copy, read-only: the numbers of a family cannot change behind its results
    found.flags.writeable = False
    return found
