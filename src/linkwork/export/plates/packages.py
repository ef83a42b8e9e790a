"""The packages of plates, loaded on first use: shapely for distances and triangles, ezdxf for DXF,
build123d for STEP.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

from linkwork.foundation.optional_packages import installed_with

__all__ = ["build123d", "ezdxf", "shapely"]


def shapely() -> Any:
    """shapely.

    Raises
    ------
    MissingPackageError
        If it is not installed.
    """
    return _loaded("shapely", "plates")


def ezdxf() -> Any:
    """ezdxf; raises like :func:`shapely`."""
    return _loaded("ezdxf", "plates")


def build123d() -> Any:
    """build123d; raises like :func:`shapely`."""
    return _loaded("build123d", "step")


def _loaded(package: str, extra: str) -> Any:
    with installed_with(extra, f"plates need {package}"):
        return import_module(package)
