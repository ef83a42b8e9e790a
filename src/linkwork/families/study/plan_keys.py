"""The keys of the file that describes a study."""

from __future__ import annotations

from linkwork.core.foundation.values import (
    Constant,
    Flag,
    Key,
    ListOf,
    Named,
    NumberValue,
    PlainNumber,
    Several,
    Table,
    Text,
    Whole,
)
from linkwork.core.textfile.keys import FORMAT, Form

SAMPLINGS = ("grid", "random", "latin-hypercube", "table")


_SPREAD = Several(
    ListOf(PlainNumber(), "value", 1),
    Table(
        (
            Key("from", PlainNumber(), "The smallest value"),
            Key("to", PlainNumber(), "The largest value"),
            Key("levels", Whole(1, 10**9), "In a grid: number of equidistant values"),
            Key("likeliest", PlainNumber(), "For a triangular distribution: the most likely value"),
            Key("mean", PlainNumber(), "For a normal distribution: its mean"),
            Key("deviation", PlainNumber(), "For a normal distribution: its standard deviation"),
        )
    ),
    "a number, a list of numbers, or a table such as { from = 36, to = 44 }",
)


_INPUT = (
    Key("from", NumberValue(), "First input value, in the mechanism's unit"),
    Key("to", NumberValue(), "Last input value"),
    Key("step", NumberValue(), "Step between input values"),
)


PLAN = Form(
    "study-plan",
    "Many designs of one mechanism: varied numbers, stored results and filters",
    "",
    (
        Key(
            "format",
            Constant(FORMAT),
            "The version of this file format; write format = 1",
            required=True,
        ),
        Key("name", Text(), "Name of the study"),
        Key(
            "mechanism",
            Text(),
            'The mechanism: a name of the library, "four-bar", or a file next to the plan, '
            '"mine.toml"',
            required=True,
        ),
        Key(
            "sampling",
            Text(SAMPLINGS),
            "How designs are chosen: every combination, random, Latin hypercube, or as "
            "listed in a table",
            required=True,
        ),
        Key("count", Whole(1, 10**15), "Number of designs"),
        Key("seed", Whole(0), "Seed of the random numbers: the same seed gives the same designs"),
        Key("table", Text(), "A CSV file next to the plan: one design in each row"),
        Key("columns", ListOf(Text(), "column", 1), "The varied columns; default all"),
        Key(
            "certify",
            Flag(),
            "Whether every position is proved; default true, false is faster",
        ),
        Key(
            "device",
            Text(("cpu", "gpu")),
            "The device: processor or graphics card; their results agree to rounding",
        ),
        Key("chunk", Whole(1), "Number of designs computed and stored together"),
        Key(
            "keep",
            ListOf(Text(), "quantity", 1),
            'Quantities stored at every row: ["B.x", "rocker"]',
        ),
        Key(
            "dimensions",
            Named(_SPREAD, 0),
            "Varied numbers of the mechanism, with values or distribution",
        ),
        Key("input", Table(_INPUT), "Range that replaces that of the mechanism's table"),
        Key(
            "reductions",
            Named(Text(), 0),
            'One number per design: swing = "stroke(rocker)"; min, max, mean or stroke',
        ),
        Key(
            "filters",
            Named(Text(), 0),
            'Conditions on a design: "whole cycle", "no dead point", "certified", '
            'or a comparison such as "mu >= 40"',
        ),
    ),
)
