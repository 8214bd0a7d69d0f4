"""The analytic model against other integrators, its throughput, and what the harness costs over a bare loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

Row = Mapping[str, Any]

FASTER: Final = {
    ("analytic", "scipy DOP853"): (100.0, (1e-6, 1e-9)),
    ("analytic", "heyoka"): (1.0, (1e-10, 1e-12)),
    ("analytic, kernel alone", "heyoka"): (1.0, (1e-10, 1e-12)),
}
"""Times faster than each other solver that is wanted, and at which errors, rad."""
RUNS_PER_CORE_S: Final = 10_000.0
MAP_S: Final = 5.0
IMPORT_RATIO: Final = 1.3
FIRST_CALL_RATIO: Final = 2.0
OVERHEAD: Final = 1.10
THROUGHPUT_REPEATS: Final = 20
"""Runs of the map of which the least time counts: another process on the machine may take part of it from several in a row."""


def tasks() -> list[str]:
    """What is measured here."""
    return ["solvers", "throughput", "startup", "overhead"]


def compute(quick: bool, task: str) -> list[dict[str, Any]]:
    """Rows of the solvers, runs per second of ensembles, cost of a start, or cost over a bare loop."""
    from harness.bench import analytic_model, contact_engines, start

    if task == "solvers":
        return analytic_model.measure(2 if quick else analytic_model.REPEATS)
    if task == "throughput":
        found = analytic_model.throughput(400) if quick else analytic_model.throughput(repeats=THROUGHPUT_REPEATS)
        return [{"throughput": found | {"map": analytic_model.map_time(40 if quick else 200)}}]
    if task == "startup":
        return [{"startup": start.startup(1 if quick else start.STARTS)}]
    return [{"overhead": contact_engines.overhead(2.0 if quick else 10.0)}]


def collected(rows: Sequence[Row]) -> dict[str, Any]:
    """The parts of a record from all rows; what is not measured yet is empty."""
    found: dict[str, Any] = {"solvers": [row for row in rows if "solver" in row], "throughput": {}}
    found |= {"startup": {}, "overhead": {}}
    for row in rows:
        found |= {name: row[name] for name in ("throughput", "startup", "overhead") if name in row}
    return found


def sentences(found: Mapping[str, Any]) -> list[str]:
    """What these rows say against what is wanted."""
    cases = list(dict.fromkeys(row["case"] for row in found["solvers"]))
    told = [
        text
        for case in cases
        for ours, other in FASTER
        for text in _against(case, ours, other, [row for row in found["solvers"] if row["case"] == case])
    ]
    if found["throughput"]:
        rate = found["throughput"]["two_block"]["runs_per_core_s"]
        held = "at least" if rate >= RUNS_PER_CORE_S else "short of"
        told.append(
            f"Outcomes of 10 s on a pedestal at 1e-6: {rate:.3g} a second and core ({held} the {RUNS_PER_CORE_S:g} wanted)."
        )
        told.extend(_map(found["throughput"]["map"]))
    told.extend(_start(found["startup"]) if found["startup"] else ())
    for kind in ("no_pedestal", "pedestal") if found["overhead"] else ():
        ratio = found["overhead"][f"{kind}_ratio"]
        held = "at most" if ratio <= OVERHEAD else "above"
        told.append(
            f"A pymunk run ({kind.replace('_', ' ')}) takes {ratio:.2f} times a bare loop ({held} {OVERHEAD:g} wanted)."
        )
    return told


def _map(row: Row) -> list[str]:
    size, wall = row["size"], row["wall_s"]
    told = f"A {size} × {size} overturning map on a pedestal takes {wall:.3g} s on {row['threads']} cores"
    if size < 200:
        return [f"{told}."]
    return [f"{told} ({'at most' if wall <= MAP_S else 'above'} {MAP_S:g} wanted)."]


def _start(row: Row) -> list[str]:
    wanted = {"import": ("importing analytic", "importing numpy and numba", IMPORT_RATIO)}
    wanted["first_call"] = ("its first call from the cache", "that of a trivial cached kernel", FIRST_CALL_RATIO)
    told = []
    for name, (what, than, most) in wanted.items():
        ratio = row[f"{name}_ratio"]
        held = "at most" if ratio <= most else "above"
        told.append(f"{what[0].upper()}{what[1:]} takes {ratio:.2f} times {than} ({held} {most:g} wanted).")
    return told


def _against(case: str, ours: str, other: str, rows: Sequence[Row]) -> list[str]:
    wanted, errors = FASTER[ours, other]
    if not any(row["solver"] == other for row in rows) or not any(row["solver"] == ours for row in rows):
        return []
    absent = [row for row in rows if row["solver"] == other and row.get("failed")]
    if absent:
        return [f"{case}: {other} was not measured: {absent[0]['failed']}."]
    told = []
    for error in errors:
        mine, theirs = _least_s(ours, error, rows), _least_s(other, error, rows)
        if mine is None or theirs is None:
            told.append(_short_of(case, ours, other, ours if mine is None else other, error, rows))
            continue
        ratio = theirs / mine
        held = "at least" if ratio >= wanted else "short of"
        told.append(
            f"{case}: at {error:g} rad {ours} is {ratio:.3g} times as fast as {other} ({held} {wanted:g} wanted)."
        )
    return told


def _short_of(case: str, ours: str, other: str, failed: str, error_rad: float, rows: Sequence[Row]) -> str:
    """What is known where a solver did not reach the error: the smallest that it reached, and the ratio there."""
    least = min(row["error_rad"] for row in rows if row["solver"] == failed)
    text = f"{case}: no setting of {failed} reached {error_rad:g} rad"
    mine, theirs = _least_s(ours, least, rows), _least_s(other, least, rows)
    if mine is None or theirs is None:
        return f"{text}; its smallest error is {least:.2g}."
    return f"{text}; at its smallest error, {least:.2g}, {ours} is {theirs / mine:.3g} times as fast as {other}."


def _least_s(solver: str, error_rad: float, rows: Sequence[Row]) -> float | None:
    """Seconds of the cheapest row of a solver whose error is within `error_rad`."""
    good = [row["seconds"] for row in rows if row["solver"] == solver and row["error_rad"] <= error_rad]
    return min(good, default=None)
