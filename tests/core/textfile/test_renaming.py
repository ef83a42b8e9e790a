"""New names and copies in a file: every reference follows, and the motion is the same."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import canonical
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.textfile.reader import example_text
from linkwork.core.textfile.writer import TextEdits
from linkwork.design.edits.entries import copy_selection, mirror_numbers, rename

TRIED = [
    "excavator",
    "cam-roller-follower",
    "planetary-gear",
    "rack-and-pinion",
    "rapier-drive",
]


@pytest.mark.parametrize("name", TRIED)
def test_with_other_names_a_mechanism_is_the_same(name: str) -> None:
    text = example_text(name)
    before, edits = lw.loads(text), TextEdits(text)
    for k, point in enumerate(edits.keys(("points",))):
        rename(edits, "point", point, f"new{k}")
    for k, link in enumerate(x for x in edits.keys(("links",)) if x != "ground"):
        rename(edits, "link", link, f"body{k}")
    for k, part in enumerate(p for p in getattr(before.description, "parts", ()) if p.names):
        rename(edits, "part", part.names[0], f"part{k}_")
    after = lw.loads(edits.text)
    assert not set(after.description.points) & set(before.description.points)  # type: ignore[attr-defined]
    old, new = before.solve(), after.solve()
    np.testing.assert_allclose(list(new.points.values()), list(old.points.values()), atol=1e-12)
    assert [new[o] for o in after.description.outputs] == pytest.approx(
        [old[o] for o in before.description.outputs]
    )


def test_comments_and_the_order_of_keys_stay() -> None:
    edits = TextEdits('[points]\nA  = [0, 0] # pivot\nB = [1, 0]\n\n[lengths]\n"A B" = 1 # rod\n')
    rename(edits, "point", "A", "O2")
    assert edits.text == (
        '[points]\nO2  = [0, 0] # pivot\nB = [1, 0]\n\n[lengths]\n"O2 B" = 1 # rod\n'
    )


@pytest.mark.parametrize(
    ("of", "name", "new", "message"),
    [
        ("point", "A", "B", '"B" is the name of a point already: choose another'),
        ("point", "A", "crank", '"crank" is the name of a link already: choose another'),
        ("point", "A", "2x", '"2x" cannot be a name'),
        ("point", "A", "sin", '"sin" cannot be a name'),
        ("point", "A", "", '"" cannot be a name'),
        ("link", "crank", "ground", '"ground" cannot be a name'),
        ("link", "ground", "base", '"ground" is the name of the fixed link in every file'),
        ("link", "A", "x", 'there is no link "A"'),
        ("part", "s", "x", 'there is no part "s"'),
    ],
)
def test_a_name_that_cannot_be_is_refused(of: str, name: str, new: str, message: str) -> None:
    edits = TextEdits(example_text("four-bar"))
    with pytest.raises(InputError) as caught:
        rename(edits, of, name, new)
    assert message in str(caught.value)
    assert edits.text == example_text("four-bar")


def test_a_copy_has_the_dimensions_parts_and_ground_of_its_original() -> None:
    edits = TextEdits(example_text("slider-crank-engine"))
    points = edits.keys(("points",))
    links = [link for link in edits.keys(("links",)) if link != "ground"]
    names = {name: f"{name}_2" for name in [*points, *links]}
    for point in points:
        x, y = edits.get(("points", point))
        edits.put(("points", names[point]), [x + 500, y])
    copy_selection(edits, names, mirrored=False)
    edits.append("input", {**next(edits.entries("input"))[1], "link": "crank_2"})
    both = lw.loads(edits.text).sweep()
    one = lw.loads(example_text("slider-crank-engine")).sweep()
    for point in points:
        np.testing.assert_allclose(both[f"{point}_2.x"] - 500, one[f"{point}.x"], atol=1e-9)
        np.testing.assert_allclose(both[f"{point}_2.y"], one[f"{point}.y"], atol=1e-9)


MIRRORED = ["four-bar", "excavator", "rack-and-pinion", "windscreen-wiper", "geneva-drive"]


@pytest.mark.parametrize("name", MIRRORED)
def test_a_mirrored_mechanism_moves_as_in_a_mirror(name: str) -> None:
    text = example_text(name)
    before, edits = lw.loads(text), TextEdits(text)
    mirror_numbers(edits, {canonical(point) for point in edits.keys(("points",))})
    for point, place in before.solve().points.items():
        edits.put(("points", point), [place[0], -place[1]])
    for which in before.description.inputs:
        if which.link or which.joint:
            k = before.description.inputs.index(which)
            for key, number in (("from", which.from_), ("to", which.to), ("step", which.step)):
                if number is not None:
                    edits.put(("input", k, key), -before.description.numbers(number))
    old, new = before.sweep(), lw.loads(edits.text).sweep()
    for point in before.solve().points:
        np.testing.assert_allclose(new[f"{point}.x"], old[f"{point}.x"], atol=1e-6)
        np.testing.assert_allclose(new[f"{point}.y"], -old[f"{point}.y"], atol=1e-6)


def test_a_cam_is_not_mirrored_wrongly() -> None:
    edits = TextEdits(example_text("cam-roller-follower"))
    with pytest.raises(InputError, match=r"\(cam\) cannot be mirrored"):
        mirror_numbers(edits, {canonical(point) for point in edits.keys(("points",))})


def test_masses_and_formulas_of_loads_follow_a_name() -> None:
    edits = TextEdits(example_text("crank-press"))
    rename(edits, "link", "ram", "plunger")
    rename(edits, "part", "height", "h")
    press = lw.loads(edits.text).description
    assert isinstance(press, Linkage)
    assert list(press.masses) == ["crank", "rod", "plunger"]
    assert press.loads[0].link == "plunger"
    assert press.loads[0].force == (0, "20000*(h < 160)*(h.velocity < 0)")


def test_something_without_a_name_is_not_renamed() -> None:
    edits = TextEdits("[points]\nO2 = [0, 0]\n")
    with pytest.raises(InputError, match="choose a point, link or part"):
        rename(edits, "O2", "O2", "Q")
    assert edits.text == "[points]\nO2 = [0, 0]\n"
