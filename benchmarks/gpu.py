"""``scripts/gpu``: compare families on a graphics card with the processor; positions per second.

Every family is swept by both, with and without proofs: statuses must be equal, unknowns must agree
within their proofs, or to rounding. Then the card solves the same chunk of designs repeatedly
without transfer of results, to measure the kernels alone.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.core.mechanism.varied_numbers import varied_numbers
from linkwork.families import Family, latin_hypercube
from linkwork.families.compiled.code_cache import Execution
from linkwork.families.design_sweep import TablePath
from linkwork.families.family_motion import FamilyMotion
from linkwork.families.gpu.kernel import DeviceKernel, graphics_card, name_of
from linkwork.families.march.march_programs import Steps

__all__ = ["FAMILIES", "Compared", "compared", "family_of", "kernel_speed", "main"]

#: Mechanisms, their varied tables, and relative variations.
FAMILIES = (
    ("four-bar", "lengths", 0.02),
    ("jansen-leg", "lengths", 0.01),
    ("rapier-drive", "dimensions", 0.005),
    ("rapier-drive-limited", "dimensions", 0.005),  # with dead points
)
_ROUNDING = 1e-11  # weighted, of unproved positions
_HOLDS = 1.0 + 1e-6  # the sum of two radii is rounded


def family_of(name: str, table: str, share: float, count: int) -> Family:
    """Designs of a library mechanism; points do not vary, since lengths refer to them."""
    mechanism = lw.example(name)
    ground = set(getattr(mechanism.description, "links", {}).get("ground", ()))
    own = {
        quantity.name: quantity.of(mechanism.description)
        for quantity in varied_numbers(mechanism.description)
        if quantity.table == table and not ground.issuperset(quantity.key.split())
    }
    ranges = {
        k: (v - share * abs(v), v + share * abs(v)) for k, v in own.items() if share * abs(v) > 0.0
    }
    return mechanism.family(latin_hypercube(count, ranges, seed=1))


@dataclass(frozen=True, kw_only=True)
class Compared:
    """One family on the card and on the processor.

    Parameters
    ----------
    positions : int
        Positions found.
    differing : int
        Rows with different status or certification.
    apart : float
        The largest distance of unknowns, weighted.
    excess : float
        The largest distance relative to the allowed one; at most 1 if all agree.
    """

    positions: int
    differing: int
    apart: float
    excess: float

    @property
    def agrees(self) -> bool:
        """Whether card and processor agree."""
        return self.differing == 0 and self.excess <= _HOLDS


def compared(ours: FamilyMotion, reference: FamilyMotion) -> Compared:
    """Compare the card's motion with that of the processor."""
    differing = (ours.status != reference.status) | (ours.certification != reference.certification)
    both = ours.found & reference.found
    table = ours.designs.base.compiled.table
    turns = table.is_angle[: table.unknowns]
    weights = np.where(turns[:, None], 1.0, ours.designs.length_scale)
    gaps = np.abs(ours.rows.v - reference.rows.v) / weights[:, None, :]
    gap = gaps.max(axis=0).T[both]
    proved = (ours.certified & reference.certified)[both]
    radii = (ours.radius + reference.radius)[both]
    allowed = np.where(proved, radii, _ROUNDING)
    return Compared(
        positions=int(ours.found.sum()),
        differing=int(differing.sum()),
        apart=float(gap.max(initial=0.0)),
        excess=float((gap / allowed).max(initial=0.0)),
    )


def kernel_speed(family: Family, certify: bool, positions: int) -> tuple[int, float]:
    """Number of positions solved by the card without transfer (at least ``positions``), and the
    seconds.
    """
    model = family.designs.base
    path = TablePath.of(model)
    assert path is not None
    march = path.march(family.designs, certify, 1, Execution(device="gpu"))
    kernel = march.kernel
    assert isinstance(kernel, DeviceKernel)
    rows = np.sort(model.rows[:, path.lead])
    chunk = kernel.chunk(len(rows), len(family))
    steps = Steps().times(path.size)
    whole = slice(0, len(family))
    kernel.load(chunk, whole, march.coefficients, march.guess, march.start, rows, steps)
    chunk.launch()
    chunk.send_back()
    chunk.stream.synchronize()
    each = max(1, int(chunk.staged["reached"].sum()))
    times = -(-positions // each)
    begin = time.perf_counter()
    for _ in range(times):
        chunk.launch()
    chunk.stream.synchronize()
    return times * each, time.perf_counter() - begin


def main(arguments: Sequence[str]) -> int:
    """Print two lines for each family; returns 1 if any differs, 2 without a graphics card."""
    parser = argparse.ArgumentParser(prog="scripts/gpu", description=__doc__)
    names = [name for name, _, _ in FAMILIES]
    parser.add_argument("family", nargs="*", choices=[[], *names], help="families; default all")
    parser.add_argument("--designs", type=int, default=65_536, help="designs of each family")
    parser.add_argument(
        "--positions", type=float, default=1e9, help="positions for the kernels' speed"
    )
    options = parser.parse_args(arguments)
    try:
        print(name_of(graphics_card()))
    except InputError as error:
        print(error)
        return 2
    print(f"{options.designs} designs each; positions/s with transfers, of the kernels alone")
    held = True
    for name, table, share in FAMILIES:
        if not options.family or name in options.family:
            family = family_of(name, table, share, options.designs)
            for certify in (True, False):
                held = _report(name, family, certify, int(options.positions)) and held
    return 0 if held else 1


def _report(name: str, family: Family, certify: bool, positions: int) -> bool:
    family.take(slice(0, 64)).sweep(certify=certify, device="gpu")  # compiles
    begin = time.perf_counter()
    ours = family.sweep(certify=certify, device="gpu")
    seconds = time.perf_counter() - begin
    found = compared(ours, family.sweep(certify=certify))
    del ours
    count, alone = kernel_speed(family, certify, positions)
    print(
        f"{name + (', proved' if certify else ''):<30}{found.positions / seconds:10.2e}"
        f"{count / alone:10.2e}  {found.positions} positions, {found.differing} rows differ, "
        f"{found.apart:.0e} apart, {found.excess:.2g} of what is allowed",
        flush=True,
    )
    return found.agrees


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
