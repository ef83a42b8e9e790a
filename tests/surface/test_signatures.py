"""Signatures of the public interface have public types."""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Iterator
from operator import attrgetter

import pytest

import linkwork as lw
from linkwork.core.foundation.errors import internal_members
from scripts.docsite.api_page import ALIASES, public_members, public_names

_OUTSIDE = {
    "Any", "Callable", "Counter", "Iterable", "Iterator", "Mapping", "None", "Path", "Self",
    "Sequence", "bool", "bytes", "complex", "dict", "float", "int", "list", "object", "set",
    "slice", "str", "tuple",
}  # fmt: skip
_THIRD_PARTY = {"AnyWidget", "Axes", "DataFrame", "Dataset"}


def type_names(annotation: object) -> set[str]:
    """The names of types in an annotation, without module names and literal values."""
    text = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    text = re.sub(r"Literal\[[^]]*\]|\w+\.(?=\w)", "", text)
    return set(re.findall(r"[A-Za-z_]\w*", text))


def annotated(name: str) -> Iterator[tuple[str, object]]:
    """Each annotation of a public function, or of a class with its public members."""
    public = attrgetter(name)(lw)
    if not inspect.isclass(public):
        yield from ((f"{name}: {key}", kind) for key, kind in public.__annotations__.items())
        return
    hidden = internal_members(public)
    if dataclasses.is_dataclass(public):
        fields = [field for field in dataclasses.fields(public) if field.name not in hidden]
        yield from ((f"{name}.{field.name}", field.type) for field in fields)
    for member, function in public_members(public):
        kinds = getattr(function, "__annotations__", {})
        yield from ((f"{name}.{member}: {key}", kind) for key, kind in kinds.items())


@pytest.mark.parametrize("name", public_names())
def test_no_private_type_is_in_a_public_signature(name: str) -> None:
    known = {*_OUTSIDE, *_THIRD_PARTY, *ALIASES}
    known |= {public.rpartition(".")[2] for public in public_names()}
    private = {place: type_names(kind) - known for place, kind in annotated(name)}
    assert {place: names for place, names in private.items() if names} == {}


def test_every_internal_member_exists() -> None:
    for name in public_names():
        public = attrgetter(name)(lw)
        if inspect.isclass(public):
            own = [{*vars(kind), *vars(kind).get("__annotations__", ())} for kind in public.__mro__]
            taken = getattr(public.__init__, "__annotations__", {})
            made = set[str]().union(*own, taken)
            assert internal_members(public) <= made, name
