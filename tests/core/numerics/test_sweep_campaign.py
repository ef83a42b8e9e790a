"""Whole cycles of random mechanisms: no row is on another branch, every row found is proved."""

from __future__ import annotations

import pytest

from tests.campaigns.motion import sweep_campaign
from tests.thinned import thinned


@pytest.mark.parametrize("part", thinned(range(40), 40))
def test_random_mechanisms_keep_their_branch_at_steps_of_1_10_and_60_degrees(part: int) -> None:
    tally = sweep_campaign(range(part * 25, part * 25 + 25), plain=False)
    assert tally.wrong == []
    assert tally.counts["mechanisms"] == 25
    assert tally.counts["branch changes"] == 0
    if part == 0:  # not every 25 mechanisms hold one
        assert tally.counts["near a change point"] > 0
    # rows without a certificate have no position: dead points and what lies beyond them
    assert tally.counts["row CERTIFIED"] == tally.counts["rows found"] > 1500
    assert tally.counts["row NO_POSITION"] == tally.counts["rows"] - tally.counts["rows found"]


@pytest.mark.extended
def test_plain_newton_changes_branch_where_certified_sweeps_do_not() -> None:
    # 60° steps: the campaign's numbers 12 to 17 modulo 18
    numbers = [k for k in range(270) if k % 18 in (12, 13, 15, 16)]
    changed = 0
    for number in numbers:
        tally = sweep_campaign(range(number, number + 1))
        assert tally.wrong == []
        changed += tally.counts["plain Newton: mechanisms that change branch"]
    assert changed > 3
