"""The part `others` of `rockcheck bench`: `python -m tests.measures.other_integrators TASK [--quick]` prints rows of JSON.

The analytic model beside other integrators, its throughput, its start, and what the harness costs over a baseline loop.
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from typing import Any, Final

from tests.measures import analytic_model, contact_engines, real_scans, start

THROUGHPUT_REPEATS: Final = 10
"""Runs of the map of which the least time counts: another process on the machine may take part of it from several in a row."""


def compute(quick: bool, task: str) -> list[dict[str, Any]]:
    """Rows of the solvers, runs per second of ensembles, cost of a start, of real scans, or over a baseline loop."""
    if task == "solvers":
        return [asdict(row) for row in analytic_model.measure(2 if quick else analytic_model.REPEATS)]
    if task == "throughput":
        rates = analytic_model.throughput(400) if quick else analytic_model.throughput(repeats=THROUGHPUT_REPEATS)
        rates |= {"map": analytic_model.map_time(40 if quick else 200)}
        return [{"throughput": {name: asdict(rate) for name, rate in rates.items()}}]
    if task == "startup":
        return [{"startup": asdict(start.startup(1 if quick else start.STARTS))}]
    if task == "scans":
        return [{"scans": real_scans.measure()}]
    return [{"overhead": contact_engines.overhead(2.0 if quick else 10.0)}]


if __name__ == "__main__":
    for row in compute("--quick" in sys.argv, sys.argv[1]):
        print(json.dumps(row))
