"""What the analytic model costs to start: its import against that of numpy and numba, a first call against a trivial one."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
from typing import Final

from harness.records.bench import Start

STARTS: Final = 9
"""Processes of each kind of start."""
_MODELS_OWN: Final = "import analytic as a; b = a.Block.rectangle(width_m=0.2, height_m=1.0); r = a.Rest()"
_STARTS: Final = {
    "import": ("import numpy, numba", "import analytic; analytic.simulate"),
    "trivial kernel": ("from harness.bench.trivial import add", "add(1.0)"),
    "analytic kernel": (_MODELS_OWN + "; f = a.simulate", "f(b, r, duration_s=0.01)"),
}
_PROGRAM: Final = """
import gc, time
{collecting}
s = time.process_time()
{first}
m = time.process_time()
{second}
print(m - s, time.process_time() - m)
"""
_COLLECTING: Final = {True: "", False: "gc.disable()"}


def timed(first: str, second: str, collecting: bool) -> tuple[float, float]:
    """Processor seconds of two steps, one after the other in a process of their own."""
    program = _PROGRAM.format(collecting=_COLLECTING[collecting], first=first, second=second)
    # an installed package has its bytecode, so a source tree must be let keep it: else each start translates the sources again
    surroundings = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    command = [sys.executable, "-c", program]
    printed = subprocess.run(command, env=surroundings, capture_output=True, text=True, check=True).stdout.split()
    return float(printed[0]), float(printed[1])


def startup(repeats: int = STARTS) -> Start:
    """Processor seconds to import analytic against numpy and numba, and of a first call from the cache against a trivial one.

    Kinds of start take turns, after one turn that does not count. The imports are timed in one process, where a processor that
    others use as well slows both alike: the median of all; a first call is the least of all. The ratios of `uncollected` are
    those without the interpreter's collection of garbage: numba's import ends some hundred objects short of the first round
    over everything, which falls on whoever comes next.
    """
    times: dict[tuple[str, bool], list[tuple[float, float]]] = {}
    kinds = [(name, collecting) for collecting in _COLLECTING for name in _STARTS]
    for turn in range(repeats + 1):
        for kind in kinds if turn % 2 else reversed(kinds):
            timings = timed(*_STARTS[kind[0]], kind[1])
            if turn > 0:
                times.setdefault(kind, []).append(timings)
    ratios = {}
    for collecting in _COLLECTING:
        called = {name: min(second for _, second in times[name, collecting]) for name in _STARTS}
        ratios[collecting] = {
            "import_ratio": statistics.median(
                (first + second) / first for first, second in times["import", collecting]
            ),
            "first_call_ratio": called["analytic kernel"] / called["trivial kernel"],
        }
    return Start(
        statistics.median(first + second for first, second in times["import", True]),
        min(second for _, second in times["analytic kernel", True]),
        uncollected=ratios[False],
        **ratios[True],
    )
