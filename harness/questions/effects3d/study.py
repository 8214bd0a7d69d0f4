"""The whole effects study: every search a task of its own, one record at the end."""

from __future__ import annotations

import math
import shlex
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Annotated, Any, Final, Literal, TypeVar

import numpy as np
from pydantic import Field, model_validator

from harness.accuracy.horizon import amplified
from harness.input.mistakes import UserTable, agree
from harness.input.tables import read_model
from harness.model import (
    Answer,
    Finding,
    Outcome,
    Say,
    Scene,
    caution,
    changes_answer,
    grouped,
    info,
    require,
    scan_azimuth_deg,
    written,
)
from harness.model import run as record
from harness.questions.effects3d.search import (
    CONDITIONS,
    EXACT,
    GEOMETRY_REL,
    STEPS,
    Search,
    changed_scene,
    departure,
    find,
    peak_g,
    solid_of,
    start_factor,
    without_meaning,
)
from harness.questions.scene.scene_run import run_scene, write_result
from harness.questions.study.cases import BaseScene, EngineName, base_of_scene
from harness.records.base import check_folder, part, write_whole
from harness.records.effects3d import (
    BASELINE,
    SOLID,
    Amplitude,
    AmplitudeChange,
    AskedRecord,
    Band,
    Departure,
    Effect,
    EffectsRecord,
    EffectsSummary,
    ReplayRecord,
    StaticLimit,
)
from harness.records.scene import SceneRecord
from harness.runs.execute import Campaign, OnProgress, silent
from harness.runs.runner import Pool
from harness.runs.store import STORE_NAME, Store, check_begun
from harness.runs.task import Task, TaskResult, request_key
from harness.statics.standstill import motion_sized
from meshes import footprint
from meshes.orientation import turn_axis
from meshes.solid import turn_about_z

# What the rows of an effects study say together: the planar model asked at the base's sides, and each condition's effect.

GRAZING_COS: Final = 0.05
"""A side that the shaking meets more obliquely than this (87°) is not tipped by it."""


def scan_directions(scene: Scene) -> Finding:
    """Where the study's 0° and 90° point on the scan as its file has it, before it was set upright and turned."""
    file, up = (written(scene, "statue", "mesh", key) for key in ("file", "up"))
    back = turn_axis(str(up or "z")).T @ turn_about_z(scan_azimuth_deg(scene)).T
    first, second = ((column.round(12) + 0.0).tolist() for column in (back[:, 0], back[:, 1]))
    return info("scan_directions", file=str(file), along_0=first, along_90=second)


def static_rose(scene: Scene, azimuths_deg: Sequence[float], sides: Sequence[Amplitude]) -> list[StaticLimit]:
    """By direction: peaks, g, at which a level push lifts the statue in 3D and in the plane, and the sides' planar answer.

    `projected_g` is the least over the base's sides of the planar model's amplitude at the side divided by the cosine between
    shaking and the side's direction: the share of the shaking that turns the statue about that side.
    """
    solid = solid_of(scene)
    back = [azimuth + 180.0 for azimuth in azimuths_deg]
    # The floor shakes both ways along a direction.
    reach, corner = (
        np.minimum(of(solid.footprint_m, azimuths_deg), of(solid.footprint_m, back)) / solid.centroid_height_m
        for of in (footprint.reach_m, footprint.corner_m)
    )
    limits = zip(azimuths_deg, reach.tolist(), corner.tolist(), strict=True)
    return [StaticLimit(azimuth, lifts, planar, *_projected(azimuth, sides)) for azimuth, lifts, planar in limits]


def _projected(azimuth_deg: float, sides: Sequence[Amplitude]) -> tuple[float | None, float | None]:
    amplitudes = [
        (row.peak_g / share, row.azimuth_deg)
        for row in sides
        for share in [math.cos(math.radians(azimuth_deg - row.azimuth_deg))]
        if row.peak_g is not None and share > GRAZING_COS
    ]
    return min(amplitudes, default=(None, None))


def effects(rows: Sequence[Amplitude], conditions: Sequence[str]) -> list[Effect]:
    """For every engine and condition how much the overturning amplitude changes: by direction, median, least and largest."""
    base = {(row.engine, row.azimuth_deg): row.peak_g for row in rows if row.condition == BASELINE}
    asked = grouped(((row.engine, row.condition), row) for row in rows)
    found = []
    every = product(dict.fromkeys(row.engine for row in rows), conditions)
    for engine, condition in (each for each in every if each in asked):
        mine = asked[engine, condition]
        changes = [
            AmplitudeChange(row.azimuth_deg, row.peak_g / unchanged - 1.0)
            for row in mine
            for unchanged in [base[engine, row.azimuth_deg]]
            if row.peak_g is not None and unchanged is not None
        ]
        values = [item.relative for item in changes]
        median = float(np.median(values)) if values else None
        least, largest = min(values, default=None), max(values, default=None)
        flips = sum(row.peak_g is None for row in mine)
        group = CONDITIONS[condition].group
        found.append(Effect(engine, condition, group, changes, median, least, largest, flips))
    return found


# One case of an effects study run with histories, to be watched: where 3D leaves the plane most.

PLANAR: Final = "analytic"


def write_replay(
    scene: Scene, rows: Sequence[Amplitude], departures: Sequence[Departure], dt_s: float, folder: Path
) -> ReplayRecord | None:
    """Run the direction whose motion turns most about the vertical, at its overturning amplitude, into `folder`; say what it is.

    By a contact engine where one was asked: there the exact model may slide for a million steps. None when no engine
    overturned the statue in any direction whose motion was followed.
    """
    yaw_rad = {row.azimuth_deg: abs(row.yaw_rad) for row in departures}
    overturned = [row for row in rows if row.condition == BASELINE and row.peak_g and row.azimuth_deg in yaw_rad]
    chosen = max(
        (row for row in overturned if row.engine in SOLID),
        key=lambda row: (row.engine != EXACT, yaw_rad[row.azimuth_deg]),
        default=None,
    )
    if chosen is None or chosen.peak_g is None:
        return None
    engine, azimuth, peak = chosen.engine, chosen.azimuth_deg, chosen.peak_g
    turned = changed_scene(scene, BASELINE, azimuth)
    shaken = amplified(turned, peak / peak_g(turned))
    shaken = replace(shaken, title=f"{scene.title}, shaken towards {azimuth:g}° with {peak:.3g} g")
    result = run_scene(shaken, [PLANAR, engine], dt_s=dt_s)
    write_result(result, folder)
    outcomes = {name: run.outcome for name, run in result.runs.items()}
    return ReplayRecord(azimuth, engine, peak, outcomes, folder.name, _command(scene, azimuth, peak, engine, dt_s))


def _command(scene: Scene, azimuth_deg: float, peak: float, engine: str, dt_s: float) -> str:
    """The command that runs the same case by itself; empty where the motion has no single key for its size."""
    sized = motion_sized(scene, peak / peak_g(scene))
    if not sized or scene.source is None:
        return ""
    turn = scan_azimuth_deg(scene) - azimuth_deg
    still = "".join(f" --set motion.{axis}=none" for axis in "yz" if written(scene, "motion", axis) is not None)
    return (
        f"rockcheck run {shlex.quote(scene.source.name)} -e {PLANAR} -e {engine} --dt {dt_s:g}"
        f" --set statue.mesh.azimuth_deg={turn:g}"
        f" --set {sized}{still}"
    )


# The planar model's overturning amplitude of many statues that differ by a survey's errors: the band around a rose.

SIGMAS: Final = 2.0
"""The stated uncertainty of a length or an inertia is this many standard deviations."""


def band(scene: Scene, azimuth_deg: float, search: Search, samples: int, seed: int) -> Band:
    """The band at one azimuth; h, each corner and J drawn independently, normal, two standard deviations being 3 %.

    Every statue has two corners (a ragged base counts as its outer ones). Raises `InputError`.
    """
    from analytic import Block, ensemble
    from harness.model import keywords

    changed = changed_scene(scene, BASELINE, azimuth_deg)
    statue, unit = changed.statue, peak_g(changed)
    block = Block.two_corners(
        mass_kg=statue.mass_kg,
        centroid_height_m=statue.centroid_height_m,
        inertia_kg_m2=statue.inertia_kg_m2,
        corner_left_m=statue.corner_left_m,
        corner_right_m=statue.corner_right_m,
    )
    draws = 1.0 + GEOMETRY_REL / SIGMAS * np.random.default_rng([seed, round(azimuth_deg)]).standard_normal(
        (4, samples, 1)
    )
    least, most = min(start_factor(changed), 0.5 * search.most_g / unit), search.most_g / unit
    count = math.ceil(math.log(most / least) / math.log(STEPS["analytic"]))
    factors = np.geomspace(least, most, count + 1)
    given: dict[str, Any] = {name: value for name, value in keywords(changed).items() if name not in UNUSED}
    drawn = ensemble(
        block,
        changed.base_excitation.x,
        sweep={
            "scale": factors[None, :],
            "centroid_height_m": statue.centroid_height_m * draws[0],
            "corner_left_m": statue.corner_left_m * draws[1],
            "corner_right_m": statue.corner_right_m * draws[2],
            "inertia_kg_m2": statue.inertia_kg_m2 * draws[3],
        },
        threads=1,
        **given,
    )
    falls = drawn.overturned.any(axis=1)
    first = np.where(falls, factors[np.argmax(drawn.overturned, axis=1)] * unit, np.inf)
    low, middle, high = (
        None if math.isinf(value) else value
        for value in (float(np.quantile(first, q, method="inverted_cdf")) for q in (0.05, 0.5, 0.95))
    )
    return Band(float(azimuth_deg), low, middle, high, float(np.mean(~falls)), int(drawn.steps.size))


UNUSED: Final = frozenset({"statue_friction", "pedestal", "wall"})
"""Keywords that an effects scene leaves at rest: the statue stands on the floor."""


ORDER: Final = (*SOLID, "pymunk", "pymunk:plain", "analytic")
"""Longest first keeps both ends of a pool busy."""
LONG_SIDE: Final = 0.05
"""Sides of the footprint shorter than this share of its outline are the bend of one corner."""

REPLAY: Final = "replay"
"""The folder of the case that is run to be watched, in the result's."""
WORK: Final[dict[type, tuple[str, Callable[..., object]]]] = {
    Amplitude: ("search", find),
    Band: ("band", band),
    Departure: ("departure", departure),
}
"""What an answer of each class is called in a store, and what finds it."""
T = TypeVar("T", Amplitude, Band, Departure)


def answer(question: tuple[type, BaseScene, tuple[Any, ...]]) -> TaskResult:
    """What a worker does for the answer of a class, from its scene and arguments; its cost is the processor time, s, it took."""
    begin = time.process_time()
    kind, base, arguments = question
    name, work = WORK[kind]
    plain = record.to_plain(work(base.scene({}), *arguments))
    return TaskResult(name, plain, time.process_time() - begin)


def asked(
    base: BaseScene, campaign: Campaign, where: Path, kind: type[T], questions: Iterable[tuple[Any, ...]]
) -> list[T]:
    """The answers in the questions' order, those that the store `where` lacks found now; one whose process died is left out."""
    (name, _), scene = WORK[kind], base.scene({})
    named = [(each, [item.key() if isinstance(item, Search) else item for item in each]) for each in questions]
    tasks = [Task(request_key(scene, None, name, words), answer, (kind, base, each)) for each, words in named]
    return [part(kind, item, where) for item in campaign.ask(tasks) if item is not None]


def run_file(
    path: Path,
    folder: Path,
    pool: Pool,
    on_progress: OnProgress = silent,
    *,
    resume: bool = False,
    say: Say = lambda finding: "",
) -> EffectsRecord:
    """Run an effects study into `folder` (result.json, store.sqlite, replay/); returns its record.

    Raises `InputError` for a wrong file or scene, or `resume` where nothing was begun.
    """
    start = time.perf_counter()
    study = read_model(EffectsFile, path)
    if resume:
        check_begun(folder, "a study")
    check_folder(folder / REPLAY, ("run",))
    base = base_of_scene(path.parent / study.scene)
    scene = base.scene({})
    _check(scene, path)
    with Store(folder / STORE_NAME, "effects3d") as store:
        done = Campaign(store, pool, on_progress)
        answers = answers_of(study, scene, partial(asked, base, done, store.path))
        # A direction across a side may be one of the rose's, and is then one search.
        searched = {*answers["rows"], *answers["sides"], *answers["bands"]}
        runs = sum(each.runs for each in searched) + len(answers["departures"])
        counts = done.computed + len(done.reused), len(done.reused), runs, done.failed, done.asked_s
    finished = EffectsRecord(
        title=study.title,
        file=path.name,
        **answers,
        scene=SceneRecord.of(scene),
        findings=[scan_directions(scene), *scene.findings],
        study=part(AskedRecord, study.model_dump(), path),
        unit_g=peak_g(scene),
        replay=write_replay(scene, answers["rows"], answers["departures"], study.search.dt_s, folder / REPLAY),
        summary=EffectsSummary(study.directions, *counts),
        versions=record.versions(),
        machine=record.machine(),
        seconds=time.perf_counter() - start,
    )
    finished = replace(finished, answer=answer_of(finished), findings=[*findings_of(finished), *finished.findings])
    return write_whole(folder, finished.texted(say))


def _check(scene: Scene, path: Path) -> None:
    solid_of(scene)
    require(scene.base_excitation.x.peak_m_s2 > 0.0, str(path), "a motion along x", "none", key="motion.x")
    wanted = "a statue on the floor: pedestal and wall have a direction of their own"
    require(scene.pedestal is None and scene.wall is None, str(path), wanted, "a pedestal or a wall", key="scene")


def answers_of(study: EffectsFile, scene: Scene, ask: Callable[..., list[Any]]) -> dict[str, Any]:
    """All rows of the record: the roses first, then what follows each of them; `ask(kind, questions)` gives the answers."""
    search = study.search
    engines = sorted(study.engines, key=ORDER.index)
    first = [name for name in engines if name in (EXACT, PLANAR)] if EXACT in engines else engines
    rows: list[Amplitude] = ask(
        Amplitude, [(BASELINE, a, name, search) for name in first for a in study.azimuths_deg()]
    )
    others = [name for name in engines if name not in first]
    rows += ask(Amplitude, [(BASELINE, a, name, search) for name in others for a in checked_azimuths(rows)])
    projected = ask(Amplitude, [(BASELINE, a, PLANAR, search) for a in side_azimuths(scene)])
    near = {(row.engine, row.azimuth_deg): row.peak_g for row in rows}
    empty = without_meaning(scene)
    wanted = [name for name in study.conditions if name not in empty]
    if EXACT in engines:
        empty |= {name: "own_steps" for name in wanted if CONDITIONS[name].group == "numerical"}
        wanted = [name for name in wanted if name not in empty]
    changed = ask(Amplitude, _changed(study, wanted, first, search, near))
    bands = [(a, search, study.samples, study.seed) for a in study.azimuths_deg(study.every)] if study.samples else []
    leaving = [
        (a, name, study.share * peak, search.dt_s)
        for name in first
        if name in SOLID
        for a in study.azimuths_deg()
        for peak in [near.get((name, a))]
        if peak is not None
    ]
    everything = [*rows, *changed]
    return {
        "rows": everything,
        "sides": projected,
        "static": static_rose(scene, study.azimuths_deg(), projected),
        "bands": ask(Band, bands),
        "departures": ask(Departure, leaving),
        "effects": effects(everything, wanted),
        "left_out": empty,
    }


def _changed(
    study: EffectsFile,
    wanted: Sequence[str],
    engines: Sequence[str],
    search: Search,
    near: dict[tuple[str, float], float | None],
) -> Iterator[tuple[Any, ...]]:
    """The searches under every condition, by engine: 3D engines all, the analytic model those that it sees."""
    for name in engines:
        for condition in wanted:
            if name in SOLID or (name == PLANAR and CONDITIONS[condition].planar):
                for azimuth in study.azimuths_deg(study.every):
                    if (begin := near.get((name, azimuth))) is not None:
                        yield condition, azimuth, name, search, begin


def checked_azimuths(rows: Sequence[Amplitude]) -> list[float]:
    """Where other engines are asked beside the exact model: where it doubts its answer, and where the plane errs most."""
    exact = {row.azimuth_deg: row for row in rows if row.engine == EXACT}
    doubtful = {azimuth for azimuth, row in exact.items() if row.doubt}
    errors = {
        row.azimuth_deg: (row.peak_g or row.stands_at_g) / peak
        for row in rows
        if row.engine == PLANAR and row.azimuth_deg in exact
        for peak in [exact[row.azimuth_deg].peak_g]
        if peak is not None
    }
    return sorted(doubtful | {max(errors, key=lambda azimuth: errors[azimuth])} if errors else doubtful)


def side_azimuths(scene: Scene) -> list[float]:
    """Directions across the long sides of the footprint, both ways: where a planar model at a side is asked."""
    lengths, towards = footprint.sides(solid_of(scene).footprint_m)
    azimuths = {round(float(a), 6) for a in towards[lengths > LONG_SIDE * lengths.sum()]}
    return sorted(azimuths | {round((a + 180.0) % 360.0, 6) for a in azimuths})


REFUSES: Final = dict.fromkeys(
    ("--export", "--witness"), "a study of cases: all of one of the third dimension stands in its result.json"
)
KIND = "effects3d"


class EffectsFile(UserTable):
    """A whole file of `kind = "effects3d"`.

    Directions are `directions` equal parts of the circle; conditions are asked at every `every`-th of them. `samples` statues
    with errors in h, b and J are drawn at each of those for the band around the planar model.
    """

    kind: Literal["effects3d"]
    title: Annotated[str, Field(min_length=1)]
    scene: Annotated[str, Field(min_length=1)]
    directions: Annotated[int, Field(ge=4, le=360)] = 24
    every: Annotated[int, Field(ge=1, le=90)] = 2
    engines: Annotated[list[EngineName], Field(min_length=1)]
    conditions: list[str] = Field(default_factory=lambda: [name for name in CONDITIONS if name != BASELINE])
    samples: Annotated[int, Field(ge=0, le=10_000)] = 200
    share: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.95
    seed: Annotated[int, Field(ge=0)] = 0
    search: Search = Search()

    @model_validator(mode="after")
    def _whole(self) -> EffectsFile:
        known, engines = [name for name in CONDITIONS if name != BASELINE], ", ".join(self.engines)
        unknown = next((name for name in self.conditions if name not in known), None)
        solid, once = any(name in SOLID for name in self.engines), len(set(self.engines)) == len(self.engines)
        divides = self.directions % self.every == 0
        agree(
            (unknown is None, "conditions", f"names out of {', '.join(known)}", repr(unknown)),
            (solid, "engines", f"one that computes in 3D ({' or '.join(SOLID)})", engines),
            (once, "engines", "each engine once", engines),
            (divides, "every", f"a divisor of directions = {self.directions}", str(self.every)),
        )
        return self

    def azimuths_deg(self, every: int = 1) -> list[float]:
        """The directions, or every n-th of them."""
        return [360.0 * k / self.directions for k in range(0, self.directions, every)]


# What an effects study says: the planar model against the solid one by direction, and each effect beside a survey's errors.

NEAR: Final = 0.05
"""Amplitudes within this share of each other count as the same: a survey's errors move them as much."""
LEAVES_RAD: Final = 1e-3
"""A statue that leaves the plane of shaking by more is said to."""
UNKNOWN: Final = (0.05, 0.95)
"""Quantiles between which the changes by a survey's errors are told."""

Peaks = Mapping[float, float]


def answer_of(record: EffectsRecord) -> Answer:
    """At how many directions the planar model is too safe, by how much at most, and the least peak that overturns."""
    solid, planar = (_peaks(record, name) for name in (record.solid_engine, "analytic"))
    found = [*_planar(record, solid, planar)] if planar else [changes_answer("plane_not_asked")]
    for name, peaks in ((record.solid_engine, solid), ("analytic", planar)):
        least_g = min(peaks.values(), default=math.inf)
        if math.isfinite(least_g):
            azimuth_deg = next(a for a, peak in peaks.items() if peak == least_g)
            found.append(info("least_peak", model=name, peak_g=least_g, azimuth_deg=azimuth_deg))
    return Answer(found[0].code, [*found, info("effects_done", **vars(record.summary))])


def findings_of(record: EffectsRecord) -> list[Finding]:
    """All that is to be known beside the headline."""
    return [*_solid_pairs(record), *_effects(record), *_leaving(record)]


def _peaks(record: EffectsRecord, engine: str) -> dict[float, float]:
    """Overturning peak by direction of one engine, infinite where it does not overturn up to the most tried."""
    rows = record.amplitudes(engine, BASELINE)
    return {row.azimuth_deg: math.inf if row.peak_g is None else row.peak_g for row in rows}


def _planar(record: EffectsRecord, solid: Peaks, planar: Peaks) -> Iterator[Finding]:
    over = [a for a in solid if math.isfinite(solid[a]) and planar[a] > (1.0 + NEAR) * solid[a]]
    sides = [row for row in record.static if math.isfinite(solid.get(row.azimuth_deg, math.inf))]
    apart = {row: abs(row.projected_g / solid[row.azimuth_deg] - 1.0) for row in sides if row.projected_g is not None}
    values: dict[str, Any] = {"over": len(over), "directions": len(solid), "near": NEAR, "model": record.solid_engine}
    yield changes_answer("plane_unsafe", **values) if over else info("plane_safe", **values)
    fall_over = {row.azimuth_deg: [row.side_deg] for row, share in apart.items() if share <= NEAR}
    if apart:
        median = float(np.median([*apart.values()]))
        yield info("plane_by_sides", median=median, directions=len(apart), within=len(fall_over), near=NEAR)
    if over:
        most_g = record.study.search.most_g
        worst = max(over, key=lambda a: min(planar[a], most_g) / solid[a])
        never = sum(math.isinf(planar[a]) for a in over)
        values = {"azimuth_deg": worst, "solid_g": solid[worst], "never": never, "sides_deg": fall_over.get(worst, [])}
        bounded = math.isfinite(planar[worst])
        yield info(
            "plane_worst",
            bounded=bounded,
            planar_g=planar[worst] if bounded else most_g,
            error=min(planar[worst], most_g) / solid[worst] - 1.0,
            **values,
        )


def _solid_pairs(record: EffectsRecord) -> Iterator[Finding]:
    """Each other 3D engine against the first, and where the exact model's own answer is in doubt."""
    first = record.solid_engine
    one = _peaks(record, first)
    for name in (name for name in record.engines if name in SOLID and name != first):
        other = _peaks(record, name)
        both = [a for a in one if math.isfinite(one[a]) and math.isfinite(other.get(a, math.inf))]
        apart = np.abs([other[a] / one[a] - 1.0 for a in both])
        if both:
            values = {"median": float(np.median(apart)), "within": int((apart <= NEAR).sum()), "directions": len(both)}
            yield info("solids_apart", a=name, b=first, near=NEAR, **values)
    doubted = {row.azimuth_deg: row.doubt for row in record.amplitudes(first, BASELINE) if row.doubt}
    if undecided := [azimuth for azimuth, doubt in doubted.items() if doubt == "undecided"]:
        yield caution("peaks_undecided", azimuths_deg=undecided).of(first)
    if change := [azimuth for azimuth, doubt in doubted.items() if doubt == "change"]:
        yield caution("peaks_change", azimuths_deg=change).of(first)


def _effects(record: EffectsRecord) -> Iterator[Finding]:
    """The least and largest change of each by direction, beside the range of what a survey does not know."""
    mine = [item for item in record.effects if item.engine == record.solid_engine and item.median is not None]
    unknown = [change.relative for item in mine if item.group == "uncertainty" for change in item.changes]
    if unknown:
        low, high = (float(np.quantile(unknown, q)) for q in UNKNOWN)
        yield info("survey_effect", low=low, high=high, model=record.solid_engine)
    shown = {item.condition: [item.least, item.largest] for item in mine if item.group != "uncertainty"}
    if shown:
        yield info("other_effects", ranges=shown)


def _leaving(record: EffectsRecord) -> Iterator[Finding]:
    """How far statues that stand leave the plane: one that falls at less than the least found, too, is no example of it."""
    mine = [each for each in record.departures if each.engine == record.solid_engine and each.outcome == Outcome.STANDS]
    leaving = [row.out_of_plane_rad for row in mine if row.out_of_plane_rad > LEAVES_RAD]
    if leaving:
        yield info(
            "leaves_plane",
            share=record.study.share,
            leaving=len(leaving),
            directions=len(mine),
            out_of_plane_rad=max(leaving),
            yaw_rad=max(abs(row.yaw_left_rad) for row in mine),
            walked_m=max(row.walked_m for row in mine),
        )
