"""All tables and keys of a task, for the reader and for the JSON Schema."""

from __future__ import annotations

from linkwork.core.foundation.values import (
    Constant,
    Either,
    Formula,
    Key,
    ListOf,
    Named,
    PlainNumber,
    Table,
    Tables,
    Text,
    Whole,
)
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.core.textfile.keys import FORMAT, Form
from linkwork.synthesis.improvement.settings import FITS, WHOLE

KINDS = ("motion", "path", "mixed", "function", "improve")
TURNS_FULLY = "turns fully"
TRANSMISSION = TRANSMISSION_ANGLE.word

_NUMBER = PlainNumber()
_POINT = ListOf(_NUMBER, "coordinate", 2, 2)
_PAIR = ListOf(_NUMBER, "number", 2, 2)
_ENDS = Either(_NUMBER, _PAIR, "[45, 105], or 60: a range that begins anywhere")

_POSITION = (
    Key("point", _POINT, "Where the guided point is: [x, y]", required=True),
    Key("angle", _NUMBER, "The angle of the guided body: with it, a pose"),
    Key("input", _NUMBER, "The angle of the crank at this position"),
    Key("tolerance", _NUMBER, "How far the point may miss; 0, the default: exact"),
    Key("angle_tolerance", _NUMBER, "How far the angle may miss; default 0"),
)

_MOVING_PIVOTS = "Pivots of the guided body, as they are at the first position"
_GIVEN = (
    Key("fixed_pivots", ListOf(_POINT, "pivot", 1, 3), "Fixed pivots: [[0, 0], [100, 0]]"),
    Key("moving_pivots", ListOf(_POINT, "pivot", 1, 2), _MOVING_PIVOTS),
    Key("lengths", Named(_NUMBER, 2), 'Lengths of a task of points: { "A0 A" = 40 }'),
)

_PAIRS = "Instead of a formula: angles of input and output, [[0, 0], [10, 4], [20, 9]]"
_SPACING = "How precision positions are spaced; default chebyshev"
_FIT = "Fit over the whole range, instead of precision positions"
_FUNCTION = (
    Key("of", Formula(), 'The function, a formula of x, of sin(x) in radians: "log10(x)"'),
    Key("x", _PAIR, "The range of x: [1, 2]"),
    Key("pairs", ListOf(_PAIR, "pair", 3), _PAIRS),
    Key("input", _ENDS, "The input angles at the ends of the range; 60: it is 60 wide"),
    Key("output", _ENDS, "The same of the output: angles, or a slider's displacements"),
    Key("positions", Whole(3, 9), "Number of precision positions; default 3, of watt-ii 9"),
    Key("spacing", Text(("chebyshev", "even")), _SPACING),
    Key("fit", Text(("least squares", "minimax")), _FIT),
)

_FILE = "A CSV file next to the task: x, y and, for timing as given, input in each row"
_TIMING = "Whether the inputs are those of the rows; default free"
_CLOSED = "Whether it is a whole curve; default: by the distance of its ends"
_CURVE = (
    Key("file", Text(), _FILE, required=True),
    Key("timing", Text(("free", "as given")), _TIMING),
    Key("closed", Text(("closed", "open", "partial")), _CLOSED),
)

_RANGE = (
    Key("from", _NUMBER, "First input value", required=True),
    Key("to", _NUMBER, "Last input value", required=True),
)
_RANGE_OR_TURNS = f'"{TURNS_FULLY}" or {{ from = 20, to = 140 }}'
_DRIVEN = Either(Text((TURNS_FULLY,)), Table(_RANGE), _RANGE_OR_TURNS)
_LEAST = Key("least", _NUMBER, "The smallest allowed", required=True)
_INSIDE = Key("inside", ListOf(_POINT, "corner", 3), "A polygon", required=True)
_LENGTHS = (
    Key("least", _NUMBER, "The shortest link allowed"),
    Key("most", _NUMBER, "The longest link or coupler arm allowed"),
    Key("ratio", _NUMBER, "The longest link over the shortest"),
)
_CIRCLES = ListOf(ListOf(_NUMBER, "number", 3, 3), "circle")
_ORDER = "The order in which positions are passed; default as given"
_WANTED = (
    Key("input", _DRIVEN, "The driven range; default from the first position to the last"),
    Key(TRANSMISSION, Table((_LEAST,)), "The transmission angle over the driven range"),
    Key("order", Text(("as given", "any")), _ORDER),
    Key("fixed_pivots", Table((_INSIDE,)), "The region of all fixed pivots"),
    Key("lengths", Table(_LENGTHS), "Bounds of the lengths of links, ground included"),
    Key("clear_of", _CIRCLES, "Obstacles: circles that no link may meet, [[x, y, radius]]"),
)

_WEIGHTS = (
    Key(TRANSMISSION, _NUMBER, "Weight of its least value"),
    Key("size", _NUMBER, "Weight of smallness"),
    Key("error", _NUMBER, "Weight of exactness"),
)
_BY = "Weights of the ranking; default { transmission = 1, size = 1, error = 5 }"
_RANK = (
    Key("by", Table(_WEIGHTS), _BY),
    Key("deliver", Whole(1, 10**6), "The largest number of designs delivered; default 20"),
)

_OF = 'A quantity, a number of a motion, "stroke(d)", or a formula'
_GOAL = (
    Key("of", Text(), _OF, required=True),
    Key("target", _NUMBER, "The target value"),
    Key("least", _NUMBER, "The smallest value allowed"),
    Key("most", _NUMBER, "The largest value allowed"),
    Key("at", ListOf(_NUMBER, "input", 1), "Inputs at which values are set"),
    Key("values", ListOf(_NUMBER, "value", 1), "The target values there"),
    Key("weight", _NUMBER, "Weight of this goal; default 1"),
)
_FRONT = "Largest number of designs of a Pareto front between the goals; default: one sum"
_IMPROVE = (
    Key("goal", Text(FITS), "How misses count; default least squares"),
    Key("point", Text(), "The point that follows the positions; default the first traced"),
    Key("vary", ListOf(Text(), "number", 1), 'Numbers to vary: ["O2 A", "O4.x"]'),
    Key("goals", Tables(_GOAL), "Goals besides the positions"),
    Key("bounds", Named(_PAIR, 0), 'Bounds of numbers: "O2 A" = [10, 60]'),
    Key("starts", Whole(*WHOLE["starts"]), "Number of starts"),
    Key("spread", _NUMBER, "Relative spread of the starts; default 0.05"),
    Key("front", Whole(*WHOLE["front"]), _FRONT),
    Key("seed", Whole(*WHOLE["seed"]), "Seed of the starts; default 1"),
)

_FORMAT = "The version of this file format; write format = 1"
_MECHANISM = Either(Text(), ListOf(Text(), "mechanism", 1), 'a name or a list: ["four-bar"]')
TASK = Form(
    "task",
    "What a mechanism should do, for the synthesis of mechanisms that do it",
    "",
    (
        Key("format", Constant(FORMAT), _FORMAT, required=True),
        Key("task", Text(KINDS), "The kind of the task", required=True),
        Key("name", Text(), "Name of the task"),
        Key("length", Text(), "Unit of every length in this file"),
        Key("angle", Text(("deg", "rad")), "Unit of every angle in this file"),
        Key("source", Text(), "Where the task comes from"),
        Key(
            "mechanism",
            _MECHANISM,
            'Kinds: "four-bar", "slider-crank", "inverted-slider-crank"; of two guides, if named: '
            '"double-slider", "rapson-slide", "oldham-coupling"; of functions "watt-ii"; a file to '
            "improve",
        ),
        Key("positions", Tables(_POSITION), "Precision positions, in order of travel"),
        Key("given", Table(_GIVEN), "What the author of the task fixes"),
        Key("function", Table(_FUNCTION), "The function of the input that the output follows"),
        Key("curve", Table(_CURVE), "A curve that the guided point follows"),
        Key("wanted", Table(_WANTED), "Wishes, each proved over the whole driven range"),
        Key("rank", Table(_RANK), "The order in which designs are delivered"),
        Key("improve", Table(_IMPROVE), "How dimensions are improved"),
    ),
)
