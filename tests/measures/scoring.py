"""What scoring costs: `python -m tests.measures.scoring` prints one row for each claim."""

import json
import math
import resource
import time
from typing import Any, Final

import numpy as np

from harness.comparison.comparator import compare
from harness.comparison.scores import ISO_SAMPLES, rate_by_iso, resampled
from harness.model import pair
from tests.doubles import rocking

PAIRS: Final = 1000
REPEATS: Final = 3
"""Best of several: what other processes do to the clock is no property of the code."""


def measure() -> list[dict[str, Any]]:
    """Rows of what, seconds or ratio, and the target."""
    # Some forty impacts each.
    histories = [rocking(amplitude_rad=amplitude, ratio=0.94) for amplitude in np.linspace(0.02, 0.12, 20)]
    pairs = [(histories[k % 20], histories[(k + 1 + k // 20) % 20]) for k in range(PAIRS)]
    best = min(_seconds(lambda: [compare(a, b) for a, b in pairs]) for _ in range(REPEATS))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    rows = [
        {
            "what": f"{PAIRS} pairs of 10 s at 1 kHz, all scores but ISO, s of processor time",
            "value": best,
            "target": 5.0,
        },
        {"what": "peak memory of that, MiB", "value": memory, "target": 1024.0},
    ]
    both = pair(histories[0], histories[1])
    rate_by_iso(both)  # compiles the library's time warping
    bare, ours = math.inf, math.inf
    for _ in range(REPEATS):
        bare = min(bare, _seconds(lambda: _bare(both)))
        ours = min(ours, _seconds(lambda: rate_by_iso(both)))
    rows.append(
        {
            "what": "ISO/TS 18571 against the library's bare call on the same samples",
            "value": ours / bare,
            "target": 1.2,
        }
    )
    rows.append({"what": "ISO/TS 18571, one pair, s", "value": ours, "target": None})
    return rows


def _bare(both: Any) -> float:
    from objective_rating_metrics.rating import ISO18571

    (a, b), step = resampled(both, ISO_SAMPLES)
    return float(ISO18571(reference_curve=b, comparison_curve=a, dt=step).overall_rating(-1))


def _seconds(work: Any) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


if __name__ == "__main__":
    for row in measure():
        print(json.dumps(row))
