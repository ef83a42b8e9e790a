"""Compile the kernels before a family needs them."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

import numpy as np

from linkwork import batch
from linkwork.foundation.value_types import check_flags
from linkwork.mechanism.driven_input import Input
from linkwork.mechanism.linkage import Linkage
from linkwork.motion.model import model_of

__all__ = ["compile_kernels"]

#: Modules that are compiled when they are loaded, those first that others need; each with its share
#: of the time.
_MODULES = {
    "program.interpreter": 0.09,
    "march.named_trial": 0.08,
    "march.start_positions": 0.08,
    "march.position_programs": 0.01,
    "march.independent": 0.13,
    "march.lockstep": 0.13,
    "march.rowwise": 0.24,
    "paths.lane_paths": 0.09,
    "single.compiled_rows": 0.08,
}
_DESIGNS = 17  # more than march row after row


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
    >>> from linkwork.batch import compile_kernels
    >>> compile_kernels()
    """
    check_flags(progress)
    done = 0.0
    for module, share in _MODULES.items():
        import_module(f"linkwork.kernels.{module}")
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
        inputs=(Input(link="crank", start=0, stop=360, step=30),),
    )
    for length in (40.0, 95.0):  # turns around, and does not
        family = batch.family_of(model_of(four_bar), {"O A": np.full(_DESIGNS, length)})
        family.sweep()["arm.d1"]
