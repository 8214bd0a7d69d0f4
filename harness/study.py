"""Many scenes, several engines: what needs a run gets one, once; what is finished is never lost."""

from __future__ import annotations

import hashlib
import json
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from harness import asking, engines, record
from harness.batches import batches, runs_of
from harness.cases import Base, Case, base_of, expand
from harness.digest import scene_digest
from harness.engine import Engine, Want
from harness.executors import Pool
from harness.record import Run
from harness.run import DEFAULT_ACCURACY_RAD, simulate
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

    @property
    def place(self) -> tuple[int, str]:
        """Its row in the plan."""
        return self.case.number, self.engine


@dataclass
class Counts:
    """What has been done so far in one call."""

    found: set[str] = field(default_factory=set)
    mine: set[str] = field(default_factory=set)
    failed: int = 0

    @property
    def computed(self) -> int:
        """Runs computed in this call."""
        return len(self.mine)


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

    The analytic model runs first, then the others in as many rounds as the question takes. Every result is in the store as soon
    as it is finished. Raises `InputError` for a case that is no scene.
    """
    base = base_of(study, path)
    cases = list(expand(study, base))
    keys = Keys(study, base)
    answers: dict[tuple[str, str], dict[asking.Place, asking.Answer]] = {}
    counts = Counts()
    rows: dict[tuple[int, str], Planned] = {}
    for names in _rounds(cases):
        while True:
            fresh = [item for item in _planned(study, cases, names, answers, keys) if rows.get(item.place) != item]
            new = [item for item in fresh if item.key is not None]
            rows.update({item.place: item for item in fresh})
            if not new:
                break
            _compute(store, pool, [keys.job(item) for item in new], told, counts)
            _learn(store, new, answers)
    ordered = [rows[place] for place in sorted(rows)]
    store.write_plan(
        study_name(study), [(p.case.number, p.engine, p.key, p.reason, described(p.case)) for p in ordered]
    )
    sent = [item.key for item in ordered if item.key is not None]
    return Summary(
        cases=len(cases),
        wanted=len(sent),
        distinct=len(set(sent)),
        found=len(counts.found),
        computed=counts.computed,
        not_sent=len(ordered) - len(sent),
        failed=counts.failed,
    )


def _rounds(cases: Sequence[Case]) -> list[list[str]]:
    """The reference first, then all others together."""
    names = sorted({name for case in cases for name in case.engines}, key=lambda name: COST_ORDER[name])
    others = [name for name in names if name != asking.REFERENCE]
    return [group for group in ([asking.REFERENCE] if asking.REFERENCE in names else [], others) if group]


def _planned(
    study: StudyFile,
    cases: Sequence[Case],
    names: Sequence[str],
    answers: asking.Answers,
    keys: Keys,
) -> Iterator[Planned]:
    """What each of these engines is asked, as far as is known now."""
    by_variant: dict[str, list[Case]] = defaultdict(list)
    for case in cases:
        by_variant[case.variant].append(case)
    for variant, members in by_variant.items():
        for name in names:
            if name not in members[0].engines:
                continue
            reasons = asking.wanted(study, [case.position for case in members], name, variant, answers)
            for case in members:
                why = reasons.get(case.position)
                key = None if why is None else keys.of(case, name)
                yield Planned(case, name, key, why or asking.left_out(study))


def _learn(
    store: Store, items: Sequence[Planned], answers: dict[tuple[str, str], dict[asking.Place, asking.Answer]]
) -> None:
    for item in items:
        row = store.get(item.key) if item.key is not None else None
        if row is not None:
            share = row.record["validity"].get("peak_over_slenderness") or abs(row.record["peak_theta_rad"])
            known = answers.setdefault((item.engine, item.case.variant), {})
            known[item.case.position] = asking.Answer(str(row.record["outcome"]), float(share))


class Keys:
    """Keys and jobs of cases, each scene resolved once."""

    def __init__(self, study: StudyFile, base: Base) -> None:
        self._study, self._base = study, base
        self._known: dict[tuple[int, str], str] = {}

    def of(self, case: Case, engine: str) -> str:
        """The key of a case for an engine."""
        place = (case.number, engine)
        if place not in self._known:
            loaded = engines.load(engine)
            digest = scene_digest(self._base.scene(case.setting), loaded.capabilities)
            self._known[place] = run_key(loaded, digest, self._accuracy(engine), self._study.ask.histories)
        return self._known[place]

    def job(self, item: Planned) -> Job:
        """What a worker needs for a planned case."""
        setting = tuple(item.case.setting.items())
        accuracy, key = self._accuracy(item.engine), self.of(item.case, item.engine)
        return Job(key, item.engine, self._base, setting, accuracy, self._study.ask.histories)

    def _accuracy(self, engine: str) -> float:
        given = [value for name, value in self._study.accuracy.items() if name == engine]
        return given[0] if given else DEFAULT_ACCURACY_RAD


def study_name(study: StudyFile) -> str:
    """What names a study in its store: its title and the hash of its content."""
    digest = hashlib.sha256(study.model_dump_json().encode()).hexdigest()
    return f"{study.title} [{digest[:12]}]"


def described(case: Case) -> dict[str, Any]:
    """What stands in tables for a case."""
    return {"variant": case.variant, **case.varied}


def run_key(engine: Engine, digest: str, accuracy_rad: float, histories: bool) -> str:
    """The name of a result: scene, engine, settings, versions, and whether its history was asked."""
    versions = record.versions()
    mine = {name: versions.get(name) for name in ("rockcheck", "numpy", "numba", engine.name) if name in versions}
    text = json.dumps([digest, engine.name, accuracy_rad.hex(), histories, mine], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _compute(store: Store, pool: Pool, jobs: Sequence[Job], told: Callable[[int, int], None], counts: Counts) -> None:
    """Run the jobs that the store does not hold, each once, in batches, longest first."""
    distinct = {job.key: job for job in jobs}
    known = store.known(distinct)
    left = [job for key, job in distinct.items() if key not in known]
    left.sort(key=lambda job: COST_ORDER[job.engine])
    counts.found |= known - counts.mine
    finished = 0

    def done(batch: Sequence[Job], results: Sequence[Run] | BaseException) -> None:
        nonlocal finished
        runs = runs_of(batch, results)
        store.put([(job.key, run) for job, run in zip(batch, runs, strict=True)], histories=batch[0].histories)
        counts.mine.update(job.key for job in batch)
        counts.failed += sum(run.outcome.failed for run in runs)
        finished += len(batch)
        told(finished, total)

    total = len(left)
    if left:
        told(0, len(left))
        if left[-1].engine == asking.REFERENCE:
            # One run here first: what it compiles is kept beside the code, and no worker compiles it again. A contact
            # engine never runs in this process: its crash would end the study.
            done(left[-1:], work(left[-1:]))
            left.pop()
        pool.run(work, batches(left, BATCH, otherwise=1), done)


def work(batch: Sequence[Job]) -> list[Run]:
    """What a worker does: resolve each scene and run it (a failure is a `Run` that says so)."""
    want = Want(history=batch[0].histories)
    return [
        simulate(job.base.scene(dict(job.setting)), job.engine, accuracy_rad=job.accuracy_rad, want=want)
        for job in batch
    ]


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
            if engine != "analytic" and reason == asking.AUDIT and reference is not None:
                audited += 1
                differ += outcome != reference[0]
    return {"audited": audited, "differ": differ}
