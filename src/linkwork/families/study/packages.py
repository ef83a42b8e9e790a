"""The packages that a study needs."""

from __future__ import annotations

from importlib.util import find_spec

from linkwork.core.foundation.errors import MissingPackageError


def check_packages() -> None:
    """Check that the packages for stores are installed.

    Raises
    ------
    MissingPackageError
        If one is missing; with the install command.
    """
    # not imported here: an import that Ctrl-C ends may raise ImportError
    if any(find_spec(name) is None for name in ("xarray", "zarr")):
        raise MissingPackageError(
            'studies are stored by zarr and xarray: pip install "linkwork[study]"'
        )
