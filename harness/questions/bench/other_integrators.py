"""The analytic model against other integrators, its throughput, and what the harness costs over a baseline loop.

Measured by a program that is given; its rows are kept and told here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Final

from harness.model.finding import Finding, info
from harness.questions.bench import programs
from harness.records.bench import BenchRecord, SolverRow, StartRow, Throughput
from harness.runs.parts import Row

COMPARED: Final = {
    ("analytic", "scipy DOP853"): (1e-6, 1e-9),
    ("analytic", "heyoka"): (1e-10, 1e-12),
    ("analytic, kernel alone", "heyoka"): (1e-10, 1e-12),
}
"""Solvers that are compared, and at which errors, rad."""
TASKS: Final = {"others": ("solvers", "startup", "overhead"), "speeds": ("throughput", "scans")}
"""Ratios of what takes turns, which may share the machine, and speeds that stand by themselves."""


def compute(program: str, quick: bool, task: str) -> list[Row]:
    """Rows of the solvers, runs per second of ensembles, cost of a start, or cost over a baseline loop."""
    return programs.rows(program, task, *(["--quick"] if quick else []))


def collected(rows: Sequence[Row]) -> dict[str, Any]:
    """Of a bench's record what these rows say; what was not measured yet is left out."""
    parts = {name: value for row in rows if "solver" not in row for name, value in row.items()}
    if "throughput" in parts:
        parts["throughput"] = {name: Throughput(**rate) for name, rate in parts["throughput"].items()}
    if "startup" in parts:
        parts["startup"] = StartRow(**parts["startup"])
    return {"solvers": [SolverRow(**row) for row in rows if "solver" in row], **parts}


def findings(measured: BenchRecord) -> list[Finding]:
    """What these rows say."""
    found = [
        each
        for case in dict.fromkeys(row.case for row in measured.solvers)
        for ours, other in COMPARED
        for each in _against(case, ours, other, [row for row in measured.solvers if row.case == case])
    ]
    for name, rate in measured.throughput.items():
        found.append(info("throughput", of=name, **vars(rate)))
    if measured.startup is not None:
        found.append(info("start_cost", **vars(measured.startup)))
    ratios = {name.removesuffix("_ratio"): each for name, each in measured.overhead.items() if name.endswith("_ratio")}
    found += [info("over_baseline", ratios=ratios)] if ratios else []
    return found + ([info("scan_speeds", factors=measured.scans)] if measured.scans else [])


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


def _against(case: str, ours: str, other: str, rows: Sequence[SolverRow]) -> Iterator[Finding]:
    if not {ours, other} <= {row.solver for row in rows}:
        return
    values = {"case": case, "ours": ours, "other": other}
    if absent := [row.failed for row in rows if row.solver == other and row.failed]:
        yield info("solver_absent", reason=absent[0], **values)
        return
    for error_rad in COMPARED[ours, other]:
        times = times_as_fast(ours, other, error_rad, rows)
        if times is not None:
            yield info("solver_faster", error_rad=error_rad, times=times, **values)
            continue
        # Where a solver did not reach the error: the smallest that it reached, and the ratio there.
        short = ours if least_s(ours, error_rad, rows) is None else other
        least_rad = min(row.error_rad for row in rows if row.solver == short and row.error_rad is not None)
        times = times_as_fast(ours, other, least_rad, rows)
        yield info("solver_short", short=short, error_rad=error_rad, least_rad=least_rad, times=times, **values)
