"""Correctness of results: rows found, rows on another branch, largest error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.peers.dyad_linkage import ComplexArray
from benchmarks.peers.reference import Reference

__all__ = ["TOLERANCE", "Verdict", "judged"]

#: A position further than this from the right one, relative to the longest link, is another one.
TOLERANCE = 1e-6


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """Every row is in one of four counts.

    Parameters
    ----------
    found : int
        Rows on the right branch.
    other_branch : int
        Rows that are a position of another configuration.
    wrong : int
        Rows that are no position known to exist.
    missing : int
        Rows that say there is none (NaN).
    error : float
        The largest error of rows found, relative to the longest link; NaN if none is found.
    """

    found: int
    other_branch: int
    wrong: int
    missing: int
    error: float

    @property
    def rows(self) -> int:
        """How many rows were judged."""
        return self.found + self.other_branch + self.wrong + self.missing


def judged(answer: ComplexArray, reference: Reference) -> Verdict:
    """Compare positions, shape (members, rows), with the right ones.

    Raises
    ------
    ValueError
        If the answer has another shape: rows were dropped or added.
    """
    if answer.shape != reference.traced.shape:
        raise ValueError(
            f"positions have the shape {answer.shape}, asked were {reference.traced.shape}"
        )
    error = np.abs(answer - reference.traced) / reference.scale
    there = np.isfinite(error)
    with np.errstate(invalid="ignore"):
        found = error <= TOLERANCE
        other = np.zeros_like(found)
        for way in reference.configurations:
            other |= np.abs(answer - way) <= TOLERANCE * reference.scale
    other &= ~found
    return Verdict(
        found=int(found.sum()),
        other_branch=int(other.sum()),
        wrong=int((there & ~found & ~other).sum()),
        missing=int((~there).sum()),
        error=float(error[found].max()) if found.any() else float("nan"),
    )
