"""The analytic model against other integrators, its throughput, and what the harness costs over a bare loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

Row = Mapping[str, Any]

FASTER: Final = {"scipy DOP853": (100.0, (1e-6, 1e-9)), "heyoka": (1.0, (1e-10, 1e-12))}
"""Times faster than each other solver that is wanted, and at which errors, rad."""
RUNS_PER_CORE_S: Final = 10_000.0
OVERHEAD: Final = 1.10


def tasks() -> list[str]:
    """What is measured here."""
    return ["solvers", "throughput", "overhead"]


def compute(quick: bool, task: str) -> list[dict[str, Any]]:
    """Rows of the solvers, runs per second of ensembles, or cost over a bare loop."""
    from harness import bench_analytic, bench_contact

    if task == "solvers":
        return bench_analytic.measure(2 if quick else bench_analytic.REPEATS)
    if task == "throughput":
        return [{"throughput": bench_analytic.throughput(400 if quick else 2000)}]
    return [{"overhead": bench_contact.overhead(2.0 if quick else 10.0)}]


def collected(rows: Sequence[Row]) -> dict[str, Any]:
    """The parts of a record from all rows; what is not measured yet is empty."""
    found: dict[str, Any] = {"solvers": [row for row in rows if "solver" in row], "throughput": {}, "overhead": {}}
    for row in rows:
        found |= {name: row[name] for name in ("throughput", "overhead") if name in row}
    return found


def sentences(found: Mapping[str, Any]) -> list[str]:
    """What these rows say against what is wanted."""
    told = [text for solver in FASTER for text in _against(solver, found["solvers"])] if found["solvers"] else []
    if found["throughput"]:
        rate = found["throughput"]["two_block"]["runs_per_core_s"]
        held = "at least" if rate >= RUNS_PER_CORE_S else "short of"
        told.append(
            f"Outcomes of 10 s on a pedestal at 1e-6: {rate:.3g} a second and core ({held} the {RUNS_PER_CORE_S:g} wanted)."
        )
    for kind in ("no_pedestal", "pedestal") if found["overhead"] else ():
        ratio = found["overhead"][f"{kind}_ratio"]
        held = "at most" if ratio <= OVERHEAD else "above"
        told.append(
            f"A pymunk run ({kind.replace('_', ' ')}) takes {ratio:.2f} times a bare loop ({held} {OVERHEAD:g} wanted)."
        )
    return told


def _against(solver: str, rows: Sequence[Row]) -> list[str]:
    wanted, errors = FASTER[solver]
    absent = [row for row in rows if row["solver"] == solver and row.get("failed")]
    if absent:
        return [f"{solver} was not measured: {absent[0]['failed']}."]
    told = []
    for error in errors:
        ours, theirs = _least_s("analytic", error, rows), _least_s(solver, error, rows)
        if ours is None or theirs is None:
            told.append(f"No tolerance of {solver if theirs is None else 'the analytic model'} reached {error:g} rad.")
            continue
        ratio = theirs / ours
        held = "at least" if ratio >= wanted else "short of"
        told.append(
            f"At {error:g} rad the analytic model is {ratio:.3g} times as fast as {solver} ({held} {wanted:g} wanted)."
        )
    return told


def _least_s(solver: str, error_rad: float, rows: Sequence[Row]) -> float | None:
    """Seconds of the cheapest row of a solver whose error is within `error_rad`."""
    good = [row["seconds"] for row in rows if row["solver"] == solver and row["error_rad"] <= error_rad]
    return min(good, default=None)
