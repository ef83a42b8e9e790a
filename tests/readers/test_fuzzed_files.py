"""Whatever a file of another program contains, it is a linkage or refused with a message."""

from __future__ import annotations

from linkwork.readers.importing import FORMATS
from tests.campaigns.imports import import_campaign


def test_no_damaged_file_causes_a_foreign_exception() -> None:
    count = 20 * len(FORMATS)
    counts, false = import_campaign(0, count)
    assert not false
    assert counts["files read"] > count / 10
    assert counts["calls refused with a message"] > count / 10
