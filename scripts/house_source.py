"""Modules of a package as texts and syntax trees; line counts and circular imports."""

from __future__ import annotations

import ast
import io
import tokenize
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

Function = ast.FunctionDef | ast.AsyncFunctionDef
Documented = ast.Module | ast.ClassDef | Function
#: Tokens that are not code.
_LAYOUT = {
    tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT,
    tokenize.ENDMARKER,
}  # fmt: skip
_REASON = "# long: "  # marks the reason why a file or function is long


@dataclass(frozen=True)
class Source:
    """A module of the package: its path below the package, and its text."""

    path: Path
    text: str

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.text)

    @cached_property
    def nodes(self) -> list[ast.AST]:
        return list(ast.walk(self.tree))

    @cached_property
    def lines(self) -> list[str]:
        return self.text.splitlines()

    @cached_property
    def tokens(self) -> list[tokenize.TokenInfo]:
        return list(tokenize.generate_tokens(io.StringIO(self.text).readline))

    @cached_property
    def code(self) -> int:
        """Lines with code: without docstrings, comments and blank lines."""
        code = {
            line
            for token in self.tokens
            if token.type not in _LAYOUT
            for line in range(token.start[0], token.end[0] + 1)
        }
        for node in self.nodes:
            if (docstring := docstring_of(node)) is not None:
                code.difference_update(lines_of(docstring))
        return len(code)

    @property
    def module(self) -> tuple[str, ...]:
        """Its name below the package, in parts; for ``__init__`` that of the package."""
        parts = self.path.with_suffix("").parts
        return parts[:-1] if parts[-1] == "__init__" else parts

    def at(self, node: ast.stmt | ast.expr) -> str:
        return f"{self.path}:{node.lineno}"


@dataclass(frozen=True)
class Count:
    """A figure, and the counted places."""

    value: float
    where: tuple[str, ...] = ()


def read(package: Path) -> list[Source]:
    """All modules of a package."""
    return [
        Source(path.relative_to(package), path.read_text(encoding="utf-8"))
        for path in sorted(package.rglob("*.py"))
    ]


# ------------------------------------------------------------------ lines


def docstring_of(node: ast.AST) -> ast.Expr | None:
    """The statement that is the docstring of a module, class or function."""
    if isinstance(node, Documented) and node.body and isinstance(first := node.body[0], ast.Expr):
        value = first.value
        if isinstance(value, ast.Constant) and isinstance(value.value, str):
            return first
    return None


def lines_of(node: ast.stmt | ast.expr) -> range:
    return range(node.lineno, (node.end_lineno or node.lineno) + 1)


def comment_share(sources: list[Source]) -> Count:
    """Lines with a comment, in percent of those with code."""
    comments = sum(t.type == tokenize.COMMENT for s in sources for t in s.tokens)
    return Count(round(100.0 * comments / max(1, sum(s.code for s in sources)), 1))


def long_files(sources: list[Source], most: int) -> Count:
    """Files with more lines, unless a comment before their first statement says why."""
    found = []
    for source in sources:
        body = [n for n in source.tree.body if not isinstance(n, ast.Import | ast.ImportFrom)]
        starts = [n.lineno for n in body if n is not docstring_of(source.tree)]
        head = source.lines[: starts[0] - 1] if starts else source.lines
        if len(source.lines) > most and not any(line.startswith(_REASON) for line in head):
            found.append(f"{source.path}: {len(source.lines)}")
    return Count(len(found), tuple(found))


def long_functions(sources: list[Source], most: int) -> Count:
    """Functions with more lines, docstring apart, unless the comment above or beside says why."""
    found = []
    for source in sources:
        for node in source.nodes:
            if isinstance(node, Function):
                docstring = docstring_of(node)
                length = len(lines_of(node)) - (len(lines_of(docstring)) if docstring else 0)
                first = min([node.lineno, *(d.lineno for d in node.decorator_list)])
                near = source.lines[max(0, first - 2) : node.body[0].lineno - 1]
                if length > most and not any(_REASON in line for line in near):
                    found.append(f"{source.at(node)} {node.name}: {length}")
    return Count(len(found), tuple(found))


# ------------------------------------------------------------------ imports


def imported(source: Source, package: str, modules: set[tuple[str, ...]]) -> set[tuple[str, ...]]:
    """Modules of the package that are imported, including imports for types."""
    found = set()
    for node in source.nodes:
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in names:
            root, *parts = name.split(".")
            if root == package:
                whole = tuple(parts)
                found.add(whole if whole in modules else whole[:-1])
    return found


def circles(sources: list[Source], package: str) -> Count:
    """Neighbours (modules or packages of one package) that import each other in a circle."""
    modules = {source.module for source in sources}
    arrows: defaultdict[tuple[str, ...], defaultdict[str, set[str]]]
    arrows = defaultdict(lambda: defaultdict(set))
    for source in sources:
        for other in imported(source, package, modules):
            shared = next(
                (k for k, (a, b) in enumerate(zip(source.module, other, strict=False)) if a != b),
                None,
            )
            if shared is not None:
                arrows[other[:shared]][source.module[shared]].add(other[shared])
    found = [
        f"{'.'.join((package, *above))}: {', '.join(sorted(group))}"
        for above, graph in sorted(arrows.items())
        for group in strong_components(graph)
    ]
    return Count(len(found), tuple(found))


def strong_components(graph: Mapping[str, set[str]]) -> list[set[str]]:
    """Groups of more than one node, each of which reaches all others of its group."""
    reach: dict[str, set[str]] = {}
    for node in graph:
        seen, todo = set(), [node]
        while todo:
            for following in graph.get(todo.pop(), ()):
                if following not in seen:
                    seen.add(following)
                    todo.append(following)
        reach[node] = seen
    groups = {
        frozenset(b for b in reach[a] if a in reach.get(b, ())) for a in graph if a in reach[a]
    }
    return sorted((set(group) for group in groups if len(group) > 1), key=sorted)
