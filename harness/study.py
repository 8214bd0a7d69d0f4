"""Many scenes, several engines: what needs a run gets one, once; what is finished is never lost."""

from __future__ import annotations

import hashlib
import json
import random
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from harness import engines, record
from harness.cases import Base, Case, base_of, expand
from harness.digest import scene_digest
from harness.engine import Engine, Want
from harness.executors import Crash, Pool
from harness.history import Outcome
from harness.record import Run
from harness.run import DEFAULT_ACCURACY_RAD, failed, simulate
from harness.store import Store
from harness.study_file import StudyFile

COST_ORDER: Final = {"pybullet": 0, "mujoco": 1, "pymunk": 2, "analytic": 3}
"""Longest first keeps both ends of a pool busy; within an engine the order is the study's."""
BATCH: Final = {"analytic": 64}
"""Runs handed to a worker at a time: a run of a fraction of a millisecond is not worth a message of its own."""


@dataclass(frozen=True)
class Job:
    """One run to compute: everything a worker on another machine needs."""

    key: str
    engine: str
    base: Base
    setting: tuple[tuple[str, Any], ...]
    accuracy_rad: float
    histories: bool


@dataclass(frozen=True)
class Planned:
    """One case and engine of the plan: its key (None: not sent to the engine), and why."""

    case: Case
    engine: str
    key: str | None
    reason: str


@dataclass(frozen=True)
class Summary:
    """What a call of a study did."""

    cases: int
    wanted: int
    distinct: int
    found: int
    computed: int
    not_sent: int
    failed: int

    def __str__(self) -> str:
        same = self.wanted - self.distinct
        parts = [
            f"{self.cases} cases, {self.wanted} runs wanted",
            f"{same} the same by their physics" if same else "",
            f"{self.found} found in the store" if self.found else "",
            f"{self.computed} computed",
            f"{self.not_sent} not sent to an engine" if self.not_sent else "",
            f"{self.failed} failed" if self.failed else "",
        ]
        return ", ".join(part for part in parts if part)


def run_study(
    study: StudyFile,
    path: Path,
    store: Store,
    pool: Pool,
    told: Callable[[int, int], None] = lambda done, all_: None,
) -> Summary:
    """Run what the study asks and the store does not hold; `told(done, all)` hears of progress.

    Every result is in the store as soon as it is finished. Raises `InputError` for a case that is no scene.
    """
    base = base_of(study, path)
    cases = list(expand(study, base))
    first = [("analytic", "the analytic model runs every case")]
    planned, jobs = plan_cases(study, base, cases, {name for name, _ in first}, lambda case: first[0][1])
    name = study_name(study)
    done = _compute(store, pool, jobs, told)
    others = {engine for case in cases for engine in case.engines} - {"analytic"}
    reasons = _reasons(study, planned, store)
    more, later = plan_cases(study, base, cases, others, reasons.get)
    rows = sorted([*planned, *more], key=lambda item: (item.case.number, item.engine))
    store.write_plan(name, [(p.case.number, p.engine, p.key, p.reason, described(p.case)) for p in rows])
    done = _merged(done, _compute(store, pool, later, told))
    keys = [item.key for item in rows if item.key is not None]
    return Summary(
        cases=len(cases),
        wanted=len(keys),
        distinct=len(set(keys)),
        found=done["found"],
        computed=done["computed"],
        not_sent=len(rows) - len(keys),
        failed=done["failed"],
    )


def study_name(study: StudyFile) -> str:
    """What names a study in its store: its title and the hash of its content."""
    digest = hashlib.sha256(study.model_dump_json().encode()).hexdigest()
    return f"{study.title} [{digest[:12]}]"


def described(case: Case) -> dict[str, Any]:
    """What stands in tables for a case."""
    return {"variant": case.variant, **case.varied}


def plan_cases(
    study: StudyFile, base: Base, cases: Sequence[Case], names: set[str], reason: Callable[[Case], str | None]
) -> tuple[list[Planned], list[Job]]:
    """Key and reason of each case for these engines, and the distinct jobs; `reason(case)` None: not sent."""
    planned: list[Planned] = []
    jobs: dict[str, Job] = {}
    loaded = {name: engines.load(name) for name in names}
    accuracies: dict[str, float] = {**study.accuracy}
    for case in cases:
        asked = [name for name in case.engines if name in names]
        if not asked:
            continue
        why = reason(case)
        scene = base.scene(case.setting) if why is not None else None
        for name in asked:
            if scene is None or why is None:
                planned.append(Planned(case, name, None, "not sent: the analytic outcome is far from a change"))
                continue
            accuracy = accuracies.get(name, DEFAULT_ACCURACY_RAD)
            key = run_key(loaded[name], scene_digest(scene, loaded[name].capabilities), accuracy, study.ask.histories)
            planned.append(Planned(case, name, key, why))
            jobs.setdefault(key, Job(key, name, base, tuple(case.setting.items()), accuracy, study.ask.histories))
    return planned, list(jobs.values())


def run_key(engine: Engine, digest: str, accuracy_rad: float, histories: bool) -> str:
    """The name of a result: scene, engine, settings, versions, and whether its history was asked."""
    versions = record.versions()
    mine = {name: versions.get(name) for name in ("rockcheck", "numpy", "numba", engine.name) if name in versions}
    text = json.dumps([digest, engine.name, accuracy_rad.hex(), histories, mine], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _compute(store: Store, pool: Pool, jobs: Sequence[Job], told: Callable[[int, int], None]) -> dict[str, int]:
    """Run the jobs that the store does not hold, in batches, longest first."""
    known = store.known(job.key for job in jobs)
    left = [job for job in jobs if job.key not in known]
    left.sort(key=lambda job: COST_ORDER[job.engine])
    counts = {"found": len(known), "computed": 0, "failed": 0}

    def done(batch: Sequence[Job], results: Sequence[Run] | BaseException) -> None:
        if isinstance(results, Crash):
            results = [failed(job.engine, Outcome.CRASHED, f"the engine's process died: {results}") for job in batch]
        elif isinstance(results, BaseException):
            raise results
        store.put([(job.key, run) for job, run in zip(batch, results, strict=True)], histories=batch[0].histories)
        counts["computed"] += len(batch)
        counts["failed"] += sum(run.outcome.failed for run in results)
        told(counts["computed"], len(left))

    told(0, len(left))
    pool.run(work, list(batches(left)), done)
    return counts


def batches(jobs: Sequence[Job]) -> list[tuple[Job, ...]]:
    """Jobs in the order given, grouped by engine into what a worker takes at a time."""
    groups: dict[str, list[Job]] = defaultdict(list)
    for job in jobs:
        groups[job.engine].append(job)
    found = []
    for name, members in groups.items():
        size = BATCH.get(name, 1)
        found += [tuple(members[i : i + size]) for i in range(0, len(members), size)]
    return found


def work(batch: Sequence[Job]) -> list[Run]:
    """What a worker does: resolve each scene and run it (a failure is a `Run` that says so)."""
    want = Want(history=batch[0].histories)
    return [
        simulate(job.base.scene(dict(job.setting)), job.engine, accuracy_rad=job.accuracy_rad, want=want)
        for job in batch
    ]


def _merged(a: Mapping[str, int], b: Mapping[str, int]) -> dict[str, int]:
    return {name: a[name] + b[name] for name in a}


def _reasons(study: StudyFile, planned: Sequence[Planned], store: Store) -> Any:
    """Why a case is sent to the contact engines, by the analytic runs that are now in the store."""
    if study.ask.cases == "all":
        return _Always("every case is asked")
    return Boundary.of(study, planned, store)


@dataclass(frozen=True)
class _Always:
    reason: str

    def get(self, case: Case) -> str | None:
        """The same reason for every case."""
        return self.reason


@dataclass(frozen=True)
class Boundary:
    """Which points are near a change of the analytic outcome, and which of the rest are audited."""

    near: Mapping[tuple[int, ...], str]

    @staticmethod
    def of(study: StudyFile, planned: Sequence[Planned], store: Store) -> Boundary:
        """Judge every point from its analytic runs."""
        outcomes: dict[tuple[int, ...], set[str]] = defaultdict(set)
        margins: dict[tuple[int, ...], float] = {}
        for item in planned:
            row = store.get(item.key) if item.key is not None else None
            if row is None:
                continue
            outcomes[item.case.position].add(str(row.record["outcome"]))
            share = row.record["validity"].get("peak_over_slenderness", abs(row.record["peak_theta_rad"]))
            margins[item.case.position] = max(margins.get(item.case.position, 0.0), float(share))
        chosen = {}
        stream = random.Random(study.seed)
        for place in sorted(outcomes):
            around = [outcomes[other] for other in neighbours(place) if other in outcomes]
            if len(outcomes[place]) > 1 or any(other != outcomes[place] for other in around):
                chosen[place] = "near a change of the analytic outcome"
            elif abs(margins[place] - 1.0) <= study.ask.margin:
                chosen[place] = "the analytic peak is near the balance point"
            elif stream.random() < study.ask.audit:
                chosen[place] = "random audit"
        return Boundary(chosen)

    def get(self, case: Case) -> str | None:
        """Why this case is sent, or None."""
        return self.near.get(case.position)


def neighbours(place: tuple[int, ...]) -> list[tuple[int, ...]]:
    """The next points along each axis."""
    return [(*place[:axis], place[axis] + step, *place[axis + 1 :]) for axis in range(len(place)) for step in (-1, 1)]


def audit(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """How the audited cases came out: of those far from a change, how many engines' outcomes differ from the analytic one."""
    said: dict[tuple[int, str], dict[str, Any]] = defaultdict(dict)
    for row in rows:
        if row["run"] is not None:
            said[(row["number"], row["varied"]["variant"])][row["engine"]] = (row["run"]["outcome"], row["reason"])
    audited = differ = 0
    for answers in said.values():
        reference = answers.get("analytic")
        for engine, (outcome, reason) in answers.items():
            if engine != "analytic" and reason == "random audit" and reference is not None:
                audited += 1
                differ += outcome != reference[0]
    return {"audited": audited, "differ": differ}
