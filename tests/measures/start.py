"""What the analytic model costs to start: its import against that of numpy and numba, a first call against a trivial one."""

import os
import subprocess
import sys
from dataclasses import dataclass
from typing import Final

STARTS: Final = 9
"""Processes of each kind of start."""
_MODELS_OWN: Final = (
    "import analytic as a; b = a.Block.rectangle(width_m=0.2, height_m=1.0); r = a.Rest(); f = a.simulate"
)
_STARTS: Final = {
    "libraries": ("import numpy, numba", ""),
    "analytic": ("import analytic; analytic.simulate", ""),
    "trivial kernel": ("from tests.measures.trivial import add", "add(1.0)"),
    "analytic kernel": (_MODELS_OWN, "f(b, r, duration_s=0.01)"),
}
_PROGRAM: Final = """
import time
s = time.process_time()
{first}
m = time.process_time()
{second}
print(m - s, time.process_time() - m)
"""


@dataclass(frozen=True)
class StartRow:
    """Seconds to import the model and for its first call, and their ratios to numpy's and numba's import and a trivial call."""

    import_s: float
    first_call_s: float
    import_ratio: float
    first_call_ratio: float


def timed(first: str, second: str) -> tuple[float, float]:
    """Processor seconds of two steps, one after the other in a process of their own."""
    # an installed package has its bytecode, so a source tree must be let keep it: else each start translates the sources again
    surroundings = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    command = [sys.executable, "-c", _PROGRAM.format(first=first, second=second)]
    printed = subprocess.run(command, env=surroundings, capture_output=True, text=True, check=True).stdout.split()
    return float(printed[0]), float(printed[1])


def startup(repeats: int = STARTS) -> StartRow:
    """Processor seconds to import analytic and of its first call from the cache, and their ratios: to importing numpy and numba,
    and to a trivial function that numba compiled and kept.

    Kinds of start take turns, after one turn that does not count; the least of each counts.
    """
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in _STARTS}
    for turn in range(repeats + 1):
        for name in _STARTS if turn % 2 else reversed(_STARTS):
            timings = timed(*_STARTS[name])
            if turn > 0:
                times[name].append(timings)
    imported, called = ({name: min(each[k] for each in rows) for name, rows in times.items()} for k in (0, 1))
    return StartRow(
        imported["analytic"],
        called["analytic kernel"],
        import_ratio=imported["analytic"] / imported["libraries"],
        first_call_ratio=called["analytic kernel"] / called["trivial kernel"],
    )
