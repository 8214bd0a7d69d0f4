"""What the analytic model costs to start: its import against that of numpy and numba, a first call against a trivial one."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from typing import Any, Final

STARTS: Final = 9
"""Processes of each kind of start of which the least time counts."""
_MODELS_OWN: Final = "import analytic as a; b = a.Block.rectangle(width_m=0.2, height_m=1.0); r = a.Rest()"
_STARTS: Final = {
    "numpy and numba": ("import numpy, numba", ""),
    "analytic": ("import analytic; analytic.simulate", ""),
    "trivial kernel": ("from harness.bench_trivial import add", "add(1.0)"),
    "analytic kernel": (_MODELS_OWN + "; f = a.simulate", "f(b, r, duration_s=0.01)"),
}
_PROGRAM: Final = """
import gc, time
{collecting}
s = time.process_time()
{imports}
m = time.process_time()
{call}
print(m - s, time.process_time() - m)
"""
_COLLECTING: Final = {True: "", False: "gc.disable()"}


def timed(imports: str, call: str, collecting: bool) -> tuple[float, float]:
    """Processor seconds of the imports and of the call, in a process of its own."""
    program = _PROGRAM.format(collecting=_COLLECTING[collecting], imports=imports, call=call)
    # an installed package has its bytecode, so a source tree must be let keep it: else each start translates the sources again
    surroundings = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    command = [sys.executable, "-c", program]
    told = subprocess.run(command, env=surroundings, capture_output=True, text=True, check=True).stdout.split()
    return float(told[0]), float(told[1])


def startup(repeats: int = STARTS) -> dict[str, Any]:
    """Processor seconds to import analytic against numpy and numba, and of a first call from the cache against a trivial one.

    Each the least of several processes that take turns, after one turn that does not count. The ratios of `uncollected` are
    those without the interpreter's collection of garbage: numba's import ends some hundred objects short of the first round
    over everything, which falls on whoever comes next.
    """
    least = {(name, collecting): (math.inf, math.inf) for collecting in _COLLECTING for name in _STARTS}
    for turn in range(repeats + 1):
        for name, collecting in least if turn % 2 else reversed(least):
            found = timed(*_STARTS[name], collecting)
            if turn > 0:
                known = least[name, collecting]
                least[name, collecting] = min(known[0], found[0]), min(known[1], found[1])
    ratios = {
        collecting: {
            "import_ratio": least["analytic", collecting][0] / least["numpy and numba", collecting][0],
            "first_call_ratio": least["analytic kernel", collecting][1] / least["trivial kernel", collecting][1],
        }
        for collecting in _COLLECTING
    }
    seconds = {"import_s": least["analytic", True][0], "first_call_s": least["analytic kernel", True][1]}
    return seconds | ratios[True] | {"uncollected": ratios[False]}
