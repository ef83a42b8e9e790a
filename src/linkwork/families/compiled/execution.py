"""The device that a march runs on, and whether its equations are compiled for it."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.core.foundation.errors import InputError
from linkwork.core.record.recorder import ROLES

#: Devices that a march can run on.
DEVICES = ("cpu", "gpu")


# Compiling takes some 5 ms for each instruction, of which a position then costs 0.1 ns less.
_PAYS = 100_000_000  # positions


_PAYS_COMPILED = 1_000_000  # where an earlier run has left its compiled code


_LONGEST = 4_000  # instructions: the compiler's time grows faster than they do


@dataclass(frozen=True, kw_only=True)
class Execution:
    """Whether the trial of a topology is written out and compiled, or done by the interpreter.

    Parameters
    ----------
    specialised : bool, optional
        Asked for; by default it is whatever takes less time for this many ``positions``.
    positions : int
    device : str
        Where it runs, one of :data:`DEVICES`; a graphics card runs compiled programs only.

    Raises
    ------
    InputError
        For another device, or for a graphics card that should compile nothing.
    """

    specialised: bool | None = None
    positions: int = 0
    device: str = "cpu"

    def __post_init__(self) -> None:
        if self.device not in DEVICES:
            raise InputError(
                f'there is no device "{self.device}" (there are: {", ".join(DEVICES)})'
            )
        if self.device == "gpu" and self.specialised is False:
            raise InputError(
                "a graphics card runs compiled equations only: leave out "
                'specialised=False or device="gpu"'
            )

    def pays(self, instructions: int) -> bool:
        """Whether compiling programs of this many instructions in all turns saves time."""
        return self.positions >= _PAYS and instructions <= ROLES * _LONGEST

    def pays_compiled(self, instructions: int) -> bool:
        """Whether loading code that an earlier run has compiled saves time."""
        return self.positions >= _PAYS_COMPILED and instructions <= ROLES * _LONGEST
