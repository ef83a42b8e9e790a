"""Columns of a table of designs: in memory, or in a CSV file."""

from __future__ import annotations

import csv
import math
from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array, read_only
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import as_names
from linkwork.core.foundation.values import as_told, whole_number


def read_columns(table: object, columns: Sequence[str] | None) -> dict[str, Array]:
    """The columns of a table by name; by default all.

    Parameters
    ----------
    table : DataFrame, structured array, Mapping[str, (n,)], or path of a CSV file with a header

    Raises
    ------
    InputError
        If the table has no columns, a cell is not a number (names its line), or ``columns`` is not
        a list of names.
    UnknownNameError
        If a column does not exist.
    """
    columns = None if columns is None else as_names("the columns", columns)
    if isinstance(table, str | PathLike):
        return _read_csv(Path(table), columns)
    return {name: numbers(name, cells) for name, cells in _pick_columns(table, columns).items()}


def numbers(name: str, cells: object) -> Array:
    """Values of one name as an array of at most one axis."""
    array = np.asarray(cells)
    if array.dtype.kind not in "iuf" or array.ndim > 1:
        raise InputError(f'"{name}" needs a row of numbers, got {as_told(cells)}')
    return array.astype(np.float64)


def _pick_columns(table: Any, columns: Sequence[str] | None) -> dict[str, object]:
    """The columns of a table in memory."""
    if isinstance(table, np.ndarray) and table.dtype.names is not None:
        names = list(table.dtype.names)
    elif isinstance(table, Mapping):
        names = list(table)
    elif hasattr(table, "columns"):
        names = list(table.columns)
    else:
        raise InputError(
            "a table is a DataFrame, a structured array, a mapping of arrays or the path of a CSV "
            f"file, got {type(table).__name__}"
        )
    return {name: table[name] for name in _known(names, columns)}


def _known(names: Sequence[str], columns: Sequence[str] | None) -> Sequence[str]:
    for name in columns or ():
        if name not in names:
            raise UnknownNameError(
                f'the table has no column "{name}" {choices("columns", names, name)}'
            )
    return names if columns is None else columns


def _read_csv(path: Path, columns: Sequence[str] | None) -> dict[str, Array]:
    try:
        # a byte order mark written by spreadsheets is not part of the first name
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file)
            header = [name.strip() for name in next(reader, [])]
            wanted = [(name, header.index(name)) for name in _known(header, columns)]
            found: dict[str, list[float]] = {name: [] for name, _ in wanted}
            for cells in reader:
                if cells:
                    _read_row(path, reader.line_num, cells, header, wanted, found)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path} is not UTF-8 text: save it as CSV in UTF-8") from None
    except ValueError as error:  # no path, such as one with a NUL character
        raise InputError(f"{as_told(str(path))} cannot be read: {error}") from None
    return {name: np.array(values) for name, values in found.items()}


def _read_row(
    path: Path,
    line: int,
    cells: Sequence[str],
    header: Sequence[str],
    wanted: Sequence[tuple[str, int]],
    found: Mapping[str, list[float]],
) -> None:
    if len(cells) != len(header):
        raise InputError(f"{path} line {line} has {len(cells)} cells, the header {len(header)}")
    for name, column in wanted:
        try:
            found[name].append(float(cells[column]))
        except ValueError:
            raise InputError(
                f'{path} line {line}: "{name}" needs a number, got "{cells[column][:40]}"'
            ) from None


# ----------------------------------------------------------------------
# Plans: the values of the varied dimensions of a family.
#
# A plan is a mapping of arrays, the argument of :func:`linkwork.families.building.designs_of`,
# which can also be generated in chunks: ``plan.chunk(k)`` needs no other chunk, so a study can use
# any number of workers and gives the same designs. Random plans use a counter-based generator
# (Philox): its key is the seed, its counter the column and the chunk. The chunk size is therefore
# part of the plan, like the seed.
#
# References
# ----------
# Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2, 3 (2011),
# doi:10.1145/2063384.2063405. McKay, Beckman, Conover: A comparison of three methods (1979),
# doi:10.2307/1268522. Black, Rogaway: Ciphers with arbitrary finite domains (2002),
# doi:10.1007/3-540-45760-7_9.


#: Designs in a chunk. Changing it changes every random plan.
CHUNK = 65_536
_ROUNDS = 8  # rounds of the shuffle; in theory four give a random permutation

#: Draws a number of values, with no random source other than the generator.
Distribution = Callable[[np.random.Generator, int], Array]
Range = tuple[float, float]


@dataclass(frozen=True)
class Uniform:
    """Uniform distribution from ``low`` to ``high``."""

    low: float
    high: float

    def __post_init__(self) -> None:
        _range("Uniform", (self.low, self.high))

    def __call__(self, generator: np.random.Generator, count: int) -> Array:
        return generator.uniform(self.low, self.high, count)


@dataclass(frozen=True)
class Normal:
    """Normal distribution with ``mean`` and standard ``deviation``."""

    mean: float
    deviation: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.mean) and math.isfinite(self.deviation) and self.deviation >= 0):
            raise InputError(
                "Normal needs a finite mean and a deviation of 0 or more, "
                f"got {self.mean} and {self.deviation}"
            )

    def __call__(self, generator: np.random.Generator, count: int) -> Array:
        return generator.normal(self.mean, abs(self.deviation), count)  # -0.0 is not 0.0 there


class Plan(Mapping[str, Array]):
    """Values of dimensions for ``count`` designs; a mapping of arrays (count,).

    Parameters
    ----------
    names : sequence of str
    count : int
    """

    def __init__(self, names: Sequence[str], count: int) -> None:
        self.names = tuple(names)
        self.count = count

    @property
    def chunks(self) -> int:
        """The number of chunks; all but the last have ``CHUNK`` designs."""
        return -(-self.count // CHUNK)

    def chunk(self, k: int) -> dict[str, Array]:
        """The k-th chunk, independent of the others.

        Raises
        ------
        InputError
            If the chunk does not exist.
        """
        if not 0 <= k < self.chunks:
            raise InputError(f"there is no chunk {k}: this plan has {self.chunks}, from 0 on")
        return {name: self._column(column, k) for column, name in enumerate(self.names)}

    def __getitem__(self, name: str) -> Array:
        if name not in self.names:
            raise UnknownNameError(f'"{name}" is not varied {choices("names", self.names, name)}')
        column = self.names.index(name)
        parts = [self._column(column, k) for k in range(self.chunks)]
        return np.concatenate(parts) if parts else np.zeros(0)

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __eq__(self, other: object) -> bool:
        return self is other  # comparison of arrays has no single truth value

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        chunks = f"{self.chunks} chunk{'s' if self.chunks != 1 else ''}"
        return f"<Plan of {self.count} designs in {chunks}: {', '.join(self.names)}>"

    def _rows(self, k: int) -> range:
        return range(k * CHUNK, min((k + 1) * CHUNK, self.count))

    @abstractmethod
    def _column(self, column: int, k: int) -> Array:
        """The values of one name in one chunk."""


class _Grid(Plan):
    def __init__(self, levels: Mapping[str, Array]) -> None:
        self.levels = list(levels.values())
        super().__init__(list(levels), math.prod(map(len, self.levels)))

    def _column(self, column: int, k: int) -> Array:
        levels, rows = self.levels[column], self._rows(k)
        # the last name changes fastest, like the last digit
        repeats = math.prod(len(later) for later in self.levels[column + 1 :])
        number = np.arange(rows.start, rows.stop) // repeats % len(levels)
        values: Array = levels[number]
        return values


class _Random(Plan):
    def __init__(self, count: int, drawn: Mapping[str, Distribution], seed: int) -> None:
        super().__init__(list(drawn), count)
        self.drawn = list(drawn.values())
        self.seed = seed

    def _column(self, column: int, k: int) -> Array:
        # keyed by column and chunk: no chunk depends on another one
        drawn = self.drawn[column](_generator(self.seed, column, k), CHUNK)
        values = np.asarray(drawn, dtype=np.float64)
        if values.shape != (CHUNK,):
            name, got = self.names[column], " × ".join(map(str, values.shape)) or "one"
            raise InputError(f'the distribution of "{name}" drew {got} values, not {CHUNK}')
        return values[: len(self._rows(k))]  # a whole chunk is drawn, independent of the count


class _LatinHypercube(Plan):
    def __init__(self, count: int, ranges: Mapping[str, Range], seed: int) -> None:
        super().__init__(list(ranges), count)
        self.ranges = list(ranges.values())
        self.seed = seed

    def _column(self, column: int, k: int) -> Array:
        rows, (low, high) = self._rows(k), self.ranges[column]
        stratum = _shuffle(np.arange(rows.start, rows.stop), self.count, (self.seed, column))
        within = _generator(self.seed, column, k).random(len(rows))
        values: Array = low + (high - low) * ((stratum + within) / self.count)  # eq. (70)
        return values


class _FromTable(Plan):
    def __init__(self, columns: Mapping[str, Array]) -> None:
        self.columns = [read_only(values) for values in columns.values()]
        super().__init__(list(columns), len(self.columns[0]))

    def _column(self, column: int, k: int) -> Array:
        rows = self._rows(k)
        return self.columns[column][rows.start : rows.stop]


def grid(levels: Mapping[str, object]) -> Plan:
    """Every combination of the given values (full factorial); the last name changes fastest.

    Parameters
    ----------
    levels : Mapping[str, number or (n,)]

    Raises
    ------
    InputError
        If there are no names, or a name has no values.
    """
    return _Grid({name: _level(name, values) for name, values in _some(levels).items()})


def random(count: int, of: Mapping[str, Range | Distribution], seed: int) -> Plan:
    """Independent random values.

    Parameters
    ----------
    of : Mapping[str, (low, high) or Distribution]
        A range means a uniform distribution; otherwise :class:`Normal`, :class:`Uniform` or any
        function of a NumPy generator and a count.
    seed : int
        Equal distributions, order and seed give the same plan; the count only determines its
        length.

    Raises
    ------
    InputError
        If a range is invalid, or the count or seed is negative.
    """
    drawn = {
        name: given if callable(given) else Uniform(*_range(name, given))
        for name, given in _some(of).items()
    }
    return _Random(whole_number("count", count), drawn, whole_number("seed", seed))


def latin_hypercube(count: int, ranges: Mapping[str, Range], seed: int) -> Plan:
    """Random values spread evenly: one design in each of ``count`` equal parts of every range.

    Parameters
    ----------
    ranges : Mapping[str, (low, high)]

    Raises
    ------
    InputError
        If a range is invalid, or the count or seed is negative.

    Notes
    -----
    The order of the parts is a Feistel cipher of their numbers, which needs no list of all parts: a
    chunk of a plan of 10^9 designs takes no longer than one of 10^6.
    """
    found = {name: _range(name, given) for name, given in _some(ranges).items()}
    return _LatinHypercube(whole_number("count", count), found, whole_number("seed", seed))


def from_table(table: object, columns: Sequence[str] | None = None) -> Plan:
    """The rows of a table: a DataFrame, a structured array, a mapping of arrays, or a CSV file.

    Parameters
    ----------
    table : DataFrame, structured array, Mapping[str, (n,)], or path of a CSV file with a header
    columns : sequence of str, optional
        The varied columns; by default all.

    Raises
    ------
    InputError
        If the table has no columns, columns have different lengths, or a cell is not a number
        (names its line).
    UnknownNameError
        If a column does not exist.
    """
    found = {name: np.atleast_1d(values) for name, values in read_columns(table, columns).items()}
    lengths = {name: len(values) for name, values in _some(found).items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{name}: {length}" for name, length in lengths.items())
        raise InputError(f"columns of a table need equal lengths, got {told}")
    return _FromTable(found)


def _generator(seed: int, column: int, k: int) -> np.random.Generator:
    """The random numbers of one column in one chunk."""
    key = np.random.SeedSequence(seed).generate_state(2, np.uint64)
    counter = np.array([0, 0, column, k], dtype=np.uint64)
    return np.random.Generator(np.random.Philox(key=key, counter=counter))


def _shuffle(numbers: AnyArray, count: int, seed: tuple[int, int]) -> AnyArray:
    """A permutation of 0 … count - 1 at some numbers.

    A Feistel network over 2h bits, repeated until the number is below the count again.
    """
    # halves of equal width: the cipher needs an even number of bits
    half = np.uint64(max(1, -(-max(count - 1, 1).bit_length() // 2)))
    keys = np.random.SeedSequence(seed[0], spawn_key=(seed[1],)).generate_state(_ROUNDS, np.uint64)
    found = _encipher(numbers.astype(np.uint64), half, keys)
    # cycle walking (Black & Rogaway): a permutation of the larger set, cut down to the smaller
    while (outside := np.flatnonzero(found >= count)).size:
        found[outside] = _encipher(found[outside], half, keys)
    return found.astype(np.int64)


def _encipher(numbers: AnyArray, half: np.uint64, keys: AnyArray) -> AnyArray:
    mask = (np.uint64(1) << half) - np.uint64(1)
    left, right = numbers >> half, numbers & mask
    for key in keys:
        left, right = right, left ^ (_mix_bits(right + key) & mask)
    return (left << half) | right


def _mix_bits(x: AnyArray) -> AnyArray:
    """The finalizer of SplitMix64: every bit of the result depends on every bit of x (uint64)."""
    x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    mixed: AnyArray = x ^ (x >> np.uint64(31))
    return mixed


# Checks of arguments


def _some(given: Mapping[str, Any]) -> Mapping[str, Any]:
    if not isinstance(given, Mapping):
        raise InputError(f"a plan needs a mapping of names and values, got {as_told(given)}")
    if not given:
        raise InputError("this plan varies no numbers: give a dimension and its values")
    return given


def _range(name: str, given: object) -> Range:
    ends = np.asarray(given)
    if ends.shape != (2,) or ends.dtype.kind not in "iuf":
        raise InputError(f'"{name}" needs a range (low, high), got {as_told(given)}')
    low, high = map(float, ends)
    if not (math.isfinite(high - low) and low <= high):
        raise InputError(f'"{name}" needs a range from low to high, got {low:g} to {high:g}')
    return low, high


def _level(name: str, values: object) -> Array:
    levels = np.atleast_1d(numbers(name, values))
    if levels.ndim != 1 or not levels.size:
        raise InputError(f'"{name}" needs at least one value in a row, got {as_told(values)}')
    return levels
