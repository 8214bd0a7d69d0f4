"""Many scenes, several engines: which case is sent to which engine and why; results are cached.

A plan of any size is made as it is run; what is finished is never lost.
"""

from __future__ import annotations

import hashlib
import itertools
import random
from collections import defaultdict
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD
from harness.model.scene import Scene
from harness.questions.study import case_selection as selection
from harness.questions.study.case_blocks import block_tasks, in_columns
from harness.questions.study.cases import Base, Case, base_of, expand
from harness.questions.study.file import StudyFile, Value
from harness.records.base import same_fields
from harness.records.study import CaseRun, StudySummary, UsageRecord
from harness.runs.execute import Campaign, OnProgress, silent
from harness.runs.runner import Pool
from harness.runs.store import Store
from harness.runs.task import RunRequest, Task

BATCH: Final = {"analytic": 64}
"""Runs handed to a worker at a time: a run of a fraction of a millisecond is not worth a message of its own."""
PlanRow = tuple[int, str, str | None, str, Mapping[str, Value]]


@dataclass(frozen=True, kw_only=True)
class Summary(StudySummary):
    """What a call of a study did, and where its seconds went."""

    usage: UsageRecord

    def record(self) -> StudySummary:
        """The counts, as a record holds them."""
        return StudySummary(**same_fields(StudySummary, self))


def run_study(
    study: StudyFile,
    path: Path,
    store: Store,
    pool: Pool,
    on_progress: OnProgress = silent,
    *,
    singly: bool = False,
) -> Summary:
    """Run what the study asks and the store does not hold; `on_progress(done, all)` hears of progress.

    The analytic model runs first where the question needs its answers, then the others in as many rounds as it takes. Every
    result is in the store as soon as it is finished. Many runs of the model alone are computed in blocks, unless each is wanted
    `singly`, as a witness judges them. Raises `InputError` for a case that is no scene.
    """
    base = base_of(study, path)
    if in_columns(study, base) and not singly:
        return _run_blocks(study, base, store, Campaign(store, pool, on_progress))
    plan = Plan(study, base)
    campaign = Campaign(store, pool, on_progress, BATCH, free=plan.free)
    for expected, tasks in plan.rounds(store.keys()):
        campaign.run(tasks, expected)
        plan.learn(store)
    store.write_plan(study_name(study), plan.rows())
    return plan.summary(campaign)


def _run_blocks(study: StudyFile, base: Base, store: Store, campaign: Campaign) -> Summary:
    """Run a study of very many cases block by block: to know which are the same by their physics would take as long."""
    tasks = list(block_tasks(study, base))
    campaign.run(tasks, study.runs)
    blocks: list[PlanRow] = [
        (task.argument.numbers.start, selection.REFERENCE, task.key, selection.EVERY, {}) for task in tasks
    ]
    store.write_plan(study_name(study), blocks)
    asked = dict.fromkeys(("cases", "wanted", "distinct"), study.runs)
    return _summary(campaign, **asked, found=study.runs - campaign.computed)


def _summary(campaign: Campaign, **counts: int) -> Summary:
    return Summary(**counts, computed=campaign.computed, failed=campaign.failed, usage=campaign.usage())


def study_name(study: StudyFile) -> str:
    """What names a study in its store: its title and the hash of its content."""
    digest = hashlib.sha256(study.model_dump_json().encode()).hexdigest()
    return f"{study.title} [{digest[:12]}]"


class Plan:
    """What is asked of each engine, as far as is known; what was planned once is not planned again."""

    def __init__(self, study: StudyFile, base: Base) -> None:
        self._study, self._base = study, base
        self._scene: tuple[int, Scene] | None = None
        self._known: dict[tuple[int, str], tuple[str | None, str]] = {}
        """Key and reason by case and engine."""
        self._answers: dict[tuple[str, str], dict[selection.Place, selection.Answer]] = {}
        self._fresh: list[tuple[Case, str, str]] = []
        named = {name for variant in study.variant for name in variant.engines}
        self._others = sorted(named - {selection.REFERENCE})
        self.free = (selection.REFERENCE,) if self._others else ()
        """What costs next to nothing beside the others."""

    def rounds(self, stored: Container[str] = ()) -> Iterator[tuple[int, Iterator[Task]]]:
        """How many tasks that cost something, and the tasks; the next round rests on the answers of the last (see `learn`).

        Contact engines' are in a seeded order, what is `stored` first: the rate at which they finish tells the time that is left.
        """
        if self._study.ask.cases == "all":
            tasks = self._of_others()
            yield (len(tasks) if self.free else self._study.runs), self._all(self._ordered(tasks, stored))
            return
        cases = list(expand(self._study, self._base))
        for names in ([selection.REFERENCE], self._others):
            while fresh := self._asked(cases, names):
                counted = sum(task.group not in self.free for task in fresh)
                yield counted, iter(fresh if names == [selection.REFERENCE] else self._ordered(fresh, stored))

    def _of_others(self) -> list[Task]:
        """Every case by contact engines, what is the same by its physics once."""
        tasks = {}
        for case in expand(self._study, self._base) if self._others else ():
            for name in self._others:
                if name in case.engines:
                    task = self._planned(case, name, selection.EVERY)
                    tasks[task.key] = task
        return list(tasks.values())

    def _ordered(self, tasks: Sequence[Task], stored: Container[str]) -> list[Task]:
        """Tasks in a seeded order, those that are stored first."""
        order = random.Random(self._study.seed).sample(tasks, len(tasks))
        return sorted(order, key=lambda task: task.key not in stored)

    def _all(self, tasks: Sequence[Task]) -> Iterator[Task]:
        """Every case: those of contact engines, the others as they come."""
        rest = self._of_reference()
        # One of the compiled model's first: should it have to be compiled, the other workers need not wait for it.
        yield from itertools.islice(rest, 1)
        yield from tasks
        yield from rest

    def _of_reference(self) -> Iterator[Task]:
        for case in expand(self._study, self._base):
            if selection.REFERENCE in case.engines:
                yield self._planned(case, selection.REFERENCE, selection.EVERY)

    def _asked(self, cases: Sequence[Case], names: Sequence[str]) -> list[Task]:
        """What these engines are asked now and were not asked before."""
        by_variant: dict[str, list[Case]] = defaultdict(list)
        for case in cases:
            by_variant[case.variant].append(case)
        tasks = []
        for name in names:
            for variant, members in by_variant.items():
                if name not in members[0].engines:
                    continue
                places = [case.position for case in members]
                reasons = selection.wanted(self._study, places, name, variant, self._answers)
                for case in members:
                    why, known = reasons.get(case.position), self._known.get((case.number, name))
                    if why is None:
                        self._known[case.number, name] = None, selection.left_out(self._study)
                    elif known is None or known[0] is None:
                        tasks.append(self._planned(case, name, why))
                        self._fresh.append((case, name, tasks[-1].key))
        return tasks

    def _planned(self, case: Case, engine: str, why: str) -> Task:
        # Each scene is resolved once here, for the names of its results.
        if self._scene is None or self._scene[0] != case.number:
            self._scene = case.number, self._base.scene(case.setting)
        accuracy = self._study.asked_rad.get(engine, DEFAULT_ACCURACY_RAD)
        made = partial(self._base.scene, case.setting)
        task = RunRequest(made, engine, accuracy, history=self._study.ask.histories).task(self._scene[1])
        self._known[case.number, engine] = task.key, why
        return task

    def learn(self, store: Store) -> None:
        """Take the answers of the round that was run, which tell what is asked next."""
        for case, engine, key in self._fresh:
            record = store.get(key)
            if record is not None:
                run = CaseRun.stored(record)
                share = run.validity.get("peak_over_slenderness")
                known = self._answers.setdefault((engine, case.variant), {})
                peak = float(share) if isinstance(share, (int, float)) and share else abs(run.peak_theta_rad)
                known[case.position] = selection.Answer(run.outcome.value, peak)
        self._fresh.clear()

    def rows(self) -> Iterator[PlanRow]:
        """All cases and engines in order: number, engine, key (None: not sent), reason, and what varies."""
        for case in expand(self._study, self._base):
            for engine in sorted(case.engines):
                key, reason = self._known[case.number, engine]
                yield case.number, engine, key, reason, {"variant": case.variant, **case.varied}

    def summary(self, campaign: Campaign) -> Summary:
        """How many cases, runs wanted, distinct ones and those not sent to an engine, and what a campaign did of them."""
        keys = [key for key, _ in self._known.values() if key is not None]
        cases, wanted = len({number for number, _ in self._known}), len(keys)
        asked = {"cases": cases, "wanted": wanted, "distinct": len(set(keys)), "not_sent": len(self._known) - wanted}
        return _summary(campaign, **asked, found=len(campaign.reused))
