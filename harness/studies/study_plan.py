"""The plan of a study: which case is sent to which engine, and why; a plan of any size is made as it is run."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from harness.campaign.store import Store
from harness.campaign.task import Task
from harness.records.study import CaseRun
from harness.studies import case_selection as selection
from harness.studies.case_tasks import CaseTasks
from harness.studies.cases import Base, Case, expand
from harness.studies.file import StudyFile, Value

DEAREST_FIRST: Final = (
    "pybullet:plain",
    "mujoco:plain",
    "mujoco",
    "pymunk:plain",
    "pybullet",
    "pymunk",
    "spatial",
    "analytic",
)
COST_ORDER: Final = {name: place for place, name in enumerate(DEAREST_FIRST)}
"""Longest first keeps all workers busy to the end."""

PlanRow = tuple[int, str, str | None, str, Mapping[str, Value]]


@dataclass(frozen=True)
class Totals:
    """Numbers of a plan: runs wanted, distinct ones, and those not sent to an engine."""

    cases: int
    wanted: int
    distinct: int
    not_sent: int


class Plan:
    """What is asked of each engine, as far as is known; what was planned once is not planned again."""

    def __init__(self, study: StudyFile, base: Base) -> None:
        self._study, self._base = study, base
        self._tasks = CaseTasks(study, base)
        self._known: dict[tuple[int, str], tuple[str | None, str]] = {}
        """Key and reason by case and engine."""
        self._answers: dict[tuple[str, str], dict[selection.Place, selection.Answer]] = {}
        self._fresh: list[tuple[Case, str, str]] = []
        named = {name for variant in study.variant for name in variant.engines}
        self._engines = sorted(named, key=lambda name: COST_ORDER[name])

    def rounds(self) -> Iterator[tuple[int, Iterator[Task]]]:
        """How many tasks, and the tasks, longest first; the next round rests on the answers of the last (see `learn`)."""
        if self._study.ask.cases == "all":
            yield self._study.runs, self._all()
            return
        cases = list(expand(self._study, self._base))
        others = [name for name in self._engines if name != selection.REFERENCE]
        for names in (self._engines[len(others) :], others):
            while fresh := self._asked(cases, names):
                yield len(fresh), iter(fresh)

    def _all(self) -> Iterator[Task]:
        """Every case: those of contact engines sorted, the others as they come."""
        others = [name for name in self._engines if name != selection.REFERENCE]
        tasks = []
        for case in expand(self._study, self._base) if others else ():
            tasks += [self._planned(case, name, selection.EVERY) for name in others if name in case.engines]
        rest = self._of_reference()
        # One of the compiled model's first: should it have to be compiled, the other workers need not wait for it.
        yield from itertools.islice(rest, 1)
        # Two bodies in contact take several times as long as one.
        yield from sorted(tasks, key=lambda task: (COST_ORDER[task.group], not task.argument.pedestal))
        yield from rest

    def _of_reference(self) -> Iterator[Task]:
        for case in expand(self._study, self._base) if selection.REFERENCE in self._engines else ():
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
        task = self._tasks.of(case, engine)
        self._known[case.number, engine] = task.key, why
        return task

    def learn(self, store: Store) -> None:
        """Take the answers of the round that was run, which tell what is asked next."""
        for case, engine, key in self._fresh:
            row = store.get(key)
            if row is not None:
                run = CaseRun.stored(row.record)
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

    def totals(self) -> Totals:
        """How many there are of each."""
        keys = [key for key, _ in self._known.values() if key is not None]
        return Totals(
            cases=len({number for number, _ in self._known}),
            wanted=len(keys),
            distinct=len(set(keys)),
            not_sent=len(self._known) - len(keys),
        )
