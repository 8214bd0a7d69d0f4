"""The bench: all measurements in parts that can be interrupted, one record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Final

from harness.bench import (
    coverage,
    findings,
    other_integrators,
    precision,
    programs,
    scaling,
    skip_savings,
    skips,
)
from harness.bench.standard_scenes import standard_set
from harness.campaign import parts
from harness.campaign.parts import Measured, Measurement, Part, Row
from harness.model.finding import Answer, caution
from harness.model.run import machine, versions
from harness.records.bench import BenchRecord, PrecisionRow, ScalingRow, SkipRow, of_parts

CLOCK: Final = "cpu_s: processor time of the process (single-threaded runs); wall_s: by the clock; both best of several"


DEFAULTS, COVERAGE, OTHERS = "engine defaults", "coverage", "others"
"""What programs that are given measure: engines on their own defaults, seeded scenes, other integrators."""


def all_parts(given: programs.Programs, quick: bool) -> list[Part]:
    """The parts as they are measured: by processor time on all cores, then those that are timed by the clock, alone."""
    other = given.get(OTHERS, "")
    others, speeds = other_integrators.TASKS.values() if other else ((), ())
    seeded = coverage.tasks(quick) if COVERAGE in given else []
    return [
        Part("precision", precision.tasks(quick), partial(precision.of, given.get(DEFAULTS), quick), precision.died),
        Part("coverage", seeded, partial(coverage.compute, given.get(COVERAGE, "")), coverage.died),
        Part("skips", skips.tasks(quick), skips.compute, skips.died),
        Part("alone", skip_savings.tasks(quick), skip_savings.compute, skip_savings.died),
        Part("others", others, partial(other_integrators.compute, other, quick), _died),
        Part("scaling", scaling.tasks(quick), scaling.compute, _died),
        Part("speeds", speeds, partial(other_integrators.compute, other, quick)),
        Part("workers", scaling.worker_tasks(quick), scaling.compute),
    ]


def _died(task: str) -> list[Row]:
    raise RuntimeError(f"{task}: its process died")


def assembled(
    given: programs.Programs, listed: Sequence[Part], measured: Mapping[str, Measured], command: str
) -> BenchRecord:
    """The record from the rows of all parts; what is not measured yet is left empty and said."""
    rows = {part.name: measured[part.name].in_order(part) for part in listed}
    absent = {row["scene"]: row["absent"] for row in rows["precision"] if "absent" in row}
    absent |= programs.absent(given, (DEFAULTS, COVERAGE, OTHERS))
    order = [item.name for item in standard_set()]
    timed = [PrecisionRow(**row) for row in rows["precision"] if "absent" not in row]
    timed.sort(key=lambda row: order.index(row.scene))
    seeded = [coverage.read(row) for row in rows["coverage"]]
    together = skips.together([SkipRow(**row) for row in rows["skips"]])
    alone = [SkipRow(**row) for row in rows["alone"]]
    grown = [ScalingRow(**row) for row in rows["scaling"] + rows["workers"]]
    solvers = other_integrators.collected(rows["others"] + rows["speeds"])
    target_rad, counts, spent = precision.TARGET_RAD, coverage.counted(seeded), parts.seconds(measured)
    standard = findings.choice(timed, target_rad)
    on_seeds = findings.choice(coverage.choice_rows(seeded), target_rad)
    found = [
        *findings.takes(standard, target_rad, "standard"),
        *findings.takes(on_seeds, target_rad, "seeded"),
        *findings.coverage(counts),
        *skips.findings(together),
        *findings.defaults(timed),
        *skip_savings.findings(alone),
        *scaling.findings(grown),
        *other_integrators.findings(solvers),
        *of_parts(spent, absent),
    ]
    met = findings.speeds(timed, target_rad) or [caution("no_engine_timed")]
    return BenchRecord(
        command=command, target_rad=target_rad, clock=CLOCK, rows=timed, absent=absent, choice=standard, seeded=on_seeds,
        coverage=counts, coverage_rows=seeded, skips=[*together, *alone], scaling=grown, **vars(solvers),
        parts=spent, answer=Answer("met" if any(each.code == "meets_target" for each in met) else "not_met", met),
        findings=found, seconds=sum(row.wall_s for row in spent), versions=versions(), machine=machine(),
    )  # fmt: skip


def bench(given: programs.Programs = programs.NONE, sources: Sequence[str] = ()) -> Measurement[BenchRecord]:
    """The bench with what these programs measure; `sources` are the folders of their code, in the source tree."""
    return Measurement("bench", partial(all_parts, given), partial(assembled, given), tuple(sources))
