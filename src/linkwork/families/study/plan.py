"""The keys of the file that describes a study."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from linkwork.core.foundation.arrays import FrozenDict
from linkwork.core.foundation.errors import (
    InputError,
    MechanismError,
    UnknownNameError,
    choices,
    key_text,
)
from linkwork.core.foundation.files import as_path
from linkwork.core.foundation.names import find_spelling
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
from linkwork.core.mechanism.description import Description, Problems
from linkwork.core.mechanism.varied_numbers import number_named
from linkwork.core.motion.model import Model
from linkwork.core.motion.solving import as_described
from linkwork.core.results.quantities.registry import Call
from linkwork.core.textfile.keys import FORMAT, Form
from linkwork.core.textfile.reader import (
    ReadFile,
    Structure,
    check_format,
    example_text,
    examples,
    located_error,
    read_text,
)
from linkwork.core.textfile.toml_text import Lines, bytes_of, data_of, text_of
from linkwork.families.family import family_of
from linkwork.families.family_motion import FamilyMotion
from linkwork.families.sampling import Plan
from linkwork.families.study.store import LEDGER, METADATA
from linkwork.families.study.study import (
    DESIGN,
    Comparison,
    Condition,
    Job,
    Study,
    Word,
    choose_values,
    linkwork_version,
    passes_name,
    read_condition,
    usual_chunk,
    values_between,
)

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


# ----------------------------------------------------------------------
# All tables and keys of a study plan, for the reader and for the JSON Schema.


# ----------------------------------------------------------------------
# Read study plans; report all problems with their lines.


_LONGEST_NAME = 80
_TAKEN = ("built", "found", "certified", "passed", "status", LEDGER, METADATA, DESIGN)

KeyPath = tuple[str | int, ...]
T = TypeVar("T")


def read_plan(path: Path | str, *, columns: Sequence[str] = ()) -> Study:
    """Read the plan of a study.

    Parameters
    ----------
    columns : sequence of str
        Quantities stored at every row in addition to those of the plan.

    Raises
    ------
    MechanismFileError
        With every problem found: file, line, key and remedy; also for the mechanism's file.
    """
    name = str(path)
    text = text_of(bytes_of(as_path(path), name), name)
    return read_plan_text(text, name, Path(path).parent, columns=columns)


def read_plan_bytes(
    data: bytes, name: str = "standard input", *, columns: Sequence[str] = ()
) -> Study:
    """Read the plan in the bytes of a file; raises like :func:`read_plan`."""
    return read_plan_text(text_of(data, name), name, columns=columns)


def read_plan_text(
    text: str,
    name: str = "the plan",
    folder: Path | str = ".",
    *,
    columns: Sequence[str] = (),
) -> Study:
    """Read the plan in a text; its files are in ``folder``.

    Raises like :func:`read_plan`.
    """
    data = data_of(text, name)
    lines = Lines.of(text)
    check_format(data, lines, name)
    structure = Structure(data, PLAN)
    if structure.problems:
        raise located_error(structure.problems, lines, name)
    content = dict(structure.content)
    if columns:
        # columns of the command line follow those of the plan, without duplicates
        content["keep"] = [*dict.fromkeys([*content.get("keep", ()), *columns])]
    reader = _Reader(content, text, Path(folder))
    study = reader.study(Path(name).stem)
    if study is None:
        raise located_error(reader.problems, lines, name)
    return study


@dataclass
class _Reader:
    """Interprets the content of a plan and collects ``problems``."""

    content: Mapping[str, Any]
    text: str
    folder: Path
    problems: Problems = field(default_factory=Problems)

    def study(self, stem: str) -> Study | None:
        """The study; ``None`` after problems."""
        source = self._mechanism_text()
        if source is None:
            return None
        described = self._described(*source)
        if self.problems:
            return None
        description = self._with_range(described)
        found = choose_values(self.content, self.folder, self.problems)
        conditions = self._filters()
        reductions = self._texts("reductions", Call.read)
        if description is None or found is None:
            return None
        plan, constants = found
        model = as_described(description)
        motion = self._nothing(model, plan, constants)
        if motion is None:
            return None
        self._check_names(model, plan, motion, reductions, conditions)
        if self.problems:
            return None
        job = Job(
            description=description,
            keep=tuple(self.content.get("keep", ())),
            reductions=FrozenDict(reductions),
            filters=FrozenDict(conditions),
            certify=self.content.get("certify", True),
            device=self.content.get("device", "cpu"),
            version=linkwork_version(),
        )
        columns = len(model.equations.unknowns) + 4 + len(job.keep)
        size = self.content.get("chunk") or usual_chunk(
            plan.count, len(model.rows_in_file_units), columns
        )
        return Study(
            name=self.content.get("name", stem),
            text=self.text,
            mechanism_text=source[0],
            model=model,
            plan=plan,
            constants=constants,
            job=job,
            units=_units(motion, job),
            chunk_size=min(size, plan.count),
            identity=self._identity(source[0], plan, job, model, min(size, plan.count)),
        )

    def _mechanism_text(self) -> tuple[str, str] | None:
        """The text of the mechanism's file, and its name."""
        name = self.content["mechanism"]
        if name.endswith(".toml") or "/" in name or "\\" in name:
            path = self.folder / name
            return text_of(bytes_of(path, str(path)), str(path)), str(path)
        try:
            return example_text(name), f"{name}.toml"
        except UnknownNameError:
            known = choices("library", examples(), name)
            message = f'there is no "{name}" {known}; the name of a file ends in .toml'
            self.problems.add(("mechanism",), message)
            return None

    def _described(self, text: str, name: str) -> Description:
        """The description in the mechanism's file; its problems have lines of that file."""
        read: ReadFile = read_text(text, name)
        try:
            as_described(read.description)
        except MechanismError as error:
            raise read.located(error) from None
        if not read.description.inputs:
            message = "has no input: a study goes through a table of input values"
            self.problems.add(("mechanism",), message)
        return read.description

    def _with_range(self, description: Description) -> Description | None:
        if "input" not in self.content:
            return description
        names = {"from": "from_", "to": "to", "step": "step"}
        changes = {names[key]: entry for key, entry in self.content["input"].items()}
        try:
            return description.with_range(**changes)
        except MechanismError as error:
            self.problems.extend(error.problems)
        except InputError as error:
            self.problems.add(("input",), str(error))
        return None

    def _nothing(
        self, model: Model, plan: Plan, constants: Mapping[str, float]
    ) -> FamilyMotion | None:
        """A motion without designs, to look up names at no cost."""
        known = True
        for name in (*plan, *constants):
            try:
                number_named(model.description, name)
            except UnknownNameError as error:
                self.problems.add(self._key_of_number(name), str(error))
                known = False
        if not known or self.problems:
            return None
        try:
            family = family_of(model, {**values_between(plan, 0, 1), **constants})
        except InputError as error:
            self.problems.add(("dimensions",), str(error))
            return None
        # no designs are swept, but all names and units of the results are known
        return family.take(slice(0)).sweep(certify=False, threads=1)

    def _key_of_number(self, name: str) -> KeyPath:
        """The key path of a number of the mechanism in a plan."""
        return ("dimensions", name) if name in self.content.get("dimensions", {}) else ("table",)

    def _texts(self, table: str, read: Callable[[str], T]) -> dict[str, T]:
        """The entries of a table of texts."""
        found: dict[str, T] = {}
        for name, text in self.content.get(table, {}).items():
            try:
                found[name] = read(text)
            except InputError as error:
                self.problems.add((table, name), str(error))
        return found

    def _filters(self) -> dict[str, Condition]:
        found = self._texts("filters", read_condition)
        for name, condition in found.items():
            if condition == Word("certified") and not self.content.get("certify", True):
                message = "no design passes it with certify = false: leave one of them out"
                self.problems.add(("filters", name), message)
        return found

    def _check_names(
        self,
        model: Model,
        plan: Plan,
        motion: FamilyMotion,
        reductions: Mapping[str, Call],
        conditions: Mapping[str, Condition],
    ) -> None:
        """Check that quantities exist and the names of arrays are unique."""
        keep = self.content.get("keep", ())
        inputs = [variable.name for variable in model.equations.inputs]
        known = [
            self._check_quantity(("keep", k), name, inputs, partial(motion.quantity, name))
            for k, name in enumerate(keep)
        ]
        calls: list[tuple[KeyPath, Call]] = [
            (("reductions", name), c) for name, c in reductions.items()
        ]
        calls += [
            (("filters", name), condition.reduced)
            for name, condition in conditions.items()
            if isinstance(condition, Comparison)
        ]
        for key, call in calls:
            self._check_quantity(key, call.of, inputs, partial(motion.value, str(call)))
        taken = dict.fromkeys(_TAKEN, "an array of every study")
        for name in inputs:
            self._check_free(("mechanism",), name, name, taken)
            taken[name] = "an input, which every row has"
        for name in plan:
            self._check_free(self._key_of_number(name), name, name, taken)
            taken[name] = "a varied number"
        for k, name in enumerate(keep):
            if known[k]:
                self._check_free(("keep", k), name, name, taken)
        for name in reductions:
            self._check_free(("reductions", name), name, name, taken)
        for name in conditions:
            self._check_free(("filters", name), name, passes_name(name), taken)

    def _check_quantity(
        self, key: KeyPath, name: str, inputs: list[str], ask: Callable[[], object]
    ) -> bool:
        """Check that the quantity exists and can differ between designs."""
        if find_spelling(name, inputs) in inputs:
            self.problems.add(key, f'"{name}" is an input, the same for every design: leave it out')
            return False
        try:
            ask()
        except UnknownNameError as error:
            self.problems.add(key, str(error))
            return False
        return True

    def _check_free(self, key: KeyPath, name: str, array: str, taken: dict[str, str]) -> None:
        """Check that the name is a valid folder name and unique."""
        if array in taken:
            self.problems.add(key, f'"{name}" is already {taken[array]}: leave it out or rename it')
        elif not name.strip() or len(name) > _LONGEST_NAME or any(sign in name for sign in "/\\:*"):
            rule = f"up to {_LONGEST_NAME} letters, without / \\ : *"
            self.problems.add(key, f'"{name}" cannot name an array: {rule}')
        elif name.startswith((".", "__")):
            self.problems.add(key, f'"{name}" cannot name an array: begin with a letter')
        taken.setdefault(array, f"the name of {key_text(key)}")

    def _identity(
        self, mechanism: str, plan: Plan, job: Job, model: Model, chunk: int
    ) -> dict[str, Any]:
        """All data on which results depend, in JSON types."""
        content = self.content
        first, last = model.rows_in_file_units[[0, -1]].tolist()
        identity = {
            "linkwork": job.version,
            # files with other line ends describe the same mechanism
            "mechanism": mechanism.replace("\r\n", "\n"),
            "sampling": content["sampling"],
            "count": plan.count,
            "seed": content.get("seed"),
            "varied": list(plan),  # the random numbers depend on their order
            "dimensions": dict(content.get("dimensions", {})),
            "table": _digest(plan) if content["sampling"] == "table" else None,
            "input": {"first": first, "last": last, "rows": len(model.rows_in_file_units)},
            "keep": list(job.keep),
            "reductions": {name: str(reduced) for name, reduced in job.reductions.items()},
            "filters": {name: str(condition) for name, condition in job.filters.items()},
            "certify": job.certify,
            "device": job.device,
            "chunk": chunk,
        }
        # as it is read back: tuples become lists
        as_stored: dict[str, Any] = json.loads(json.dumps(identity))
        return as_stored


def _digest(plan: Plan) -> str:
    """A checksum of a table."""
    total = hashlib.sha256("\0".join(plan).encode())
    for values in plan.values():
        total.update(values.tobytes())
    return total.hexdigest()


def _units(motion: FamilyMotion, job: Job) -> dict[str, str]:
    """The units of stored quantities and numbers of motions, by array name."""
    found = {name: motion.unit(name) for name in job.keep}
    for name, call in job.reductions.items():
        found[name] = motion.quantities.find_of_motion(str(call)).unit
    return found
