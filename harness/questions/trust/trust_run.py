"""The whole map: the model everywhere, engines where they are needed, a tenth of what they were not asked checked."""

import csv
import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from itertools import takewhile
from pathlib import Path
from typing import Final

import numpy as np

from harness import engines
from harness.accuracy.forecast import run_s
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD, simulate
from harness.input.paths import read_files
from harness.input.scene_file import load_scene
from harness.model import (
    MOST_TIMES,
    Answer,
    Finding,
    InputError,
    Say,
    Scene,
    caution,
    changes_answer,
    check_known,
    grouped,
    info,
    machine,
    require,
    versions,
)
from harness.questions.assess.probability import SAMPLE_S
from harness.questions.assess.sensitivity import crossing
from harness.questions.scene.workload import check as check_work
from harness.questions.study.case_selection import filled, refined
from harness.questions.trust.plane import Plane, Point, below, to_ask
from harness.questions.trust.point import (
    DRAWS,
    MODEL,
    STRETCHES,
    Kept,
    Question,
    Said,
    assess_point,
    interval_of,
    run_point,
)
from harness.records.base import Plain, part
from harness.records.result_folder import COMING, PAGES, RECORD, check_folder, check_inputs, write_whole
from harness.records.run import HorizonRecord, has_answer
from harness.records.scene import SceneRecord
from harness.records.scores import Interval
from harness.records.trust import (
    CLASSES,
    CONTOURS,
    HELD,
    MOTIONS,
    Basis,
    Rotation,
    Saved,
    TrustCell,
    TrustClass,
    TrustMap,
    TrustRecord,
    TrustSummary,
    knows_most,
)
from harness.runs.execute import Campaign
from harness.runs.progress import LESS_STORED, duration_words, progress
from harness.runs.runner import DaskPool, LocalPool, Pool
from harness.runs.store import STORE_NAME, Store, check_begun
from harness.runs.task import Task, request_key
from harness.runs.task import TaskResult as Told

CELLS_NAME: Final = "cells.csv"
CHECKED: Final = 0.1
"""Share of the points without engine runs that is run all the same."""
MOST_CHECKS: Final = 3
"""Where a check finds another class its surroundings are refined and a tenth of the rest is checked, so often at most."""
BATCH: Final = 8
"""Points of the model alone, some 40 ms each, that a worker takes at a time."""
DOUBTFUL: Final = (0.05, 0.95)
"""Probabilities between which an engine is asked for its own."""
SAME: Final = ""
"""The engines in space change nothing of what those in the plane say."""
PLANAR: Final = 2
POINT_S: Final = 0.06
"""Processor seconds of a point by the model, in a forecast: its run, its horizon and its probability."""
ASKED: Final = {2: 0.55, 3: 0.4}
"""Share of the points at which an engine in the plane, and one in space, is asked: 0.41 to 0.57, and 0.2 to 0.43, of the shipped
statue's maps."""
COARSE_TIMES: Final = 8.0
"""What a climb of a coarse map may take: half of the time, and here and there a whole motion is not confirmed to its end."""
CHANCE_S: Final = 6.0
"""Of an engine's probability, at one point of each frequency of a whole map."""
TRIALS: Final = 16
"""Drawn points of each map whose runs are forecast."""


@dataclass
class Points:
    """Asks what the store does not hold; `most_times` is what an engine's climb may take (`RunOptions`), `draws` how many draws a
    probability has.
    """

    store: Store
    campaign: Campaign
    most_times: float = MOST_TIMES
    draws: int = DRAWS[False]

    def kept(
        self,
        plane: Plane,
        points: Iterable[Point],
        names: tuple[str, ...],
        horizons: Mapping[Point, Mapping[str, HorizonRecord]] | None = None,
    ) -> dict[Point, Kept | None]:
        """What the runs of these models are at each point; None where the process died. `horizons` are known already."""
        found = self._ask(run_point, plane, points, names, horizons or {})
        return {point: None if each is None else part(Kept, each, self.store.path) for point, each in found.items()}

    def chances(self, plane: Plane, points: Iterable[Point], name: str) -> dict[Point, Interval]:
        """The probability of a fall by one model, where it has any."""
        found = self._ask(assess_point, plane, points, (name,), {})
        return {point: known for point, each in found.items() if (known := interval_of(each)) is not None}

    def _ask(
        self,
        work: Callable[[Question], Told],
        plane: Plane,
        points: Iterable[Point],
        names: tuple[str, ...],
        horizons: Mapping[Point, Mapping[str, HorizonRecord]],
    ) -> dict[Point, Plain | None]:
        asked = "trust", work.__name__, names, self.draws, STRETCHES, DEFAULT_ACCURACY_RAD, self.most_times
        group = MODEL if names == (MODEL,) else ""
        scenes = {point: plane.at(point) for point in points}
        tasks = [
            Task(
                request_key(scene, None, *asked),
                work,
                Question(scene, names, self.most_times, self.draws, horizons.get(point, {})),
                group,
            )
            for point, scene in scenes.items()
        ]
        return dict(zip(scenes, self.campaign.ask(tasks), strict=True))


@dataclass
class Map:
    """What is known of the plane: the model's word everywhere, and what was found where engines ran: by those in the plane
    (`ran`, whose borders are halved along each frequency), and by all (`whole`), where one in space takes seconds for a point.

    That one is asked as a study's adaptive map is: on a coarse grid, refined where it says another class than those in the plane.
    """

    plane: Plane
    names: tuple[str, ...]
    model: Mapping[Point, Said]
    rest: set[Point]
    ran: dict[Point, Said] = field(default_factory=dict)
    whole: dict[Point, Said] = field(default_factory=dict)
    checks: set[Point] = field(default_factory=set)
    changed: set[Point] = field(default_factory=set)
    paths: dict[Point, Mapping[str, Rotation]] = field(default_factory=dict)
    horizons: Mapping[Point, Mapping[str, HorizonRecord]] = field(default_factory=dict)

    @property
    def quick(self) -> tuple[str, ...]:
        """The model and the engines in the plane; all, where that is nobody beside it or there is one frequency only."""
        quick = tuple(name for name in self.names if engines.load(name).capabilities.dimensions == PLANAR)
        return quick if len(quick) > 1 and len(self.plane.frequencies_hz) > 1 else self.names

    def unasked(self, names: tuple[str, ...]) -> set[Point]:
        """Where those engines are to be asked next."""
        if names != self.quick:
            wanted = refined(self.plane.points, self._changes(), (0, 1), self.plane.farthest)
            return wanted.keys() - self.rest - self.whole.keys()
        points: set[Point] = set()
        for i in range(len(self.plane.frequencies_hz)):
            alike = [
                None if (i, j) in self.rest else self.model[i, j].alike for j in range(len(self.plane.amplitudes_g))
            ]
            points |= {(i, j) for j in to_ask(alike, self._along(i), self.plane.farthest[1])}
        return points

    def take(self, names: tuple[str, ...], kept: Mapping[Point, Kept | None]) -> None:
        """Take in what was kept of their runs: where all ran, also what those in the plane say by themselves."""
        for point, each in kept.items():
            scene = self.plane.at(point)
            said = {who: _died(who) if each is None else each.said(scene, who) for who in (names, self.quick)}
            self.ran[point] = said[self.quick]
            if each is not None:
                self.paths[point] = each.paths
            if names == self.names:
                self.whole[point] = said[names]

    def words(self) -> dict[Point, tuple[TrustClass, Basis, Said]]:
        """The class of each point, what it rests on, and the run that says so, here or nearby."""
        changes = self._changes()
        fill = filled(self.plane.points, changes, (0, 1), self.plane.farthest)
        return {point: self._word(point, changes, fill.get(point, SAME)) for point in self.plane.points}

    def _word(self, point: Point, changes: Mapping[Point, str], fill: str) -> tuple[TrustClass, Basis, Said]:
        """What is less known of the two counts: what those in the plane say, what an engine in space makes of it around."""
        if point in self.whole:
            return self.whole[point].kind, self._basis(point), self.whole[point]
        kind, basis, said = self._in_plane(point)
        if fill == SAME or _doubt(fill) < _doubt(kind):
            return kind, basis, said
        alike = (each for each in self.whole if changes[each] == fill)
        nearest = self.whole[min(alike, key=lambda at: math.dist(at, point))]
        return nearest.kind, "between", nearest

    def _in_plane(self, point: Point) -> tuple[TrustClass, Basis, Said]:
        """What those in the plane say."""
        if point in self.ran:
            return self.ran[point].kind, self._basis(point), self.ran[point]
        if point in self.rest:
            return "nothing_moves", "rest", self.model[point]
        other = self.ran[point[0], below(point[1], self._along(point[0]))]
        return other.kind, "between", other

    def _basis(self, point: Point) -> Basis:
        return "checked" if point in self.checks else "runs"

    def check(self, points: Sequence[Point], kept: Mapping[Point, Kept | None]) -> None:
        """Take checks in; where one is not what was said, its surroundings are no longer decided."""
        said = self.words()
        self.take(self.names, kept)
        self.checks |= set(points)
        for point in points:
            if self.whole[point].kind != said[point][0]:
                self.changed.add(point)
                self.rest = {each for each in self.rest if each[0] != point[0]}

    def _changes(self) -> dict[Point, str]:
        """Where all ran: which class they say instead of that of those in the plane. At rest nobody says another."""
        said = {
            point: all_of.kind if all_of.found != self.ran[point].found else SAME
            for point, all_of in self.whole.items()
        }
        return dict.fromkeys(self.rest, SAME) | said

    def _along(self, i: int) -> dict[int, tuple[object, ...]]:
        """What engines in the plane found along a frequency, by strength."""
        return {point[1]: said.found for point, said in self.ran.items() if point[0] == i}


def _doubt(kind: str) -> int:
    """How little a class says is known."""
    return [str(each) for each in CLASSES].index(kind)


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
    check_known(motion, MOTIONS, "--motion")
    check_folder(folder, ("trust",), [RECORD, COMING, *PAGES, CELLS_NAME])
    scene = load_scene(path, overrides)
    check_inputs(folder, [RECORD, CELLS_NAME], [path, *read_files(scene.given, scene.source)])
    plane = Plane.of(scene, motion, coarse=coarse)
    hardest = plane.at(plane.points[-1])
    chosen = engines_of(hardest, names, coarse=coarse)
    check_work(hardest, {name: engines.load(name).capabilities.dimensions for name in chosen}, str(path))
    if resume:
        check_begun(folder, "a trust map")
    with ExitStack() as stack:
        workers = pool or stack.enter_context(closing(LocalPool(jobs) if dask is None else DaskPool(dask)))
        size = cost_words(plane, chosen, workers.workers, coarse=coarse) + LESS_STORED * (folder / STORE_NAME).exists()
        store = stack.enter_context(Store(folder / STORE_NAME, "trust"))
        on_progress = stack.enter_context(progress(f"{path.stem}, trust map", quiet, size, grows=True))
        campaign = Campaign(store, workers, on_progress, {MODEL: BATCH}, free=(MODEL,))
        points = Points(store, campaign, COARSE_TIMES if coarse else MOST_TIMES, DRAWS[coarse])
        record = trust_map(plane, chosen, points, coarse=coarse, seed=seed)
    record = replace(record, overrides=overrides)
    return write_whole(folder, record.texted(say), lambda fresh: write_cells(record.maps, fresh / CELLS_NAME))


def engines_of(scene: Scene, names: Sequence[str] | None, *, coarse: bool) -> tuple[str, ...]:
    """The analytic model and who is asked beside it: those named; or of a run's own all that are here and no twin of it, of a
    coarse map none that takes seconds for a point.

    Raises `InputError` where there is nobody beside it, or one that was named is not installed.
    """
    others = [engines.load(name) for name in engines.asked(names, engines.default_engines(scene)) if name != MODEL]
    here = [item for item in others if item.missing() is None]
    if not names:
        # A planar scene in three dimensions is the planar answer again.
        quick = [item for item in here if item.capabilities.dimensions == 2 or item.name == engines.EXACT_IN_SPACE]
        here = quick if coarse or scene.planar else here
    got = "; ".join(f"{item.name}: {item.missing()}" for item in others if item not in here) or f"{MODEL} alone"
    wanted = "engines that are installed, one of them beside the analytic model, to hold it against"
    require(here and (not names or here == others), "--engine", wanted, got)
    return (MODEL, *(item.name for item in here))


def planes_of(plane: Plane) -> tuple[list[Plane], list[Finding]]:
    """The plane, and of a statue on a pedestal that without it; or why there is none."""
    if plane.scene.pedestal is None:
        return [plane], []
    try:
        return [plane, plane.without_pedestal()], []
    except InputError as error:
        return [plane], [caution("trust_without_floor", reason=str(error))]


def cost_words(plane: Plane, names: Sequence[str], workers: int, *, coarse: bool) -> str:
    """How many points a map has, and what it is expected to take, nothing being stored yet: by the runs of drawn points."""
    planes, cpu_s = planes_of(plane)[0], 0.0
    for each in planes:
        drawn = np.random.default_rng(0).permutation(len(each.points))[:TRIALS].tolist()
        scenes = [each.at(each.points[k]) for k in drawn]
        asked = {name: ASKED[engines.load(name).capabilities.dimensions] for name in names if name != MODEL}
        runs_s = sum(share * run_s(name, scene).middle for name, share in asked.items() for scene in scenes)
        # A probability has an engine's draws where the model leaves its domain.
        left = sum(not has_answer(simulate(scene, MODEL)) for scene in scenes)
        cpu_s += len(each.points) * (POINT_S + (runs_s + SAMPLE_S * left) / len(scenes))
        cpu_s += 0.0 if coarse else CHANCE_S * len(each.frequencies_hz)
    points, spent, clock = len(planes) * len(plane.points), duration_words(cpu_s), duration_words(cpu_s / workers)
    return f"{points} points: about {spent} of processor time, {clock} by the clock (workers: {workers})"


def trust_map(plane: Plane, names: tuple[str, ...], points: Points, *, coarse: bool, seed: int) -> TrustRecord:
    """The record of a map whose answers are kept in a store; of a statue on a pedestal also that of the map without it."""
    start = time.perf_counter()
    planes, alone = planes_of(plane)
    found = [explored(each, names, points, seed) for each in planes]
    maps = [map_of(each, points, coarse=coarse) for each in found]
    summary = TrustSummary(
        points=sum(len(each.plane.points) for each in found),
        asked=sum(len(each.ran) for each in found),
        checked=sum(len(each.checks) for each in found),
        changed=sum(len(each.changed) for each in found),
        found=len(points.campaign.reused),
        cpu_s=points.campaign.asked_s,
        failed=points.campaign.failed,
        whole=sum(len(each.whole) for each in found),
    )
    saved = saved_by(names, maps)
    return TrustRecord(
        title=plane.scene.title,
        answer=answer_of(plane, names, maps, saved),
        findings=[*findings_of(maps, saved, summary, seed), *alone, *plane.shaken.findings],
        scene=SceneRecord.of(plane.scene),
        motion=plane.motion,
        coarse=coarse,
        engines=names,
        seed=seed,
        maps=maps,
        saved=saved,
        summary=summary,
        seconds=time.perf_counter() - start,
        versions=versions(),
        machine=machine(),
    )


def explored(plane: Plane, names: tuple[str, ...], points: Points, seed: int) -> Map:
    """What is known of a plane once engines were asked where they may say another class than is told without."""
    every = plane.points
    alone = points.kept(plane, every, (MODEL,))
    model = {at: _died((MODEL,)) if kept is None else kept.said(plane.at(at), (MODEL,)) for at, kept in alone.items()}
    rest = {point for point in every if model[point].still and plane.at_rest(point)}
    paths = {at: kept.paths for at, kept in alone.items() if kept is not None}
    horizons = {at: kept.horizons for at, kept in alone.items() if kept is not None}
    found = Map(plane, names, model, rest, paths=paths, horizons=horizons)
    _refine(found, points)
    stream = np.random.default_rng(seed)
    for _ in range(MOST_CHECKS):
        left = [point for point in every if point not in found.ran]
        chosen = stream.permutation(len(left))[: round(CHECKED * len(left))]
        checks, before = sorted(left[k] for k in chosen.tolist()), len(found.changed)
        found.check(checks, points.kept(plane, checks, names, found.horizons))
        _refine(found, points)
        if len(found.changed) == before:
            break
    return found


def _refine(found: Map, points: Points) -> None:
    """Ask until nothing is left that may be another class."""
    tiers = dict.fromkeys((found.names, found.quick))
    while wanted := {names: asked for names in tiers if (asked := found.unasked(names))}:
        for names, asked in wanted.items():
            # Where all run, those in the plane say by themselves what they would.
            left = asked if names == found.names else asked - wanted.get(found.names, set())
            found.take(names, points.kept(found.plane, sorted(left), names, found.horizons))


def map_of(found: Map, points: Points, *, coarse: bool) -> TrustMap:
    """The map of a plane with each point's probability of a fall; on a whole map by an engine too, where that is near a half."""
    plane, words = found.plane, found.words()
    moving = [point for point in plane.points if words[point][0] != "nothing_moves"]
    chances = {MODEL: points.chances(plane, moving, MODEL)}
    engine = next(name for name in found.names if name != MODEL)
    if not coarse:
        chances[engine] = points.chances(plane, doubtful(chances[MODEL]), engine)
    by_point = {at: {name: known[at] for name, known in chances.items() if at in known} for at in plane.points}
    cells = [_cell(found, point, words[point], by_point[point]) for point in plane.points]
    return TrustMap(
        stands_on="floor" if plane.scene.pedestal is None else "pedestal",
        shares={kind: sum(cell["class"] == kind for cell in cells) / len(cells) for kind in CLASSES},
        confirmed_up_to_g=confirmed_up_to_g(found, words),
        contours={name: contour(name, cells, plane) for name in CONTOURS},
        cells=cells,
    )


def contour(name: str, cells: Sequence[TrustCell], plane: Plane) -> list[float | None]:
    """The least strength, g, at each frequency at which the value of one of `CONTOURS` is passed."""
    count = len(plane.amplitudes_g)
    line = []
    for i in range(len(plane.frequencies_hz)):
        duration_s = plane.at((i, 0)).duration_s
        heights = {cell["amplitude_g"]: _height(name, cell, duration_s) for cell in cells[i * count : (i + 1) * count]}
        known = {at: height for at, height in heights.items() if height is not None}
        line.append(crossing([*known.values()], CONTOURS[name], [*known]))
    return line


def _height(name: str, cell: TrustCell, duration_s: float) -> float | None:
    """What a contour is of, at one point; None where the model, having left its domain, knows no largest lean."""
    if name.startswith("probability"):
        chance = cell["probability"].get(MODEL)
        return 0.0 if chance is None else chance.value
    if name == "horizon":
        return 0.0 if cell["horizon_s"] is None else 1.0 - cell["horizon_s"] / duration_s
    if cell["peak_over_alpha"] is None:
        return math.inf if cell["outcomes"][MODEL] in ("overturned", "undecided") else None
    return cell["peak_over_alpha"]


def doubtful(chances: Mapping[Point, Interval]) -> list[Point]:
    """Of each frequency the point at which a fall is nearest as probable as not, where any is between `DOUBTFUL`."""
    open_ = (point for point, chance in chances.items() if DOUBTFUL[0] < chance.value < DOUBTFUL[1])
    along = grouped((point[0], point) for point in open_)
    return [min(points, key=lambda point: abs(chances[point].value - 0.5)) for points in along.values()]


def confirmed_up_to_g(found: Map, words: Mapping[Point, tuple[TrustClass, Basis, Said]]) -> float | None:
    """The largest strength up to which outcome and peak are confirmed at every frequency, and the model's outcome stays the same:
    between two strengths where it changes it is a matter of probability.
    """
    strengths, each = found.plane.amplitudes_g, range(len(found.plane.frequencies_hz))

    def confirmed(j: int) -> bool:
        known = all(words[i, j][0] in HELD and words[i, j][2].peak_confirmed for i in each)
        return known and all(found.model[i, j].outcomes == found.model[i, max(j - 1, 0)].outcomes for i in each)

    held = list(takewhile(confirmed, range(len(strengths))))
    return strengths[held[-1]] if held else None


def saved_by(names: Sequence[str], maps: Sequence[TrustMap]) -> dict[str, Saved]:
    """By model: at how many of the points known with and without the pedestal that prevents or causes a fall."""
    if len(maps) < 2:
        return {}
    own, floor = (each.cells for each in maps)
    return {
        name: Saved.of([(falls(without, name), falls(cell, name)) for cell, without in zip(own, floor, strict=True)])
        for name in names
    }


def falls(cell: TrustCell, name: str) -> bool | None:
    """Whether the statue falls by one model's own run, or by the limits of rest; None where it is not known."""
    ends = cell["outcomes"]
    end = ends.get(name if cell["basis"] != "rest" else MODEL)
    return None if end not in ("overturned", "stands") else end == "overturned"


def answer_of(plane: Plane, names: Sequence[str], maps: Sequence[TrustMap], saved: Mapping[str, Saved]) -> Answer:
    """The headline: up to which strength the model holds, whether space was asked of a scan, the shares of the plane,
    and what the pedestal saves.
    """
    frequencies = [each for each in plane.frequencies_hz if each is not None]
    over = {"from_g": plane.amplitudes_g[0], "to_g": plane.amplitudes_g[-1]}
    # The scene's own motion has no frequency of which to speak.
    every_hz = {"from_hz": frequencies[0], "to_hz": frequencies[-1]} if frequencies else {}
    refuted = [changes_answer("trust_refuted", share=each.shares["refuted"]) for each in maps if each.shares["refuted"]]
    held, told = list[Finding](), list[Finding]()
    for each in maps:
        where, up_to_g = "own" if each is maps[0] else "floor", each.confirmed_up_to_g
        held_where = where if up_to_g is not None else f"{where}_nowhere"
        held.append(info("trust_up_to", where=held_where, strength_g=up_to_g, **every_hz))
        shares = {kind: share for kind, share in each.shares.items() if share}
        shaken = plane.motion if where == "own" else where
        told.append(info("trust_shares", where=shaken, shares=shares, **over, **every_hz))
    planar = all(engines.load(name).capabilities.dimensions == PLANAR for name in names)
    alone = [caution("trust_in_plane")] if planar and not plane.shaken.planar else []
    first = knows_most(saved, MODEL)
    pedestal = [] if first is None else [info("pedestal_saves", model=first, **vars(saved[first]))]
    return Answer("refuted" if refuted else "trust_map", [*refuted[:1], *held, *alone, *pedestal, *told])


def findings_of(
    maps: Sequence[TrustMap], saved: Mapping[str, Saved], summary: TrustSummary, seed: int
) -> list[Finding]:
    """What the maps rest on, why models left their domain or the plane is not enough, and what the pedestal saves by engines."""
    some = summary.whole if summary.whole < summary.asked else None
    checks, first = {"checked": summary.checked, "changed": summary.changed, "seed": seed}, knows_most(saved, MODEL)
    found = [
        info("trust_asked", points=summary.points, asked=summary.asked, some=some),
        caution("trust_checked", **checks) if summary.changed else info("trust_checked", **checks),
        *(info("pedestal_saves", model=name, **vars(each)) for name, each in saved.items() if name != first),
    ]
    cells = [cell for each in maps for cell in each.cells]
    for kind in ("left_domain", "plane_left_out", "no_answer"):
        causes = sorted({cause for cell in cells if cell["class"] == kind for cause in cell["why"]})
        found += [caution("trust_why", kind=kind, causes=causes)] if causes else []
    return found


def write_cells(maps: Sequence[TrustMap], path: Path) -> None:
    """A row for each point of each map; what is of one model has its columns after all others, outcomes first."""
    rows = [_row(each.stands_on, cell) for each in maps for cell in each.cells]
    names = dict.fromkeys(name for row in rows for name in row)
    columns = sorted(names, key=lambda name: (name.startswith("probability_"), name.startswith("outcome_")))
    with path.open("w", newline="", encoding="utf-8") as stream:
        table = csv.DictWriter(stream, columns)
        table.writeheader()
        table.writerows(rows)


def _row(stands_on: str, cell: TrustCell) -> dict[str, object]:
    """A point by its columns: lists as words, and a column for each model's outcome and probability with its interval."""
    plain = {name: value for name, value in cell.items() if name not in ("outcomes", "probability", "paths")}
    plain |= {"why": " ".join(cell["why"]), "set": " ".join(f"--set '{item}'" for item in cell["set"])}
    outcomes = {f"outcome_{name}": end for name, end in cell["outcomes"].items()}
    chances = {
        f"probability_{name}{end}": value
        for name, chance in cell["probability"].items()
        for end, value in (("", chance.value), ("_low", chance.low), ("_high", chance.high))
    }
    return {"stands_on": stands_on, **plain, **outcomes, **chances}


def _cell(found: Map, point: Point, word: tuple[TrustClass, Basis, Said], chances: Mapping[str, Interval]) -> TrustCell:
    """A point as it stands in the record; numbers of runs only where it has its own."""
    kind, basis, by = word
    own, model, plane = point in found.ran, found.model[point], found.plane
    strength, frequency = plane.without_dimension(point)
    return {
        "amplitude_g": plane.amplitudes_g[point[1]],
        "frequency_hz": plane.frequencies_hz[point[0]],
        "class": kind,
        "basis": basis,
        "answer": by.answer if own else "",
        "why": by.why if basis != "rest" else [],
        "outcomes": by.outcomes if own else model.outcomes,
        "peak_rad": model.peak_rad,
        "peak_over_alpha": model.balance_share,
        "peaks_apart_rad": by.peaks_apart_rad if own else None,
        "agree_until_s": by.agree_until_s if own else None,
        "horizon_s": model.horizon_s,
        "probability": chances,
        "amplitude_over_g_tan_alpha": strength,
        "frequency_over_p": frequency,
        "set": plane.command(point),
        "paths": found.paths.get(point, {}),
    }


def _died(names: tuple[str, ...]) -> Said:
    """A point whose process died."""
    ends = dict.fromkeys(names, "crashed")
    alike = ends.get(MODEL), False, False, "", False
    return Said("no_answer", "no_answer", ["crashed"], ends, False, alike, None, None, None, None, None)
