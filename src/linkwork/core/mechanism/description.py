"""The types of what a caller gives for the fields of a description."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property, lru_cache
from typing import Any, Self, TypeVar, cast

import numpy as np

from linkwork.core.expression.grammar import RESERVED, parse
from linkwork.core.expression.tree import Name
from linkwork.core.foundation.arrays import Array, FrozenDict
from linkwork.core.foundation.errors import (
    ExpressionError,
    InputError,
    MechanismError,
    Problem,
    UnknownNameError,
    choices,
    internal,
)
from linkwork.core.foundation.names import canonical, is_name
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.foundation.values import as_told, check_values, is_listed
from linkwork.core.mechanism.dimensions import Number, Numbers
from linkwork.core.mechanism.inputs import Input, formula_mistake, law_mistakes, speed_per_second

T = TypeVar("T")


def made_of(kind: type[T], given: Mapping[str, Any]) -> T:
    """A description from its fields by name.

    Raises
    ------
    UnknownNameError
        For a field that does not exist, with those that do.
    """
    return kind(**fields_of(kind, given))


def fields_of(kind: type, given: Mapping[str, Any]) -> Mapping[str, Any]:
    """The same fields by name, all of which exist; raises like :func:`made_of`."""
    names = [field.name for field in fields(cast(Any, kind)) if field.init]
    for name in given:
        if name not in names:
            raise UnknownNameError(f'there is no field "{name}" {choices("fields", names, name)}')
    return given


def merged(description: Any, given: Mapping[str, Any]) -> dict[str, Any]:
    """New fields of a description: entries of tables by name join those that it has.

    An entry ``None`` removes the one of that name, an empty table all; lists replace lists.

    Raises
    ------
    UnknownNameError
        For a field, or an entry to be removed, that does not exist.
    """
    changed = dict(fields_of(type(description), given))
    for table, new in changed.items():
        old = getattr(description, table)
        if isinstance(old, Mapping) and isinstance(new, Mapping) and new:
            changed[table] = _joined(table, old, new)
    return changed


def _joined(table: str, old: Mapping[Any, Any], new: Mapping[Any, Any]) -> dict[Any, Any]:
    spelled = {_folded(key): key for key in old}
    # keys that are no texts are refused later, with the field's name
    keys = {key: spelled.get(_folded(key), key) if isinstance(key, str) else key for key in new}
    for key, entry in new.items():
        if entry is None and keys[key] not in old:
            raise UnknownNameError(f'{table} has no "{key}" {choices(table, old, str(key))}')
    if len(set(keys.values())) < len(keys):
        raise InputError(f"{table} has two values under one name: {', '.join(map(str, keys))}")
    entries = {**old, **{keys[key]: entry for key, entry in new.items()}}
    return {key: entry for key, entry in entries.items() if entry is not None}


def _folded(key: str) -> tuple[str, ...]:
    words = canonical(key).split()
    # a distance has no direction, an angle has
    return tuple(sorted(words) if len(words) == 2 else words)


def check_field_types(description: Any) -> None:
    """Check that every field has the type of its default value; tables and lists become immutable.

    Raises
    ------
    InputError
        With the field, the type it must have, and what was given.
    """
    for field in fields(description):
        if not field.init:
            continue
        name, given = field.name, getattr(description, field.name)
        if isinstance(field.default, Mapping):
            _check_mapping(name, str(field.type), given)
            object.__setattr__(description, name, FrozenDict.of(given))
        elif isinstance(field.default, tuple):
            if not is_listed(given):
                raise _wrong(name, "a list", given)
            object.__setattr__(description, name, tuple(given))
        elif isinstance(field.default, bool | str) and not isinstance(given, type(field.default)):
            wanted = "a text" if isinstance(field.default, str) else "True or False"
            raise _wrong(name, wanted, given)


def check_entries(name: str, kind: type, given: Iterable[Any]) -> None:
    """Check that all entries of a field are of one class.

    Raises
    ------
    InputError
        With the field, the class, and what was given.
    """
    for k, entry in enumerate(given):
        if not isinstance(entry, kind):
            raise _wrong(f"{name}[{k}]", f"a lw.{kind.__name__}(…)", entry)


def _check_mapping(name: str, kind: str, given: Any) -> None:
    """``kind``: the type of the field as written: ``Mapping[str, …]``."""
    lists, texts = kind.startswith("Mapping[str, tuple"), kind == "Mapping[str, str]"
    wanted = _ENTRIES.get(name, "values") if lists else "texts" if texts else "values"
    if not isinstance(given, Mapping):
        raise _wrong(name, f"a dictionary of names and {wanted}", given)
    for key, entry in given.items():
        if not isinstance(key, str):
            raise InputError(f"the names in {name} must be texts, got {as_told(key)}")
        if lists and not is_listed(entry):
            raise _wrong(f'{name}["{key}"]', f"a list of {wanted}", entry)
        if texts and not isinstance(entry, str):
            raise _wrong(f'{name}["{key}"]', "a text", entry)


#: What the lists in a mapping contain.
_ENTRIES = {"points": "coordinates", "links": "points"}


def _wrong(name: str, wanted: str, given: Any) -> InputError:
    return InputError(f"{name} must be {wanted}, got {as_told(given)}")


# ----------------------------------------------------------------------
# A question about a mechanism, whose answer is hidden on a page until it is asked for.


#: The answers that are places of the input, and the kinds of limits there.
LIMITS = {"dead points": "DEAD_POINT", "change points": "CHANGE_POINT"}

#: What a question can hide on a page.
HIDDEN = ("numbers", "charts", "limits", "input", "equations")


@internal("problems", "given")
@dataclass(frozen=True, kw_only=True)
class Question:
    """A question with an answer that is computed, or a number that is given.

    Parameters
    ----------
    text : str
        The question.
    answer : str or float
        ``"dead points"`` or ``"change points"``: input values, any one of which is right; a number
        of the whole motion, ``"stroke(rocker)"``; with ``at`` a quantity of a row, ``"mu"``; or the
        number itself, in ``unit``.
    tolerance : float
        How far an answer may be from the right one, in the unit of the answer.
    at : float, optional
        The value of the leading input, in file units, at which ``answer`` is asked.
    unit : str
        The unit of an answer that is given.
    hide : tuple of str
        What the page hides until the question is answered: ``numbers`` of the position and the
        motion, ``charts``, ``limits`` (marks and sentences about dead points), the ``input``'s
        value, ``equations``.

    Examples
    --------
    >>> import linkwork as lw
    >>> ask = lw.Question(text="How far does it turn?", answer="stroke(rocker)", tolerance=1)
    >>> lw.example("four-bar").changed(questions=[ask]).sweep().skeleton.questions[0].answer
    'stroke(rocker)'
    """

    text: str
    answer: str | float
    tolerance: float
    at: float | None = None
    unit: str = ""
    hide: tuple[str, ...] = HIDDEN[:4]

    def __post_init__(self) -> None:
        check_values(self)

    @property
    def given(self) -> bool:
        """Whether the answer is a number in the file."""
        return not isinstance(self.answer, str)

    def problems(self) -> Iterator[tuple[str, str]]:
        """Keys and messages of what is wrong, without regard to the mechanism."""
        if not self.text.strip():
            yield "text", "is empty: write the question"
        if not 0 < self.tolerance < math.inf:
            yield "tolerance", "must be a positive number, in the unit of the answer"
        known = ", ".join(f'"{word}"' for word in HIDDEN)
        for word in self.hide:
            if word not in HIDDEN:
                yield "hide", f'"{word}" cannot be hidden (known: {known})'
        placed = not self.given and self.answer not in LIMITS
        if self.at is not None and not placed:
            yield "at", "has no effect: it is for a quantity that differs from row to row"
        if self.unit and not self.given:
            yield "unit", "has no effect: a computed answer has the unit of its quantity"


# ----------------------------------------------------------------------
# The base class of the three forms of a mechanism.


Key = tuple[str | int, ...]

_RANGE = ("from_", "to", "step")
_MOST_ROWS = 10_000_000
_LAW_STEPS = 360  # rows of a table over time, unless its step is given


class Problems(list[Problem]):
    """The problems found so far."""

    def add(self, key: Iterable[str | int], message: str) -> None:
        """Note a problem under a key path."""
        self.append(Problem(key=tuple(key), message=message))

    def raise_any(self, where: str) -> None:
        """Raise all problems together, if there are any."""
        if self:
            raise MechanismError(self, where)


@dataclass(frozen=True, kw_only=True)
class Description:
    """The description of a mechanism: immutable, comparable, in file units.

    Parameters
    ----------
    name : str
        Name of the mechanism.
    purpose : str
        What the mechanism is for, in one sentence.
    length : str
        Unit of every length; nothing is converted.
    angle : AngleUnit
        Unit of every angle.
    dimensions : Mapping[str, number or formula]
        Named numbers, usable in place of numbers.
    inputs : tuple of Input
        The driven quantities; several inputs move together.
    trace : tuple of str
        Points whose paths are drawn.
    outputs : Mapping[str, str]
        Named formulas of unknowns, dimensions and point coordinates (``A.x``).
    source : str
        The source of the mechanism.
    family : str
        The heading in lists of mechanisms.
    configuration : str
        The configuration or branch to start from instead of the guess.
    questions : tuple of Question
        Questions asked on pages, with hidden answers.
    tolerances : Mapping[str, number]
        The standard deviation of numbers that can vary, in their own units.

    Raises
    ------
    MechanismError
        With every problem found.
    """

    name: str = "mechanism"
    length: str = "mm"
    angle: AngleUnit = AngleUnit.DEGREE
    dimensions: Mapping[str, Number] = FrozenDict()
    inputs: tuple[Input, ...] = ()
    trace: tuple[str, ...] = ()
    outputs: Mapping[str, str] = FrozenDict()
    purpose: str = ""
    source: str = ""
    family: str = ""
    configuration: str = ""
    questions: tuple[Question, ...] = ()
    tolerances: Mapping[str, Number] = FrozenDict()

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        given: object = self.angle
        if not isinstance(given, AngleUnit):
            set_(self, "angle", _angle_unit(given, self.name))
        if isinstance(self.inputs, Input):
            set_(self, "inputs", (self.inputs,))
        check_field_types(self)
        if not all(isinstance(which, Input) for which in self.inputs):
            raise InputError(
                'inputs must be Input objects: lw.Input(link="crank"), or a list of them'
            )
        check_entries("questions", Question, self.questions)

    @cached_property
    def numbers(self) -> Numbers:
        """All named dimensions as numbers, with evaluation of further formulas."""
        return Numbers(self.dimensions, self.angle)

    def with_range(
        self, from_: Number | None = None, to: Number | None = None, step: Number | None = None
    ) -> Self:
        """A copy with another range of the input's table.

        Raises
        ------
        InputError
            If there is no input or more than one.
        """
        if len(self.inputs) != 1:
            count = len(self.inputs) or "no"
            raise InputError(
                f'mechanism "{self.name}" has {count} input{"s" * bool(self.inputs)}: '
                "only the range of a single one can be replaced"
            )
        old = self.inputs[0]
        changed = replace(
            old,
            from_=old.from_ if from_ is None else from_,
            to=old.to if to is None else to,
            step=old.step if step is None else step,
        )
        return replace(self, inputs=(changed,))

    def speed(self, which: Input) -> float | None:
        """The speed of an input in its unit per second, if given."""
        if which.speed is None:
            return None
        return speed_per_second(which.speed, which.drives[0], self.numbers, self.length)

    def check_common(self, problems: Problems, named: Iterable[tuple[Key, str]]) -> None:
        """Checks shared by all forms: names, dimensions, inputs.

        ``named`` lists further names of the form: key path and name.
        """
        taken: dict[str, str] = {}
        for key, name in (*named, *declared("dimensions", self.dimensions)):
            _check_name(problems, key, name, taken)
        self.numbers.check(problems.add)
        for key, name in declared("outputs", self.outputs):
            _check_name(problems, key, name, taken)
        for k, question in enumerate(self.questions):
            for field, message in question.problems():
                problems.add(("questions", k, field), message)
        for k, which in enumerate(self.inputs):
            if which.law is None:
                _check_rows(self, which, self.input_key(k), problems)
            else:
                _check_law(self, which, self.input_key(k), problems)
            _check_motor(self, which, self.input_key(k), problems)
        self._check_lock_step(problems)
        if self.timed:
            self._check_times(taken, problems)

    def input_key(self, k: int) -> Key:
        """Key path of the k-th input in a file."""
        return ("input",) if len(self.inputs) == 1 else ("input", k)

    @property
    def timed(self) -> bool:
        """Whether time drives the rows: an input has a law."""
        return any(which.law is not None for which in self.inputs)

    @cached_property
    def times(self) -> Array:
        """The one table of times of all inputs with a law [s], (rows,)."""
        return self.rows(next(which for which in self.inputs if which.law is not None))

    def lasts(self) -> float:
        """How long the shortest law of segments takes [s]; infinite for formulas."""
        return min(
            sum(segment.duration(self.numbers) for segment in which.law)
            if isinstance(which.law, tuple)
            else math.inf
            for which in self.inputs
        )

    def rows(self, which: Input) -> Array:
        """The table's values of one input, in the file's unit, shape (rows,); the times that all
        inputs share with a law.

        An input with a range of one value is constant and has one row, unlike the others.
        """
        start, stop, step = self._range(which)
        if start == stop:
            return np.array([start])
        count = math.floor((stop - start) / step + 1e-9) + 1
        return np.asarray(start + step * np.arange(count), dtype=np.float64)

    def _range(self, which: Input) -> tuple[float, float, float]:
        turn = self.angle.turn
        whole = (0.0, turn, turn / 360.0)
        if which.law is not None:
            whole = (0.0, self.lasts(), self.lasts() / _LAW_STEPS)
        given = [self._given(which, field) for field in _RANGE]
        start, stop, step = (
            default if number is None else number
            for number, default in zip(given, whole, strict=True)
        )
        if which.law is not None and given[2] is None and math.isfinite(stop - start):
            step = (stop - start) / _LAW_STEPS
        elif given[2] is None and stop < start:
            step = -step
        return start, stop, step

    def _given(self, which: Input, field: str) -> float | None:
        """An end or the step of an input's table; of times it may be written at any input."""
        sharing = [w for w in self.inputs if w.law is not None and which.law is not None]
        numbers = (getattr(w, field) for w in (which, *sharing))
        return next((self.numbers(number) for number in numbers if number is not None), None)

    def falls(self, which: Input) -> bool:
        """Whether the input decreases, according to its speed or else its table."""
        speed = self.speed(which)
        start, stop, _ = self._range(which)
        return speed < 0 if speed is not None else stop < start

    def _check_times(self, taken: Mapping[str, str], problems: Problems) -> None:
        """One table of times, within all laws."""
        if "t" in taken:
            problems.add(
                ("input",), f"t is the time of a law, and a name in {taken['t']}: call that t1"
            )
        if problems:
            return
        timed = [which for which in self.inputs if which.law is not None]
        given = [w for w in timed if (w.from_, w.to, w.step) != (None, None, None)] or timed
        for k, which in enumerate(self.inputs):
            key = self.input_key(k)
            if which.law is None and len(self.rows(which)) > 1:
                message = "is missing: time drives the other inputs; without a law it is constant"
                problems.add((*key, "law"), message)
            if which.law is not None and self._range(which) != self._range(timed[0]):
                problems.add(key, "has other times than the first input: they share one table")
            if which is given[0]:
                _check_steps(self, which, key, problems)
        ends = (float(self.times.min()), float(self.times.max())) if not problems else (0.0, 0.0)
        segments = any(isinstance(which.law, tuple) for which in self.inputs)
        if segments and ends[0] < 0.0:
            problems.add(("input",), f"begins at {ends[0]:g} s: a law of segments begins at 0")
        if ends[1] > self.lasts() * (1.0 + 1e-9):
            problems.add(
                ("input",),
                f"goes on to {ends[1]:g} s, but a law ends at {self.lasts():g} s: add a segment, "
                'for example { law = "dwell", … }, or end the table there',
            )

    def _check_lock_step(self, problems: Problems) -> None:
        if problems or len(self.inputs) < 2 or self.timed:
            return
        counts = [len(self.rows(which)) for which in self.inputs]
        first = next((k for k, count in enumerate(counts) if count > 1), 0)
        for k, count in enumerate(counts):
            if count not in (1, counts[first]):
                which = "the first input" if first == 0 else f"input {first + 1}"
                problems.add(
                    self.input_key(k),
                    f"has {count} rows, {which} has {counts[first]}: "
                    "inputs move in lock-step and need equal row counts",
                )


def _check_motor(description: Description, which: Input, key: Key, problems: Problems) -> None:
    numbers = description.numbers
    if which.motor is not None:
        kind = which.drives[0]
        for below, message in which.motor.mistakes(kind, numbers, description.length):
            problems.add((*key, "motor", *below), message)
    if which.inertia is not None:
        amount = numbers.check_amount(problems.add, (*key, "inertia"), which.inertia)
        if amount < 0:
            problems.add((*key, "inertia"), f"must not be negative, got {amount:g}")


def _check_law(description: Description, which: Input, key: Key, problems: Problems) -> None:
    numbers = description.numbers
    if which.speed is not None:
        problems.add((*key, "speed"), "contradicts the law, which gives the speed: leave one out")
    if isinstance(which.law, str):
        mistake = formula_mistake(which.law, numbers)
        if mistake is not None:
            problems.add((*key, "law"), mistake)
        if which.begin is not None:
            problems.add((*key, "begin"), "is used with segments only: the formula has a value")
        timed = [w for w in description.inputs if w.law is not None]
        if all(w.to is None and isinstance(w.law, str) for w in timed):
            problems.add((*key, "to"), "is missing: the last time [s], as a formula has no end")
    else:
        for below, message in law_mistakes(which.law or (), numbers):
            problems.add((*key, "law", *below), message)
    fields = {"from": which.from_, "to": which.to, "step": which.step, "begin": which.begin}
    for field, number in fields.items():
        numbers.check_number(problems.add, (*key, field), 0 if number is None else number)


def declared(table: str, names: Iterable[str]) -> Iterator[tuple[Key, str]]:
    """Key path and name for all keys of a table."""
    return (((table, name), name) for name in names)


def _angle_unit(given: object, name: str) -> AngleUnit:
    try:
        return AngleUnit(given)
    except ValueError:
        known = " or ".join(f'"{unit.value}"' for unit in AngleUnit)
        told = f'"{given}"' if isinstance(given, str) else as_told(given)
        problem = Problem(key=("angle",), message=f"must be {known}, got {told}")
        raise MechanismError([problem], f'mechanism "{name}"') from None


def _check_name(problems: Problems, key: Key, name: str, taken: dict[str, str]) -> None:
    folded = canonical(name)
    if is_name(name) and not _reads_as(name, folded):
        problems.add(key, f'"{name}" cannot be a name: formulas could not use it')
    elif not is_name(name):
        rule = "letters first, then letters, digits, _ or '"
        problems.add(key, f'"{name}" cannot be a name: {rule}')
    elif folded in RESERVED:
        problems.add(key, f'"{name}" is reserved in formulas: call it "{name}1"')
    elif folded in taken:
        problems.add(key, f'"{name}" is already a name in {taken[folded]}')
    else:
        taken[folded] = f"[{key[0]}]" if len(key) == 2 else f"[[{key[0]}]]"


@lru_cache(maxsize=1024)
def _reads_as(name: str, folded: str) -> bool:
    """Whether formulas can use the name: they read ``iθ`` as i*θ, ``x²`` as x^2."""
    if folded in RESERVED:
        return True
    try:
        return parse(name) == Name(folded)
    except ExpressionError:
        return False


def _check_rows(description: Description, which: Input, key: Key, problems: Problems) -> None:
    _check_speed(description, which, (*key, "speed"), problems)
    fields = (("from", which.from_), ("to", which.to), ("step", which.step))
    amounts = [
        description.numbers.check_number(problems.add, (*key, field), number)
        for field, number in fields
        if number is not None
    ]
    lengthy = which.drives[0] in ("slider", "cylinder")
    missing = [field for field, number in fields if number is None]
    if missing == ["step"] and amounts[0] == amounts[1]:
        missing = []  # constant
    if lengthy and missing:
        problems.add((*key, missing[0]), "is missing: an input length has no natural range")
    if (lengthy and missing) or any(amount != amount for amount in amounts):  # NaN
        return
    _check_steps(description, which, key, problems)


def _check_steps(description: Description, which: Input, key: Key, problems: Problems) -> None:
    start, stop, step = description._range(which)
    if start != stop and (step == 0 or (stop > start) != (step > 0)):
        problems.add((*key, "step"), f"a step of {step:g} does not lead from {start:g} to {stop:g}")
    elif start != stop and (stop - start) / step > _MOST_ROWS:
        message = f"a step of {step:g} from {start:g} to {stop:g} gives more than {_MOST_ROWS} rows"
        problems.add((*key, "step"), message)


def _check_speed(description: Description, which: Input, key: Key, problems: Problems) -> None:
    try:
        description.speed(which)
    except ExpressionError as error:
        if not description.numbers.wrong:  # else the cause is a dimension, reported already
            problems.add(key, error.message)
