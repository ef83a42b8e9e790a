"""Sections about evidence: what is proved, versions, the file."""

from __future__ import annotations

import platform
from collections.abc import Iterator
from importlib import metadata

import numpy as np

from linkwork.export.report.document import Block, Facts, Listing, Paragraph
from linkwork.export.report.findings import Findings
from linkwork.export.report.template import Template
from linkwork.foundation.certification import Certification
from linkwork.results.listing.motion_listing import evidence_fields
from linkwork.results.listing.number_text import significant
from linkwork.results.listing.position_listing import certificate_text, radius_measure
from linkwork.results.motion import Motion

__all__ = ["file", "proof", "versions"]


def proof(found: Findings, template: Template) -> Iterator[Block]:
    """One paragraph on what is proved and what is not, and the evidence in numbers."""
    sentences = [*_positions(found), *_lists(found), *_unproved(found)]
    yield Paragraph(text=" ".join(sentences))
    if found.motion is not None and found.motion.found.any():
        yield Facts(pairs=tuple(evidence_fields(found.motion, _measure(found))))


def _measure(found: Findings) -> str:
    return " of the longest link" if found.model.equations.loops else ""


def _radius(found: Findings) -> str:
    return radius_measure(found.model.equations.loops, found.model.equations.real)


def _positions(found: Findings) -> Iterator[str]:
    motion = found.motion
    if motion is None:
        if not found.position.status.ok:
            yield f"No position was found: {found.position.message}."
            return
        certificate = certificate_text(found.position.certificate, _radius(found))
        yield f"Certificate of the position: {certificate}."
        return
    there = int(motion.found.sum())
    yield f"Rows with a position: {there} of {len(motion)}."
    if not there:
        return
    proved = np.flatnonzero(motion.certified)
    yield f"Rows with a complete proof: {len(proved)}."
    if len(proved):
        yield (
            f"In each of these, a true position lies within {_largest(motion, proved)}"
            f"{_radius(found)} of the computed one, no other lies near it, and the motion from "
            "the start to it stays on one branch."
        )
    for reason in Certification:
        count = sum(
            c is reason for c, here in zip(motion.certification, motion.found, strict=True) if here
        )
        if count and reason is not Certification.CERTIFIED:
            yield f"Rows without it: {count}; {reason.value}."


def _largest(motion: Motion, rows: np.ndarray) -> str:
    return f"{significant(float(motion.radius[rows].max()), 2)}"


def _lists(found: Findings) -> Iterator[str]:
    """How many circuits and configurations are proved, and whether their lists are complete."""
    if found.circuits is not None:
        certified = sum(circuit.certified for circuit in found.circuits)
        if len(found.circuits):
            yield f"Circuits proved to be one curve: {certified} of {len(found.circuits)}."
        yield _sentence(found.circuits.message)
    if found.configurations is not None:
        certified = sum(p.certificate.certified for p in found.configurations)
        if len(found.configurations):
            yield f"Proved configurations: {certified} of {len(found.configurations)}."
        yield _sentence(f"configurations: {found.configurations.message}")


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."


def _unproved(found: Findings) -> Iterator[str]:
    """What carries no proof."""
    others = ["rates", "plots"]
    others += ["forces"] if found.forces is not None else []
    others += ["tolerances"] if found.tolerances else []
    listed = f"{', '.join(others[:-1])} and {others[-1]}"
    yield f"Not proved are {listed}: they are computed in double precision from the positions."


def versions(found: Findings, template: Template) -> Iterator[Block]:
    """The programs that computed the results."""
    yield Facts(
        pairs=(
            ("Linkwork", metadata.version("linkwork")),
            ("NumPy", np.__version__),
            ("Python", platform.python_version()),
        )
    )


def file(found: Findings, template: Template) -> Iterator[Block]:
    """The mechanism file, complete."""
    yield Paragraph(text="All results of this report are computed from the file below.")
    yield Listing(text=found.source)
