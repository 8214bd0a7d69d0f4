"""The analytic model against other integrators, its throughput, and what the harness costs over a baseline loop.

Measured by a program that is given; its rows are kept and told here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from harness.bench import programs
from harness.campaign.parts import Row
from harness.records.bench import SolverRow, Start, Throughput

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


@dataclass(frozen=True)
class OtherSolvers:
    """What was measured here; what was not yet is empty, or None."""

    solvers: Sequence[SolverRow] = ()
    throughput: Mapping[str, Throughput] = field(default_factory=dict)
    startup: Start | None = None
    overhead: Mapping[str, float] = field(default_factory=dict)
    scans: Mapping[str, float] = field(default_factory=dict)


def collected(rows: Sequence[Row]) -> OtherSolvers:
    """All rows that were kept."""
    parts = {name: value for row in rows if "solver" not in row for name, value in row.items()}
    return OtherSolvers(
        [SolverRow(**row) for row in rows if "solver" in row],
        {name: Throughput(**rate) for name, rate in parts.get("throughput", {}).items()},
        Start(**parts["startup"]) if "startup" in parts else None,
        parts.get("overhead", {}),
        parts.get("scans", {}),
    )


def sentences(measured: OtherSolvers) -> list[str]:
    """What these rows say."""
    sentences = [
        text
        for case in dict.fromkeys(row.case for row in measured.solvers)
        for ours, other in COMPARED
        for text in _against(case, ours, other, [row for row in measured.solvers if row.case == case])
    ]
    if measured.throughput:
        rate, area = measured.throughput["two_block"], measured.throughput["map"]
        size = math.isqrt(area.runs)
        sentences += [
            f"Outcomes of 10 s on a pedestal at 1e-6: {rate.runs_per_core_s:.3g} a second and core.",
            f"A {size} × {size} overturning map on a pedestal takes {area.wall_s:.3g} s on {area.threads} cores.",
        ]
    if measured.startup is not None:
        sentences += [
            f"Importing analytic takes {measured.startup.import_ratio:.2f} times importing numpy and numba.",
            f"Its first call from the cache takes {measured.startup.first_call_ratio:.2f} times that of a trivial cached kernel.",
        ]
    sentences += [
        f"A pymunk run ({name.removesuffix('_ratio').replace('_', ' ')}) takes {ratio:.2f} times a baseline loop."
        for name, ratio in measured.overhead.items()
        if name.endswith("_ratio")
    ]
    if rates := measured.scans:
        listed = ", ".join(f"{name} {rate:.3g}" for name, rate in rates.items())
        sentences.append(f"Times real time of pybullet on scans under a record: {listed}.")
    return sentences


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


def _against(case: str, ours: str, other: str, rows: Sequence[SolverRow]) -> list[str]:
    if not {ours, other} <= {row.solver for row in rows}:
        return []
    if absent := [row.failed for row in rows if row.solver == other and row.failed]:
        return [f"{case}: {other} was not measured: {absent[0]}."]
    sentences = []
    for error_rad in COMPARED[ours, other]:
        ratio = times_as_fast(ours, other, error_rad, rows)
        text = f"{case}: at {error_rad:g} rad {ours} is {ratio or 0.0:.3g} times as fast as {other}."
        sentences.append(text if ratio is not None else _short_of(case, ours, other, error_rad, rows))
    return sentences


def _short_of(case: str, ours: str, other: str, error_rad: float, rows: Sequence[SolverRow]) -> str:
    """What is known where a solver did not reach the error: the smallest that it reached, and the ratio there."""
    failed = ours if least_s(ours, error_rad, rows) is None else other
    least = min(row.error_rad for row in rows if row.solver == failed and row.error_rad is not None)
    text = f"{case}: no setting of {failed} reached {error_rad:g} rad"
    ratio = times_as_fast(ours, other, least, rows)
    if ratio is None:
        return f"{text}; its smallest error is {least:.2g}."
    return f"{text}; at its smallest error, {least:.2g}, {ours} is {ratio:.3g} times as fast as {other}."
