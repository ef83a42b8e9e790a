"""The referee of families of every kind: random designs of one structure against closed forms.

Triads have none: each of them is compared with its own sweep.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from linkwork.core.foundation.statuses import Certification
from linkwork.core.mechanism.loops import Loops
from linkwork.families import FamilyMotion
from tests.campaigns.motion import FAMILIES, Case, changed_branch, random_case
from tests.described import described_as

__all__ = ["kind_campaign"]

_STEP = 10


def kind_campaign(
    part: int, count: int, step: int = _STEP, *, certify: bool = True
) -> tuple[Counter[str], list[str]]:
    """So many designs of one kind, a tenth close to a change point; what is false."""
    kind, rng = FAMILIES[part % len(FAMILIES)], np.random.default_rng([29, part])
    near = (rng.random(count) < 0.1) & (kind != "triad")
    gaps = np.where(near, 10.0 ** rng.uniform(-9, -3, count), np.nan)
    cases = [random_case(rng, kind, float(g) if np.isfinite(g) else None, step) for g in gaps]
    motion = _together(cases, certify)
    counts = Counter({
        "mechanisms": count,
        "near a change point": int(near.sum()),
        "designs that went alone": int(motion.rows.alone.sum()),
        "rows": motion.found.size,
        "rows found": int(motion.found.sum()),
    })  # fmt: skip
    for reason in Certification:
        counts[f"row {reason.name}"] += int((motion.certification == reason.code).sum())
    false = []
    for k, case in enumerate(cases):
        judge = _judged_alone if case.exact is None else _judged
        wrong = judge(case, motion, k, counts, bool(near[k]))
        false += [f"{kind}, part {part}, design {k}: {what}" for what in wrong]
    return counts, false


def _together(cases: Sequence[Case], certify: bool) -> FamilyMotion:
    """All of them as designs of the first one."""
    described = [described_as(Loops, case.mechanism) for case in cases]
    columns = {
        name: np.array([one.dimensions[name] for one in described])
        for name in described[0].dimensions
    }
    columns |= {
        name: np.array([one.guess[name] for one in described]) for name in described[0].guess
    }
    return cases[0].mechanism.family(columns).sweep(certify=certify)


def _judged(
    case: Case, motion: FamilyMotion, k: int, counts: Counter[str], near: bool
) -> list[str]:
    theta = np.radians(motion.inputs[:, 0])
    values = {u.name: motion[u.name][k] for u in case.mechanism.model.equations.unknowns}
    joints = case.joints(values, theta)
    changed = changed_branch(case, theta, joints, joints) & motion.found[k]
    counts["branch changes"] += int(changed.sum())
    wrong = []
    if changed.any():
        wrong.append(f"{int(changed.sum())} rows on another branch")
    lost = int((~motion.found[k]).sum()) if case.turns else 0
    counts["rows lost that can be reached"] += lost
    if lost and not near:
        wrong.append(f"{lost} reachable rows are lost")
    return wrong


def _judged_alone(
    case: Case, motion: FamilyMotion, k: int, counts: Counter[str], near: bool
) -> list[str]:
    own = case.mechanism.sweep()
    asked = own.asked
    both = own.found[asked] & motion.found[k]
    differ = int((own.found[asked] != motion.found[k]).sum())
    counts["rows found alone only, or together only"] += differ
    gaps = [np.abs(own[name][asked] - motion[name][k])[both] for name in own.unknowns]
    off = float(np.max(gaps, initial=0.0))
    return [f"{off} from its own sweep"] if off > 1e-6 else []
