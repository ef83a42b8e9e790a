"""Which loops are written for a mechanism of points and links, and how they are solved."""

from __future__ import annotations

import pytest

import linkwork as lw
from tests.core.equations.linkages import LINKAGES

POINTS = {
    "A": (0, 0), "B": (0, 1), "C": (3, 2), "D": (2.5, 0), "E": (2, 3), "F": (5.5, 2.6),
    "G": (5, 0.2), "H": (7, 3), "K": (8, 0),
}  # fmt: skip
FOUR_BAR = {"ground": "A D", "crank": "A B", "coupler": "B C", "rocker": "D C"}
GRAPHS: dict[str, dict[str, str]] = {
    "four-bar": FOUR_BAR,
    "Watt": FOUR_BAR | {"ground": "A D G", "rocker": "D C E", "rod": "E F", "out": "G F"},
    "Stephenson": FOUR_BAR | {"ground": "A D G", "coupler": "B C E", "rod": "E F", "out": "G F"},
    "Stephenson from the far crank": {
        "ground": "A D G",
        "left": "A B",
        "coupler": "B C E",
        "rocker": "D C",
        "rod": "E F",
        "crank": "G F",
    },
    "pin of three links": FOUR_BAR | {"ground": "A D G", "rod": "C F", "out": "G F"},
    "double butterfly": {
        "ground": "A B C",
        "crank": "B G",
        "wing": "A D E",
        "left": "G F H",
        "right": "F K L",
        "rod1": "C K",
        "rod2": "D H",
        "rod3": "E L",
    },
}
#: Labels of the loops, then the unknowns of each block.
WANTED: dict[str, tuple[list[str], list[str]]] = {
    "four-bar": (["A B C D"], ["coupler rocker"]),
    "Watt": (["A B C D", "D E F G"], ["coupler rocker", "rod out"]),
    "Stephenson": (["A B C D", "A B E F G"], ["coupler rocker", "rod out"]),
    "Stephenson from the far crank": (
        ["A B C D", "D C E F G"],
        ["left coupler rocker rod"],
    ),
    "pin of three links": (["A B C D", "D C F G"], ["coupler rocker", "rod out"]),
}


def built(graph: dict[str, str], **more: object) -> lw.Mechanism:
    links = {name: tuple(points.split()) for name, points in graph.items()}
    used = {p for points in links.values() for p in points}
    points = {n: xy for n, xy in {**POINTS, "L": (6, 4)}.items() if n in used}
    inputs = more.pop("inputs", (lw.Input(link="crank"),))
    return lw.linkage(points=points, links=links, inputs=inputs, **more)


@pytest.mark.parametrize("name", WANTED)
def test_loops_and_blocks_of_known_graphs(name: str) -> None:
    labels, blocks = WANTED[name]
    report = built(GRAPHS[name]).check()
    assert list(report.loops) == labels
    assert [" ".join(block.unknowns) for block in report.blocks] == blocks
    assert [e for block in report.blocks for e in block.equations] == labels
    assert report.mobility_count == 1


def test_double_butterfly_is_one_block_of_three_shortest_loops() -> None:
    report = built(GRAPHS["double butterfly"]).check()
    # of its four loops of five links any three are independent, every other loop is longer
    assert len(report.loops) == 3
    assert all(len(label.split()) == 5 for label in report.loops)
    (block,) = report.blocks
    assert block.unknowns == ("wing", "left", "right", "rod1", "rod2", "rod3")
    assert report.mobility_count == 1


def test_jansen_leg_is_three_dyads() -> None:
    report = lw.example("jansen-leg").check()
    assert report.loops == ("O A B P", "O A C P", "P C E D")
    assert [block.unknowns for block in report.blocks] == [
        ("upper_rod", "upper_triangle"),
        ("lower_rod", "lower_rocker"),
        ("coupler", "foot"),
    ]
    assert (report.mobility_count, report.mobility_rank) == (1, 1)


def test_jansen_leg_driven_at_the_foot_couples_its_loops() -> None:
    changed = lw.example("jansen-leg").changed(inputs=(lw.Input(link="foot"),))
    sizes = [len(block.unknowns) for block in changed.check().blocks]
    assert sum(sizes) == 6
    assert max(sizes) == 6


@pytest.mark.parametrize("count", [1, 2, 30])
def test_a_chain_of_four_bars_is_solved_one_by_one(count: int) -> None:
    points: dict[str, tuple[float, float]] = {"A0": (0, 0), "B0": (0.2, 1)}
    links: dict[str, tuple[str, ...]] = {"L0": ("A0", "B0")}
    for k in range(1, count + 1):
        points |= {f"A{k}": (3.0 * k, 0), f"B{k}": (3.0 * k + 0.2, 1)}
        links |= {f"C{k}": (f"B{k - 1}", f"B{k}"), f"L{k}": (f"A{k}", f"B{k}")}
    links["ground"] = tuple(f"A{k}" for k in range(count + 1))
    report = lw.linkage(points=points, links=links, inputs=(lw.Input(link="L0"),)).check()
    assert list(report.loops) == [f"A{k} B{k} B{k + 1} A{k + 1}" for k in range(count)]
    wanted = [(f"C{k}", f"L{k}") for k in range(1, count + 1)]
    assert [block.unknowns for block in report.blocks] == wanted


@pytest.mark.parametrize(
    ("name", "unknowns"),
    [
        ("slider of one point", ["rod s"]),
        ("slider of two points", ["rod s"]),
        ("slider on a moving link", ["lever s"]),
        ("slot on ground", ["rod s"]),
        ("slot on a moving link", ["lever s"]),
        ("cylinder as input", ["boom ram_angle"]),
        ("cylinder that follows", ["ram_angle ram"]),
        ("slider as input", ["crank rod"]),
        ("link against link", ["crank coupler rocker"]),
        ("joint as input", ["crank coupler rocker"]),
    ],
)
def test_unknowns_are_link_angles_and_slider_lengths(name: str, unknowns: list[str]) -> None:
    report = LINKAGES[name]().check()
    assert [" ".join(block.unknowns) for block in report.blocks] == unknowns
    assert (report.mobility_count, report.mobility_rank) == (1, 1)


def message(graph: dict[str, str], **more: object) -> str:
    with pytest.raises(lw.MechanismError) as raised:
        built(graph, **more)
    return str(raised.value)


def both(*names: str) -> tuple[lw.Input, ...]:
    return tuple(lw.Input(link=name) for name in names)


TOO_FEW = [
    (
        FOUR_BAR,
        (),
        'one degree of freedom has no input: add an input, for example link = "crank" '
        "(free to move: crank, rocker, coupler)",
    ),
    (
        FOUR_BAR | {"coupler": "B C E", "tail": "E F"},
        both("crank"),
        "one degree of freedom has no input: add an input or a link (free to move: tail)",
    ),
    (
        FOUR_BAR | {"coupler": "B C E", "tail": "E F", "tip": "F G"},
        both("crank"),
        "2 degrees of freedom have no input: add 2 inputs or a link (free to move: tail, tip)",
    ),
]
TOO_MANY = [
    (
        FOUR_BAR,
        both("crank", "rocker"),
        "1 condition too many: remove an input or a link among crank, rocker, coupler "
        "(as assembled it has 1 degree of freedom for 2 inputs)",
    ),
    (
        FOUR_BAR | {"rod": "B D"},
        both("crank"),
        "1 condition too many: remove an input or a link among crank, rod "
        "(as assembled it has 0 degrees of freedom for 1 input)",
    ),
    (
        FOUR_BAR | {"rod": "B D"},
        both("crank", "rocker"),
        "2 conditions too many: remove an input or a link among crank, rocker, rod, coupler "
        "(as assembled it has 0 degrees of freedom for 2 inputs)",
    ),
]


@pytest.mark.parametrize(("graph", "inputs", "wanted"), TOO_FEW)
def test_too_few_inputs_name_the_links_that_stay_free(
    graph: dict[str, str], inputs: tuple[lw.Input, ...], wanted: str
) -> None:
    assert message(graph, inputs=inputs) == f'1 problem in mechanism "mechanism"\n  input  {wanted}'


@pytest.mark.parametrize(("graph", "inputs", "wanted"), TOO_MANY)
def test_too_many_conditions_name_the_links_that_are_tied(
    graph: dict[str, str], inputs: tuple[lw.Input, ...], wanted: str
) -> None:
    assert message(graph, inputs=inputs) == f'1 problem in mechanism "mechanism"\n  links  {wanted}'


def test_one_part_too_free_and_another_too_tied_are_reported_together() -> None:
    graph = FOUR_BAR | {"ground": "A D G", "rod": "B D", "pendulum": "G H"}
    assert message(graph, name="mixed") == (
        '2 problems in mechanism "mixed"\n'
        "  input  one degree of freedom has no input: "
        "add an input or a link (free to move: pendulum)\n"
        "  links  1 condition too many: remove an input or a link among crank, rod"
    )


LOOPS = {
    "name": "one loop",
    "dimensions": {"a": 1, "b": 3},
    "inputs": (lw.Input(variable="θ2"),),
}


@pytest.mark.parametrize(
    ("loops", "guess", "wanted"),
    [
        (
            {"1": "a*e^(i*θ2) + b*e^(i*θ3) - d*e^(i*θ4) = 0"},
            {"θ2": 30, "θ3": 0, "θ4": 10, "d": 3},
            "loops  1 unknown too many for the equations: "
            "add an equation or an input (not determined: θ3, θ4, d)",
        ),
        (
            {"1": "a*e^(i*θ2) + b*e^(i*θ3) - d = 0", "2": "a*e^(i*θ3) + b = d"},
            {"θ2": 30, "θ3": 0, "d": 3},
            'loops  2 equations too many: "1", "2" together contain only θ3, d; '
            "remove an equation or an input",
        ),
    ],
)
def test_loops_that_do_not_fit_their_unknowns_say_which(
    loops: dict[str, str], guess: dict[str, float], wanted: str
) -> None:
    with pytest.raises(lw.MechanismError) as raised:
        lw.loops(loops=loops, guess=guess, **LOOPS)
    assert str(raised.value) == f'1 problem in mechanism "one loop"\n  {wanted}'


def test_plain_equations_that_do_not_fit_their_unknowns_say_which() -> None:
    with pytest.raises(lw.MechanismError) as raised:
        lw.plain_equations(equations={"F": "x + y = 1"}, guess={"x": 0, "y": 0})
    assert str(raised.value) == (
        '1 problem in mechanism "mechanism"\n'
        "  equations  1 unknown too many for the equations: "
        "add an equation or an input (not determined: x, y)"
    )
    with pytest.raises(lw.MechanismError) as raised:
        lw.plain_equations(equations={"F": "x = 1", "G": "x^2 = 2"}, guess={"x": 0})
    assert str(raised.value) == (
        '1 problem in mechanism "mechanism"\n'
        '  equations  1 equation too many: "F", "G" together contain only x; '
        "remove an equation or an input"
    )


def test_loops_that_cannot_close_name_the_gap_that_remains() -> None:
    mechanism = lw.linkage(
        name="short",
        points={"O": (0, 0), "A": (0, 1), "B": (4, 2), "C": (10, 0)},
        links={"ground": ("O", "C"), "crank": ("O", "A"), "rod": ("A", "B"), "rocker": ("C", "B")},
        lengths={"O A": 1, "A B": 4, "C B": 2},
        inputs=(lw.Input(link="crank"),),
    )
    position = mechanism.solve(0, from_guess=True)
    assert position.status is lw.Status.CANNOT_CLOSE
    # from A = (1, 0) to C = (10, 0) rod and rocker reach 6 of 9
    assert position.message == (
        'loop "O A B C" cannot be closed at crank = 0°: near the guess a gap of at least 3 mm '
        'remains; the loops just close with "O A" = 4 mm (3 longer) or "A B" = 7 mm (3 longer) or '
        '"C B" = 5 mm (3 longer); no input value was '
        "found at which the mechanism can be assembled; "
        "no configuration exists there"
    )
