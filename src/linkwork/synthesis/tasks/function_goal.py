"""The function that an output follows, its precision points, and its formula in a mechanism."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import (
    Binary,
    Call,
    Name,
    Negative,
    Node,
    NumberNode,
    names_in,
    text,
)
from linkwork.core.expression.values import OF_ANGLE, TO_ANGLE, value
from linkwork.core.foundation.arrays import EPSILON, EQUAL_ROWS, Array
from linkwork.core.foundation.errors import ExpressionError
from linkwork.core.foundation.units import FULL_TURN, AngleUnit
from linkwork.core.foundation.values import as_told
from linkwork.synthesis.improvement.settings import Problems

_VARIABLE = "x"
_ANGLES = ("rocker",)  # outputs that are angles
_LARGEST_STEP = 0.5  # of all values: between neighbours it is a pole
_EQUAL = 1e-9  # relative: ranges that differ by less are equal
_AS_WRITTEN = 1e-5  # relative: 3.14159 is half a turn
_ROUNDED = 16.0 * EPSILON  # relative: a value of a formula
_DENSE = 181  # points over the range for fits and structural errors

Pair = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class ExactPairs:
    """How many pairs of input and output a kind of mechanism meets exactly.

    Parameters
    ----------
    mechanism : str
    least : int
        Fewer pairs are no task for it.
    fixed, free : int
        The most with given start angles, and with free ones.
    fits : bool
        Whether it can be fitted to more of them.
    """

    mechanism: str = "four-bar"
    least: int = 3
    fixed: int = 3
    free: int = 5
    fits: bool = True


#: Those of a four-bar or slider-crank.
LOOP_PAIRS = ExactPairs()


@dataclass(frozen=True, kw_only=True)
class FunctionGoal:
    """An output as a function of the input, in file units.

    Parameters
    ----------
    of : str
        A formula of x; "" with ``pairs``.
    x : (float, float), optional
        The range of x.
    pairs : tuple of (float, float)
        Inputs and outputs instead of a formula.
    input, output : (float, float), optional
        Input and output at the ends of the range. Without them, the start angles are free and pairs
        count by their differences.
    free : tuple of str
        Those of input and output whose range begins anywhere, as if it began at 0.
    positions : int
        Number of precision points of a formula; 0: as many as the mechanism meets.
    spacing : str
        chebyshev or even.
    fit : str
        "", least squares or minimax.
    exact : ExactPairs
        How many pairs the mechanism meets.
    """

    of: str = ""
    x: Pair | None = None
    pairs: tuple[Pair, ...] = ()
    input: Pair | None = None
    output: Pair | None = None
    free: tuple[str, ...] = ()
    positions: int = 0
    spacing: str = "chebyshev"
    fit: str = ""
    exact: ExactPairs = LOOP_PAIRS

    @property
    def note(self) -> str:
        """What a summary adds: that trigonometric functions of more than a turn are of radians."""
        x = max(map(abs, self.x or (0.0,)))
        if x <= FULL_TURN or not re.search(r"\b(sin|cos|tan)\s*\(\s*x\s*\)", self.of):
            return ""
        return f"; x is in radians in {self.of}, and {x:g} are {x / FULL_TURN:.3g} turns"

    def problems(self) -> Problems:
        """What is wrong, with the key of each problem."""
        if bool(self.of) == bool(self.pairs):
            both = "are both given" if self.of else "are both missing"
            yield ("function", "of"), f'formula and pairs {both}: give of = "…" or pairs = [[…]]'
            return
        if self.free and (self.pairs or not self.exact.fits):
            yield ("function", self.free[0]), "must be a range with its start: [45, 105]"
            return
        if self.of:
            yield from self._formula_problems()
        else:
            yield from self._pair_problems()
        if self.fit and not self.exact.fits:
            yield ("function", "fit"), f"has no effect on {self.exact.mechanism}: leave it out"
        if len(self.free) == 1:
            message = "has no start, unlike the other one: give both or none"
            yield ("function", self.free[0]), message
        for key in ("x", "input", "output"):
            ends = getattr(self, key)
            if ends is not None and ends[0] == ends[1]:
                yield ("function", key), f"begins and ends at {ends[0]:g}: give a range"

    def _formula_problems(self) -> Problems:
        missing = [key for key in ("x", "input", "output") if getattr(self, key) is None]
        for key in missing:
            yield ("function", key), f"is missing: a formula needs the range of its {key}"
        if missing:
            return
        try:
            values = [self._evaluated(number) for number in self._x(_DENSE)]
        except ExpressionError as error:
            yield ("function", "of"), str(error)
            return
        first = values[0]
        size = max(map(abs, values)) or 1.0
        shares = np.array(values) / size
        steps, spread = np.abs(np.diff(shares)), float(np.ptp(shares))
        if abs(shares[-1] - shares[0]) <= max(_AS_WRITTEN * spread, _ROUNDED):
            text = f"has the value {first:g} at both ends, so that the output has no range"
            yield ("function", "of"), text
        elif steps.max() > _LARGEST_STEP * spread:
            place = self._x(_DENSE)[steps.argmax()]
            text = f"jumps by {size * steps.max():.4g} near x = {place:.4g}"
            yield ("function", "of"), f"{text}: give a range without this place"
        yield from self._count_problems("positions", self._count, "precision points")

    def _count_problems(self, key: str, count: int, noun: str) -> Problems:
        """Fewer precision points or pairs than a mechanism meets, or more."""
        exact, most = self.exact, self._most
        if count < exact.least:
            yield ("function", key), f"{count} given: give {exact.least} or more"
        elif count > most and not self.fit:
            starts = "given" if self.starts_fixed else "free"
            text = f"{count} {noun} leave no {exact.mechanism} with {starts} start angles: keep "
            text += f'{most}, or write fit = "least squares"' if exact.fits else str(most)
            if self.of and count <= exact.free:
                text += f"; free start angles meet {count}: input = 60 is a range that begins"
                text += " anywhere"
            yield ("function", key), text

    def _pair_problems(self) -> Problems:
        count = len(self.pairs)
        yield from self._count_problems("pairs", count, "pairs")
        outputs = [output for _, output in self.pairs]
        if count and np.ptp(outputs) <= _ROUNDED * max(map(abs, outputs)):
            text = f"all have the output {outputs[0]:g}, so that the output has no range"
            yield ("function", "pairs"), text
        for k, one in enumerate(self.pairs):
            for j in range(k):
                if one[0] == self.pairs[j][0]:
                    text = f"has the input {one[0]:g} of pair {j + 1}: leave one out"
                    yield ("function", "pairs", k), text
        for key, place in (("input", 0), ("output", 1)):
            ends = getattr(self, key)
            if (ends is None) == self.starts_fixed:
                yield ("function", key), "is missing: fix both start angles, or none"
            elif ends is not None and count:
                span = self.pairs[-1][place] - self.pairs[0][place]
                slack = _EQUAL * max(map(abs, ends))
                if not math.isclose(ends[1] - ends[0], span, rel_tol=_EQUAL, abs_tol=slack):
                    text = f"spans {ends[1] - ends[0]:g}, but the pairs span {span:g}"
                    yield ("function", key), text

    def range_problems(self, ends: Pair, turn: float) -> Problems:
        """An input that a driven range leaves out, in whatever turn the range is."""
        inputs = self.points()[0] if self.pairs else np.array(self.input)
        low, high = sorted(ends)
        slack = EQUAL_ROWS * turn
        turned = math.ceil((low - slack - inputs.min()) / turn) * turn
        first, last = float(inputs.min()), float(inputs.max())
        if last + turned > high + slack:
            near = round((low + high - first - last) / 2 / turn) * turn
            message = f"from {low:g} to {high:g} leaves out inputs of the function, which are from"
            message = f"{message} {first + near:.6g} to {last + near:.6g}: move or widen it"
            yield ("wanted", "input"), message

    def turn_problems(self, turn: float, rotates: bool) -> Problems:
        """Inputs, or angles of the output, of more than a turn; links of six-bars that make several
        turns come back to their angles in each.
        """
        inputs, outputs = self.dense_points()
        if not self.exact.fits and np.ptp(inputs) > turn:
            return
        listed = (("input", inputs), ("output", outputs)) if rotates else (("input", inputs),)
        for key, angles in listed:
            if np.ptp(angles) > turn * (1.0 + EQUAL_ROWS):
                message = f"spans {key}s of more than a turn, {turn:g}"
                if self.of and key == "output":
                    message += f": {self.of} gives {angles.min():.4g} to {angles.max():.4g}"
                yield ("function", "pairs" if self.pairs else key), message

    def order_problems(self) -> Problems:
        """A pair whose input is not between its neighbours' inputs."""
        steps = np.sign(np.diff(self.points()[0]))
        turned = np.flatnonzero(steps != steps[0])
        if len(turned):
            text = "is out of order: let inputs rise or fall from pair to pair, or write [wanted]"
            yield ("function", "pairs", int(turned[0]) + 1), f'{text} order = "any"'

    @property
    def _count(self) -> int:
        """The number of precision points of a formula."""
        return self.positions or self._most

    @property
    def _most(self) -> int:
        """The largest number of pairs or points."""
        return self.exact.fixed if self.starts_fixed else self.exact.free

    @property
    def starts_fixed(self) -> bool:
        """Whether the start angles are given."""
        return not self.free and (self.input is not None or self.output is not None)

    def begun_at(self, inputs: float, outputs: float) -> FunctionGoal:
        """The function whose first point is at this input and output, with given start angles."""
        first, second = (float(values[0]) for values in self.points())
        (a, b), (c, d) = self.input or (0.0, 0.0), self.output or (0.0, 0.0)
        u, v = inputs - first, outputs - second
        return replace(self, input=(a + u, b + u), output=(c + v, d + v), free=())

    @property
    def freed(self) -> FunctionGoal:
        """The same function without start angles."""
        if self.pairs or self.input is None or self.output is None:
            return replace(self, input=None, output=None)
        u, v = self.input[1] - self.input[0], self.output[1] - self.output[0]
        return replace(self, input=(0.0, u), output=(0.0, v), free=("input", "output"))

    def points(self) -> tuple[Array, Array]:
        """Inputs and outputs (K,) that a design meets, or a fit follows."""
        return self.dense_points() if self.fit else self.precision_points()

    def precision_points(self) -> tuple[Array, Array]:
        """Inputs and outputs (K,) of the precision points, in order."""
        if self.pairs:
            return self._of_pairs()
        return self._outputs(self._x(self._count, self.spacing))

    def dense_points(self) -> tuple[Array, Array]:
        """Inputs and outputs (K,) over the whole range, or the pairs."""
        return self._of_pairs() if self.pairs else self._outputs(self._x(_DENSE))

    def formula(self, link: str, output: str, angle: AngleUnit) -> str:
        """The structural error as a formula of the input and output links, in a file with this
        unit of angles; "" for pairs and free starts.
        """
        if self.pairs or self.free or self.x is None or self.input is None or self.output is None:
            return ""
        (x0, x1), (u0, u1), (v0, v1) = self.x, self.input, self.output
        middle, scale = 0.5 * (u0 + u1), (x1 - x0) / (u1 - u0)
        away = f"({link} - {middle!r})"
        if abs(u1 - u0) < angle.turn:
            away = _within_half_a_turn(away)
        variable = f"({x0 + (middle - u0) * scale!r} + {away}*{scale!r})"
        shown = text(
            _in_unit(self._tree, angle),
            lambda node: variable if node.name == _VARIABLE else node.name,
        )
        f0, f1 = map(self._evaluated, self.x)
        wrong = f"{output} - ({v0!r} + ({shown} - {f0!r})*{(v1 - v0) / (f1 - f0)!r})"
        return _within_half_a_turn(wrong) if output in _ANGLES else wrong

    def errors(self, inputs: Array, outputs: Array, turn: float) -> Array:
        """Structural errors (R,) at those of the angles (K,) of both links that are in the range of
        a formula, in whatever turn.
        """
        assert self.input is not None
        assert self.x is not None
        (u0, u1), (x0, x1) = self.input, self.x
        away = inputs - 0.5 * (u0 + u1)
        about = away if abs(u1 - u0) < turn else away.mean()
        share = 0.5 + (away - turn * np.round(about / turn)) / (u1 - u0)
        inside = np.abs(share - 0.5) <= 0.5 + EQUAL_ROWS
        # an end to rounding is the end, where a root or logarithm may begin
        goal = self._outputs(np.clip(x0 + share[inside] * (x1 - x0), min(self.x), max(self.x)))[1]
        wrong = outputs[inside] - goal
        return np.asarray(wrong - turn * np.round(wrong / turn))

    def _of_pairs(self) -> tuple[Array, Array]:
        inputs, outputs = np.array(self.pairs, dtype=float).T
        if self.input is not None and self.output is not None:
            inputs = inputs - inputs[0] + self.input[0]
            outputs = outputs - outputs[0] + self.output[0]
        return inputs, outputs

    def _outputs(self, x: Array) -> tuple[Array, Array]:
        """Inputs and outputs at numbers x, by the linear scales of the ranges."""
        assert self.x is not None
        assert self.input is not None
        assert self.output is not None
        f = np.array([self._evaluated(number) for number in x])
        f0, f1 = (self._evaluated(number) for number in self.x)
        (x0, x1), (u0, u1), (v0, v1) = self.x, self.input, self.output
        return (
            u0 + (x - x0) * ((u1 - u0) / (x1 - x0)),
            v0 + (f - f0) * ((v1 - v0) / (f1 - f0)),
        )

    def _x(self, count: int, spacing: str = "even") -> Array:
        assert self.x is not None
        start, stop = self.x
        if spacing == "even":
            return np.linspace(start, stop, count)
        # eq. (147)
        k = np.arange(1, count + 1)
        share = 0.5 - 0.5 * np.cos((2 * k - 1) * np.pi / (2 * count))
        return np.asarray(start + share * (stop - start))

    @property
    def _tree(self) -> Node:
        tree = parse(self.of)
        for node in names_in(tree):
            if node.name not in (_VARIABLE, "pi", "e"):
                message = f'column {node.column}: the variable is "x", got {as_told(node.spelling)}'
                raise ExpressionError(message, self.of, node.column)
        return tree

    def _evaluated(self, x: float) -> float:
        # functions of x are those of mathematics: radians
        return value(self._tree, {_VARIABLE: float(x)}, AngleUnit.RADIAN, self.of)


def _within_half_a_turn(angle: str) -> str:
    """A formula of an angle that a motion may count in another turn."""
    return f"atan2(sin({angle}), cos({angle}))"


def _in_unit(node: Node, angle: AngleUnit) -> Node:
    """A formula in radians as one whose functions of angles take, and give, another unit."""
    if angle is AngleUnit.RADIAN:
        return node
    match node:
        case Negative():
            return replace(node, operand=_in_unit(node.operand, angle))
        case Binary():
            return Binary(node.operator, _in_unit(node.left, angle), _in_unit(node.right, angle))
        case Call():
            arguments = tuple(_in_unit(argument, angle) for argument in node.arguments)
            unit = Binary("/", NumberNode(angle.turn / 2), Name("pi"))
            if node.function in OF_ANGLE:
                return Call(node.function, (Binary("*", arguments[0], unit),))
            call = Call(node.function, arguments)
            return Binary("/", call, unit) if node.function in TO_ANGLE else call
        case _:
            return node
