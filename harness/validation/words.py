"""A validation in a few lines of plain words: how often each model is right, and which tests nothing explains."""

from __future__ import annotations

from harness.records.scores import Interval
from harness.records.sets import ReliabilityBin
from harness.records.validation import FallScores, ModelRecord, ProbabilityScores, ValidationRecord

SWAPPED = "no run gives what was observed (label swapped?)"


def summary(record: ValidationRecord) -> str:
    """The scores by model, those of a threshold on PGV beside them, and the tests that nothing explains."""
    width = max(len(name) for name in (*record.models, "PGV threshold"))
    lines = [record.title]
    for name, item in record.models.items():
        lines.append(f"  {name:{width}}  {'; '.join(_of_model(item))}")
        if bins := item.probability.reliability:
            lines.append(f"  {'':{width}}  of what it says: {'; '.join(map(_bin, bins))}")
    bare = record.baseline
    lines.append(f"  {'PGV threshold':{width}}  {'; '.join(_scores(bare.outcomes, bare.probability))}")
    if record.unfitted:
        lines.append(f"  note: {', '.join(record.unfitted)}: no test of share {record.fit_share.name!r} to fit on")
    if record.unexplained:
        lines.append(f"  {', '.join(record.unexplained)}: {SWAPPED}")
    lines.append(f"  {record.runs.computed} of {record.runs.wanted} runs computed in this call")
    return "\n".join(lines)


def share(item: Interval) -> str:
    """A share in per cent with its interval."""
    return f"{100 * item.value:.0f} % ({100 * item.low:.0f}–{100 * item.high:.0f} %)"


def _bin(item: ReliabilityBin) -> str:
    """`0–20 % fell 1 of 6: 17 % (3–56 %)`, and where that is no true probability's."""
    fell = round(item.fell.value * item.cases)
    said = f"{100 * item.low:.0f}–{100 * item.high:.0f} % fell {fell} of {item.cases}: {share(item.fell)}"
    return said if item.holds else f"{said}, outside the band of true ones"


def _of_model(item: ModelRecord) -> list[str]:
    right = item.outcomes.accuracy
    words = [] if right is None else [f"nominal run right in {share(right)}"]
    return [
        *words,
        *_scores(item.by_probability, item.probability),
        *([f"{item.failed} failed"] if item.failed else []),
    ]


def _scores(falls: FallScores | None, chances: ProbabilityScores) -> list[str]:
    words = []
    if falls is not None and falls.accuracy is not None:
        words.append(f"by P ≥ 1/2 right in {share(falls.accuracy)}")
    if chances.brier is not None:
        words.append(f"Brier {chances.brier:.3f}")
    if chances.area is not None:
        words.append(f"area under the curve {chances.area.value:.2f}")
    return words
