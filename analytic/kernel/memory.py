"""Reaching numbers without the checks of an index: arrays that the compiled code only borrows, by their address (the caller keeps
them alive), and the rows of the workspace (an index from the end is not looked for, which would be asked at every term).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import types
from numba.extending import intrinsic

from analytic.kernel.layout import Floats


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


def _place(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Where item k of a row of the table w stands, whose rows follow each other."""
    kind, (w, row, k) = signature.args[0], arguments[:3]
    table = context.make_array(kind)(context, builder, w)
    if isinstance(kind, types.NestedArray):
        columns = context.get_constant(types.int64, kind.shape[1])
    else:
        columns = builder.extract_value(table.shape, 1)
    return builder.gep(table.data, [builder.add(builder.mul(row, columns), k)])


def _term(typing_context: Any, w: Any, row: Any, k: Any) -> Any:
    """w[row, k], k from 0 on, of a table of doubles whose rows follow each other."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load(_place(context, builder, signature, arguments))

    return types.float64(w, types.int64, types.int64), code


def _set_term(typing_context: Any, w: Any, row: Any, k: Any, value: Any) -> Any:
    """Write w[row, k], k from 0 on, of a table of doubles whose rows follow each other."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.store(arguments[3], _place(context, builder, signature, arguments))
        return context.get_dummy_value()

    return types.none(w, types.int64, types.int64, types.float64), code


_compiled_peek: Any = intrinsic(_peek)
_compiled_poke: Any = intrinsic(_poke)
_compiled_term: Any = intrinsic(_term)
_compiled_set_term: Any = intrinsic(_set_term)
peek: Callable[[int, int], float] = _compiled_peek
poke: Callable[[int, int, float], None] = _compiled_poke
term: Callable[[Floats, int, int], float] = _compiled_term
set_term: Callable[[Floats, int, int, float], None] = _compiled_set_term
