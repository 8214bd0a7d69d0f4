"""The bench: all measurements in parts that can be interrupted, one record."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Final

from harness import engines
from harness.model.finding import Answer, caution
from harness.questions.bench import findings, other_integrators, precision, programs, scaling, skips
from harness.questions.bench.precision import NOBODY, TARGET_RAD
from harness.questions.bench.standard_scenes import standard_set
from harness.records.bench import (
    LEVEL,
    TARGET,
    BenchRecord,
    Coverage,
    Covered,
    PrecisionRow,
    ScalingRow,
    SkipRow,
    of_parts,
)
from harness.runs.parts import Measurement, Part

# Is the stated numerical uncertainty honest, and what does a target take? Seeded scenes, each against a much finer run.
# Measured by a program that is given; its rows are kept and counted here.

FIRST_SEED: Final = 20_900
"""Scenes from here on were not used to choose the levels or the safety factor."""
SCENES: Final = 60
QUICK_SCENES: Final = 2
PIECE: Final = {"pybullet": 8, "pymunk": 25}
"""Scenes of one task, by engine."""


def tasks(quick: bool) -> list[str]:
    """The work in pieces that can be computed apart, the longest first."""
    last = FIRST_SEED + (QUICK_SCENES if quick else SCENES)
    return [
        f"{name}: seeds {begin} to {min(begin + piece, last) - 1}"
        for name, piece in PIECE.items()
        for begin in range(FIRST_SEED, last, piece)
    ]


def compute(program: str, task: str) -> Sequence[object]:
    """The rows of one piece; none where the engine is not here."""
    name, seeds = _piece(task)
    if engines.load(name).missing() is not None:
        return []
    done = programs.ask(program, name, str(seeds.start), str(len(seeds)), "--levels")
    return died(task) if done.returncode else [json.loads(line) for line in done.stdout.splitlines()]


def died(task: str) -> list[Coverage]:
    """A piece that took its process with it: none of its scenes is covered."""
    name, seeds = _piece(task)
    return [Coverage(name, seed, TARGET_RAD) for seed in seeds]


def _piece(task: str) -> tuple[str, range]:
    name, _, span = task.partition(": seeds ")
    first, _, last = span.partition(" to ")
    return name, range(int(first), int(last) + 1)


def choice_rows(rows: Sequence[Coverage]) -> list[PrecisionRow]:
    """The scenes that met the target to the end, as `sentences.choice` compares them."""
    compared = []
    for row in rows:
        if not row.levels or row.stated is None:
            continue
        base = PrecisionRow(row.engine, f"seed {row.seed}", TARGET, "", error_rad=row.stated.error_rad, cpu_s=row.cpu_s)
        compared += [replace(base, group=LEVEL, **vars(level)) for level in row.levels]
        compared.append(base)
    return compared


def counted(rows: Sequence[Coverage]) -> dict[str, Covered]:
    """By engine: scenes on which the error lay within the statement, of how many, and which it did not."""
    counts = {}
    for engine in dict.fromkeys(row.engine for row in rows):
        mine = [row for row in rows if row.engine == engine]
        missed = [row.seed for row in mine if not row.covered]
        counts[engine] = Covered(len(mine) - len(missed), len(mine), missed)
    return counts


CLOCK: Final = "cpu_s: processor time of the process (single-threaded runs); wall_s: by the clock; both best of several"


DEFAULTS, COVERAGE, OTHERS = "engine defaults", "coverage", "others"
"""What programs that are given measure: engines on their own defaults, seeded scenes, other integrators."""


def all_parts(given: programs.Programs, quick: bool) -> list[Part]:
    """The parts as they are measured: by processor time on all cores, then those that are timed by the clock, alone."""
    other = given.get(OTHERS, "")
    others, speeds = other_integrators.TASKS.values() if other else ((), ())
    seeded = tasks(quick) if COVERAGE in given else []
    return [
        Part(
            "precision",
            precision.tasks(quick),
            partial(precision.of, given.get(DEFAULTS), quick),
            precision.died,
            PrecisionRow,
        ),
        Part("coverage", seeded, partial(compute, given.get(COVERAGE, "")), died, Coverage),
        Part("skips", skips.together_tasks(quick), skips.compute, skips.died, SkipRow),
        Part("alone", skips.alone_tasks(quick), skips.compute, skips.died, SkipRow),
        Part("others", others, partial(other_integrators.compute, other, quick), _died),
        Part("scaling", scaling.tasks(quick), scaling.compute, _died, ScalingRow),
        Part("speeds", speeds, partial(other_integrators.compute, other, quick)),
        Part("workers", scaling.worker_tasks(quick), scaling.compute, row=ScalingRow),
    ]


def _died(task: str) -> list[object]:
    raise RuntimeError(f"{task}: its process died")


def assembled(given: programs.Programs, rows: Mapping[str, Sequence[Any]], head: Mapping[str, Any]) -> BenchRecord:
    """The record from the rows of all parts; what is not measured yet is left empty and said."""
    absent = {row.scene: row.failed for row in rows["precision"] if row.engine == NOBODY}
    absent |= programs.absent(given, (DEFAULTS, COVERAGE, OTHERS))
    order = [item.name for item in standard_set()]
    timed = [row for row in rows["precision"] if row.engine != NOBODY]
    timed.sort(key=lambda row: order.index(row.scene))
    seeded, alone, together = rows["coverage"], rows["alone"], skips.together(rows["skips"])
    made = BenchRecord(
        target_rad=TARGET_RAD,
        clock=CLOCK,
        rows=timed,
        absent=absent,
        choice=findings.choice(timed, TARGET_RAD),
        seeded=findings.choice(choice_rows(seeded), TARGET_RAD),
        coverage=counted(seeded),
        coverage_rows=seeded,
        skips=[*together, *alone],
        scaling=[*rows["scaling"], *rows["workers"]],
        **other_integrators.collected([*rows["others"], *rows["speeds"]]),
        **head,
    )
    found = [
        *findings.takes(made.choice, TARGET_RAD, "standard"),
        *findings.takes(made.seeded, TARGET_RAD, "seeded"),
        *findings.coverage(made.coverage),
        *skips.together_findings(together),
        *findings.defaults(timed),
        *skips.alone_findings(alone),
        *scaling.findings(made.scaling),
        *other_integrators.findings(made),
        *of_parts(made.parts, absent),
    ]
    met = findings.speeds(timed, TARGET_RAD) or [caution("no_engine_timed")]
    answer = Answer("met" if any(each.code == "meets_target" for each in met) else "not_met", met)
    return replace(made, answer=answer, findings=found)


def bench(given: programs.Programs = programs.NONE, sources: Sequence[str] = ()) -> Measurement[BenchRecord]:
    """The bench with what these programs measure; `sources` are the folders of their code, in the source tree."""
    return Measurement("bench", partial(all_parts, given), partial(assembled, given), tuple(sources))
