"""The numbers of a mechanism by which its quantities have derivatives."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from weakref import WeakKeyDictionary

import numpy as np

from linkwork.batch.building import write_equations
from linkwork.design.derivatives.tape import Tape
from linkwork.equations.compiling import Compiled
from linkwork.foundation.errors import InputError, LinkworkError, key_text
from linkwork.foundation.operand import NotElementwise
from linkwork.mechanism.description import Description
from linkwork.mechanism.varied_number import (
    VariedNumber,
    number_named,
    varied_numbers,
    with_numbers,
)
from linkwork.motion.model import Model

__all__ = ["chosen_numbers", "groups_of"]

#: Reasons by compiled equations, and by number.
_REFUSED: WeakKeyDictionary[Compiled, dict[VariedNumber, str]] = WeakKeyDictionary()


def chosen_numbers(
    model: Model, by: Iterable[str] | None
) -> tuple[tuple[VariedNumber, ...], dict[str, str]]:
    """The numbers asked for, or all that are written as plain numbers; and why others cannot vary.

    Raises
    ------
    UnknownNameError
        For a name of no number.
    InputError
        For a number that cannot vary, or that is named twice.
    """
    description = model.description
    if by is not None:
        asked = (by,) if isinstance(by, str) else tuple(by)
        numbers = tuple(number_named(description, name) for name in asked)
        reasons = _refusals(model, numbers)
        for k, (name, number) in enumerate(zip(asked, numbers, strict=True)):
            if number in numbers[:k]:
                raise InputError(f'"{name}" is named twice: give each number once')
            if reasons[number]:
                raise InputError(f'"{name}" cannot vary: {reasons[number]}')
        return numbers, {}
    # what a formula gives follows from the numbers in it; a guess changes no position
    plain = [
        number
        for number in varied_numbers(description)
        if number.table != "guess" and not isinstance(number.written(description), str)
    ]
    reasons = _refusals(model, plain)
    refused = {number.name: reasons[number] for number in plain if reasons[number]}
    return tuple(number for number in plain if not reasons[number]), refused


def _refusals(model: Model, numbers: Sequence[VariedNumber]) -> dict[VariedNumber, str]:
    """Why the equations do not follow each number; "" if they do."""
    known = _REFUSED.setdefault(model.compiled, {})
    left = [number for number in numbers if number not in known]
    # all at once takes hardly longer than one
    if left and not _refusal(model.description, left):
        known |= dict.fromkeys(left, "")
    for number in numbers:
        if number not in known:
            known[number] = _refusal(model.description, [number])
    return {number: known[number] for number in numbers}


def _refusal(description: Description, numbers: Sequence[VariedNumber]) -> str:
    tape = Tape()
    tape.writing = True
    try:
        with np.errstate(all="ignore"):
            taped = {number: tape.number(float(number.of(description))) for number in numbers}
            write_equations(with_numbers(description, taped))
    except NotElementwise:
        return "it changes the form of the equations, such as a ratio of wheels or the law of a cam"
    except LinkworkError as error:
        if tape.lacks_derivatives:
            at = " and ".join(f"{number.of(description):g}" for number in numbers)
            return (
                f"at {at} a formula of it has a corner (abs, max, min, hypot) or an end (asin, "
                "acos, sqrt), where it has no derivative: change the number a little"
            )
        problems = getattr(error, "problems", ())
        if not problems:
            return str(error)
        held = problems[0].key
        if held[0] in ("lengths", "angles") and "ground coordinates" in problems[0].message:
            told = f"ground coordinates are exact and give {key_text(held)}"
            return f"{told}: leave that out to vary coordinates, or vary other numbers"
        return str(problems[0].message)
    return ""


def groups_of(
    description: Description, numbers: Sequence[VariedNumber]
) -> Iterator[tuple[VariedNumber, ...]]:
    """The numbers in groups that vary together: a number that a formula gives varies alone.

    Otherwise its formula would not pass on the change of the numbers in it.
    """
    plain = tuple(q for q in numbers if not isinstance(q.written(description), str))
    if plain:
        yield plain
    for number in numbers:
        if number not in plain:
            yield (number,)
