"""What a study says: the claims where it judges any, else how often the models agree, else how often the statue overturns."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from harness.model.finding import Answer, Finding, caution, info
from harness.model.history import Outcome
from harness.records.run import PLAIN
from harness.records.study import RecheckRecord, StudyRecord, StudyRow, StudyWitness, TableRecord

MOST_FINDINGS: Final = 30
"""Kinds of findings of runs that a study keeps, the most frequent ones."""


def answer_of(record: StudyRecord) -> Answer:
    """The headline, and what was run."""
    pairs = [
        info("same_outcome", model=name, reference=each.reference, same=each.same, cases=each.cases)
        for name, each in (record.scores or {}).items()
        if each.cases
    ]
    code = "claims" if record.headline else "agreement" if pairs else "overturning"
    found = [_claims(record.headline)] if record.headline else []
    found += pairs or _falls(record.rows)
    done = vars(record.summary)
    return Answer(code, [*found, info("study_done", **done, alike=record.summary.wanted - record.summary.distinct)])


def findings_of(record: StudyRecord) -> list[Finding]:
    """All that is to be known beside the headline."""
    found = [*_left_domain(record.rows), *_of_runs(record.rows)]
    found += [each for name, item in (record.scores or {}).items() for each in item.findings(name)]
    found += [] if record.audit is None else [_recheck(record.audit)]
    found += [] if record.table is None else [_columns(record.table)]
    found += [] if record.witness is None else _witness(record.witness)
    if record.usage is not None and record.usage.utilisation is not None:
        found.append(info("study_usage", **vars(record.usage)))
    return found


def _claims(headline: Mapping[str, str]) -> Finding:
    groups: dict[str, list[str]] = {}
    for claim, verdict in headline.items():
        groups.setdefault(verdict, []).append(claim)
    return info("claims", groups=groups)


def _falls(rows: Sequence[StudyRow]) -> list[Finding]:
    """In how many cases each model lets the statue overturn."""
    runs: dict[str, list[bool]] = {}
    for row in rows:
        if row.run is not None:
            runs.setdefault(row.model, []).append(row.run.outcome.overturned)
    return [info("overturns_in", falls=sum(falls), cases=len(falls), model=model) for model, falls in runs.items()]


def _left_domain(rows: Sequence[StudyRow]) -> Iterator[Finding]:
    """In how many runs each model left its own domain, and by what: there its outcome cannot be relied on."""
    for model in dict.fromkeys(row.model for row in rows):
        runs = [row.run for row in rows if row.run is not None and row.model == model]
        causes = Counter(cause for run in runs if (cause := run.validity.get("left_domain_by")))
        if causes:
            counts = dict(causes.most_common())
            yield caution("left_domain_in_runs", left=causes.total(), cases=len(runs), causes=counts).of(model)


def _of_runs(rows: Sequence[StudyRow]) -> list[Finding]:
    """Each kind of finding of the runs once, with the number of runs that have it and the median of its numbers; a domain that
    was left is counted by its cause.
    """
    kinds: dict[tuple[str, str], list[Finding]] = {}
    for row in rows:
        for found in row.run.findings if row.run is not None else ():
            if found.code != "left_domain":
                kinds.setdefault((row.engine, found.code), []).append(found)
    ordered = sorted(kinds.items(), key=lambda item: -len(item[1]))[:MOST_FINDINGS]
    return [replace(found[0], values=_medians(found), engine=engine) for (engine, _), found in ordered]


def _medians(found: Sequence[Finding]) -> dict[str, Any]:
    """The values of findings of one code: of numbers the median, else the first's; and how many runs they are of."""
    values = dict(found[0].values)
    for key in values:
        # Of some runs a number may not be known.
        known = [number for each in found if isinstance(number := each.values.get(key), float)]
        if known:
            values[key] = float(np.median(known))
    return values | {"in_runs": len(found)}


def _recheck(item: RecheckRecord) -> Finding:
    values = {"audited": item.audited, "differ": item.differ, "against": item.against}
    return caution("rechecked", **values) if item.differ else info("rechecked", **values)


def _columns(item: TableRecord) -> Finding:
    fallen = sum(count for name, count in item.outcomes.items() if Outcome(name).overturned)
    shown = item.shown if item.shown < item.rows else None
    return info("in_columns", rows=item.rows, folder=item.folder, share=fallen / max(item.rows, 1), shown=shown)


def _witness(item: StudyWitness) -> list[Finding]:
    """What unmodified engines say of a tenth of the scenes."""
    counts = [
        info("study_witness_count", witness=name.removesuffix(PLAIN), **vars(count))
        for name, count in item.counts.items()
    ]
    return [info("study_witness", scenes=item.scenes, of=item.of), *counts, *item.differing]
