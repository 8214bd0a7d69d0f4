"""The whole map: the model everywhere, engines where they are needed, a tenth of what they were not asked checked."""

from __future__ import annotations

import csv
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import takewhile
from pathlib import Path
from typing import Final

import numpy as np

from harness import engines
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD
from harness.input.paths import read_files
from harness.input.scene_file import load_scene
from harness.model.errors import InputError, Mistake
from harness.model.finding import Answer, Finding, Say, caution, changes_answer, info
from harness.model.options import Capabilities
from harness.model.run import machine, versions
from harness.model.scene import Scene
from harness.records.base import Plain, part
from harness.records.result_folder import COMING, PAGES, RECORD, check_folder, check_inputs, write_whole
from harness.records.scene import SceneRecord
from harness.records.scores import Interval
from harness.records.trust import CLASSES, HELD, MOTIONS, Basis, TrustCell, TrustClass, TrustRecord, TrustSummary
from harness.runs.cache_key import key_of, scene_key
from harness.runs.dask_pool import DaskPool
from harness.runs.execute import Campaign, OnProgress
from harness.runs.progress import progress
from harness.runs.runner import LocalPool, Pool
from harness.runs.store import STORE_NAME, Store, check_begun
from harness.runs.task import Task
from harness.scene_run.workload import check as check_work
from harness.trust.plane import Plane, Point, below, to_ask
from harness.trust.point import DRAWS, MODEL, Question, Said, ask, interval_of

CELLS_NAME: Final = "cells.csv"
CHECKED: Final = 0.1
"""Share of the points without engine runs that is run all the same."""
MOST_CHECKS: Final = 3
"""Where a check finds another class its surroundings are refined and a tenth of the rest is checked, so often at most."""
BATCH: Final = 8
"""Points of the model alone, some 40 ms each, that a worker takes at a time."""
EVERYTHING: Final = Capabilities(dimensions=3, uses_mesh=True, own_impact=False, statue_slips=True)
"""What a key sees of a scene: all of it."""


@dataclass
class Points:
    """Asks what the store does not hold; `keys` are those of all that was asked."""

    plane: Plane
    store: Store
    campaign: Campaign
    keys: set[str] = field(default_factory=set)

    def ask(self, points: Iterable[Point], names: tuple[str, ...]) -> dict[Point, Plain | None]:
        """What is said at each point; None where the process died."""
        tasks = {point: self._task(point, names) for point in points}
        self.campaign.run(tasks.values(), len(tasks))
        self.keys |= {task.key for task in tasks.values()}
        return {point: self.store.get(task.key) for point, task in tasks.items()}

    def said(self, points: Iterable[Point], names: tuple[str, ...]) -> dict[Point, Said]:
        """The same, read; a point whose process died has no answer."""
        return {
            point: _died(names) if plain is None else part(Said, plain, self.store.path)
            for point, plain in self.ask(points, names).items()
        }

    def _task(self, point: Point, names: tuple[str, ...]) -> Task:
        scene = self.plane.at(point)
        what = names or ("probability", DRAWS)
        key = key_of(scene_key(scene, EVERYTHING), "trust", what, DEFAULT_ACCURACY_RAD, versions())
        return Task(key, ask, Question(scene, names), MODEL if names == (MODEL,) else "")

    @property
    def cpu_s(self) -> float:
        """Processor time of all answers, whenever they were found."""
        return sum(self.store.seconds(key) or 0.0 for key in self.keys)


@dataclass
class Map:
    """What is known of the plane: the model's word everywhere, the engines' where they ran."""

    plane: Plane
    model: Mapping[Point, Said]
    rest: set[Point]
    ran: dict[Point, Said] = field(default_factory=dict)
    checks: set[Point] = field(default_factory=set)
    changed: set[Point] = field(default_factory=set)

    def unasked(self) -> set[Point]:
        """Where engines are to be asked next."""
        points = set()
        for i in range(len(self.plane.frequencies_hz)):
            alike = [
                None if (i, j) in self.rest else self.model[i, j].alike for j in range(len(self.plane.amplitudes_g))
            ]
            points |= {(i, j) for j in to_ask(alike, self._along(i), self.plane.farthest)}
        return points

    def kind(self, point: Point) -> tuple[TrustClass, Basis, Said]:
        """The class of a point, what it rests on, and the run that says so, here or at the strength below."""
        if point in self.ran:
            return self.ran[point].kind, "checked" if point in self.checks else "runs", self.ran[point]
        if point in self.rest:
            return "nothing_moves", "rest", self.model[point]
        other = self.ran[point[0], below(point[1], self._along(point[0]))]
        return other.kind, "between", other

    def check(self, points: Iterable[Point], said: Mapping[Point, Said]) -> None:
        """Take checks in; where one is not what was said, its surroundings are no longer decided."""
        for point in points:
            if said[point].kind != self.kind(point)[0]:
                self.changed.add(point)
                self.rest = {each for each in self.rest if each[0] != point[0]}
        self.checks |= set(points)
        self.ran |= said

    def _along(self, i: int) -> dict[int, tuple[object, ...]]:
        """What engines found along a frequency, by strength."""
        return {point[1]: said.found for point, said in self.ran.items() if point[0] == i}


def run_trust(
    path: Path,
    folder: Path,
    names: Sequence[str] | None = None,
    overrides: Sequence[str] = (),
    *,
    motion: str = "sine",
    coarse: bool = False,
    jobs: int | None = None,
    resume: bool = False,
    dask: str | None = None,
    seed: int = 0,
    quiet: bool = False,
    pool: Pool | None = None,
    say: Say = lambda finding: "",
) -> TrustRecord:
    """The trust map of a scene into `folder` (store.sqlite, result.json, cells.csv); `say` fills in the sentences.

    `pool` is used, and not closed, where given.

    Raises `InputError` for wrong input, or `resume` where nothing was begun.
    """
    if motion not in MOTIONS:
        raise InputError(Mistake("--motion", "", f"one of {', '.join(MOTIONS)}", repr(motion)))
    check_folder(folder, ("trust",), [RECORD, COMING, *PAGES, CELLS_NAME])
    scene = load_scene(path, overrides)
    check_inputs(folder, [RECORD, CELLS_NAME], [path, *read_files(scene.given, scene.source)])
    plane = Plane.of(scene, motion, coarse=coarse)
    hardest = plane.at(plane.points[-1])
    chosen = engines_of(hardest, names, coarse=coarse)
    check_work(hardest, {name: engines.load(name).capabilities.dimensions for name in chosen}, str(path))
    if resume:
        check_begun(folder, "a trust map")
    own = (LocalPool(jobs) if dask is None else DaskPool(dask)) if pool is None else None
    try:
        with Store(folder / STORE_NAME, "trust") as store, progress(f"{path.stem}, trust map", quiet) as on_progress:
            record = trust_map(plane, chosen, store, own or pool, on_progress, coarse=coarse, seed=seed)  # type: ignore[arg-type]
    finally:
        if own is not None:
            own.close()
    return write_whole(folder, record.texted(say), lambda fresh: write_cells(record.cells, fresh / CELLS_NAME))


def engines_of(scene: Scene, names: Sequence[str] | None, *, coarse: bool) -> tuple[str, ...]:
    """The analytic model and who is asked beside it: those named; or of a run's own all that are here and no twin of it, of a
    coarse map none that takes seconds for a point.

    Raises `InputError` where there is nobody beside it, or one that was named is not installed.
    """
    others = [engines.load(name) for name in dict.fromkeys(names or engines.default_engines(scene)) if name != MODEL]
    here = [item for item in others if item.missing() is None]
    if not names:
        # A planar scene in three dimensions is the planar answer again.
        quick = [item for item in here if item.capabilities.dimensions == 2 or item.name == engines.EXACT_IN_SPACE]
        here = quick if coarse or scene.planar else here
    if not here or (names and here != others):
        got = "; ".join(f"{item.name}: {item.missing()}" for item in others if item not in here) or f"{MODEL} alone"
        wanted = "engines that are installed, one of them beside the analytic model, to hold it against"
        raise InputError(Mistake("--engine", "", wanted, got))
    return (MODEL, *(item.name for item in here))


def trust_map(
    plane: Plane, names: tuple[str, ...], store: Store, pool: Pool, on_progress: OnProgress, *, coarse: bool, seed: int
) -> TrustRecord:
    """The record of a map whose answers are kept in a store."""
    start = time.perf_counter()
    campaign = Campaign(store, pool, on_progress, {MODEL: BATCH})
    points = Points(plane, store, campaign)
    every = plane.points
    model = points.said(every, (MODEL,))
    found = Map(plane, model, {point for point in every if model[point].still and plane.at_rest(point)})
    stream = np.random.default_rng(seed)
    for _ in range(MOST_CHECKS):
        while asked := found.unasked():
            found.ran |= points.said(sorted(asked), names)
        left = [point for point in every if point not in found.ran]
        chosen = stream.permutation(len(left))[: round(CHECKED * len(left))]
        checks, before = sorted(left[k] for k in chosen.tolist()), len(found.changed)
        found.check(checks, points.said(checks, names))
        if len(found.changed) == before:
            break
    while asked := found.unasked():
        found.ran |= points.said(sorted(asked), names)
    open_ends = [point for point in every if found.kind(point)[0] == "probability"]
    chances = {point: interval_of(plain) for point, plain in points.ask(open_ends, ()).items()}
    cells = [_cell(found, point, chances.get(point)) for point in every]
    shares = {kind: sum(cell["class"] == kind for cell in cells) / len(cells) for kind in CLASSES}
    up_to = confirmed_up_to_g(found)
    summary = TrustSummary(
        points=len(every),
        asked=len(found.ran),
        checked=len(found.checks),
        changed=len(found.changed),
        found=len(campaign.reused),
        cpu_s=points.cpu_s,
        failed=campaign.failed,
    )
    return TrustRecord(
        title=plane.scene.title,
        answer=answer_of(plane, shares, up_to),
        findings=[*findings_of(cells, summary, seed), *plane.scene.findings],
        scene=SceneRecord.of(plane.scene),
        motion=plane.motion,
        coarse=coarse,
        engines=names,
        seed=seed,
        shares=shares,
        confirmed_up_to_g=up_to,
        cells=cells,
        summary=summary,
        seconds=time.perf_counter() - start,
        versions=versions(),
        machine=machine(),
    )


def confirmed_up_to_g(found: Map) -> float | None:
    """The largest strength up to which outcome and peak are confirmed at every frequency."""

    def confirmed(j: int) -> bool:
        each = [found.kind((i, j)) for i in range(len(found.plane.frequencies_hz))]
        return all(kind in HELD and said.peak_confirmed for kind, _, said in each)

    strengths = found.plane.amplitudes_g
    held = list(takewhile(confirmed, range(len(strengths))))
    return strengths[held[-1]] if held else None


def answer_of(plane: Plane, shares: Mapping[TrustClass, float], up_to_g: float | None) -> Answer:
    """The headline: up to which strength the model holds, and the shares of the plane."""
    frequencies = [each for each in plane.frequencies_hz if each is not None]
    over = {"from_g": plane.amplitudes_g[0], "to_g": plane.amplitudes_g[-1]}
    if frequencies:
        over |= {"from_hz": frequencies[0], "to_hz": frequencies[-1]}
    told = {kind: share for kind, share in shares.items() if share}
    held = info("trust_nowhere") if up_to_g is None else info("trust_up_to", strength_g=up_to_g)
    refuted = [changes_answer("trust_refuted", share=shares["refuted"])] if shares["refuted"] else []
    return Answer("refuted" if refuted else "trust_map", [*refuted, held, info("trust_shares", shares=told, **over)])


def findings_of(cells: Sequence[TrustCell], summary: TrustSummary, seed: int) -> list[Finding]:
    """What the map rests on, and why models left their domain or the plane is not enough."""
    checks = {"checked": summary.checked, "changed": summary.changed, "seed": seed}
    found = [
        info("trust_asked", points=summary.points, asked=summary.asked),
        caution("trust_checked", **checks) if summary.changed else info("trust_checked", **checks),
    ]
    for kind in ("left_domain", "plane_left_out", "no_answer"):
        causes = sorted({cause for cell in cells if cell["class"] == kind for cause in cell["why"]})
        found += [caution("trust_why", kind=kind, causes=causes)] if causes else []
    return found


def write_cells(cells: Sequence[TrustCell], path: Path) -> None:
    """A row for each point."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream)
        ends = [f"outcome_{name}" for name in {name: None for cell in cells for name in cell["outcomes"]}]
        plain = [name for name in cells[0] if name not in ("outcomes", "probability")]
        rows.writerow([*plain, *ends, "probability", "probability_low", "probability_high"])
        for cell in cells:
            values = {**cell, "why": " ".join(cell["why"])}
            chance = cell["probability"]
            bounds = [None] * 3 if chance is None else [chance.value, chance.low, chance.high]
            told = [cell["outcomes"].get(name.removeprefix("outcome_"), "") for name in ends]
            rows.writerow([*(values[name] for name in plain), *told, *bounds])


def _cell(found: Map, point: Point, chance: Interval | None) -> TrustCell:
    """A point as it stands in the record; numbers of runs only where it has its own."""
    kind, basis, by = found.kind(point)
    own, model = point in found.ran, found.model[point]
    strength, frequency = found.plane.without_dimension(point)
    return {
        "amplitude_g": found.plane.amplitudes_g[point[1]],
        "frequency_hz": found.plane.frequencies_hz[point[0]],
        "class": kind,
        "basis": basis,
        "answer": by.answer if own else "",
        "why": by.why if basis != "rest" else [],
        "outcomes": by.outcomes if own else model.outcomes,
        "peak_rad": model.peak_rad,
        "peaks_apart_rad": by.peaks_apart_rad if own else None,
        "agree_until_s": by.agree_until_s if own else None,
        "horizon_s": model.horizon_s,
        "probability": chance,
        "amplitude_over_g_tan_alpha": strength,
        "frequency_over_p": frequency,
    }


def _died(names: tuple[str, ...]) -> Said:
    """A point whose process died."""
    ends = dict.fromkeys(names, "crashed")
    return Said("no_answer", "no_answer", ["crashed"], ends, False, False, "", None, None, None, None, False)
