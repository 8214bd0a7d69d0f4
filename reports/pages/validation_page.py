"""The page of a validation: how often each model predicts what was measured, beside a bare threshold on PGV."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from harness.records.scores import Interval, Scores
from harness.records.scores import Verdict as Verdicts
from harness.records.validation import BaselineRecord, Fitted, PairScores, ValidationRecord
from harness.validation.words import SWAPPED, share
from reports.charts.validation_figures import BASELINE, charts
from reports.text.language import ENGLISH
from reports.text.numbers import digits, short, unit
from reports.text.study_rows import FAILED, SYMBOLS
from reports.text.wording import Verdict

SCORES: Final = (
    ("accuracy", "right"),
    ("precision", "of those predicted to fall, fell"),
    ("recall", "of those that fell, predicted"),
    ("f1", "F1"),
    ("matthews", "Matthews' correlation"),
)


def context(_folder: Path, record: ValidationRecord) -> dict[str, object]:
    """Everything that the validation template shows."""
    models = record.models
    return {
        "title": f"Validation against {record.tests} measured tests",
        "verdict": validation_verdict(record),
        "names": [*models, BASELINE],
        "kinds": SCORES,
        "share": share,
        "pairs": pair_sentences(record.pairs),
        "unstated": sorted({name for pair in record.pairs for name in pair.unstated}),
        "charts": charts(record),
        "fitted": {name: _fitted(item.fitted) for name, item in models.items()},
        "symbols": SYMBOLS,
        "failed": FAILED,
        "histories": [
            (name, item.test, _history(item.scores)) for name, scores in models.items() for item in scores.histories
        ],
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


def pair_sentences(pairs: Sequence[PairScores]) -> list[tuple[str, str]]:
    """For each two models, how often they give the same outcome and the shares of the verdicts."""
    sentences = []
    for pair in pairs:
        same = pair.outcomes.side_accuracy
        text = f"the same outcome in {share(same)} of {pair.cases} tests; " if same else ""
        text += "; ".join(f"{each.value}: {100 * pair.verdicts.get(each, 0.0):.0f} %" for each in Verdicts) + "."
        if pair.flips:
            text += f" In {pair.flips} the outcome flips within the numerical error."
        sentences.append((f"{pair.a} and {pair.b}", text))
    return sentences


def _fitted(fitted: Fitted) -> str:
    if not fitted.tests:
        return "nothing was fitted"
    parts = [f"on {fitted.tests} tests"]
    if fitted.friction is not None:
        parts.append(f"friction {short(fitted.friction)}")
    parts += [f"{Path(body).name}: {short(float(angle))}°" for body, angle in fitted.azimuth_deg.items()]
    for words, values in (("contact tolerance", fitted.contact_tolerance_m), ("worn by", fitted.inset_m)):
        parts += [f"{Path(body).name}: {words} {unit(value, 'm')}" for body, value in values.items()]
    return f"{', '.join(parts)}; {fitted.runs} runs"


def command(record: ValidationRecord) -> str:
    """The command that repeats the validation, with every option that is not at its default."""
    parts = [f"rockcheck validate {shlex.quote(record.experiments)}", *(f"-e {name}" for name in record.models)]
    parts += [f"--samples {record.samples}"] if record.samples else []
    parts += [f"--seed {record.seed}"] if record.seed else []
    name = record.fit_share.name
    return " ".join([*parts, f"--fit-share {name}"] if name != "fit" else parts)


def _history(scores: Scores | None) -> str:
    """One computed history beside the measured one: numbers first, then why they differ."""
    if scores is None:
        return "no history was computed"
    parts = [f"up to {unit(scores.compared_until_s, 's')}: {digits(scores.rms_theta_rad)} rad apart (root mean square)"]
    if scores.peak_ratio is not None:
        parts.append(f"largest rotation {digits(scores.peak_ratio)} times the measured one")
    if scores.combined is not None:
        parts.append(f"magnitude error {digits(scores.magnitude)}, phase error {digits(scores.phase)}")
    return f"{', '.join(parts)}. {scores.verdict_sentence}"
