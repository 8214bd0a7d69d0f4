"""Where the fields of a record stand in memory: for numpy, which the compiler reads, and for packing without numpy."""

from __future__ import annotations

from struct import Struct
from typing import Annotated, Any, Final, get_args, get_origin, get_type_hints

import numpy as np

from analytic.kernel.records import Base, Counts, EventRow, Floats, Ints, MotionParams, Params, Results, State, Task

_PLAIN: Final[dict[Any, tuple[str, type]]] = {float: ("d", np.float64), int: ("q", np.int64), bool: ("?", np.bool_)}
_ITEMS: Final[dict[Any, type]] = {Floats: np.float64, Ints: np.int64}
"""Of arrays of a stated shape; other items are records."""


def layout(record: type) -> np.dtype[np.void]:
    """The numpy record with the fields of a class of records, each where a C compiler would put it."""
    fields: list[tuple[Any, ...]] = []
    for name, hint in get_type_hints(record, include_extras=True).items():
        if get_origin(hint) is Annotated:
            items, shape = hint.__origin__, hint.__metadata__[0]
            fields.append((name, _ITEMS[items] if items in _ITEMS else layout(get_args(items)[0]), shape))
        else:
            fields.append((name, _PLAIN[hint][1] if hint in _PLAIN else layout(hint)))
    # align=True pads as the native format of `struct` does: `packing` then writes where this record is read.
    return np.dtype(fields, align=True)


def packing(record: type) -> Struct:
    """Packs and unpacks a record without others in it, in the same places: some ten times faster than numpy, item by item."""
    return Struct("".join(_PLAIN[hint][0] for hint in get_type_hints(record).values()))


def row(record: Any) -> tuple[Any, ...]:
    """The fields of a record one after another."""
    return tuple(vars(record).values())


TASK: Final = layout(Task)
PARAMS: Final = layout(Params)
MOTION_PARAMS: Final = layout(MotionParams)
BASE: Final = layout(Base)
STATE: Final = layout(State)
RESULTS: Final = layout(Results)
COUNTS: Final = layout(Counts)
EVENT_ROW: Final = layout(EventRow)
