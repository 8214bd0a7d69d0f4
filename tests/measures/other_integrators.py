"""The analytic model beside other integrators, its throughput, its start, scans, and what the harness costs over a baseline loop.

`python -m tests.measures.other_integrators [--quick]` measures them one after the other, prints them and keeps them in
out/bench_others.json, which `tests.measures.goals` reads.
"""

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

from harness.records.base import part
from tests.measures import analytic_model, contact_engines, real_scans, start
from tests.measures.analytic_model import SolverRow, Throughput
from tests.measures.start import StartRow

KEPT: Final = Path("out/bench_others.json")
THROUGHPUT_REPEATS: Final = 10
"""Runs of the map of which the least time counts: another process on the machine may take part of it from several in a row."""
COMPARED: Final = {
    ("analytic", "scipy DOP853"): (1e-6, 1e-9),
    ("analytic", "heyoka"): (1e-10, 1e-12),
    ("analytic, kernel alone", "heyoka"): (1e-10, 1e-12),
}
"""Solvers that are compared, and at which errors, rad."""


@dataclass(frozen=True)
class Others:
    """What is measured: rows of solvers, runs of the compiled model by kind, its start, times real time of scans in pybullet, and
    of whole pymunk runs over a baseline loop."""

    solvers: Sequence[SolverRow] = ()
    throughput: Mapping[str, Throughput] = field(default_factory=dict)
    startup: StartRow | None = None
    overhead: Mapping[str, float] = field(default_factory=dict)
    scans: Mapping[str, float] = field(default_factory=dict)


def measure(quick: bool) -> Others:
    """Everything, one after the other: what takes turns may share the machine, speeds stand by themselves."""
    rates = analytic_model.throughput(400) if quick else analytic_model.throughput(repeats=THROUGHPUT_REPEATS)
    return Others(
        analytic_model.measure(2 if quick else analytic_model.REPEATS),
        {**rates, "map": analytic_model.map_time(40 if quick else 200)},
        start.startup(1 if quick else start.STARTS),
        contact_engines.overhead(2.0 if quick else 10.0),
        {} if quick else real_scans.measure(),
    )


def read(path: Path) -> Others:
    """What was measured; nothing where it was not. Raises `InputError` for a file that is damaged."""
    if not path.is_file():
        return Others()
    content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return part(Others, content, path)


def times_as_fast(ours: str, other: str, error_rad: float, rows: Sequence[SolverRow]) -> float | None:
    """How many times as fast the cheapest settings of one solver within an error are as those of another; None without."""
    mine, theirs = least_s(ours, error_rad, rows), least_s(other, error_rad, rows)
    return None if mine is None or theirs is None else theirs / mine


def least_s(solver: str, error_rad: float, rows: Sequence[SolverRow]) -> float | None:
    """Seconds of the cheapest row of a solver whose error is within `error_rad`."""
    good = [
        row.seconds
        for row in rows
        if row.solver == solver and row.seconds is not None and row.error_rad is not None and row.error_rad <= error_rad
    ]
    return min(good, default=None)


if __name__ == "__main__":
    measured = asdict(measure("--quick" in sys.argv))
    KEPT.parent.mkdir(parents=True, exist_ok=True)
    KEPT.write_text(json.dumps(measured, indent=1) + "\n", encoding="utf-8")
    for name, value in measured.items():
        for row in value if isinstance(value, (list, tuple)) else [value]:
            print(name, json.dumps(row))
