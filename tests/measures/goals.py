"""What a bench must reach: `python -m tests.measures.goals [RESULT [OTHERS]]` prints each goal of a bench's record and of what
`tests.measures.other_integrators` measured; 1 where one is missed."""

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from harness.questions.bench.bench_run import fastest
from harness.records.base import validated
from harness.records.bench import TOGETHER, BenchRecord
from tests.measures.analytic_model import SolverRow
from tests.measures.other_integrators import COMPARED, KEPT, Others, read, times_as_fast

RECORD: Final = Path("out/bench/result.json")
REAL_TIME: Final = {"pymunk": 250.0, "pybullet": 60.0}
"""Times real time wanted on the block scenes at the target accuracy."""
COST_SHARE: Final = 0.5
"""Share of the fixed level's total cost that the target accuracy may take, its checks included."""
HINDSIGHT: Final = 3.0
"""Times the best level in hindsight that it may take on one scene."""
SKIP_GAIN: Final = {"analytic": 5.0, "pymunk": 2.0, "pybullet": 2.0}
FASTER: Final = {"scipy DOP853": 100.0, "heyoka": 1.4}
"""Times faster than each other solver."""
RUNS_PER_CORE_S: Final = 25_000.0
CERTIFIED: Final = 1.3
"""Times the bare cost that an outcome with its doubt flag may take."""
MAP_RUNS: Final = 40_000
MAP_S: Final = 5.0
"""Seconds of the map of so many outcomes on two cores."""
IMPORT_RATIO: Final = 1.3
FIRST_CALL_RATIO: Final = 2.0
OVERHEAD: Final = 1.10
SCANS: Final = {"Maria at 1 ms": 100.0, "stone at 2 ms": 40.0}
"""Times real time of scans in pybullet, under a record that makes them rock."""


@dataclass(frozen=True)
class Goal:
    """One number of a bench (None: it could not be measured) and what is wanted of it, at least or at most."""

    what: str
    value: float | None
    wanted: float
    at_most: bool = False

    @property
    def reached(self) -> bool:
        """Whether the number is as wanted."""
        if self.value is None:
            return False
        return self.value <= self.wanted if self.at_most else self.value >= self.wanted

    def __str__(self) -> str:
        number = "not measured" if self.value is None else f"{self.value:.3g}"
        side = "most" if self.at_most else "least"
        return f"{'reached' if self.reached else 'MISSED '}  {self.what}: {number}, at {side} {self.wanted:g} wanted"


def goals(record: BenchRecord, others: Others) -> Iterator[Goal]:
    """The goals of what a record and the others hold; of a part that is not measured there are none."""
    target_rad = record.target_rad
    for engine, (factor, scene) in fastest(record.rows, target_rad).items():
        if engine in REAL_TIME:
            yield Goal(f"{engine}, times real time at {target_rad:g} rad on {scene}", factor, REAL_TIME[engine])
    for item in record.choice:
        on = f"--accuracy {target_rad:g} with {item.engine} on the standard set"
        yield Goal(f"{on}, of the one fixed level's cost", item.share, COST_SHARE, at_most=True)
        yield Goal(f"{on}, times the best level", item.worst_times, HINDSIGHT, at_most=True)
    for row in record.skips:
        if row.skip == TOGETHER:
            gain = None if row.failed else row.gain
            yield Goal(f"{row.engine}, times faster by all skips", gain, SKIP_GAIN[row.engine])
            yield Goal(f"{row.engine}, outcomes that skips change", len(row.changed), 0.0, at_most=True)
    yield from _solvers(others.solvers)
    if rates := others.throughput:
        yield Goal("outcomes a second and core", rates["two_block"].runs_per_core_s, RUNS_PER_CORE_S)
        if "two_block_certified" in rates:
            times = rates["two_block"].runs_per_core_s / rates["two_block_certified"].runs_per_core_s
            yield Goal("outcomes with their doubt flag, times the bare cost", times, CERTIFIED, at_most=True)
        if rates["map"].runs >= MAP_RUNS:
            yield Goal("seconds of a map", rates["map"].wall_s, MAP_S, at_most=True)
    if others.startup is not None:
        yield Goal("import over numpy's and numba's", others.startup.import_ratio, IMPORT_RATIO, at_most=True)
        yield Goal("first call over a trivial one", others.startup.first_call_ratio, FIRST_CALL_RATIO, at_most=True)
    for name, least in SCANS.items():
        if name in others.scans:
            yield Goal(f"pybullet, times real time of {name}", others.scans[name], least)
    for name, ratio in others.overhead.items():
        if name.endswith("_ratio"):
            yield Goal(f"pymunk over a baseline loop, {name}", ratio, OVERHEAD, at_most=True)


def _solvers(rows: Sequence[SolverRow]) -> Iterator[Goal]:
    for case in dict.fromkeys(row.case for row in rows):
        mine = [row for row in rows if row.case == case]
        for (ours, other), errors in COMPARED.items():
            if {ours, other} <= {row.solver for row in mine}:
                for error_rad in errors:
                    ratio = times_as_fast(ours, other, error_rad, mine)
                    yield Goal(f"{case} at {error_rad:g} rad: {ours} over {other}", ratio, FASTER[other])


def main(arguments: Sequence[str]) -> int:
    """Print the goals; 1 where one is missed."""
    path, kept = (Path(each) for each in (*arguments, *(RECORD, KEPT)[len(arguments) :]))
    listed = list(goals(validated(BenchRecord, path.read_bytes(), path), read(kept)))
    sys.stdout.write("".join(f"{goal}\n" for goal in listed))
    return 0 if all(goal.reached for goal in listed) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
