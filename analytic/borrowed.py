"""Arrays that the compiled code only borrows: it reaches them by their address, the caller keeps them alive."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import types
from numba.extending import intrinsic


def _item(context: Any, builder: Any, address: Any, i: Any) -> Any:
    pointer = builder.inttoptr(address, context.get_value_type(types.float64).as_pointer())
    return builder.gep(pointer, [i])


def _peek(typing_context: Any, address: Any, i: Any) -> Any:
    """Item i of the doubles at the address."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load(_item(context, builder, *arguments))

    return types.float64(types.int64, types.int64), code


def _poke(typing_context: Any, address: Any, i: Any, value: Any) -> Any:
    """Write item i of the doubles at the address."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.store(arguments[2], _item(context, builder, *arguments[:2]))
        return context.get_dummy_value()

    return types.none(types.int64, types.int64, types.float64), code


_compiled_peek: Any = intrinsic(_peek)
_compiled_poke: Any = intrinsic(_poke)
peek: Callable[[int, int], float] = _compiled_peek
poke: Callable[[int, int, float], None] = _compiled_poke
