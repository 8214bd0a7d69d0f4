"""The bench: all measurements in parts that can be interrupted, one record."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Final

from harness.model import Answer, caution
from harness.questions.bench import precision, scaling, skips
from harness.questions.bench.parts import Measurement, Part
from harness.questions.bench.precision import NOBODY, TARGET_RAD
from harness.questions.bench.standard_scenes import standard_set
from harness.records.bench import BenchRecord, PrecisionRow, ScalingRow, SkipRow, of_parts


def all_parts(quick: bool) -> list[Part]:
    """The parts as they are measured: by processor time on all cores, then those that are timed by the clock, alone."""
    return [
        Part("precision", precision.tasks(quick), partial(precision.of, quick), precision.died, PrecisionRow),
        Part("skips", skips.together_tasks(quick), skips.compute, skips.died, SkipRow),
        Part("alone", skips.alone_tasks(quick), skips.compute, skips.died, SkipRow),
        Part("scaling", scaling.tasks(quick), scaling.compute, _died, ScalingRow),
        Part("workers", scaling.worker_tasks(quick), scaling.compute, row=ScalingRow),
    ]


def _died(task: str) -> list[object]:
    raise RuntimeError(f"{task}: its process died")


def assembled(rows: Mapping[str, Sequence[Any]], head: Mapping[str, Any]) -> BenchRecord:
    """The record from the rows of all parts; what is not measured yet is left empty and said."""
    absent = {row.scene: row.failed for row in rows["precision"] if row.engine == NOBODY}
    order = [item.name for item in standard_set()]
    timed = [row for row in rows["precision"] if row.engine != NOBODY]
    timed.sort(key=lambda row: order.index(row.scene))
    alone, together = rows["alone"], skips.together(rows["skips"])
    made = BenchRecord(
        target_rad=TARGET_RAD,
        rows=timed,
        absent=absent,
        choice=precision.choice(timed, TARGET_RAD),
        skips=[*together, *alone],
        scaling=[*rows["scaling"], *rows["workers"]],
        **head,
    )
    found = [
        *precision.takes(made.choice, TARGET_RAD),
        *skips.together_findings(together),
        *skips.alone_findings(alone),
        *scaling.findings(made.scaling),
        *of_parts(made.parts, absent),
    ]
    met = precision.speeds(timed, TARGET_RAD) or [caution("no_engine_timed")]
    answer = Answer("met" if any(each.code == "meets_target" for each in met) else "not_met", met)
    return replace(made, answer=answer, findings=found)


BENCH: Final = Measurement("bench", all_parts, assembled)
