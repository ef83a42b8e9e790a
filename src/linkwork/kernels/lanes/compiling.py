"""How functions of this package are compiled: the one place that knows numba."""

from __future__ import annotations

from typing import Any

import numba  # noqa: TID253 - this module is loaded when a family is solved
from numba import types  # noqa: TID253

__all__ = ["compiled", "compiled_for", "named_tuple", "types"]


def compiled_for(signature: object):  # type: ignore[no-untyped-def]
    """Compiled when the module is loaded, for arrays as the signature says; ``None``: at the first
    call, for the arrays that are met.
    """
    return numba.njit(signature, cache=True, error_model="numpy", fastmath={"contract"}, nogil=True)


compiled = compiled_for(None)


def named_tuple(fields: list[object], kind: type) -> Any:
    """The type of a NamedTuple in a signature."""
    return types.NamedTuple(fields, kind)  # type: ignore[no-untyped-call]
