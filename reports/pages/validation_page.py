"""The page of a validation: how often each model predicts what was measured, beside a bare threshold on PGV."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path

from harness.records.scores import Interval
from harness.records.scores import Verdict as Verdicts
from harness.records.validation import BaselineRecord, ValidationRecord
from harness.validation.words import SWAPPED, share
from reports.charts.validation_figures import BASELINE, charts
from reports.messages import ENGLISH
from reports.messages.numbers import unit
from reports.text.study_rows import FAILED, SYMBOLS
from reports.text.wording import Verdict


def context(_folder: Path, record: ValidationRecord) -> dict[str, object]:
    """Everything that the validation template shows."""
    models = record.models
    return {
        "title": f"Validation against {record.tests} measured tests",
        "verdict": validation_verdict(record),
        "names": [*models, BASELINE],
        "share": share,
        "verdicts": list(Verdicts),
        "unstated": sorted({name for pair in record.pairs for name in pair.unstated}),
        "charts": charts(record),
        "symbols": SYMBOLS,
        "failed": FAILED,
        "histories": [(name, item) for name, scores in models.items() for item in scores.histories],
        "command": command(record),
    }


def validation_verdict(record: ValidationRecord) -> Verdict:
    """Which models are right most often, with the interval, and whether any beats the threshold."""
    known = {name: item.outcomes.accuracy for name, item in record.models.items() if item.outcomes.accuracy}
    if not known:
        return Verdict("No model decided any test", "failed", [])
    bare = record.baseline.outcomes.accuracy
    best = _best(known)
    points = [f"{name}: {share(item)} of the tests that it decides." for name, item in known.items()]
    if record.unexplained:
        points.append(f"{ENGLISH.listed(list(record.unexplained))}: {SWAPPED}.")
    for name, item in record.models.items():
        outcomes = item.outcomes
        if item.by_probability is not None and item.by_probability.accuracy is not None:
            points.append(f"{name} by P ≥ ½ of {record.samples} draws: {share(item.by_probability.accuracy)}.")
        left = outcomes.undecided + outcomes.within_uncertainty
        if left or item.failed:
            points.append(
                f"{name} leaves {left} tests open ({outcomes.within_uncertainty} within its numerical error); "
                f"{item.failed} runs failed."
            )
    if bare is None:
        return Verdict(best, "agree", points)
    points.append(f"A bare threshold on PGV ({_thresholds(record.baseline)}): {share(bare)}.")
    better = [name for name, item in known.items() if item.low > bare.value]
    worse = [name for name, item in known.items() if item.high < bare.value]
    if better:
        who = (
            "every model"
            if len(better) == len(known)
            else f"of {ENGLISH.count(len(known))} models {ENGLISH.listed(better)}"
        )
        words = f"{who} {'beats' if len(better) in (1, len(known)) else 'beat'} a bare threshold on PGV beyond chance"
    elif worse:
        words = f"no model beats a bare threshold on PGV, and {ENGLISH.listed(worse)} {'is' if len(worse) == 1 else 'are'} worse"
    else:
        words = "with these tests no model can be told from a bare threshold on PGV"
    return Verdict(f"{best}; {words}, right in {share(bare)}", "agree" if better else "differ", points)


def _thresholds(baseline: BaselineRecord) -> str:
    """The thresholds by body, from the least to the greatest."""
    own = sorted(baseline.threshold_by_body_m_s.values()) or [baseline.threshold_m_s]
    if own[0] == own[-1]:
        return unit(own[0], "m/s")
    return f"{unit(own[0], 'm/s')} to {unit(own[-1], 'm/s')}, by body"


def _best(known: Mapping[str, Interval]) -> str:
    """Which models are right most often; a bare count, whose intervals may overlap."""
    most = max(item.value for item in known.values())
    best = [name for name, item in known.items() if item.value == most]
    if len(known) == 1:
        return f"{best[0]} is right in {share(known[best[0]])} of the tests that it decides"
    if len(best) == 1:
        return f"{best[0]} is right most often, in {share(known[best[0]])} of the tests that it decides"
    every = "All models are" if len(best) == len(known) else f"{ENGLISH.listed(best)} are"
    return f"{every} right equally often, in {100 * most:.0f} % of the tests that they decide"


def command(record: ValidationRecord) -> str:
    """The command that repeats the validation, with every option that is not at its default."""
    parts = [f"rockcheck validate {shlex.quote(record.experiments)}", *(f"-e {name}" for name in record.models)]
    parts += [f"--samples {record.samples}"] if record.samples else []
    parts += [f"--seed {record.seed}"] if record.seed else []
    name = record.fit_share.name
    return " ".join([*parts, f"--fit-share {name}"] if name != "fit" else parts)
