"""Compile the kernels before a family needs them."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

__all__ = ["compile_kernels"]

#: Modules that are compiled when they are loaded, those first that others need; each with its share
#: of the time.
_MODULES = (
    ("program.interpreter", 0.15),
    ("march.named_trial", 0.10),
    ("march.start_positions", 0.10),
    ("march.position_programs", 0.05),
    ("march.independent", 0.15),
    ("march.lockstep", 0.20),
    ("march.rowwise", 0.25),
)


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
    done = 0.0
    for module, share in _MODULES:
        import_module(f"linkwork.kernels.{module}")
        done += share
        if progress is not None:
            progress(min(done, 1.0))
