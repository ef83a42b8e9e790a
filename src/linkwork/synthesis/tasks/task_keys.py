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

_POINT = ListOf(PlainNumber(), "coordinate", 2, 2)
_PAIR = ListOf(PlainNumber(), "number", 2, 2)
_ENDS = Either(PlainNumber(), _PAIR, "[45, 105], or 60: a range that begins anywhere")
_RANGE = Table(
    (
        Key("from", PlainNumber(), "First input value", required=True),
        Key("to", PlainNumber(), "Last input value", required=True),
    )
)
_POSITIONS = Key(
    "positions",
    Tables(
        (
            Key("point", _POINT, "Where the guided point is: [x, y]", required=True),
            Key("angle", PlainNumber(), "The angle of the guided body: with it, a pose"),
            Key("input", PlainNumber(), "The angle of the crank at this position"),
            Key("tolerance", PlainNumber(), "How far the point may miss; 0, the default: exact"),
            Key("angle_tolerance", PlainNumber(), "How far the angle may miss; default 0"),
        )
    ),
    "Precision positions, in order of travel",
)
_GIVEN = Key(
    "given",
    Table(
        (
            Key("fixed_pivots", ListOf(_POINT, "pivot", 1, 3), "Fixed pivots: [[0, 0], [100, 0]]"),
            Key(
                "moving_pivots",
                ListOf(_POINT, "pivot", 1, 2),
                "Pivots of the guided body, as they are at the first position",
            ),
            Key("lengths", Named(PlainNumber(), 2), 'Lengths of a task of points: { "A0 A" = 40 }'),
        )
    ),
    "What the author of the task fixes",
)
_FUNCTION = Key(
    "function",
    Table(
        (
            Key("of", Formula(), 'The function, a formula of x, of sin(x) in radians: "log10(x)"'),
            Key("x", _PAIR, "The range of x: [1, 2]"),
            Key(
                "pairs",
                ListOf(_PAIR, "pair", 3),
                "Instead of a formula: angles of input and output, [[0, 0], [10, 4], [20, 9]]",
            ),
            Key("input", _ENDS, "The input angles at the ends of the range; 60: it is 60 wide"),
            Key("output", _ENDS, "The same of the output: angles, or a slider's displacements"),
            Key(
                "positions",
                Whole(3, 9),
                "Number of precision positions; default 3, of watt-ii 9",
            ),
            Key(
                "spacing",
                Text(("chebyshev", "even")),
                "How precision positions are spaced; default chebyshev",
            ),
            Key(
                "fit",
                Text(("least squares", "minimax")),
                "Fit over the whole range, instead of precision positions",
            ),
        )
    ),
    "The function of the input that the output follows",
)
_CURVE = Key(
    "curve",
    Table(
        (
            Key(
                "file",
                Text(),
                "A CSV file next to the task: x, y and, for timing as given, input in each row",
                required=True,
            ),
            Key(
                "timing",
                Text(("free", "as given")),
                "Whether the inputs are those of the rows; default free",
            ),
            Key(
                "closed",
                Text(("closed", "open", "partial")),
                "Whether it is a whole curve; default: by the distance of its ends",
            ),
        )
    ),
    "A curve that the guided point follows",
)
_WANTED = Key(
    "wanted",
    Table(
        (
            Key(
                "input",
                Either(
                    Text((TURNS_FULLY,)), _RANGE, f'"{TURNS_FULLY}" or {{ from = 20, to = 140 }}'
                ),
                "The driven range; default from the first position to the last",
            ),
            Key(
                TRANSMISSION_ANGLE.word,
                Table((Key("least", PlainNumber(), "The smallest allowed", required=True),)),
                "The transmission angle over the driven range",
            ),
            Key(
                "order",
                Text(("as given", "any")),
                "The order in which positions are passed; default as given",
            ),
            Key(
                "fixed_pivots",
                Table((Key("inside", ListOf(_POINT, "corner", 3), "A polygon", required=True),)),
                "The region of all fixed pivots",
            ),
            Key(
                "lengths",
                Table(
                    (
                        Key("least", PlainNumber(), "The shortest link allowed"),
                        Key(
                            "most",
                            PlainNumber(),
                            "The longest link or coupler arm allowed",
                        ),
                        Key("ratio", PlainNumber(), "The longest link over the shortest"),
                    )
                ),
                "Bounds of the lengths of links, ground included",
            ),
            Key(
                "clear_of",
                ListOf(ListOf(PlainNumber(), "number", 3, 3), "circle"),
                "Obstacles: circles that no link may meet, [[x, y, radius]]",
            ),
        )
    ),
    "Wishes, each proved over the whole driven range",
)
_RANK = Key(
    "rank",
    Table(
        (
            Key(
                "by",
                Table(
                    (
                        Key(
                            TRANSMISSION_ANGLE.word,
                            PlainNumber(),
                            "Weight of its least value",
                        ),
                        Key("size", PlainNumber(), "Weight of smallness"),
                        Key("error", PlainNumber(), "Weight of exactness"),
                    )
                ),
                "Weights of the ranking; default { transmission = 1, size = 1, error = 5 }",
            ),
            Key("deliver", Whole(1, 10**6), "The largest number of designs delivered; default 20"),
        )
    ),
    "The order in which designs are delivered",
)
_GOALS = Tables(
    (
        Key(
            "of",
            Text(),
            'A quantity, a number of a motion, "stroke(d)", or a formula',
            required=True,
        ),
        Key("target", PlainNumber(), "The target value"),
        Key("least", PlainNumber(), "The smallest value allowed"),
        Key("most", PlainNumber(), "The largest value allowed"),
        Key("at", ListOf(PlainNumber(), "input", 1), "Inputs at which values are set"),
        Key("values", ListOf(PlainNumber(), "value", 1), "The target values there"),
        Key("weight", PlainNumber(), "Weight of this goal; default 1"),
    )
)
_IMPROVE = Key(
    "improve",
    Table(
        (
            Key("goal", Text(FITS), "How misses count; default least squares"),
            Key("point", Text(), "The point that follows the positions; default the first traced"),
            Key("vary", ListOf(Text(), "number", 1), 'Numbers to vary: ["O2 A", "O4.x"]'),
            Key("goals", _GOALS, "Goals besides the positions"),
            Key("bounds", Named(_PAIR, 0), 'Bounds of numbers: "O2 A" = [10, 60]'),
            Key("starts", Whole(*WHOLE["starts"]), "Number of starts"),
            Key("spread", PlainNumber(), "Relative spread of the starts; default 0.05"),
            Key(
                "front",
                Whole(*WHOLE["front"]),
                "Largest number of designs of a Pareto front between the goals; default: one sum",
            ),
            Key("seed", Whole(*WHOLE["seed"]), "Seed of the starts; default 1"),
        )
    ),
    "How dimensions are improved",
)

TASK = Form(
    "task",
    "What a mechanism should do, for the synthesis of mechanisms that do it",
    "",
    (
        Key(
            "format",
            Constant(FORMAT),
            "The version of this file format; write format = 1",
            required=True,
        ),
        Key("task", Text(KINDS), "The kind of the task", required=True),
        Key("name", Text(), "Name of the task"),
        Key("length", Text(), "Unit of every length in this file"),
        Key("angle", Text(("deg", "rad")), "Unit of every angle in this file"),
        Key("source", Text(), "Where the task comes from"),
        Key(
            "mechanism",
            Either(Text(), ListOf(Text(), "mechanism", 1), 'a name or a list: ["four-bar"]'),
            'Kinds: "four-bar", "slider-crank", "inverted-slider-crank"; of two guides, if named: '
            '"double-slider", "rapson-slide", "oldham-coupling"; of functions "watt-ii"; a file to '
            "improve",
        ),
        _POSITIONS,
        _GIVEN,
        _FUNCTION,
        _CURVE,
        _WANTED,
        _RANK,
        _IMPROVE,
    ),
)
