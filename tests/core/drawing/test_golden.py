"""Ten drawings are what they were when they were last looked at; ``scripts/golden`` renews them."""

from __future__ import annotations

import numpy as np
import pytest

from tests.core.drawing.golden_form import FOLDER, GOLDEN, drawn, read

LINE = 0.02  # of a point on the page: two numbers rounded to hundredths
TEXT = 1.0  # of a point: a font of another version is as wide, about


@pytest.mark.parametrize("name", GOLDEN)
def test_a_drawing_is_the_one_that_was_looked_at(name: str) -> None:
    now, then = read(drawn(name)), read((FOLDER / f"{name}.svg").read_text(encoding="utf-8"))
    assert [(s.name, s.text) for s in now] == [(s.name, s.text) for s in then]
    for one, other in zip(now, then, strict=True):
        assert len(one.points) == len(other.points), one.name
        atol = TEXT if one.text else LINE
        np.testing.assert_allclose(one.points, other.points, rtol=0, atol=atol, err_msg=one.name)


def test_every_golden_file_is_compared() -> None:
    assert sorted(path.stem for path in FOLDER.glob("*.svg")) == sorted(GOLDEN)


def test_golden_drawings_hold_lines_and_texts() -> None:
    for name in GOLDEN:
        shapes = read((FOLDER / f"{name}.svg").read_text(encoding="utf-8"))
        roles = {shape.name.partition(":")[0] for shape in shapes}
        assert {"label", "pin", "input"} & roles >= {"label", "input"}, name
        assert any(len(shape.points) > 1 for shape in shapes), name
