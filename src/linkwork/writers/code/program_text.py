"""How the languages of programs write formulas and statements."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import resources

from linkwork.core.expression.tree import (
    STRENGTH,
    Binary,
    Call,
    Name,
    Negative,
    Node,
    NumberNode,
    names_in,
    strength,
)
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.units import AngleUnit
from linkwork.writers.code.solver_program import BlockProgram, Lets, SolverProgram, Stretch
from linkwork.writers.formulas.closure_formulas import CellFormula
from linkwork.writers.formulas.rate_formulas import rate_key

_OF_ANGLE = ("sin", "cos", "tan")
_TO_ANGLE = ("asin", "acos", "atan", "atan2")


@dataclass(frozen=True, kw_only=True)
class Syntax:
    """One language.

    Parameters
    ----------
    language : str
        Its name for people.
    suffix : str
        Of its files, with the dot.
    template : str
        The file of the fixed parts, in the folder ``templates``.
    functions : Mapping[str, str]
        Forms of the functions of formulas, of ``^``, and of the constants ``pi`` and ``e``.
    sections : Mapping[str, str]
        Forms of the functions of a program: ``closure``, ``sides1`` and ``sides2`` of a block with
        its number ``{k}``, its titles ``{about}`` and ``{n}`` rows; ``derived``,
        ``derived_rates``. ``{body}`` are statements, ``{locals}`` the names that they define.
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
    indent : str
        Before a statement in a function.
    padded : bool
        Whether lists of lists need lists of one length.
    empty : str
        What a list of no numbers contains.
    shared : str
        How functions call a constant.
    inner : tuple of str, optional
        As ``row``, for a list in a list.
    """

    language: str
    suffix: str
    template: str
    functions: Mapping[str, str]
    sections: Mapping[str, str]
    assign: str
    constant: str
    comment: str
    first: int
    element: str
    entry: str
    store: str
    string: str
    row: tuple[str, str, str]
    rows: tuple[str, str, str]
    words: frozenset[str]
    comments: str
    indent: str = "    "
    padded: bool = True
    empty: str = ""
    shared: str = "{name}"
    inner: tuple[str, str, str] | None = None

    @cached_property
    def text(self) -> str:
        """The template."""
        folder = resources.files("linkwork.writers.code") / "templates"
        return (folder / self.template).read_text("utf-8")

    @cached_property
    def reserved(self) -> frozenset[str]:
        """What is no free identifier: the language's words and the names of the fixed parts."""
        fixed = [self.text, *self.sections.values(), *self.functions.values()]
        code = (re.sub(self.comments, " ", part, flags=re.DOTALL).lower() for part in fixed)
        return self.words.union(*(re.findall(r"[a-z]\w*", part) for part in code))

    def number(self, value: float) -> str:
        """A number by all its digits, with a decimal point; NaN does not occur in programs."""
        shown = repr(float(value))
        mantissa, mark, exponent = shown.partition("e")
        if "." not in mantissa:
            mantissa += ".0"
        return mantissa + mark + exponent

    def listed(self, values: Sequence[float], *, inside: bool = False) -> str:
        """A list of numbers, whole ones as such; ``inside``: in a list of lists."""
        begin, between, end = (inside and self.inner) or self.row
        shown = (str(x) if isinstance(x, int) else self.number(x) for x in values)
        return begin + (between.join(shown) or self.empty) + end

    def at(self, array: str, k: int) -> str:
        """An element of an array; k counts from 0."""
        return self.element.format(array=array, k=k + self.first)

    def inside(self, matrix: str, i: int, j: int) -> str:
        """An entry of a matrix; i and j count from 0."""
        return self.entry.format(array=matrix, i=i + self.first, j=j + self.first)


@dataclass(frozen=True)
class FormulaText:
    """Formulas in a language's notation.

    Parameters
    ----------
    syntax : Syntax
    names : Mapping[str, str]
        Identifiers by the names of formulas.
    """

    syntax: Syntax
    names: Mapping[str, str]

    def of(self, formula: CellFormula) -> str:
        """A formula, its trigonometric functions in its unit of angles."""
        return self.text(formula.node, formula.unit is AngleUnit.DEGREE)

    def text(self, node: Node, degrees: bool = False) -> str:
        """A node; ``degrees``: whether sin, cos and their inverses use degrees."""
        match node:
            case NumberNode():
                shown = self.syntax.number(abs(node.value))
                return f"-{shown}" if node.value < 0.0 else shown
            case Name():
                return self._name(node.name)
            case Negative():
                return "-" + self._inside(node.operand, STRENGTH["*"], degrees)
            case Call():
                arguments = [self.text(x, degrees) for x in node.arguments]
                return self._call(node.function, arguments, degrees)
            case Binary("^"):
                return self._power(node, degrees)
            case Binary():
                strength = STRENGTH[node.operator]
                left = self._inside(node.left, strength, degrees)
                right = self._inside(node.right, strength + 1, degrees)
                if right.startswith("-"):  # no two operators in succession
                    right = f"({right})"
                space = " " if node.operator in "+-" else ""
                return f"{left}{space}{node.operator}{space}{right}"

    def _name(self, name: str) -> str:
        if name in self.names:
            return self.names[name]
        return self.syntax.functions[name]  # pi, e

    def _power(self, node: Binary, degrees: bool) -> str:
        if node.right == NumberNode(2.0) and isinstance(node.left, Name):
            base = self.text(node.left)
            return f"({base}*{base})"
        return self._call("^", [self.text(x, degrees) for x in (node.left, node.right)], degrees)

    def _call(self, function: str, arguments: list[str], degrees: bool) -> str:
        forms = self.syntax.functions
        if function in ("min", "max"):
            text = arguments[0]
            for other in arguments[1:]:
                text = forms[function].format(text, other)
            return text
        if function in _OF_ANGLE and degrees:
            arguments = [forms["radians"].format(*arguments)]
        shown = forms[function].format(*arguments)
        return forms["degrees"].format(shown) if function in _TO_ANGLE and degrees else shown

    def _inside(self, node: Node, least: int, degrees: bool) -> str:
        shown = self.text(node, degrees)
        return f"({shown})" if strength(node) < least else shown


# ----------------------------------------------------------------------
# A solver as the text of a program: a language's fixed parts, and the sections that differ.


_WIDTH = 90  # of a line of numbers
_FITS = 1e-9  # of the longest link: as far may a redundant link be from its length
_SECTION = re.compile(r"^([ %*]*)@\{(\w+)\}$|@\{(\w+)\}", re.MULTILINE)
#: What begins or ends a comment in some language, escapes, or names a section of a template.
_ENDS = (
    ("\\", "/"), ("*/", "* /"), ("/*", "/ *"), ("*)", "* )"), ("(*", "( *"), ('"""', "'"),
    ("@{", "@ {"),
)  # fmt: skip


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
        sections = {**self.sections, "heading": "\n".join(map(_as_comment, heading))}

        def fill(match: re.Match[str]) -> str:
            text = _SECTION.sub(fill, sections[match[2] or match[3]])
            space = match[1] or ""
            lines = ((space + line).rstrip() for line in text.split("\n"))
            return "\n".join(lines) if match[2] else text

        return _SECTION.sub(fill, self.syntax.text)

    @cached_property
    def _formula(self) -> FormulaText:
        of = self.program.names.of
        shared = {key: self.syntax.shared.format(name=name) for key, name in self._shared.items()}
        return FormulaText(self.syntax, of | shared)

    @cached_property
    def _shared(self) -> dict[str, str]:
        """Constants that all functions use."""
        keys = [d.key for d in self.program.dimensions]
        keys += [part.key for part in self.program.closure.coefficients.values()]
        keys += [rate_key(v.symbol, 1) for v in self.program.model.equations.inputs]
        return {key: self.program.names.of[key] for key in keys}

    # Places of variables in arrays, by the names of formulas

    @cached_property
    def _variables(self) -> dict[str, str]:
        """Where the values of unknowns and inputs are kept."""
        equations, at = self.program.model.equations, self.syntax.at
        places = {v.symbol: at("q", k) for k, v in enumerate(equations.unknowns)}
        return places | {v.symbol: at("u", k) for k, v in enumerate(equations.inputs)}

    @cached_property
    def _rate_variables(self) -> dict[str, str]:
        """Where the derivatives of unknowns are kept."""
        return {
            rate_key(v.symbol, order): self.syntax.at(f"d{order}", k)
            for order in (1, 2)
            for k, v in enumerate(self.program.model.equations.unknowns)
        }

    # Sections

    @cached_property
    def sections(self) -> Mapping[str, str]:
        """The sections by their names in templates."""
        return {
            **self._sizes,
            **self._of_blocks,
            **self._of_rows,
            "name": self.program.names.of["program"],
            "numbers": "\n".join(self._numbers()),
            "number_names": self._each("number", [(name, "") for name in self._shared.values()]),
            "units": self.syntax.listed(self.program.units),
            "sizes": self.syntax.listed(self.program.sizes),
            "results": self._each("result", self._results),
            "result_names": ", ".join(name for name, _ in self._results),
            "derived": self._function("derived", self._derived(), n=len(self.program.derived)),
            "derived_rates": self._function(
                "derived_rates", self._derived_rates(), n=len(self._with_rates)
            ),
            "misfits": self._function(
                "misfits", self._misfits(), n=len(self.program.closure.released)
            ),
        }

    @property
    def _sizes(self) -> dict[str, str]:
        """Lengths of arrays, and the numbers of their last elements, counted from 0."""
        program, equations = self.program, self.program.model.equations
        counts = {
            "n": len(equations.unknowns),
            "m": len(equations.inputs),
            "derived": len(program.derived),
            "rate": len(self._with_rates),
            "block": len(program.blocks),
            "largest": self._largest,
            "stretch": len(program.stretches),
            "row": len(program.inputs),
            "misfit": len(program.closure.released),
            "shown": len(self._shown),
        }
        sizes = {f"{name}_count": str(count) for name, count in counts.items()}
        sizes |= {f"last_{name}": str(max(count - 1, 0)) for name, count in counts.items()}
        return sizes | {"first_extra": str(counts["m"] + 1)}

    @property
    def _of_blocks(self) -> dict[str, str]:
        """Functions, calls and unknowns of all blocks."""
        syntax, blocks = self.syntax, self.program.blocks
        unknowns = [tuple(k + syntax.first for k in block.unknowns) for block in blocks]
        replacements = {
            name: "\n".join(
                form.format(k=k + 1, b=k, n=len(block.unknowns)) for k, block in enumerate(blocks)
            )
            for name, form in syntax.sections.items()
            if name.startswith("call")
        }
        return replacements | {
            "blocks": "\n".join(self._functions()),
            "block_unknowns": self._lists(unknowns),
            "block_lists": ", ".join(map(syntax.listed, unknowns)),
            "block_sizes": syntax.listed([len(block.unknowns) for block in blocks]),
            "no_blocks": "" if blocks else syntax.sections.get("no blocks", ""),
        }

    @property
    def _of_rows(self) -> dict[str, str]:
        """The table, its columns, and where its branches begin."""
        program, syntax, of = self.program, self.syntax, self.program.names.of
        equations, stretches = program.model.equations, program.stretches
        names = [of[v.symbol] for v in equations.inputs]
        first = stretches[0].first if stretches else 0
        start = stretches[0].unknowns if stretches else (0.0,) * len(equations.unknowns)
        goals = [(name, syntax.at("goal", k)) for k, name in enumerate(names)]
        return {
            "table": self._listed(program.inputs.tolist()),
            "starts": self._stretches(stretches),
            "estimates": syntax.listed(start),
            "first_row": str(first),
            "first_inputs": syntax.listed(program.inputs[first].tolist()),
            "input_names": ", ".join(names),
            "goals": self._each("goal", goals),
            "table_call": ", ".join(f"{name} := table[row, {k}]" for k, name in enumerate(names)),
            "column_names": ", ".join(map(syntax.string.format, self._columns())),
            "shown": syntax.listed(tuple(k + syntax.first for k in self._shown)),
            "largest_misfit": syntax.number(_FITS * equations.length_scale),
        }

    def _each(self, kind: str, pairs: Iterable[tuple[str, str]]) -> str:
        """A statement of one form for each name and place."""
        form = self.syntax.sections.get(kind, "")
        return "\n".join(form.format(name=name, place=place) for name, place in pairs)

    @cached_property
    def _shown(self) -> list[int]:
        """The unknowns with columns: all but lengths of redundant links."""
        unknowns = self.program.model.equations.unknowns
        return [k for k, v in enumerate(unknowns) if v.name in self.program.motion.unknowns]

    @property
    def _largest(self) -> int:
        return max((len(block.unknowns) for block in self.program.blocks), default=1)

    @cached_property
    def _with_rates(self) -> list[int]:
        return [k for k, d in enumerate(self.program.derived) if d.rates is not None]

    def _lists(self, rows: Sequence[tuple[int, ...]]) -> str:
        """Lists of whole numbers, all of the same length."""
        width = self._largest
        padded = [(*row, *[self.syntax.first - 1] * (width - len(row))) for row in rows]
        return self._listed(padded if self.syntax.padded else rows)

    def _listed(self, rows: Iterable[Sequence[float]]) -> str:
        """A list of lists, several in a line."""
        begin, between, end = self.syntax.rows
        lines: list[str] = []
        for numbers in rows:
            row = self.syntax.listed(numbers, inside=True)
            if lines and len(lines[-1]) + len(between) + len(row) <= _WIDTH:
                lines[-1] += between + row
            else:
                lines.append(row)
        listed = (between.rstrip() + "\n" + self.syntax.indent).join(lines)
        if not listed:
            begin, _, end = self.syntax.row
            listed = self.syntax.empty and self.syntax.listed(())
        return begin + listed + end

    def _numbers(self) -> Iterator[str]:
        """Dimensions, coefficients and rates of the inputs as constants."""
        program, of = self.program, self.program.names.of
        for dimension in program.dimensions:
            value = self.syntax.number(dimension.value)
            if dimension.formula is not None and dimension.live:
                angle = program.model.equations.angle
                value = self._formula.of(CellFormula(dimension.formula, angle))
            yield self._constant(of[dimension.key], value, dimension.name)
        for part in program.closure.coefficients.values():
            yield self._constant(of[part.key], self._formula.of(part.formula), "")
        for variable, rate in zip(program.model.equations.inputs, program.input_rates, strict=True):
            name = of[rate_key(variable.symbol, 1)]
            about = f"{variable.name} by the leading input"
            yield self._constant(name, self.syntax.number(rate), about)

    def _constant(self, name: str, value: str, about: str) -> str:
        place = self.syntax.shared.format(name=name)
        statement = self.syntax.constant.format(name=place, value=value)
        said = about and about.replace(" ", "_") != name
        return statement + (self.syntax.comment.format(about) if said else "")

    def _stretches(self, stretches: Sequence[Stretch]) -> str:
        first = self.syntax.first
        return self._listed(
            (float(s.first + first), float(s.last + first), *s.unknowns) for s in stretches
        )

    def _columns(self) -> list[str]:
        program = self.program
        equations = program.model.equations
        shown = [equations.unknowns[k].name for k in self._shown]
        moving = list(shown)
        moving += [program.derived[k].title for k in self._with_rates]
        return [
            *(v.name for v in equations.inputs),
            *shown,
            *(d.title for d in program.derived),
            *(f"{title}.d{order}" for title in moving for order in (1, 2)),
        ]

    # Functions

    def _functions(self) -> Iterator[str]:
        for k, block in enumerate(self.program.blocks):
            about = ", ".join(block.titles)
            n = len(block.unknowns)
            yield self._function("closure", self._closure(block), k, n, about)
            for order in (1, 2):
                yield self._function(f"sides{order}", self._sides(block, order), k, n, about)

    def _function(
        self, kind: str, body: list[tuple[str, str]], k: int = 0, n: int = 0, about: str = ""
    ) -> str:
        """A function: its statements are pairs of a new name, "" for none, and the statement."""
        statements = [statement for _, statement in body]
        return self.syntax.sections[kind].format(
            k=k + 1,
            n=n,
            about=about,
            locals=self._locals(body),
            body=("\n" + self.syntax.indent).join(statements),
        )

    def _locals(self, body: Sequence[tuple[str, str]]) -> str:
        """The declaration of the names that statements define, where a language needs one."""
        names = ", ".join(dict.fromkeys(name for name, _ in body if name))
        return self.syntax.sections.get("locals", "").format(names=names) if names else ""

    def _begin(
        self, lets: Lets, formulas: Sequence[CellFormula], places: Mapping[str, str]
    ) -> list[tuple[str, str]]:
        """Names of variables, then of sines and cosines."""
        of = self.program.names.of
        used = {node.name for formula in formulas for node in names_in(formula.node)}
        named = [(key, let) for key, let in lets.named if key in used]
        used |= {node.name for _, let in named for node in names_in(let.node)}
        body = [self._let(of[key], place) for key, place in places.items() if key in used]
        return body + [self._let(of[key], self._formula.of(let)) for key, let in named]

    def _let(self, name: str, value: str) -> tuple[str, str]:
        return name, self.syntax.assign.format(name=name, value=value)

    def _store(self, place: str, formula: CellFormula) -> tuple[str, str]:
        return "", self.syntax.store.format(place=place, value=self._formula.of(formula))

    def _closure(self, block: BlockProgram) -> list[tuple[str, str]]:
        """F and J of a block."""
        lets, n = block.closure, len(block.unknowns)
        body = self._begin(lets, lets.formulas, self._variables)
        body += [self._store(self.syntax.at("F", r), lets.formulas[r]) for r in range(n)]
        for r in range(n):
            for c in range(n):
                slope = lets.formulas[n + r * n + c]
                if slope.node != NumberNode(0.0):  # as all entries at the beginning
                    body.append(self._store(self.syntax.inside("J", r, c), slope))
        return body

    def _sides(self, block: BlockProgram, order: int) -> list[tuple[str, str]]:
        """The right-hand sides of one order of a block."""
        n = len(block.unknowns)
        sides = block.sides.formulas[(order - 1) * n : order * n]
        body = self._begin(block.sides, sides, self._variables | self._rate_variables)
        return body + [self._store(self.syntax.at("F", r), side) for r, side in enumerate(sides)]

    @cached_property
    def _results(self) -> list[tuple[str, str]]:
        """The identifiers of all columns but inputs, and their places in arrays."""
        of, at, equations = self.program.names.of, self.syntax.at, self.program.model.equations
        symbols = {k: equations.unknowns[k].symbol for k in self._shown}
        results = [(of[symbol], at("q", k)) for k, symbol in symbols.items()]
        results += [(d.name, at("v", k)) for k, d in enumerate(self.program.derived)]
        for order in (1, 2):
            results += [(of[rate_key(s, order)], at(f"d{order}", k)) for k, s in symbols.items()]
            results += [
                (of[rate_key(self.program.derived[k].key, order)], at(f"v{order}", row))
                for row, k in enumerate(self._with_rates)
            ]
        return results

    def _misfits(self) -> list[tuple[str, str]]:
        """The errors of redundant links."""
        released = self.program.closure.released
        errors = [
            CellFormula(Binary("-", Name(canonical(link.variable)), formula.node))
            for link, formula in released
        ]
        body = self._begin(Lets(), errors, self._variables)
        return body + [self._store(self.syntax.at("w", k), e) for k, e in enumerate(errors)]

    def _derived(self) -> list[tuple[str, str]]:
        derived = self.program.derived
        formulas = [part.formula for part in derived]
        body = self._begin(Lets(), formulas, self._variables)
        for k, part in enumerate(derived):
            body.append(self._let(part.name, self._formula.of(part.formula)))
            place = self.syntax.at("v", k)
            body.append(("", self.syntax.store.format(place=place, value=part.name)))
        return body

    def _derived_rates(self) -> list[tuple[str, str]]:
        """First, then second derivatives of the quantities computed from the unknowns."""
        of, syntax = self.program.names.of, self.syntax
        parts = [(self.program.derived[k], row) for row, k in enumerate(self._with_rates)]
        formulas = [rate for part, _ in parts for rate in part.rates or ()]
        values = {d.key: syntax.at("v", k) for k, d in enumerate(self.program.derived)}
        body = self._begin(Lets(), formulas, self._variables | self._rate_variables | values)
        for order in (1, 2):
            for part, row in parts:
                assert part.rates is not None
                name = of[rate_key(part.key, order)]
                body.append(self._let(name, self._formula.of(part.rates[order - 1])))
                place = syntax.at(f"v{order}", row)
                body.append(("", syntax.store.format(place=place, value=name)))
        return body


def _as_comment(line: str) -> str:
    """A line without characters that would end a comment."""
    plain = "".join(letter if letter.isprintable() else " " for letter in line)
    for end, instead in _ENDS:
        plain = plain.replace(end, instead)
    return plain
