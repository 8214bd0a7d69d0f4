"""The page of a validation: how often each model predicts what was measured, beside a bare threshold on PGV."""

from __future__ import annotations

import shlex
from pathlib import Path

from harness.records.scores import Verdict as Verdicts
from harness.records.validation import ValidationRecord
from reports.charts.validation_figures import BASELINE, charts
from reports.terminal import rate
from reports.text.limits import by_severity
from reports.text.study_rows import FAILED, SYMBOLS
from reports.text.wording import Verdict


def context(_folder: Path, record: ValidationRecord) -> dict[str, object]:
    """Everything that the validation template shows."""
    models = record.models
    return {
        "title": f"Validation against {record.tests} measured tests",
        "verdict": validation_verdict(record),
        "names": [*models, BASELINE],
        "share": rate,
        "notes": by_severity(record.findings),
        "verdicts": list(Verdicts),
        "unstated": sorted({name for pair in record.pairs for name in pair.unstated}),
        "charts": charts(record),
        "symbols": SYMBOLS,
        "failed": FAILED,
        "histories": [(name, item) for name, scores in models.items() for item in scores.histories],
        "command": command(record),
    }


def validation_verdict(record: ValidationRecord) -> Verdict:
    """The record's answer; green where a model beats the bare threshold."""
    code, found = (record.answer.code, record.answer.findings) if record.answer else ("no_answer", [])
    first, *points = [each.text for each in found] or [""]
    tones = {"no_answer": "failed", "better": "agree", "no_threshold": "agree"}
    return Verdict(first, tones.get(code, "differ"), points)


def command(record: ValidationRecord) -> str:
    """The command that repeats the validation, with every option that is not at its default."""
    parts = [f"rockcheck validate {shlex.quote(record.experiments)}", *(f"-e {name}" for name in record.models)]
    parts += [f"--samples {record.samples}"] if record.samples else []
    parts += [f"--seed {record.seed}"] if record.seed else []
    name = record.fit_share.name
    return " ".join([*parts, f"--fit-share {name}"] if name != "fit" else parts)
