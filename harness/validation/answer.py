"""What a validation says: which models are right most often, and whether any beats a bare threshold on PGV."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from harness.model.finding import Answer, Finding, caution, changes_answer, info
from harness.records.scores import Interval
from harness.records.validation import ModelRecord, ValidationRecord


def answer_of(record: ValidationRecord) -> Answer:
    """The models that are right most often, held against the threshold; its code says whether any is better."""
    known = {name: item.outcomes.accuracy for name, item in record.models.items() if item.outcomes.accuracy}
    if not known:
        return Answer("no_answer", [changes_answer("no_test_decided", tests=record.tests)])
    found, bare = [_best(known)], record.baseline.outcomes.accuracy
    if bare is None:
        return Answer("no_threshold", found)
    better = [name for name, item in known.items() if item.low > bare.value]
    worse = [name for name, item in known.items() if item.high < bare.value]
    shown = "better" if better else "worse" if worse else "alike"
    own = sorted(record.baseline.threshold_by_body_m_s.values()) or [record.baseline.threshold_m_s]
    values = {"models": better or worse or list(known), "right": _values(bare), "threshold_m_s": [own[0], own[-1]]}
    against = info("threshold", shown=shown, **values) if better else caution("threshold", shown=shown, **values)
    return Answer(shown, [*found, against])


def findings_of(record: ValidationRecord) -> list[Finding]:
    """All that is to be known beside the headline."""
    found = [each.of(name) for name, item in record.models.items() for each in _of_model(item)]
    if record.unexplained:
        found.append(caution("tests_unexplained", tests=list(record.unexplained)))
    if record.unfitted:
        found.append(caution("not_fitted", keys=list(record.unfitted), fit_share=record.fit_share.name))
    return [*found, info("runs_computed", computed=record.runs.computed, wanted=record.runs.wanted)]


def _best(known: Mapping[str, Interval]) -> Finding:
    """Which models are right most often; a bare count, whose intervals may overlap."""
    most = max(item.value for item in known.values())
    best = [name for name, item in known.items() if item.value == most]
    return info("right_most_often", alone=len(best) == 1, models=best, right=_values(known[best[0]]))


def _of_model(item: ModelRecord) -> Iterator[Finding]:
    """What a model leaves open, and where what it says of a fall is no true probability."""
    within = item.outcomes.within_uncertainty
    left = item.outcomes.undecided + within
    if left or item.failed:
        yield caution("tests_left_open", left=left, within=within, failed=item.failed)
    for each in item.probability.reliability:
        if not each.holds:
            values = {"from": each.low, "to": each.high, "fell": _values(each.fell), "cases": each.cases}
            yield caution("not_reliable", **values)


def _values(item: Interval) -> list[float]:
    return [item.value, item.low, item.high]
