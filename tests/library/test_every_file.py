"""Every file of the library has a law, a source and a family, and proves what it reaches."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from importlib import import_module
from pathlib import Path

import pytest

import linkwork as lw
from linkwork.core.foundation.statuses import Certification
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.textfile.keys import json_schema
from tests.library.laws import LAWS, motion_of
from tests.library_mechanisms import driven_examples, read_example

MODULES = [
    import_module(f"tests.library.{path.stem}")
    for path in sorted(Path(__file__).parent.glob("test_*.py"))
    if path != Path(__file__)
]
#: Tables that a file of points and links may repeat, by its published schema; inputs are another,
#: questions are no parts, and stops join nothing.
JOINT_TABLES = [
    table
    for table, entry in json_schema()["$defs"]["points_and_links"]["properties"].items()
    if entry.get("type") == "array" and table not in ("questions", "stops")
]
DRIVEN = driven_examples()


def test_every_mechanism_has_a_law() -> None:
    assert set(lw.examples()) - set(LAWS) == set()


def test_every_law_belongs_to_a_mechanism() -> None:
    assert set(LAWS) - set(lw.examples()) == set()


@pytest.mark.parametrize("name", lw.examples())
def test_every_mechanism_tells_its_source_and_family(name: str) -> None:
    description = read_example(name).description
    assert len(description.source) > 20
    assert re.fullmatch(r"[A-Z][^.]{20,140}\.", description.purpose)  # one sentence
    assert description.family
    assert description.name != "mechanism"


@pytest.mark.parametrize("kind", ["pins", *JOINT_TABLES])
def test_every_kind_of_joint_works_in_two_mechanisms(kind: str) -> None:
    """A joint is a table of the file format that may be repeated, or a pin: a shared point."""
    found = []
    for name in lw.examples():
        linkage = read_example(name).description
        if isinstance(linkage, Linkage):
            pinned = any(len(bodies) > 1 for bodies in linkage.carriers().values())
            found += [name] if (pinned if kind == "pins" else getattr(linkage, kind)) else []
    assert len(found) >= 2, found


def test_the_gallery_shows_every_mechanism() -> None:
    """After a change of the library: ``scripts/gallery``."""
    docs = Path(__file__).parents[2] / "docs"
    page = (docs / "gallery.md").read_text(encoding="utf-8")
    assert [name for name in lw.examples() if f"(`{name}`)" not in page] == []
    assert [name for name in lw.examples() if _purpose(name) not in page] == []
    pictures = {path.stem: path for path in (docs / "images" / "gallery").iterdir()}
    assert set(pictures) <= set(lw.examples())
    assert [name for name in pictures if f"gallery/{name}.svg" not in page] == []
    assert len(pictures) > 50
    for path in pictures.values():
        text = path.read_text(encoding="utf-8")
        assert ElementTree.fromstring(text).tag == "{http://www.w3.org/2000/svg}svg"
        assert len(text) < 40_000
        assert "var(" not in text  # programs other than browsers do not know it


def _purpose(name: str) -> str:
    return read_example(name).description.purpose


@pytest.mark.parametrize("name", DRIVEN)
def test_every_row_that_is_found_is_proved(name: str) -> None:
    motion = motion_of(name)
    assert motion.found.any()
    proved = Certification.SUBSET_CERTIFIED if motion.redundant else Certification.CERTIFIED
    assert {c for c, found in zip(motion.certification, motion.found, strict=True) if found} == {
        proved
    }
    assert all(gap <= 1e-12 for gap in motion.redundant.values())
