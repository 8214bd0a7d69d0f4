"""One place for the compiler's options, with types kept; what is compiled is kept by `analytic.machine_code`.

By itself the compiler optimises each function with all that it calls, and makes it native, before what calls it is compiled: a
function at the bottom of ten is worked through ten times. Here a function that others call is only lowered; it is optimised and
made native once, in what the interpreter enters. That takes a quarter to a half of the time, and what comes out is faster.
"""

from collections.abc import Callable
from functools import cache, cached_property, update_wrapper
from typing import Any, ClassVar, Final, Generic, ParamSpec, Protocol, TypeVar

import llvmlite.binding as llvm
import numba
import numpy as np
from numba import from_dtype, types
from numba.core.ccallback import CFunc
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen
from numba.core.registry import CPUTarget, cpu_target
from numba.extending import intrinsic

from analytic.kernel.records import Floats

FUSED: Final = {"contract"}
"""Of all liberties only the fused a·b + c, rounded once where the processor has it. A mirrored run keeps its bits, and so does
any run on the same kind of processor; between those with and without it numbers differ in their last bits."""
OPTIONS: Final[dict[str, object]] = {"nogil": True, "error_model": "numpy", "fastmath": FUSED}
"""A sweep's threads run at once; a division by nought gives infinity, without a branch for an exception."""
_njit: Any = numba.njit
"""With the options that its published types leave out."""
P = ParamSpec("P")
R = TypeVar("R")
Item = TypeVar("Item")


class _Part(JITCodeLibrary):
    """The lowered code of a function that is only compiled into others."""

    def finalize(self) -> None:
        """Neither optimise nor make native."""
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Nobody calls it from outside."""
        return 0

    def _get_module_for_linking(self) -> Any:
        """All that it needs, each part once."""
        whole, needed = self._final_module.clone(), dict.fromkeys(self._linking_libraries)
        waiting = list(needed)
        while waiting:
            part = waiting.pop()
            if isinstance(part, _Part):
                whole.link_in(part._final_module.clone())
                more = dict.fromkeys(each for each in part._linking_libraries if each not in needed)
                waiting += more
                needed |= more
        for other in needed:
            if not isinstance(other, _Part):  # whole by itself: LLVM takes what of it is called by now
                whole.link_in(other._get_module_for_linking(), preserve=True)
        for function in whole.functions:
            if not function.is_declaration and function.linkage == llvm.Linkage.external:
                function.linkage = "linkonce_odr"  # may be linked again, and is left out where nothing calls it
        return whole


class _Parts(JITCPUCodegen):
    """Makes parts."""

    _library_class = _Part

    def set_env(self, env_name: str, env: object) -> None:
        """Native code alone has an environment."""


@cache
def _parts() -> Any:
    """The compiler's own target, but that it makes parts."""

    codegen: Any = _Parts

    class Target(CPUTarget):
        typing_context = cpu_target.typing_context
        target_context = cpu_target.target_context.subtarget(_internal_codegen=codegen("parts"))

    target: Any = Target
    return target("parts")


class Inner(Generic[P, R]):
    """A function that others call in compiled code, handed to the compiler when one of them is compiled or when it is called.

    `on_made`, where there is one, is called with how many are made and how many there are, each time that one is.
    """

    made: ClassVar[int] = 0
    total: ClassVar[int] = 0
    on_made: ClassVar[Callable[[int, int], object] | None] = None

    def __init__(self, function: Callable[P, R], forceinline: bool) -> None:
        self._function, self._forceinline = function, forceinline
        update_wrapper(self, function)
        Inner.total += 1

    @cached_property
    def _part(self) -> Any:
        """As others call it."""
        Inner.made += 1
        if Inner.on_made is not None:
            Inner.on_made(Inner.made, Inner.total)
        part: Any = _njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, forceinline=self._forceinline, **OPTIONS)(
            self._function
        )
        part._compiler.targetdescr = _parts()
        return part

    @cached_property
    def _made(self) -> Callable[P, R]:
        """As the interpreter calls it, which only tests and measurements do: compiled by each process."""
        compiled: Callable[P, R] = _njit(**OPTIONS)(self._function)
        return compiled

    @property
    def _numba_type_(self) -> Any:
        """What the compiler takes it for, by which it asks any value for its type."""
        return self._part._numba_type_

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        return self._made(*args, **kwargs)


def c_function(function: Callable[..., None]) -> Any:
    """Compile a function of integers that returns nothing, with all that it calls, for callers outside the interpreter."""
    return numba.cfunc(_signature(function), error_model="numpy", fastmath=FUSED)(function)


def c_code(function: Callable[..., None]) -> tuple[str, str]:
    """Symbol and optimised LLVM text of such a function: with nothing else to be called from outside, more of it is inlined."""

    class Entry(CFunc):
        _targetdescr = _parts()

    signature = _signature(function)
    entry: Any = Entry(
        function, (signature.args, signature.return_type), {}, {"error_model": "numpy", "fastmath": FUSED}
    )
    entry.compile()
    part = entry._library
    part._final_module = part._get_module_for_linking()
    for each in part._final_module.functions:
        if not each.is_declaration:
            each.linkage = "external" if each.name == entry.native_name else "internal"
    part._optimize_final_module()
    return entry.native_name, part.get_llvm_str()


def _signature(function: Callable[..., None]) -> Any:
    return numba.void(*[numba.int64] * function.__code__.co_argcount)


def jit(function: Callable[P, R]) -> Inner[P, R]:
    """Compile a function: without the interpreter's lock, IEEE division, sums in the order written."""
    return Inner(function, forceinline=False)


def inlined(function: Callable[P, R]) -> Inner[P, R]:
    """Compile a function in the same way into those that call it: for small ones of every step."""
    return Inner(function, forceinline=True)


# Loads and stores without the checks of an index.
#
# The caller's arrays are known to the compiled code by their address only (the caller keeps them alive):
# an array inside a record would have a length fixed when the record is laid out. The terms of a series are
# reached without asking whether the index counts from the end, which would be asked at every term of every
# step.


class Cell(Protocol[Item]):
    """One place of a table: what stands there, a record by its address, to be read or written as a whole or field by field."""

    item: Item


def cell_at(kind: Any, item: type[Item]) -> Callable[[int, int], Cell[Item]]:
    """The compiled function of an address and i that gives cell i of a table of numbers or records there: `kind` to numpy,
    `item` to the type checker."""
    record = np.dtype([("item", kind)], align=True)
    cell: Any = from_dtype(record)

    def find(typing_context: Any, address: Any, i: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            address, i = arguments
            # A record is known by its address: nothing is copied, and what is written lands in the caller's table.
            offset = builder.mul(i, context.get_constant(types.int64, record.itemsize))
            return builder.inttoptr(builder.add(address, offset), context.get_value_type(cell))

        return cell(types.int64, types.int64), code

    compiled: Any = intrinsic
    made: Callable[[int, int], Cell[Item]] = compiled(find)
    return made


double: Final = cell_at(np.float64, float)


@inlined
def load_double(address: int, i: int) -> float:
    """Item i of the doubles at the address."""
    return double(address, i).item


@inlined
def store_double(address: int, i: int, value: float) -> None:
    """Write item i of the doubles at the address."""
    double(address, i).item = value


@inlined
def term(row: Floats, k: int) -> float:
    """row[k], k from 0 on."""
    return float(row[np.uint64(k)])  # an index without a sign is not asked whether it counts from the end: 3 % of a run


@inlined
def set_term(row: Floats, k: int, value: float) -> None:
    """Write row[k], k from 0 on."""
    row[np.uint64(k)] = value
