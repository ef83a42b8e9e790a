"""A family: one mechanism in many designs, solved together."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from warnings import warn

import numpy as np

from linkwork.batch.designs import Designs, designs_of
from linkwork.batch.family_motion import FamilyMotion
from linkwork.batch.lane_rows import design_rows
from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.errors import InputError
from linkwork.foundation.names import as_name
from linkwork.foundation.plain_numbers import whole_number
from linkwork.foundation.sharing import cores
from linkwork.kernels.gpu.compiling import graphics_card
from linkwork.kernels.program.execution import Execution
from linkwork.motion.model import Model

__all__ = ["Family", "Reduction", "family_of"]

#: A reduction by name, or a function of values (D, R) that gives (D,); NaN marks missing positions.
Reduction = str | Callable[[Array], Array]

_MOST_BYTES = 4 << 30  # of unknowns that one call may hold in memory
_PART = 16_384  # designs reduced at a time, fewer where unknowns and rates take more than
_PART_BYTES = 1 << 30


class Family:
    """Designs of one mechanism; made by ``mechanism.family({"a2": array, …})``.

    Parameters
    ----------
    designs : Designs
    """

    def __init__(self, designs: Designs) -> None:
        self.designs = designs

    def __len__(self) -> int:
        return len(self.designs)

    def __repr__(self) -> str:
        varied = ", ".join(self.designs.dimensions)
        name = self.designs.base.description.name
        return f'<Family of "{name}": {len(self)} designs with their own {varied}>'

    @property
    def dimensions(self) -> Mapping[str, Array]:
        """What varies, (D,) each, in file units."""
        return self.designs.dimensions

    def take(self, index: Sequence[int] | IndexArray | BoolArray | slice) -> Family:
        """Some of the designs (integers, a mask or a slice)."""
        return Family(self.designs.take(index))

    def sweep(
        self,
        *,
        certify: bool = True,
        threads: int | None = None,
        specialised: bool | None = None,
        device: str = "cpu",
    ) -> FamilyMotion:
        """Every design at every row of the mechanism's table, each on the branch of its start.

        Positions, statuses and proofs are those that each design has by itself.

        Parameters
        ----------
        certify : bool
            Prove every position and the motion to it.
        threads : int, optional
            How many cores work; all of them by default.
        specialised : bool, optional
            Compile this mechanism's equations, which takes seconds once and is kept on disk. By
            default where so many positions are asked for that it saves time.
        device : str
            ``"gpu"``: a graphics card computes positions and proofs (the extra ``gpu``), the same
            to rounding; compiling takes seconds once for each mechanism.

        Raises
        ------
        InputError
            If the result would not fit into memory: use :meth:`parts` or :meth:`reduced`; if there
            is no such device.
        MissingPackageError
            If ``gpu`` is not installed.
        """
        execution = self._execution(specialised, device)
        return self._sweep(certify, _workers(threads), execution)

    def _execution(self, specialised: bool | None, device: str) -> Execution:
        positions = len(self) * len(self.designs.base.rows)
        execution = Execution(specialised=specialised, positions=positions, device=device)
        if execution.device == "gpu":
            graphics_card()  # or the reason why there is none, before anything is computed
        return execution

    def _sweep(self, certify: bool, threads: int, execution: Execution) -> FamilyMotion:
        model = self.designs.base
        count = len(self) * len(model.rows) * (len(model.equations.unknowns) + 1)
        if 8 * count > _MOST_BYTES:
            raise InputError(
                f"{len(self)} designs × {len(model.rows)} rows take {8 * count / 2**30:.0f} GiB: "
                "use family.parts() or family.reduced({...})"
            )
        rows = design_rows(self.designs, certify=certify, threads=threads, execution=execution)
        return FamilyMotion(
            designs=self.designs, inputs=model.rows_in_file_units, rows=rows, threads=threads
        )

    def parts(
        self,
        designs: int = _PART,
        *,
        certify: bool = True,
        threads: int | None = None,
        specialised: bool | None = None,
        device: str = "cpu",
    ) -> Iterator[FamilyMotion]:
        """The motions of so many designs at a time, in order; memory stays bounded."""
        designs, workers = whole_number("designs", designs, least=1), _workers(threads)
        parts = (self.take(slice(k, k + designs)) for k in range(0, len(self), designs))
        execution = self._execution(specialised, device)
        return (part._sweep(certify, workers, execution) for part in parts)

    def _part(self) -> int:
        """How many designs are reduced at a time, rates included."""
        model = self.designs.base
        # unknowns and two derivatives, and what is computed of them
        each = 8 * len(model.rows) * (3 * len(model.equations.unknowns) + 1)
        return max(1, min(_PART, _PART_BYTES // each))

    def reduced(
        self,
        wanted: Iterable[str] | Mapping[str, Reduction | tuple[Reduction, ...]],
        *,
        certify: bool = True,
        threads: int | None = None,
        specialised: bool | None = None,
        device: str = "cpu",
    ) -> dict[str, Array]:
        """One number per design of its whole motion: ``reduced(["stroke(s16)", "max(mu)"])``.

        Parameters
        ----------
        wanted : sequence of str, or Mapping
            Numbers of a motion by name, see ``linkwork quantities``; or quantities and rates
            (``B.x.velocity``), each with a function, or several, of values (D, R) to (D,), in which
            missing positions are NaN. Names of reductions in a mapping are deprecated.

        Returns
        -------
        dict
            By these names, ``"mu.name of the function"`` for functions, (D,) each, with ``found``
            and ``certified``: how many rows hold a position, and how many are proved;
            ``limit.lower`` and ``limit.upper``: between which inputs a design can move, see
            :class:`FamilyLimits`.

        Raises
        ------
        InputError, UnknownNameError
            For a number of a motion or a quantity that does not exist.
        """
        columns = list(_columns(wanted))
        # the motion of no designs knows all names, at no cost
        nothing = self.take(slice(0)).sweep(certify=False)
        for column in columns:  # what does not exist is refused before anything is computed
            column.check(nothing)
        found: dict[str, list[Array]] = {column.key: [np.empty(0)] for column in columns}
        found |= {"found": [np.empty(0, dtype=int)], "certified": [np.empty(0, dtype=int)]}
        found |= {"limit.lower": [np.empty(0)], "limit.upper": [np.empty(0)]}
        for part in self.parts(
            self._part(), certify=certify, threads=threads, specialised=specialised, device=device
        ):
            for column in columns:
                found[column.key].append(column.of(part))
            found["found"].append(part.found.sum(axis=1))
            found["certified"].append(part.certified.sum(axis=1))
            found["limit.lower"].append(part.limits.lower)
            found["limit.upper"].append(part.limits.upper)
        return {key: np.concatenate(values) for key, values in found.items()}


def family_of(model: Model, dimensions: Mapping[str, object]) -> Family:
    """The family of a mechanism; see :func:`linkwork.batch.designs_of` for what may vary."""
    return Family(designs_of(model, dimensions))


def _workers(threads: int | None) -> int:
    """How many threads are asked for; as many as there are cores by default."""
    return cores() if threads is None else whole_number("threads", threads, least=1)


@dataclass(frozen=True)
class _Column:
    """A number of every design: by its name, or what a function makes of a quantity's values."""

    key: str
    name: str
    function: Callable[[Array], Array] | None = None

    def check(self, motion: FamilyMotion) -> None:
        """Refuse what does not exist, on the motion of no designs."""
        if self.function is None:
            motion.value(self.name)
        else:
            motion.quantity(self.name)

    def of(self, motion: FamilyMotion) -> Array:
        """(D,)."""
        if self.function is None:
            return motion.value(self.name)
        value = np.asarray(self.function(motion[self.name]), dtype=float)
        if value.shape != (len(motion),):
            raise InputError(
                f"{self.key} needs one number per design ({len(motion)},), got {value.shape}"
            )
        return value


def _columns(
    wanted: Iterable[str] | Mapping[str, Reduction | tuple[Reduction, ...]],
) -> Iterator[_Column]:
    if not isinstance(wanted, Mapping):
        for name in (wanted,) if isinstance(wanted, str) else wanted:
            yield _Column(as_name(name), name)
        return
    for name, several in wanted.items():
        for reduction in several if isinstance(several, tuple) else (several,):
            if callable(reduction):
                word = getattr(reduction, "__name__", "value")
                yield _Column(f"{as_name(name)}.{word}", name, reduction)
                continue
            asked = f"{reduction}({as_name(name)})"
            warn(
                f'write family.reduced(["{asked}"]): names of reductions in a mapping are removed '
                "in version 0.4",
                DeprecationWarning,
                stacklevel=3,
            )
            yield _Column(f"{name}.{reduction}", asked)
