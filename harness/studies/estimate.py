"""How long a study may take, told before it begins; studies over a day need `--large`."""

from __future__ import annotations

from typing import Final

from harness.campaign.progress import duration_words
from harness.model.errors import InputError, Mistake
from harness.model.scene import Scene
from harness.scene_run.witness import BUDGET
from harness.scene_run.workload import LONGEST_S, run_s
from harness.studies.case_selection import COARSEST, REFERENCE, map_axes
from harness.studies.file import StudyFile
from harness.studies.witnessed import SHARE

WITH_HISTORY: Final = 10.0
"""By how much a history makes an analytic run costlier; to contact engines it makes no difference."""
BOUNDARY: Final = 4.0
"""Points of an adaptive map along the line on which the outcome changes, in points along both axes."""
SHORTEST_LIMIT_S: Final = 600.0
"""A worker that has not answered for this long may still be compiling the model, or loading a large scan."""
MOST_CASES: Final = 2_000_000
"""Larger studies, and longer ones, are run only when that is asked for."""


def seconds(study: StudyFile, scene: Scene, workers: int) -> float:
    """Roughly the longest that the study may take on so many workers, nothing of it being stored yet."""
    total = 0.0
    for variant in study.variant:
        for engine in set(variant.engines):
            each = run_s(engine, scene)
            if engine == REFERENCE:
                total += study.points * each * (WITH_HISTORY if study.ask.histories else 1.0)
            else:
                total += _sent(study) * each * (1.0 + SHARE * (1.0 + BUDGET))
    return total / workers


def limit_s(study: StudyFile, scene: Scene) -> float:
    """How long a worker may go without an answer before it is taken to hang: a hundred times the estimate of its longest run."""
    names = {engine for variant in study.variant for engine in variant.engines}
    return SHORTEST_LIMIT_S + 100.0 * max(run_s(name, scene, study.asked_rad.get(name)) for name in names)


def _sent(study: StudyFile) -> float:
    """Cases that a contact engine may be asked."""
    if study.ask.cases != "adaptive":
        return float(study.points)
    along = sum(study.vary[axis].count or 1 for axis in map_axes(study))
    return min(study.points * (study.ask.audit + COARSEST**-2.0) + BOUNDARY * along, float(study.points))


def sentence(study: StudyFile, scene: Scene, workers: int) -> str:
    """The size of a study in words."""
    cases = study.points * len(study.variant)
    at_most = "at most " if study.ask.cases != "all" else ""
    longest = duration_words(seconds(study, scene, workers))
    # What is the same by its physics, or stored already, is found only on the way.
    return f"{cases} cases, {at_most}{study.runs} runs: at most about {longest} on {workers} workers"


def check(study: StudyFile, scene: Scene, workers: int, where: str) -> None:
    """Raise `InputError` for a study of more cases or hours than anyone starts without knowing it."""
    cases = study.points * len(study.variant)
    if cases <= MOST_CASES and seconds(study, scene, workers) <= LONGEST_S:
        return
    wanted = f"at most {MOST_CASES} cases and {duration_words(LONGEST_S)}"
    advice = "a coarser grid, fewer samples, [ask] cases = 'adaptive' or 'boundary' for contact engines, or --large to run it all"
    raise InputError(Mistake(where, "vary", wanted, sentence(study, scene, workers), advice))
