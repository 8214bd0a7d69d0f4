"""Loads and stores without the checks of an index.

The caller's arrays are known to the compiled code by their address only (the caller keeps them alive): an array inside a record
would have a length fixed when the record is laid out. The terms of a series are reached without asking whether the index counts
from the end, which would be asked at every term of every step.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import from_dtype, types
from numba.core import cgutils
from numba.extending import intrinsic

from analytic.kernel.compiler import inlined
from analytic.kernel.layout import EVENT_ROW
from analytic.kernel.records import EventRow, Floats


def _pointer(context: Any, builder: Any, address: Any, i: Any) -> Any:
    pointer = builder.inttoptr(address, context.get_value_type(types.float64).as_pointer())
    return builder.gep(pointer, [i])


def _load(typing_context: Any, address: Any, i: Any) -> Any:
    """Item i of the doubles at the address."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load(_pointer(context, builder, *arguments))

    return types.float64(types.int64, types.int64), code


def _store(typing_context: Any, address: Any, i: Any, value: Any) -> Any:
    """Write item i of the doubles at the address."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.store(arguments[2], _pointer(context, builder, *arguments[:2]))
        return context.get_dummy_value()

    return types.none(types.int64, types.int64, types.float64), code


copy: Callable[..., Any] = cgutils.raw_memcpy


def _row(record: np.dtype[np.void]) -> Any:
    """What finds row i of a table of such records at an address."""
    kind: Any = from_dtype(record)

    def row(typing_context: Any, address: Any, i: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            address, i = arguments
            # A record is known by its address: no row is copied, and a field that is written lands in the caller's table.
            offset = builder.mul(i, context.get_constant(types.int64, record.itemsize))
            return builder.inttoptr(builder.add(address, offset), context.get_value_type(kind))

        return kind(types.int64, types.int64), code

    return row


def _set_row(typing_context: Any, row: Any, record: Any) -> Any:
    """Write all fields of a row of a table at once."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        target, source = arguments
        copy(builder, target, source, context.get_constant(types.int64, record.size), 1)
        return context.get_dummy_value()

    return types.none(row, record), code


def _intrinsic(function: Any) -> Any:
    return intrinsic(function)


def row_at(record: np.dtype[np.void]) -> Any:
    """The compiled function of an address and i that gives row i of a table of such records."""
    return _intrinsic(_row(record))


load_double: Callable[[int, int], float] = _intrinsic(_load)
store_double: Callable[[int, int, float], None] = _intrinsic(_store)
event_row: Callable[[int, int], EventRow] = row_at(EVENT_ROW)
set_row: Callable[[Any, Any], None] = _intrinsic(_set_row)


@inlined
def term(row: Floats, k: int) -> float:
    """row[k], k from 0 on."""
    return float(row[np.uint64(k)])  # an index without a sign is not asked whether it counts from the end: 3 % of a run


@inlined
def set_term(row: Floats, k: int, value: float) -> None:
    """Write row[k], k from 0 on."""
    row[np.uint64(k)] = value
