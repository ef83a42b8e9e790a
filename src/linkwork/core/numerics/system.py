"""The interface between equations and the numerical methods that solve and prove them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NoReturn, Protocol, Self, dataclass_transform

import numpy as np

from linkwork.core.foundation.arrays import (
    AnyArray,
    Array,
    BoolArray,
    CountArray,
    IndexArray,
    StatusArray,
)
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.table.curvature import Curvature


class SmallSystem(Protocol):
    """Equations F(v) = 0 with v = (unknowns, inputs), batched over the first axis of v (B, N)."""

    @property
    def unknowns(self) -> int:
        """The number n of unknowns, which are the first variables."""

    @property
    def equation_scale(self) -> Array:
        """(m,) scales that divide residuals before these are compared."""

    @property
    def variable_scale(self) -> Array:
        """(N,) weights of the variables."""

    def residual_and_jacobian(self, v: Array) -> tuple[Array, Array]:
        """F, (B, m), and dF/dv, (B, m, N)."""

    def hessians(self, v: Array, weights: Array) -> Array:
        """Second derivatives of K sums of equations at one position v (N,), (K, N, N); ``weights``
        (K, m): the factor of every equation in each sum.
        """


class System(SmallSystem, Protocol):
    """Equations with the further functions that path following and proofs need."""

    @property
    def is_angle(self) -> BoolArray:
        """(N,) which variables are angles."""

    def residual(self, v: Array) -> Array:
        """F, (B, m)."""

    def exact_residual(self, v: Array) -> tuple[Array, Array]:
        """F at one position v (N,), (m,), with as little rounding as the equations allow, and a
        bound of its error.
        """

    def jacobian(self, v: Array) -> Array:
        """dF/dv, (B, m, N)."""

    def second_directional_derivative(self, v: Array, d: Array) -> Array:
        """D²F[d, d], (B, m)."""

    @property
    def has_curvature_bound(self) -> bool:
        """Whether :meth:`curvature` gives a bound."""

    @property
    def is_enclosed(self) -> bool:
        """Whether :meth:`enclosure` gives bounds."""

    def enclosure(self, v: Array, box: Array) -> tuple[Array, Array]:
        """Lowest and highest F, (2, B, m), and dF/dv, (2, B, m, N), over boxes around v (B, N)
        with half widths ``box`` (B, N), with all rounding.
        """

    def curvature(self, v: Array, matrix: Array) -> Curvature:
        """Moduli of the second derivatives multiplied by a matrix (B, n, m)."""


class BlockFunctions(Protocol):
    """A block's arithmetic as functions; see :mod:`linkwork.core.record.block_record`."""

    def __getattr__(self, name: str) -> Callable[..., Any]:
        """``solve``, ``correct``, ``rates``, ``balanced``, ``place`` or ``within``."""


class Recorded(Protocol):
    """A block whose arithmetic is recorded."""

    @property
    def of_floats(self) -> BlockFunctions:
        """Its functions of floats."""

    @property
    def of_arrays(self) -> BlockFunctions:
        """Its functions of arrays."""


# ----------------------------------------------------------------------
# Rows with named columns; positions of one mechanism with everything that is known of each.


#: A column that has not been computed: empty.
UNKNOWN: Any = np.empty(0)


@dataclass_transform(kw_only_default=True, frozen_default=True)
class Columns:
    """Arrays over the same rows by name, read-only; one that is not given keeps its default.

    A data class would set each of twenty columns one by one, which takes longer than a step of
    Newton-Raphson on a small block.
    """

    def __init__(self, **columns: AnyArray) -> None:
        for column in columns.values():
            column.setflags(write=False)
        vars(self).update(columns)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise TypeError("columns are read-only: make others with set, put or with_columns")

    @property
    def columns(self) -> dict[str, AnyArray]:
        """The columns that have been computed, by name."""
        return dict(vars(self))

    def with_columns(self, **columns: AnyArray) -> Self:
        """The rows with some columns added or replaced."""
        return type(self)(**(vars(self) | columns))

    def take(self, where: IndexArray | slice) -> Self:
        """Some rows, in the order of ``where``."""
        return type(self)(**{name: column[where] for name, column in vars(self).items()})

    @classmethod
    def concatenate(cls, parts: Sequence[Self]) -> Self:
        """Rows one after the other, with the columns that all parts have."""
        columns = [part.columns for part in parts]
        names = [name for name in columns[0] if all(name in other for other in columns)]
        return cls(**{name: np.concatenate([c[name] for c in columns]) for name in names})

    def put(self, where: IndexArray, others: Self) -> Self:
        """The rows with some replaced by others one by one; columns unknown of those stay."""
        changed = self.columns
        for name in changed.keys() & others.columns.keys():
            changed[name] = changed[name].copy()
            changed[name][where] = getattr(others, name)
        return type(self)(**changed)

    def set(self, where: Any = slice(None), **values: Any) -> Self:
        """The rows with values of some columns set at the rows ``where``."""
        changed = self.columns
        for name, value in values.items():
            changed[name] = changed[name].copy()
            changed[name][where] = value
        return type(self)(**changed)


class SolvedRows(Columns):
    """B positions of one mechanism in internal units; every column is read-only.

    A step of the solution computes some columns; the others are ``UNKNOWN``.

    Parameters
    ----------
    v : (B, N)
        Unknowns followed by the inputs, NaN where there is no position.
    t : (B,)
        Values of the path's parameter.
    status, iterations, residual : (B,)
        How Newton-Raphson ended; the largest scaled residual.
    first_step, contraction : (B,)
        Of Newton-Raphson: weighted size of the first correction; largest ratio of successive
        corrections that were above rounding.
    failed_block : (B,)
        The block that did not converge, -1 where all did.
    first, second : (B, N)
        Derivatives by t, NaN where they do not exist.
    condition, nearness : (B,)
        Largest over the blocks of ‖J‖·‖J⁻¹‖ (largest norm, weighted); how near to a singular
        position: the condition itself unless lengths differ much.
    orientation : (B, blocks)
        Sign of det J, 0 where J is singular.
    input_radius : (B, p)
        How far the intended inputs may be from those in v.
    certification, radius, uniqueness_radius : (B,)
        Codes of :class:`Certification`; a true position lies within the one radius, no other
        within the other (weighted), NaN without a proof.
    inputs : (B, p)
        The inputs asked for, in file units.
    branch, limit : (B,)
        Names, or "".
    """

    v: Array
    t: Array = UNKNOWN
    status: StatusArray = UNKNOWN
    iterations: CountArray = UNKNOWN
    residual: Array = UNKNOWN
    first_step: Array = UNKNOWN
    contraction: Array = UNKNOWN
    failed_block: CountArray = UNKNOWN
    first: Array = UNKNOWN
    second: Array = UNKNOWN
    condition: Array = UNKNOWN
    nearness: Array = UNKNOWN
    orientation: StatusArray = UNKNOWN
    input_radius: Array = UNKNOWN
    certification: StatusArray = UNKNOWN
    radius: Array = UNKNOWN
    uniqueness_radius: Array = UNKNOWN
    inputs: Array = UNKNOWN
    branch: AnyArray = UNKNOWN
    limit: AnyArray = UNKNOWN

    def __len__(self) -> int:
        return len(self.v)

    @classmethod
    def blank(
        cls,
        inputs: Array,
        variables: int,
        status: Status,
        certification: Certification = Certification.NO_POSITION,
    ) -> SolvedRows:
        """Rows of a table without positions, all for one reason."""
        count = len(inputs)
        nothing, unknown = np.full((count, variables), np.nan), np.full(count, np.nan)
        names = np.full(count, "", dtype=object)
        return cls(
            inputs=np.array(inputs, dtype=float),
            v=nothing,
            first=nothing,
            second=nothing,
            status=np.full(count, status.code, dtype=np.int8),
            iterations=np.zeros(count, dtype=np.int64),
            residual=unknown,
            condition=unknown,
            certification=np.full(count, certification.code, dtype=np.int8),
            radius=unknown,
            uniqueness_radius=unknown,
            branch=names,
            limit=names,
        )

    @property
    def asks_for_proofs(self) -> bool:
        """Whether the rows of a table are to be proved."""
        return not (self.certification == Certification.NOT_ASKED.code).any()

    def demote(self, standing: Certification) -> SolvedRows:
        """The rows with those that are certified on their branch limited to ``standing``."""
        return self.set(
            self.certification == Certification.CERTIFIED.code, certification=standing.code
        )
