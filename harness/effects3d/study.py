"""The whole effects study: every search a task of its own, what is finished kept, one record at the end."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

from harness.campaign.executors import Crash, Pool
from harness.effects3d.band import Band, band
from harness.effects3d.conditions import BASELINE, CONDITIONS, solid_of, without_meaning
from harness.effects3d.departure import Departure, departure
from harness.effects3d.file import SOLID, EffectsFile, load_effects
from harness.effects3d.replay import write_replay
from harness.effects3d.search import Amplitude, Search, find, peak_g
from harness.effects3d.summary import effects, static_rose
from harness.model import run as record
from harness.model.errors import InputError, Mistake
from harness.model.options import Capabilities
from harness.model.run import SCHEMA_VERSION
from harness.model.scene import Scene
from harness.records.result_folder import listing
from harness.records.scene import SceneRecord
from harness.studies.cache_key import scene_digest
from harness.studies.cases import Base, base_of_scene
from meshes import footprint

ORDER: Final = (*SOLID, "pymunk", "pymunk:plain", "analytic")
"""Longest first keeps both ends of a pool busy."""
KEPT_NAME: Final = "searches.jsonl"
LONG_SIDE: Final = 0.05
"""Sides of the footprint shorter than this share of its outline are the bend of one corner."""

Answer = Amplitude | Band | Departure


@dataclass(frozen=True)
class Task:
    """One question: a search, a band or a departure, and what a worker needs to answer it."""

    kind: str
    base: Base
    arguments: tuple[Any, ...]
    key: str


@dataclass(frozen=True)
class Summary:
    """What a call of an effects study did."""

    directions: int
    asked: int
    found: int
    runs: int
    failed: int
    cpu_s: float

    def __str__(self) -> str:
        parts = [
            f"{self.directions} directions",
            f"{self.asked} searches",
            f"{self.runs} runs, {self.cpu_s:.0f} s of processor time",
        ]
        parts += [f"{self.found} searches found finished"] if self.found else []
        parts += [f"{self.failed} failed"] if self.failed else []
        return ", ".join(parts)


def answer(task: Task) -> tuple[Answer, float]:
    """What a worker does, and the processor time, s, that it took."""
    begin = time.process_time()
    scene = task.base.scene({})
    kinds: dict[str, Callable[..., Answer]] = {"search": find, "band": band, "departure": departure}
    return kinds[task.kind](scene, *task.arguments), time.process_time() - begin


class Ledger:
    """The answers found so far, one line of JSON each; a line cut short by a killed process is left out."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.known: dict[str, dict[str, Any]] = {}
        self.spent_s: dict[str, float] = {}
        if path.is_file():
            for line in path.read_text(encoding="utf-8").splitlines():
                try:
                    entry = json.loads(line)
                    key, answer, seconds = str(entry["key"]), dict(entry["answer"]), float(entry["seconds"])
                except (ValueError, TypeError, KeyError):
                    continue
                self.known[key], self.spent_s[key] = answer, seconds

    def put(self, key: str, found: Answer, seconds: float) -> None:
        """Keep an answer and the processor time that it took."""
        self.known[key], self.spent_s[key] = record.to_plain(asdict(found)), seconds
        with self._path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps({"key": key, "seconds": round(seconds, 4), "answer": self.known[key]}) + "\n")


class Questions:
    """Asks the pool for what the ledger does not hold."""

    def __init__(self, base: Base, scene: Scene, ledger: Ledger, pool: Pool, told: Callable[[int, int], None]) -> None:
        self._base, self._ledger, self._pool, self._told = base, ledger, pool, told
        everything = Capabilities(dimensions=3, uses_mesh=True, own_impact=False, statue_slips=True)
        self._digest = scene_digest(scene, everything)
        self.asked = self.found = self.runs = self.failed = 0
        self._asked_keys: set[str] = set()

    def ask(self, kind: str, questions: Sequence[tuple[Any, ...]]) -> list[dict[str, Any]]:
        """The answers in the questions' order; one whose process died is left out and counted."""
        tasks = [Task(kind, self._base, arguments, self._key(kind, arguments)) for arguments in questions]
        left = [task for task in tasks if task.key not in self._ledger.known]
        self.asked += len(tasks)
        self.found += len(tasks) - len(left)
        finished = 0

        def done(task: Task, found: tuple[Answer, float] | BaseException) -> None:
            nonlocal finished
            finished += 1
            self._told(finished, len(left))
            if isinstance(found, Crash):
                self.failed += 1
                return
            if isinstance(found, BaseException):
                raise found
            self._ledger.put(task.key, *found)

        if left:
            self._told(0, len(left))
            self._pool.run(answer, left, done)
        answers = [self._ledger.known[task.key] for task in tasks if task.key in self._ledger.known]
        self.runs += sum(int(item.get("runs", 1)) for item in answers)
        self._asked_keys |= {task.key for task in tasks}
        return answers

    @property
    def seconds(self) -> float:
        """Processor time of all answers, whenever they were found."""
        return sum(self._ledger.spent_s.get(key, 0.0) for key in self._asked_keys)

    def _key(self, kind: str, arguments: tuple[Any, ...]) -> str:
        text = json.dumps([self._digest, kind, repr(arguments), record.versions()], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def run_effects(
    path: Path, folder: Path, pool: Pool, told: Callable[[int, int], None], *, resume: bool = False
) -> tuple[dict[str, Any], Summary]:
    """Run an effects study into `folder` (result.json, searches.jsonl, replay/); returns its record and what was done.

    Raises `InputError` for a wrong file or scene, or `resume` where nothing was begun.
    """
    start = time.perf_counter()
    study = load_effects(path)
    if resume and not (folder / KEPT_NAME).is_file():
        wanted = f"a study that was begun in {folder}"
        raise InputError(Mistake("--resume", "", wanted, "nothing there", "leave --resume out to begin"))
    base = base_of_scene(path.parent / study.scene)
    scene = base.scene({})
    _check(scene, path)
    folder.mkdir(parents=True, exist_ok=True)
    questions = Questions(base, scene, Ledger(folder / KEPT_NAME), pool, told)
    found = {"schema_version": SCHEMA_VERSION, "kind": "effects3d", "title": study.title, "file": path.name}
    found |= _answers(study, scene, questions)
    found |= {
        "scene": SceneRecord.of(scene),
        "notes": scene.notes,
        "study": study.model_dump(),
        "unit_g": peak_g(scene),
        "versions": record.versions(),
        "machine": record.machine(),
        "files": listing(()),
    }
    found["replay"] = write_replay(found, scene, folder / "replay")
    summary = Summary(
        study.directions, questions.asked, questions.found, questions.runs, questions.failed, questions.seconds
    )
    found["summary"] = {"sentence": str(summary), **asdict(summary)}
    found["seconds"] = time.perf_counter() - start
    plain: dict[str, Any] = record.to_plain(found)
    record.write_json(folder / "result.json", plain)
    return plain, summary


def _check(scene: Scene, path: Path) -> None:
    solid_of(scene)
    if scene.base_excitation.x.peak_m_s2 == 0.0:
        raise InputError(Mistake(str(path), "motion.x", "a motion along x", "none"))
    if scene.pedestal is not None or scene.wall is not None:
        wanted = "a statue on the floor: pedestal and wall have a direction of their own"
        raise InputError(Mistake(str(path), "scene", wanted, "a pedestal or a wall"))


def _answers(study: EffectsFile, scene: Scene, questions: Questions) -> dict[str, Any]:
    """All rows of the record: the roses first, then what follows each of them."""
    search = study.wanted()
    engines = sorted(study.engines, key=ORDER.index)
    rows = questions.ask("search", [(BASELINE, a, name, search) for name in engines for a in study.azimuths_deg()])
    sides = [("analytic", azimuth) for azimuth in side_azimuths(scene)]
    projected = questions.ask("search", [(BASELINE, azimuth, name, search) for name, azimuth in sides])
    near = {(row["engine"], row["azimuth_deg"]): row["peak_g"] for row in rows}
    empty = without_meaning(scene)
    wanted = [name for name in study.conditions if name not in empty]
    changed = questions.ask("search", list(_changed(study, wanted, engines, search, near)))
    bands = [(a, search, study.samples, study.seed) for a in study.azimuths_deg(study.every)] if study.samples else []
    leaving = [
        (a, name, study.share * peak, search.dt_s)
        for name in engines
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
        "bands": questions.ask("band", bands),
        "departures": questions.ask("departure", leaving),
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
            if name not in SOLID and not (name == "analytic" and CONDITIONS[condition].planar):
                continue
            for azimuth in study.azimuths_deg(study.every):
                begin = near.get((name, azimuth))
                if begin is not None:
                    yield condition, azimuth, name, search, begin


def side_azimuths(scene: Scene) -> list[float]:
    """Directions across the long sides of the footprint, both ways: where a planar model at a side is asked."""
    polygon = solid_of(scene).footprint_m
    lengths, towards = footprint.sides(polygon)
    found = {round(float(a), 6) for a in towards[lengths > LONG_SIDE * lengths.sum()]}
    return sorted(found | {round((a + 180.0) % 360.0, 6) for a in found})
