"""One place for the compiler's options, with types kept; where compiled code is kept is `analytic._cache`."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, update_wrapper
from pathlib import Path
from typing import Any, ClassVar, Final, Generic, ParamSpec, TypeVar

import numba

from analytic._cache import home_of

FUSED: Final = {"contract"}
"""Of all liberties only the fused a·b + c, rounded once where the processor has it. A mirrored run keeps its bits, and so does
any run on the same kind of processor; between those with and without it numbers differ in their last bits."""
P = ParamSpec("P")
R = TypeVar("R")


def _compiled(function: Callable[P, R], cache: bool, forceinline: bool) -> Callable[P, R]:
    config: Any = numba.config
    theirs = config.CACHE_DIR
    place = theirs or home_of(Path(function.__code__.co_filename).resolve().parent)
    # numba reads the folder when it is handed a function; the setting is the user's, and is put back.
    config.CACHE_DIR = str(place or "")
    try:
        # A sweep's threads run at once (nogil); a division by nought gives infinity, without a branch for an exception.
        make: Any = numba.njit(
            cache=cache and bool(place), forceinline=forceinline, nogil=True, error_model="numpy", fastmath=FUSED
        )
        compiled: Callable[P, R] = make(function)
    finally:
        config.CACHE_DIR = theirs
    return compiled


class Inner(Generic[P, R]):
    """A function that others call in compiled code, handed to the compiler when one of them is compiled or when it is called.

    `on_made`, where there is one, is called with how many are made and how many there are, each time that one is.
    """

    made: ClassVar[int] = 0
    total: ClassVar[int] = 0
    on_made: ClassVar[Callable[[int, int], object] | None] = None

    def __init__(self, function: Callable[P, R], cache: bool, forceinline: bool) -> None:
        self._task = function, cache, forceinline
        update_wrapper(self, function)
        Inner.total += 1

    @cached_property
    def _made(self) -> Callable[P, R]:
        Inner.made += 1
        if Inner.on_made is not None:
            Inner.on_made(Inner.made, Inner.total)
        return _compiled(*self._task)

    @property
    def _numba_type_(self) -> Any:
        """What the compiler takes it for, by which it asks any value for its type."""
        made: Any = self._made
        return made._numba_type_

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        return self._made(*args, **kwargs)


def entry(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function in the same way as `jit`: for those that the interpreter calls, without a detour."""
    return _compiled(function, cache=True, forceinline=False)


def c_function(function: Callable[..., None]) -> Any:
    """Compile a function of integers that returns nothing, with all that it calls, for callers outside the interpreter."""
    signature = numba.void(*[numba.int64] * function.__code__.co_argcount)
    return numba.cfunc(signature, error_model="numpy", fastmath=FUSED)(function)


def jit(function: Callable[P, R]) -> Inner[P, R]:
    """Compile a function: cached on disk, without the interpreter's lock, IEEE division, sums in the order written."""
    return Inner(function, cache=True, forceinline=False)


def inlined(function: Callable[P, R]) -> Inner[P, R]:
    """Compile a function in the same way into those that call it: for small ones of every step."""
    return Inner(function, cache=False, forceinline=True)
