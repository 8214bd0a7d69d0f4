"""Work against precision: every engine on every level, and what a target takes."""

import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import zip_longest
from typing import Final

from harness import engines
from harness.accuracy.horizon import by_model
from harness.accuracy.refinement import run_to_accuracy
from harness.comparison.scores import error_rad
from harness.engines.base import Engine, EngineFailure, Settings
from harness.model import Finding, InputError, Run, RunOptions, Scene, caution, grouped, info, number
from harness.questions.bench.parts import Cost, costs, timed
from harness.questions.bench.standard_scenes import Standard, standard_set
from harness.records.bench import LEVEL, TARGET, LevelChoice, PrecisionRow
from harness.records.run import PLAIN

TARGET_RAD: Final = 1e-3
LONG_S: Final = 1.0
"""A level is left out (and said so) when the one before it took this long: finer levels show the same line further."""
REPEATS: Final = 15
"""Turns in which levels are timed: after a long one caches are cold, and a short one needs more turns to show its least time."""
BUDGET_S: Final = 0.1
"""Processor time of one level after which no further turn is begun: what is compared are ratios of whole numbers and more."""
NOBODY: Final = ""
"""The engine of the row of a scene that is not here."""
NOTHING: Final = Cost(0.0, 0.0, 0)
"""Of what was not run."""


def tasks(quick: bool) -> list[str]:
    """The scenes of the standard set, the longest first."""
    names = [item.name for item in standard_set()]
    return names[:3] if quick else sorted(names, key=lambda name: "Maria" not in name)


def of(quick: bool, name: str) -> list[PrecisionRow]:
    """All rows of one scene of the standard set; one that says why where a file of it is absent."""
    item = next(item for item in standard_set() if item.name == name)
    try:
        scene = item.scene()
    except InputError as error:
        return [PrecisionRow(NOBODY, name, LEVEL, "", failed=str(error))]
    return list(rows_of(item, scene, list(engines.REGISTRY), quick=quick))


def died(name: str) -> list[PrecisionRow]:
    """A scene whose process died: one row that says so."""
    return [PrecisionRow("any", name, LEVEL, "all", failed="the process died")]


def rows_of(item: Standard, scene: Scene, names: Sequence[str], *, quick: bool) -> Iterator[PrecisionRow]:
    """The rows of one scene: each engine's levels, and what the target takes."""
    exact = by_model(scene, options=RunOptions())
    for name in names:
        engine = engines.load(name)
        if item.spatial and engine.capabilities.dimensions < 3:
            continue
        base = PrecisionRow(name, item.name, LEVEL, "not here", item.block)
        reason = engine.missing()
        if reason is not None:
            yield replace(base, failed=reason)
            continue
        # A self-certifying model has no finer settings of another kind to be judged by than its own finest.
        own = item.reference == "own" or engine.capabilities.certifies
        yield from _levels(base, scene, engine, None if own else exact, quick)


def _levels(base: PrecisionRow, scene: Scene, engine: Engine, exact: Run | None, quick: bool) -> Iterator[PrecisionRow]:
    """Every level and what the target takes: errors first, then all of them timed in turns, as they are compared."""
    base = replace(base, reference="analytic" if exact is not None else "own finest level")
    tried = _tried(engine, scene, quick)
    good = [(settings, run, once) for settings, run, once in tried if isinstance(run, Run)]
    judge = exact or (good[-1][1] if good else None)
    # An unmodified engine is not asked what a target takes: it refines until it gives up.
    refines = judge is not None and not engine.capabilities.certifies and not engine.name.endswith(PLAIN)
    refine = partial(run_to_accuracy, engine, scene, TARGET_RAD, RunOptions())
    asked, once = timed(partial(_answered, refine)) if refines else (None, NOTHING)
    works: list[Callable[[], object]] = [
        partial(engine.simulate, scene, settings, RunOptions()) for settings, _, _ in good
    ]
    before = [item[2] for item in good]
    if isinstance(asked, Run):
        works.append(refine)
        before.append(once)
    spent = iter(costs(works, REPEATS, BUDGET_S, before))
    for settings, run, _ in tried:
        row = replace(base, label=_label(settings), dt_s=settings.dt_s)
        if isinstance(run, str) or judge is None:
            yield replace(row, failed=str(run))
            continue
        took = next(spent)
        if run is not judge:
            yield costing(_with(row, run, error_rad(run, judge)), took, run.end_s)
    if asked is not None and judge is not None:
        yield _chosen(replace(base, group=TARGET, label=f"--accuracy {TARGET_RAD:g}"), asked, judge, next(spent, None))


def _tried(engine: Engine, scene: Scene, quick: bool) -> list[tuple[Settings, Run | str, Cost]]:
    """Each level's run, whose error is taken, or why there is none, and its cost."""
    tried: list[tuple[Settings, Run | str, Cost]] = []
    levels = engine.refinement_levels(scene)[: 3 if quick else None]
    for settings in levels:
        if tried and isinstance(tried[-1][1], Run) and tried[-1][2].cpu_s > LONG_S:
            left_out = f"not run: the level before it took {LONG_S:g} s of processor time or more"
            return [*tried, *((finer, left_out, NOTHING) for finer in levels[len(tried) :])]
        run = partial(engine.simulate, scene, settings, RunOptions())
        tried.append((settings, *timed(partial(_answered, run))))
    return tried


def _answered(work: Callable[[], Run]) -> Run | str:
    """What a run gives, or why it gives nothing."""
    try:
        run = work()
    except EngineFailure as failure:
        return str(failure)
    return (run.message or run.outcome.value) if run.outcome.failed or run.history is None else run


def _chosen(row: PrecisionRow, run: Run | str, judge: Run, spent: Cost | None) -> PrecisionRow:
    """What the target accuracy takes, its own checks included."""
    if isinstance(run, Run) and run.settings == judge.settings:
        run = "it goes on to the very level by which errors are judged here"
    if isinstance(run, str) or spent is None:
        return replace(row, failed=str(run))
    error = error_rad(run, judge, run.bounded_until_s)
    row = costing(_with(row, run, error), spent, run.end_s)
    label = f"{row.label}: {run.work.get('runs', 1)} runs, the finest {_label(run.settings)}"
    steps = run.work.get("steps_of_all_runs", run.steps)
    return replace(
        row,
        label=label,
        dt_s=number(run.settings, "dt_s"),
        chosen=True,
        reliable_until_s=run.reliable_until_s,
        steps=steps,
    )


def _with(row: PrecisionRow, run: Run, error: float) -> PrecisionRow:
    """A row with a run's work, its statement and its error."""
    return replace(
        row, error_rad=error, steps=run.steps, iterations=int(number(run.settings, "iterations", 0.0)) or None,
        stated_rad=run.numerical_uncertainty_rad,
    )  # fmt: skip


def costing(row: PrecisionRow, spent: Cost, simulated_s: float) -> PrecisionRow:
    """A row with what it took to simulate so long."""
    factor = simulated_s / spent.cpu_s
    return replace(row, wall_s=spent.wall_s, cpu_s=spent.cpu_s, repeats=spent.repeats, real_time_factor=factor)


def _label(settings: Settings | Mapping[str, object]) -> str:
    """A level by its numbers."""
    plain = settings.as_dict() if isinstance(settings, Settings) else settings
    if "accuracy_rad" in plain:
        return f"{plain['accuracy_rad']:g} rad"
    parts = [f"{1e3 * number(plain, 'dt_s'):g} ms"]
    parts += [f"{plain['iterations']} it."] if "iterations" in plain else []
    return ", ".join(parts)


# What the rows say.


def choice(rows: Sequence[PrecisionRow], target_rad: float) -> list[LevelChoice]:
    """For each engine what the target takes on the scenes where it gave an answer."""
    engines = dict.fromkeys(row.engine for row in rows)
    choices = [_choice([row for row in rows if row.engine == engine], target_rad) for engine in engines]
    return [item for item in choices if item is not None]


def _choice(rows: Sequence[PrecisionRow], target_rad: float) -> LevelChoice | None:
    taken = {row.scene: row for row in rows if row.group == TARGET and row.failed is None}
    if not taken:
        return None
    by_scene = grouped((row.scene, row) for row in rows if row.group == LEVEL and row.scene in taken)
    # By its place among the levels: one level may have other iterations on another scene.
    levels = [
        {row.scene: row for row in at if row is not None and row.failed is None}
        for at in zip_longest(*by_scene.values())
    ]
    whole = [by for by in levels if set(by) == set(taken) and all(row.meets(target_rad) for row in by.values())]
    fixed_s = min((sum(row.cpu_s or 0.0 for row in by.values()) for by in whole), default=None)
    good = grouped((scene, row.cpu_s or 0.0) for by in levels for scene, row in by.items() if row.meets(target_rad))
    times = {scene: (row.cpu_s or 0.0) / min(good[scene]) for scene, row in taken.items() if scene in good}
    total_s = sum(row.cpu_s or 0.0 for row in taken.values())
    worst = max(times, key=lambda scene: times[scene], default=None)
    return LevelChoice(
        rows[0].engine,
        len(taken),
        sum(row.meets(target_rad) for row in taken.values()),
        total_s,
        fixed_s,
        None if fixed_s is None else total_s / fixed_s,
        worst,
        None if worst is None else times[worst],
        statistics.median(times.values()) if times else None,
    )


def fastest(rows: Sequence[PrecisionRow], target_rad: float) -> dict[str, tuple[float, str]]:
    """For each engine the least real-time factor, over the block scenes, of the fastest level that meets the target."""
    factors = grouped(
        ((row.engine, row.scene), (row.real_time_factor or 0.0) if row.meets(target_rad) else 0.0)
        for row in rows
        if row.block and row.group == LEVEL
    )
    by_engine = grouped((engine, (max(of_levels), scene)) for (engine, scene), of_levels in factors.items())
    return {engine: min(of_scenes) for engine, of_scenes in by_engine.items()}


def speeds(rows: Sequence[PrecisionRow], target_rad: float) -> list[Finding]:
    """How fast each engine meets the target."""
    return [
        info("meets_target", model=engine, factor=factor, scene=scene, target_rad=target_rad)
        if factor > 0.0
        else caution("misses_target", model=engine, scene=scene, target_rad=target_rad)
        for engine, (factor, scene) in fastest(rows, target_rad).items()
    ]


def takes(choices: Sequence[LevelChoice], target_rad: float) -> list[Finding]:
    """What the target takes."""
    return [info("target_takes", target_rad=target_rad, **vars(item)).of(item.engine) for item in choices]
