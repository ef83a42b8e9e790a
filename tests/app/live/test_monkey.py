"""Random actions at the live page leave page and file in agreement."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest

from tests.campaigns.monkey import monkey_at

pytestmark = pytest.mark.extended


def test_page_and_file_agree_after_random_actions(browser: Any) -> None:
    counts: Counter[str] = Counter()
    assert list(monkey_at(browser, range(6, 10), counts)) == []
    assert counts["actions"] == 200
