"""Many scenes, several engines: what needs a run gets one, once; what is finished is never lost."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from harness.campaign.batches import batches, run_batches
from harness.campaign.runner import Crash, Pool
from harness.studies.cases import base_of
from harness.studies.file import StudyFile
from harness.studies.jobs import Finished, Job, compute, lost
from harness.studies.store import Store
from harness.studies.study_plan import Plan
from harness.studies.usage import Usage

BATCH: Final = {"analytic": 64}
"""Runs handed to a worker at a time: a run of a fraction of a millisecond is not worth a message of its own."""


@dataclass(frozen=True)
class Summary:
    """What a call of a study did, and where its seconds went."""

    cases: int
    wanted: int
    distinct: int
    found: int
    computed: int
    not_sent: int
    failed: int
    usage: Usage

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

    def as_dict(self) -> dict[str, Any]:
        """The counts as plain values, with their sentence."""
        return {**{name: value for name, value in vars(self).items() if name != "usage"}, "sentence": str(self)}


def run_study(
    study: StudyFile,
    path: Path,
    store: Store,
    pool: Pool,
    told: Callable[[int, int], None] = lambda done, all_: None,
) -> Summary:
    """Run what the study asks and the store does not hold; `told(done, all)` hears of progress.

    The analytic model runs first where the question needs its answers, then the others in as many rounds as it takes. Every
    result is in the store as soon as it is finished. Raises `InputError` for a case that is no scene.
    """
    plan = Plan(study, base_of(study, path))
    work = _Work(store, pool, told)
    for expected, jobs in plan.rounds():
        work.compute(expected, jobs)
        plan.learn(store)
    work.usage.stop()
    store.write_plan(study_name(study), plan.rows())
    totals = plan.totals()
    return Summary(
        cases=totals.cases,
        wanted=totals.wanted,
        distinct=totals.distinct,
        found=len(work.found),
        computed=work.computed,
        not_sent=totals.not_sent,
        failed=work.failed,
        usage=work.usage,
    )


def study_name(study: StudyFile) -> str:
    """What names a study in its store: its title and the hash of its content."""
    digest = hashlib.sha256(study.model_dump_json().encode()).hexdigest()
    return f"{study.title} [{digest[:12]}]"


class _Work:
    """The work of one call: each job that the store does not hold, once."""

    def __init__(self, store: Store, pool: Pool, told: Callable[[int, int], None]) -> None:
        self._store, self._pool, self._told = store, pool, told
        self._expected = self._settled = 0
        self._kept = store.keys()
        self._seen: set[str] = set()
        self.found: set[str] = set()
        self.computed = self.failed = 0
        self.usage = Usage(pool.workers)

    def compute(self, expected: int, jobs: Iterator[Job]) -> None:
        """Run jobs (of which so many are expected) in batches, in the order in which they come."""
        self._expected += expected
        self._told(self._settled, self._expected)
        run_batches(self._pool, compute, batches(self._left(jobs), BATCH, otherwise=1), self._done)
        self._told(self._settled, self._expected)

    def _left(self, jobs: Iterator[Job]) -> Iterator[Job]:
        """The jobs of which nobody has a result yet, and nobody is at work on."""
        for job in jobs:
            if job.key in self._kept:
                self.found.add(job.key)
            elif job.key not in self._seen:
                self._seen.add(job.key)
                yield job
                continue
            self._settled += 1

    def _done(self, batch: Sequence[Job], result: Finished | Crash) -> None:
        finished = lost(batch, result) if isinstance(result, Crash) else result
        self._store.add(finished.results)
        self.computed += len(batch)
        self.failed += finished.failed
        self.usage.note(len(batch), finished.busy_s, finished.outside_s)
        self._settled += len(batch)
        self._told(self._settled, self._expected)
