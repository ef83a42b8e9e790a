"""Solution paths of a homotopy in the lanes of compiled code, which is loaded when first used."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.families.paths.path_kernel import PathKernel as PathKernel
else:
    __getattr__ = loader(__name__)
