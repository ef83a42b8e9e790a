"""The device that a march runs on, and whether its equations are compiled for it."""

from __future__ import annotations

import hashlib
import importlib.util
import logging
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from threading import RLock
from typing import TYPE_CHECKING, Any, NoReturn, ParamSpec, Protocol, TypeVar, cast

from llvmlite import binding, ir
from numba import types as types
from numba.core import cgutils
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.ccallback import CFunc
from numba.extending import intrinsic

from linkwork.core.foundation.errors import InputError, MissingPackageError
from linkwork.core.foundation.files import CACHE_VARIABLE, cache_folder, user_cache
from linkwork.core.record.recorder import ROLES

if TYPE_CHECKING:
    from numba.core.base import BaseContext
    from numba.core.typing.context import Context
    from numba.core.typing.templates import Signature

#: Devices that a march can run on.
DEVICES = ("cpu", "gpu")


# Compiling takes some 5 ms for each instruction, of which a position then costs 0.1 ns less.
_PAYS = 100_000_000  # positions


_PAYS_COMPILED = 1_000_000  # where an earlier run has left its compiled code


_LONGEST = 4_000  # instructions: the compiler's time grows faster than they do


@dataclass(frozen=True, kw_only=True)
class Execution:
    """Whether the trial of a topology is written out and compiled, or done by the interpreter.

    Parameters
    ----------
    specialised : bool, optional
        Asked for; by default it is whatever takes less time for this many ``positions``.
    positions : int
    device : str
        Where it runs, one of :data:`DEVICES`; a graphics card runs compiled programs only.

    Raises
    ------
    InputError
        For another device, or for a graphics card that should compile nothing.
    """

    specialised: bool | None = None
    positions: int = 0
    device: str = "cpu"

    def __post_init__(self) -> None:
        if self.device not in DEVICES:
            raise InputError(
                f'there is no device "{self.device}" (there are: {", ".join(DEVICES)})'
            )
        if self.device == "gpu" and self.specialised is False:
            raise InputError(
                "a graphics card runs compiled equations only: leave out "
                'specialised=False or device="gpu"'
            )

    def pays(self, instructions: int) -> bool:
        """Whether compiling programs of this many instructions in all turns saves time."""
        return self.positions >= _PAYS and instructions <= ROLES * _LONGEST

    def pays_compiled(self, instructions: int) -> bool:
        """Whether loading code that an earlier run has compiled saves time."""
        return self.positions >= _PAYS_COMPILED and instructions <= ROLES * _LONGEST


# ----------------------------------------------------------------------
# Whether compiled code exists already; found without loading it, or Numba.


#: The loop over solution paths of a homotopy.
PATH_LOOP = "paths.path_kernel"
#: Modules with loops over lanes, and the function of each that takes long to compile.
LOOPS = {"march.independent": "march", "march.lockstep": "in_step", PATH_LOOP: "follow_paths"}
_COMPILED = (
    "core/numerics/marching.py", "core/record/*.py", "families/compiled/*.py", "families/gpu/*.py",
    "families/march/*.py", "families/paths/*.py",
)  # fmt: skip


def has_compiler() -> bool:
    """Whether Numba is installed: the extra ``fast``."""
    with suppress(ModuleNotFoundError):
        return importlib.util.find_spec("numba") is not None
    return False


def is_loaded(loop: str) -> bool:
    """Whether this process has a loop in use."""
    return f"linkwork.families.{loop}" in sys.modules


def is_compiled(loop: str) -> bool:
    """Whether an earlier process has left a loop compiled: next to its source, in the user's cache
    where that cannot be written to, or in the folder named by ``NUMBA_CACHE_DIR``.
    """
    digest = sources_digest()
    return any(digest in index.read_bytes() for index in _indices(loop))


@cache
def sources_digest() -> bytes:
    """A digest of all sources that are compiled; code compiled from others is out of date."""
    package = Path(__file__).parents[2]
    digest = hashlib.sha256()
    for pattern in _COMPILED:
        for path in sorted(package.glob(pattern)):
            digest.update(path.read_bytes())
    return digest.digest()


def _indices(loop: str) -> Iterator[Path]:
    """Numba's index files of a loop."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    shared = Path(given) if given else user_cache("numba", False)
    package, module = loop.split(".")
    folders = list(shared.glob(f"{package}_*"))
    if not given:
        folders.append(Path(__file__).parents[1] / package / "__pycache__")
    for folder in folders:
        yield from folder.glob(f"{module}.{LOOPS[loop]}-*.nbi")


def say_that_it_compiles(loop: str = "") -> None:
    """Warn once in the log ``linkwork`` that compiling takes time, if it will.

    Without a loop: whether what all of them share was compiled, with any of them.
    """
    if not any(map(is_compiled, (loop,) if loop else LOOPS)):
        _warn_that_it_compiles()


@cache
def _warn_that_it_compiles() -> None:
    logging.getLogger("linkwork").warning(
        "compiling Linkwork's kernels, once after an installation: up to half a minute "
        '("linkwork compile" compiles all of them beforehand)'
    )


# ----------------------------------------------------------------------
# Programs written out as modules of their own, in a folder where compiled code is kept.


_ONE_AT_A_TIME = RLock()  # a module is among the known ones before it is whole


def load_compiled(source: str, function: str) -> Any:
    """A function of a module of which the source is given; compiled at most once.

    Raises
    ------
    InputError
        If nothing can be written to the folder of the cache.
    """
    name = _name(source)
    with _ONE_AT_A_TIME:
        known = sys.modules.get(name)
        if known is None:
            path = _path(name)
            if not path.exists() or path.read_text(encoding="utf-8") != source:
                _write(path, source)
            known = _load_module(name, path)
    return getattr(known, function)


def is_cached(source: str) -> bool:
    """Whether the module is there already, so that it costs next to nothing."""
    return _name(source) in sys.modules or _path(_name(source)).exists()


def _path(name: str) -> Path:
    return cache_folder("kernels") / f"{name}.py"


def _name(source: str) -> str:
    """The name of a module: a digest of its text and of all sources it is compiled with."""
    digest = hashlib.sha256(source.encode() + sources_digest())
    return f"linkwork_kernel_{digest.hexdigest()[:24]}"


def _write(path: Path, source: str) -> None:
    """Write the file whole or not at all, also while other processes write it."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(
            "w", dir=path.parent, suffix=".part", delete=False, encoding="utf-8"
        ) as part:
            part.write(source)
        os.replace(part.name, path)
    except OSError as error:
        raise InputError(
            f"compiled code cannot be stored in {path.parent} ({error.strerror}): "
            f"name another folder in {CACHE_VARIABLE}, or use specialised=False"
        ) from None


def _load_module(name: str, path: Path) -> Any:
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


# ----------------------------------------------------------------------
# Compiling functions of this package: the only module that imports Numba.


try:
    import numba  # this module is loaded when a family is solved
except ModuleNotFoundError:
    needed = 'compiled code needs Numba: pip install "linkwork[fast]"'
    raise MissingPackageError(needed) from None


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
