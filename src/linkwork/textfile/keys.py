"""All tables and keys of a mechanism file, defined in one place.

The reader's checks (:mod:`~linkwork.textfile.structure`) and the published JSON Schema
(:mod:`~linkwork.textfile.schema`) are both generated from :data:`FORMS`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from linkwork.mechanism.motion_laws import LAWS

__all__ = [
    "EQUATIONS", "FORMAT", "FORMS", "LINKAGE", "LOOPS",
    "Constant", "Flag", "Form", "Formula", "Key", "Kind", "ListOf", "Named", "Number",
    "PlainNumber", "Several", "Speed", "Table", "Tables", "Text", "Whole", "form_of",
]  # fmt: skip

#: The version of the file format that this package reads and writes.
FORMAT = 1


@dataclass(frozen=True)
class Constant:
    """The one whole number allowed."""

    number: int


@dataclass(frozen=True)
class Text:
    """Text, or one of a few words; ``of`` is what it names: a point, link or slider."""

    words: tuple[str, ...] = ()
    of: str = ""


@dataclass(frozen=True)
class Number:
    """A number, or a formula of the named dimensions."""


@dataclass(frozen=True)
class PlainNumber:
    """A number; no formula."""


@dataclass(frozen=True)
class Whole:
    """A whole number within bounds."""

    least: int
    most: int = 2**53


@dataclass(frozen=True)
class Formula:
    """A formula in quotes; with ``equation`` it has an equals sign."""

    equation: bool = False


@dataclass(frozen=True)
class Speed:
    """A number, or text with a unit: ``"300 rpm"``."""


@dataclass(frozen=True)
class Flag:
    """true or false."""


@dataclass(frozen=True)
class ListOf:
    """A list; ``noun`` is what one entry is called in messages."""

    of: Kind
    noun: str
    least: int = 0
    most: int | None = None


@dataclass(frozen=True)
class Table:
    """A table whose keys are known."""

    keys: tuple[Key, ...]


@dataclass(frozen=True)
class Tables:
    """A list of tables, ``[[slots]]``; with ``single`` one plain ``[input]`` will do."""

    keys: tuple[Key, ...]
    single: bool = False


@dataclass(frozen=True)
class Named:
    """A table whose keys the author chooses; each key has ``words`` words."""

    of: Kind
    words: int = 1


@dataclass(frozen=True)
class Several:
    """One number, a list of numbers, or a table; ``wanted`` says so in a message."""

    many: ListOf
    table: Table
    wanted: str


Kind = (
    Constant
    | Text
    | Number
    | PlainNumber
    | Whole
    | Formula
    | Speed
    | Flag
    | ListOf
    | Table
    | Tables
    | Named
    | Several
)


@dataclass(frozen=True)
class Key:
    """One key: its name, what may stand there, and one line for people."""

    name: str
    kind: Kind
    doc: str
    required: bool = False


@dataclass(frozen=True)
class Form:
    """A kind of file: its keys, and the table ``marker`` that tells it from others, if any."""

    title: str
    doc: str
    marker: str
    keys: tuple[Key, ...]

    @property
    def definition(self) -> str:
        """Its name among the definitions of the JSON Schema."""
        return self.title.replace("-", "_").replace(" ", "_")


_POINT, _LINK, _SLIDING = Text(of="point"), Text(of="link"), Text(of="slider")
_NAME_LIST = ListOf(Text(), "name")
_POINT_PAIR = ListOf(Text(), "point", 2, 2)

_HEAD = (
    Key(
        "format",
        Constant(FORMAT),
        "The version of this file format; write format = 1",
        required=True,
    ),
    Key("name", Text(), "Name of the mechanism"),
    Key("length", Text(), "Unit of every length in this file; nothing is converted"),
    Key("angle", Text(("deg", "rad")), "Unit of every angle in this file"),
    Key("source", Text(), "Where the mechanism comes from: book, page, drawing"),
    Key("family", Text(), 'The family in lists of mechanisms: "straight line", "engine"'),
    Key(
        "configuration",
        Text(),
        'The configuration or branch to start from instead of the guess: "crossed", '
        '"circuit 1 branch 2"',
    ),
)
_DIMENSIONS = Key(
    "dimensions", Named(Number()), "Named numbers and formulas, usable wherever a number is"
)
_OUTPUTS = Key(
    "outputs",
    Named(Formula()),
    "Named formulas of unknowns, dimensions and point coordinates (A.x)",
)
_TRACE = Key(
    "trace",
    Table((Key("points", _NAME_LIST, "Points whose path is drawn", required=True),)),
    "Traces in pictures",
)
_GUESS = Key(
    "guess",
    Named(Number()),
    "Estimates of all unknowns at one input value",
    required=True,
)
_RANGE = (
    Key("from", Number(), "First input value"),
    Key("to", Number(), "Last input value"),
    Key(
        "step",
        Number(),
        "Step between input values; its sign points from the first value to the last",
    ),
    Key(
        "speed",
        Speed(),
        'Speed of the input, "300 rpm"; a plain number is in file units per second',
    ),
)
_DRIVES = (
    Key("link", Text(), "The link whose angle is driven"),
    Key("relative_to", Text(), "The link relative to which the angle is measured; default ground"),
    Key("joint", Text(), "The pin whose relative angle is driven"),
    Key("slider", Text(), "The slider or slot whose displacement is driven"),
    Key("cylinder", Text(), "The cylinder whose length is driven"),
    *_RANGE,
)
_VARIABLE = (
    Key("variable", Text(), "The name in the equations that is driven", required=True),
    *_RANGE,
)
_SLOT = (
    Key("name", Text(), "Name of the displacement, zero at the first point of the line", True),
    Key("point", _POINT, "The pin: a point of another link", required=True),
    Key("on", _LINK, "The link with the slot", required=True),
    Key("line", _POINT_PAIR, "Two points of that link; positive from first to second", True),
)
_SLIDER = (
    Key("name", Text(), "Name of the displacement, zero at the first point of the line", True),
    Key("link", _LINK, "The link that slides without turning", required=True),
    Key(
        "points",
        ListOf(Text(), "point", 1, 2),
        "Two points of the sliding link on the line, or one point and angle",
        required=True,
    ),
    Key("on", _LINK, "The link along which it slides", required=True),
    Key("line", _POINT_PAIR, "Two points of that link; positive from first to second", True),
    Key("offset", Number(), "Distance of the points from the line, positive to its left"),
    Key("angle", Number(), "With one point: the angle from the line to the sliding link"),
)
_CYLINDER = (
    Key("name", Text(), "Name of the variable length", required=True),
    Key("between", _POINT_PAIR, "The two points it connects", required=True),
)

_SPRING = (
    Key("name", Text(), "Name of the spring", required=True),
    Key("between", _POINT_PAIR, "The two points it connects", required=True),
)

_NUMBER_PAIR = ListOf(Number(), "number", 2, 2)
_COORDINATES = ListOf(ListOf(Number(), "coordinate", 2, 2), "point", 3)
_WELD = (
    Key("links", ListOf(Text(), "link", 2, 2), "Two links that share a point", required=True),
    Key("angle", Number(), "From the first link's direction to the second's"),
)
_WHEELS = (
    Key("wheels", ListOf(Text(), "link", 2, 2), "The two links that turn", required=True),
    Key("centers", ListOf(Text(), "point", 2, 2), "The points at which they turn", required=True),
    Key("arm", _LINK, "The link with both centres; default ground"),
    Key("radii", _NUMBER_PAIR, "Pitch radii"),
    Key("teeth", _NUMBER_PAIR, "Numbers of teeth, instead of radii"),
    Key("phase", Number(), "Angle of the second wheel where the first one's is zero"),
)
_GEAR = (
    Key("name", Text(), "Name of the gear pair", required=True),
    *_WHEELS,
    Key("internal", Flag(), "The larger wheel is a ring around the smaller one"),
)
_BELT = (
    Key("name", Text(), "Name of the belt or chain", required=True),
    *_WHEELS,
    Key("crossed", Flag(), "The belt crosses itself: the wheels turn in opposite directions"),
)
_RACK = (
    Key("name", Text(), "Name of the rack and pinion", required=True),
    Key("pinion", _LINK, "The link that turns", required=True),
    Key("center", _POINT, "The point at which it turns", required=True),
    Key("slider", _SLIDING, "The slider of the rack", required=True),
    Key("radius", Number(), "Pitch radius of the pinion", required=True),
)
_ROLLING = (
    Key(
        "name",
        Text(),
        "Displacement of the point of contact along the line, or angle of the line of centres",
        True,
    ),
    Key("wheel", _LINK, "The link that rolls", required=True),
    Key("center", _POINT, "Its centre", required=True),
    Key("radius", Number(), "Its radius", required=True),
    Key("on", _LINK, "The link on which it rolls; default ground"),
    Key("line", _POINT_PAIR, "Two points of that link: it rolls along this line"),
    Key("circle", _POINT, "Or the centre of the circle on which it rolls"),
    Key("circle_radius", Number(), "The radius of that circle"),
    Key("inside", Flag(), "The smaller of wheel and circle is inside the larger one"),
)
_SEGMENT = (
    Key("law", Text(LAWS), "Motion law of the follower", required=True),
    Key("over", Number(), "Angle by which the cam turns", required=True),
    Key("lift", Number(), "Displacement of the follower, positive away from the centre"),
)
_CAM = (
    Key("name", Text(), "Name of the cam", required=True),
    Key("cam", _LINK, "The link that turns", required=True),
    Key("center", _POINT, "The point about which it turns", required=True),
    Key("slider", _SLIDING, "The slider that it moves"),
    Key("link", _LINK, "Or the oscillating link that it moves"),
    Key("pivot", _POINT, "With link: the point about which it oscillates"),
    Key(
        "point",
        _POINT,
        "With link: its knife edge, the centre of its roller or the end of its face",
    ),
    Key("contact", Text(("knife", "roller", "flat")), "Kind of the follower; default knife"),
    Key("radius", Number(), "Radius of the roller"),
    Key("base", Number(), "Radius of the base circle, with segments"),
    Key("start", Number(), "Angle of the cam at which the segments begin; default 0"),
    Key("segments", Tables(_SEGMENT), "Motion of the follower in one turn of the cam"),
    Key("profile", _COORDINATES, "Or the outline, in the cam's frame about its centre"),
)
_CURVE = (
    Key("name", Text(), "Name of the coordinate along the curve", required=True),
    Key("point", _POINT, "The point that moves along it, of another link", required=True),
    Key("on", _LINK, "The link with the curve", required=True),
    Key("origin", _POINT, "The point of that link from which coordinates are measured", True),
    Key("through", _COORDINATES, "Points of the curve in that link's own frame", required=True),
    Key("closed", Flag(), "Whether the curve is closed"),
)

LINKAGE = Form(
    "points-and-links",
    "A mechanism given by points and links",
    "",
    (
        *_HEAD,
        Key("sketch", Flag(), "If true, dimensions are never measured from [points]"),
        _DIMENSIONS,
        Key(
            "points",
            Named(ListOf(Number(), "coordinate", 2, 2)),
            "One assembled position: A = [35, 20]; exact for ground, elsewhere a sketch is enough",
            required=True,
        ),
        Key(
            "links",
            Named(ListOf(Text(), "point", 1)),
            'The points each link carries: crank = ["O2", "A"]; "ground" is fixed',
            required=True,
        ),
        Key("lengths", Named(Number(), 2), 'Exact distances in one link: "O2 A" = 40'),
        Key(
            "angles",
            Named(Number(), 3),
            'Exact angles in one link: "B A P" = 30, at A from AB to AP, counter-clockwise',
        ),
        Key("slots", Tables(_SLOT), "Pin in slot: a point moves along a line of another link"),
        Key("sliders", Tables(_SLIDER), "A link slides along a line of another without turning"),
        Key("cylinders", Tables(_CYLINDER), "A link of variable length between two points"),
        Key("welds", Tables(_WELD), "Two links that share a point and turn together"),
        Key("gears", Tables(_GEAR), "Two wheels in mesh, external or internal, on a common arm"),
        Key("belts", Tables(_BELT), "A belt or chain around two wheels, open or crossed"),
        Key("racks", Tables(_RACK), "A rack that slides and the pinion that drives it"),
        Key("rolling", Tables(_ROLLING), "A wheel that rolls without slipping"),
        Key("cams", Tables(_CAM), "A cam and its follower"),
        Key("curves", Tables(_CURVE), "A point moves along a curve of another link"),
        Key("springs", Tables(_SPRING), "A spring between two points; drawn, without constraint"),
        Key("input", Tables(_DRIVES, single=True), "The driven quantity and its range"),
        _TRACE,
        _OUTPUTS,
    ),
)
LOOPS = Form(
    "loops",
    "A mechanism given by vector loop-closure equations",
    "loops",
    (
        *_HEAD,
        _DIMENSIONS,
        Key(
            "loops",
            Named(Formula(equation=True), 0),
            'Loop equations by label: "A B C" = "a2*e^(i*theta2) + a3*e^(i*theta3) = d"',
            required=True,
        ),
        _GUESS,
        Key(
            "input",
            Tables(_VARIABLE, single=True),
            'The driven variable: variable = "theta2"',
            required=True,
        ),
        Key(
            "points",
            Named(Formula()),
            'Points as formulas, A = "a2*e^(i*theta2)", for drawings',
        ),
        Key(
            "links",
            Named(ListOf(Text(), "point", 1)),
            'Points drawn as one link: crank = ["A0", "A"]; "ground" is fixed',
        ),
        _TRACE,
        _OUTPUTS,
    ),
)
EQUATIONS = Form(
    "plain-equations",
    "Any small system of real equations, solved by Newton-Raphson",
    "equations",
    (
        *_HEAD,
        _DIMENSIONS,
        Key(
            "equations",
            Named(Formula(equation=True), 0),
            'Real equations by label: f = "x^3 - 2*x + 2 = 0"',
            required=True,
        ),
        _GUESS,
        Key("input", Tables(_VARIABLE, single=True), 'The driven variable: variable = "x"'),
        _OUTPUTS,
    ),
)
FORMS = (LINKAGE, LOOPS, EQUATIONS)


def form_of(tables: Iterable[str]) -> Form:
    """The form of a file with these top-level keys."""
    present = set(tables)
    return next((form for form in FORMS if form.marker in present), LINKAGE)
