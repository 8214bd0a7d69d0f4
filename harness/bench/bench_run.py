"""The bench: all measurements in parts that can be interrupted, one record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Final

from harness.bench import (
    coverage,
    other_integrators,
    precision,
    programs,
    scaling,
    sentences,
    skip_savings,
    skips,
)
from harness.bench.standard_scenes import standard_set
from harness.campaign import parts
from harness.campaign.parts import Measured, Measurement, Part, Row
from harness.model.run import machine, versions
from harness.records.bench import BenchRecord, PrecisionRow, ScalingRow, SkipRow, part_sentences

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
    standard = sentences.choice(timed, target_rad)
    on_seeds = sentences.choice(coverage.choice_rows(seeded), target_rad)
    texts = [
        *sentences.speeds(timed, target_rad),
        *sentences.choices(standard, on_seeds, target_rad),
        *sentences.coverage(counts),
        *skips.sentences(together),
        *sentences.defaults(timed),
        *skip_savings.sentences(alone),
        *scaling.sentences(grown),
        *other_integrators.sentences(solvers),
        *(f"“{name}” was left out: {why}." for name, why in absent.items()),
        *part_sentences(spent),
    ]
    return BenchRecord(
        command=command, target_rad=target_rad, clock=CLOCK, rows=timed, absent=absent, choice=standard, seeded=on_seeds,
        coverage=counts, coverage_rows=seeded, skips=[*together, *alone], scaling=grown, **vars(solvers),
        parts=spent, sentences=texts, seconds=sum(row.wall_s for row in spent),
        versions=versions(), machine=machine(),
    )  # fmt: skip


def bench(given: programs.Programs = programs.NONE, sources: Sequence[str] = ()) -> Measurement[BenchRecord]:
    """The bench with what these programs measure; `sources` are the folders of their code, in the source tree."""
    return Measurement("bench", partial(all_parts, given), partial(assembled, given), _sentences, tuple(sources))


def _sentences(record: BenchRecord) -> Sequence[str]:
    return record.sentences
