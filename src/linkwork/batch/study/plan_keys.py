"""All tables and keys of a study plan, for the reader and for the JSON Schema."""

from __future__ import annotations

from linkwork.foundation.file_keys import (
    Constant,
    Flag,
    Key,
    ListOf,
    Named,
    Number,
    PlainNumber,
    Several,
    Table,
    Text,
    Whole,
)
from linkwork.textfile.keys import FORMAT, Form

__all__ = ["PLAN", "SAMPLINGS"]

SAMPLINGS = ("grid", "random", "latin-hypercube", "table")

_SPREAD = Several(
    ListOf(PlainNumber(), "value", 1),
    Table(
        (
            Key("from", PlainNumber(), "The smallest value"),
            Key("to", PlainNumber(), "The largest value"),
            Key("levels", Whole(1, 10**9), "In a grid: so many values from the first to the last"),
            Key("likeliest", PlainNumber(), "Of a random triangle: the value most often drawn"),
            Key("mean", PlainNumber(), "Of a random normal distribution: its mean"),
            Key("deviation", PlainNumber(), "Of a random normal distribution: one sigma"),
        )
    ),
    "a number, a list of numbers, or a table such as { from = 36, to = 44 }",
)
_INPUT = (
    Key("from", Number(), "First input value, in the mechanism's unit"),
    Key("to", Number(), "Last input value"),
    Key("step", Number(), "Step between input values"),
)

PLAN = Form(
    "study-plan",
    "Many designs of one mechanism: what varies, what is kept of each, which of them pass",
    "",
    (
        Key(
            "format",
            Constant(FORMAT),
            "The version of this file format; write format = 1",
            required=True,
        ),
        Key("name", Text(), "What the study is called"),
        Key(
            "mechanism",
            Text(),
            'The mechanism: a name of the library, "four-bar", or a file beside the plan, '
            '"mine.toml"',
            required=True,
        ),
        Key(
            "sampling",
            Text(SAMPLINGS),
            "How designs are chosen: every combination, by chance, evenly by chance, or as "
            "a table lists them",
            required=True,
        ),
        Key("count", Whole(1, 10**15), "How many designs are drawn"),
        Key("seed", Whole(0), "Where the random numbers start: the same seed, the same designs"),
        Key("table", Text(), "A CSV file beside the plan: one design in each row"),
        Key("columns", ListOf(Text(), "column", 1), "The columns that vary; all if left out"),
        Key(
            "certify",
            Flag(),
            "Whether every position is proved; true if left out, false is faster",
        ),
        Key(
            "device",
            Text(("cpu", "gpu")),
            "What computes: the processor, or a graphics card, whose results agree to rounding",
        ),
        Key("chunk", Whole(1), "Designs that are computed and stored together"),
        Key(
            "keep",
            ListOf(Text(), "quantity", 1),
            'Quantities kept at every row: ["B.x", "rocker"]',
        ),
        Key(
            "dimensions",
            Named(_SPREAD, 0),
            "What varies: a number of the mechanism, and its values or their distribution",
        ),
        Key("input", Table(_INPUT), "Another range of the mechanism's table"),
        Key(
            "reductions",
            Named(Text(), 0),
            'One number per design: swing = "stroke(rocker)"; min, max, mean or stroke',
        ),
        Key(
            "filters",
            Named(Text(), 0),
            'What a design has to pass: "whole cycle", "no dead point", "certified", '
            'or a comparison such as "mu >= 40"',
        ),
    ),
)
