"""The bench: all measurements in parts that can be interrupted, one record."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Final

from harness.bench import coverage as cover
from harness.bench import other_integrators, precision, scaling, sentences, skip_savings, skips
from harness.bench.standard_scenes import standard_set
from harness.campaign import parts
from harness.campaign.parts import Measured, Part, Row
from harness.model.run import machine, versions
from harness.records.base import as_file
from harness.records.bench import BenchRecord, PartRow, PrecisionRow, ScalingRow, SkipRow

CLOCK: Final = "cpu_s: processor time of the process (single-threaded runs); wall_s: by the clock; both best of several"


def run(
    folder: Path,
    quick: bool = False,
    on_progress: Callable[[str], None] = lambda text: None,
    only: Sequence[str] | None = None,
) -> Row:
    """Measure everything (or `only` some parts) and write `result.json` into `folder`; `quick` takes the first of each kind.

    What was interrupted goes on where it was. `on_progress` hears of it. Raises `InputError` for a folder that cannot be
    written, or an unknown part.
    """
    listed = all_parts(quick)
    measured = parts.session(folder, listed, quick, only, on_progress)
    return parts.written(folder, as_file(assembled(listed, measured, parts.command("bench", quick, measured))))


def all_parts(quick: bool) -> list[Part]:
    """The parts as they are measured: by processor time on all cores, then those that are timed by the clock, alone."""
    return [
        Part("precision", precision.tasks(quick), partial(precision.of, quick), precision.died),
        Part("coverage", cover.tasks(quick), cover.compute, cover.died),
        Part("skips", skips.tasks(quick), skips.compute),
        Part("alone", skip_savings.tasks(quick), skip_savings.compute),
        Part("scaling", scaling.tasks(quick), scaling.compute),
        Part("others", other_integrators.tasks(), partial(other_integrators.compute, quick)),
    ]


def assembled(listed: Sequence[Part], measured: dict[str, Measured], command: str = "rockcheck bench") -> BenchRecord:
    """The record from the rows of all parts; what is not measured yet is left empty and said."""
    rows = {part.name: measured[part.name].in_order(part) for part in listed}
    absent = {row["scene"]: row["absent"] for row in rows["precision"] if "absent" in row}
    order = [item.name for item in standard_set()]
    timed = [PrecisionRow(**row) for row in rows["precision"] if "absent" not in row]
    timed.sort(key=lambda row: order.index(row.scene))
    seeded = [cover.read(row) for row in rows["coverage"]]
    together = skips.together([SkipRow(**row) for row in rows["skips"]])
    alone = [SkipRow(**row) for row in rows["alone"]]
    grown = [ScalingRow(**row) for row in rows["scaling"]]
    others = other_integrators.collected(rows["others"])
    target_rad, counts, spent = precision.TARGET_RAD, cover.counted(seeded), parts.seconds(measured)
    standard = sentences.choice(timed, target_rad)
    on_seeds = sentences.choice(cover.choice_rows(seeded), target_rad)
    texts = [
        *sentences.speeds(timed, target_rad),
        *sentences.choices(standard, on_seeds, target_rad),
        *sentences.coverage(counts),
        *skips.sentences(together),
        *sentences.defaults(timed),
        *skip_savings.sentences(alone),
        *scaling.sentences(grown),
        *other_integrators.sentences(others),
        *(f"“{name}” was left out: {why}." for name, why in absent.items()),
        *parts.sentences(spent),
    ]
    return BenchRecord(
        command=command, target_rad=target_rad, clock=CLOCK, rows=timed, absent=absent, choice=standard, seeded=on_seeds,
        coverage=counts, coverage_rows=seeded, skips=[*together, *alone], scaling=grown, **vars(others),
        parts=[PartRow(**item) for item in spent], sentences=texts, seconds=sum(item["wall_s"] for item in spent),
        versions=versions(), machine=machine(),
    )  # fmt: skip
