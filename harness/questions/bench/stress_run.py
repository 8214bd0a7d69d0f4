"""The stress run: hard scenes and stability maps, on all cores and in parts; one record."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final

from harness import engines
from harness.engines.base import Engine, EngineFailure, Settings
from harness.model import Run, RunOptions, Scene
from harness.questions.bench import hard_scenes as hard
from harness.questions.bench.hard_scenes import ALL, SHAKEN, body, converged, leaning, solution
from harness.questions.bench.parts import Measurement, Part
from harness.questions.bench.standard_scenes import COLUMN, EQUAL, PAESTUM, PEDESTAL, harmonic, scene_of
from harness.records.bench import HardRow, Measure, StabilityCell, StressRecord, answer_of, findings_of

# The stability map: every engine, setting by difficulty, each cell's category computed with its evidence.

STEPS_S: Final = (1.0 / 60.0, 1.0 / 240.0, 1e-3, 2.5e-4, 1e-4, 1e-5)
NONE: Final = RunOptions(skips=frozenset())
CONVERGED_S: Final = 2.5e-4
"""Step of the run with far more iterations, where no step is stable."""


@dataclass(frozen=True)
class Difficulty:
    """One row of a map; `share` of the scene's time is run with the finest step: what grows with small steps shows at once."""

    name: str
    content: Mapping[str, object]
    share: float = 0.3
    at_rest: bool = False


def difficulties() -> tuple[Difficulty, ...]:
    """The rows from easy to hard."""
    pushed = {"duration_s": 1.0, "statue": PAESTUM, "motion": harmonic(0.429, 3.0)}
    stand = {"pedestal": PEDESTAL, "contact": EQUAL}
    light = {"pedestal": {**PEDESTAL, "mass_kg": 0.707}, "contact": EQUAL}
    return (
        Difficulty("at rest", {"duration_s": 2.0, "statue": COLUMN}, at_rest=True),
        Difficulty("free rocking", leaning(COLUMN, 0.5, 1.0)),
        Difficulty("slenderness 50", leaning(body(0.02, 1.0), 0.5, 1.0)),
        Difficulty("harmonic, 0.429 g, 3 Hz", pushed),
        Difficulty("harmonic, on a pedestal", {**pushed, **stand}, share=0.1),
        Difficulty("pedestal of a thousandth of the mass", {**pushed, **light}, share=0.1),
        Difficulty("5 g at 100 Hz", {"duration_s": 0.5, **SHAKEN}),
    )


ENGINES: Final = ("pybullet", "pymunk", "analytic")


def tasks(quick: bool) -> list[str]:
    """A row of each engine's map: the difficulty by each engine, the longest first."""
    rows = difficulties()[1:2] if quick else difficulties()
    return [f"{engine}: {row.name}" for engine in ENGINES for row in sorted(rows, key=lambda row: row.share)]


def compute(quick: bool, task: str) -> list[StabilityCell]:
    """The cells of one row of one map; none where the engine is not here."""
    name, _, words = task.partition(": ")
    engine = engines.load(name)
    if engine.missing() is not None:
        return []
    row = next(item for item in difficulties() if item.name == words)
    scene = scene_of(row.name, row.content)
    exact = solution(scene)
    cells = list(_cells_of(row, scene, engine, exact, quick))
    return list(explained(cells, partial(_converged, row, scene, engine, exact)))


def died(task: str) -> list[StabilityCell]:
    """A row whose process died: one cell, diverged and not explained."""
    name, _, words = task.partition(": ")
    return [StabilityCell(name, "any", words, "diverged", message="crashed")]


def _cells_of(row: Difficulty, scene: Scene, engine: Engine, exact: Run, quick: bool) -> Iterator[StabilityCell]:
    if engine.capabilities.certifies:
        for settings in engine.refinement_levels(scene):
            run = engine.simulate(scene, settings, RunOptions())
            label = f"{settings.expected_error_rad:g} rad"
            yield judge(StabilityCell(engine.name, label, row.name, ""), scene, run, exact, row)
        return
    for step_s in STEPS_S[1:3] if quick else STEPS_S:
        short = step_s == STEPS_S[-1]
        shorter = replace(scene, duration_s=row.share * scene.duration_s) if short else scene
        cell = StabilityCell(engine.name, _step(step_s), row.name, "", short=short)
        yield _of_step(cell, shorter, engine, engine.settings_for_dt(shorter, step_s), exact, row)


def _converged(row: Difficulty, scene: Scene, engine: Engine, exact: Run) -> StabilityCell | None:
    """The whole scene with far more iterations a step; None for a model that has none."""
    if engine.capabilities.certifies:
        return None
    settings = converged(engine.settings_for_dt(scene, CONVERGED_S))
    cell = StabilityCell(engine.name, f"{_step(CONVERGED_S)}, {settings.as_dict()['iterations']} it.", row.name, "")
    return _of_step(cell, scene, engine, settings, exact, row)


def _of_step(
    cell: StabilityCell, scene: Scene, engine: Engine, settings: Settings, exact: Run, row: Difficulty
) -> StabilityCell:
    """The cell of a run with nothing left out; diverged where the engine gives up."""
    try:
        return judge(cell, scene, engine.simulate(scene, settings, NONE), exact, row)
    except EngineFailure as failure:
        return replace(cell, category="diverged", message=str(failure))


def judge(cell: StabilityCell, scene: Scene, run: Run, exact: Run, row: Difficulty) -> StabilityCell:
    """The cell with category, evidence and message of one run against the exact solution."""
    if run.outcome.failed or run.history is None or exact.history is None:
        return replace(cell, category="diverged", message=run.message or run.outcome.value)
    right = hard.agrees(scene, run, exact)
    if not math.isfinite(hard.error_rad(run, exact)):
        return replace(cell, category="diverged", evidence=[Measure("finite", holds=False)])
    drifts = [*hard.energy(scene, run), *hard.depth(scene, run), *(hard.creep(scene, run) if row.at_rest else [])]
    category = "inaccurate" if not hard.all_hold(right) else "stable" if hard.all_hold(drifts) else "drifting"
    return replace(cell, category=category, evidence=[*right, *drifts])


def _step(step_s: float) -> str:
    return f"1/{round(1.0 / step_s)} s" if step_s > 2e-3 else f"{1e3 * step_s:g} ms"


# Why a cell is not stable: the setting of the same row that is, or nothing.


def explained(
    row: Sequence[StabilityCell], converged: Callable[[], StabilityCell | None] = lambda: None
) -> Iterator[StabilityCell]:
    """The cells of one row, from coarse to fine; those that are not stable with the setting that is, where one is known.

    A cell is explained by a whole run with a finer step that is stable. Where there is none, `converged` computes the row with
    far more iterations a step: that cell follows the others, and explains those before it when it is stable.
    """
    finer = [next((each for each in row[k + 1 :] if _explains(each)), None) for k in range(len(row))]
    left = [cell for cell, by in zip(row, finer, strict=True) if cell.category != "stable" and by is None]
    last = converged() if left else None
    for cell, by in zip(row, finer, strict=True):
        if cell.category != "stable" and by is not None:
            yield cell.avoided("step", by)
        elif cell.category != "stable" and last is not None and _explains(last):
            yield cell.avoided("iterations", last)
        else:
            yield cell
    if last is not None:
        yield last


def _explains(cell: StabilityCell) -> bool:
    return cell.category == "stable" and not cell.short


# The record of the whole run.


def assembled(rows: Mapping[str, Sequence[Any]], head: Mapping[str, Any]) -> StressRecord:
    """The record from the rows of all parts; engines of the catalogue that are not here are named with the reason."""
    order = {row.name: place for place, row in enumerate(difficulties())}
    missing = {name: engines.load(name).missing() for name in ALL}
    made = StressRecord(
        absent={name: why for name, why in missing.items() if why is not None},
        scenes=rows["scenes"],
        cells=sorted(rows["maps"], key=lambda cell: (ENGINES.index(cell.engine), order[cell.difficulty])),
        **head,
    )
    return replace(made, answer=answer_of(made), findings=findings_of(made))


def all_parts(quick: bool) -> list[Part]:
    """The parts, the one with the longest tasks first: all are computed side by side."""
    return [
        Part("maps", tasks(quick), partial(compute, quick), died, StabilityCell),
        Part("scenes", hard.tasks(quick), hard.compute, hard.died, HardRow),
    ]


STRESS: Final = Measurement("stress", all_parts, assembled)
