"""Many scenes, several engines: what needs a run gets one, once; what is finished is never lost."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from harness.campaign.campaign import Campaign, OnProgress, silent
from harness.campaign.column_store import ColumnStore
from harness.campaign.runner import Pool
from harness.campaign.store import Store
from harness.campaign.task import Answer, Task
from harness.campaign.usage import Usage
from harness.records.study import StudySummary
from harness.studies.case_blocks import block_tasks
from harness.studies.cases import base_of
from harness.studies.file import StudyFile
from harness.studies.study_plan import Plan

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

    def record(self) -> StudySummary:
        """The counts with their sentence, as a record holds them."""
        counts = {name: value for name, value in vars(self).items() if name != "usage"}
        return StudySummary(**counts, sentence=str(self))


@dataclass
class Beside:
    """Tasks without a key that use the workers of a study: some before its own, some when those are handed out; their answers."""

    before: Iterable[Task]
    after: Callable[[], Iterable[Task]]
    answers: list[tuple[Task, Answer]] = field(default_factory=list)

    def around(self, tasks: Iterable[Task]) -> Iterator[Task]:
        """The tasks of a study among these, which come once; the last are made when all others are handed out."""
        before, after, self.before, self.after = self.before, self.after, (), tuple
        yield from before
        yield from tasks
        yield from after()


def run_study(
    study: StudyFile,
    path: Path,
    store: Store,
    pool: Pool,
    on_progress: OnProgress = silent,
    beside: Beside | None = None,
) -> Summary:
    """Run what the study asks and the store does not hold; `on_progress(done, all)` hears of progress.

    The analytic model runs first where the question needs its answers, then the others in as many rounds as it takes. Every
    result is in the store as soon as it is finished. Raises `InputError` for a case that is no scene.
    """
    plan = Plan(study, base_of(study, path))
    campaign = Campaign(store, pool, on_progress, BATCH)
    for expected, tasks in plan.rounds():
        campaign.run(tasks if beside is None else beside.around(tasks), expected)
        plan.learn(store)
    if beside is not None:
        beside.answers += campaign.aside
    campaign.usage.stop()
    store.write_plan(study_name(study), plan.rows())
    totals = plan.totals()
    return Summary(
        cases=totals.cases,
        wanted=totals.wanted,
        distinct=totals.distinct,
        found=len(campaign.reused),
        computed=campaign.computed,
        not_sent=totals.not_sent,
        failed=campaign.failed,
        usage=campaign.usage,
    )


def run_in_columns(
    study: StudyFile, path: Path, store: ColumnStore, pool: Pool, on_progress: OnProgress = silent
) -> Summary:
    """Run a study of very many cases block by block; each block is in the store, whole, as soon as it is finished.

    Cases that are the same by their physics are computed once each: to know them would take as long. Raises `InputError` for a
    case that is no scene.
    """
    campaign = Campaign(store, pool, on_progress)
    campaign.run(block_tasks(study, base_of(study, path)), study.runs)
    campaign.usage.stop()
    return Summary(
        cases=study.runs,
        wanted=study.runs,
        distinct=study.runs,
        found=study.runs - campaign.computed,
        computed=campaign.computed,
        not_sent=0,
        failed=campaign.failed,
        usage=campaign.usage,
    )


def study_name(study: StudyFile) -> str:
    """What names a study in its store: its title and the hash of its content."""
    digest = hashlib.sha256(study.model_dump_json().encode()).hexdigest()
    return f"{study.title} [{digest[:12]}]"
