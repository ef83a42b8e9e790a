"""Compiling functions for a graphics card: the only module that imports numba.cuda."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from typing import Any, ParamSpec, TypeVar

from linkwork.foundation.errors import InputError, MissingPackageError

__all__ = ["graphics_card", "kernel", "name_of", "numba_cuda", "on_device"]

_P = ParamSpec("_P")
_R = TypeVar("_R")


def numba_cuda() -> Any:
    """The package; loading it takes half a second."""
    from numba import cuda

    return cuda


def graphics_card() -> Any:
    """The package, where there is a graphics card that it can use (or its simulator).

    Raises
    ------
    MissingPackageError
        With the package to install.
    InputError
        If there is no such device.
    """
    if find_spec("numba_cuda") is None:
        raise MissingPackageError(
            'families on a graphics card need numba-cuda: pip install "linkwork[gpu]"'
        )
    cuda = numba_cuda()
    if not cuda.is_available():
        raise InputError(
            "no usable graphics card was found: an NVIDIA card needs its driver and CUDA's "
            'compiler (pip install "numba-cuda[cu12]" or "[cu13]"); leave out device="gpu" to '
            "use the processor"
        )
    return cuda


def name_of(card: Any) -> str:
    """The name of the graphics card in use."""
    name = card.get_current_device().name
    return name.decode() if isinstance(name, bytes) else str(name)


def on_device(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """A function that kernels call; it becomes a part of them, so that arrays of a thread that are
    addressed by constants stay in registers.
    """
    cuda = numba_cuda()
    inlined = {} if _simulated() else {"forceinline": True}
    placed: Callable[_P, _R] = cuda.jit(device=True, **inlined)(function)
    return placed


def kernel(function: Callable[..., Any]) -> Any:
    """A function that a graphics card runs in many threads, compiled once for each kind of card."""
    return numba_cuda().jit(cache=True)(function)


def _simulated() -> bool:
    """Whether kernels are run as Python, for tests."""
    from numba import config

    return bool(getattr(config, "ENABLE_CUDASIM", 0))
