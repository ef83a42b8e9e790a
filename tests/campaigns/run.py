"""Campaigns by name, split over processes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from tests.campaigns.certificates import judge
from tests.campaigns.change_points import (
    CASES,
    parallel_train_campaign,
    random_train_campaign,
)
from tests.campaigns.circuits import circuit_campaign
from tests.campaigns.commands import PARTS as COMMANDS, command_campaign
from tests.campaigns.configurations import configuration_campaign
from tests.campaigns.dead_points import dead_point_campaign
from tests.campaigns.defects import defect_campaign
from tests.campaigns.extremes import extreme_campaign
from tests.campaigns.families import family_campaign
from tests.campaigns.forces import force_campaign
from tests.campaigns.fuzz import fuzz_campaign
from tests.campaigns.goals import goal_campaign
from tests.campaigns.gradients import EVERY, gradient_campaign
from tests.campaigns.imports import import_campaign
from tests.campaigns.improvement import PARTS as IMPROVEMENTS, improvement_campaign
from tests.campaigns.kinds import kind_campaign
from tests.campaigns.lanes import judge_lane_steps, judge_lanes
from tests.campaigns.library_defects import MECHANISMS, library_defect_campaign
from tests.campaigns.links import link_campaign
from tests.campaigns.longer_strokes import stroke_campaign
from tests.campaigns.monkey import monkey_campaign
from tests.campaigns.motion import sweep_campaign
from tests.campaigns.nine_points import nine_point_campaign
from tests.campaigns.orders import order_campaign
from tests.campaigns.poses import pose_campaign
from tests.campaigns.positions import library_positions, random_position
from tests.campaigns.precision_points import precision_campaign
from tests.campaigns.processors import processor_campaign
from tests.campaigns.radii import radius_campaign
from tests.campaigns.roots import root_campaign
from tests.campaigns.steps import judge_steps
from tests.campaigns.study import study_campaign
from tests.campaigns.switching_motions import switching_campaign
from tests.campaigns.whole_motions import EVERY as MOTIONS, whole_motion_campaign
from tests.campaigns.workbooks import workbook_campaign

__all__ = ["CAMPAIGNS", "WHOLE", "Report", "run"]

_PART = 50
# every length of train and every mechanism is a part; tasks of poses are solved many at a time
_OWN_PART = {
    "commands": 1,
    "extremes": 10,
    "goals": 1,
    "gradients": 1,
    "improve": 1,
    "library-defects": 1,
    "nine-points": 1,
    "orders": 20,
    "parallel-trains": 1,
    "poses": 1000,
    "precision-points": 4,
    "strokes": 1,
    "whole-motions": 1,
}
#: Mechanisms in random order, so that a smaller campaign is a sample of all of them.
_GRADIENTS = np.random.default_rng(20).permutation(EVERY)


@dataclass(frozen=True)
class Report:
    """Counts and false claims of one campaign."""

    counts: Counter[str]
    false: tuple[str, ...]
    seconds: float


def _certificates(part: int) -> tuple[Counter[str], list[str]]:
    first = part * _PART
    random = [random_position(k) for k in range(first, first + _PART - 10)]
    verdict = judge([*random, *library_positions(10, part)], part)
    return verdict.counts, verdict.false


def _steps(part: int) -> tuple[Counter[str], list[str]]:
    verdict = judge_steps(_PART, part)
    return verdict.counts, verdict.false


def _lanes(part: int) -> tuple[Counter[str], list[str]]:
    tables = range(part * _PART, (part + 1) * _PART)
    verdict = judge_lanes(tables, part, thorough=16)
    verdict.add(judge_lane_steps(tables, part))
    return verdict.counts, verdict.false


def _motion(part: int) -> tuple[Counter[str], list[str]]:
    tally = sweep_campaign(range(part * _PART, (part + 1) * _PART))
    return tally.counts, tally.wrong


def _configurations(part: int) -> tuple[Counter[str], list[str]]:
    return configuration_campaign(part, _PART)


def _circuits(part: int) -> tuple[Counter[str], list[str]]:
    return circuit_campaign(part, _PART)


def _dead_points(part: int) -> tuple[Counter[str], list[str]]:
    return dead_point_campaign(part, _PART)


def _random_trains(part: int) -> tuple[Counter[str], list[str]]:
    return random_train_campaign(part, _PART)


def _parallel_trains(part: int) -> tuple[Counter[str], list[str]]:
    return parallel_train_campaign(part, len(CASES))


def _kinds(part: int) -> tuple[Counter[str], list[str]]:
    return kind_campaign(part, _PART)


def _forces(part: int) -> tuple[Counter[str], list[str]]:
    return force_campaign(part, _PART)


def _extremes(part: int) -> tuple[Counter[str], list[str]]:
    return extreme_campaign(part, _OWN_PART["extremes"])


def _links(part: int) -> tuple[Counter[str], list[str]]:
    return link_campaign(part, _PART)


def _imports(part: int) -> tuple[Counter[str], list[str]]:
    return import_campaign(part, _PART)


def _orders(part: int) -> tuple[Counter[str], list[str]]:
    return order_campaign(part, _OWN_PART["orders"])


def _radii(part: int) -> tuple[Counter[str], list[str]]:
    return radius_campaign(part, _PART)


def _precision_points(part: int) -> tuple[Counter[str], list[str]]:
    return precision_campaign(part, _OWN_PART["precision-points"])


def _poses(part: int) -> tuple[Counter[str], list[str]]:
    return pose_campaign(part, _OWN_PART["poses"])


def _roots(part: int) -> tuple[Counter[str], list[str]]:
    return root_campaign(part, _PART)


def _defects(part: int) -> tuple[Counter[str], list[str]]:
    return defect_campaign(part, _PART)


def _switching(part: int) -> tuple[Counter[str], list[str]]:
    return switching_campaign(part, _PART)


def _gradients(part: int) -> tuple[Counter[str], list[str]]:
    return gradient_campaign(int(_GRADIENTS[part % EVERY]))


#: What one part does, and how many things the whole campaign looks at.
CAMPAIGNS: dict[str, tuple[Callable[[int], tuple[Counter[str], list[str]]], int]] = {
    "certificates": (_certificates, 10_000),
    "radii": (_radii, 6_200),
    "steps": (_steps, 1_000),
    "lanes": (_lanes, 1_000),
    "motion": (_motion, 10_000),
    "configurations": (_configurations, 450),
    "circuits": (_circuits, 500),
    "dead-points": (_dead_points, 1_000),
    "trains": (_random_trains, 500),
    "parallel-trains": (_parallel_trains, 40),
    "roots": (_roots, 2_000),
    "kinds": (_kinds, 100_000),
    "links": (_links, 100_000),
    "imports": (_imports, 80_000),
    "forces": (_forces, 2_000),
    "switching-motions": (_switching, 2_000),
    "orders": (_orders, 2_000),
    "extremes": (_extremes, 2_000),
    "precision-points": (_precision_points, 200),
    "nine-points": (nine_point_campaign, 100),
    "poses": (_poses, 100_000),
    "defects": (_defects, 10_000),
    "library-defects": (library_defect_campaign, len(MECHANISMS)),
    "goals": (goal_campaign, 4 * len(MECHANISMS)),
    "gradients": (_gradients, EVERY),
    "improve": (improvement_campaign, IMPROVEMENTS),
    "strokes": (stroke_campaign, len(MECHANISMS)),
    "whole-motions": (whole_motion_campaign, MOTIONS),
    "commands": (command_campaign, COMMANDS),
}
#: Those that share the cores themselves: what does the whole campaign, and its usual size.
WHOLE: dict[str, tuple[Callable[[int], tuple[Counter[str], list[str]]], int]] = {
    "families": (family_campaign, 1_000_000),
    "study": (study_campaign, 1_000_000),
    "workbooks": (workbook_campaign, 100),
    "fuzz": (fuzz_campaign, 100_000),
    "monkey": (monkey_campaign, 10_000),
    "processors": (processor_campaign, 6),  # pairs of kernel and SIMD level
}


def run(
    name: str, count: int | None = None, progress: Callable[[int, int], None] | None = None
) -> Report:
    """Run a campaign on all cores; ``count`` replaces its usual size.

    ``progress`` is called with the number of finished parts and of all parts.
    """
    begin = perf_counter()
    if name in WHOLE:
        whole, usual = WHOLE[name]
        counts, false = whole(count or usual)
        return Report(counts, tuple(false), perf_counter() - begin)
    work, usual = CAMPAIGNS[name]
    part = _OWN_PART.get(name, _PART)
    parts = range(-(-(count or usual) // part))
    counts, false = Counter(), []
    with ProcessPoolExecutor() as pool:
        for done, (part_counts, part_false) in enumerate(pool.map(work, parts), start=1):
            counts += part_counts
            false += part_false
            if progress is not None:
                progress(done, len(parts))
    return Report(counts, tuple(false), perf_counter() - begin)
