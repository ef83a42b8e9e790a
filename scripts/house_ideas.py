"""Counts of parallel implementations: parts, quantities, rows, arithmetic, roundoff, steps."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from scripts.house_source import Count, Function, Source


def files_of_a_part(
    sources: list[Source], parts: Mapping[str, str], indices: Iterable[str]
) -> Count:
    """Files that name one kind of part by class or table; the median over kinds."""
    index = {Path(path) for path in indices}
    named: dict[str, list[str]] = {part: [] for part in parts}
    for source in sources:
        if source.path not in index and source.path.name != "__init__.py":
            classes, words = _own_names(source)
            for part, table in parts.items():
                if part in classes or table in words:
                    named[part].append(str(source.path))
    counts = sorted(map(len, named.values()))
    where = tuple(f"{part}: {len(files)} ({', '.join(files)})" for part, files in named.items())
    return Count(counts[len(counts) // 2] if counts else 0, where)


def _own_names(source: Source) -> tuple[set[str], set[str]]:
    """Classes defined here or imported from mechanisms; attributes and texts."""
    classes, words = set(), set()
    for node in source.nodes:
        match node:
            case ast.ClassDef(name=name):
                classes.add(name)
            case ast.ImportFrom(module=str(module)) if ".mechanism" in module:
                classes.update(alias.name for alias in node.names)
            case ast.Attribute(attr=name) | ast.Constant(value=str(name)):
                words.add(name)
    return classes, words


def files_of_a_quantity(sources: list[Source], quantities: Iterable[str]) -> Count:
    """Files that contain the name of a quantity as text; the maximum over some quantities."""
    texts = [
        (s, {node.value for node in s.nodes if isinstance(node, ast.Constant)}) for s in sources
    ]
    files = {name: [str(s.path) for s, inside in texts if name in inside] for name in quantities}
    where = tuple(f"{name}: {len(paths)} ({', '.join(paths)})" for name, paths in files.items())
    return Count(max(map(len, files.values()), default=0), where)


def lists_of_parts(sources: list[Source], parts: Mapping[str, str]) -> Count:
    """Tuples, lists, sets and dictionaries with three or more kinds of parts."""
    found = []
    words: set[object] = {*parts, *parts.values()}
    for source in sources:
        public = {id(n.value) for n in source.nodes if isinstance(n, ast.Assign) and _is_all(n)}
        for node in source.nodes:
            if source.path.name == "__init__.py" or id(node) in public:
                continue
            entries = node.keys if isinstance(node, ast.Dict) else getattr(node, "elts", [])
            named = words & {
                entry.value if isinstance(entry, ast.Constant) else entry.id
                for entry in entries
                if isinstance(entry, ast.Constant | ast.Name)
            }
            if len(named) >= 3:
                assert isinstance(node, ast.expr)
                found.append(f"{source.at(node)}: {', '.join(sorted(map(str, named)))}")
    return Count(len(found), tuple(found))


def _is_all(node: ast.Assign) -> bool:
    return any(isinstance(name, ast.Name) and name.id == "__all__" for name in node.targets)


def containers(
    sources: list[Source], fields: Iterable[str], least: int, single: Iterable[str]
) -> Count:
    """Classes with several fields of solved rows."""
    typical, found = set(fields), []
    for source in sources:
        for node in source.nodes:
            if isinstance(node, ast.ClassDef) and node.name not in single:
                own = {
                    entry.target.id
                    for entry in node.body
                    if isinstance(entry, ast.AnnAssign)
                    and isinstance(entry.target, ast.Name)
                    and "Array" in ast.unparse(entry.annotation)
                }
                if len(own & typical) >= least:
                    found.append(f"{source.at(node)} {node.name}: {', '.join(sorted(own))}")
    return Count(len(found), tuple(found))


def arithmetic(sources: list[Source]) -> Count:
    """Classes that overload sums and products."""
    found = []
    for source in sources:
        for node in source.nodes:
            if isinstance(node, ast.ClassDef):
                methods = {entry.name for entry in node.body if isinstance(entry, Function)}
                if methods & {"__add__", "__mul__", "__array_ufunc__"}:
                    found.append(f"{source.at(node)} {node.name}")
    return Count(len(found), tuple(found))


def roundoffs(sources: list[Source], home: str) -> Count:
    """Unit roundoffs computed outside the module that defines them."""
    found = []
    for source in sources:
        if source.path != Path(home):
            found += [
                source.at(node)
                for node in source.nodes
                if isinstance(node, ast.expr) and _is_roundoff(node)
            ]
    return Count(len(found), tuple(found))


def _is_roundoff(node: ast.expr) -> bool:
    match node:
        case ast.Attribute(attr="eps", value=ast.Call(func=function)):
            return ast.unparse(function).endswith("finfo")
        case ast.Attribute(attr="epsilon"):
            return ast.unparse(node).endswith("float_info.epsilon")
        case ast.BinOp(left=ast.Constant(value=2 | 2.0), op=ast.Pow(), right=exponent):
            return ast.unparse(exponent) in ("-52", "-53", "-52.0", "-53.0")
        case ast.Constant(value=float(value)):
            return 1.1e-16 < value < 1.12e-16 or 2.2e-16 < value < 2.23e-16
    return False


def tolerances(sources: list[Source], names: Iterable[str]) -> Count:
    """Modules with a tolerance whose name is used by other modules too."""
    wanted, found = set(names), []
    for source in sources:
        for node in source.tree.body:
            if isinstance(node, ast.Assign):
                own = {target.id for target in node.targets if isinstance(target, ast.Name)}
                found += [f"{source.at(node)} {name}" for name in sorted(own & wanted)]
    return Count(len(found), tuple(found))


# ------------------------------------------------------------------ loops


def loops(source: Source) -> Iterator[str]:
    """Functions with a loop that counts no entries: ``while``, or a ``for`` that only counts."""

    def inner(node: ast.AST, around: tuple[str, ...]) -> Iterator[str]:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, Function | ast.ClassDef):
                yield from inner(child, (*around, child.name))
                continue
            if isinstance(child, ast.While) or (isinstance(child, ast.For) and _counts(child)):
                yield ".".join((source.path.stem, *around))
            yield from inner(child, around)

    yield from inner(source.tree, ())


def _counts(loop: ast.For) -> bool:
    return (
        isinstance(loop.target, ast.Name)
        and loop.target.id.startswith("_")
        and isinstance(loop.iter, ast.Call)
        and ast.unparse(loop.iter.func) in ("range", "count", "itertools.count")
    )


def loop_counts(
    sources: list[Source], packages: Iterable[str], declared: Mapping[str, str]
) -> dict[str, Count]:
    """Loops that step along a path, and undeclared loops."""
    roots = set(packages)
    there = {name for s in sources if s.path.parts[0] in roots for name in loops(s)}
    steps = [f"{n}: {why}" for n, why in declared.items() if n in there and why.startswith("steps")]
    unknown = [f"{name}: not in house.toml" for name in sorted(there - declared.keys())]
    unknown += [f"{name}: no longer there" for name in sorted(declared.keys() - there)]
    return {
        "step loops": Count(len(steps), tuple(steps)),
        "undeclared loops": Count(len(unknown), tuple(unknown)),
    }
