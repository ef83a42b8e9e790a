"""Compile the kernels before a family needs them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from importlib import import_module
from typing import NamedTuple

import numpy as np

from linkwork import wings
from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.errors import InputError, internal
from linkwork.core.foundation.loading import cores
from linkwork.core.foundation.names import as_name
from linkwork.core.foundation.values import check_flags, whole_number
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.motion.model import Model, model_of
from linkwork.families.building import Designs, designs_of
from linkwork.families.compiled.code_cache import Execution
from linkwork.families.design_sweep import design_rows
from linkwork.families.family_motion import FamilyMotion

#: Modules that are compiled when they are loaded, those first that others need; each with its share
#: of the time.
_MODULES = {
    "compiled.interpreter": 0.1,
    "march.step_trial": 0.25,
    "march.independent": 0.2,
    "march.lockstep": 0.2,
    "paths.path_kernel": 0.15,
}
_DESIGNS = 5  # more than march row after row


def compile_kernels(progress: Callable[[float], None] | None = None) -> None:
    """Compile all kernels, once after an installation.

    Otherwise each of them is compiled when a family first needs it, in up to half a minute. Later
    processes load the compiled code.

    Parameters
    ----------
    progress : callable, optional
        Called with the finished fraction, 0 to 1.

    Examples
    --------
    >>> from linkwork.families import compile_kernels
    >>> compile_kernels()
    """
    check_flags(progress)
    done = 0.0
    for module, share in _MODULES.items():
        import_module(f"linkwork.families.{module}")
        done += share
        if progress is not None:
            progress(done)
    _use_all()
    if progress is not None:
        progress(1.0)


def _use_all() -> None:
    """Solve two small families, for the functions that are compiled when they are first called:
    rates of positions that are found together and one by one, and dead points.
    """
    four_bar = Linkage(
        points={"O": (0, 0), "A": (35, 20), "B": (146, 66), "C": (100, 0)},
        links={"ground": ("O", "C"), "crank": ("O", "A"), "rod": ("A", "B"), "arm": ("C", "B")},
        lengths={"O A": 40},
        inputs=(Input(link="crank", from_=0, to=360, step=30),),
    )
    for length in (40.0, 95.0):  # turns around, and does not
        family = family_of(model_of(four_bar), {"O A": np.full(_DESIGNS, length)})
        family.sweep()["arm.d1"]


# ----------------------------------------------------------------------
# A family: one mechanism in many designs, solved together.


#: A function from values (D, R) to (D,); NaN marks missing positions.
Reduction = Callable[[Array], Array]

_MOST_BYTES = 4 << 30  # limit for the unknowns of one call
_PART = 16_384  # designs reduced at a time, fewer if unknowns and rates exceed
_PART_BYTES = 1 << 30


@internal("designs")
class Family:
    """Designs of one mechanism; made by ``mechanism.family({"a2": array, …})``.

    Parameters
    ----------
    designs : Designs

    Examples
    --------
    >>> import linkwork as lw
    >>> family = lw.example("four-bar").family({"O2 A": [38, 40, 42]})
    >>> motion = family.sweep()
    >>> motion["rocker"].shape, bool(motion.certified.all())
    ((3, 361), True)
    """

    def __init__(self, designs: Designs) -> None:
        self.designs = designs

    def __len__(self) -> int:
        return len(self.designs)

    def __repr__(self) -> str:
        varied = ", ".join(self.designs.dimensions)
        name = self.designs.base.description.name
        return f'<Family of "{name}": {len(self)} designs with varied {varied}>'

    @property
    def dimensions(self) -> Mapping[str, Array]:
        """The varied numbers, (D,) each, in file units."""
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
        """Solve every design at every row of the mechanism's table, on the branch of its start.

        Positions, statuses and proofs equal those of each design swept alone.

        Parameters
        ----------
        certify : bool
            Prove every position and the motion to it.
        threads : int, optional
            Number of cores; all by default.
        specialised : bool, optional
            Compile this mechanism's equations, which takes seconds once and is cached on disk. By
            default only if the number of positions is large enough to save time.
        device : str
            ``"gpu"`` computes positions and proofs on a graphics card (extra ``gpu``), with the
            same results to rounding; compiling takes seconds once for each mechanism.

        Raises
        ------
        InputError
            If the result does not fit into memory (use :meth:`parts` or :meth:`reduced`), or the
            device does not exist.
        MissingPackageError
            If ``gpu`` is not installed.
        """
        check_flags(certify=certify)
        execution = self._execution(specialised, device)
        return self._sweep(certify, _workers(threads), execution)

    def _execution(self, specialised: bool | None, device: str) -> Execution:
        positions = len(self) * len(self.designs.base.rows)
        execution = Execution(specialised=specialised, positions=positions, device=device)
        if execution.device == "gpu":  # an error before any computation
            wings.use("families.gpu.kernel").graphics_card()
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
        """The motions of ``designs`` designs at a time, in order, with bounded memory."""
        designs, workers = whole_number("designs", designs, least=1), _workers(threads)
        parts = (self.take(slice(k, k + designs)) for k in range(0, len(self), designs))
        execution = self._execution(specialised, device)
        return (part._sweep(certify, workers, execution) for part in parts)

    def _part(self) -> int:
        """Number of designs reduced at a time, rates included."""
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
        """One number for the whole motion of each design: ``reduced(["stroke(s16)", "max(mu)"])``.

        Parameters
        ----------
        wanted : sequence of str, or Mapping
            Numbers of a motion by name, see ``linkwork quantities``; or a mapping of quantities and
            rates (``B.x.velocity``) to one or more functions from values (D, R) to (D,), where
            missing positions are NaN.

        Returns
        -------
        dict
            By these names, ``"mu.name of the function"`` for functions, (D,) each; also ``found``
            and ``certified``, the numbers of rows with a position and of proved rows, and
            ``limit.lower`` and ``limit.upper``, the range of inputs, see :class:`FamilyLimits`.

        Raises
        ------
        InputError, UnknownNameError
            If a number of a motion or a quantity does not exist.
        """
        columns = list(_columns(wanted))
        # a motion without designs has all names, at no cost
        nothing = self.take(slice(0)).sweep(certify=False)
        for column in columns:  # reject unknown names before any computation
            if column.function is None:
                nothing.value(column.name)
            else:
                nothing.quantity(column.name)
        found: dict[str, list[Array]] = {column.key: [np.empty(0)] for column in columns}
        found |= {"found": [np.empty(0, dtype=int)], "certified": [np.empty(0, dtype=int)]}
        found |= {"limit.lower": [np.empty(0)], "limit.upper": [np.empty(0)]}
        for part in self.parts(
            self._part(), certify=certify, threads=threads, specialised=specialised, device=device
        ):
            for column in columns:
                found[column.key].append(_numbers(part, column))
            found["found"].append(part.found.sum(axis=1))
            found["certified"].append(part.certified.sum(axis=1))
            found["limit.lower"].append(part.limits.lower)
            found["limit.upper"].append(part.limits.upper)
        return {key: np.concatenate(values) for key, values in found.items()}


def family_of(model: Model, dimensions: Mapping[str, object]) -> Family:
    """The family of a mechanism; :func:`linkwork.families.designs_of` lists the variable
    numbers.
    """
    return Family(designs_of(model, dimensions))


def _workers(threads: int | None) -> int:
    """The number of threads; by default the number of cores."""
    return cores() if threads is None else whole_number("threads", threads, least=1)


class _Column(NamedTuple):
    """A number of every design, given by name or by a function of a quantity's values."""

    key: str
    name: str
    function: Reduction | None = None


def _numbers(motion: FamilyMotion, column: _Column) -> Array:
    """One number for each design, (D,)."""
    if column.function is None:
        return motion.value(column.name)
    value = np.asarray(column.function(motion[column.name]), dtype=float)
    if value.shape != (len(motion),):
        raise InputError(
            f"{column.key} needs one number per design ({len(motion)},), got {value.shape}"
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
            if not callable(reduction):
                raise InputError(
                    f'"{reduction}" of {as_name(name)} is not a function: write '
                    f'family.reduced(["{reduction}({as_name(name)})"])'
                )
            word = getattr(reduction, "__name__", "value")
            yield _Column(f"{as_name(name)}.{word}", name, reduction)
