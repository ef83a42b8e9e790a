"""Programs in several languages."""

from __future__ import annotations

import keyword
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from importlib import metadata, resources
from pathlib import Path

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.expression.tree import Binary, Call, Name, Node, NumberNode, names_in
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import as_path, save_text
from linkwork.core.foundation.names import canonical
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.writers.code.solver_program import SolvedBlock, SolverProgram
from linkwork.writers.formulas.closure_formulas import FormulaText, Notation, of_radians
from linkwork.writers.formulas.rate_formulas import rate_key

# ----------------------------------------------------------------------
# How the languages of programs write formulas and statements.


def program_number(value: float) -> str:
    """A number by all its digits, with a decimal point; NaN does not occur in programs."""
    mantissa, mark, exponent = repr(float(value)).partition("e")
    return mantissa + ("" if "." in mantissa else ".0") + mark + exponent


@dataclass(frozen=True, kw_only=True)
class Syntax(Notation):
    """One language.

    Parameters
    ----------
    language : str
        Its name for people.
    suffix : str
        Of its files, with the dot.
    template : str
        The file of the fixed parts, in the folder ``templates``; see :func:`filled`.
    assign : str
        A statement that gives a new ``{name}`` a ``{value}``.
    constant : str
        The same for a number that never changes.
    comment : str
        A comment after a statement.
    first : int
        The index of an array's first element.
    element, entry : str
        Elements of an array and of a matrix, by numbers.
    store : str
        Writes a ``{value}`` to a ``{place}``.
    string : str
        A text between its marks.
    row, rows : tuple of str
        Beginning, separator and end of a list of numbers, and of a list of such lists.
    words : frozenset of str
        Words of the language, in lower case.
    comments : str
        A regular expression of comments in the template.
    padded : bool
        Whether lists of lists need lists of one length.
    empty : str
        What a list of no numbers contains.
    shared : str
        How functions call a constant.
    locals : str
        The declaration of the ``{names}`` that a function defines.
    inner : tuple of str, optional
        As ``row``, for a list in a list.
    """

    language: str
    suffix: str
    template: str
    number: Callable[[float], str] = program_number
    assign: str = "{name} = {value};"
    constant: str = "{name} = {value};"
    comment: str
    first: int = 0
    element: str = "{array}[{k}]"
    entry: str = "{array}[{i}][{j}]"
    store: str = "{place} = {value};"
    string: str = '"{}"'
    row: tuple[str, str, str] = ("[", ", ", "]")
    rows: tuple[str, str, str]
    words: frozenset[str]
    comments: str
    padded: bool = False
    empty: str = ""
    shared: str = "{name}"
    locals: str = ""
    inner: tuple[str, str, str] | None = None

    @cached_property
    def text(self) -> str:
        """The template."""
        folder = resources.files("linkwork.writers.code") / "templates"
        return (folder / self.template).read_text("utf-8")

    @cached_property
    def reserved(self) -> frozenset[str]:
        """What is no free identifier: the language's words and the names of the fixed parts."""
        ignored = rf"{self.comments}|{_PLACE.pattern}"
        fixed = "\n".join([self.text, *self.functions.values()])
        code = re.sub(ignored, " ", fixed, flags=re.DOTALL | re.MULTILINE).lower()
        return self.words.union(re.findall(r"[a-z]\w*", code))

    def listed(self, values: Iterable[float], *, inside: bool = False) -> str:
        """A list of numbers, whole ones as such; ``inside``: in a list of lists."""
        begin, between, end = (inside and self.inner) or self.row
        shown = (str(x) if isinstance(x, int) else self.number(x) for x in values)
        return begin + (between.join(shown) or self.empty) + end

    def table(self, rows: Iterable[Sequence[float]]) -> str:
        """A list of lists, several in a line."""
        begin, between, end = self.rows
        lines: list[str] = []
        for numbers in rows:
            row = self.listed(numbers, inside=True)
            if lines and len(lines[-1]) + len(between) + len(row) <= _WIDTH:
                lines[-1] += between + row
            else:
                lines.append(row)
        if not lines:
            begin, _, end = self.row
            lines = [self.empty and self.listed(())]
        indent = begin.partition("\n")[2]
        return begin + f"{between.rstrip()}\n{indent}".join(lines) + end

    def at(self, array: str, k: int) -> str:
        """An element of an array; k counts from 0."""
        return self.element.format(array=array, k=k + self.first)

    def inside(self, matrix: str, i: int, j: int) -> str:
        """An entry of a matrix; i and j count from 0."""
        return self.entry.format(array=matrix, i=i + self.first, j=j + self.first)


# ----------------------------------------------------------------------
# Templates: a language's fixed parts with places for what differs.


_PLACE = re.compile(r"^(?P<space>[ %*]*)@\{(?P<line>\w+)\}$|@\{(?P<word>[\w ]+)\}", re.MULTILINE)
_EACH = re.compile(r"^ *@\{each (\w+)\}\n(.*?)^ *@\{end\}\n", re.MULTILINE | re.DOTALL)
#: What begins or ends a comment in some language, escapes, or names a place of a template.
_ENDS = (
    ("\\", "/"), ("*/", "* /"), ("/*", "/ *"), ("*)", "* )"), ("(*", "( *"), ('"""', "'"),
    ("@{", "@ {"),
)  # fmt: skip


def filled(
    template: str,
    values: Mapping[str, str],
    repeated: Mapping[str, Iterable[Mapping[str, str]]],
) -> str:
    """The text of a template.

    Parameters
    ----------
    values : Mapping[str, str]
        Texts of the places ``@{name}``; a place alone in its line may have several lines.
    repeated : Mapping[str, iterable of Mapping[str, str]]
        Further texts of the lines from ``@{each name}`` to ``@{end}``, which are written once for
        each.
    """

    def lines(match: re.Match[str]) -> str:
        return "".join(filled(match[2], {**values, **own}, {}) for own in repeated[match[1]])

    def fill(match: re.Match[str]) -> str:
        if match["word"]:
            return values[match["word"]]
        text = values[match["line"]].split("\n")
        return "\n".join((match["space"] + line).rstrip() for line in text)

    return _PLACE.sub(fill, _EACH.sub(lines, template))


def as_comment(line: str) -> str:
    """A line without characters that would end a comment."""
    plain = "".join(letter if letter.isprintable() else " " for letter in line)
    for end, instead in _ENDS:
        plain = plain.replace(end, instead)
    return plain


# ----------------------------------------------------------------------
# A solver as the text of a program.


_WIDTH = 90  # of a line of numbers
_FITS = 1e-9  # of the longest link: as far may a redundant link be from its length


@dataclass
class Statements(FormulaText):
    """The statements of one function.

    Variables, sines and cosines get names where they are first used.

    Parameters
    ----------
    notation : Syntax
    claim : callable
        The identifier for a key, similar to a preferred one.
    places : Mapping[str, str]
        Elements of arrays by the names of formulas.
    """

    notation: Syntax
    claim: Callable[[str, str], str]
    places: Mapping[str, str]
    lines: list[str] = field(default_factory=list)
    new: dict[str, None] = field(default_factory=dict)

    def let(self, name: str, value: str) -> str:
        """Give a name a value, once."""
        if name not in self.new:
            self.new[name] = None
            self.lines.append(self.notation.assign.format(name=name, value=value))
        return name

    def store(self, place: str, formula: Node) -> None:
        """Write a number to an element of an array."""
        self.lines.append(self.notation.store.format(place=place, value=self.text(formula)))

    def name(self, name: str) -> str:
        """The text of a name; variables are read from their arrays."""
        shown = super().name(name)
        return self.let(shown, self.places[name]) if name in self.places else shown

    def call(self, node: Call) -> str:
        """The text of a function."""
        text = super().call(node)
        if node.function not in ("sin", "cos"):
            return text
        used = (
            self.names[x.name].rpartition(".")[2] for x in names_in(node) if x.name in self.names
        )
        stem = "_".join(dict.fromkeys((node.function, *used)))
        return self.let(self.claim(f"let {text}", stem), text)

    def written(self, kind: str) -> dict[str, str]:
        """The texts of the places of a function: its statements, and their declarations."""
        names = ", ".join(self.new)
        declared = self.notation.locals.format(names=names) if names else ""
        return {kind: "\n".join(self.lines), f"{kind}_locals": declared}


@dataclass(frozen=True)
class ProgramText:
    """Writes a program in one language.

    Parameters
    ----------
    program : SolverProgram
    syntax : Syntax
    """

    program: SolverProgram
    syntax: Syntax

    def written(self, heading: Sequence[str]) -> str:
        """The whole program.

        Parameters
        ----------
        heading : sequence of str
            Lines of its first comment.
        """
        program, syntax, of = self.program, self.syntax, self.program.names.of
        values = {
            **self._sizes(),
            **self._table(),
            **self._derived().written("derived"),
            **self._derived_rates().written("derived_rates"),
            **self._misfits().written("misfits"),
            "heading": "\n".join(map(as_comment, heading)),
            "name": of["program"],
            "numbers": "\n".join(self._numbers()),
            "units": syntax.listed(program.units),
            "sizes": syntax.listed(program.sizes),
            "result_names": ", ".join(name for _, name, _ in self._results),
        }
        goals = (
            {"goal": of[v.symbol], "place": syntax.at("goal", k)}
            for k, v in enumerate(program.model.equations.inputs)
        )
        repeated: dict[str, Iterable[Mapping[str, str]]] = {
            "block": [self._block(k, block) for k, block in enumerate(program.blocks)],
            "number": [{"number": of[key]} for key in self._shared],
            "result": [{"result": name, "place": place} for _, name, place in self._results],
            "goal": goals,
        }
        return filled(syntax.text, values, repeated)

    @cached_property
    def _shared(self) -> list[str]:
        """The keys of constants that all functions use."""
        keys = [d.key for d in self.program.dimensions]
        keys += [part.key for part in self.program.closure.coefficients.values()]
        return keys + [rate_key(v.symbol, 1) for v in self.program.model.equations.inputs]

    @cached_property
    def _names(self) -> dict[str, str]:
        """Identifiers in formulas by their names there."""
        of, form = self.program.names.of, self.syntax.shared
        return of | {key: form.format(name=of[key]) for key in self._shared}

    @cached_property
    def _places(self) -> dict[str, str]:
        """Where unknowns, inputs and derivatives of unknowns are kept, by the names of formulas."""
        equations, at = self.program.model.equations, self.syntax.at
        places = {v.symbol: at("u", k) for k, v in enumerate(equations.inputs)}
        for k, variable in enumerate(equations.unknowns):
            places[variable.symbol] = at("q", k)
            for order in (1, 2):
                places[rate_key(variable.symbol, order)] = at(f"d{order}", k)
        return places

    def _statements(self, places: Mapping[str, str] | None = None) -> Statements:
        claim = self.program.names.claim
        return Statements(self.syntax, self._names, claim, {**self._places, **(places or {})})

    # Numbers

    def _sizes(self) -> dict[str, str]:
        """Lengths of arrays, and the numbers of their last elements, counted from 0."""
        program, equations = self.program, self.program.model.equations
        counts = {
            "n": len(equations.unknowns),
            "m": len(equations.inputs),
            "derived": len(program.closure.quantities),
            "rate": len(self._with_rates),
            "block": len(program.blocks),
            "largest": max((len(b.formulas.unknowns) for b in program.blocks), default=1),
            "stretch": len(program.stretches),
            "row": len(program.inputs),
            "misfit": len(program.closure.released),
            "shown": len(self._shown),
        }
        unknowns = [[k + self.syntax.first for k in b.formulas.unknowns] for b in program.blocks]
        width = counts["largest"] if self.syntax.padded else 0
        padded = [[*row, *[0] * (width - len(row))] for row in unknowns]
        return {
            **{f"{name}_count": str(count) for name, count in counts.items()},
            **{f"last_{name}": str(max(count - 1, 0)) for name, count in counts.items()},
            "first_extra": str(counts["m"] + 1),
            "block_unknowns": self.syntax.table(padded),
            "block_lists": ", ".join(map(self.syntax.listed, unknowns)),
            "block_sizes": self.syntax.listed(map(len, unknowns)),
        }

    def _table(self) -> dict[str, str]:
        """The table, its columns, and where its branches begin."""
        program, syntax = self.program, self.syntax
        equations, stretches, at = program.model.equations, program.stretches, syntax.first
        names = [program.names.of[v.symbol] for v in equations.inputs]
        titles = [*(v.name for v in equations.inputs), *(title for title, _, _ in self._results)]
        first = stretches[0].first if stretches else 0
        start = stretches[0].unknowns if stretches else (0.0,) * len(equations.unknowns)
        starts = ((float(s.first + at), float(s.last + at), *s.unknowns) for s in stretches)
        return {
            "table": syntax.table(program.inputs.tolist()),
            "starts": syntax.table(starts),
            "estimates": syntax.listed(start),
            "first_row": str(first),
            "first_inputs": syntax.listed(program.inputs[first].tolist()),
            "input_names": ", ".join(names),
            "table_call": ", ".join(f"{name} := table[row, {k}]" for k, name in enumerate(names)),
            "column_names": ", ".join(map(syntax.string.format, titles)),
            "shown": syntax.listed(k + at for k in self._shown),
            "largest_misfit": syntax.number(_FITS * equations.length_scale),
        }

    @cached_property
    def _shown(self) -> list[int]:
        """The unknowns with columns: all but lengths of redundant links."""
        unknowns = self.program.model.equations.unknowns
        return [k for k, v in enumerate(unknowns) if v.name in self.program.motion.unknowns]

    @cached_property
    def _with_rates(self) -> list[int]:
        rates, quantities = self.program.rates.of, self.program.closure.quantities
        return [k for k, quantity in enumerate(quantities) if quantity.key in rates]

    @cached_property
    def _results(self) -> list[tuple[str, str, str]]:
        """Title, identifier and place in an array of all columns but inputs."""
        unknowns, of = self.program.model.equations.unknowns, self.program.names.of
        derived, at = self.program.closure.quantities, self.syntax.at
        shown = [(unknowns[k].name, unknowns[k].symbol, k) for k in self._shown]
        results = [(name, of[symbol], at("q", k)) for name, symbol, k in shown]
        results += [(part.shown, of[part.key], at("v", k)) for k, part in enumerate(derived)]
        moving = [(name, symbol, "d", k) for name, symbol, k in shown]
        for row, k in enumerate(self._with_rates):
            moving.append((derived[k].shown, derived[k].key, "v", row))
        for name, key, array, k in moving:
            for order in (1, 2):
                place = at(f"{array}{order}", k)
                results.append((f"{name}.d{order}", of[rate_key(key, order)], place))
        return results

    def _numbers(self) -> Iterator[str]:
        """Dimensions, coefficients and rates of the inputs as constants."""
        program, of = self.program, self.program.names.of
        formulas = FormulaText(self.syntax, self._names)
        for dimension in program.dimensions:
            formula: Node = NumberNode(dimension.value)
            if dimension.formula is not None and dimension.live:
                formula = of_radians(dimension.formula, program.model.equations.angle)
            yield self._constant(of[dimension.key], formulas.text(formula), dimension.name)
        for part in program.closure.coefficients.values():
            yield self._constant(of[part.key], formulas.text(part.formula), "")
        for variable, rate in zip(program.model.equations.inputs, program.input_rates, strict=True):
            name = of[rate_key(variable.symbol, 1)]
            about = f"{variable.name} by the leading input"
            yield self._constant(name, self.syntax.number(rate), about)

    def _constant(self, name: str, value: str, about: str) -> str:
        place = self.syntax.shared.format(name=name)
        statement = self.syntax.constant.format(name=place, value=value)
        said = about and about.replace(" ", "_") != name
        return statement + (self.syntax.comment.format(about) if said else "")

    # Functions

    def _block(self, k: int, block: SolvedBlock) -> dict[str, str]:
        """The texts of the functions of a block: F and J, and the right-hand sides of rates."""
        at, inside, rows = self.syntax.at, self.syntax.inside, block.formulas.rows
        closure, *sides = (self._statements() for _ in range(3))
        for r, row in enumerate(rows):
            closure.store(at("F", r), row.formula)
        for r, row in enumerate(rows):
            for c, slope in enumerate(row.slopes):
                if slope != NumberNode(0.0):  # as all entries at the beginning
                    closure.store(inside("J", r, c), slope)
        for order, side in enumerate(sides):
            for r, pair in enumerate(block.sides):
                side.store(at("F", r), pair[order])
        return {
            **closure.written("closure"),
            **sides[0].written("first_sides"),
            **sides[1].written("second_sides"),
            "k": str(k + 1),
            "b": str(k),
            "n": str(len(rows)),
            "about": as_comment(", ".join(block.titles)),
        }

    def _misfits(self) -> Statements:
        """The errors of redundant links."""
        statements = self._statements()
        for k, (link, length) in enumerate(self.program.closure.released):
            error = Binary("-", Name(canonical(link.variable)), length)
            statements.store(self.syntax.at("w", k), error)
        return statements

    def _derived(self) -> Statements:
        """Links that turn with others, points and outputs."""
        statements = self._statements()
        for k, part in enumerate(self.program.closure.quantities):
            statements.let(self._names[part.key], statements.text(part.formula))
            statements.store(self.syntax.at("v", k), Name(part.key))
        return statements

    def _derived_rates(self) -> Statements:
        """First, then second derivatives of the quantities computed from the unknowns."""
        derived, rates = self.program.closure.quantities, self.program.rates.of
        statements = self._statements(
            {part.key: self.syntax.at("v", k) for k, part in enumerate(derived)}
        )
        for order in (1, 2):
            for row, part in enumerate(derived[k] for k in self._with_rates):
                key = rate_key(part.key, order)
                statements.let(self._names[key], statements.text(rates[part.key][order - 1]))
                statements.store(self.syntax.at(f"v{order}", row), Name(key))
        return statements


# ----------------------------------------------------------------------
# The languages of programs as tables of spellings; programs by the suffixes of their files.


def _functions(one: str, two: str, **others: str) -> dict[str, str]:
    """Forms of functions of one and of two numbers, by forms of their names, and others."""
    single = ("sin", "cos", "tan", "asin", "acos", "atan", "sqrt", "exp", "log10", "abs")
    named = {name: one.format(name) for name in single}
    named |= {name: two.format(name) for name in ("atan2", "hypot", "min", "max")}
    named |= {"ln": one.format("log"), "radians": "radians({})", "degrees": "degrees({})"}
    return named | others


# ----------------------------------------------------------------------
# The languages.


_C_WORDS = """
    auto break case char const continue default do double else enum extern float for goto if
    inline int long register restrict return short signed sizeof static struct switch typedef
    union unsigned void volatile while bool true false nan infinity null main
"""
# Macros of the headers, also those beyond the standard that compilers add by default.
_MACROS = """
    bufsiz eof huge_val isfinite isgreater isinf isless isnan isnormal linux m_e m_pi signbit stderr
    stdin stdout unix
"""
C = Syntax(
    language="C99",
    suffix=".c",
    template="c.txt",
    functions=_functions(
        "{}({{}})", "{}({{}}, {{}})", min="fmin({}, {})", max="fmax({}, {})", abs="fabs({})",
        square="({0}*{0})", pi="PI", e="exp(1.0)", **{"^": "pow({}, {})"},
    ),
    assign="const double {name} = {value};",
    constant="#define {name} ({value})",
    comment=" /* {} */",
    row=("{", ", ", "}"),
    rows=("{\n    ", ", ", "\n}"),
    empty="0",
    words=frozenset((_C_WORDS + _MACROS).split()),
    comments=r"/\*.*?\*/",
    padded=True,
)  # fmt: skip
_JAVASCRIPT_WORDS = """
    abstract arguments await boolean break byte case catch char class const continue debugger
    default delete do double else enum eval export extends false final finally float for
    function goto if implements import in instanceof int interface let long native new null
    package private protected public return short static super switch synchronized this throw
    throws transient true try typeof undefined var void volatile while with yield nan infinity
    document location top window
"""  # the last four: names that a page cannot declare
JAVASCRIPT = Syntax(
    language="JavaScript",
    suffix=".js",
    template="javascript.txt",
    functions=_functions(
        "Math.{}({{}})", "Math.{}({{}}, {{}})",
        square="({0}*{0})", pi="Math.PI", e="Math.E", **{"^": "Math.pow({}, {})"},
    ),
    assign="const {name} = {value};",
    constant="const {name} = {value};",
    comment=" // {}",
    rows=("[\n  ", ", ", ",\n]"),
    words=frozenset(_JAVASCRIPT_WORDS.split()),
    comments=r"/\*.*?\*/|//[^\n]*",
)  # fmt: skip
_OCTAVE_WORDS = """
    break case catch classdef continue do else elseif end end_try_catch end_unwind_protect
    endfor endfunction endif endparfor endswitch endwhile enumeration events for function global
    if methods otherwise parfor persistent properties return spmd switch try until
    unwind_protect unwind_protect_cleanup while
"""
#: Octave and MATLAB: one function file.
OCTAVE = Syntax(
    language="Octave and MATLAB",
    suffix=".m",
    template="octave.txt",
    functions=_functions(
        "{}({{}})", "{}({{}}, {{}})", square="{}^2", pi="pi", e="exp(1)", **{"^": "{}^{}"}
    ),
    comment="  % {}",
    first=1,
    element="{array}({k})",
    entry="{array}({i}, {j})",
    string="'{}'",
    rows=("[\n  ", "; ", "\n]"),
    words=frozenset(_OCTAVE_WORDS.split()),
    comments=r"%[^\n]*",
    shared="p.{name}",
)  # fmt: skip
#: Python with NumPy.
PYTHON = Syntax(
    language="Python",
    suffix=".py",
    template="python.txt",
    functions=_functions(
        "{}({{}})", "{}({{}}, {{}})", square="{}**2", pi="pi", e="exp(1.0)", **{"^": "{}**{}"}
    ),
    assign="{name} = {value}",
    constant="{name} = {value}",
    comment="  # {}",
    entry="{array}[{i}, {j}]",
    store="{place} = {value}",
    rows=("[\n    ", ", ", ",\n]"),
    words=frozenset(map(str.lower, keyword.kwlist)),
    comments=r'""".*?"""|#[^\n]*',
)  # fmt: skip
_STRUCTURED_TEXT_WORDS = """
    abs abstract acos action add and any any_bit any_date any_int any_num any_real array asin at
    atan atan2 bool by byte case class concat configuration constant continue cos ct ctd ctu
    ctud date date_and_time delete div do dint dt dword else elsif end_action end_case end_class
    end_configuration end_for end_function end_function_block end_if end_interface end_method
    end_namespace end_program end_repeat end_resource end_step end_struct end_transition
    end_type end_var end_while eq exit exp expt extends f_edge f_trig false find final for from
    function function_block ge gt if implements initial_step insert int interface internal
    interval invert le left len limit ln log lreal lt lword max method mid min mod move mul mux
    namespace ne non_retain not null of on or overlap override pragma private program protected
    public pt q1 r1 r_edge r_trig read_only read_write real ref ref_to repeat replace resource
    retain return right rol ror rs s1 sel set shl shr sin single sint sizeof sqrt sr step string
    struct sub super tan task then this time time_of_day to tod tof ton tp transition true trunc
    type udint uint ulint unsigned until uint usint using var var_access var_config var_external
    var_global var_in_out var_input var_output var_temp while with word wstring xor ld st en eno
    jmp cal ret s r n
"""
#: Structured text of IEC 61131-3, for programmable controllers.
STRUCTURED_TEXT = Syntax(
    language="structured text, IEC 61131-3",
    suffix=".st",
    template="structured_text.txt",
    functions={
        **{name: form.upper() for name, form in _functions("{}({{}})", "{}({{}}, {{}})").items()},
        "ln": "LN({})", "log10": "LOG({})", "hypot": "SQRT(EXPT({}, 2.0) + EXPT({}, 2.0))",
        "^": "EXPT({}, {})", "square": "({0}*{0})", "pi": "3.141592653589793", "e": "EXP(1.0)",
        "radians": "(0.017453292519943295*({}))", "degrees": "(57.29577951308232*({}))",
    },
    assign="{name} := {value};",
    constant="{name} := {value};",
    comment=" (* {} *)",
    entry="{array}[{i}, {j}]",
    store="{place} := {value};",
    string="'{}'",
    rows=("[\n    ", ", ", "\n  ]"),
    inner=("", ", ", ""),
    words=frozenset(_STRUCTURED_TEXT_WORDS.split()),
    comments=r"\(\*.*?\*\)",
    empty="0",
    shared="p.{name}",
    locals="VAR\n  {names} : LREAL;\nEND_VAR",
    padded=True,
)  # fmt: skip


# ----------------------------------------------------------------------
# A mechanism's solver as a program in another language.


#: Languages by the suffixes of their files.
LANGUAGES: Mapping[str, Syntax] = {
    syntax.suffix: syntax for syntax in (PYTHON, OCTAVE, C, JAVASCRIPT, STRUCTURED_TEXT)
}


def language_of(file: Path) -> Syntax:
    """The language of a program's file, by its suffix.

    Raises
    ------
    InputError
        If no programs are written in this language.
    """
    syntax = LANGUAGES.get(file.suffix.lower())
    if syntax is None:
        known = ", ".join(f"{key} ({one.language})" for key, one in LANGUAGES.items())
        raise InputError(f'cannot write "{file}": the suffix of a program is one of {known}')
    return syntax


def code_of(model: Model, motion: Motion, file: Path) -> str:
    """Write the solver of a mechanism as a program.

    Parameters
    ----------
    model : Model
    motion : Motion
        The sweep of its table, which the program computes again.
    file : Path
        The program's file: its suffix selects the language, its name is that of the program.

    Raises
    ------
    InputError
        If the language is not known, or the mechanism's equations have no formulas.
    """
    syntax = language_of(file)
    program = SolverProgram(model, motion, file.stem, syntax.reserved)
    return ProgramText(program, syntax).written(list(_heading(program)))


def _heading(program: SolverProgram) -> Iterator[str]:
    """The results of the program, its units, and its limits."""
    model, motion = program.model, program.motion
    units = model.units
    yield f"{model.description.name}."
    yield ""
    yield f"Written by Linkwork {metadata.version('linkwork')}."
    yield f"Lengths in {units.length or 'the unit of the file'}, angles in {units.angle.value};"
    yield "derivatives are with respect to the leading input, with angles in radians."
    proved = int(motion.certified[motion.asked].sum())
    yield f"Linkwork proved {proved} of the {len(program.inputs)} positions of the table below;"
    yield "this program computes them again, and any others near them, but proves nothing."
    for limit in motion.limits:
        yield f"{limit.kind.word.capitalize()} at {limit.input:.12g}."


def write_program(mechanism: Mechanism, path: str | Path, motion: Motion | None = None) -> None:
    """Write the solver as a program in another language, which needs no Linkwork.

    Parameters
    ----------
    path : str or Path
        The file; its suffix selects the language: ``.py`` (NumPy), ``.m`` (Octave, MATLAB),
        ``.c`` (C99), ``.js``, ``.st`` (structured text of IEC 61131-3).
    motion : Motion, optional
        A sweep of this mechanism, whose table the program computes again; by default
        :meth:`~linkwork.Mechanism.sweep`.

    Raises
    ------
    InputError
        If the language is not known, the mechanism's equations have no formulas, or the file
        cannot be written.

    Examples
    --------
    >>> import linkwork as lw, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     lw.example("four-bar").write(f"{folder}/four_bar.py")
    ...     lines = pathlib.Path(folder, "four_bar.py").read_text().splitlines()
    >>> lines[1]
    'Four-bar linkage, open.'
    """
    cycle = mechanism.sweep() if motion is None else motion
    text = code_of(mechanism.model, cycle, as_path(path))
    save_text(text, path)
