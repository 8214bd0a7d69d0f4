"""How long a study may take, told before it begins; studies over a day need `--large`."""

import random
from collections import defaultdict
from operator import itemgetter
from typing import Final, NamedTuple

import numpy as np

from harness import engines
from harness.accuracy.forecast import CERTIFIED_S, START_S, expected_steps, run_s, timed_step_s
from harness.model import Scene, require
from harness.questions.scene.witness import BUDGET
from harness.questions.scene.workload import LONGEST_S
from harness.questions.study.case_blocks import in_columns
from harness.questions.study.case_selection import COARSEST, REFERENCE, map_axes
from harness.questions.study.cases import BaseScene, Case, expand
from harness.questions.study.file import StudyFile
from harness.questions.study.study_run import SHARE
from harness.runs.progress import counted, duration_words
from harness.runs.task import scene_key

TRIALS: Final = 16
"""Drawn cases of each variant that are looked at: their mean is off by a sixth where one differs from another by two thirds."""
CASE_S: Final = 5e-3
"""Processor seconds of a case by the analytic model with what is around it: read, named, run, kept, scored and drawn."""
ROW_S: Final = 6e-5
"""The same where results stand in columns, for each second of motion."""
RESULT_S: Final = 4.0
"""To begin, to score, and to write the record and its pages."""
BOUNDARY: Final = 4.0
"""Points of an adaptive map along the line on which the outcome changes, in points along both axes."""
SHORTEST_LIMIT_S: Final = 600.0
"""A worker that has not answered for this long may still be compiling the model, or loading a large scan."""
MOST_CASES: Final = 2_000_000
"""Larger studies, and longer ones, are run only when that is asked for."""


class StudyCost(NamedTuple):
    """Processor seconds that a study is expected to take, and those of a run of a contact engine: 0 where it has none."""

    cpu_s: float
    each_s: float


def cost(study: StudyFile, base: BaseScene, workers: int, *, witness: bool = False) -> StudyCost:
    """What the study is expected to take, nothing of it being stored yet: by drawn cases of each variant.

    What is the same to an engine by its physics counts once.
    """
    rows = study.points * sum(REFERENCE in variant.engines for variant in study.variant)
    if in_columns(study, base) and not witness:
        return StudyCost(RESULT_S + rows * ROW_S * base.scene(study.variant[0].set).duration_s, 0.0)
    stream, spent, contact = random.Random(study.seed), 0.0, 0.0
    steps: dict[tuple[str, bool], float] = defaultdict(float)
    timed: dict[tuple[str, bool], tuple[float, Scene]] = {}
    for variant in range(len(study.variant)):
        drawn = stream.sample(range(study.points), min(TRIALS, study.points))
        for case in expand(study, base, [len(study.variant) * point + variant for point in drawn]):
            scene = base.scene(case.setting)
            for name in sorted(set(case.engines) - {REFERENCE}):
                runs = min(_sent(study), study.points / alike(study, base, case, name)) / len(drawn)
                contact += runs
                if name in CERTIFIED_S:
                    spent += runs * run_s(name, scene).middle
                    continue
                kind = name, scene.pedestal is not None
                each = expected_steps(name, scene, study.asked_rad.get(name)).middle
                steps[kind] += runs * each
                # The longest: in a fall steps take several times as long.
                timed[kind] = max(timed.get(kind, (0.0, scene)), (each, scene), key=itemgetter(0))
    spent += sum(
        count * timed_step_s(kind[0], timed[kind][1], study.asked_rad.get(kind[0])) for kind, count in steps.items()
    )
    spent *= 1.0 + witness * SHARE * (1.0 + BUDGET)
    return StudyCost(RESULT_S + START_S * workers + CASE_S * rows + spent, spent / contact if contact else 0.0)


def alike(study: StudyFile, base: BaseScene, case: Case, name: str) -> float:
    """How many cases of its variant are one run to an engine: the product of how many are along each axis through the case."""
    engine, sizes = engines.load(name), [*study.sizes, len(study.variant)]

    def key(place: tuple[int, ...]) -> str:
        (there,) = expand(study, base, [int(np.ravel_multi_index(place, sizes))])
        return scene_key(base.scene(there.setting), engine.capabilities)

    here = study.place(case.number)
    mine, product = key(here), 1.0
    for axis, size in enumerate(study.sizes):
        others = sorted({0, size // 2, size - 1} - {here[axis]})
        same = [key((*here[:axis], at, *here[axis + 1 :])) == mine for at in others]
        product *= 1.0 + (size - 1) * sum(same) / max(len(same), 1)
    return product


def limit_s(study: StudyFile, scene: Scene) -> float:
    """How long a worker may go without an answer before it is taken to hang: a hundred times the forecast of its longest run."""
    names = {engine for variant in study.variant for engine in variant.engines}
    return SHORTEST_LIMIT_S + 100.0 * max(run_s(name, scene, study.asked_rad.get(name)).middle for name in names)


def _sent(study: StudyFile) -> float:
    """Cases that a contact engine may be asked."""
    if study.ask.cases != "adaptive":
        return float(study.points)
    along = sum(study.vary[axis].count or 1 for axis in map_axes(study))
    return min(study.points * (study.ask.audit + COARSEST**-2.0) + BOUNDARY * along, float(study.points))


def check(study: StudyFile, cpu_s: float, workers: int, where: str, *, large: bool = False) -> str:
    """The size of a study in words. Raises `InputError` for more cases or hours than anyone starts without knowing it."""
    cases = study.points * len(study.variant)
    at_most = "at most " if study.ask.cases != "all" else ""
    spent, clock = duration_words(cpu_s), duration_words(cpu_s / workers)
    size = f"{counted(cases, 'case')}, {at_most}{counted(study.runs, 'run')}"
    told = f"{size}: {at_most}about {spent} of processor time, {clock} by the clock (workers: {workers})"
    wanted = f"at most {MOST_CASES} cases and {duration_words(LONGEST_S)}"
    advice = "a coarser grid, fewer samples, [ask] cases = 'adaptive' or 'boundary' for contact engines, or --large to run it all"
    require(large or (cases <= MOST_CASES and cpu_s / workers <= LONGEST_S), where, wanted, told, advice, key="vary")
    return told
