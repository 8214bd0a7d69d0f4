"""Where the fields of a record stand in memory: for numpy, which the compiler reads, and for packing without numpy."""

from __future__ import annotations

from struct import Struct
from typing import Any, Final, get_type_hints

import numpy as np

from analytic.kernel.records import (
    TERMS,
    Base,
    Counts,
    EventRow,
    Floats,
    MotionParams,
    Params,
    Results,
    State,
    Task,
)

_PLAIN: Final[dict[Any, tuple[str, tuple[Any, ...]]]] = {
    float: ("d", (np.float64,)),
    int: ("q", (np.int64,)),
    bool: ("?", (np.bool_,)),
    Floats: (f"{TERMS}d", (np.float64, TERMS)),
}


def layout(record: type) -> np.dtype[np.void]:
    """The numpy record with the fields of a class of this module, each where a C compiler would put it."""
    hints = get_type_hints(record).items()
    return np.dtype(
        # align=True pads as the native format of `struct` does: `packing` then writes where this record is read.
        [(name, *(_PLAIN[hint][1] if hint in _PLAIN else (layout(hint),))) for name, hint in hints],
        align=True,
    )


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
