"""Compiling functions of this package: the only module that imports Numba."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, ParamSpec, Protocol, TypeVar, cast

from linkwork.core.foundation.errors import MissingPackageError

try:
    import numba  # this module is loaded when a family is solved
except ModuleNotFoundError:
    needed = 'compiled code needs Numba: pip install "linkwork[fast]"'
    raise MissingPackageError(needed) from None
from llvmlite import binding, ir
from numba import types as types
from numba.core import cgutils
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.ccallback import CFunc
from numba.extending import intrinsic

from linkwork.families.compiled.code_cache import say_that_it_compiles, sources_digest

if TYPE_CHECKING:
    from numba.core.base import BaseContext
    from numba.core.typing.context import Context
    from numba.core.typing.templates import Signature

    #: Writes the code of an intrinsic, from its arguments.
    Emitter = Callable[[BaseContext, ir.IRBuilder, Signature, Sequence[ir.Value]], ir.Value]

_numba: Any = numba  # whose types do not know of all options
#: An array at a pointer, with a shape; in compiled code.
carray: Any = _numba.carray
_OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}}
_P = ParamSpec("_P")
_R_co = TypeVar("_R_co", covariant=True)


class Compiled(Protocol[_P, _R_co]):
    """A compiled function, and the Python that it was compiled from."""

    @property
    def py_func(self) -> Callable[_P, _R_co]: ...

    def __call__(self, *args: _P.args, **options: _P.kwargs) -> _R_co: ...


class Compiling(Protocol):
    """A decorator of functions to be compiled."""

    def __call__(self, function: Callable[_P, _R_co], /) -> Compiled[_P, _R_co]: ...


class CodeFiles(IndexDataCacheFile):
    """The files of a function's compiled code; a file's name depends on what it holds.

    Numba counts the files, and enters a file before it is written: of processes that compile at
    once one could read the code of another signature, or of former sources.
    """

    def save(self, key: object, data: object) -> None:
        """Write the code, then enter it."""
        file: Any = self  # whose methods have no types
        index = Path(file._index_path)
        known: dict[object, str] = file._load_index()
        if not known and index.exists():  # the sources have changed
            for stale in index.parent.glob(f"{index.stem}.*.nbc"):
                stale.unlink(missing_ok=True)
        digest = hashlib.sha256(file._dump((file._source_stamp, key))).hexdigest()[:16]
        name = known.get(key) or f"{index.stem}.{digest}.nbc"
        file._save_data(name, data)
        file._save_index({**file._load_index(), key: name})


class _SourcesCache(FunctionCache):
    """A function's compiled code on disk, valid as long as no source of the kernels changes.

    Numba compares the function's own file only, but compiled code contains, or calls, functions of
    other files.
    """

    def __init__(self, function: Callable[..., object]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        files: Any = CodeFiles
        self._cache_file = files(  # noqa: V101  # Numba reads it
            cache_path=self._cache_path,
            filename_base=self._impl.filename_base,
            source_stamp=(self._impl.locator.get_source_stamp(), sources_digest()),
        )


def _enter_nothing(*_: object) -> None:
    """Enter no function among those that Python can call."""


def _refuse(function: Any, *_: object) -> NoReturn:
    raise TypeError(f"{function.__qualname__} is called by compiled functions only")


def _compiling(signature: object, **options: object) -> Compiling:
    def compile_function(function: Any, /) -> Any:
        made = _numba.njit(nogil=True, **(_OPTIONS | options))(function)
        made._cache = _SourcesCache(function)
        if "no_cpython_wrapper" in options:
            # Python would call a function that is not there
            made._insert = _enter_nothing  # noqa: V101  # Numba calls it
            made._compile_for_args = partial(_refuse, function)  # noqa: V101  # Numba calls it
        if signature is not None:
            made.compile(signature)
            made.disable_compile()
        return made

    return compile_function


def compiled_for(signature: object) -> Compiling:
    """Compiled when the module is loaded, for arrays of the signature; ``None``: at the first
    call, for the arrays that are met.
    """
    return _compiling(signature, no_cfunc_wrapper=True)


compiled = compiled_for(None)


# to compile the way in from Python takes longer than to compile most functions
_WITHIN = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}

#: The same for functions that only compiled ones call: Python cannot.
compiled_within: Compiling = _compiling(None, **_WITHIN)

#: The same for functions that make no arrays: references to their arguments are not counted.
#: Counting would take a fifth of the time.
njit_no_refcount: Compiling = _compiling(None, _nrt=False, **_WITHIN)

#: The same for functions that become part of those that call them, before these are compiled: for
#: short ones, and those that would be compiled for every constant argument.
inlined: Compiling = _compiling(None, _nrt=False, inline="always")
say_that_it_compiles()


def numbers(axes: int) -> types.Type:
    """An array of numbers in a signature."""
    return types.Array(types.float64, axes, "C")


def wholes(axes: int) -> types.Type:
    """An array of whole numbers in a signature."""
    return types.Array(types.int64, axes, "C")


def truths(axes: int) -> types.Type:
    """An array of truth values in a signature."""
    return types.Array(types.boolean, axes, "C")


def named_tuple(fields: list[object], kind: type) -> Any:
    """The type of a NamedTuple in a signature."""
    if len(set(fields)) == 1:  # Numba has a type of its own for these
        return types.NamedUniTuple(fields[0], len(fields), kind)
    return types.NamedTuple(fields, kind)


_intrinsic: Any = cgutils.get_or_insert_function
_BYTES = ir.PointerType(ir.IntType(8))
_BLOCKS = 6  # of numbers, which a trial that is written out is called with


def trial_at(function: Any) -> Any:  # noqa: V103  # printed code calls it
    """A function of six blocks of numbers and a number of lanes, compiled for :data:`call_at`; its
    ``address``, which unlike a function costs nothing to hand over.
    """
    numbers = types.CPointer(types.float64)
    signature = types.void(*[numbers] * _BLOCKS, types.int64)
    # its file has a name that depends on all sources
    return _numba.cfunc(signature, cache=True, **_OPTIONS)(function)


def _call(
    typing: Context,
    address: types.Type,
    one: types.Type,
    two: types.Type,
    three: types.Type,
    four: types.Type,
    five: types.Type,
    six: types.Type,
    lanes: types.Type,
) -> tuple[Signature, Emitter]:
    def code(
        context: BaseContext,
        builder: ir.IRBuilder,
        signature: Signature,
        arguments: Sequence[ir.Value],
    ) -> ir.Value:
        number = ir.PointerType(ir.DoubleType())
        kind = ir.FunctionType(ir.VoidType(), [*[number] * _BLOCKS, ir.IntType(64)])
        function = builder.inttoptr(arguments[0], ir.PointerType(kind))
        blocks = [builder.inttoptr(a, number) for a in arguments[1:-1]]
        builder.call(function, [*blocks, arguments[-1]])
        return context.get_dummy_value()

    return types.void(*[types.int64] * (2 + _BLOCKS)), code


#: Calls a function compiled by :func:`trial_at`, by its address, with the addresses of six blocks
#: and the number of lanes.
call_at = cast(Callable[[int, int, int, int, int, int, int, int], None], intrinsic(_call))


_NAMED: list[object] = []  # functions that are called by name have to stay


def called_by_name(name: str, *kinds: types.Type) -> Callable[[Any], Callable[..., int]]:
    """A decorator of functions that compiled code calls without holding a copy of them.

    Copies would take the compiler most of its time. What it makes is called with one tuple of
    whole numbers, addresses where ``kinds`` has pointers, and returns a whole number.
    """
    signature = types.int64(*kinds)

    def compile_apart(function: Any) -> Callable[..., int]:
        made: Any = CFunc(function, (signature.args, signature.return_type), {}, _OPTIONS)
        made._cache = _SourcesCache(function)
        made.compile()
        _NAMED.append(made)
        binding.add_symbol(name, made.address)

        def call(typing: Context, given: types.Type) -> tuple[Signature, Emitter]:
            def emit(
                context: BaseContext,
                builder: ir.IRBuilder,
                signature: Signature,
                arguments: Sequence[ir.Value],
            ) -> ir.Value:
                wanted = [context.get_value_type(kind) for kind in kinds]
                kind = ir.FunctionType(ir.IntType(64), wanted)
                values = [
                    builder.inttoptr(value, own) if isinstance(own, ir.PointerType) else value
                    for value, own in zip(
                        cgutils.unpack_tuple(builder, arguments[0]), wanted, strict=True
                    )
                ]
                return builder.call(_intrinsic(builder.module, kind, name), values)

            return types.int64(types.UniTuple(types.int64, len(kinds))), emit

        return cast(Callable[..., int], intrinsic(call))

    return compile_apart


def _copy(
    typing: Context, to: types.Type, source: types.Type, count: types.Type
) -> tuple[Signature, Emitter]:
    def code(
        context: BaseContext,
        builder: ir.IRBuilder,
        signature: Signature,
        arguments: Sequence[ir.Value],
    ) -> ir.Value:
        target, origin = (builder.inttoptr(a, _BYTES) for a in arguments[:2])
        cgutils.raw_memcpy(builder, target, origin, arguments[2], 8)
        return context.get_dummy_value()

    return types.void(types.int64, types.int64, types.int64), code


#: Copies numbers, at once, to an address from another one; ``count`` of them.
memcpy = cast(Callable[[int, int, int], None], intrinsic(_copy))


def _prefetch(typing: Context, address: types.Type) -> tuple[Signature, Emitter]:
    def code(
        context: BaseContext,
        builder: ir.IRBuilder,
        signature: Signature,
        arguments: Sequence[ir.Value],
    ) -> ir.Value:
        whole = ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [_BYTES, whole, whole, whole])
        fetch = _intrinsic(builder.module, kind, "llvm.prefetch.p0")
        place = builder.inttoptr(arguments[0], _BYTES)
        builder.call(fetch, [place, whole(1), whole(3), whole(1)])  # to write, to keep, data
        return context.get_dummy_value()

    return types.void(types.int64), code


#: Says that the cache line of an address will be written to.
prefetch = cast(Callable[[int], None], intrinsic(_prefetch))
