"""A small part of the campaign of families; scripts/campaign families has the rest."""

from __future__ import annotations

import pytest

from tests.campaigns import families, kinds
from tests.campaigns.motion import FAMILIES


def test_random_four_bars_stay_on_their_branch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(families, "_CHUNK", 300)  # starts at one input, then at many
    counts, false = families.family_campaign(600)
    assert not false
    assert counts["mechanisms"] == 600
    assert counts["near a change point"] > 40
    assert counts["row CERTIFIED"] > 0.9 * counts["rows found"]


@pytest.mark.extended
@pytest.mark.parametrize("part", range(len(FAMILIES)), ids=FAMILIES)
def test_random_designs_of_every_kind_stay_on_their_branch(part: int) -> None:
    counts, false = kinds.kind_campaign(part, 20)
    assert not false
    assert counts["mechanisms"] == 20
    assert counts["row CERTIFIED"] > 0.9 * counts["rows found"] > 0


@pytest.mark.parametrize("part", range(len(FAMILIES)), ids=FAMILIES)
def test_few_random_designs_stay_on_their_branch(part: int) -> None:
    counts, false = kinds.kind_campaign(part, 4, 4)
    assert not false
    assert counts["row CERTIFIED"] > 0.9 * counts["rows found"] > 0


@pytest.mark.parametrize("part", [7, 25, 49])
def test_without_proofs_no_design_leaves_its_branch(part: int) -> None:
    """Slider-cranks of which one would leave its branch if only convergence were asked for."""
    counts, false = kinds.kind_campaign(part, 8, 4, certify=False)
    assert not false
    assert counts["branch changes"] == 0
    assert counts["rows found"] > 300
